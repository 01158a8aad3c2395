/* A bundle in the packing: what its styles are made of, at the size that they share. */
#ifndef STYLUT_TOOLS_PACK_H
#define STYLUT_TOOLS_PACK_H

#include "options.h"
#include "stylut/audit.h"
#include "stylut/lut.h"
#include "stylut/pack.h"

enum { MOST_JITTERS = 256, DEFAULT_LUT_SIZE = 256 };

typedef enum Fit { FIT_NONE, FIT_RESIZE, FIT_PAD } Fit;
extern const char *const fit_names[]; /* NULL behind the last */

/* First member of the arguments of a command that uses making_argp. */
typedef struct PackArguments {
  Options options;
  const char *manifest;
  int fit;            /* a Fit: what becomes of exemplars of differing sizes */
  int jitter_frames;  /* tables to be drawn, */
  int jitter_noise;   /* by a StyNoise */
  bool allow_outside; /* files may be outside of the manifest's folder */
} PackArguments;

extern const struct argp making_argp; /* --fit --jitter-frames --jitter-noise --allow-outside */

typedef struct Size {
  int width, height;
} Size;

/* Who knows files by their paths, and needn't look at them anew: SHA-256, and the size of pictures. */
typedef struct Records {
  StyStatus (*hash)(struct Records *, const char *path, char out[STY_HASH_SIZE], StyError *error);
  StyStatus (*measure)(struct Records *, const char *path, Size *out, StyError *error);
} Records;

typedef struct Packing {
  PackArguments *arguments;
  const char *command; /* for the history: "pack" or "batch" */
  Records *records;    /* NULL: nobody */
  StyManifest manifest;
  char *root;                 /* folder, links followed, that all files must be in; NULL: anywhere. Owned. */
  Size sizes[STY_MAX_STYLES]; /* of each style's exemplars, as their files have them */
  Size size;                  /* that all have in the bundle */
  int lut_size;
  json_t *guides; /* names of guide files that were read, and warned of where that is due */
  json_t *inputs; /* of the history: hashes by names; NULL: none is kept */
} Packing;

/* Pixels that a guide covers, and those of them that all exemplars have paint on. */
typedef struct Overlap {
  size_t guided, painted;
} Overlap;

/* A guide as it is, and as the bundle has it, RGBA: many styles may share it. */
typedef struct Guide {
  StyImage *image;
  uint8_t *texels;
} Guide;

/* One style's source. */
typedef struct Source {
  uint8_t *layers[2 * STY_MAX_LIGHTINGS]; /* RGBA: exemplars, then their bases */
  StyImage *guide;                        /* covers what all exemplars have paint on */
  uint8_t *texels; /* RGBA: the guide as the bundle has it; tables go by all its precision, as frames look up with 16
                    * bits */
  Overlap overlap;
} Source;

/* A style's table. */
typedef struct Table {
  uint16_t *texels;  /* lut_size^2 pairs, as the bundle has them */
  bool unorm8;       /* meant for bytes */
  bool is_judged;    /* a table that was made for a picture of another size isn't */
  StyFigures lookup; /* how far its answers are off, degrees */
  size_t holes;      /* texels that name a pixel without guide or paint */
} Table;

/* What a manifest's reader can't know: engines, what audits can be held to, and whether jitter is asked for twice. */
StyStatus check_manifest(const Packing *packing, StyError *error);

/* A picture's size, by its name in the manifest. */
StyStatus measure_picture(const Packing *packing, const char *name, Size *out, StyError *error);

/* STY_ERROR_INPUT where a guide's file isn't of its exemplar's size. */
StyStatus check_guide_fits(const StyManifestStyle *style, Size exemplar, Size guide, StyError *error);

/* Fills sizes and size from the exemplars' headers. STY_ERROR_INPUT where they differ and no --fit says what to do. */
StyStatus measure_exemplars(Packing *packing, StyError *error);

/* Whether two styles have the same guide. The caller closes the guide that it opens. */
bool is_same_guide(const Packing *packing, int a, int b);
StyStatus open_guide(const Packing *packing, int style, Guide *out, StyError *error);
void close_guide(Guide *guide);

/* Reads a style's exemplars, takes what they have paint on of the style's guide, and makes its bases. The caller closes
 * the source. Thread-safe. */
StyStatus open_source(const Packing *packing, int style, const Guide *guide, Source *out, StyError *error);
void close_source(Source *source);

/* The parts of a source. All have the bundle's size.
 * RGBA of a style's exemplars, which the caller frees, also after a failure; */
StyStatus read_exemplars(const Packing *packing, int style, uint8_t *layers[STY_MAX_LIGHTINGS], StyError *error);
/* 255 where all of them have paint, else 0, a byte a pixel; STY_ERROR_INPUT where that is nowhere; */
StyStatus find_painted(const Packing *packing, int style, uint8_t *const *layers, uint8_t *painted, StyError *error);
/* A and normals, as the guide has them, */
StyStatus get_guide(const Packing *packing, int style, StyImage **out, StyError *error);
/* and less what isn't painted; */
Overlap uncover_unpainted(StyImage *guide, const uint8_t *painted);
/* RGBA of either, which the caller frees; */
StyStatus encode_guide(const StyImage *guide, uint8_t **out, StyError *error);
/* the second from the first, whose texels have no alpha where nothing is covered; */
Overlap leave_painted(const uint8_t *texels, const uint8_t *painted, size_t pixels, uint8_t *out);
/* the exemplars' bases, behind them in `layers`, where the style has any. */
StyStatus make_bases(const Packing *packing, int style, const StyImage *guide, uint8_t *layers[2 * STY_MAX_LIGHTINGS],
                     StyError *error);

/* Warn of guides without much paint, and of tables that point where none is. */
void review_overlap(const Packing *packing, const Options *options, int style, const Overlap *overlap);
void review_holes(const Options *options, const StyManifestStyle *style, size_t holes);

/* Reads a picture as RGBA bytes, which the caller frees. */
StyStatus read_bytes(const char *path, uint8_t **bytes, Size *size, StyError *error);

/* A file of the manifest; the caller frees it. NULL, with *error, when memory is short. */
char *find_file(const Packing *packing, const char *name, StyError *error);

/* The tables of the manifest, or drawn ones (not in a dry run), which the caller frees; how many they are. */
StyStatus get_jitters(const Packing *packing, uint8_t **out, StyError *error);
int count_jitters(const Packing *packing);

/* Begins the index's history: the command, and every file that the manifest names; what a scene names joins them when
 * it is read. */
StyStatus begin_history(Packing *packing, json_t *index, StyError *error);

/* Adds the hash of a file to the history, once; NULL is none. */
StyStatus record_input(const Packing *packing, const char *name, StyError *error);

/* What the index says of one style, whose `layer` is the first of its own, and of the jitter tables. */
json_t *describe_style(const Packing *packing, int number, const StyStyle *parameters, int layer, const Table *table);
json_t *describe_lookup(const Table *table); /* its errors */
json_t *describe_lut(const Packing *packing, int number, const Table *table);
json_t *describe_jitter(const Packing *packing);

/* Whether a style's guide is the analytic sphere, no file; whether its table has a budget. */
bool is_sphere(const StyManifestStyle *style);
bool has_budget(const StyManifestStyle *style);

/* The size that a style insists on and all others take, and the first that does; 0: none does. */
StyStatus find_fixed_size(const Packing *packing, int *out, const StyManifestStyle **by, StyError *error);

/* The smallest size that meets a style's budget, by its guide (less what isn't painted). STY_CHECK_FAILED where none
 * does. */
StyStatus choose_lut_size(const Packing *packing, int style, const StyImage *guide, int *out, StyError *error);

/* STY_ERROR_INPUT where a style's budget takes more than the size that `fixed_by` insists on. */
StyStatus check_lut_size(int fixed, const char *fixed_by, const StyManifestStyle *style, int size, StyError *error);

/* Fills lut_size: what sizes, tables and budgets of the styles come down to. STY_CHECK_FAILED where a budget can't be
 * met. */
StyStatus settle_lut_size(Packing *packing, StyError *error);

/* Makes or reads a style's table, and judges it. STY_CHECK_FAILED when it is over the style's budget. The caller frees
 * the texels. */
StyStatus make_table(const Packing *packing, int style, const StyImage *guide, Table *out, StyError *error);

#endif
