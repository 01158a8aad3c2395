#include "guide/channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define LANE(field) (int)(offsetof(StySamples, field) / sizeof(StyLane))

const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT] = {
    {STY_GUIDE_NORMAL, "normal", 3, {"normal.X", "normal.Y", "normal.Z"}, 0, LANE(normal)},
    {STY_GUIDE_DEPTH, "depth", 1, {"depth.Z"}, INFINITY, LANE(depth)},
    {STY_GUIDE_POSITION, "position", 3, {"position.X", "position.Y", "position.Z"}, 0, LANE(position)},
    {STY_GUIDE_OBJECT, "object", 1, {"object.I"}, 0, LANE(object)},
    {STY_GUIDE_STYLE, "style", 1, {"style.I"}, 0, LANE(style)},
    {STY_GUIDE_UV, "uv", 2, {"uv.U", "uv.V"}, 0, LANE(uv)},
    {STY_GUIDE_ALBEDO, "albedo", 3, {"albedo.R", "albedo.G", "albedo.B"}, 0, LANE(albedo)},
    {STY_GUIDE_LUMA, "luma", 1, {"luma.Y"}, 0, LANE(luma)},
    {STY_GUIDE_CURVATURE, "curvature", 1, {"curvature.Y"}, 0, LANE(curvature)},
    {STY_GUIDE_CONTOUR, "contour", 1, {"contour.Y"}, 0, 0},
    {STY_GUIDE_MOTION, "motion", 2, {"motion.U", "motion.V"}, 0, LANE(motion)},
    {STY_GUIDE_FULL, "full", 3, {"full.R", "full.G", "full.B"}, 0, LANE(paths.full)},
    {STY_GUIDE_LDE, "LDE", 3, {"LDE.R", "LDE.G", "LDE.B"}, 0, LANE(paths.lde)},
    {STY_GUIDE_LSE, "LSE", 3, {"LSE.R", "LSE.G", "LSE.B"}, 0, LANE(paths.lse)},
    {STY_GUIDE_LD12E, "LD12E", 3, {"LD12E.R", "LD12E.G", "LD12E.B"}, 0, LANE(paths.ld12e)},
    {STY_GUIDE_LIE, "LIE", 3, {"LIE.R", "LIE.G", "LIE.B"}, 0, LANE(paths.lie)},
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

StyChannels sty_list_channels(unsigned groups) {
  StyChannels list = {1, {{"A", LANE(coverage), 0}}};
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const StyChannelGroupInfo *info = &STY_CHANNEL_GROUPS[g];
    if (!(groups & ~(unsigned)STY_GUIDE_CONTOUR & info->group)) continue;
    for (int c = 0; c < info->count; c++)
      list.channels[list.count++] = (struct StySampledChannel){info->channels[c], info->lane + c, info->miss};
  }
  return list;
}

StyGuide sty_view_guide(StyImage *image, unsigned groups) {
  StyGuide guide = {.image = image, .channels = sty_list_channels(groups)};
  for (int c = 0; c < guide.channels.count; c++)
    guide.planes[c] = sty_find_channel(image, guide.channels.channels[c].name);
  return guide;
}

StyStatus sty_create_guide(int width, int height, unsigned groups, StyGuide *out, StyError *error) {
  if (groups & ~get_all_groups())
    return sty_fail(error, STY_ERROR_USAGE, "guide channels: found the unknown set 0x%x", groups);
  const char *names[STY_GUIDE_CHANNELS] = {"A"};
  int count = 1;
  for (int g = 0; g < STY_GROUP_COUNT; g++)
    for (int c = 0; groups & STY_CHANNEL_GROUPS[g].group && c < STY_CHANNEL_GROUPS[g].count; c++)
      names[count++] = STY_CHANNEL_GROUPS[g].channels[c];
  StyImage *image = NULL;
  const StyStatus status = sty_create_image(width, height, count, names, 32, &image, error);
  if (status == STY_OK) *out = sty_view_guide(image, groups);
  return status;
}

void sty_clear_strip(const StyChannels *channels, StyStrip *strip) {
  for (int c = 0; c < channels->count; c++) {
    float *values = strip->values[channels->channels[c].lane][0];
    for (int i = 0; i < STY_BLOCK_HEIGHT * STY_STRIP_WIDTH; i++) values[i] = channels->channels[c].miss;
  }
}

#ifdef __SSE2__
static void stream_value(float *to, const float *from) {
  int bits;
  memcpy(&bits, from, sizeof bits);
  _mm_stream_si32((int *)(void *)to, bits);
}

/* Past the caches: what a guide's memory held before isn't read first, which would take longer than the writing. */
static void put_values(float *to, const float *from, size_t count) {
  size_t i = 0;
  for (; i < count && (uintptr_t)(to + i) % 16; i++) stream_value(to + i, from + i);
  for (; i + 4 <= count; i += 4) _mm_stream_ps(to + i, _mm_loadu_ps(from + i));
  for (; i < count; i++) stream_value(to + i, from + i);
}

void sty_finish_strips(void) { _mm_sfence(); }
#else
static void put_values(float *to, const float *from, size_t count) { memcpy(to, from, count * sizeof *to); }

void sty_finish_strips(void) {}
#endif

void sty_write_strip(const StyStrip *strip, int x, int y, const StyGuide *guide) {
  const size_t width = (size_t)guide->image->width, rest = width - (size_t)x;
  const size_t count = rest < STY_STRIP_WIDTH ? rest : STY_STRIP_WIDTH;
  for (int c = 0; c < guide->channels.count; c++)
    for (int row = 0; row < STY_BLOCK_HEIGHT && y + row < guide->image->height; row++)
      put_values(guide->planes[c] + (size_t)(y + row) * width + (size_t)x,
                 strip->values[guide->channels.channels[c].lane][row], count);
}
