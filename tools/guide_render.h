/* What `guide sphere` and `guide scene` are asked for, and how it is done. */
#ifndef STYLUT_TOOLS_GUIDE_RENDER_H
#define STYLUT_TOOLS_GUIDE_RENDER_H

#include "options.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/simplify.h"

typedef struct GuideArguments {
  Options options;
  const char *mesh; /* or a scene file; NULL: the sphere */
  int width, height;
  const char *channels; /* as they were asked for; NULL: they weren't */
  unsigned groups;
  int bits;
  StyImageFormat format;
  StyView view;
  int camera, up;      /* of the view: indices of cameras, and of sty_up_axis_names */
  double crease_angle; /* of StyMeshOptions */
  bool flat;
  int frame;  /* index of frames */
  int filter; /* index of filters */
  StyPathOptions paths;
  StyContourWeights contour;
  const char *previous;
  bool repair, simplify;
  StySimplifyOptions simplify_options;
} GuideArguments;

extern const GuideArguments default_guide_arguments;

/* --size --channels --bits, for GuideArguments only; and what is to be said of those and the output. */
extern const struct argp picture_argp;
StyStatus check_picture(GuideArguments *arguments);

/* Renders into the output, band by band, and reports. */
StyStatus render_guide(GuideArguments *arguments);

#endif
