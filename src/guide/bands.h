/* A picture in bands of rows: while one is made, the one before is taken away. */
#ifndef STYLUT_GUIDE_BANDS_H
#define STYLUT_GUIDE_BANDS_H

#include "guide/channels.h"

typedef struct StyBands {
  int width, height;
  unsigned groups; /* channels */
  /* Fills every pixel of the band, whose first row is row `first` of the picture: a multiple of 32. No band is higher
   * than the first. */
  StyStatus (*fill)(void *context, int first, const StyGuide *band, const StyRun *run, StyError *error);
  void *context;
} StyBands;

/* Rows of a picture's bands; no more than two are held. */
int sty_choose_band_rows(int width, int height);

typedef struct StyBandTimes {
  double first_ms, fill_ms; /* what filling the first took, and all of them */
} StyBandTimes;

/* Hands all bands to the sink, in order. */
StyStatus sty_stream_bands(const StyBands *bands, const StyRun *run, const StyRowSink *sink, StyBandTimes *times,
                           StyError *error);

#endif
