#include "guide/flow_pyramid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static StyStatus create_picture(int width, int height, int margin, StyFlowPicture *out, StyError *error) {
  const size_t side = (size_t)width + 2 * (size_t)margin;
  const size_t bytes = side * ((size_t)height + 2 * (size_t)margin) * sizeof(StyLanes);
  *out = (StyFlowPicture){width, height, margin, (ptrdiff_t)side, malloc(bytes), NULL};
  if (!out->memory) return sty_fail_memory(error, "flow pyramid", (double)bytes);
  out->first = out->memory + margin * out->stride + margin;
  return STY_OK;
}

static StyStatus create_level(int index, int width, int height, int margin, StyFlowLevel *out, StyError *error) {
  const size_t count = (size_t)width * (size_t)height;
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < 2; i++) status = create_picture(width, height, margin, &out->pictures[i], error);
  if (status) return status;
  out->index = index;
  out->covered = calloc(count, 1);
  out->vectors = calloc(count, sizeof *out->vectors);
  out->spare = calloc(count, sizeof *out->spare);
  if (out->covered && out->vectors && out->spare) return STY_OK;
  return sty_fail_memory(error, "flow", (double)count * 2 * sizeof *out->vectors);
}

static StyLanes *get_row(const StyFlowPicture *picture, int y) { return picture->first + y * picture->stride; }

static void extend_border(const StyFlowPicture *picture) {
  const int margin = picture->margin, height = picture->height;
  const size_t row = (size_t)picture->stride * sizeof(StyLanes);
  for (int y = 0; y < height; y++) {
    StyLanes *first = get_row(picture, y), *last = first + picture->width - 1;
    for (int m = 1; m <= margin; m++) {
      first[-m] = *first;
      last[m] = *last;
    }
  }
  for (int m = 1; m <= margin; m++) {
    memcpy(get_row(picture, -m) - margin, get_row(picture, 0) - margin, row);
    memcpy(get_row(picture, height - 1 + m) - margin, get_row(picture, height - 1) - margin, row);
  }
}

static StyStatus check_value(const char *name, const StyImage *image, size_t p, float value, StyError *error) {
  if (fabsf(value) <= STY_FLOW_MOST_VALUE) return STY_OK;
  return sty_fail(error, STY_ERROR_INPUT, "%s: found %g at pixel (%zu, %zu), expected numbers within %g", name,
                  (double)value, p % (size_t)image->width, p / (size_t)image->width, (double)STY_FLOW_MOST_VALUE);
}

static StyStatus fill_picture(const char *name, const StyImage *image, const float *const *planes, int lanes,
                              const StyFlowPicture *picture, unsigned char *covered, StyError *error) {
  const float *alpha = sty_find_channel(image, "A");
  StyStatus status = STY_OK;
  size_t p = 0;
  for (int y = 0; !status && y < image->height; y++) {
    StyLanes *at = get_row(picture, y);
    for (int x = 0; !status && x < image->width; x++, p++) {
      const bool is_covered = !alpha || alpha[p] > 0;
      if (covered) covered[p] = is_covered;
      if (alpha) status = check_value(name, image, p, alpha[p], error);
      for (int c = 0; c < STY_LANES; c++) {
        at[x][c] = c < lanes && is_covered ? planes[c][p] : 0;
        if (!status) status = check_value(name, image, p, at[x][c], error);
      }
    }
  }
  return status;
}

/* Equation 4.2; where a side is odd, the last pixel is the mean of those that are there. */
static void halve_by_box(const StyFlowPicture *fine, const StyFlowPicture *coarse) {
  for (int y = 0; y < coarse->height; y++) {
    const int below = 2 * y + 1 < fine->height ? 2 * y + 1 : 2 * y;
    const StyLanes *upper = get_row(fine, 2 * y), *lower = get_row(fine, below);
    StyLanes *at = get_row(coarse, y);
    for (int x = 0; x < coarse->width; x++) {
      const int left = 2 * x, right = left + 1 < fine->width ? left + 1 : left;
      at[x] = 0.25f * ((upper[left] + upper[right]) + (lower[left] + lower[right]));
    }
  }
}

/* Over 4x4 pixels, weights 1 3 3 1: a box lets details through that look different on the coarser
 * level wherever they moved by anything but its whole pixels. */
static void halve_smoothly(const StyFlowPicture *fine, const StyFlowPicture *coarse) {
  for (int y = 0; y < coarse->height; y++) {
    StyLanes *at = get_row(coarse, y);
    for (int x = 0; x < coarse->width; x++) {
      StyLanes rows[4];
      for (int j = 0; j < 4; j++) {
        const StyLanes *p = sty_get_flow_pixel(fine, 2 * x - 1, 2 * y - 1 + j);
        rows[j] = 0.125f * (p[0] + p[3]) + 0.375f * (p[1] + p[2]);
      }
      at[x] = 0.125f * (rows[0] + rows[3]) + 0.375f * (rows[1] + rows[2]);
    }
  }
}

static void halve_coverage(const StyFlowLevel *fine, const StyFlowLevel *coarse) {
  const int width = fine->pictures[0].width, coarse_width = coarse->pictures[0].width;
  for (int y = 0; y < fine->pictures[0].height; y++)
    for (int x = 0; x < width; x++)
      if (fine->covered[(size_t)y * (size_t)width + (size_t)x])
        coarse->covered[(size_t)(y / 2) * (size_t)coarse_width + (size_t)(x / 2)] = 1;
}

/* Down to a longer side below 16 pixels: then a window is most of the picture. */
int sty_count_flow_levels(int width, int height, int wanted) {
  const int least = wanted ? 2 : 16; /* longer side of a level that has one below */
  const int most = wanted ? wanted : STY_FLOW_MOST_LEVELS;
  int count = 1;
  for (int side = width > height ? width : height; count < most && side >= least; count++) side = (side + 1) / 2;
  return count;
}

StyStatus sty_build_flow_pyramid(const char *const names[2], const StyImage *const images[2],
                                 const float *planes[2][STY_FLOW_MOST_CHANNELS], int lanes, int levels, int margin,
                                 bool smooth, StyFlowPyramid *out, StyError *error) {
  int width = images[0]->width, height = images[0]->height;
  StyStatus status = STY_OK;
  *out = (StyFlowPyramid){.count = levels, .lanes = lanes};
  for (int l = 0; !status && l < out->count; l++) {
    StyFlowLevel *level = &out->levels[l];
    status = create_level(l, width, height, margin, level, error);
    for (int i = 0; !status && i < 2; i++) {
      if (l == 0)
        status =
            fill_picture(names[i], images[i], planes[i], lanes, &level->pictures[i], i ? NULL : level->covered, error);
      else
        (smooth ? halve_smoothly : halve_by_box)(&level[-1].pictures[i], &level->pictures[i]);
      if (!status) extend_border(&level->pictures[i]);
    }
    if (!status && l > 0) halve_coverage(level - 1, level);
    width = (width + 1) / 2;
    height = (height + 1) / 2;
  }
  return status;
}

void sty_close_flow_pyramid(StyFlowPyramid *pyramid) {
  for (int l = 0; l < pyramid->count; l++) {
    StyFlowLevel *level = &pyramid->levels[l];
    for (int i = 0; i < 2; i++) free(level->pictures[i].memory);
    free(level->covered);
    free(level->vectors);
    free(level->spare);
  }
  *pyramid = (StyFlowPyramid){0};
}
