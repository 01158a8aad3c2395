/* Bundles: manifests read, textures written, whole bundles checked and loaded.
 * File formats: runtime_format.h. */
#ifndef STYLUT_PACK_H
#define STYLUT_PACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stylut/file.h"
#include "stylut/image.h"
#include "stylut/json.h"
#include "stylut/ktx2.h"
#include "stylut/parallel.h"
#include "stylut/runtime.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- parameters: those of StyStyle that people set ---------------------------- */

typedef enum StyParameterKind {
  STY_PARAMETER_WHOLE,  /* int */
  STY_PARAMETER_NUMBER, /* float */
  STY_PARAMETER_SCALE,  /* float: 0.5, 1 or 2 */
  STY_PARAMETER_FLAG    /* a bit of the flags: true or false */
} StyParameterKind;

typedef struct StyParameter {
  const char *name;
  StyParameterKind kind;
  double minimum, maximum;
  size_t offset; /* of the field in StyStyle */
  unsigned flag;
} StyParameter;

/* All of them, for manifests and command lines; the last has a NULL name. */
extern const StyParameter sty_parameters[];

/* What a parameter may be, in words. */
#define STY_RANGE_SIZE 64
const char *sty_name_parameter_range(const StyParameter *parameter, char out[STY_RANGE_SIZE]);

/* False where the value is out of range; then the style stays as it is. */
bool sty_put_parameter(const StyParameter *parameter, double value, StyStyle *style);
/* As few decimals as tell it from other values: what was put, where that had up to 6. */
double sty_get_parameter(const StyParameter *parameter, const StyStyle *style);

/* {"threshold": 24, ...}; the caller owns it. */
json_t *sty_describe_parameters(const StyStyle *style);

/* The parameter `name` from text. STY_ERROR_USAGE lists the names, or the range; `what` names the option. */
StyStatus sty_set_parameter(const char *what, const char *name, const char *text, StyStyle *style, StyError *error);

/* ---- manifest: stylut-bundle/1, what people write ---------------------------- */

/* A style's table: how to build it, or which file holds it. */
typedef struct StyManifestLut {
  const json_t *written; /* as it stands in the style or in the defaults, or NULL: what is below says the same */
  const char *file;      /* a table brought along, or NULL: build one */
  const char *engine;    /* name, "auto" unless given */
  int size;              /* texels a side; 0: as the bundle's others, or as the budget asks */
  double most_mean, most_p99, most_error; /* budget: lookup errors in degrees; 0: any */
  const char *resolve;                    /* "nearest" (unless given), "coherent", "frames" or "both" */
  double slack;                           /* 8-bit levels, for all but "nearest" */
  const json_t *frames;                   /* guide files, for "frames" and "both"; see sty_get_manifest_name */
  const char *sampling;                   /* "unorm8" (unless given) or "centre"; NULL for a file that says it itself */
} StyManifestLut;

/* One style, or one of those that a glob stands for, defaults included. Strings are owned by the manifest; file names
 * are as written, to be joined with the manifest's folder. */
typedef struct StyManifestStyle {
  size_t entry; /* of the list "styles" */
  const char *name;
  const char *exemplars[STY_MAX_LIGHTINGS]; /* picture files, parameters.layer_count of them */
  const char *guide;                        /* "sphere", a guide file or a scene */
  double base;                              /* Gaussian that its low frequencies are taken with, pixels; 0: none */
  StyManifestLut lut;
  const json_t *check; /* what its audit is held to: an object of numbers, or NULL; names are left to the packer */
  StyStyle parameters; /* first layer and the flags of textures are left to the packer */
} StyManifestStyle;

typedef struct StyManifest {
  StyDocument document;
  char *folder;
  const json_t *jitter; /* picture files whose R and G are the tables, or NULL: seeded */
  int style_count;      /* 1 .. STY_MAX_STYLES */
  StyManifestStyle *styles;
  json_t *made; /* strings that aren't written there: what globs stand for */
} StyManifest;

/* One or more file names: a string, or a list of them. NULL: none. */
size_t sty_count_manifest_names(const json_t *names);
const char *sty_get_manifest_name(const json_t *names, size_t i);

/* The layers that a style's exemplars and bases take. */
int sty_count_layers(const StyStyle *parameters);

/* STY_ERROR_INPUT for wrong types, unknown keys, values out of range, two styles
 * of one name, globs that no file matches: with file, line and column. Files named inside aren't opened; globs are
 * matched against the last part of the names in a folder, and give styles in the order of their names' bytes. */
StyStatus sty_read_manifest(const char *path, StyManifest *out, StyError *error);

/* The same of a document that was read already, and of the folder that its names are relative to. The document is
 * spent. */
StyStatus sty_parse_manifest(StyDocument *document, const char *folder, StyManifest *out, StyError *error);

/* STY_ERROR_INPUT for a value of a style's "lut" or "check" (`section`), which stands there or in the defaults. */
StyStatus sty_fail_manifest_value(const StyManifest *manifest, const StyManifestStyle *style, const char *section,
                                  const char *key, const json_t *found, const char *expected, StyError *error);
void sty_close_manifest(StyManifest *manifest);

/* ---- writing ------------------------------------------------------------------ */

/* A jitter table of white noise: bytes 0..254, so that a seed stays in its
 * cell (255 would put it on the next). STY_JITTER_BYTES: STY_JITTER_SIZE^2 texels of 2. */
#define STY_JITTER_BYTES (2 * STY_JITTER_SIZE * STY_JITTER_SIZE)
void sty_make_jitter(uint64_t seed, uint8_t *out);

/* `count` tables, one behind the other, that have nothing in common. White: as above, the first of this very seed.
 * Blue: each of a table's two channels ranks all cells so that the first of them, however many, are spread evenly (void
 * and cluster, Ulichney 1993): near cells differ in what they get, and all bytes are equally frequent. A second or so a
 * table. STY_ERROR_LIBRARY: memory. */
typedef enum StyNoise { STY_NOISE_WHITE, STY_NOISE_BLUE } StyNoise;
extern const char *const sty_noise_names[]; /* NULL behind the last */
StyStatus sty_make_jitters(StyNoise noise, uint64_t seed, int count, const StyRun *run, uint8_t *out, StyError *error);

/* The low frequencies of an exemplar (thesis 000, 2.2.3): a Gaussian of `sigma` pixels over the RGBA bytes, as they are
 * encoded. What counts is what the guide (channel A) covers, by the exemplar's alpha, so that no background bleeds in;
 * alpha stays. The caller frees *out. STY_ERROR_LIBRARY: memory. */
StyStatus sty_make_base(const uint8_t *exemplar, const StyImage *guide, double sigma, const StyRun *run, uint8_t **out,
                        StyError *error);

typedef struct StyBundleShape {
  int width, height; /* of exemplars and guides */
  int lut_size;
  int style_count;
  int exemplar_count; /* layers of all styles' exemplars and bases */
  int jitter_count;   /* tables */
} StyBundleShape;

/* A bundle in the making: a temporary folder beside its final place. */
typedef struct StyBundleWriter StyBundleWriter;

/* STY_ERROR_FILE when `path` can't be written or is a folder that holds anything
 * but a bundle (what people keep there isn't ours to replace). */
StyStatus sty_open_bundle_writer(const char *path, const StyBundleShape *shape, StyBundleWriter **out, StyError *error);

/* Appends the next style's layers: sty_count_layers exemplars, each lighting's, then each one's base, and the guide as
 * RGBA bytes, the LUT as two 16-bit values a texel. `parameters->layer` is set by the writer. */
StyStatus sty_write_style(StyBundleWriter *writer, const uint8_t *const *exemplars, const uint8_t *guide,
                          const uint16_t *lut, const StyStyle *parameters, StyError *error);

/* Writes parameters, the jitter tables (see sty_make_jitters), import settings and bundle.json, checks
 * everything as a reader would, and puts the bundle in its place. `index`, an
 * object that says what went in, is borrowed and completed with "schema",
 * "version", "files", "import_settings" and "sha256", the hash of the rest in compact form with
 * sorted keys. *writer is spent. */
StyStatus sty_commit_bundle(StyBundleWriter **writer, const uint8_t *jitter, json_t *index, const StyRun *run,
                            StyError *error);
void sty_discard_bundle(StyBundleWriter **writer);

/* A bundle of textures that were written one by one, each a file of STY_BUNDLE_* in the folder `parts`, which it links
 * (copies, where the file system has no links): import settings and the index are written, all is checked, and the
 * bundle put in its place, as by sty_commit_bundle. */
StyStatus sty_assemble_bundle(const char *path, const char *parts, json_t *index, const StyRun *run, StyError *error);

/* STY_ERROR_FILE unless a bundle may be put at `path`: a new name, an empty folder, or an earlier bundle's, which may
 * hold other files; those stay. */
StyStatus sty_check_bundle_place(const char *path, StyError *error);

/* Names of the files, in the order of STY_BUNDLE_*. */
extern const char *const sty_bundle_files[STY_BUNDLE_FILES];
#define STY_BUNDLE_INDEX "bundle.json"
#define STY_BUNDLE_SCHEMA "stylut-bundle-index/1"

/* Beside them a file for engines: how to import each texture (JSON, "stylut-import-settings/1"), which the index lists
 * under STY_IMPORT_KEY. */
#define STY_IMPORT_SETTINGS "import-settings.json"
#define STY_IMPORT_KEY "import_settings"

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
  StyBundle bundle;          /* points into the mappings, and to: */
  unsigned char *parameters; /* those that were put; NULL: none */
} StyLoadedBundle;

/* Maps a bundle and verifies it: lengths and hashes against the index, headers,
 * parameters. Every finding goes to `report` (may be NULL); the first that isn't
 * a warning becomes the message. STY_ERROR_FILE when that is a missing file,
 * else STY_ERROR_INPUT. Unmap with sty_unload_bundle. */
StyStatus sty_load_bundle(const char *path, void (*report)(void *context, const StyFinding *finding), void *context,
                          StyLoadedBundle *out, StyError *error);
void sty_unload_bundle(StyLoadedBundle *bundle);

/* A style's name, by its number (1 and up); "" where the index has none. The bundle's. */
const char *sty_get_style_name(const StyLoadedBundle *bundle, int number);

/* The number (1 and up) of a style given as a number or by its name.
 * STY_ERROR_USAGE; `what` names the option. */
StyStatus sty_find_style(const char *what, const char *text, const StyLoadedBundle *bundle, int *out, StyError *error);

/* ---- changing parameters ------------------------------------------------------ */

/* Gives style `number` (1 and up) of a loaded bundle these parameters, in memory: bundle and index. What follows from
 * its textures (layers, flags but STY_FLAG_OBJECTS) must be as it was. STY_ERROR_LIBRARY: memory. */
StyStatus sty_put_style(StyLoadedBundle *bundle, int number, const StyStyle *style, StyError *error);

/* "KEY=VALUE" for all styles, "STYLE.KEY=VALUE" for the one of that name or number; in memory. STY_ERROR_USAGE; `what`
 * names the option. */
StyStatus sty_set_bundle_parameter(const char *what, const char *text, StyLoadedBundle *bundle, StyError *error);

/* Puts the parameters and the index into the bundle's folder `path` in one step; all other files stay as they are. */
StyStatus sty_save_parameters(const char *path, const StyLoadedBundle *bundle, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
