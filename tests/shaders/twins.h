/* Every pass on a graphics processor beside its twin in C. */
#ifndef STYLUT_TESTS_TWINS_H
#define STYLUT_TESTS_TWINS_H

#include "gpu.h"
#include "stylut/runtime.h"

enum { HAS_FINE = 1, HAS_DEPTH = 2, HAS_STYLES = 4, HAS_OBJECTS = 8, HAS_LUMA = 16, HAS_ALBEDO = 32, HAS_ANCHORS = 64 };
enum { ANCHOR_COLUMNS = 256 };

/* One frame of one bundle. */
typedef struct Twins {
  const Gpu *gpu;
  const StyBundle *bundle;
  const StyFrame *frame;
  GLuint textures[UNITS];
} Twins;

static inline int list_inputs(const StyFrame *frame) {
  return (frame->fine ? HAS_FINE : 0) | (frame->depth ? HAS_DEPTH : 0) | (frame->styles ? HAS_STYLES : 0) |
         (frame->objects ? HAS_OBJECTS : 0) | (frame->luma ? HAS_LUMA : 0) | (frame->albedo ? HAS_ALBEDO : 0) |
         (frame->anchors ? HAS_ANCHORS : 0);
}

/* Objects beyond the anchors have 0, 0, as do those beyond the texture. */
static inline GLuint upload_anchors(const StyFrame *frame) {
  const int rows = frame->anchor_count / ANCHOR_COLUMNS + 1;
  int32_t *texels = calloc((size_t)rows * ANCHOR_COLUMNS, 2 * sizeof *texels);
  if (!texels) give_up("no memory for anchors");
  if (frame->anchors) memcpy(texels, frame->anchors, (size_t)frame->anchor_count * 2 * sizeof *texels);
  const GLuint texture = upload(UNIT_ANCHORS, ANCHOR_COLUMNS, rows, 1, texels);
  free(texels);
  return texture;
}

/* What isn't there gets a texture all the same: the renderer would compile a pass anew for each set of empty units. */
static inline Twins open_twins(const Gpu *gpu, const StyBundle *bundle, const StyFrame *frame) {
  Twins twins = {.gpu = gpu, .bundle = bundle, .frame = frame};
  for (int file = 0; file < STY_BUNDLE_FILES; file++) {
    const StyTexture *texture = &bundle->textures[file];
    twins.textures[file] =
        upload(file, (int)texture->width, (int)texture->height, (int)texture->layers, texture->texels);
  }
  const void *const inputs[UNITS] = {
      [UNIT_GUIDE] = frame->guide,   [UNIT_FINE] = frame->fine, [UNIT_DEPTH] = frame->depth,
      [UNIT_STYLES] = frame->styles, [UNIT_LUMA] = frame->luma, [UNIT_OBJECTS] = frame->objects,
      [UNIT_ALBEDO] = frame->albedo, [UNIT_MATCHES] = NULL};
  for (int unit = UNIT_GUIDE; unit <= UNIT_PICTURE; unit++)
    if (unit != UNIT_ANCHORS) twins.textures[unit] = upload(unit, frame->width, frame->height, 1, inputs[unit]);
  twins.textures[UNIT_ANCHORS] = upload_anchors(frame);
  return twins;
}

static inline void close_twins(Twins *twins) { glDeleteTextures(UNIT_PICTURE + 1, twins->textures); }

static inline void set_frame(const Twins *twins, int pass, const StyFrame *frame, int stride) {
  const Gpu *gpu = twins->gpu;
  set_size(gpu, pass, "frame_size", frame->width, frame->height);
  set_integer(gpu, pass, "frame_stride", stride);
  set_integer(gpu, pass, "frame_resolution", frame->resolution);
  set_integer(gpu, pass, "frame_number", frame->number);
  set_integer(gpu, pass, "frame_style", frame->style);
  set_integer(gpu, pass, "frame_inputs", list_inputs(twins->frame));
}

static inline void *allocate(size_t pixels, size_t size) {
  void *values = calloc(pixels, size);
  if (!values) give_up("no memory for %zu pixels", pixels);
  return values;
}

static inline void require_ok(StyRuntimeStatus status) {
  if (status) give_up("%s", sty_describe_runtime_status(status));
}

/* ---- matches ---- */

static inline void expect_matches(const Twins *twins, int pass, const StyFrame *frame, const StyMatch *wanted,
                                  const uint32_t *found) {
  size_t differences = 0, first = 0, pixels = (size_t)frame->width * (size_t)frame->height;
  for (size_t i = 0; i < pixels; i++) {
    const uint32_t *f = found + 4 * i;
    const StyMatch *w = &wanted[i];
    if (f[0] == w->x && f[1] == w->y && f[2] == w->level + 256u * w->layer && f[3] == w->style) continue;
    if (differences++ == 0) first = i;
  }
  const uint32_t *f = found + 4 * first;
  const StyMatch *w = &wanted[first];
  if (differences)
    give_up(
        "%s/%s: %zu of %zu matches differ; at (%zu, %zu) of %dx%d found %u, %u level %u layer %u style %u, expected "
        "%u, %u level %u layer %u style %u",
        twins->gpu->dialect, pass_names[pass], differences, pixels, first % (size_t)frame->width,
        first / (size_t)frame->width, frame->width, frame->height, f[0], f[1], f[2] % 256, f[2] / 256, f[3], w->x, w->y,
        w->level, w->layer, w->style);
}

/* Draws into the texture of `unit`, which stays for later passes. */
static inline void check_matches(const Twins *twins, int pass, int unit, const StyFrame *frame, int stride,
                                 const StyMatch *wanted) {
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  uint32_t *found = allocate(pixels, 4 * sizeof *found);
  set_frame(twins, pass, frame, stride);
  draw_pass(twins->gpu, pass, twins->textures[unit], unit, frame->width, frame->height, found);
  expect_matches(twins, pass, frame, wanted, found);
  free(found);
}

/* Every second pixel of a frame's input, every second row. */
static inline void *take_half(const StyFrame *frame, const void *input, size_t size) {
  const size_t width = (size_t)frame->width, height = (size_t)frame->height, half_width = (width + 1) / 2;
  if (!input) return NULL;
  char *half = allocate(half_width * ((height + 1) / 2), size);
  for (size_t y = 0; y < height; y += 2)
    for (size_t x = 0; x < width; x += 2)
      memcpy(half + (y / 2 * half_width + x / 2) * size, (const char *)input + (y * width + x) * size, size);
  return half;
}

static inline StyFrame take_half_frame(const StyFrame *frame) {
  StyFrame half = *frame;
  half.width = (frame->width + 1) / 2, half.height = (frame->height + 1) / 2, half.resolution--;
  half.guide = take_half(frame, frame->guide, 4), half.fine = take_half(frame, frame->fine, 2 * sizeof *frame->fine);
  half.depth = take_half(frame, frame->depth, sizeof *frame->depth), half.styles = take_half(frame, frame->styles, 1);
  half.objects = take_half(frame, frame->objects, sizeof *frame->objects);
  half.luma = take_half(frame, frame->luma, 1), half.albedo = take_half(frame, frame->albedo, 4);
  return half;
}

static inline void destroy_half_frame(const StyFrame *half) {
  free((void *)half->guide), free((void *)half->fine), free((void *)half->depth), free((void *)half->styles);
  free((void *)half->objects), free((void *)half->luma), free((void *)half->albedo);
}

/* The shader takes every second texel by itself. */
static inline void check_half(const Twins *twins) {
  const StyFrame *frame = twins->frame, half = take_half_frame(frame);
  const StyRect all = {0, 0, frame->width, frame->height}, half_all = {0, 0, half.width, half.height};
  StyMatch *half_matches = allocate((size_t)half.width * (size_t)half.height, sizeof *half_matches);
  StyMatch *matches = allocate((size_t)frame->width * (size_t)frame->height, sizeof *matches);
  require_ok(sty_transfer_frame(twins->bundle, &half, half_all, half_matches));
  require_ok(sty_expand_matches(twins->bundle, &half, half_matches, frame, all, matches));
  check_matches(twins, PASS_TRANSFER, UNIT_HALF_MATCHES, &half, 2, half_matches);
  check_matches(twins, PASS_EXPAND, UNIT_MATCHES, frame, 1, matches);
  free(half_matches), free(matches), destroy_half_frame(&half);
}

/* ---- pictures ---- */

/* Draws into a texture of its own. */
static inline void check_picture(const Twins *twins, int pass, int width, int height, const uint8_t *wanted) {
  const size_t size = 4 * (size_t)width * (size_t)height;
  uint8_t *found = allocate(size, 1);
  GLint bound;
  glActiveTexture(GL_TEXTURE0 + UNIT_PICTURE);
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  const GLuint target = upload(UNIT_PICTURE, width, height, 1, NULL);
  glBindTexture(GL_TEXTURE_2D, (GLuint)bound);
  draw_pass(twins->gpu, pass, target, UNIT_PICTURE, width, height, found);
  for (size_t i = 0; i < size; i++)
    if (found[i] != wanted[i])
      give_up("%s/%s: (%zu, %zu) of %dx%d, channel %zu: found %d, expected %d", twins->gpu->dialect, pass_names[pass],
              i / 4 % (size_t)width, i / 4 / (size_t)width, width, height, i % 4, found[i], wanted[i]);
  glDeleteTextures(1, &target);
  free(found);
}

/* The picture's own pixels, four to one; an odd last row or column is left. */
static inline void check_halve(const Twins *twins, const uint8_t *picture) {
  const StyFrame *frame = twins->frame;
  const int width = frame->width / 2, height = frame->height / 2;
  if (width == 0 || height == 0) return;
  uint8_t *even = allocate((size_t)width * (size_t)height, 16), *wanted = allocate((size_t)width * (size_t)height, 4);
  const size_t row = 8 * (size_t)width;
  for (size_t y = 0; y < 2 * (size_t)height; y++) memcpy(even + y * row, picture + y * 4 * (size_t)frame->width, row);
  const GLuint texture = upload(UNIT_PICTURE, 2 * width, 2 * height, 1, even);
  require_ok(sty_halve_picture(width, height, 8, even, (StyRect){0, 0, width, height}, wanted));
  check_picture(twins, PASS_HALVE, width, height, wanted);
  glDeleteTextures(1, &texture);
  free(even), free(wanted);
}

/* ---- all of it ---- */

/* Ends the program where a pass differs from its twin. matches and picture: of the frame, as C has them. */
static inline void check_passes(const Gpu *gpu, const StyBundle *bundle, const StyFrame *frame, StyMatch *matches,
                                uint8_t *picture) {
  const StyRect all = {0, 0, frame->width, frame->height};
  Twins twins = open_twins(gpu, bundle, frame);
  require_ok(sty_look_up_frame(bundle, frame, all, matches));
  check_matches(&twins, PASS_LOOK_UP, UNIT_MATCHES, frame, 1, matches);
  if (frame->resolution > -1) check_half(&twins);
  require_ok(sty_transfer_frame(bundle, frame, all, matches));
  check_matches(&twins, PASS_TRANSFER, UNIT_MATCHES, frame, 1, matches);
  require_ok(sty_blend_frame(bundle, frame, all, matches, 8, picture));
  set_frame(&twins, PASS_BLEND, frame, 1);
  check_picture(&twins, PASS_BLEND, frame->width, frame->height, picture);
  check_halve(&twins, picture);
  close_twins(&twins);
}

#endif
