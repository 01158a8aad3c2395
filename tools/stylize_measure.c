#include "stylize_measure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stylut/measure.h"

/* Figures that have a mean over the frames, by their names and what they are. */
enum { WARP_MEAN, WARP_RMS, JUMPS, SSIM, FLIP, CHUNK_MEAN, CHUNK_WEIGHTED, FALLBACK, FLAT, REPETITION, SHOWN, FIGURES };
static const struct {
  const char *key, *text;
} figures[FIGURES] = {{"warp_mean", "change along the motion, mean |difference|; 0: steady, 1: black to white"},
                      {"warp_rms", "the same, root of the mean square"},
                      {"jumps", "share of pixels whose source pixel is over 4 pixels off the last; 0: steady"},
                      {"ssim", "likeness (SSIM) to the frame before; 1: alike"},
                      {"flip", "difference (FLIP) that an eye sees from the frame before; 0: alike"},
                      {"chunk_mean", "pixels a piece, mean over the pieces"},
                      {"chunk_weighted", "pixels of a pixel's piece, mean over the pixels; more: longer strokes"},
                      {"fallback", "share of pixels that no piece fits, by the table alone; less is better"},
                      {"flat", "share of pixels on flat areas, where a patch may repeat"},
                      {"repetition", "mean peak of autocorrelation there; 0: no pattern, 1: a tiling"},
                      {"shown", "times that a source pixel is shown there; 1: no repetition"}};

/* What a frame leaves for the next: a shot and its buffers. */
typedef struct Kept {
  int number;
  StyShot shot;
  float *rgb, *motion, *depth;
  uint8_t *guide;
  uint16_t *objects;
  StyMatch *matches;
} Kept;

struct Measures {
  Kept last;
  json_t *frames;
  double sums[FIGURES];
  int counts[FIGURES];
  int followed; /* frames that tell how they follow from the one before */
};

static void free_kept(Kept *kept) {
  free(kept->rgb);
  free(kept->motion);
  free(kept->depth);
  free(kept->guide);
  free(kept->objects);
  free(kept->matches);
  *kept = (Kept){.rgb = NULL};
}

Measures *open_measures(void) {
  Measures *measures = calloc(1, sizeof *measures);
  if (measures) measures->frames = json_array();
  return measures;
}

void close_measures(Measures **measures) {
  if (!*measures) return;
  free_kept(&(*measures)->last);
  json_decref((*measures)->frames);
  free(*measures);
  *measures = NULL;
}

static void *copy(const void *bytes, size_t size, bool *failed) {
  void *copied = bytes ? malloc(size) : NULL;
  *failed |= bytes && !copied;
  if (copied) memcpy(copied, bytes, size);
  return copied;
}

static StyStatus keep(const Request *request, const FrameFiles *files, const Work *work, Kept *out, StyError *error) {
  const StyFrame *frame = &work->filled.frame;
  const size_t pixels = (size_t)frame->width * (size_t)frame->height;
  bool failed = false;
  *out = (Kept){.number = files->number, .rgb = malloc(3 * pixels * sizeof *out->rgb)};
  failed = !out->rgb;
  out->guide = copy(frame->guide, 4 * pixels, &failed);
  out->matches = copy(work->matches, pixels * sizeof *out->matches, &failed);
  out->motion = copy(work->motion, 2 * pixels * sizeof *out->motion, &failed);
  out->depth = copy(frame->depth, pixels * sizeof *out->depth, &failed);
  out->objects = copy(frame->objects, pixels * sizeof *out->objects, &failed);
  if (failed) return sty_fail_memory(error, "frame to measure", (double)pixels * 40);
  sty_lay_on_white(work->picture, request->bits, pixels, out->rgb);
  out->shot = (StyShot){.width = frame->width,
                        .height = frame->height,
                        .rgb = out->rgb,
                        .guide = out->guide,
                        .matches = out->matches,
                        .motion = {out->motion, out->motion ? out->motion + pixels : NULL},
                        .depth = out->depth,
                        .objects = out->objects};
  return STY_OK;
}

static void note(Measures *measures, json_t *into, int figure, double value) {
  measures->sums[figure] += value;
  measures->counts[figure]++;
  json_object_set_new(into, figures[figure].key, json_real(value));
}

/* Motion is that from the frame before; where that one is left out, it tells nothing of what is shown. */
static void measure_motion(Measures *measures, const Kept *now, json_t *into) {
  const Kept *before = &measures->last;
  StyWarp warp;
  if (!now->motion || now->number != before->number + 1) return;
  measures->followed++;
  sty_measure_warp(&before->shot, &now->shot, &warp);
  if (!warp.pixels) return;
  note(measures, into, WARP_MEAN, warp.mean);
  note(measures, into, WARP_RMS, warp.rms);
  note(measures, into, JUMPS, warp.jumps);
}

static StyStatus measure_change(Measures *measures, const Kept *now, json_t *into, const StyRun *run, StyError *error) {
  const StyShot *before = &measures->last.shot, *shot = &now->shot;
  double ssim = 0, flip = 0;
  if (!before->rgb || before->width != shot->width || before->height != shot->height) return STY_OK;
  measure_motion(measures, now, into);
  StyStatus status = sty_measure_ssim(shot->width, shot->height, before->rgb, shot->rgb, run, &ssim, error);
  if (!status) status = sty_measure_flip(shot->width, shot->height, before->rgb, shot->rgb, run, &flip, error);
  if (status) return status;
  note(measures, into, SSIM, ssim);
  note(measures, into, FLIP, flip);
  return STY_OK;
}

static StyStatus measure_shot(Measures *measures, const Request *request, const StyShot *now, json_t *into,
                              const StyRun *run, StyError *error) {
  float scales[STY_MAX_STYLES];
  const int styles = (int)request->bundle->textures[STY_BUNDLE_PARAMS].width;
  for (int style = 1; style <= STY_MAX_STYLES; style++) {
    StyStyle values;
    scales[style - 1] = style <= styles && !sty_get_style(request->bundle, style, &values) ? values.scale : 1;
  }
  StyChunks chunks;
  StyLevels levels;
  StyRepetition repetition;
  StyStatus status = sty_measure_chunks(now, scales, &chunks, error);
  if (!status) status = sty_measure_repetition(now, run, &repetition, error);
  if (status) return status;
  sty_measure_levels(now, &levels);
  note(measures, into, CHUNK_MEAN, chunks.mean);
  note(measures, into, CHUNK_WEIGHTED, chunks.weighted);
  note(measures, into, FALLBACK, levels.fallback);
  note(measures, into, FLAT, repetition.flat);
  if (repetition.windows) {
    note(measures, into, REPETITION, repetition.mean);
    note(measures, into, SHOWN, repetition.shown);
  }
  json_t *shares = json_array();
  for (int level = 0; level <= STY_MAX_LEVEL; level++) json_array_append_new(shares, json_real(levels.share[level]));
  json_object_set_new(into, "levels", shares);
  return STY_OK;
}

StyStatus measure_work(Measures *measures, const Request *request, const FrameFiles *files, const Work *work,
                       const StyRun *run, StyError *error) {
  Kept now;
  json_t *into = json_object();
  json_object_set_new(into, "frame", json_integer(files->number));
  StyStatus status = keep(request, files, work, &now, error);
  if (!status) status = measure_change(measures, &now, into, run, error);
  if (!status) status = measure_shot(measures, request, &now.shot, into, run, error);
  json_array_append_new(measures->frames, into);
  free_kept(&measures->last);
  measures->last = now;
  return status;
}

json_t *pack_measures(const Measures *measures) {
  json_t *overall = json_object();
  for (int i = 0; i < FIGURES; i++)
    if (measures->counts[i])
      json_object_set_new(overall, figures[i].key, json_real(measures->sums[i] / measures->counts[i]));
  return json_pack("{s:s, s:O, s:o}", "schema", "stylut-measure/1", "frames", measures->frames, "overall", overall);
}

void review_measures(const Measures *measures, const Request *request, const char *guide) {
  const int frames = (int)json_array_size(measures->frames);
  if (measures->followed + 1 >= frames) return;
  warn(request->options,
       "%s: found %d of %d frames with motion.U and motion.V and the frame before, expected them of all but the first "
       "for warp_mean, warp_rms and jumps",
       clean_text(guide), measures->followed, frames);
}

void print_measures(const Measures *measures) {
  for (int i = 0; i < FIGURES; i++)
    if (measures->counts[i])
      printf("%-14s %-11.6g %s\n", figures[i].key, measures->sums[i] / measures->counts[i], figures[i].text);
}
