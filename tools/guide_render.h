/* What `guide sphere` and `guide scene` are asked for, and how it is done. */
#ifndef STYLUT_TOOLS_GUIDE_RENDER_H
#define STYLUT_TOOLS_GUIDE_RENDER_H

#include "options.h"
#include "stylut/guide.h"
#include "stylut/simplify.h"

/* Channels that look at textures. */
enum { COLOURED = STY_GUIDE_ALBEDO | STY_GUIDE_LUMA | STY_GUIDE_PATHS };

typedef struct GuideArguments {
  Options options;
  const char *kind, *mesh;
  int width, height;
  unsigned groups;
  int bits;
  StyView view;
  double crease_angle; /* of StyMeshOptions */
  bool flat;
  int frame;  /* index of frames */
  int filter; /* index of filters */
  StyPathOptions paths;
  const char *paths_only; /* an option that means nothing without light paths */
  StyContourWeights contour;
  const char *contour_only; /* an option that means nothing without the channel contour */
  const char *previous;
  bool repair, simplify;
  StySimplifyOptions simplify_options;
  bool has_max_error;
  const char *scene_only;  /* an option that means nothing for a sphere */
  const char *camera_only; /* one that means nothing where a scene file has the camera */
} GuideArguments;

/* Renders into the output, band by band, and reports. */
StyStatus render_guide(GuideArguments *arguments);

#endif
