/* Speed and memory beside libraries as they are, and of whole processes; all else
 * is measured by `stylut bench`. What is compared runs alternately, so that both
 * meet the same weather on the machine. Prints CSV lines
 *   row,variant,runs,median_ms,rate,rate_unit,ratio,reference
 * where the ratio is the reference's time over the row's (above 1: faster than
 * the reference); for memory, the bytes taken over the bytes held. Nothing is
 * judged here.
 * Usage: bench SECTION STYLUT EXEMPLARS SCRATCH, with the program decode beside bench; each section wants a process
 * of its own, because a child's peak memory starts at its parent's. */
#include <embree3/rtcore.h>
#include <fcntl.h>
#include <flann/flann.h>
#include <limits.h>
#include <math.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "stylut/chart.h"
#include "stylut/file.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"
#include "stylut/json.h"
#include "stylut/lut.h"

/* All odd, so that a median is one of the runs. */
enum { RUNS = 7, STARTS = 11, MEMORY_RUNS = 3, LARGEST_RUNS = STARTS };
enum { WIDTH = 1920, HEIGHT = 1080, PIXELS = WIDTH * HEIGHT };

static const int thread_counts[] = {1, 2};
enum { THREAD_COUNTS = sizeof thread_counts / sizeof *thread_counts };

/* What main was called with. */
typedef struct Paths {
  const char *bench, *stylut, *exemplars, *scratch;
} Paths;

/* ---- failing ---- */

static void fail(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));
static void fail(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fprintf(stderr, "bench: ");
  vfprintf(stderr, format, arguments);
  fprintf(stderr, "\n");
  va_end(arguments);
  exit(EXIT_FAILURE);
}

static void require(StyStatus status, const StyError *error) {
  if (status) fail("%s", error->text);
}

static void *allocate(size_t size) {
  void *memory = malloc(size);
  if (!memory) fail("found too little memory for %zu bytes", size);
  return memory;
}

static char *join(const char *folder, const char *name) {
  char *path = sty_join_path(folder, name);
  if (!path) fail("found too little memory for a path");
  return path;
}

/* ---- times ---- */

typedef struct Series {
  double values[LARGEST_RUNS];
  int count;
} Series;

static void add_value(Series *series, double value) { series->values[series->count++] = value; }

static double get_median(const Series *series) {
  Series sorted = *series;
  return sty_find_median(sorted.values, sorted.count);
}

/* ---- rows ---- */

/* Numbers that don't apply are NAN and leave their field empty. */
static void print_number(double value) {
  if (isnan(value))
    printf(",");
  else
    printf("%.3f,", value);
}

static void print_row(const char *row, const char *variant, const Series *times, double rate, const char *unit,
                      double ratio, const char *reference) {
  printf("%s,%s,%d,", row, variant, times->count);
  print_number(get_median(times));
  print_number(rate);
  printf("%s,", unit);
  print_number(ratio);
  printf("%s\n", reference);
  fflush(stdout);
}

/* A row whose rate is `work` a second; `work` is in units that `unit` names, e.g. millions of rays. */
static void print_times(const char *row, const char *variant, const Series *times, double work, const char *unit,
                        const Series *reference, const char *reference_name) {
  const double median = get_median(times);
  const double ratio = reference ? get_median(reference) / median : NAN;
  print_row(row, variant, times, work / median * 1e3, unit, ratio, reference ? reference_name : "");
}

/* "WHAT, 1 thread" without the comma, which CSV would mind. */
static const char *name_threads(char *out, size_t size, const char *what, int threads) {
  snprintf(out, size, "%s %d thread%s", what, threads, threads == 1 ? "" : "s");
  return out;
}

/* ---- processes ---- */

/* Runs a program to its successful end; milliseconds. Its stdout goes to the file `output`. */
static double run_program(const char *const *arguments, const char *output) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t child;
  int status = -1;
  const double start = sty_get_milliseconds();
  if (posix_spawn(&child, arguments[0], &actions, NULL, (char *const *)arguments, environ) != 0)
    fail("%s does not start", arguments[0]);
  if (waitpid(child, &status, 0) != child || status != 0)
    fail("%s %s: found status %d, expected success", arguments[0], arguments[1], status);
  const double time = sty_get_milliseconds() - start;
  posix_spawn_file_actions_destroy(&actions);
  return time;
}

/* ---- the bare ray loop ---- */

/* Packets, their order and the start of orthographic rays, as in src/guide/trace.c. */
enum { BLOCK_WIDTH = 4, BLOCK_HEIGHT = 2, BLOCK = BLOCK_WIDTH * BLOCK_HEIGHT, TILE = 32 };
enum { COLUMNS = (WIDTH + TILE - 1) / TILE, ROWS = (HEIGHT + TILE - 1) / TILE };
static const double start_slack = 1.0 / 1024;

typedef struct Bare {
  const StyCamera *camera;
  RTCDevice device;
  RTCScene tree;
  double sums[COLUMNS * ROWS]; /* of distances; one a tile, so that the result is used */
  size_t hits[COLUMNS * ROWS];
} Bare;

static void build_bare(Bare *bare, const StyMesh *mesh) {
  bare->device = rtcNewDevice("threads=1");
  bare->tree = rtcNewScene(bare->device);
  rtcSetSceneFlags(bare->tree, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(bare->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0,
                             3 * sizeof *mesh->positions, mesh->vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices, 0,
                             3 * sizeof *mesh->indices, mesh->triangle_count);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(bare->tree, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(bare->tree);
  if (rtcGetDeviceError(bare->device) != RTC_ERROR_NONE) fail("Embree fails on %zu triangles", mesh->triangle_count);
}

static void release_bare(Bare *bare) {
  rtcReleaseScene(bare->tree);
  rtcReleaseDevice(bare->device);
}

static void set_ray(const StyCamera *camera, int x, int y, struct RTCRayHit8 *packet, int i) {
  const double s = ((x + 0.5) / WIDTH * 2 - 1) * camera->half_width;
  const double t = (1 - (y + 0.5) / HEIGHT * 2) * camera->half_height;
  double origin[3], direction[3];
  for (int k = 0; k < 3; k++) {
    const double film = s * camera->right[k] + t * camera->up[k];
    origin[k] = camera->perspective ? camera->eye[k] : camera->eye[k] + film + start_slack * camera->back[k];
    direction[k] = camera->perspective ? film - camera->back[k] : -camera->back[k];
  }
  packet->ray.org_x[i] = (float)origin[0];
  packet->ray.org_y[i] = (float)origin[1];
  packet->ray.org_z[i] = (float)origin[2];
  packet->ray.dir_x[i] = (float)direction[0];
  packet->ray.dir_y[i] = (float)direction[1];
  packet->ray.dir_z[i] = (float)direction[2];
  packet->ray.tnear[i] = 0;
  packet->ray.tfar[i] = INFINITY;
  packet->ray.mask[i] = ~0u;
  packet->hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  packet->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
}

static void trace_bare_block(Bare *bare, long tile, struct RTCIntersectContext *context, int x0, int y0) {
  _Alignas(32) struct RTCRayHit8 packet = {0};
  _Alignas(32) int valid[BLOCK];
  for (int i = 0; i < BLOCK; i++) {
    const int x = x0 + i % BLOCK_WIDTH, y = y0 + i / BLOCK_WIDTH;
    valid[i] = x < WIDTH && y < HEIGHT ? -1 : 0;
    set_ray(bare->camera, x, y, &packet, i);
  }
  rtcIntersect8(valid, bare->tree, context, &packet);
  for (int i = 0; i < BLOCK; i++) {
    if (!valid[i] || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    bare->sums[tile] += (double)packet.ray.tfar[i];
    bare->hits[tile]++;
  }
}

static StyStatus trace_bare_tile(void *context, long tile, StyError *error) {
  (void)error;
  Bare *bare = context;
  const int x0 = (int)(tile % COLUMNS) * TILE, y0 = (int)(tile / COLUMNS) * TILE;
  struct RTCIntersectContext rays;
  rtcInitIntersectContext(&rays);
  rays.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  bare->sums[tile] = 0;
  bare->hits[tile] = 0;
  for (int y = y0; y < y0 + TILE; y += BLOCK_HEIGHT)
    for (int x = x0; x < x0 + TILE; x += BLOCK_WIDTH) trace_bare_block(bare, tile, &rays, x, y);
  return STY_OK;
}

/* Milliseconds. */
static double trace_bare(Bare *bare, int threads) {
  const StyRun run = {.threads = threads};
  const double start = sty_get_milliseconds();
  require(sty_parallel_for(&run, COLUMNS * ROWS, trace_bare_tile, bare, NULL), NULL);
  return sty_get_milliseconds() - start;
}

/* ---- section: guide ---- */

static const StyView three_quarter = {.azimuth = 35, .elevation = 20, .fov = 35, .margin = 0.05};

static StyScene *read_creature(const char *path) {
  StyError error;
  StyMesh *mesh = NULL;
  StyScene *scene = NULL;
  require(sty_read_mesh(path, NULL, &mesh, &error), &error);
  require(sty_wrap_mesh(&mesh, &scene, &error), &error);
  return scene;
}

static StyCamera fit_camera(const StyScene *scene) {
  StyError error;
  StyCamera camera;
  require(sty_fit_camera(scene, &three_quarter, WIDTH, HEIGHT, &camera, &error), &error);
  return camera;
}

/* Takes rows as a file would, but doesn't write them. */
static StyStatus count_covered(void *context, StyImage *rows, StyError *error) {
  (void)error;
  size_t *count = context;
  const float *covered = sty_find_channel(rows, "A");
  for (size_t i = 0; i < sty_count_pixels(rows); i++) *count += covered[i] > 0;
  return STY_OK;
}

/* Both loops must have done the same work: edges may fall to either side, no more. */
static void compare_hits(const Bare *bare, size_t covered) {
  size_t hits = 0;
  double sum = 0;
  for (int i = 0; i < COLUMNS * ROWS; i++) {
    hits += bare->hits[i];
    sum += bare->sums[i];
  }
  const size_t difference = hits > covered ? hits - covered : covered - hits;
  if (!isfinite(sum) || difference > PIXELS / 10000)
    fail("the bare loop hits %zu pixels and the guide covers %zu", hits, covered);
}

typedef struct GuideTimes {
  Series rays; /* rays and shading alone */
  Series call; /* with the tree */
} GuideTimes;

static void time_guide(const StyScene *scene, const StyCamera *camera, unsigned groups, int threads, const Bare *bare,
                       GuideTimes *times) {
  const StyTraceOptions options = {.width = WIDTH, .height = HEIGHT, .groups = groups, .contour = {1, 1}};
  const StyRun run = {.threads = threads};
  StyError error;
  StyTraceTimes parts;
  size_t covered = 0;
  const StyRowSink sink = {count_covered, &covered};
  const double start = sty_get_milliseconds();
  require(sty_trace_rows(scene, camera, &options, &run, &sink, &parts, &error), &error);
  add_value(&times->call, sty_get_milliseconds() - start);
  add_value(&times->rays, parts.trace_ms);
  compare_hits(bare, covered);
}

/* The guide's rays beside the bare loop's, for one camera and number of threads. */
static void bench_rays(const char *what, const StyScene *scene, const StyCamera *camera, int threads) {
  static const char *const lists[] = {"normal,depth", "all"};
  static const char *const names[] = {"normal+depth", "all channels"};
  static Bare bare;
  unsigned groups[2];
  Series rays = {0}, call = {0};
  GuideTimes times[2] = {0};
  for (int g = 0; g < 2; g++) require(sty_parse_channels("bench", lists[g], &groups[g], NULL), NULL);
  bare.camera = camera;
  for (int run = 0; run < RUNS; run++) {
    const double start = sty_get_milliseconds();
    build_bare(&bare, scene->meshes[0]);
    add_value(&rays, trace_bare(&bare, threads));
    add_value(&call, sty_get_milliseconds() - start);
    for (int g = 0; g < 2; g++) time_guide(scene, camera, groups[g], threads, &bare, &times[g]);
    release_bare(&bare);
  }
  const double work = PIXELS / 1e6;
  char row[64], variant[64];
  name_threads(row, sizeof row, what, threads);
  print_times(row, "bare loop", &rays, work, "Mrays/s", NULL, NULL);
  for (int g = 0; g < 2; g++) print_times(row, names[g], &times[g].rays, work, "Mrays/s", &rays, "bare loop");
  print_times(row, "bare loop and tree", &call, work, "Mrays/s", NULL, NULL);
  for (int g = 0; g < 2; g++) {
    snprintf(variant, sizeof variant, "%s whole call", names[g]);
    print_times(row, variant, &times[g].call, work, "Mrays/s", &call, "bare loop and tree");
  }
}

/* Mesh to distances without a picture. */
static double run_bare(const char *mesh) {
  static Bare bare;
  const double start = sty_get_milliseconds();
  StyScene *scene = read_creature(mesh);
  const StyCamera camera = fit_camera(scene);
  bare.camera = &camera;
  build_bare(&bare, scene->meshes[0]);
  trace_bare(&bare, 0);
  release_bare(&bare);
  sty_destroy_scene(&scene);
  return sty_get_milliseconds() - start;
}

/* The whole command, from process start to the picture in its place. */
static void bench_guide_command(const Paths *paths, const char *mesh) {
  char *picture = join(paths->scratch, "guide.exr");
  const char *const lists[] = {"normal,depth", "all"}, *const names[] = {"normal+depth", "all channels"};
  Series bare = {0}, whole[2] = {0};
  for (int run = 0; run < RUNS; run++) {
    add_value(&bare, run_bare(mesh));
    for (int g = 0; g < 2; g++) {
      const char *const command[] = {paths->stylut, "guide",      "scene",  mesh, "--view", "three-quarter", "--size",
                                     "1920x1080",   "--channels", lists[g], "-o", picture,  "--quiet",       NULL};
      add_value(&whole[g], run_program(command, "/dev/null"));
    }
  }
  const double work = PIXELS / 1e6;
  print_times("guide command", "bare loop with mesh and tree", &bare, work, "Mrays/s", NULL, NULL);
  for (int g = 0; g < 2; g++)
    print_times("guide command", names[g], &whole[g], work, "Mrays/s", &bare, "bare loop with mesh and tree");
  free(picture);
}

static void bench_guide(const Paths *paths) {
  char *mesh = join(paths->exemplars, "creature.ply");
  StyScene *scene = read_creature(mesh);
  const StyCamera camera = fit_camera(scene);
  StyCamera near = camera; /* the body fills the picture: all rays are shaded */
  near.half_width /= 4;
  near.half_height /= 4;
  for (int t = 0; t < THREAD_COUNTS; t++) bench_rays("guide", scene, &camera, thread_counts[t]);
  for (int t = 0; t < THREAD_COUNTS; t++) bench_rays("guide close-up", scene, &near, thread_counts[t]);
  sty_destroy_scene(&scene);
  bench_guide_command(paths, mesh);
  free(mesh);
}

/* ---- section: lut ---- */

enum { SPHERE = 512, TABLE = 256 };

static const StyLutSpec table_spec = {.width = TABLE, .height = TABLE};

static StySites *collect_sphere(void) {
  StyError error;
  StyImage *guide = NULL;
  StySites *sites = NULL;
  require(sty_make_sphere_guide(SPHERE, SPHERE, STY_GUIDE_NORMAL, &guide, &error), &error);
  require(sty_collect_sites("sphere", guide, &sites, &error), &error);
  sty_destroy_image(&guide);
  return sites;
}

static double time_engine(const StyEngine *engine, const StySites *sites, int threads) {
  const StyRun run = {.threads = threads};
  StyError error;
  StyLut *lut = NULL;
  const double start = sty_get_milliseconds();
  require(sty_build_lut(sites, engine, NULL, &table_spec, &run, &lut, &error), &error);
  const double time = sty_get_milliseconds() - start;
  sty_destroy_lut(&lut);
  return time;
}

/* FLANN as one finds it: one neighbour, whichever of several it happens to be. */
static double time_flann(const StySites *sites, int threads) {
  StyError error;
  StyLut *lut = NULL;
  const size_t texels = sty_count_texels(&table_spec);
  float *queries = allocate(2 * texels * sizeof *queries), *distances = allocate(texels * sizeof *distances), speedup;
  int *found = allocate(texels * sizeof *found);
  require(sty_create_lut(&table_spec, sites->width, sites->height, &lut, &error), &error);
  const double start = sty_get_milliseconds();
  struct FLANNParameters parameters = DEFAULT_FLANN_PARAMETERS;
  parameters.algorithm = FLANN_INDEX_KDTREE_SINGLE;
  parameters.leaf_max_size = 10;
  parameters.cores = threads;
  parameters.log_level = FLANN_LOG_NONE;
  for (size_t t = 0; t < texels; t++)
    sty_get_texel_value(&table_spec, (int)(t % TABLE), (int)(t / TABLE), queries + 2 * t);
  flann_index_t index = flann_build_index_float(sites->values, (int)sites->count, 2, &speedup, &parameters);
  if (!index || flann_find_nearest_neighbors_index_float(index, queries, (int)texels, found, distances, 1, &parameters))
    fail("FLANN fails on %zu points", sites->count);
  for (size_t t = 0; t < texels; t++) lut->pixels[t] = sites->pixels[found[t]];
  flann_free_index_float(index, &parameters);
  const double time = sty_get_milliseconds() - start;
  sty_destroy_lut(&lut);
  free(queries);
  free(distances);
  free(found);
  return time;
}

/* The library raw, beside our engine of it, which `stylut bench` has a row for. */
static void bench_lut(const Paths *paths) {
  (void)paths;
  StySites *sites = collect_sphere();
  const StyEngine *peer = NULL;
  StyError error;
  require(sty_find_engine("bench", "flann-single", &peer, &error), &error);
  Series ours[THREAD_COUNTS] = {0}, raw[THREAD_COUNTS] = {0};
  for (int run = 0; run < RUNS; run++)
    for (int t = 0; t < THREAD_COUNTS; t++) {
      add_value(&ours[t], time_engine(peer, sites, thread_counts[t]));
      add_value(&raw[t], time_flann(sites, thread_counts[t]));
    }
  for (int t = 0; t < THREAD_COUNTS; t++) {
    char row[64];
    print_times(name_threads(row, sizeof row, "lut", thread_counts[t]), "raw FLANN k=1 no ties", &raw[t],
                (double)TABLE * TABLE / 1e6, "Mtexels/s", &ours[t], peer->name);
  }
  sty_destroy_sites(&sites);
}

/* ---- section: startup ---- */

static void bench_startup(const Paths *paths) {
  char *picture = join(paths->scratch, "smallest.exr");
  const char *const nothing[] = {"/bin/true", NULL, NULL}, *const version[] = {paths->stylut, "--version", NULL};
  const char *const smallest[] = {paths->stylut, "guide", "sphere", "--size", "8", "-o", picture, "--quiet", NULL};
  Series least = {0}, ours = {0}, loaded = {0};
  for (int run = 0; run < STARTS; run++) {
    add_value(&least, run_program(nothing, "/dev/null"));
    add_value(&ours, run_program(version, "/dev/null"));
    add_value(&loaded, run_program(smallest, "/dev/null"));
  }
  print_times("startup", "/bin/true", &least, 1, "starts/s", NULL, NULL);
  print_times("startup", "stylut --version", &ours, 1, "starts/s", &least, "/bin/true");
  print_times("startup", "8x8 picture: image module", &loaded, 1, "starts/s", &least, "/bin/true");
  free(picture);
}

/* ---- section: batch ---- */

enum { STYLES = 256, BATCH_RUNS = 5 };

/* STYLES pictures in `folder`, no two the same, and a manifest of them all beside it. Where masks differ, each has a
 * pixel without paint that is its own, and so a table of its own. */
static void paint_styles(const Paths *paths, const char *folder, bool masks_differ, char (*painted)[PATH_MAX],
                         const char *manifest) {
  static const char *const names[] = {"charcoal", "oil", "pencil", "stipple", "watercolour"};
  enum { NAMES = sizeof names / sizeof *names };
  StyImage *images[NAMES];
  StyError error;
  for (int n = 0; n < NAMES; n++) {
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/spheres/%s.png", paths->exemplars, names[n]);
    require(sty_read_image(path, &images[n], &error), &error);
  }
  if (mkdir(folder, 0777) != 0) fail("%s cannot be made", folder);
  for (int i = 0; i < STYLES; i++) {
    StyImage *image = images[i % NAMES];
    float *alpha = sty_find_channel(image, "A") + (image->height / 2) * image->width + image->width / 4 + i;
    for (size_t p = 0; p < sty_count_pixels(image); p++) image->data[p] *= 0.99f; /* the red */
    if (masks_differ) *alpha = 0;
    snprintf(painted[i], sizeof painted[i], "%s/%d.png", folder, i);
    require(sty_write_image(painted[i], image, &error), &error);
    *alpha = 1;
  }
  for (int n = 0; n < NAMES; n++) sty_destroy_image(&images[n]);
  FILE *file = fopen(manifest, "w");
  if (!file ||
      fprintf(file, "{\"schema\": \"stylut-bundle/1\", \"styles\": [{\"glob\": \"%s/*.png\"}]}",
              strrchr(folder, '/') + 1) < 0 ||
      fclose(file) != 0)
    fail("%s cannot be written", manifest);
}

/* From the guide to the table. */
static double time_table(const StyImage *guide, const StyEngine *engine, int threads) {
  StyError error;
  StySites *sites = NULL;
  const double start = sty_get_milliseconds();
  require(sty_collect_sites("sphere", guide, &sites, &error), &error);
  const double collected = sty_get_milliseconds() - start;
  const double time = collected + time_engine(engine, sites, threads);
  sty_destroy_sites(&sites);
  return time;
}

/* Many styles packed beside the least that it must do: decoding its pictures with OpenImageIO, and building its tables.
 */
static void bench_batch_of(const Paths *paths, const char *row, bool masks_differ, int threads) {
  static char painted[STYLES][PATH_MAX];
  static const char *decode[STYLES + 3];
  char *manifest = join(paths->scratch, masks_differ ? "own.json" : "one.json");
  char *folder = join(paths->scratch, masks_differ ? "own" : "one");
  char decoder[PATH_MAX], count[16];
  paint_styles(paths, folder, masks_differ, painted, manifest);
  snprintf(decoder, sizeof decoder, "%.*sdecode", (int)(strrchr(paths->bench, '/') + 1 - paths->bench), paths->bench);
  snprintf(count, sizeof count, "%d", threads);
  decode[0] = decoder;
  decode[1] = count;
  for (int i = 0; i < STYLES; i++) decode[2 + i] = painted[i];
  StyImage *guide = NULL;
  const StyEngine *engine = NULL;
  StyError error;
  require(sty_make_sphere_guide(SPHERE, SPHERE, STY_GUIDE_NORMAL, &guide, &error), &error);
  require(sty_find_engine("bench", "grid", &engine, &error), &error);
  Series least = {0}, packed = {0}, cold = {0}, again = {0};
  for (int run = 0; run < BATCH_RUNS; run++) {
    char out[PATH_MAX], bundle[PATH_MAX];
    snprintf(out, sizeof out, "%s.%d", folder, run);
    snprintf(bundle, sizeof bundle, "%s.packed%d", folder, run);
    const char *const pack[] = {paths->stylut, "pack", manifest, "-o", bundle, "-j", count, "--quiet", NULL};
    const char *const batch[] = {paths->stylut, "batch", manifest, "-o", out, "-j", count, "--quiet", NULL};
    double time = run_program(decode, "/dev/null");
    for (int table = 0; table < (masks_differ ? STYLES : 1); table++) time += time_table(guide, engine, threads);
    add_value(&least, time);
    add_value(&packed, run_program(pack, "/dev/null"));
    add_value(&cold, run_program(batch, "/dev/null"));
    add_value(&again, run_program(batch, "/dev/null"));
  }
  sty_destroy_image(&guide);
  const char *reference = "decoding and tables";
  print_times(row, reference, &least, STYLES, "styles/s", NULL, NULL);
  print_times(row, "pack", &packed, STYLES, "styles/s", &least, reference);
  print_times(row, "batch", &cold, STYLES, "styles/s", &least, reference);
  print_times(row, "batch nothing changed", &again, STYLES, "styles/s", &least, reference);
  free(folder);
  free(manifest);
}

static void bench_batch(const Paths *paths) {
  const int threads = thread_counts[THREAD_COUNTS - 1];
  bench_batch_of(paths, "256 styles a table each", true, threads);
  bench_batch_of(paths, "256 styles one table", false, threads);
}

/* ---- section: memory ---- */

/* What a command with --format json said of itself. */
typedef struct Account {
  Series times, peaks; /* milliseconds, bytes */
  double unique;       /* of a table's sites */
} Account;

static Account account_for(const Paths *paths, const char *const *command) {
  char *report = join(paths->scratch, "report.json");
  Account account = {0};
  for (int run = 0; run < MEMORY_RUNS; run++) {
    StyDocument document;
    StyError error;
    double peak = 0;
    add_value(&account.times, run_program(command, report));
    require(sty_read_document(report, &document, &error), &error);
    require(sty_get_number(&document, NULL, document.root, "peak_bytes", 1, 1e15, &peak, &error), &error);
    require(sty_get_number(&document, NULL, document.root, "unique", 0, 1e15, &account.unique, &error), &error);
    sty_close_document(&document);
    add_value(&account.peaks, peak);
  }
  free(report);
  return account;
}

/* `idle` is the same command with next to nothing to do, `held` the bytes of its own data. */
static void print_memory(const char *row, const char *variant, const Account *busy, const Account *idle, double held) {
  const double taken = get_median(&busy->peaks) - get_median(&idle->peaks);
  char reference[64];
  snprintf(reference, sizeof reference, "%.1f MB of data", held / 1e6);
  print_row(row, variant, &busy->times, taken / 1e6, "MB over idle", taken / held, reference);
}

static void print_idle(const char *row, const Account *idle) {
  print_row(row, "idle: everything loaded", &idle->times, get_median(&idle->peaks) / 1e6, "MB", NAN, "");
}

static void write_triangle(const char *path) {
  FILE *file = fopen(path, "w");
  if (!file) fail("%s cannot be written", path);
  fputs(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
      file);
  if (fclose(file) != 0) fail("%s cannot be written", path);
}

static Account trace_for_memory(const Paths *paths, const char *mesh, const char *size) {
  char *picture = join(paths->scratch, "memory.exr");
  const char *const command[] = {paths->stylut, "guide", "scene", mesh,    "--view",   "three-quarter", "--size", size,
                                 "--channels",  "all",   "-o",    picture, "--format", "json",          NULL};
  const Account account = account_for(paths, command);
  free(picture);
  return account;
}

static void bench_guide_memory(const Paths *paths) {
  char *mesh = join(paths->exemplars, "creature.ply"), *triangle = join(paths->scratch, "triangle.ply");
  write_triangle(triangle);
  const Account idle = trace_for_memory(paths, triangle, "8"), busy = trace_for_memory(paths, mesh, "1920x1080");
  StyScene *scene = read_creature(mesh);
  const double picture = 18.0 * PIXELS * sizeof(float); /* all channels, were they held at once */
  const double vertices = (double)scene->meshes[0]->vertex_count * 6 * sizeof(float);
  const double triangles = (double)scene->meshes[0]->triangle_count * 4 * sizeof(uint32_t);
  print_idle("memory of guide scene", &idle);
  print_memory("memory of guide scene", "1920x1080 all channels", &busy, &idle, picture + vertices + triangles);
  sty_destroy_scene(&scene);
  free(mesh);
  free(triangle);
}

static Account index_for_memory(const Paths *paths, int side, int size) {
  char *guide = join(paths->scratch, "sphere.exr"), *table = join(paths->scratch, "lut.exr"), sides[16], sizes[16];
  snprintf(sides, sizeof sides, "%d", side);
  snprintf(sizes, sizeof sizes, "%d", size);
  const char *const sphere[] = {paths->stylut, "guide", "sphere", "--size",  sides, "--channels",
                                "normal",      "-o",    guide,    "--quiet", NULL};
  const char *const lut[] = {paths->stylut, "lut", guide, "--size", sizes, "-o", table, "--format", "json", NULL};
  run_program(sphere, "/dev/null");
  const Account account = account_for(paths, lut);
  free(guide);
  free(table);
  return account;
}

static void bench_lut_memory(const Paths *paths) {
  static const int sides[] = {512, 1024}, sizes[] = {256, 1024};
  const Account idle = index_for_memory(paths, 8, 8);
  print_idle("memory of lut", &idle);
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      const Account busy = index_for_memory(paths, sides[a], sizes[b]);
      const double guide = 4.0 * sides[a] * sides[a] * sizeof(float); /* A and normal */
      const double sites = busy.unique * (2 * sizeof(float) + sizeof(uint32_t));
      const double table = (double)sizes[b] * sizes[b] * (sizeof(uint32_t) + sizeof(float));
      char variant[64];
      snprintf(variant, sizeof variant, "sphere %d to table %d", sides[a], sizes[b]);
      print_memory("memory of lut", variant, &busy, &idle, guide + sites + table);
    }
}

static void bench_memory(const Paths *paths) {
  bench_guide_memory(paths);
  bench_lut_memory(paths);
}

/* ---- main ---- */

int main(int argc, char **argv) {
  static const struct {
    const char *name;
    void (*run)(const Paths *paths);
  } sections[] = {{"guide", bench_guide},
                  {"lut", bench_lut},
                  {"startup", bench_startup},
                  {"batch", bench_batch},
                  {"memory", bench_memory}};
  for (size_t s = 0; argc == 5 && s < sizeof sections / sizeof *sections; s++) {
    if (strcmp(argv[1], sections[s].name) != 0) continue;
    const Paths paths = {argv[0], argv[2], argv[3], argv[4]};
    sections[s].run(&paths);
    return EXIT_SUCCESS;
  }
  fail("usage: bench guide|lut|startup|batch|memory STYLUT EXEMPLARS SCRATCH");
}
