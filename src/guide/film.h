/* A camera's film: where its pixels are, and what part of it the scene can show on. */
#ifndef STYLUT_GUIDE_FILM_H
#define STYLUT_GUIDE_FILM_H

#include "stylut/scene.h"

typedef struct StyFilm {
  const StyCamera *camera;
  int width, height;        /* pixels */
  double start[3];          /* of the ray through the film's middle, trace space */
  double *columns, *rows;   /* s and t of pixel centres, see StyCamera, as many as whole blocks have; owned */
  double first[2], last[2]; /* pixels, columns and rows, beyond which no ray meets anything */
} StyFilm;

/* Refers to the camera. STY_ERROR_LIBRARY. */
StyStatus sty_open_film(const StyScene *scene, const StyCamera *camera, int width, int height, StyFilm *out,
                        StyError *error);
void sty_close_film(StyFilm *film);

/* False where no pixel of this rectangle can show anything. */
bool sty_is_in_sight(const StyFilm *film, int x, int y, int width, int height);

/* Where a point of trace space is on a camera's film of this many pixels; false: behind the camera. */
bool sty_project_point(const StyCamera *camera, int width, int height, const double at[3], double pixel[2]);

#endif
