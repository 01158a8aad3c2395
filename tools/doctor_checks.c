#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "doctor.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"
#include "stylut/pack.h"

enum { SIDE = 96 };

static StyStatus fail_check(StyError *error, const char *found, const char *expected) {
  return sty_fail(error, STY_CHECK_FAILED, "found %s, expected %s", found, expected);
}

/* ---- pictures ---- */

static bool is_same_image(const StyImage *a, const StyImage *b) {
  return a->width == b->width && a->height == b->height && a->channel_count == b->channel_count &&
         memcmp(a->data, b->data, sty_count_pixels(a) * (size_t)a->channel_count * sizeof *a->data) == 0;
}

static StyStatus write_and_read(const char *folder, const char *name, const StyImage *image, StyError *error) {
  char *path = sty_join_path(folder, name);
  StyImage *read = NULL;
  StyStatus status = path ? sty_write_image(path, image, error) : sty_fail_memory(error, name, 0);
  if (!status) status = sty_read_image(path, &read, error);
  if (!status && !is_same_image(image, read))
    status = fail_check(error, "another picture than was written", "the same");
  sty_destroy_image(&read);
  free(path);
  return status;
}

static StyStatus check_pictures(const char *folder, StyError *error) {
  StyImage *guide = NULL, *bytes = NULL;
  StyStatus status = sty_make_sphere_guide(SIDE, SIDE, STY_GUIDE_NORMAL, &guide, error);
  if (!status) status = sty_encode_normals(guide, 8, &bytes, error);
  if (!status) status = write_and_read(folder, "sphere.exr", guide, error);
  if (!status) status = write_and_read(folder, "sphere.png", bytes, error);
  sty_destroy_image(&guide);
  sty_destroy_image(&bytes);
  return status;
}

/* ---- rays ---- */

static StyStatus write_text(const char *folder, const char *name, const char *text, char **path, StyError *error) {
  StyOutput output;
  *path = sty_join_path(folder, name);
  if (!*path) return sty_fail_memory(error, name, 0);
  const StyStatus status = sty_open_output(*path, &output, error);
  if (status) return status;
  fputs(text, output.stream);
  return sty_commit_output(&output, error);
}

/* A square that faces whoever looks: what is covered has one normal. */
static StyStatus check_normals(const StyImage *guide, StyError *error) {
  const float *covered = sty_find_channel(guide, "A"), *z = sty_find_channel(guide, "normal.Z");
  size_t pixels = 0, wrong = 0;
  for (size_t i = 0; covered && z && i < sty_count_pixels(guide); i++) {
    pixels += covered[i] > 0;
    wrong += covered[i] > 0 && !(z[i] > 0.9999f);
  }
  if (pixels > (size_t)SIDE * SIDE / 4 && wrong == 0) return STY_OK;
  return fail_check(error, "a square that faces elsewhere", "one that faces the camera");
}

static StyStatus check_rays(const char *folder, StyError *error) {
  char *mesh = NULL, *path = sty_join_path(folder, "square.exr");
  StyImage *guide = NULL;
  StyStatus status = path ? write_text(folder, "square.obj",
                                       "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n", &mesh, error)
                          : sty_fail_memory(error, folder, 0);
  char program[] = "stylut guide scene", size[] = "-s96x96", quiet[] = "-q", output[] = "-o";
  char *words[] = {program, mesh, size, quiet, output, path, NULL};
  if (!status && run_guide_scene(6, words) != STY_OK)
    status = fail_check(error, "a square that can't be traced", "a guide");
  if (!status) status = sty_read_image(path, &guide, error);
  if (!status) status = check_normals(guide, error);
  sty_destroy_image(&guide);
  free(mesh);
  free(path);
  return status;
}

/* ---- tables ---- */

static const char *const units[] = {"plain", "avx2", "avx512"}; /* a unit that isn't there is the next best */
enum { UNITS = sizeof units / sizeof *units };

/* Whatever STYLUT_VECTOR was comes back with end_units. */
static char *begin_units(void) {
  const char *asked = getenv("STYLUT_VECTOR");
  return asked ? strdup(asked) : NULL;
}

static void end_units(char *asked) {
  if (asked)
    setenv("STYLUT_VECTOR", asked, 1);
  else
    unsetenv("STYLUT_VECTOR");
  free(asked);
}

static StyStatus compare_tables(const StySites *sites, const StyLut *reference, const StyEngine *engine,
                                StyError *error) {
  const StyLutSpec spec = {.width = SIDE, .height = SIDE};
  StyStatus status = STY_OK;
  for (int unit = 0; !status && unit < UNITS; unit++)
    for (int threads = 1; !status && threads <= 2; threads++) {
      const StyRun run = {.threads = threads};
      StyLut *lut = NULL;
      setenv("STYLUT_VECTOR", units[unit], 1);
      status = sty_build_lut(sites, engine, NULL, &spec, &run, &lut, error);
      if (!status && memcmp(lut->pixels, reference->pixels, (size_t)SIDE * SIDE * sizeof *lut->pixels) != 0) {
        char found[128];
        snprintf(found, sizeof found, "another table by engine %s (%s, %d threads)", engine->name, units[unit],
                 threads);
        status = fail_check(error, found, "that of brute");
      }
      sty_destroy_lut(&lut);
    }
  return status;
}

static StyStatus check_tables(const char *folder, StyError *error) {
  (void)folder;
  const StyLutSpec spec = {.width = SIDE, .height = SIDE};
  const StyEngine *brute = NULL;
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyLut *reference = NULL;
  char *asked = begin_units();
  StyStatus status = sty_make_sphere_guide(SIDE, SIDE, STY_GUIDE_NORMAL, &guide, error);
  if (!status) status = sty_collect_sites("sphere", guide, &sites, error);
  if (!status) status = sty_find_engine("doctor", "brute", &brute, error);
  if (!status) status = sty_build_lut(sites, brute, NULL, &spec, NULL, &reference, error);
  for (int e = 0; !status && sty_engines[e].name; e++)
    if (sty_engines[e].exact) status = compare_tables(sites, reference, &sty_engines[e], error);
  end_units(asked);
  sty_destroy_lut(&reference);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
  return status;
}

/* ---- bundles and frames ---- */

enum { PIXELS = SIDE * SIDE };

static StyStatus compare_frames(const StyBundle *bundle, const uint8_t *guide, StyError *error) {
  static const StyRuntimePath paths[] = {STY_PATH_REFERENCE, STY_PATH_PORTABLE, STY_PATH_AVX2, STY_PATH_AVX512};
  static StyMatch matches[PIXELS];
  static uint8_t pictures[2][4 * PIXELS];
  const StyRect all = {0, 0, SIDE, SIDE};
  for (int p = 0; p < 4; p++) {
    uint8_t *picture = pictures[p > 0];
    const StyFrame frame = {.width = SIDE, .height = SIDE, .guide = guide, .style = 1, .path = paths[p]};
    StyRuntimeStatus status = sty_transfer_frame(bundle, &frame, all, matches);
    if (status == STY_RUNTIME_OK) status = sty_blend_frame(bundle, &frame, all, matches, 8, picture);
    if (status != STY_RUNTIME_OK)
      return sty_fail(error, STY_CHECK_FAILED, "found a frame that can't be stylized: %s",
                      sty_describe_runtime_status(status));
    if (p > 0 && memcmp(pictures[0], picture, sizeof pictures[0]) != 0)
      return fail_check(error, "another picture by a vector unit", "the reference's");
  }
  return STY_OK;
}

static StyStatus pack_sphere(const char *folder, char **bundle, StyError *error) {
  char *manifest = NULL;
  *bundle = sty_join_path(folder, "bundle");
  StyStatus status = *bundle
                         ? write_text(folder, "styles.json",
                                      "{\"schema\": \"stylut-bundle/1\", \"styles\": [{\"name\": \"a\", \"exemplar\": "
                                      "\"sphere.png\"}]}\n",
                                      &manifest, error)
                         : sty_fail_memory(error, folder, 0);
  char program[] = "stylut pack", quiet[] = "-q", output[] = "-o";
  char *words[] = {program, manifest, quiet, output, *bundle, NULL};
  if (!status && run_pack(5, words) != STY_OK)
    status = fail_check(error, "an exemplar that can't be packed", "a bundle");
  free(manifest);
  return status;
}

static StyStatus check_frames(const char *folder, StyError *error) {
  char *path = NULL;
  StyLoadedBundle bundle;
  StyImage *sphere = NULL, *encoded = NULL;
  uint8_t guide[4 * PIXELS];
  StyStatus status = pack_sphere(folder, &path, error);
  if (!status) status = sty_make_sphere_guide(SIDE, SIDE, STY_GUIDE_NORMAL, &sphere, error);
  if (!status) status = sty_encode_normals(sphere, 8, &encoded, error);
  if (!status) status = sty_convert_to_rgba8("sphere", encoded, guide, error);
  if (!status) status = sty_load_bundle(path, NULL, NULL, &bundle, error);
  if (!status) {
    status = compare_frames(&bundle.bundle, guide, error);
    sty_unload_bundle(&bundle);
  }
  if (path) sty_remove_temporary_folder(path);
  sty_destroy_image(&sphere);
  sty_destroy_image(&encoded);
  free(path);
  return status;
}

const Check checks[] = {
    {"pictures", "EXR and PNG hold what was written", check_pictures},
    {"rays", "a square is seen as it stands", check_rays},
    {"tables", "all exact engines, vector units and threads give the same", check_tables},
    {"frames", "a bundle is packed and loaded, and all vector units give the same picture", check_frames},
    {NULL, NULL, NULL},
};
