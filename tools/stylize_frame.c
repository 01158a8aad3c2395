#include "stylize_frame.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "inputs.h"
#include "passes.h"
#include "stylut/image_io.h"
#include "stylut/match.h"
#include "stylut/measure.h"

/* ---- what is read ----------------------------------------------------------------- */

/* 0 stands for "as the guide's style.I says". */
static StyStatus choose_style(const Request *request, const StyImage *guide, int *style, StyError *error) {
  if (request->style) return sty_find_style("--style", request->style, request->loaded, style, error);
  *style = sty_find_channel(guide, "style.I") ? 0 : 1;
  return STY_OK;
}

/* Channels that styles go by, and what for. */
static const char *const channels[REVIEW_EMPTY] = {"luma.Y, which chooses among lightings", "albedo, which colours",
                                                   "depth.Z, at which blending stops",
                                                   "object.I, at which blending stops"};

static void find_lacking(const Request *request, const StyFrame *frame, int lacking[REVIEW_EMPTY]) {
  const int styles = (int)request->bundle->textures[STY_BUNDLE_PARAMS].width;
  for (int style = frame->styles ? 1 : frame->style; style <= (frame->styles ? styles : frame->style); style++) {
    StyStyle values;
    if (sty_get_style(request->bundle, style, &values)) continue;
    const bool lacks[REVIEW_EMPTY] = {[REVIEW_LUMA] = values.layer_count > 1 && !frame->luma,
                                      [REVIEW_ALBEDO] = values.colour_weight > 0 && !frame->albedo,
                                      [REVIEW_DEPTH] = values.depth_tolerance > 0 && !frame->depth,
                                      [REVIEW_OBJECT] = values.flags & STY_FLAG_OBJECTS && !frame->objects};
    for (int i = 0; i < REVIEW_EMPTY; i++)
      if (lacks[i] && !lacking[i]) lacking[i] = style;
  }
}

static StyStatus copy_motion(const StyImage *guide, Work *work, StyError *error) {
  const float *u = sty_find_channel(guide, "motion.U"), *v = sty_find_channel(guide, "motion.V");
  const size_t pixels = sty_count_pixels(guide);
  if (!u || !v) return STY_OK;
  work->motion = malloc(2 * pixels * sizeof *work->motion);
  if (!work->motion) return sty_fail_memory(error, "motion", (double)pixels * 8);
  memcpy(work->motion, u, pixels * sizeof *u);
  memcpy(work->motion + pixels, v, pixels * sizeof *v);
  return STY_OK;
}

static StyStatus set_size(const Request *request, const FrameFiles *files, Work *work, StyError *error) {
  StyFrame *frame = &work->filled.frame;
  work->width = frame->width;
  work->height = frame->height;
  if (request->resolution != RESOLUTION_DOUBLE) return STY_OK;
  if (frame->width % 2 || frame->height % 2)
    return sty_fail(error, STY_ERROR_INPUT, "%s: found %dx%d pixels, expected even sides for --resolution double",
                    files->guide, frame->width, frame->height);
  frame->resolution = 1;
  work->width /= 2;
  work->height /= 2;
  return STY_OK;
}

static StyStatus fill_work(const Request *request, const FrameFiles *files, const StyImage *guide, Work *work,
                           StyError *error) {
  int style = 0;
  StyStatus status = choose_style(request, guide, &style, error);
  if (!status) status = fill_frame(files->guide, guide, style, &work->filled, error);
  if (!status) status = set_size(request, files, work, error);
  if (!status)
    status =
        place_anchors(request->anchors, request->pivots, files->guide, guide, files->number, 1, &work->anchors, error);
  if (!status) status = copy_motion(guide, work, error);
  if (status) return status;
  StyFrame *frame = &work->filled.frame;
  frame->anchors = work->anchors.places;
  frame->anchor_count = work->anchors.count;
  frame->number = files->number;
  frame->path = request->path;
  find_lacking(request, frame, work->lacking);
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  work->matches = malloc(pixels * sizeof *work->matches);
  work->picture = malloc(pixels * 4 * (size_t)request->bits / 8);
  if (!work->matches || !work->picture) return sty_fail_memory(error, "picture", (double)pixels * 16);
  return STY_OK;
}

StyStatus open_work(const Request *request, const FrameFiles *files, Work *out, StyError *error) {
  const double start = sty_get_milliseconds();
  StyImage *guide = NULL;
  Work work = {.motion = NULL};
  StyStatus status = read_guide(request->options, files->guide, &guide, error);
  if (!status) status = fill_work(request, files, guide, &work, error);
  sty_destroy_image(&guide);
  if (status) {
    close_work(&work);
    return status;
  }
  work.times[0] = sty_get_milliseconds() - start;
  *out = work;
  return STY_OK;
}

void close_work(Work *work) {
  free_frame(&work->filled);
  free(work->anchors.places);
  free(work->motion);
  free(work->matches);
  free(work->picture);
  *work = (Work){.motion = NULL};
}

/* ---- what is drawn ---------------------------------------------------------------- */

/* Every second pixel of every second row of `count` values of `size` bytes each. */
static void *take_half(const void *values, const StyFrame *frame, size_t size, bool *failed) {
  const size_t width = ((size_t)frame->width + 1) / 2, height = ((size_t)frame->height + 1) / 2;
  char *half = values ? malloc(width * height * size) : NULL;
  *failed |= values && !half;
  for (size_t y = 0; half && y < height; y++)
    for (size_t x = 0; x < width; x++)
      memcpy(half + (y * width + x) * size, (const char *)values + (2 * y * (size_t)frame->width + 2 * x) * size, size);
  return half;
}

/* Anchors of half a frame are half as far. */
static StyStatus open_half(const Work *work, FilledFrame *half, Anchors *anchors, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  bool failed = false;
  *half = (FilledFrame){.frame = *frame};
  half->guide = take_half(frame->guide, frame, 4, &failed);
  half->styles = take_half(frame->styles, frame, 1, &failed);
  half->luma = take_half(frame->luma, frame, 1, &failed);
  half->objects = take_half(frame->objects, frame, sizeof *frame->objects, &failed);
  half->fine = take_half(frame->fine, frame, 2 * sizeof *frame->fine, &failed);
  *anchors = (Anchors){.count = work->anchors.count};
  if (work->anchors.places) {
    anchors->places = malloc(2 * (size_t)anchors->count * sizeof *anchors->places + 1);
    failed |= !anchors->places;
    for (int i = 0; anchors->places && i < 2 * anchors->count; i++)
      anchors->places[i] = (int32_t)((work->anchors.places[i] - (work->anchors.places[i] < 0)) / 2);
  }
  half->frame.guide = half->guide;
  half->frame.styles = half->styles;
  half->frame.luma = half->luma;
  half->frame.objects = half->objects;
  half->frame.fine = half->fine;
  half->frame.depth = NULL;
  half->frame.albedo = NULL;
  half->frame.anchors = anchors->places;
  half->frame.width = (frame->width + 1) / 2;
  half->frame.height = (frame->height + 1) / 2;
  half->frame.resolution = frame->resolution - 1;
  return failed ? sty_fail_memory(error, "half frame", (double)frame->width * frame->height * 4) : STY_OK;
}

typedef struct Expansion {
  const StyBundle *bundle;
  const StyFrame *half, *frame;
  const StyMatch *half_matches;
  StyMatch *matches;
} Expansion;

static StyRuntimeStatus expand_rect(void *context, StyRect rect) {
  const Expansion *expansion = context;
  return sty_expand_matches(expansion->bundle, expansion->half, expansion->half_matches, expansion->frame, rect,
                            expansion->matches);
}

static StyStatus transfer_by_half(const Request *request, Work *work, const StyRun *run, StyError *error) {
  FilledFrame half;
  Anchors anchors;
  StyMatch *matches = NULL;
  StyStatus status = open_half(work, &half, &anchors, error);
  if (!status) matches = malloc((size_t)half.frame.width * (size_t)half.frame.height * sizeof *matches);
  if (!status && !matches) status = sty_fail_memory(error, "half frame", 0);
  if (!status) status = transfer_frame(request->bundle, &half.frame, matches, run, error);
  const StyFrame *frame = &work->filled.frame;
  Expansion expansion = {request->bundle, &half.frame, frame, matches, work->matches};
  if (!status) status = pass_rects(frame->width, frame->height, expand_rect, &expansion, run, error);
  free(matches);
  free(anchors.places);
  free_frame(&half);
  return status;
}

static StyRuntimeStatus look_up_rect(void *context, StyRect rect) {
  const Expansion *look_up = context;
  return sty_look_up_frame(look_up->bundle, look_up->frame, rect, look_up->matches);
}

/* A search per chunk over the whole source: more than so many steps are hours. */
static const double most_brute_steps = 68719476736.0; /* 2^36: 512 x 512 pixels of either */

static StyStatus transfer_by_force(const Request *request, const FrameFiles *files, Work *work, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  const StyTexture *source = &request->bundle->textures[STY_BUNDLE_GUIDES];
  if ((double)frame->width * frame->height * source->width * source->height > most_brute_steps)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: found %dx%d pixels for a source of %ux%u, expected at most 2^36 pairs of them for --method "
                    "brute",
                    files->guide, frame->width, frame->height, source->width, source->height);
  const StyRuntimeStatus status = sty_transfer_brute(request->bundle, frame, work->matches);
  return status ? sty_fail(error, STY_ERROR_LIBRARY, "runtime: %s", sty_describe_runtime_status(status)) : STY_OK;
}

static StyStatus transfer_work(const Request *request, const FrameFiles *files, Work *work, const StyRun *run,
                               StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  Expansion look_up = {.bundle = request->bundle, .frame = frame, .matches = work->matches};
  if (request->method == METHOD_BRUTE) return transfer_by_force(request, files, work, error);
  if (request->method == METHOD_LIT_SPHERE)
    return pass_rects(frame->width, frame->height, look_up_rect, &look_up, run, error);
  if (request->resolution == RESOLUTION_HALF) return transfer_by_half(request, work, run, error);
  return transfer_frame(request->bundle, frame, work->matches, run, error);
}

typedef struct Halving {
  int width, height, bits;
  const void *picture;
  void *out;
} Halving;

static StyRuntimeStatus halve_rect(void *context, StyRect rect) {
  const Halving *halving = context;
  return sty_halve_picture(halving->width, halving->height, halving->bits, halving->picture, rect, halving->out);
}

static StyStatus halve_work(const Request *request, Work *work, const StyRun *run, StyError *error) {
  void *smaller = malloc((size_t)work->width * (size_t)work->height * 4 * (size_t)request->bits / 8);
  if (!smaller) return sty_fail_memory(error, "picture", 0);
  Halving halving = {work->width, work->height, request->bits, work->picture, smaller};
  const StyStatus status = pass_rects(work->width, work->height, halve_rect, &halving, run, error);
  free(work->picture);
  work->picture = smaller;
  return status;
}

/* Of a guide of twice the picture's size, one pixel in four: the picture's are counted. */
static void count_pixels(Work *work) {
  const StyFrame *frame = &work->filled.frame;
  const int step = frame->width / work->width;
  work->unnamed = work->filled.foreign_styles;
  for (int y = 0; y < frame->height; y += step)
    for (int x = 0; x < frame->width; x += step) {
      const size_t i = (size_t)y * (size_t)frame->width + (size_t)x;
      const uint8_t level = work->matches[i].level;
      work->covered += level != STY_LEVEL_NONE;
      work->fallback += level == STY_LEVEL_FALLBACK;
      work->unnamed += frame->styles && frame->styles[i] && frame->guide[4 * i + 3] > 0 && level == STY_LEVEL_NONE;
    }
}

StyStatus draw_work(const Request *request, const FrameFiles *files, Work *work, const StyRun *run, StyError *error) {
  const double start = sty_get_milliseconds();
  sty_begin_stage(run, "transfer");
  StyStatus status = transfer_work(request, files, work, run, error);
  const double transferred = sty_get_milliseconds();
  sty_begin_stage(run, "blend");
  if (!status)
    status = blend_frame(request->bundle, &work->filled.frame, work->matches, request->bits, work->picture, run, error);
  if (!status && request->resolution == RESOLUTION_DOUBLE) status = halve_work(request, work, run, error);
  work->times[1] = transferred - start;
  work->times[2] = sty_get_milliseconds() - transferred;
  if (!status) count_pixels(work);
  return status;
}

/* Share of pixels without a piece: no exemplar is that poor in directions. */
static const double hopeless = 0.5;

/* Of each kind the first is told, the others are counted. */
static bool is_news(Review *review, ReviewKind kind) { return review->counts[kind]++ == 0; }

void review_channels(const Request *request, const FrameFiles *files, const Work *work, Review *review) {
  for (int i = 0; i < REVIEW_EMPTY; i++)
    if (work->lacking[i] && is_news(review, (ReviewKind)i))
      warn(request->options, "%s: found no channel %s, expected it for style '%s'", clean_text(files->guide),
           channels[i], clean_text(sty_get_style_name(request->loaded, work->lacking[i])));
}

void review_work(const Request *request, const FrameFiles *files, const Work *work, Review *review) {
  const double share = work->covered ? (double)work->fallback / (double)work->covered : 0;
  review_channels(request, files, work, review);
  if (work->filled.foreign_objects && is_news(review, REVIEW_OBJECTS))
    warn(request->options, "%s: found %zu pixels whose object.I is no whole number up to 65535, expected one",
         clean_text(files->guide), work->filled.foreign_objects);
  if (!work->covered && !work->unnamed && is_news(review, REVIEW_EMPTY))
    warn(request->options, "%s: found no covered pixel, expected a frame that shows something",
         clean_text(files->guide));
  if (request->method == METHOD_STYLEBLIT && share > hopeless && is_news(review, REVIEW_HOPELESS))
    warn(request->options,
         "%s: found no piece of the exemplar that fits %.1f %% of the pixels, expected a frame of the convention of "
         "the bundle's guide, or a larger threshold",
         clean_text(files->guide), 100 * share);
  if (work->unnamed && is_news(review, REVIEW_UNNAMED))
    warn(request->options, "%s: found %zu pixels whose style.I the bundle has no style for, expected 1 to %u, or 0",
         clean_text(files->guide), work->unnamed,
         request->bundle->textures[STY_BUNDLE_GUIDES].layers < 255 ? request->bundle->textures[STY_BUNDLE_GUIDES].layers
                                                                   : 255);
}

void end_review(const Request *request, const char *guide, const Review *review) {
  static const char *const kinds[REVIEW_KINDS] = {"no luma.Y",          "no albedo",
                                                  "no depth.Z",         "no object.I",
                                                  "no covered pixel",   "no piece that fits most pixels",
                                                  "pixels of no style", "object.I out of range"};
  for (int i = 0; i < REVIEW_KINDS; i++)
    if (review->counts[i] > 1)
      warn(request->options, "%s: found %s in %d more frame%s", clean_text(guide), kinds[i], review->counts[i] - 1,
           review->counts[i] > 2 ? "s" : "");
}

/* ---- what is written -------------------------------------------------------------- */

typedef float GetComponent(const Request *request, const Work *work, size_t pixel, int channel);

static StyStatus draw_rgba(const Request *request, const Work *work, int width, int height, int bits, GetComponent *get,
                           StyImage **out, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *image = NULL;
  const StyStatus status = sty_create_image(width, height, 4, names, bits, &image, error);
  if (status) return status;
  const size_t pixels = sty_count_pixels(image);
  for (int c = 0; c < 4; c++)
    for (size_t i = 0; i < pixels; i++)
      image->data[(size_t)c * pixels + i] = get(request, work, i, c) / (bits == 8 ? 255.0f : 65535.0f);
  *out = image;
  return STY_OK;
}

static float get_picture(const Request *request, const Work *work, size_t pixel, int channel) {
  const size_t i = 4 * pixel + (size_t)channel;
  return request->bits == 8 ? (float)((const uint8_t *)work->picture)[i] : (float)((const uint16_t *)work->picture)[i];
}

/* Pixels of one chunk share the offset between picture and source. */
static float get_chunk(const Request *request, const Work *work, size_t pixel, int channel) {
  const StyMatch *match = &work->matches[pixel];
  const size_t width = (size_t)work->filled.frame.width;
  (void)request;
  if (match->level == STY_LEVEL_NONE) return 0;
  if (channel == 3) return 255;
  const uint32_t dx = (uint32_t)match->x - (uint32_t)(pixel % width);
  const uint32_t dy = (uint32_t)match->y - (uint32_t)(pixel / width);
  uint32_t hash = dx * 0x9e3779b1u ^ dy * 0x85ebca6bu;
  hash = (hash ^ hash >> 15) * 0x2c1b3c6du;
  hash ^= hash >> 13;
  return (float)(64 + (hash >> 8 * channel & 255) * 3 / 4);
}

typedef StyStatus DrawOutput(const Request *request, const Work *work, StyImage **out, StyError *error);

static StyStatus draw_picture(const Request *request, const Work *work, StyImage **out, StyError *error) {
  return draw_rgba(request, work, work->width, work->height, request->bits, get_picture, out, error);
}

static StyStatus draw_chunks(const Request *request, const Work *work, StyImage **out, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  return draw_rgba(request, work, frame->width, frame->height, 8, get_chunk, out, error);
}

static StyStatus draw_field(const Request *request, const Work *work, StyImage **out, StyError *error) {
  const StyTexture *source = &request->bundle->textures[STY_BUNDLE_GUIDES];
  const StyFrame *frame = &work->filled.frame;
  StyField *field = NULL;
  StyStatus status =
      sty_create_field(frame->width, frame->height, (int)source->width, (int)source->height, &field, error);
  if (status) return status;
  for (size_t i = 0; i < (size_t)field->width * (size_t)field->height; i++)
    if (work->matches[i].level != STY_LEVEL_NONE)
      field->pixels[i] = work->matches[i].y * source->width + work->matches[i].x;
  status = sty_encode_field(field, 16, out, error);
  sty_destroy_field(&field);
  return status;
}

static StyStatus draw_flat(const Request *request, const Work *work, StyImage **out, StyError *error) {
  static const char *const names[] = {"Y"};
  const StyFrame *frame = &work->filled.frame;
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  (void)request;
  uint8_t *mask = malloc(pixels);
  if (!mask) return sty_fail_memory(error, "flat areas", (double)pixels);
  const StyStatus status = sty_create_image(frame->width, frame->height, 1, names, 8, out, error);
  if (!status) sty_mark_flat(&(StyShot){.width = frame->width, .height = frame->height, .guide = frame->guide}, mask);
  for (size_t i = 0; !status && i < pixels; i++) (*out)->data[i] = mask[i] ? 1 : 0;
  free(mask);
  return status;
}

/* Which of the frame's pictures this is, into its metadata. */
static StyStatus record_kind(int kind, StyImage *image, StyError *error) {
  static const char *const kinds[OUTPUTS] = {"picture", "nnf", "chunks", "flat"};
  return sty_set_attribute(image, "stylut:shows", kinds[kind], error);
}

/* How the frame came about, the same. */
static StyStatus record(const Request *request, const FrameFiles *files, StyImage *image, StyError *error) {
  char *index = sty_join_path(request->bundle_path, STY_BUNDLE_INDEX);
  const char *const inputs[] = {files->guide, index, request->anchors->pivots};
  const StyStatus status =
      index ? add_history(request->options, "stylize", image, inputs, request->anchors->pivots ? 3 : 2, error)
            : sty_fail_memory(error, "history", 0);
  free(index);
  return status;
}

static StyStatus prepare_output(const Request *request, const FrameFiles *files, int kind, const Work *work,
                                StyOutput *out, StyError *error) {
  static DrawOutput *const draw[OUTPUTS] = {draw_picture, draw_field, draw_chunks, draw_flat};
  StyImage *image = NULL;
  StyStatus status = draw[kind](request, work, &image, error);
  if (status) return status;
  status = record(request, files, image, error);
  if (!status && !request->options->no_history) status = record_kind(kind, image, error);
  if (!status) status = sty_prepare_image(files->outputs[kind], image, out, error);
  sty_destroy_image(&image);
  return status;
}

StyStatus write_work(const Request *request, const FrameFiles *files, Work *work, StyError *error) {
  const double start = sty_get_milliseconds();
  StyOutput outputs[OUTPUTS];
  int count = 0;
  StyStatus status = STY_OK;
  for (int i = 0; !status && i < OUTPUTS; i++) {
    if (!files->outputs[i]) continue;
    status = prepare_output(request, files, i, work, &outputs[count], error);
    count += !status;
  }
  for (int i = 0; i < count; i++) {
    if (status)
      sty_discard_output(&outputs[i]);
    else
      status = sty_commit_output(&outputs[i], error);
  }
  work->times[3] = sty_get_milliseconds() - start;
  return status;
}

static bool has_history(const char *path, const StyImage *wanted) {
  StyImage *found = NULL;
  if (access(path, R_OK) != 0 || sty_read_image(path, &found, NULL)) return false;
  bool is_same = true;
  for (int i = 0; is_same && i < wanted->attribute_count; i++) {
    const char *value = sty_find_attribute(found, wanted->attributes[i].name);
    is_same = value && strcmp(value, wanted->attributes[i].value) == 0;
  }
  sty_destroy_image(&found);
  return is_same;
}

bool is_kept(const Request *request, const FrameFiles *files) {
  static const char *const names[] = {"A"};
  StyImage *wanted = NULL;
  if (request->options->no_history || access(files->outputs[OUTPUT_PICTURE], R_OK) != 0) return false;
  if (sty_create_image(1, 1, 1, names, 8, &wanted, NULL)) return false;
  bool is_same = !record(request, files, wanted, NULL);
  for (int i = 0; is_same && i < OUTPUTS; i++)
    is_same = !files->outputs[i] || (!record_kind(i, wanted, NULL) && has_history(files->outputs[i], wanted));
  sty_destroy_image(&wanted);
  return is_same;
}
