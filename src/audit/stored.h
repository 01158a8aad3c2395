/* What is left of a table that was stored. */
#ifndef STYLUT_SRC_AUDIT_STORED_H
#define STYLUT_SRC_AUDIT_STORED_H

#include "stylut/lut.h"

/* Of its texture. */
size_t sty_count_bytes(const StyLutSpec *spec, StyEncoding encoding);

/* The table as it comes back from its encoding; the caller owns it. */
StyStatus sty_restore_lut(const StyLut *lut, StyEncoding encoding, StyLut **out, StyError *error);

#endif
