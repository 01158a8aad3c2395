#include "scene/simplifier.h"

#include <stdlib.h>
#include <string.h>

#include "bridge/surface.h"
#include "scene/corners.h"
#include "scene/forest.h"
#include "scene/soup.h"

/* A chart is triangles that hang together without a seam. Within one, a point has one vertex. */
typedef struct Wedge {
  uint32_t point, chart, vertex;
} Wedge;

struct StySimplifier {
  const StyMesh *mesh;
  StySoup soup;
  uint32_t *charts; /* 1 per triangle of the soup */
  Wedge *wedges;    /* sorted */
  size_t wedge_count;
  StySurface *base, *last;
};

static const uint32_t NONE = UINT32_MAX;

/* ---- charts ---- */

/* The vertex that a triangle of the soup has at a point; NONE: it isn't there. */
static uint32_t find_own_vertex(const StySoup *soup, size_t triangle, uint32_t point) {
  for (size_t k = 0; k < 3; k++)
    if (soup->corners[3 * triangle + k] == point) return soup->mesh->indices[3 * (size_t)soup->triangles[triangle] + k];
  return NONE;
}

static bool is_smooth(const StySoup *soup, const StyWinding *winding, const StyEdge *a, const StyEdge *b) {
  const size_t s = a->corner / 3, t = b->corner / 3;
  const uint32_t low = winding->origins[a->low], high = winding->origins[a->high];
  return sty_get_part(soup->mesh, soup->triangles[s]) == sty_get_part(soup->mesh, soup->triangles[t]) &&
         find_own_vertex(soup, s, low) == find_own_vertex(soup, t, low) &&
         find_own_vertex(soup, s, high) == find_own_vertex(soup, t, high);
}

static StyStatus find_charts(StySimplifier *simplifier, const StyWinding *winding, StyError *error) {
  const StySoup *soup = &simplifier->soup;
  const size_t count = soup->triangle_count;
  StyEdge *edges = malloc(3 * count * sizeof *edges);
  uint32_t *charts = simplifier->charts = malloc(count * sizeof *charts);
  if (!edges || !charts) {
    free(edges);
    return sty_fail_memory(error, "mesh charts", (double)(3 * count * sizeof *edges));
  }
  for (uint32_t t = 0; t < count; t++) charts[t] = t;
  sty_list_edges(winding->corners, 3 * count, edges);
  for (size_t e = 1; e < 3 * count; e++)
    if (sty_is_same_edge(&edges[e - 1], &edges[e]) && is_smooth(soup, winding, &edges[e - 1], &edges[e]))
      join_sets(charts, edges[e - 1].corner / 3, edges[e].corner / 3);
  for (uint32_t t = 0; t < count; t++) charts[t] = find_root(charts, t);
  free(edges);
  return STY_OK;
}

/* ---- wedges ---- */

static bool is_beside(const Wedge *a, const Wedge *b) { return a->point == b->point && a->chart == b->chart; }

static StyStatus list_wedges(StySimplifier *simplifier, StyError *error) {
  const StySoup *soup = &simplifier->soup;
  const size_t count = 3 * soup->triangle_count;
  Wedge *wedges = simplifier->wedges = malloc(count * sizeof *wedges);
  if (!wedges) return sty_fail_memory(error, "mesh charts", (double)(count * sizeof *wedges));
  for (size_t c = 0; c < count; c++)
    wedges[c] = (Wedge){soup->corners[c], simplifier->charts[c / 3],
                        soup->mesh->indices[3 * (size_t)soup->triangles[c / 3] + c % 3]};
  qsort(wedges, count, sizeof *wedges, sty_compare_triples);
  for (size_t c = 0; c < count; c++)
    if (c == 0 || sty_compare_triples(&wedges[c], &wedges[simplifier->wedge_count - 1]) != 0)
      wedges[simplifier->wedge_count++] = wedges[c];
  return STY_OK;
}

/* The vertex at a point for a triangle that wasn't there at first. */
static uint32_t find_wedge(const StySimplifier *simplifier, uint32_t point, uint32_t chart) {
  size_t low = 0, high = simplifier->wedge_count;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    const Wedge *wedge = &simplifier->wedges[middle];
    if (wedge->point < point || (wedge->point == point && wedge->chart < chart))
      low = middle + 1;
    else
      high = middle;
  }
  const Wedge *found = &simplifier->wedges[low];
  return low < simplifier->wedge_count && found->point == point && found->chart == chart ? found->vertex : NONE;
}

/* ---- points that stay ---- */

/* Where a chart has two vertices at one point, as at a cut that ends within it, all triangles stay: none could tell
 * which is its own. Where the soup is no surface, several copies of a point would part. */
static unsigned char *fix_points(const StySimplifier *simplifier, const StyWinding *winding, StyError *error) {
  const StySoup *soup = &simplifier->soup;
  unsigned char *fixed = calloc(soup->point_count, 1), *is_torn = calloc(soup->point_count, 1);
  if (!fixed || !is_torn) {
    free(fixed);
    free(is_torn);
    sty_fail_memory(error, "mesh points", 2 * (double)soup->point_count);
    return NULL;
  }
  for (size_t w = 1; w < simplifier->wedge_count; w++)
    if (is_beside(&simplifier->wedges[w - 1], &simplifier->wedges[w])) is_torn[simplifier->wedges[w].point] = 1;
  for (size_t t = 0; t < soup->triangle_count; t++) {
    const uint32_t *c = &soup->corners[3 * t];
    if (is_torn[c[0]] || is_torn[c[1]] || is_torn[c[2]]) fixed[c[0]] = fixed[c[1]] = fixed[c[2]] = 1;
  }
  for (size_t p = soup->point_count; p < winding->point_count; p++) fixed[winding->origins[p]] = 1;
  free(is_torn);
  return fixed;
}

static float *copy_normals(const StySoup *soup, StyError *error) {
  const size_t count = 3 * soup->triangle_count;
  float *normals = malloc(3 * count * sizeof *normals);
  if (!normals) sty_fail_memory(error, "mesh normals", (double)(3 * count * sizeof *normals));
  for (size_t c = 0; normals && c < count; c++) {
    const uint32_t vertex = soup->mesh->indices[3 * (size_t)soup->triangles[c / 3] + c % 3];
    memcpy(&normals[3 * c], &soup->mesh->normals[3 * (size_t)vertex], 3 * sizeof *normals);
  }
  return normals;
}

static StyStatus open_surface(StySimplifier *simplifier, const StyTolerance *tolerance, StyError *error) {
  const StySoup *soup = &simplifier->soup;
  const StyTriangles triangles = {soup->points, soup->point_count, soup->corners, soup->triangle_count};
  StyWinding winding = {0};
  StyStatus status = sty_wind_triangles(&triangles, &winding, error);
  if (!status) status = find_charts(simplifier, &winding, error);
  if (!status) status = list_wedges(simplifier, error);
  unsigned char *fixed = status ? NULL : fix_points(simplifier, &winding, error);
  float *normals = fixed ? copy_normals(soup, error) : NULL;
  if (!status && !normals) status = STY_ERROR_LIBRARY;
  const StyCollapseRules rules = {simplifier->charts, normals, fixed, tolerance->angle, tolerance->distance};
  if (!status) status = sty_open_surface(&triangles, &winding, &rules, &simplifier->base, error);
  free(normals);
  free(fixed);
  sty_destroy_winding(&winding);
  return status;
}

StyStatus sty_open_simplifier(const StyMesh *mesh, const StyTolerance *tolerance, StySimplifier **out,
                              StyError *error) {
  StySimplifier *simplifier = calloc(1, sizeof *simplifier);
  if (!simplifier) return sty_fail_memory(error, "simplifier", sizeof *simplifier);
  simplifier->mesh = mesh;
  size_t copies;
  StyStatus status = sty_make_soup(mesh, &simplifier->soup, error);
  if (!status) status = sty_drop_copies(&simplifier->soup, &copies, error);
  if (!status) status = open_surface(simplifier, tolerance, error);
  if (status)
    sty_close_simplifier(&simplifier);
  else
    *out = simplifier;
  return status;
}

void sty_close_simplifier(StySimplifier **closed) {
  if (!closed || !*closed) return;
  StySimplifier *simplifier = *closed;
  sty_close_surface(&simplifier->base);
  sty_close_surface(&simplifier->last);
  sty_destroy_soup(&simplifier->soup);
  free(simplifier->charts);
  free(simplifier->wedges);
  free(simplifier);
  *closed = NULL;
}

/* ---- the mesh with fewer ---- */

/* What a mesh is beside its triangles. */
static StyStatus copy_frame(const StyMesh *from, StyMesh *to, StyError *error) {
  const size_t parts = (size_t)from->part_count;
  *to = (StyMesh){.part_count = from->part_count,
                  .scale = from->scale,
                  .vertices_read = from->vertices_read,
                  .repeated_faces = from->repeated_faces,
                  .flat_faces = from->flat_faces,
                  .crease_angle = from->crease_angle};
  for (int k = 0; k < 3; k++) {
    to->centre[k] = from->centre[k];
    to->minimum[k] = from->minimum[k];
    to->maximum[k] = from->maximum[k];
  }
  bool failed = from->path && !(to->path = strdup(from->path));
  if (from->paints && !failed) {
    to->paints = malloc(parts * sizeof *to->paints);
    failed = !to->paints;
    if (!failed) memcpy(to->paints, from->paints, parts * sizeof *to->paints);
  }
  return failed ? sty_fail_memory(error, "mesh", (double)(parts * sizeof *to->paints)) : STY_OK;
}

/* Numbers the vertices that are left, in the order of their first use: numbers[v] of the old vertex v. */
static StyStatus number_vertices(const StySimplifier *simplifier, const uint32_t *corners, const uint32_t *triangles,
                                 uint32_t *numbers, StyMesh *mesh, StyError *error) {
  memset(numbers, 0xFF, simplifier->mesh->vertex_count * sizeof *numbers);
  for (size_t c = 0; c < 3 * mesh->triangle_count; c++) {
    const uint32_t triangle = triangles[c / 3];
    uint32_t vertex = find_own_vertex(&simplifier->soup, triangle, corners[c]);
    if (vertex == NONE) vertex = find_wedge(simplifier, corners[c], simplifier->charts[triangle]);
    if (vertex == NONE)
      return sty_fail(error, STY_ERROR_LIBRARY, "simplifying: a triangle left its chart, expected it to stay");
    if (numbers[vertex] == NONE) numbers[vertex] = (uint32_t)mesh->vertex_count++;
    mesh->indices[c] = numbers[vertex];
  }
  return STY_OK;
}

static StyStatus copy_vertices(const StyMesh *from, const uint32_t *numbers, StyMesh *to, StyError *error) {
  to->positions = calloc(3 * to->vertex_count + 1, sizeof *to->positions);
  to->normals = malloc(3 * to->vertex_count * sizeof *to->normals);
  if (from->uvs) to->uvs = malloc(2 * to->vertex_count * sizeof *to->uvs);
  if (!to->positions || !to->normals || (from->uvs && !to->uvs))
    return sty_fail_memory(error, "mesh vertices", (double)(32 * to->vertex_count));
  for (size_t v = 0; v < from->vertex_count; v++) {
    const size_t n = numbers[v];
    if (numbers[v] == NONE) continue;
    memcpy(&to->positions[3 * n], &from->positions[3 * v], 3 * sizeof *to->positions);
    memcpy(&to->normals[3 * n], &from->normals[3 * v], 3 * sizeof *to->normals);
    if (from->uvs) memcpy(&to->uvs[2 * n], &from->uvs[2 * v], 2 * sizeof *to->uvs);
  }
  return STY_OK;
}

static StyStatus fill_mesh(const StySimplifier *simplifier, StyMesh *mesh, StyError *error) {
  const StyMesh *from = simplifier->mesh;
  const size_t count = mesh->triangle_count = sty_count_surface(simplifier->last);
  uint32_t *corners = malloc(3 * count * sizeof *corners), *triangles = malloc(count * sizeof *triangles),
           *numbers = malloc(from->vertex_count * sizeof *numbers);
  mesh->indices = malloc(3 * count * sizeof *mesh->indices);
  if (from->part_ids) mesh->part_ids = malloc(count * sizeof *mesh->part_ids);
  StyStatus status = STY_OK;
  if (!corners || !triangles || !numbers || !mesh->indices || (from->part_ids && !mesh->part_ids))
    status = sty_fail_memory(error, "mesh triangles", (double)(32 * count));
  if (!status) {
    sty_list_surface(simplifier->last, corners, triangles);
    for (size_t t = 0; t < count && from->part_ids; t++)
      mesh->part_ids[t] = from->part_ids[simplifier->soup.triangles[triangles[t]]];
    status = number_vertices(simplifier, corners, triangles, numbers, mesh, error);
  }
  if (!status) status = copy_vertices(from, numbers, mesh, error);
  free(corners);
  free(triangles);
  free(numbers);
  return status;
}

StyStatus sty_simplify_to(StySimplifier *simplifier, size_t target, StyMesh **out, StyError *error) {
  sty_close_surface(&simplifier->last);
  StyMesh *mesh = calloc(1, sizeof *mesh);
  if (!mesh) return sty_fail_memory(error, "mesh", sizeof *mesh);
  StyStatus status = copy_frame(simplifier->mesh, mesh, error);
  if (!status) status = sty_copy_surface(simplifier->base, &simplifier->last, error);
  if (!status) status = sty_collapse_surface(simplifier->last, target, error);
  if (!status) status = fill_mesh(simplifier, mesh, error);
  if (status)
    sty_destroy_mesh(&mesh);
  else
    *out = mesh;
  return status;
}

void sty_keep_simplified(StySimplifier *simplifier) {
  if (!simplifier->last) return;
  sty_close_surface(&simplifier->base);
  simplifier->base = simplifier->last;
  simplifier->last = NULL;
}
