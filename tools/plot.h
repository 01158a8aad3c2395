/* Charts, drawn by gnuplot, which runs as a child. */
#ifndef STYLUT_TOOLS_PLOT_H
#define STYLUT_TOOLS_PLOT_H

#include <stdio.h>

#include "stylut/chart.h"

typedef enum PlotFormat { PLOT_SVG, PLOT_PNG } PlotFormat;

typedef struct Plot {
  const char *title;  /* UTF-8 */
  const char *making; /* what the file says of it, one printable line, or NULL */
  const StyChart *chart;
  int threads; /* the times are of */
  PlotFormat format;
} Plot;

/* STY_ERROR_UNAVAILABLE when there is no gnuplot to run. */
StyStatus find_gnuplot(StyError *error);

/* Draws into `picture`, a file. STY_ERROR_LIBRARY when gnuplot fails. */
StyStatus draw_plot(const Plot *plot, FILE *picture, StyError *error);

#endif
