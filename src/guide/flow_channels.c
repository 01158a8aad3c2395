/* Which channels of two pictures a flow compares. */
#include <stdio.h>
#include <string.h>

#include "guide/flow_pyramid.h"

typedef struct Choice {
  const char *const *names;
  const StyImage *const *images;
  const float *(*planes)[STY_FLOW_MOST_CHANNELS];
  int count;
  char *text; /* 256 bytes */
} Choice;

/* A channel that the first picture has must be in the second one, too. */
static StyStatus add_channel(Choice *choice, const char *channel, const float *plane, StyError *error) {
  const float *other = sty_find_channel(choice->images[1], channel);
  if (!other)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found no channel %s, expected it as in %s", choice->names[1], channel,
                    choice->names[0]);
  const size_t used = strlen(choice->text);
  if (choice->count == STY_FLOW_MOST_CHANNELS || used + strlen(channel) + 2 > 256)
    return sty_fail(error, STY_ERROR_USAGE, "channels: found more than %d with %s, expected at most that",
                    STY_FLOW_MOST_CHANNELS, channel);
  snprintf(choice->text + used, 256 - used, "%s%s", used ? "," : "", channel);
  choice->planes[0][choice->count] = plane;
  choice->planes[1][choice->count++] = other;
  return STY_OK;
}

static bool is_named(const char *channel, const char *name, size_t length) {
  if (strncmp(channel, name, length) != 0) return false;
  const bool is_layer = channel[length] == '.' && !memchr(name, '.', length);
  return channel[length] == '\0' || is_layer;
}

/* The channel of this name, or all of the layer, in the order of the first picture. */
static StyStatus add_name(Choice *choice, const char *name, size_t length, StyError *error) {
  const StyImage *image = choice->images[0];
  const int before = choice->count;
  StyStatus status = STY_OK;
  for (int c = 0; !status && c < image->channel_count; c++)
    if (is_named(image->names[c], name, length))
      status = add_channel(choice, image->names[c], image->data + (size_t)c * sty_count_pixels(image), error);
  if (!status && choice->count == before)
    status = sty_fail(error, STY_ERROR_INPUT, "%s: found no channel %.*s, expected one of the channels to be compared",
                      choice->names[0], (int)(length < 64 ? length : 64), name);
  return status;
}

static bool has_name(const StyImage *image, const char *name) {
  for (int c = 0; c < image->channel_count; c++)
    if (is_named(image->names[c], name, strlen(name))) return true;
  return false;
}

/* Colours before what is only part of them. */
static const char *choose_default(const Choice *choice) {
  static const char *const lists[] = {"R,G,B", "full", "Y", "luma.Y", "albedo", "normal"};
  static const char *const first[] = {"R", "full", "Y", "luma.Y", "albedo", "normal"};
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
    if (has_name(choice->images[0], first[i]) && has_name(choice->images[1], first[i])) return lists[i];
  return NULL;
}

StyStatus sty_choose_flow_channels(const char *const names[2], const StyImage *const images[2], const char *list,
                                   const float *planes[2][STY_FLOW_MOST_CHANNELS], int *count, char channels[256],
                                   StyError *error) {
  Choice choice = {names, images, planes, 0, channels};
  StyStatus status = STY_OK;
  channels[0] = '\0';
  if (!list) list = choose_default(&choice);
  if (!list)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s and %s: found no channels in common that show colours, light or normals, expected R,G,B, full, "
                    "Y, luma.Y, albedo or normal, or others to be named",
                    names[0], names[1]);
  for (const char *at = list; !status;) {
    const size_t length = strcspn(at, ",");
    if (length == 0)
      return sty_fail(error, STY_ERROR_USAGE, "channels: found an empty name in '%s', expected names between commas",
                      list);
    status = add_name(&choice, at, length, error);
    if (at[length] == '\0') break;
    at += length + 1;
  }
  *count = choice.count;
  return status;
}
