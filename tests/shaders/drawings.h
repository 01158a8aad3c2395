/* Toon shading and outlines on a graphics processor beside their twins in C. */
#ifndef STYLUT_TESTS_DRAWINGS_H
#define STYLUT_TESTS_DRAWINGS_H

#include "twins.h"

static inline GLuint upload_pattern(int unit, const StyPattern *pattern) {
  const int width = pattern->texels ? pattern->width : 1, height = pattern->texels ? pattern->height : 1;
  return upload(unit, width, height, 1, pattern->texels);
}

/* ---- toon ---- */

/* toon->jitter is a layer of the bundle's; the frame is the twins', or what it is with a stride. */
static inline void check_toon(const Twins *twins, const StyFrame *frame, int stride, const StyToon *toon,
                              uint8_t *picture) {
  const Gpu *gpu = twins->gpu;
  const ptrdiff_t from_first = toon->jitter - twins->bundle->textures[STY_BUNDLE_JITTER].texels;
  int thresholds[STY_MAX_BANDS - 1];
  for (int i = 0; i < STY_MAX_BANDS - 1; i++) thresholds[i] = toon->thresholds[i];
  require_ok(sty_shade_toon(frame, toon, (StyRect){0, 0, frame->width, frame->height}, 8, picture));
  set_frame(twins, PASS_TOON, frame, stride);
  set_integer(gpu, PASS_TOON, "toon_band_count", toon->band_count);
  set_integers(gpu, PASS_TOON, "toon_thresholds", STY_MAX_BANDS - 1, thresholds);
  set_colours(gpu, PASS_TOON, "toon_colours", STY_MAX_BANDS, toon->colours);
  set_integer(gpu, PASS_TOON, "toon_colour_weight", toon->colour_weight);
  set_integer(gpu, PASS_TOON, "toon_style", toon->style);
  set_integer(gpu, PASS_TOON, "toon_pattern_weight", toon->pattern.texels ? toon->pattern_weight : 0);
  set_integer(gpu, PASS_TOON, "toon_cell_level", toon->cell_level);
  set_integer(gpu, PASS_TOON, "toon_jitter_table", (int)(from_first / (2 * STY_JITTER_SIZE * STY_JITTER_SIZE)));
  set_integer(gpu, PASS_TOON, "toon_jitter_amount", toon->jitter_amount);
  const GLuint pattern = upload_pattern(UNIT_PATTERN, &toon->pattern);
  check_picture(twins, PASS_TOON, frame->width, frame->height, picture);
  glDeleteTextures(1, &pattern);
}

/* ---- outlines ---- */

static inline void set_outline(const Twins *twins, const StyFrame *frame, int stride, const StyOutline *outline) {
  const Gpu *gpu = twins->gpu;
  set_frame(twins, PASS_CONTOURS, frame, stride);
  set_integer(gpu, PASS_CONTOURS, "outline_silhouette_weight", outline->silhouette_weight);
  set_integer(gpu, PASS_CONTOURS, "outline_object_weight", outline->object_weight);
  set_integer(gpu, PASS_CONTOURS, "outline_normal_weight", outline->normal_weight);
  set_integer(gpu, PASS_CONTOURS, "outline_depth_weight", outline->depth_weight);
  set_integer(gpu, PASS_CONTOURS, "outline_normal_tolerance", outline->normal_tolerance);
  set_number(gpu, PASS_CONTOURS, "outline_depth_tolerance", outline->depth_tolerance);
  set_integer(gpu, PASS_CONTOURS, "outline_noise_weight", outline->noise.texels ? outline->noise_weight : 0);
  set_integer(gpu, PASS_CONTOURS, "outline_threshold", outline->threshold);
}

/* Draws into a new texture of `unit`, which stays bound, and compares its one channel. */
static inline GLuint check_plane(const Twins *twins, int pass, int unit, int width, int height, const void *wanted) {
  const bool is_signed = unit == UNIT_COLUMNS;
  const size_t pixels = (size_t)width * (size_t)height;
  void *found = allocate(pixels, 4 * sizeof(int32_t));
  const GLuint target = upload(unit, width, height, 1, NULL);
  draw_pass(twins->gpu, pass, target, unit, width, height, found);
  for (size_t i = 0; i < pixels; i++) {
    const int f = is_signed ? ((const int32_t *)found)[4 * i] : ((const uint8_t *)found)[4 * i];
    const int w = is_signed ? ((const int8_t *)wanted)[i] : ((const uint8_t *)wanted)[i];
    if (f != w)
      give_up("%s/%s: (%zu, %zu) of %dx%d: found %d, expected %d", twins->gpu->dialect, pass_names[pass],
              i % (size_t)width, i / (size_t)width, width, height, f, w);
  }
  free(found);
  return target;
}

static inline void check_contours(const Twins *twins, const StyFrame *frame, int stride, const StyOutline *outline,
                                  uint8_t *contours) {
  require_ok(sty_find_contours(frame, outline, (StyRect){0, 0, frame->width, frame->height}, contours));
  set_outline(twins, frame, stride, outline);
  GLuint textures[2] = {upload_pattern(UNIT_NOISE, &outline->noise)};
  textures[1] = check_plane(twins, PASS_CONTOURS, UNIT_CONTOURS, frame->width, frame->height, contours);
  glDeleteTextures(2, textures);
}

/* The lines of contours; their texture stays bound. */
static inline GLuint check_lines(const Twins *twins, int width, int height, const uint8_t *contours,
                                 const StyLine *line, uint8_t *lines) {
  const Gpu *gpu = twins->gpu;
  const StyRect all = {0, 0, width, height};
  int8_t *columns = allocate((size_t)width * (size_t)height, 1);
  require_ok(sty_measure_columns(width, height, contours, line, all, columns));
  require_ok(sty_draw_lines(width, height, columns, line, all, lines));
  GLuint textures[3] = {upload(UNIT_CONTOURS, width, height, 1, contours), upload_pattern(UNIT_WOBBLE, &line->wobble)};
  for (int pass = PASS_COLUMNS; pass <= PASS_LINES; pass++) {
    set_size(gpu, pass, "frame_size", width, height);
    set_integer(gpu, pass, "line_width", line->width);
  }
  set_integer(gpu, PASS_LINES, "line_wobble_amount", line->wobble.texels ? line->wobble_amount : 0);
  textures[2] = check_plane(twins, PASS_COLUMNS, UNIT_COLUMNS, width, height, columns);
  const GLuint target = check_plane(twins, PASS_LINES, UNIT_LINES, width, height, lines);
  glDeleteTextures(3, textures);
  free(columns);
  return target;
}

/* All four passes; `picture` is what the lines are laid on. */
static inline void check_outline(const Twins *twins, const StyFrame *frame, int stride, const StyOutline *outline,
                                 const StyLine *line, const uint8_t colour[4], int beyond, uint8_t *picture,
                                 uint8_t *lines) {
  const int width = frame->width, height = frame->height;
  uint8_t *contours = allocate((size_t)width * (size_t)height, 1);
  check_contours(twins, frame, stride, outline, contours);
  const GLuint textures[2] = {check_lines(twins, width, height, contours, line, lines),
                              upload(UNIT_BELOW, width, height, 1, picture)};
  require_ok(sty_lay_lines(width, height, lines, colour, beyond, (StyRect){0, 0, width, height}, 8, picture));
  set_colours(twins->gpu, PASS_LAY, "lay_colour", 1, (const uint8_t(*)[4])(const void *)colour);
  set_integer(twins->gpu, PASS_LAY, "lay_beyond", beyond);
  check_picture(twins, PASS_LAY, width, height, picture);
  glDeleteTextures(2, textures);
  free(contours);
}

#endif
