/* One step of a batch: what its recipe says, and what the steps do. Recipes are JSON, written by `stylut batch` into
 * its work folder; names of files in them are relative to that folder, or absolute. */
#ifndef STYLUT_TOOLS_STEP_H
#define STYLUT_TOOLS_STEP_H

#include "pack.h"

#define STEP_SCHEMA "stylut-step/1"

enum { NAME_SIZE = 512 }; /* of files of the work folder */

typedef struct Step {
  StyDocument recipe;
  const char *kind, *output;
  PackArguments arguments;
  Packing packing; /* of the recipe's "manifest": the bundle's, less what the step doesn't need */
} Step;

/* Recipes name files in lists, one a style: file i of the list. NULL, with *error, where there is none. */
const char *get_step_file(const Step *step, const char *list, size_t i, StyError *error);

/* What a step wrote as name_made(output) takes the output's place, unless that holds the same bytes already: what
 * depends on it is then left alone. The caller frees the name; NULL, with *error, when memory is short. */
char *name_made(const char *output, StyError *error);
StyStatus put_made(const char *output, StyError *error);

/* Both, for a JSON value, which is spent, and for a texture of so many layers. */
StyStatus put_value(const char *output, json_t *value, StyError *error);
StyStatus put_texture(const char *output, uint32_t format, int width, int height, int layers, const void *texels,
                      StyError *error);

/* A texture in its file, which the caller unmaps after success. */
StyStatus map_texture(const char *path, uint32_t format, StyMapping *mapping, StyTexture *out, StyError *error);

/* What texels of a table answer for, by the facts that its step wrote. */
StyStatus read_sampling(const char *file, StySampling *out, StyError *error);

/* A small file, under another name. */
StyStatus copy_file(const char *from, const char *to, StyError *error);

/* A file as it is; whatever takes its place has another. The caller owns it. */
json_t *identify_file(const char *path);

/* The guides of a batch are float textures. */
StyStatus put_guide(const char *output, const StyImage *guide, StyError *error);
StyStatus read_guide_texture(const char *path, StyImage **out, StyError *error);

/* Masks are PGM: 255 where all exemplars of a style have paint. */
StyStatus write_mask(const char *path, Size size, const uint8_t *painted, StyError *error);
StyStatus read_mask(const char *path, Size size, uint8_t **out, StyError *error);

/* A style's guide less what isn't painted, from "guides" and "masks" of the recipe. */
StyStatus open_masked_guide(const Step *step, int style, StyImage **out, Overlap *overlap, StyError *error);

/* The steps. */
StyStatus step_guide(Step *step, StyError *error);
StyStatus step_exemplars(Step *step, StyError *error);
StyStatus step_guides(Step *step, StyError *error);
StyStatus step_lut_size(Step *step, StyError *error);
StyStatus step_lut(Step *step, StyError *error);
StyStatus step_audit(Step *step, StyError *error);
StyStatus step_luts(Step *step, StyError *error);
StyStatus step_params(Step *step, StyError *error);
StyStatus step_jitter(Step *step, StyError *error);
StyStatus step_bundle(Step *step, StyError *error);

#endif
