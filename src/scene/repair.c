#include "stylut/repair.h"

#include <stdlib.h>
#include <string.h>

#include "bridge/surface.h"
#include "scene/forest.h"
#include "scene/normals.h"
#include "scene/share.h"
#include "scene/soup.h"

/* ---- looking ---- */

static uint32_t *make_forest(size_t count, StyError *error) {
  uint32_t *parents = malloc(count * sizeof *parents);
  if (!parents) sty_fail_memory(error, "mesh survey", (double)(count * sizeof *parents));
  for (size_t i = 0; parents && i < count; i++) parents[i] = (uint32_t)i;
  return parents;
}

static size_t count_roots(const uint32_t *parents, size_t count) {
  size_t roots = 0;
  for (size_t i = 0; i < count; i++) roots += parents[i] == i;
  return roots;
}

/* What is known of one edge: of the triangles between `begin` and `end`. */
static void count_edge(const StySoup *soup, const StyEdge *begin, size_t triangles, StyMeshSurvey *survey) {
  survey->borders += triangles == 1;
  survey->tangles += triangles > 2;
  if (triangles == 2) survey->clashes += soup->corners[begin[0].corner] == soup->corners[begin[1].corner];
}

static size_t find_end(const StyEdge *edges, size_t begin, size_t count) {
  size_t end = begin + 1;
  while (end < count && sty_is_same_edge(&edges[end], &edges[begin])) end++;
  return end;
}

static StyStatus count_components(const StySoup *soup, const StyEdge *edges, StyMeshSurvey *survey, StyError *error) {
  const size_t count = 3 * soup->triangle_count;
  uint32_t *parents = make_forest(soup->triangle_count, error);
  if (!parents) return STY_ERROR_LIBRARY;
  for (size_t begin = 0, end; begin < count; begin = end) {
    end = find_end(edges, begin, count);
    count_edge(soup, &edges[begin], end - begin, survey);
    for (size_t i = begin + 1; i < end; i++) join_sets(parents, edges[begin].corner / 3, edges[i].corner / 3);
  }
  survey->components = count_roots(parents, soup->triangle_count);
  free(parents);
  return STY_OK;
}

/* Borders that touch at their points form one loop: a set of more than one point. */
static StyStatus count_holes(const StySoup *soup, const StyEdge *edges, StyMeshSurvey *survey, StyError *error) {
  const size_t count = 3 * soup->triangle_count;
  uint32_t *parents = make_forest(soup->point_count, error);
  unsigned char *is_loop = calloc(soup->point_count, 1);
  if (!parents || !is_loop) {
    free(parents);
    free(is_loop);
    return sty_fail_memory(error, "mesh survey", (double)(5 * soup->point_count));
  }
  for (size_t begin = 0, end; begin < count; begin = end) {
    end = find_end(edges, begin, count);
    if (end - begin == 1) join_sets(parents, edges[begin].low, edges[begin].high);
  }
  for (uint32_t p = 0; p < soup->point_count; p++)
    if (parents[p] != p) is_loop[find_root(parents, p)] = 1;
  for (size_t p = 0; p < soup->point_count; p++) survey->holes += is_loop[p];
  free(parents);
  free(is_loop);
  return STY_OK;
}

static StyStatus survey_soup(const StySoup *soup, StyMeshSurvey *survey, StyError *error) {
  const size_t count = 3 * soup->triangle_count;
  StyEdge *edges = malloc(count * sizeof *edges);
  if (!edges) return sty_fail_memory(error, "mesh survey", (double)(count * sizeof *edges));
  sty_list_edges(soup->corners, count, edges);
  StyStatus status = count_components(soup, edges, survey, error);
  if (!status && survey->borders) status = count_holes(soup, edges, survey, error);
  free(edges);
  return status;
}

/* The soup without copies stays with the caller. */
static StyStatus look(const StyMesh *mesh, StySoup *soup, StyMeshSurvey *out, StyError *error) {
  StyMeshSurvey survey = {.vertices = mesh->vertices_read,
                          .triangles = mesh->triangle_count,
                          .repeated = mesh->repeated_faces,
                          .flat = mesh->flat_faces};
  StyStatus status = sty_make_soup(mesh, soup, error);
  survey.points = soup->point_count;
  if (!status) status = sty_drop_copies(soup, &survey.copies, error);
  if (!status) status = survey_soup(soup, &survey, error);
  if (!status) *out = survey;
  return status;
}

StyStatus sty_survey_mesh(const StyMesh *mesh, StyMeshSurvey *out, StyError *error) {
  StySoup soup = {0};
  const StyStatus status = look(mesh, &soup, out, error);
  sty_destroy_soup(&soup);
  return status;
}

/* ---- repairing ---- */

/* CGAL takes the side of a piece's first triangle; here the fewer turn. Pieces hang together as they were wound. */
static StyStatus turn_fewer(const StySoup *soup, StyWinding *winding, StyError *error) {
  const size_t count = soup->triangle_count;
  uint32_t *parents = make_forest(count, error);
  StyEdge *edges = malloc(3 * count * sizeof *edges);
  size_t(*sides)[2] = calloc(count, sizeof *sides);
  if (parents && edges && sides) {
    sty_list_edges(winding->corners, 3 * count, edges);
    for (size_t begin = 0, end; begin < 3 * count; begin = end) {
      end = find_end(edges, begin, 3 * count);
      for (size_t i = begin + 1; i < end; i++) join_sets(parents, edges[begin].corner / 3, edges[i].corner / 3);
    }
    for (uint32_t t = 0; t < count; t++) sides[find_root(parents, t)][winding->turned[t]]++;
    for (uint32_t t = 0; t < count; t++) {
      const size_t *piece = sides[find_root(parents, t)];
      winding->turned[t] ^= piece[1] > piece[0];
    }
  }
  const bool done = parents && edges && sides;
  free(parents);
  free(edges);
  free(sides);
  return done ? STY_OK : sty_fail_memory(error, "mesh repair", (double)(count * 56));
}

/* Which of the soup's triangles to turn round; all stay where no neighbours clash. */
static StyStatus choose_sides(const StySoup *soup, const StyMeshSurvey *survey, StyWinding *out, StyError *error) {
  const StyTriangles triangles = {soup->points, soup->point_count, soup->corners, soup->triangle_count};
  if (!survey->clashes) {
    out->turned = calloc(soup->triangle_count, 1);
    return out->turned ? STY_OK : sty_fail_memory(error, "mesh repair", (double)soup->triangle_count);
  }
  const StyStatus status = sty_wind_triangles(&triangles, out, error);
  return status ? status : turn_fewer(soup, out, error);
}

static StyCorner *copy_corners(const StySoup *soup, const unsigned char *turned) {
  const bool forget = soup->mesh->crease_angle >= 0; /* computed: to be computed again */
  StyCorner *corners = malloc(3 * soup->triangle_count * sizeof *corners);
  for (size_t t = 0; corners && t < soup->triangle_count; t++)
    for (size_t k = 0; k < 3; k++) {
      const size_t from = turned[t] ? (3 - k) % 3 : k;
      StyCorner *corner = &corners[3 * t + k];
      *corner = sty_get_corner(soup->mesh, 3 * (size_t)soup->triangles[t] + from);
      if (forget) memset(corner->normal, 0, sizeof corner->normal);
    }
  return corners;
}

/* The triangles of `from` into `mesh`, which lets go of its own. */
static void replace_triangles(StyMesh *mesh, StyMesh *from) {
  free(mesh->positions);
  free(mesh->normals);
  free(mesh->uvs);
  free(mesh->indices);
  free(mesh->part_ids);
  mesh->vertex_count = from->vertex_count;
  mesh->triangle_count = from->triangle_count;
  mesh->positions = from->positions;
  mesh->normals = from->normals;
  mesh->uvs = from->uvs;
  mesh->indices = from->indices;
  mesh->part_ids = from->part_ids;
}

static StyStatus rebuild(StyMesh *mesh, const StySoup *soup, const unsigned char *turned, StyError *error) {
  const size_t count = soup->triangle_count;
  StyMesh *made = calloc(1, sizeof *made);
  StyCorner *corners = copy_corners(soup, turned);
  StyStatus status = STY_OK;
  if (made && mesh->part_ids) made->part_ids = malloc(count * sizeof *made->part_ids);
  if (!made || !corners || (mesh->part_ids && !made->part_ids))
    status = sty_fail_memory(error, "mesh corners", (double)(3 * count * sizeof *corners));
  if (!status) {
    made->triangle_count = count;
    for (size_t t = 0; t < count && mesh->part_ids; t++) made->part_ids[t] = mesh->part_ids[soup->triangles[t]];
    status = sty_share_vertices(made, corners, mesh->uvs, error);
  }
  free(corners);
  if (!status && mesh->crease_angle >= 0) status = sty_compute_normals(made, mesh->crease_angle, NULL, error);
  if (status) {
    sty_destroy_mesh(&made);
    return status;
  }
  replace_triangles(mesh, made);
  free(made);
  return STY_OK;
}

static StyStatus repair(StyMesh *mesh, StySoup *soup, StyRepair *out, StyError *error) {
  StyWinding winding = {0};
  StyStatus status = look(mesh, soup, &out->found, error);
  if (!status) status = choose_sides(soup, &out->found, &winding, error);
  out->removed = out->found.copies;
  for (size_t t = 0; !status && t < soup->triangle_count; t++) out->turned += winding.turned[t];
  const bool is_changed = out->removed || out->turned;
  if (!status && is_changed) status = rebuild(mesh, soup, winding.turned, error);
  sty_destroy_winding(&winding);
  out->left = out->found;
  return !status && is_changed ? sty_survey_mesh(mesh, &out->left, error) : status;
}

StyStatus sty_repair_mesh(StyMesh *mesh, StyRepair *out, StyError *error) {
  StySoup soup = {0};
  StyRepair done = {0};
  const StyStatus status = repair(mesh, &soup, &done, error);
  sty_destroy_soup(&soup);
  if (!status) *out = done;
  return status;
}

/* ---- scenes ---- */

static void add_survey(StyMeshSurvey *sum, const StyMeshSurvey *more) {
  sum->vertices += more->vertices;
  sum->points += more->points;
  sum->triangles += more->triangles;
  sum->repeated += more->repeated;
  sum->flat += more->flat;
  sum->copies += more->copies;
  sum->clashes += more->clashes;
  sum->tangles += more->tangles;
  sum->borders += more->borders;
  sum->holes += more->holes;
  sum->components += more->components;
}

StyStatus sty_survey_scene(const StyScene *scene, StyMeshSurvey *out, StyError *error) {
  StyMeshSurvey sum = {0};
  for (int m = 0; m < scene->mesh_count; m++) {
    StyMeshSurvey survey;
    const StyStatus status = sty_survey_mesh(scene->meshes[m], &survey, error);
    if (status) return status;
    add_survey(&sum, &survey);
  }
  *out = sum;
  return STY_OK;
}

StyStatus sty_repair_scene(StyScene *scene, StyRepair *out, StyError *error) {
  StyRepair sum = {0};
  for (int m = 0; m < scene->mesh_count; m++) {
    StyRepair done;
    const StyStatus status = sty_repair_mesh(scene->meshes[m], &done, error);
    if (status) return status;
    add_survey(&sum.found, &done.found);
    add_survey(&sum.left, &done.left);
    sum.removed += done.removed;
    sum.turned += done.turned;
  }
  *out = sum;
  return STY_OK;
}
