/* What lies around a point, its fan, is gathered for a block of points at a time: for all of a large mesh together it
 * would take as much memory as the mesh. */
#include "scene/normals.h"

#include <stdlib.h>
#include <string.h>

#include "scene/corners.h"
#include "scene/forest.h"
#include "scene/vector.h"

/* An edge that more triangles share than this is a tangle; it stays hard, and
 * comparing all its pairs stays cheap. */
enum { MOST_ON_EDGE = 8 };

/* Of points: a block is an eighth of the mesh, or this many; a thread takes so many of them at a time. */
enum { BLOCKS = 8, LEAST_BLOCK = 1 << 16, CHUNK = 1 << 10 };

typedef struct Smoothing {
  StyMesh *mesh;
  size_t vertex_capacity;
  uint32_t *points; /* the point of each vertex; NULL: its own number */
  size_t point_count;
  double cosine; /* facets that bend less than this are joined */
  /* The block: its points, and corners at them. */
  size_t first, count;
  uint32_t *begins;      /* count + 1 */
  uint32_t *corners;     /* those at point first + i from begins[i] on, rising */
  unsigned char *shared; /* 1: surfaces meet at this point without being smooth there */
} Smoothing;

/* An edge of a fan: to which point, on which of its corners' triangles, and whether that runs along it outward. */
typedef struct Spoke {
  uint32_t to, corner;
  bool outward;
} Spoke;

/* The corners at a point, numbered from 0. */
typedef struct Fan {
  size_t count;
  const uint32_t *corners;
  double (*facets)[3]; /* unit normals */
  double (*sums)[3];   /* of a set's facets, at its root; in the end their direction */
  Spoke *spokes;       /* 2 per corner */
  uint32_t *parents;   /* forest of corners that are smooth together; once summed, the root of each */
} Fan;

static uint32_t get_point(const Smoothing *s, size_t corner) {
  const uint32_t vertex = s->mesh->indices[corner];
  return s->points ? s->points[vertex] : vertex;
}

/* ---- a block of points ---- */

static void list_corners(Smoothing *s) {
  const size_t total = 3 * s->mesh->triangle_count;
  memset(s->begins, 0, (s->count + 1) * sizeof *s->begins);
  for (size_t c = 0; c < total; c++) {
    const size_t at = get_point(s, c) - s->first; /* wraps round below the block */
    if (at < s->count) s->begins[at + 1]++;
  }
  for (size_t i = 0; i < s->count; i++) s->begins[i + 1] += s->begins[i];
}

/* Beginnings move to ends as the corners arrive, and then back. */
static StyStatus open_block(Smoothing *s, StyError *error) {
  const size_t total = 3 * s->mesh->triangle_count;
  list_corners(s);
  const size_t held = s->begins[s->count];
  s->corners = malloc((held + 1) * sizeof *s->corners);
  s->shared = calloc(s->count, 1);
  if (!s->corners || !s->shared) return sty_fail_memory(error, "smooth normals", (double)(held * sizeof *s->corners));
  for (size_t c = 0; c < total; c++) {
    const size_t at = get_point(s, c) - s->first;
    if (at < s->count) s->corners[s->begins[at]++] = (uint32_t)c;
  }
  memmove(s->begins + 1, s->begins, s->count * sizeof *s->begins);
  s->begins[0] = 0;
  return STY_OK;
}

static void close_block(Smoothing *s) {
  free(s->corners);
  free(s->shared);
  s->corners = NULL;
  s->shared = NULL;
}

/* ---- a fan ---- */

static StyStatus open_fan(Fan *fan, size_t most, StyError *error) {
  fan->facets = malloc((most + 1) * sizeof *fan->facets);
  fan->sums = malloc((most + 1) * sizeof *fan->sums);
  fan->spokes = malloc((2 * most + 1) * sizeof *fan->spokes);
  fan->parents = malloc((most + 1) * sizeof *fan->parents);
  if (fan->facets && fan->sums && fan->spokes && fan->parents) return STY_OK;
  return sty_fail_memory(error, "smooth normals", (double)(most * 68));
}

static void close_fan(Fan *fan) {
  free(fan->facets);
  free(fan->sums);
  free(fan->spokes);
  free(fan->parents);
}

static void get_edge(const StyMesh *mesh, uint32_t from, uint32_t to, double out[3]) {
  const float *a = &mesh->positions[3 * (size_t)mesh->indices[from]],
              *b = &mesh->positions[3 * (size_t)mesh->indices[to]];
  for (int k = 0; k < 3; k++) out[k] = (double)b[k] - a[k];
}

/* From the triangle's first corner, so that all three find the same to the bit. */
static void get_facet(const StyMesh *mesh, uint32_t corner, double out[3]) {
  const uint32_t first = corner - corner % 3;
  double a[3], b[3];
  get_edge(mesh, first, first + 1, a);
  get_edge(mesh, first, first + 2, b);
  cross_vectors(a, b, out);
  normalize_vector(out);
}

static double get_angle(const StyMesh *mesh, uint32_t corner) {
  double a[3], b[3], normal[3];
  get_edge(mesh, corner, sty_next_corner(corner), a);
  get_edge(mesh, corner, sty_next_corner(sty_next_corner(corner)), b);
  cross_vectors(a, b, normal);
  return atan2(sqrt(dot_vectors(normal, normal)), dot_vectors(a, b));
}

static int compare_spokes(const void *a, const void *b) {
  const Spoke *x = a, *y = b;
  if (x->to != y->to) return x->to < y->to ? -1 : 1;
  return (x->corner > y->corner) - (x->corner < y->corner);
}

/* Most fans have a dozen of them, for which qsort is slow. */
static void sort_spokes(Spoke *spokes, size_t count) {
  if (count > 64) {
    qsort(spokes, count, sizeof *spokes, compare_spokes);
    return;
  }
  for (size_t i = 1; i < count; i++) {
    const Spoke moved = spokes[i];
    size_t at = i;
    for (; at > 0 && compare_spokes(&spokes[at - 1], &moved) > 0; at--) spokes[at] = spokes[at - 1];
    spokes[at] = moved;
  }
}

static void join_smooth_facets(Fan *fan, double cosine) {
  const size_t count = 2 * fan->count;
  for (size_t begin = 0, end; begin < count; begin = end) {
    for (end = begin + 1; end < count && fan->spokes[end].to == fan->spokes[begin].to;) end++;
    if (end - begin > MOST_ON_EDGE) continue;
    for (size_t i = begin; i < end; i++)
      for (size_t j = i + 1; j < end; j++) {
        const uint32_t a = fan->spokes[i].corner, b = fan->spokes[j].corner;
        if (!(dot_vectors(fan->facets[a], fan->facets[b]) < cosine)) join_sets(fan->parents, a, b);
      }
  }
}

static void sum_facets(Fan *fan, const StyMesh *mesh) {
  for (size_t i = 0; i < fan->count; i++) {
    const uint32_t root = fan->parents[i] = find_root(fan->parents, (uint32_t)i);
    const double angle = get_angle(mesh, fan->corners[i]);
    for (int k = 0; k < 3; k++) {
      const double part = angle * fan->facets[i][k];
      fan->sums[i][k] = part; /* a root comes before the others of its set */
      if (root != i) fan->sums[root][k] += part;
    }
  }
}

/* A set whose sum has no direction falls apart into its facets; its root, its lowest number, comes last. */
static void find_means(Fan *fan) {
  for (size_t i = fan->count; i-- > 0;) {
    double mean[3];
    memcpy(mean, fan->sums[fan->parents[i]], sizeof mean);
    if (!normalize_vector(mean)) {
      fan->parents[i] = (uint32_t)i;
      memcpy(mean, fan->facets[i], sizeof mean);
    }
    if (fan->parents[i] == i) memcpy(fan->sums[i], mean, sizeof mean);
  }
}

static void spread_fan(const Smoothing *s, size_t point, Fan *fan) {
  fan->corners = &s->corners[s->begins[point]];
  fan->count = s->begins[point + 1] - s->begins[point];
  for (uint32_t i = 0; i < fan->count; i++) {
    const uint32_t corner = fan->corners[i], next = sty_next_corner(corner);
    get_facet(s->mesh, corner, fan->facets[i]);
    fan->spokes[2 * i] = (Spoke){get_point(s, next), i, true};
    fan->spokes[2 * i + 1] = (Spoke){get_point(s, sty_next_corner(next)), i, false};
    fan->parents[i] = i;
  }
  sort_spokes(fan->spokes, 2 * fan->count);
  join_smooth_facets(fan, s->cosine);
  sum_facets(fan, s->mesh);
  find_means(fan);
}

/* ---- points that are smooth all round ---- */

static bool is_known(const float normal[3]) { return normal[0] != 0 || normal[1] != 0 || normal[2] != 0; }

/* Adding zero turns negative zero into zero, so that equal normals are equal bytes. */
static void set_normal(const double from[3], float out[3]) {
  for (int k = 0; k < 3; k++) out[k] = (float)from[k] + 0.0f;
}

/* Edges of two triangles that run the same way along it; each is found at one of its ends. */
static size_t count_clashes(const Fan *fan, size_t point) {
  size_t clashes = 0;
  const size_t count = 2 * fan->count;
  for (size_t begin = 0, end; begin < count; begin = end) {
    const Spoke *spokes = &fan->spokes[begin];
    for (end = begin + 1; end < count && fan->spokes[end].to == spokes->to;) end++;
    clashes += end - begin == 2 && spokes->to > point && spokes[0].outward == spokes[1].outward;
  }
  return clashes;
}

static void smooth_point(Smoothing *s, size_t point, Fan *fan, size_t *clashes) {
  spread_fan(s, point, fan);
  *clashes += count_clashes(fan, s->first + point);
  for (size_t i = 1; i < fan->count; i++) s->shared[point] |= fan->parents[i] != fan->parents[0];
  for (size_t i = 0; i < fan->count && !s->shared[point]; i++) {
    float *normal = &s->mesh->normals[3 * (size_t)s->mesh->indices[fan->corners[i]]];
    if (!is_known(normal)) set_normal(fan->sums[fan->parents[0]], normal);
  }
}

static size_t find_largest_fan(const Smoothing *s, size_t begin, size_t end) {
  size_t most = 0;
  for (size_t i = begin; i < end; i++) {
    const size_t count = s->begins[i + 1] - s->begins[i];
    most = count > most ? count : most;
  }
  return most;
}

static StyStatus smooth_chunk(void *context, long chunk, StyError *error) {
  Smoothing *s = context;
  Fan fan = {0};
  const size_t begin = (size_t)chunk * CHUNK, end = begin + CHUNK < s->count ? begin + CHUNK : s->count;
  const StyStatus status = open_fan(&fan, find_largest_fan(s, begin, end), error);
  size_t clashes = 0;
  for (size_t i = begin; i < end && !status; i++) smooth_point(s, i, &fan, &clashes);
#pragma omp atomic
  s->mesh->clashes += clashes;
  close_fan(&fan);
  return status;
}

/* ---- points where surfaces meet ---- */

static StyStatus keep_points(Smoothing *s, StyError *error) {
  if (s->points) return STY_OK;
  s->points = malloc(s->vertex_capacity * sizeof *s->points);
  if (!s->points) return sty_fail_memory(error, "mesh vertices", (double)(s->vertex_capacity * sizeof *s->points));
  for (size_t v = 0; v < s->mesh->vertex_count; v++) s->points[v] = (uint32_t)v;
  return STY_OK;
}

/* Grows *list to `count` floats or numbers. */
static bool grow(void *list, size_t count) {
  void **slot = list, *grown = realloc(*slot, count * sizeof(float));
  if (grown) *slot = grown;
  return grown;
}

static StyStatus reserve_vertex(Smoothing *s, StyError *error) {
  StyMesh *mesh = s->mesh;
  if (mesh->vertex_count < s->vertex_capacity) return STY_OK;
  const size_t capacity = s->vertex_capacity + s->vertex_capacity / 2 + 16;
  if (!grow(&mesh->positions, 3 * capacity + 1) || !grow(&mesh->normals, 3 * capacity) ||
      (mesh->uvs && !grow(&mesh->uvs, 2 * capacity)) || !grow(&s->points, capacity))
    return sty_fail_memory(error, "mesh vertices", (double)capacity * 36);
  s->vertex_capacity = capacity;
  return STY_OK;
}

/* The same vertex again, for another normal. */
static StyStatus repeat_vertex(Smoothing *s, uint32_t vertex, uint32_t *out, StyError *error) {
  StyMesh *mesh = s->mesh;
  const StyStatus status = reserve_vertex(s, error);
  if (status) return status;
  const size_t made = mesh->vertex_count++, from = vertex;
  memcpy(&mesh->positions[3 * made], &mesh->positions[3 * from], 3 * sizeof *mesh->positions);
  if (mesh->uvs) memcpy(&mesh->uvs[2 * made], &mesh->uvs[2 * from], 2 * sizeof *mesh->uvs);
  s->points[made] = s->points[from];
  *out = (uint32_t)made;
  return STY_OK;
}

/* A corner of a fan, by its vertex and the set that it is in. */
typedef struct Use {
  uint32_t vertex, set, corner;
} Use;

static int compare_uses(const void *a, const void *b) {
  const Use *x = a, *y = b;
  if (x->vertex != y->vertex) return x->vertex < y->vertex ? -1 : 1;
  if (x->set != y->set) return x->set < y->set ? -1 : 1;
  return (x->corner > y->corner) - (x->corner < y->corner);
}

/* One vertex per set: the first keeps its number. `uses` are all of one vertex. */
static StyStatus split_vertex(Smoothing *s, const Fan *fan, const Use *uses, size_t count, StyError *error) {
  uint32_t vertex = uses->vertex;
  if (is_known(&s->mesh->normals[3 * (size_t)vertex])) return STY_OK;
  for (size_t i = 0; i < count; i++) {
    const bool begins = i == 0 || uses[i].set != uses[i - 1].set;
    const StyStatus status = begins && i > 0 ? repeat_vertex(s, uses->vertex, &vertex, error) : STY_OK;
    if (status) return status;
    if (begins) set_normal(fan->sums[uses[i].set], &s->mesh->normals[3 * (size_t)vertex]);
    s->mesh->indices[fan->corners[uses[i].corner]] = vertex;
  }
  return STY_OK;
}

static StyStatus split_point(Smoothing *s, size_t point, Fan *fan, Use *uses, StyError *error) {
  spread_fan(s, point, fan);
  for (uint32_t i = 0; i < fan->count; i++) uses[i] = (Use){s->mesh->indices[fan->corners[i]], fan->parents[i], i};
  qsort(uses, fan->count, sizeof *uses, compare_uses);
  StyStatus status = STY_OK;
  for (size_t begin = 0, end; begin < fan->count && !status; begin = end) {
    for (end = begin + 1; end < fan->count && uses[end].vertex == uses[begin].vertex;) end++;
    status = split_vertex(s, fan, &uses[begin], end - begin, error);
  }
  return status;
}

/* In the order of the points, so that new vertices get the same numbers whatever the threads. */
static StyStatus split_points(Smoothing *s, StyError *error) {
  Fan fan = {0};
  const size_t most = find_largest_fan(s, 0, s->count);
  Use *uses = malloc((most + 1) * sizeof *uses);
  StyStatus status =
      uses ? keep_points(s, error) : sty_fail_memory(error, "smooth normals", (double)(most * sizeof *uses));
  if (!status) status = open_fan(&fan, most, error);
  for (size_t i = 0; i < s->count && !status; i++)
    if (s->shared[i]) status = split_point(s, i, &fan, uses, error);
  close_fan(&fan);
  free(uses);
  return status;
}

/* ---- the whole ---- */

static StyStatus smooth_block(Smoothing *s, const StyRun *run, StyError *error) {
  StyStatus status = open_block(s, error);
  if (!status) status = sty_parallel_for(run, (long)((s->count + CHUNK - 1) / CHUNK), smooth_chunk, s, error);
  if (!status && memchr(s->shared, 1, s->count)) status = split_points(s, error);
  close_block(s);
  return status;
}

static StyStatus smooth_blocks(Smoothing *s, const StyRun *run, StyError *error) {
  const size_t part = (s->point_count + BLOCKS - 1) / BLOCKS, step = part > LEAST_BLOCK ? part : LEAST_BLOCK;
  s->begins = malloc((step + 1) * sizeof *s->begins);
  StyStatus status = s->begins ? STY_OK : sty_fail_memory(error, "smooth normals", (double)(step * sizeof *s->begins));
  for (s->first = 0; s->first < s->point_count && !status; s->first += step) {
    s->count = s->point_count - s->first < step ? s->point_count - s->first : step;
    StyShare share = {run, (double)s->first / (double)s->point_count, (double)s->count / (double)s->point_count};
    const StyRun own = sty_share_run(&share);
    status = smooth_block(s, &own, error);
  }
  free(s->begins);
  return status;
}

/* Vertices at the same place are one point. */
static StyStatus number_points(Smoothing *s, StyError *error) {
  const StyMesh *mesh = s->mesh;
  const size_t count = mesh->vertex_count;
  s->points = malloc(count * sizeof *s->points);
  if (!s->points) return sty_fail_memory(error, "smooth normals", (double)(count * sizeof *s->points));
  const size_t size = 3 * sizeof *mesh->positions;
  const StyStatus status = sty_number_distinct(mesh->positions, size, count, size, s->points, &s->point_count, error);
  if (!status && s->point_count == count) {
    free(s->points);
    s->points = NULL;
  }
  return status;
}

/* Gives back what splitting reserved and did not need. */
static void trim_vertices(StyMesh *mesh) {
  grow(&mesh->positions, 3 * mesh->vertex_count + 1);
  grow(&mesh->normals, 3 * mesh->vertex_count);
  if (mesh->uvs) grow(&mesh->uvs, 2 * mesh->vertex_count);
}

static size_t count_known(const StyMesh *mesh) {
  size_t known = 0;
  for (size_t v = 0; v < mesh->vertex_count; v++) known += is_known(&mesh->normals[3 * v]);
  return known;
}

StyStatus sty_compute_normals(StyMesh *mesh, double crease_angle, const StyRun *run, StyError *error) {
  /* The slack covers rounding, so that 0 joins coplanar facets and 180 all. */
  Smoothing s = {
      .mesh = mesh, .vertex_capacity = mesh->vertex_count, .cosine = cos(crease_angle * (M_PI / 180)) - 1e-9};
  const size_t known = mesh->normals ? count_known(mesh) : 0;
  mesh->crease_angle = known ? -1 : crease_angle;
  mesh->clashes = 0;
  if (known == mesh->vertex_count) return STY_OK;
  StyStatus status = number_points(&s, error);
  if (!status && !mesh->normals) mesh->normals = calloc(3 * mesh->vertex_count, sizeof *mesh->normals);
  if (!status && !mesh->normals) status = sty_fail_memory(error, "smooth normals", 12.0 * (double)mesh->vertex_count);
  if (!status) status = smooth_blocks(&s, run, error);
  free(s.points);
  if (s.vertex_capacity > mesh->vertex_count) trim_vertices(mesh);
  return status;
}
