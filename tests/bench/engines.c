/* The engine `grid` against the best of nanoflann, FLANN and CGAL, case by case:
 * index and queries, one thread, all from the array of the guide's points to the
 * answers; one row of grid's begins at the guide's image. The peers know nothing of
 * equal points (CGAL's tree is even quadratic on them), so they are also given each
 * value once, found by our own collapsing, whose time then counts. All runs
 * alternate. Rows as in bench.c; the ratio is the best peer's time over ours. What
 * falls below its aim is said on stderr.
 * Usage: engines [DATA]: the folder of other projects' guides. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lut/engine.h"
#include "peers.h"
#include "stylut/chart.h"
#include "stylut/guide.h"
#include "stylut/image_io.h"

enum { RUNS = 5 };

static void require(StyStatus status, const StyError *error) {
  if (!status) return;
  fprintf(stderr, "engines: %s\n", error->text);
  exit(EXIT_FAILURE);
}

static void *allocate(size_t size) {
  void *memory = malloc(size);
  if (memory) return memory;
  fprintf(stderr, "engines: found too little memory for %zu bytes\n", size);
  exit(EXIT_FAILURE);
}

/* ---- guides ------------------------------------------------------------------- */

static uint64_t state = 1;

static double draw(void) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (double)(state >> 11) * 0x1p-53;
}

static void draw_sphere(int side, int i, float g[2]) {
  g[0] = (float)(2 * (i % side) + 1 - side) / (float)side;
  g[1] = (float)(side - 2 * (i / side) - 1) / (float)side;
}

static void draw_uniform(int side, int i, float g[2]) {
  (void)side, (void)i;
  g[0] = (float)(2 * draw() - 1);
  g[1] = (float)(2 * draw() - 1);
}

static void draw_circle(int side, int i, float g[2]) {
  (void)side, (void)i;
  const double angle = 2 * M_PI * draw();
  g[0] = (float)cos(angle);
  g[1] = (float)sin(angle);
}

static void draw_cluster(int side, int i, float g[2]) {
  (void)side, (void)i;
  g[0] = (float)(0.3 + 1e-5 * draw());
  g[1] = (float)(0.2 + 1e-5 * draw());
}

static void draw_two_clusters(int side, int i, float g[2]) {
  (void)side;
  g[0] = (float)((i & 1 ? 0.7 : -0.6) + 1e-3 * draw());
  g[1] = (float)((i & 1 ? 0.5 : -0.4) + 1e-3 * draw());
}

static void draw_equal(int side, int i, float g[2]) {
  (void)side, (void)i;
  g[0] = 0.3f;
  g[1] = 0.2f;
}

static void draw_cube(int side, int i, float g[2]) {
  (void)side;
  g[0] = i % 3 == 0 ? 0.7f : i % 3 == 1 ? -0.6f : 0.1f;
  g[1] = i % 3 == 0 ? -0.3f : i % 3 == 1 ? -0.4f : 0.8f;
}

static StyImage *make_guide(int side, void (*draw_value)(int side, int i, float g[2])) {
  static const char *const names[] = {"A", "normal.X", "normal.Y"};
  StyError error;
  StyImage *guide = NULL;
  require(sty_create_image(side, side, 3, names, 32, &guide, &error), &error);
  const int count = side * side;
  for (int i = 0; i < count; i++) {
    float g[2];
    draw_value(side, i, g);
    guide->data[i] = draw_value != draw_sphere || g[0] * g[0] + g[1] * g[1] <= 1;
    guide->data[count + i] = g[0];
    guide->data[2 * count + i] = g[1];
  }
  return guide;
}

static StyImage *read_guide(const char *folder, const char *name) {
  char path[4096];
  StyError error;
  StyImage *guide = NULL;
  snprintf(path, sizeof path, "%s/%s", folder, name);
  if (sty_read_image(path, &guide, &error)) return NULL;
  require(sty_import_guide(path, &guide, &error), &error);
  return guide;
}

/* ---- times -------------------------------------------------------------------- */

static double get_median(const double times[RUNS]) {
  double sorted[RUNS];
  memcpy(sorted, times, sizeof sorted);
  return sty_find_median(sorted, RUNS);
}

/* The time from the points to the table; `collecting` gets the time from the image
 * to the points. */
static double time_grid(const StyImage *guide, int size, int threads, double *collecting, StyLut **out) {
  const StyRun run = {.threads = threads};
  const StyLutSpec spec = {.width = size, .height = size};
  const StyEngine *engine = NULL;
  StyError error;
  StySites *sites = NULL;
  sty_destroy_lut(out);
  require(sty_find_engine("bench", "grid", &engine, &error), &error);
  const double start = sty_get_milliseconds();
  require(sty_collect_sites("guide", guide, &sites, &error), &error);
  const double collected = sty_get_milliseconds();
  require(sty_build_lut(sites, engine, NULL, &spec, &run, out, &error), &error);
  const double time = sty_get_milliseconds() - collected;
  *collecting = collected - start;
  sty_destroy_sites(&sites);
  return time;
}

/* ---- a case ------------------------------------------------------------------- */

static const char *const units[] = {"plain", "avx2", "avx512"};
enum { UNITS = 3, PEERS = 5 };

typedef struct Entrant {
  const char *name;
  Peer *search;
  bool collapsed;
} Entrant;

static const Entrant peers[PEERS] = {
    {"nanoflann", search_with_nanoflann, false},       {"nanoflann, each value once", search_with_nanoflann, true},
    {"FLANN single", search_with_flann, false},        {"FLANN single, each value once", search_with_flann, true},
    {"CGAL, each value once", search_with_cgal, true},
};

typedef struct Results {
  double peers[PEERS][RUNS], grid[UNITS][RUNS], both[RUNS];
  double whole[RUNS]; /* the best unit, from the guide's image */
} Results;

/* Where one run of a peer takes longer, no more are made. */
static const double patience = 5000; /* milliseconds */

/* Entrants that would take minutes to hours: FLANN where points are equally far or
 * clustered; everyone who is given a value a million times. */
typedef enum Spared { NOBODY, FLANN, UNCOLLAPSED } Spared;

static bool is_spared(const Entrant *peer, Spared spared) {
  return (spared == FLANN && peer->search == search_with_flann) || (spared == UNCOLLAPSED && !peer->collapsed);
}

static void run_case(const StyImage *guide, int size, Spared spared, Results *r) {
  const StyLutSpec spec = {.width = size, .height = size};
  const size_t texels = sty_count_texels(&spec);
  StyError error;
  StySites *sites = NULL;
  StyPoints points;
  StyLut *lut = NULL;
  require(sty_collect_sites("guide", guide, &sites, &error), &error);
  const double start = sty_get_milliseconds();
  require(sty_collapse_sites(sites, &spec, &points, &error), &error);
  const double collapsing = sty_get_milliseconds() - start;
  float *queries = allocate(2 * texels * sizeof *queries);
  int *nearest = allocate(texels * sizeof *nearest);
  for (size_t t = 0; t < texels; t++) sty_get_texel_value(&spec, (int)t % size, (int)t / size, queries + 2 * t);
  for (int run = 0; run < RUNS; run++) {
    double collecting = 0;
    for (int p = 0; p < PEERS; p++) {
      const bool once = peers[p].collapsed;
      if (is_spared(&peers[p], spared))
        r->peers[p][run] = INFINITY;
      else if (run > 0 && r->peers[p][run - 1] > patience)
        r->peers[p][run] = r->peers[p][run - 1];
      else
        r->peers[p][run] =
            (once ? collapsing : 0) + peers[p].search(once ? points.values : sites->values,
                                                      once ? points.count : sites->count, queries, texels, nearest);
    }
    for (int u = 0; u < UNITS; u++) {
      setenv("STYLUT_VECTOR", units[u], 1);
      r->grid[u][run] = time_grid(guide, size, 1, &collecting, &lut);
    }
    r->whole[run] = collecting + r->grid[UNITS - 1][run];
    r->both[run] = time_grid(guide, size, 2, &collecting, &lut);
  }
  free(queries);
  free(nearest);
  sty_free_points(&points);
  sty_destroy_sites(&sites);
  sty_destroy_lut(&lut);
}

static void print_row(const char *row, const char *variant, double time, double texels, double ratio,
                      const char *reference) {
  printf("%s,%s,%d,%.3f,%.3f,Mtexels/s,", row, variant, RUNS, time, texels / time / 1e3);
  if (ratio > 0) printf("%.3f", ratio);
  printf(",%s\n", reference);
  fflush(stdout);
}

/* What the engine is to reach, over the best peer: in plain C, and with the best
 * vector unit there is. */
typedef struct Aim {
  double plain, best;
  bool as_they_come; /* over peers that get all points, as other projects call them */
} Aim;

static const Aim not_slower = {0.8, 0.8, false}, several_times = {3, 5, false};
static const double threads_aim = 1.5, threads_from = 50; /* milliseconds on one thread */

static double get_best_peer(const Results *r, bool as_they_come) {
  double best = INFINITY;
  for (int p = 0; p < PEERS; p++)
    if (!as_they_come || !peers[p].collapsed) best = fmin(best, get_median(r->peers[p]));
  return best;
}

static void expect_aim(const char *row, const char *what, double found, double aim) {
  if (!(found >= aim))
    fprintf(stderr, "engines: below aim: %s, %s: found %.2f, expected %.2f\n", row, what, found, aim);
}

static void expect_aims(const char *row, const Results *r, const Aim *aim) {
  const double peer = get_best_peer(r, aim->as_they_come), plain = get_median(r->grid[0]);
  const double one = get_median(r->grid[UNITS - 1]);
  expect_aim(row, "plain C over the best peer", peer / plain, aim->plain);
  expect_aim(row, "the best unit over the best peer", peer / fmin(one, get_median(r->grid[1])), aim->best);
  if (one > threads_from) expect_aim(row, "two threads over one", one / get_median(r->both), threads_aim);
}

static void bench_case(const char *name, StyImage *guide, int size, Spared spared, const Aim *aim) {
  if (!guide) {
    fprintf(stderr, "engines: %s is not there\n", name);
    return;
  }
  static Results r;
  run_case(guide, size, spared, &r);
  char row[96], reference[64];
  int best = 0;
  const double texels = (double)size * size;
  snprintf(row, sizeof row, "lut %s to %d", name, size);
  for (int p = 1; p < PEERS; p++)
    if (get_median(r.peers[p]) < get_median(r.peers[best])) best = p;
  for (int p = 0; p < PEERS; p++) {
    char variant[64];
    if (isinf(get_median(r.peers[p]))) continue;
    snprintf(variant, sizeof variant, "%s", peers[p].name);
    for (char *c = variant; *c; c++) *c = *c == ',' ? ':' : *c; /* CSV */
    print_row(row, variant, get_median(r.peers[p]), texels, 0, "");
    if (p == best) memcpy(reference, variant, sizeof reference);
  }
  for (int u = 0; u < UNITS; u++) {
    char variant[32];
    snprintf(variant, sizeof variant, "grid %s", units[u]);
    print_row(row, variant, get_median(r.grid[u]), texels, get_median(r.peers[best]) / get_median(r.grid[u]),
              reference);
  }
  print_row(row, "grid from the image", get_median(r.whole), texels, get_median(r.peers[best]) / get_median(r.whole),
            reference);
  print_row(row, "grid 2 threads", get_median(r.both), texels, get_median(r.grid[UNITS - 1]) / get_median(r.both),
            "1 thread");
  expect_aims(row, &r, aim);
  sty_destroy_image(&guide);
}

int main(int argc, char **argv) {
  bench_case("float sphere 512", make_guide(512, draw_sphere), 512, NOBODY, &several_times);
  bench_case("float sphere 1024", make_guide(1024, draw_sphere), 1024, NOBODY, &several_times);
  bench_case("uniform 512", make_guide(512, draw_uniform), 512, NOBODY, &not_slower);
  bench_case("uniform 1000", make_guide(1000, draw_uniform), 1024, NOBODY, &not_slower);
  bench_case("cluster of 1e-5 1000", make_guide(1000, draw_cluster), 1024, NOBODY, &not_slower);
  bench_case("two clusters 1000", make_guide(1000, draw_two_clusters), 1024, FLANN, &not_slower);
  bench_case("circle 245", make_guide(245, draw_circle), 512, FLANN, &not_slower);
  bench_case("circle 1000", make_guide(1000, draw_circle), 1024, FLANN, &not_slower);
  bench_case("all equal 1000", make_guide(1000, draw_equal), 1024, UNCOLLAPSED, &not_slower);
  bench_case("cube 1000", make_guide(1000, draw_cube), 1024, UNCOLLAPSED, &not_slower);
  if (argc < 2) return EXIT_SUCCESS;
  bench_case("normals.png", read_guide(argv[1], "styleblit/normals.png"), 512, NOBODY, &(Aim){25, 25, true});
  bench_case("golem.001.png", read_guide(argv[1], "frames/golem.001.png"), 512, NOBODY, &(Aim){12, 12, true});
  bench_case("s_normals.png", read_guide(argv[1], "unity-plugin/s_normals.png"), 512, NOBODY, &(Aim){12, 12, true});
  return EXIT_SUCCESS;
}
