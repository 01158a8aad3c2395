/* How much is taken from a file before it is refused: what hostile headers claim, and what honest work may need, is a
 * matter of the machine, so these can be set. They hold for the whole process.
 *
 * Threads: set them before anything else is called; reading them is safe at any time. */
#ifndef STYLUT_CEILINGS_H
#define STYLUT_CEILINGS_H

#include <stddef.h>

#include "stylut/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum StyCeiling {
  STY_CEILING_PIXELS,         /* of a picture: width times height */
  STY_CEILING_JSON_BYTES,     /* of a manifest, a scene, pairs of points, pivots or a bundle's index */
  STY_CEILING_IMPORT_SECONDS, /* of a mesh file's import; 0: by its size */
  STY_CEILING_IMPORT_BYTES,   /* of memory for it; 0: by its size */
  STY_CEILINGS
} StyCeiling;

double sty_get_ceiling(StyCeiling ceiling);

/* "pixels=100000000": names are pixels, json-bytes, import-seconds and import-bytes, values whole numbers.
 * STY_ERROR_USAGE; `what` names the option. */
StyStatus sty_set_ceiling(const char *what, const char *text, StyError *error);

/* Those that were set, as "NAME=VALUE" with blanks between; returns the length, as snprintf does. */
size_t sty_list_ceilings(const char *before_each, char *out, size_t size);

#ifdef __cplusplus
}
#endif
#endif
