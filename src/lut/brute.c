#include "lut/engine.h"

size_t sty_scan_sites(const StySites *sites, const float g[2]) {
  float best = sty_measure_site(sites, 0, g);
#pragma omp simd reduction(min : best)
  for (size_t s = 1; s < sites->count; s++) {
    const float distance = sty_measure_site(sites, s, g);
    best = distance < best ? distance : best;
  }
  /* Sites ascend by pixel: the first at the minimum is the lowest. */
  size_t nearest = 0;
  while (sty_measure_site(sites, nearest, g) != best) nearest++;
  return nearest;
}

typedef struct Job {
  const StySites *sites;
  StyLut *lut;
} Job;

static StyStatus build_row(void *context, long j, StyError *error) {
  (void)error;
  const Job *job = context;
  for (int i = 0; i < job->lut->size; i++) {
    float g[2];
    sty_get_texel_value(job->lut, i, (int)j, g);
    sty_set_texel(job->lut, i, (int)j, job->sites, sty_scan_sites(job->sites, g), g);
  }
  return STY_OK;
}

StyStatus sty_build_brute(const StySites *sites, StyLut *lut, const StyRun *run, StyError *error) {
  Job job = {sites, lut};
  return sty_parallel_for(run, lut->size, build_row, &job, error);
}
