#include "guide/channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const StyChannelGroupInfo STY_CHANNEL_GROUPS[STY_GROUP_COUNT] = {
    {STY_GUIDE_NORMAL, "normal", 3, {"normal.X", "normal.Y", "normal.Z"}, 0, offsetof(StySample, normal)},
    {STY_GUIDE_DEPTH, "depth", 1, {"depth.Z"}, INFINITY, offsetof(StySample, depth)},
    {STY_GUIDE_POSITION, "position", 3, {"position.X", "position.Y", "position.Z"}, 0, offsetof(StySample, position)},
    {STY_GUIDE_OBJECT, "object", 1, {"object.I"}, 0, offsetof(StySample, object)},
    {STY_GUIDE_STYLE, "style", 1, {"style.I"}, 0, offsetof(StySample, style)},
    {STY_GUIDE_UV, "uv", 2, {"uv.U", "uv.V"}, 0, offsetof(StySample, uv)},
    {STY_GUIDE_ALBEDO, "albedo", 3, {"albedo.R", "albedo.G", "albedo.B"}, 0, offsetof(StySample, albedo)},
    {STY_GUIDE_LUMA, "luma", 1, {"luma.Y"}, 0, offsetof(StySample, luma)},
    {STY_GUIDE_CURVATURE, "curvature", 1, {"curvature.Y"}, 0, offsetof(StySample, curvature)},
    {STY_GUIDE_CONTOUR, "contour", 1, {"contour.Y"}, 0, offsetof(StySample, contour)},
    {STY_GUIDE_MOTION, "motion", 2, {"motion.U", "motion.V"}, 0, offsetof(StySample, motion)},
};

static unsigned get_all_groups(void) {
  unsigned all = 0;
  for (int g = 0; g < STY_GROUP_COUNT; g++) all |= STY_CHANNEL_GROUPS[g].group;
  return all;
}

/* The group called by the first `length` characters of `text`; 0 for none. */
static unsigned find_group(const char *text, size_t length) {
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const char *name = STY_CHANNEL_GROUPS[g].name;
    if (strlen(name) == length && memcmp(name, text, length) == 0) return STY_CHANNEL_GROUPS[g].group;
  }
  return length == 3 && memcmp(text, "all", 3) == 0 ? get_all_groups() & ~(unsigned)STY_GUIDE_MOTION : 0;
}

static StyStatus fail_group(const char *what, const char *text, size_t length, StyError *error) {
  char names[128] = "";
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const size_t used = strlen(names);
    snprintf(names + used, sizeof names - used, "%s, ", STY_CHANNEL_GROUPS[g].name);
  }
  return sty_fail(error, STY_ERROR_USAGE, "%s: found '%.*s', expected a comma-separated list of %sor all", what,
                  (int)(length < 64 ? length : 64), text, names);
}

StyStatus sty_parse_channels(const char *what, const char *text, unsigned *groups, StyError *error) {
  unsigned found = 0;
  for (const char *at = text;;) {
    const size_t length = strcspn(at, ",");
    const unsigned group = find_group(at, length);
    if (group == 0) return fail_group(what, at, length, error);
    found |= group;
    if (at[length] == '\0') break;
    at += length + 1;
  }
  *groups = found;
  return STY_OK;
}

/* A new image is all zero, which is what most channels say of a miss. */
static void set_misses(const StyGuide *guide) {
  const size_t count = sty_count_pixels(guide->image);
  for (int g = 0; g < guide->group_count; g++)
    for (int c = 0; guide->groups[g].info->miss != 0 && c < guide->groups[g].info->count; c++)
      for (size_t i = 0; i < count; i++) guide->groups[g].planes[c][i] = guide->groups[g].info->miss;
}

StyGuide sty_view_guide(StyImage *image, unsigned groups) {
  StyGuide guide = {.image = image, .coverage = sty_find_channel(image, "A")};
  for (int g = 0; g < STY_GROUP_COUNT; g++) {
    const StyChannelGroupInfo *info = &STY_CHANNEL_GROUPS[g];
    if (!(groups & info->group)) continue;
    struct StyGuidePlanes *group = &guide.groups[guide.group_count++];
    group->info = info;
    for (int c = 0; c < info->count; c++) group->planes[c] = sty_find_channel(image, info->channels[c]);
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
  if (status != STY_OK) return status;
  *out = sty_view_guide(image, groups);
  set_misses(out);
  return STY_OK;
}

void sty_clear_guide(const StyGuide *guide) {
  memset(guide->image->data, 0, (size_t)guide->image->channel_count * sty_count_pixels(guide->image) * sizeof(float));
  set_misses(guide);
}

StyStatus sty_select_channels(StyImage **image, int first, int rows, unsigned groups, StyError *error) {
  StyGuide guide;
  int channels = 1;
  for (int g = 0; g < STY_GROUP_COUNT; g++)
    if (groups & STY_CHANNEL_GROUPS[g].group) channels += STY_CHANNEL_GROUPS[g].count;
  if (rows == (*image)->height && channels == (*image)->channel_count) return STY_OK;
  const StyStatus status = sty_create_guide((*image)->width, rows, groups, &guide, error);
  if (status) return status;
  const size_t count = sty_count_pixels(guide.image), start = (size_t)first * (size_t)guide.image->width;
  for (int c = 0; c < guide.image->channel_count; c++)
    memcpy(guide.image->data + (size_t)c * count, sty_find_channel(*image, guide.image->names[c]) + start,
           count * sizeof(float));
  sty_destroy_image(image);
  *image = guide.image;
  return STY_OK;
}

void sty_set_sample(const StyGuide *guide, size_t pixel, const StySample *sample) {
  guide->coverage[pixel] = 1;
  for (int g = 0; g < guide->group_count; g++) {
    const StyChannelGroupInfo *info = guide->groups[g].info;
    const double *values = (const double *)(const void *)((const char *)sample + info->field);
    for (int c = 0; c < info->count; c++) guide->groups[g].planes[c][pixel] = (float)values[c];
  }
}
