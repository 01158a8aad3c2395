/* Inputs that several commands read in the same way. */
#ifndef STYLUT_TOOLS_INPUTS_H
#define STYLUT_TOOLS_INPUTS_H

#include "stylut/guide.h"
#include "stylut/lut.h"

/* Reads a file and turns it into a guide with A and normal.* (see guide.h). */
StyStatus read_guide(const char *path, StyImage **out, StyError *error);

/* Reads a table; `hints` say what the file may leave out. */
StyStatus read_lut(const char *path, const StyLutHints *hints, StyLut **out, StyError *error);

#endif
