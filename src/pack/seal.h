/* How an index vouches for itself. */
#ifndef STYLUT_SRC_PACK_SEAL_H
#define STYLUT_SRC_PACK_SEAL_H

#include <jansson.h>

#include "stylut/file.h"

#define STY_SEAL_KEY "sha256"
#define STY_INDEX_PRECISION 9 /* digits of reals */

/* The hash of an index without its own seal: compact, keys sorted. */
StyStatus sty_seal_index(const json_t *index, char out[STY_HASH_SIZE], StyError *error);

#endif
