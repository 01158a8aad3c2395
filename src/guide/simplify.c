/* As few triangles as a picture needs: made fewer, rendered, compared, and taken back where that is too few. */
#include "stylut/simplify.h"

#include <math.h>
#include <stdlib.h>

#include "guide/change.h"
#include "scene/points.h"
#include "scene/simplifier.h"
#include "scene/vector.h"

/* The search for one mesh. */
typedef struct Descent {
  StySimplifier *simplifier;
  StyMesh *full;    /* where another stands in its place in the scene; else NULL */
  size_t good, bad; /* triangles within the budget, and beyond it; bad 0: not known */
  bool is_done;
} Descent;

typedef struct Search {
  StyScene *scene;
  const StyCamera *camera;
  const StyTraceOptions *trace;
  const StySimplifyOptions *options;
  StyRun run; /* that of each render; no progress, since how many there will be isn't known */
  StyShape full;
  Descent *descents; /* 1 per mesh */
  StySimplification result;
} Search;

/* Where good and bad are as near as this, no more is tried. */
static const double CLOSE = 1.05;

static bool is_within(const Search *search, const StyGuideChange *change) {
  return change->p99 <= search->options->max_error && change->silhouette <= search->options->silhouette;
}

/* Renders the scene as it stands. */
static StyStatus measure(Search *search, StyGuideChange *change, StyRenderCost *cost, StyError *error) {
  StyShape shape = {0};
  StyStatus status = sty_render_shape(search->scene, search->camera, search->trace, &search->run, &shape, cost, error);
  if (!status) status = sty_measure_change(&search->full, &shape, &search->run, change, error);
  sty_destroy_shape(&shape);
  search->result.trials++;
  return status;
}

static void note(Search *search, const StyGuideChange *change, const StyRenderCost *cost) {
  search->result.change = *change;
  search->result.simple = *cost;
  search->result.is_simpler = true;
}

/* `mesh` into the scene; what stood there goes, unless it is the full one. */
static void place(Search *search, int m, StyMesh *mesh) {
  Descent *descent = &search->descents[m];
  StyMesh **slot = &search->scene->meshes[m];
  if (!descent->full)
    descent->full = *slot;
  else
    sty_destroy_mesh(slot);
  *slot = mesh;
}

/* One mesh with fewer triangles, if the picture allows it. */
static StyStatus try_mesh(Search *search, int m, StyMesh *mesh, StyError *error) {
  Descent *descent = &search->descents[m];
  StyMesh **slot = &search->scene->meshes[m], *before = *slot;
  const size_t count = mesh->triangle_count;
  StyGuideChange change;
  StyRenderCost cost;
  *slot = mesh;
  const StyStatus status = measure(search, &change, &cost, error);
  *slot = before;
  if (status || !is_within(search, &change)) {
    sty_destroy_mesh(&mesh);
    descent->bad = count;
    return status;
  }
  place(search, m, mesh);
  sty_keep_simplified(descent->simplifier);
  descent->good = count;
  note(search, &change, &cost);
  return STY_OK;
}

static StyStatus step_down(Search *search, int m, StyError *error) {
  Descent *descent = &search->descents[m];
  const size_t target = descent->bad ? (size_t)sqrt((double)descent->good * (double)descent->bad) : descent->good / 4;
  StyMesh *mesh = NULL;
  StyStatus status = sty_simplify_to(descent->simplifier, target, &mesh, error);
  if (status) return status;
  const size_t count = mesh->triangle_count, before = descent->good;
  if (count >= descent->good || count == descent->bad) {
    sty_destroy_mesh(&mesh);
    descent->is_done = true;
    return STY_OK;
  }
  status = try_mesh(search, m, mesh, error);
  /* As few as there can be. */
  descent->is_done = (count > target && descent->good < before) ||
                     (descent->bad && (double)descent->good <= CLOSE * (double)descent->bad);
  return status;
}

/* In turns, so that the first mesh doesn't use up what the picture allows. */
static StyStatus search_budget(Search *search, StyError *error) {
  StyStatus status = STY_OK;
  for (bool is_busy = true; is_busy && !status;) {
    is_busy = false;
    for (int m = 0; m < search->scene->mesh_count && !status; m++) {
      if (search->descents[m].is_done) continue;
      status = step_down(search, m, error);
      is_busy = true;
    }
  }
  return status;
}

/* One mesh with `share` of its triangles, or about so many, in its place, if any can go. */
static StyStatus shrink_mesh(Search *search, int m, double share, bool *is_smaller, StyError *error) {
  Descent *descent = &search->descents[m];
  StyMesh *mesh = NULL;
  const size_t target = (size_t)(share * (double)descent->good + 0.5);
  if (target >= descent->good) return STY_OK;
  const StyStatus status = sty_simplify_to(descent->simplifier, target, &mesh, error);
  if (status) return status;
  if (mesh->triangle_count < descent->good) {
    place(search, m, mesh);
    *is_smaller = true;
  } else {
    sty_destroy_mesh(&mesh);
  }
  return STY_OK;
}

/* About as many triangles as were asked for, by the same share of each mesh. */
static StyStatus take_share(Search *search, StyError *error) {
  const double share = (double)search->options->triangles / (double)search->result.full.triangles;
  bool is_smaller = false;
  StyStatus status = STY_OK;
  for (int m = 0; m < search->scene->mesh_count && !status; m++)
    status = shrink_mesh(search, m, share, &is_smaller, error);
  if (status || !is_smaller) return status;
  StyGuideChange change;
  StyRenderCost cost;
  status = measure(search, &change, &cost, error);
  if (!status) note(search, &change, &cost);
  return status;
}

/* ---- beginning and end ---- */

StyStatus sty_check_simplify(int width, int height, const StySimplifyOptions *options, StyError *error) {
  if (!(options->max_error >= 0 && options->max_error <= 180))
    return sty_fail(error, STY_ERROR_USAGE, "largest error: found %g degrees, expected 0 to 180", options->max_error);
  if (!(options->silhouette >= 0 && options->silhouette <= STY_MOST_SILHOUETTE))
    return sty_fail(error, STY_ERROR_USAGE, "silhouette: found %g pixels, expected 0 to %d", options->silhouette,
                    STY_MOST_SILHOUETTE);
  if ((long long)width * height > STY_MOST_SIMPLIFIED_PIXELS || width > STY_MAX_SIDE / 2 || height > STY_MAX_SIDE / 2)
    return sty_fail(error, STY_ERROR_USAGE,
                    "simplifying: found a picture of %dx%d, expected at most %lld pixels and sides of %d", width,
                    height, STY_MOST_SIMPLIFIED_PIXELS, STY_MAX_SIDE / 2);
  return STY_OK;
}

/* The largest factor by which an object's matrix stretches a mesh. */
static double get_stretch(const StyScene *scene, int m) {
  double most = 0;
  for (int o = 0; o < scene->object_count; o++) {
    if (scene->objects[o].mesh != m) continue;
    double matrix[3][4];
    sty_get_object_matrix(scene, &scene->objects[o], matrix);
    for (int j = 0; j < 3; j++) {
      const double column[3] = {matrix[0][j], matrix[1][j], matrix[2][j]};
      most = fmax(most, sqrt(dot_vectors(column, column)));
    }
  }
  return most > 0 ? most : 1;
}

/* The budgets as the mesh sees them: pixels at the scene's middle. */
static StyTolerance get_tolerance(const Search *search, int m) {
  const StyCamera *camera = search->camera;
  const double away = camera->perspective ? fmax(fabs(dot_vectors(camera->eye, camera->back)), 1e-3) : 1;
  const double pixel = 2 * camera->half_height * away / search->trace->height;
  return (StyTolerance){fmax(search->options->max_error, 1e-3) * (M_PI / 180),
                        fmax(search->options->silhouette, 1e-3) * pixel / get_stretch(search->scene, m)};
}

static StyStatus open_search(Search *search, StyError *error) {
  const int count = search->scene->mesh_count;
  search->descents = calloc((size_t)count + 1, sizeof *search->descents);
  if (!search->descents) return sty_fail_memory(error, "meshes", (double)count * sizeof *search->descents);
  StyStatus status = sty_render_shape(search->scene, search->camera, search->trace, &search->run, &search->full,
                                      &search->result.full, error);
  search->result.simple = search->result.full;
  for (int m = 0; m < count && !status; m++) {
    search->descents[m].good = search->scene->meshes[m]->triangle_count;
    const StyTolerance tolerance = get_tolerance(search, m);
    status = sty_open_simplifier(search->scene->meshes[m], &tolerance, &search->descents[m].simplifier, error);
  }
  return status;
}

/* Lets go of the full meshes, or, where the search failed, of the others. */
static void close_search(Search *search, bool failed) {
  for (int m = 0; search->descents && m < search->scene->mesh_count; m++) {
    Descent *descent = &search->descents[m];
    sty_close_simplifier(&descent->simplifier);
    if (!descent->full) continue;
    if (failed) {
      sty_destroy_mesh(&search->scene->meshes[m]);
      search->scene->meshes[m] = descent->full;
    } else {
      sty_destroy_mesh(&descent->full);
    }
  }
  free(search->descents);
  sty_destroy_shape(&search->full);
}

StyStatus sty_simplify_scene(StyScene *scene, const StyCamera *camera, const StyTraceOptions *trace,
                             const StySimplifyOptions *options, const StyRun *run, StySimplification *out,
                             StyError *error) {
  Search search = {.scene = scene, .camera = camera, .trace = trace, .options = options};
  search.run.threads = run ? run->threads : 0;
  const double start = sty_get_milliseconds();
  StyStatus status = sty_check_simplify(trace->width, trace->height, options, error);
  if (status) return status;
  status = open_search(&search, error);
  if (!status) status = options->triangles ? take_share(&search, error) : search_budget(&search, error);
  close_search(&search, status != STY_OK);
  search.result.search_ms = sty_get_milliseconds() - start;
  if (!status) *out = search.result;
  return status;
}
