#include "guide/channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT] = {
    {STY_GUIDE_NORMAL, "normal", 3, {"normal.X", "normal.Y", "normal.Z"}, 0, offsetof(StySamples, normal)},
    {STY_GUIDE_DEPTH, "depth", 1, {"depth.Z"}, INFINITY, offsetof(StySamples, depth)},
    {STY_GUIDE_POSITION, "position", 3, {"position.X", "position.Y", "position.Z"}, 0, offsetof(StySamples, position)},
    {STY_GUIDE_OBJECT, "object", 1, {"object.I"}, 0, offsetof(StySamples, object)},
    {STY_GUIDE_STYLE, "style", 1, {"style.I"}, 0, offsetof(StySamples, style)},
    {STY_GUIDE_UV, "uv", 2, {"uv.U", "uv.V"}, 0, offsetof(StySamples, uv)},
    {STY_GUIDE_ALBEDO, "albedo", 3, {"albedo.R", "albedo.G", "albedo.B"}, 0, offsetof(StySamples, albedo)},
    {STY_GUIDE_LUMA, "luma", 1, {"luma.Y"}, 0, offsetof(StySamples, luma)},
    {STY_GUIDE_CURVATURE, "curvature", 1, {"curvature.Y"}, 0, offsetof(StySamples, curvature)},
    {STY_GUIDE_CONTOUR, "contour", 1, {"contour.Y"}, 0, 0},
    {STY_GUIDE_MOTION, "motion", 2, {"motion.U", "motion.V"}, 0, offsetof(StySamples, motion)},
    {STY_GUIDE_FULL, "full", 3, {"full.R", "full.G", "full.B"}, 0, offsetof(StySamples, paths.full)},
    {STY_GUIDE_LDE, "LDE", 3, {"LDE.R", "LDE.G", "LDE.B"}, 0, offsetof(StySamples, paths.lde)},
    {STY_GUIDE_LSE, "LSE", 3, {"LSE.R", "LSE.G", "LSE.B"}, 0, offsetof(StySamples, paths.lse)},
    {STY_GUIDE_LD12E, "LD12E", 3, {"LD12E.R", "LD12E.G", "LD12E.B"}, 0, offsetof(StySamples, paths.ld12e)},
    {STY_GUIDE_LIE, "LIE", 3, {"LIE.R", "LIE.G", "LIE.B"}, 0, offsetof(StySamples, paths.lie)},
};

static unsigned get_all_groups(void) {
  unsigned all = 0;
  for (int g = 0; g < STY_GROUP_COUNT; g++) all |= STY_CHANNEL_GROUPS[g].group;
  return all;
}

static bool is_word(const char *text, size_t length, const char *word) {
  return strlen(word) == length && memcmp(word, text, length) == 0;
}

/* The groups called by the first `length` characters of `text`; 0 for none. */
static unsigned find_groups(const char *text, size_t length) {
  for (int g = 0; g < STY_GROUP_COUNT; g++)
    if (is_word(text, length, STY_CHANNEL_GROUPS[g].name)) return STY_CHANNEL_GROUPS[g].group;
  if (is_word(text, length, "paths")) return STY_GUIDE_PATHS;
  return is_word(text, length, "all") ? get_all_groups() & ~(unsigned)(STY_GUIDE_MOTION | STY_GUIDE_PATHS) : 0;
}

static StyStatus fail_group(const char *what, const char *text, size_t length, StyError *error) {
  char names[256] = "";
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const size_t used = strlen(names);
    snprintf(names + used, sizeof names - used, "%s, ", STY_CHANNEL_GROUPS[g].name);
  }
  return sty_fail(error, STY_ERROR_USAGE, "%s: found '%.*s', expected a comma-separated list of %spaths or all", what,
                  (int)(length < 64 ? length : 64), text, names);
}

StyStatus sty_parse_channels(const char *what, const char *text, unsigned *groups, StyError *error) {
  unsigned found = 0;
  for (const char *at = text;;) {
    const size_t length = strcspn(at, ",");
    const unsigned named = find_groups(at, length);
    if (named == 0) return fail_group(what, at, length, error);
    found |= named;
    if (at[length] == '\0') break;
    at += length + 1;
  }
  *groups = found;
  return STY_OK;
}

static void add_plane(StyGuide *guide, const char *channel, float miss, size_t field) {
  guide->planes[guide->plane_count++] = (StyGuidePlane){sty_find_channel(guide->image, channel), miss, field};
}

StyGuide sty_view_guide(StyImage *image, unsigned groups) {
  StyGuide guide = {.image = image};
  add_plane(&guide, "A", 0, offsetof(StySamples, coverage));
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const StyChannelGroupInfo *info = &STY_CHANNEL_GROUPS[g];
    if (!(groups & ~(unsigned)STY_GUIDE_CONTOUR & info->group)) continue;
    for (int c = 0; c < info->count; c++)
      add_plane(&guide, info->channels[c], info->miss, info->field + (size_t)c * sizeof(StyLane));
  }
  return guide;
}

StyStatus sty_create_guide(int width, int height, unsigned groups, StyGuide *out, StyError *error) {
  if (groups & ~get_all_groups())
    return sty_fail(error, STY_ERROR_USAGE, "guide channels: found the unknown set 0x%x", groups);
  const char *names[1 + STY_GROUP_COUNT * STY_GROUP_CHANNELS] = {"A"};
  int count = 1;
  for (int g = 0; g < STY_GROUP_COUNT; g++)
    for (int c = 0; groups & STY_CHANNEL_GROUPS[g].group && c < STY_CHANNEL_GROUPS[g].count; c++)
      names[count++] = STY_CHANNEL_GROUPS[g].channels[c];
  StyImage *image = NULL;
  const StyStatus status = sty_create_image(width, height, count, names, 32, &image, error);
  if (status == STY_OK) *out = sty_view_guide(image, groups);
  return status;
}

void sty_clear_pixels(const StyGuide *guide, int x, int y, int width, int height) {
  const StyImage *image = guide->image;
  const int right = x + width < image->width ? x + width : image->width;
  const int top = y > 0 ? y : 0, bottom = y + height < image->height ? y + height : image->height;
  for (int p = 0; p < guide->plane_count; p++)
    for (int row = top; row < bottom; row++) {
      float *values = guide->planes[p].values + (size_t)row * (size_t)image->width;
      for (int column = x; column < right; column++) values[column] = guide->planes[p].miss;
    }
}
