/* Bundles: manifests read, textures written, whole bundles checked and loaded.
 * File formats: runtime_format.h. */
#ifndef STYLUT_PACK_H
#define STYLUT_PACK_H

#include <stdbool.h>
#include <stdint.h>

#include "stylut/file.h"
#include "stylut/json.h"
#include "stylut/ktx2.h"
#include "stylut/runtime.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- manifest: stylut-bundle/1, what people write ---------------------------- */

/* One style. Strings are owned by the manifest; file names are as written, to
 * be joined with the manifest's folder. */
typedef struct StyManifestStyle {
  const char *name;
  const char *exemplar;     /* picture file */
  const char *guide;        /* "sphere" or a guide file */
  const char *lut_file;     /* a table brought along, or NULL: build one */
  const char *lut_engine;   /* name, "auto" unless given */
  int lut_size;             /* texels a side, 256 unless given */
  const char *lut_sampling; /* "unorm8" (unless given) or "centre"; NULL for a file that says it itself */
  StyStyle parameters;      /* layer and flags are left to the packer */
} StyManifestStyle;

typedef struct StyManifest {
  StyDocument document;
  char *folder;
  const char *jitter; /* picture file whose R and G are the table, or NULL: seeded */
  int style_count;    /* 1 .. STY_MAX_STYLES */
  StyManifestStyle *styles;
} StyManifest;

/* STY_ERROR_INPUT for wrong types, unknown keys, values out of range, two styles
 * of one name: with file, line and column. Files named inside aren't opened. */
StyStatus sty_read_manifest(const char *path, StyManifest *out, StyError *error);
void sty_close_manifest(StyManifest *manifest);

/* ---- writing ------------------------------------------------------------------ */

/* A jitter table of white noise: bytes 0..254, so that a seed stays in its
 * cell (255 would put it on the next). STY_JITTER_SIZE^2 texels of 2 bytes. */
void sty_make_jitter(uint64_t seed, uint8_t *out);

typedef struct StyBundleShape {
  int width, height; /* of exemplars and guides */
  int lut_size;
  int style_count;
} StyBundleShape;

/* A bundle in the making: a temporary folder beside its final place. */
typedef struct StyBundleWriter StyBundleWriter;

/* STY_ERROR_FILE when `path` can't be written or is a folder that holds anything
 * but a bundle (what people keep there isn't ours to replace). */
StyStatus sty_open_bundle_writer(const char *path, const StyBundleShape *shape, StyBundleWriter **out, StyError *error);

/* Appends the next style's layers: exemplar and guide as RGBA bytes, LUT as two
 * 16-bit values a texel. `parameters->layer` is set by the writer. */
StyStatus sty_write_style(StyBundleWriter *writer, const uint8_t *exemplar, const uint8_t *guide, const uint16_t *lut,
                          const StyStyle *parameters, StyError *error);

/* Writes parameters, jitter (see sty_make_jitter) and bundle.json, checks
 * everything as a reader would, and puts the bundle in its place. `index`, an
 * object that says what went in, is borrowed and completed with "schema",
 * "version", "files" and "sha256", the hash of the rest in compact form with
 * sorted keys. *writer is spent. */
StyStatus sty_commit_bundle(StyBundleWriter **writer, const uint8_t *jitter, json_t *index, StyError *error);
void sty_discard_bundle(StyBundleWriter **writer);

/* Names of the files, in the order of STY_BUNDLE_*. */
extern const char *const sty_bundle_files[STY_BUNDLE_FILES];
#define STY_BUNDLE_INDEX "bundle.json"
#define STY_BUNDLE_SCHEMA "stylut-bundle-index/1"

/* ---- reading ------------------------------------------------------------------ */

/* Findings about a bundle. The numbers are permanent. */
typedef enum StyFindingNumber {
  STY_FINDING_INDEX = 1,      /* bundle.json isn't what it should be */
  STY_FINDING_MISSING = 2,    /* a file, bundle.json included, is missing or unreadable */
  STY_FINDING_SIZE = 3,       /* a file's length differs from the index */
  STY_FINDING_HASH = 4,       /* a file's SHA-256 differs from the index, or the index's from its own */
  STY_FINDING_TEXTURE = 5,    /* a file isn't the KTX2 texture it should be */
  STY_FINDING_MISMATCH = 6,   /* the textures don't fit each other */
  STY_FINDING_PARAMETERS = 7, /* a style's parameters are out of range */
  STY_FINDING_STYLES = 8,     /* the index lists another number of styles */
  STY_FINDING_BACKGROUND = 9, /* warning: LUT texels point at pixels that aren't covered */
} StyFindingNumber;

typedef struct StyFinding {
  StyFindingNumber number;
  bool warning;
  char file[64]; /* inside the bundle */
  char text[512];
} StyFinding;

typedef struct StyLoadedBundle {
  StyDocument index;
  StyMapping files[STY_BUNDLE_FILES];
  StyBundle bundle; /* points into the mappings */
} StyLoadedBundle;

/* Maps a bundle and verifies it: lengths and hashes against the index, headers,
 * parameters. Every finding goes to `report` (may be NULL); the first that isn't
 * a warning becomes the message. STY_ERROR_FILE when that is a missing file,
 * else STY_ERROR_INPUT. Unmap with sty_unload_bundle. */
StyStatus sty_load_bundle(const char *path, void (*report)(void *context, const StyFinding *finding), void *context,
                          StyLoadedBundle *out, StyError *error);
void sty_unload_bundle(StyLoadedBundle *bundle);

/* The number (1 and up) of a style given as a number or by its name.
 * STY_ERROR_USAGE; `what` names the option. */
StyStatus sty_find_style(const char *what, const char *text, const StyLoadedBundle *bundle, int *out, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
