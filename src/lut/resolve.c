/* The choice among nearly equal source pixels: see coherent.c for what keeps
 * neighbouring texels together and serve.c for what serves frames. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lut/choice.h"
#include "lut/near.h"

/* So many of the pixels within the slack are tried on frames, evenly chosen of a
 * sample of them. On the figures this was tuned with, 24 took up to twice as long and
 * all, 62 on average, six times, and pieces were no larger. */
enum { MOST_TRIED = 10, SAMPLE = 40 };

/* ---- setting up --------------------------------------------------------------- */

static uint8_t get_life(const StyLutSpec *spec, int i, int j) {
  if (sty_is_feasible(spec, i, j)) return STY_FEASIBLE;
  for (int s = 0; s < 4; s++) {
    const int x = i + sty_steps[s][0], y = j + sty_steps[s][1];
    if (x >= 0 && y >= 0 && x < spec->width && y < spec->height && sty_is_feasible(spec, x, y)) return STY_RIM;
  }
  return STY_DEAD;
}

static void set_texels(StyChoice *choice, const StyMeasure *measure, double slack) {
  const StyLutSpec *spec = &choice->lut->spec;
  for (int j = 0; j < spec->height; j++)
    for (int i = 0; i < spec->width; i++) {
      const size_t t = (size_t)j * (size_t)spec->width + (size_t)i;
      StyQuery query;
      sty_make_query(measure, choice->lut, i, j, &query);
      memcpy(choice->places + (size_t)choice->dims * t, query.at, (size_t)choice->dims * sizeof(float));
      /* The margin is for rounding, which near 1 is more than a small slack's: never beyond the slack. */
      const double least = (double)choice->lut->errors[t];
      const double limit = least + fmax(0, slack - (least + slack) * 4e-7);
      choice->limits[t] = (float)(limit * limit);
      choice->live[t] = get_life(spec, i, j);
      const int pixel = (int)choice->lut->pixels[t], width = choice->lut->source_width;
      choice->current[t] = sty_pack_pixel(pixel % width, pixel / width);
    }
}

static void set_values(StyChoice *choice, const StySites *sites) {
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  for (int k = 0; k < choice->dims; k++)
    for (size_t p = 0; p < pixels; p++) choice->values[k][p] = NAN;
  for (size_t s = 0; s < sites->count; s++) {
    float at[3];
    sty_lift(choice->dims, sites->values + 2 * s, at);
    for (int k = 0; k < choice->dims; k++) choice->values[k][sites->pixels[s]] = at[k];
  }
}

static void close_choice(StyChoice *choice) {
  for (int k = 0; k < 3; k++) free(choice->values[k]);
  free(choice->places);
  free(choice->limits);
  free(choice->live);
  free(choice->current);
  free(choice->favourites);
  free(choice->services);
}

static StyStatus open_choice(StyLut *lut, const StySites *sites, double slack, StyChoice *choice, StyError *error) {
  const StyMeasure measure = sty_choose_measure(sites, &lut->spec);
  const size_t texels = sty_count_texels(&lut->spec), dims = (size_t)measure.dims;
  const size_t pixels = (size_t)sites->width * (size_t)sites->height;
  *choice = (StyChoice){.lut = lut, .dims = measure.dims};
  bool complete = true;
  for (int k = 0; k < measure.dims; k++) complete = (choice->values[k] = malloc(pixels * sizeof(float))) && complete;
  choice->places = malloc(texels * dims * sizeof *choice->places);
  choice->limits = malloc(texels * sizeof *choice->limits);
  choice->live = malloc(texels * sizeof *choice->live);
  choice->current = malloc(texels * sizeof *choice->current);
  if (!complete || !choice->places || !choice->limits || !choice->live || !choice->current) {
    close_choice(choice);
    return sty_fail_memory(error, "LUT choices", (double)texels * 17 + (double)pixels * 8);
  }
  set_texels(choice, &measure, slack);
  set_values(choice, sites);
  return STY_OK;
}

/* ---- what serves frames ------------------------------------------------------- */

typedef struct Job {
  StyChoice *choice;
  const StySites *sites;
  const StyNear *near;
  double slack;
} Job;

static void try_pixel(StyChoice *choice, int texel, uint32_t pixel) {
  const float squared = sty_measure_option(choice, texel, pixel);
  if (!(squared <= choice->limits[texel])) return;
  const float service = sty_measure_service(choice->serve, (size_t)texel, sty_get_x(pixel), sty_get_y(pixel));
  if (!(service > choice->services[texel])) return;
  choice->services[texel] = service;
  choice->favourites[texel] = pixel;
}

/* Those to try: of a sample, evenly chosen by value, evenly chosen by place; how many. */
static int choose_tried(const StyNearList *list, uint32_t tried[MOST_TRIED]) {
  uint32_t sample[SAMPLE];
  const int count = list->count < SAMPLE ? (int)list->count : SAMPLE;
  for (int c = 0; c < count; c++) {
    const uint32_t site = list->sites[(size_t)c * list->count / (size_t)count];
    int at = c;
    for (; at > 0 && sample[at - 1] > site; at--) sample[at] = sample[at - 1];
    sample[at] = site;
  }
  const int most = count < MOST_TRIED ? count : MOST_TRIED;
  for (int c = 0; c < most; c++) tried[c] = sample[c * count / most];
  return most;
}

/* The nearest pixel first, so that it stays where none is better. */
static StyStatus choose_row(void *context, long j, StyError *error) {
  const Job *job = context;
  StyChoice *choice = job->choice;
  const int source = choice->lut->source_width, width = choice->lut->spec.width;
  StyNearList list = {0};
  StyStatus status = STY_OK;
  for (int texel = (int)j * width; !status && texel < ((int)j + 1) * width; texel++) {
    if (!choice->live[texel] || !sty_has_askers(choice->serve, (size_t)texel)) continue;
    try_pixel(choice, texel, choice->current[texel]);
    const float *place = choice->places + (size_t)choice->dims * (size_t)texel;
    if (!sty_list_near(job->near, place, (double)choice->lut->errors[texel] + job->slack, &list))
      status = sty_fail_memory(error, "LUT choices", (double)list.capacity * 8);
    uint32_t tried[MOST_TRIED];
    const int count = status ? 0 : choose_tried(&list, tried);
    for (int c = 0; c < count; c++) {
      const int pixel = (int)job->sites->pixels[tried[c]];
      try_pixel(choice, texel, sty_pack_pixel(pixel % source, pixel / source));
    }
  }
  sty_free_near_list(&list);
  return status;
}

static StyStatus choose_favourites(StyChoice *choice, const StySites *sites, double slack, const StyRun *run,
                                   StyError *error) {
  const size_t texels = sty_count_texels(&choice->lut->spec);
  choice->favourites = malloc(texels * sizeof *choice->favourites);
  choice->services = calloc(texels, sizeof *choice->services);
  if (!choice->favourites || !choice->services) return sty_fail_memory(error, "LUT choices", (double)texels * 8);
  memcpy(choice->favourites, choice->current, texels * sizeof *choice->favourites);
  StyNear near;
  StyStatus status = sty_open_near(sites, choice->dims, slack, &near, error);
  if (status) return status;
  Job job = {choice, sites, &near, slack};
  status = sty_parallel_for(run, choice->lut->spec.height, choose_row, &job, error);
  sty_close_near(&near);
  return status;
}

/* ---- the whole ---------------------------------------------------------------- */

/* Puts the choices into the table; pixels that stayed keep their errors as they are,
 * and a table of nothing else is still that of the nearest. */
static void write_choices(const StyChoice *choice, const uint32_t *chosen, double slack) {
  StyLut *lut = choice->lut;
  for (size_t t = 0; t < sty_count_texels(&lut->spec); t++) {
    const uint32_t pixel =
        (uint32_t)sty_get_y(chosen[t]) * (uint32_t)lut->source_width + (uint32_t)sty_get_x(chosen[t]);
    if (lut->pixels[t] == pixel) continue;
    lut->slack = slack;
    lut->pixels[t] = pixel;
    lut->errors[t] = sqrtf(sty_measure_option(choice, (int)t, chosen[t]));
  }
}

StyStatus sty_resolve_lut(StyLut *lut, const StySites *sites, const StyResolveOptions *options, const StyRun *run,
                          StyError *error) {
  if (lut->depth)
    return sty_fail(error, STY_ERROR_USAGE, "LUT: found three dimensions, expected two for a choice within the slack");
  if (!options->guide || options->guide->width != lut->source_width || options->guide->height != lut->source_height)
    return sty_fail(error, STY_ERROR_INPUT,
                    "LUT: found no guide or one of another size, expected the one it is made of");
  if (options->frame_count >= STY_NO_FRAME)
    return sty_fail(error, STY_ERROR_USAGE, "LUT: found %d frames to serve, expected fewer than %d",
                    options->frame_count, STY_NO_FRAME);
  StyChoice choice;
  StyServe serve = {0};
  StyStatus status = open_choice(lut, sites, options->slack, &choice, error);
  if (status) return status;
  /* Without frames the guide itself is the best guess at what they look like. */
  const bool has_frames = options->frame_count > 0;
  status = sty_open_serve(lut, options->guide, has_frames ? options->frames : &options->guide,
                          has_frames ? options->frame_count : 1, &serve, error);
  choice.serve = &serve;
  if (!status && has_frames) status = choose_favourites(&choice, sites, options->slack, run, error);
  if (!status && options->coherent) status = sty_make_coherent(&choice, run, error);
  if (!status)
    write_choices(&choice, options->coherent || !has_frames ? choice.current : choice.favourites, options->slack);
  sty_close_serve(&serve);
  close_choice(&choice);
  return status;
}
