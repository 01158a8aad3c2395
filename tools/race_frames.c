/* Guides of a torus, 1920 x 1080, and bundles packed. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands.h"
#include "options.h"
#include "passes.h"
#include "races.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/lut.h"
#include "stylut/pack.h"
#include "stylut/runtime.h"

/* ---- guides ----------------------------------------------------------------------- */

enum { TABLE = 256 };
enum { WIDTH = 1920, HEIGHT = 1080, PIXELS = WIDTH * HEIGHT };

/* A torus of a great many triangles, in trace space as it is. */
enum { AROUND = 400, ACROSS = 200 };
static const double ring_radius = 0.65, tube_radius = 0.3;

static void set_torus_vertex(StyMesh *mesh, int around, int across) {
  const double a = 2 * M_PI * around / AROUND, b = 2 * M_PI * across / ACROSS;
  const double normal[3] = {cos(a) * cos(b), sin(b), sin(a) * cos(b)}, centre[3] = {cos(a), 0, sin(a)};
  const size_t v = (size_t)around * ACROSS + (size_t)across;
  for (int k = 0; k < 3; k++) {
    mesh->positions[3 * v + (size_t)k] = (float)(ring_radius * centre[k] + tube_radius * normal[k]);
    mesh->normals[3 * v + (size_t)k] = (float)normal[k];
  }
}

static void set_torus_quad(StyMesh *mesh, int around, int across) {
  const int next_around = (around + 1) % AROUND, next_across = (across + 1) % ACROSS;
  const uint32_t corners[4] = {(uint32_t)(around * ACROSS + across), (uint32_t)(around * ACROSS + next_across),
                               (uint32_t)(next_around * ACROSS + next_across),
                               (uint32_t)(next_around * ACROSS + across)};
  const uint32_t triangles[6] = {corners[0], corners[1], corners[2], corners[0], corners[2], corners[3]};
  const size_t first = 2 * ((size_t)around * ACROSS + (size_t)across);
  memcpy(mesh->indices + 3 * first, triangles, sizeof triangles);
  mesh->part_ids[first] = mesh->part_ids[first + 1] = 1;
}

static StyStatus make_torus(StyMesh **out, StyError *error) {
  const size_t vertices = (size_t)AROUND * ACROSS, triangles = 2 * vertices;
  StyMesh *mesh = calloc(1, sizeof *mesh);
  if (!mesh) return sty_fail_memory(error, "bench", sizeof *mesh);
  *mesh = (StyMesh){.vertex_count = vertices, .triangle_count = triangles, .part_count = 1, .scale = 1};
  mesh->positions = calloc(3 * vertices + 1, sizeof *mesh->positions);
  mesh->normals = calloc(3 * vertices, sizeof *mesh->normals);
  mesh->indices = calloc(3 * triangles, sizeof *mesh->indices);
  mesh->part_ids = calloc(triangles, sizeof *mesh->part_ids);
  if (!mesh->positions || !mesh->normals || !mesh->indices || !mesh->part_ids) {
    sty_destroy_mesh(&mesh);
    return sty_fail_memory(error, "bench", (double)vertices * 56);
  }
  for (int around = 0; around < AROUND; around++)
    for (int across = 0; across < ACROSS; across++) {
      set_torus_vertex(mesh, around, across);
      set_torus_quad(mesh, around, across);
    }
  for (int k = 0; k < 3; k++) {
    mesh->maximum[k] = k == 1 ? tube_radius : ring_radius + tube_radius;
    mesh->minimum[k] = -mesh->maximum[k];
  }
  *out = mesh;
  return STY_OK;
}

typedef struct Tracing {
  StyScene *scene;
  StyCamera camera;
} Tracing;

static StyStatus open_tracing(Tracing *out, StyError *error) {
  static const StyView view = {.azimuth = 35, .elevation = 40, .margin = 0.05};
  *out = (Tracing){0};
  StyMesh *torus = NULL;
  StyStatus status = make_torus(&torus, error);
  if (!status) status = sty_wrap_mesh(&torus, &out->scene, error);
  return status ? status : sty_fit_camera(out->scene, &view, WIDTH, HEIGHT, &out->camera, error);
}

static StyStatus trace(const Tracing *tracing, unsigned groups, int threads, StyImage **out, StyError *error) {
  const StyTraceOptions options = {.width = WIDTH, .height = HEIGHT, .groups = groups, .contour = sty_default_contour};
  const StyRun run = {.threads = threads};
  return sty_trace_guide(tracing->scene, &tracing->camera, &options, &run, NULL, out, error);
}

static const char *const channel_lists[] = {"normal,depth", "all"};

static StyStatus trace_once(const Entrant *self, double *milliseconds, StyError *error) {
  StyImage *guide = NULL;
  unsigned groups = 0;
  StyStatus status = sty_parse_channels("bench", channel_lists[self->choice], &groups, error);
  const double start = sty_get_milliseconds();
  if (!status) status = trace(self->subject, groups, self->threads, &guide, error);
  *milliseconds = sty_get_milliseconds() - start;
  sty_destroy_image(&guide);
  return status;
}

StyStatus measure_guides(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  static const char *const names[] = {"normal+depth", "all channels"};
  Tracing tracing = {0};
  Race *race = calloc(1, sizeof *race);
  StyStatus status = race ? open_tracing(&tracing, error) : sty_fail_memory(error, "bench", sizeof *race);
  for (int threads = 1; !status && threads <= 2; threads++)
    for (int list = 0; list < 2; list++) {
      Entrant *entrant = enter(race, (Entrant){.run = trace_once,
                                               .subject = &tracing,
                                               .choice = list,
                                               .threads = threads,
                                               .work = PIXELS / 1e6,
                                               .rate_unit = "Mrays/s",
                                               .reference = threads == 2 ? list : list - 1,
                                               .reference_name = threads == 2 ? race_threads[1] : names[0]});
      snprintf(entrant->row, sizeof entrant->row, "guide torus %s", race_threads[threads]);
      snprintf(entrant->variant, sizeof entrant->variant, "%s", names[list]);
    }
  if (!status) status = run_race(race, repeats, run, results, error);
  sty_destroy_scene(&tracing.scene);
  free(race);
  return status;
}

/* ---- bundles ---------------------------------------------------------------------- */

/* A folder with an exemplar, a manifest of several styles, and the bundle. */
enum { STYLES = 5 };
typedef struct Workshop {
  char folder[256];
  char exemplar[300], manifest[300], bundle[300];
} Workshop;

static StyStatus open_workshop(Workshop *out, StyError *error) {
  const char *base = getenv("TMPDIR");
  const int length = snprintf(out->folder, sizeof out->folder, "%s/stylut-bench.XXXXXX", base && *base ? base : "/tmp");
  if (length >= (int)sizeof out->folder || !mkdtemp(out->folder)) {
    const int cause = length >= (int)sizeof out->folder ? ENAMETOOLONG : errno;
    *out->folder = 0;
    return sty_fail(error, STY_ERROR_FILE, "temporary folder: cannot create: %s; expected TMPDIR to be writable",
                    strerror(cause));
  }
  snprintf(out->exemplar, sizeof out->exemplar, "%s/exemplar.png", out->folder);
  snprintf(out->manifest, sizeof out->manifest, "%s/styles.json", out->folder);
  snprintf(out->bundle, sizeof out->bundle, "%s/bundle", out->folder);
  return STY_OK;
}

static void close_workshop(const Workshop *workshop) {
  if (!*workshop->folder) return;
  sty_remove_temporary_folder(workshop->bundle);
  sty_remove_temporary_folder(workshop->folder);
}

/* Strokes of a kind, with the sphere's outline; what they look like costs nothing. */
static StyStatus paint_exemplar(const Workshop *workshop, StyError *error) {
  static const char *const names[] = {"R", "G", "B", "A"};
  StyImage *sphere = NULL, *image = NULL;
  StyStatus status = make_sphere(32, &sphere, error);
  if (!status) status = sty_create_image(SPHERE, SPHERE, 4, names, 8, &image, error);
  const size_t pixels = (size_t)SPHERE * SPHERE;
  const float *covered = status ? NULL : sty_find_channel(sphere, "A");
  for (size_t i = 0; !status && i < pixels; i++) {
    const double x = (double)(i % SPHERE), y = (double)(i / SPHERE);
    for (size_t c = 0; c < 3; c++)
      image->data[c * pixels + i] = (float)(0.5 + 0.5 * sin(x / (5 + (double)c) + 3 * sin(y / 29)));
    image->data[3 * pixels + i] = covered[i];
  }
  if (!status) status = sty_write_image(workshop->exemplar, image, error);
  sty_destroy_image(&sphere);
  sty_destroy_image(&image);
  return status;
}

static StyStatus write_manifest(const Workshop *workshop, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_open_output(workshop->manifest, &output, error);
  if (status) return status;
  fprintf(output.stream, "{\"schema\": \"stylut-bundle/1\", \"styles\": [");
  for (int i = 0; i < STYLES; i++)
    fprintf(output.stream, "%s{\"name\": \"%d\", \"exemplar\": \"exemplar.png\"}", i ? ", " : "", i + 1);
  fprintf(output.stream, "]}\n");
  return sty_commit_output(&output, error);
}

static StyStatus furnish_workshop(Workshop *out, StyError *error) {
  StyStatus status = open_workshop(out, error);
  if (!status) status = paint_exemplar(out, error);
  return status ? status : write_manifest(out, error);
}

/* What the command does, without the start of a process. It prints its own error. */
static StyStatus pack_bundle(const Workshop *workshop) {
  char *arguments[] = {"stylut pack", (char *)workshop->manifest, "-o", (char *)workshop->bundle, "-q", NULL};
  return run_pack(5, arguments);
}

static StyStatus pack_once(const Entrant *self, double *milliseconds, StyError *error) {
  (void)error;
  const double start = sty_get_milliseconds();
  const StyStatus status = pack_bundle(self->subject);
  *milliseconds = sty_get_milliseconds() - start;
  return status ? STY_ERROR_LIBRARY : STY_OK;
}

/* What can't be spared: each picture decoded once, one table built. */
static StyStatus do_parts_once(const Entrant *self, double *milliseconds, StyError *error) {
  const Workshop *workshop = self->subject;
  const StyLutSpec spec = {.width = TABLE, .height = TABLE, .sampling = STY_SAMPLE_UNORM8};
  const StyEngine *engine = NULL;
  StyImage *guide = NULL;
  StySites *sites = NULL;
  StyLut *lut = NULL;
  StyStatus status = STY_OK;
  const double start = sty_get_milliseconds();
  for (int i = 0; !status && i < STYLES; i++) {
    StyImage *image = NULL;
    status = sty_read_image(workshop->exemplar, &image, error);
    sty_destroy_image(&image);
  }
  if (!status) status = sty_find_engine("bench", "auto", &engine, error);
  if (!status) status = make_sphere(32, &guide, error);
  if (!status) status = sty_collect_sites("sphere", guide, &sites, error);
  if (!status) status = sty_build_lut(sites, engine, NULL, &spec, NULL, &lut, error);
  *milliseconds = sty_get_milliseconds() - start;
  sty_destroy_lut(&lut);
  sty_destroy_sites(&sites);
  sty_destroy_image(&guide);
  return status;
}

StyStatus measure_packing(int repeats, const StyRun *run, RaceResults *results, StyError *error) {
  static const char *const parts = "parts: decode and one lut";
  Workshop workshop = {.folder = ""};
  Race *race = calloc(1, sizeof *race);
  StyStatus status = race ? furnish_workshop(&workshop, error) : sty_fail_memory(error, "bench", sizeof *race);
  if (!status) {
    const Entrant common = {.row = "pack", .subject = &workshop, .work = STYLES, .rate_unit = "styles/s"};
    Entrant *least = enter(race, common), *whole = enter(race, common);
    least->run = do_parts_once;
    least->reference = -1;
    snprintf(least->variant, sizeof least->variant, "%s", parts);
    whole->run = pack_once;
    whole->reference_name = parts;
    snprintf(whole->variant, sizeof whole->variant, "whole");
    status = run_race(race, repeats, run, results, error);
  }
  close_workshop(&workshop);
  free(race);
  return status;
}
