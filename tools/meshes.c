#include "meshes.h"

#include <stdio.h>

json_t *pack_survey(const StyMeshSurvey *s) {
  const struct {
    const char *name;
    size_t value;
  } figures[] = {
      {"vertices", s->vertices},
      {"points", s->points},
      {"triangles", s->triangles},
      {"repeated_index_faces", s->repeated},
      {"degenerate_faces", s->flat},
      {"duplicate_triangles", s->copies},
      {"clashing_edges", s->clashes},
      {"non_manifold_edges", s->tangles},
      {"border_edges", s->borders},
      {"holes", s->holes},
      {"connected_components", s->components},
  };
  json_t *report = json_object();
  for (size_t i = 0; i < sizeof figures / sizeof *figures; i++)
    json_object_set_new(report, figures[i].name, json_integer((json_int_t)figures[i].value));
  return report;
}

void print_survey(const StyMeshSurvey *s) {
  printf("  %zu triangles on %zu points, of %zu vertices\n", s->triangles, s->points, s->vertices);
  printf("  left out: %zu face(s) with a repeated point, %zu other(s) without area\n", s->repeated, s->flat);
  printf("  %zu duplicate triangle(s), %zu edge(s) whose triangles are wound against each other\n", s->copies,
         s->clashes);
  printf("  %zu connected component(s), %zu hole(s) of %zu border edges, %zu non-manifold edge(s)\n", s->components,
         s->holes, s->borders, s->tangles);
}

static bool is_manifold(const StyMeshSurvey *s) { return !s->clashes && !s->tangles; }

json_t *pack_repair(const StyRepair *repair) {
  return json_pack("{s:o, s:o, s:I, s:I, s:b}", "found", pack_survey(&repair->found), "left",
                   pack_survey(&repair->left), "removed", (json_int_t)repair->removed, "turned",
                   (json_int_t)repair->turned, "manifold", is_manifold(&repair->left));
}

/* What no repair takes away. */
static void print_remains(const StyMeshSurvey *left) {
  if (!left->borders && is_manifold(left)) puts("  remains: nothing; surfaces are closed and wound one way");
  if (left->borders == 3 * left->triangles)
    puts("  remains: loose triangles, no two of which share an edge");
  else if (left->borders)
    printf("  remains: %zu hole(s) of %zu border edges, which aren't filled\n", left->holes, left->borders);
  if (!is_manifold(left))
    printf(
        "  remains: %zu edge(s) of three or more triangles, %zu wound against each other: no surface, but it renders\n",
        left->tangles, left->clashes);
}

void print_repair(const StyRepair *repair) {
  if (repair->removed || repair->turned)
    printf("repair: %zu duplicate triangle(s) removed, %zu turned round\n", repair->removed, repair->turned);
  else
    puts("repair: nothing to remove or to turn, nothing was changed");
  print_remains(&repair->left);
  puts("  before:");
  print_survey(&repair->found);
}

/* ---- simplification ---- */

static json_t *pack_cost(const StyRenderCost *cost) {
  return json_pack("{s:I, s:f, s:f, s:f, s:f}", "triangles", (json_int_t)cost->triangles, "build_ms", cost->build_ms,
                   "trace_ms", cost->trace_ms, "mesh_bytes", cost->mesh_bytes, "tree_bytes", cost->tree_bytes);
}

json_t *pack_simplification(const StySimplification *done) {
  const StyGuideChange *change = &done->change;
  return json_pack("{s:b, s:o, s:o, s:{s:f, s:f, s:f}, s:f, s:I, s:i, s:f}", "simpler", done->is_simpler, "full",
                   pack_cost(&done->full), "simple", pack_cost(&done->simple), "normal_deg", "mean", change->mean,
                   "p99", change->p99, "max", change->maximum, "silhouette_px", change->silhouette, "compared",
                   (json_int_t)change->compared, "trials", done->trials, "search_ms", done->search_ms);
}

static double get_mib(const StyRenderCost *cost) { return (cost->mesh_bytes + cost->tree_bytes) / (1 << 20); }

static void print_unsimplified(const StySimplification *done, const StySimplifyOptions *options) {
  printf("simplified: no; all %zu triangles stay, since ", done->full.triangles);
  if (done->full.triangles <= options->triangles)
    printf("%zu were asked for\n", options->triangles);
  else if (!done->trials)
    puts("nothing can be removed");
  else
    printf("none of %d trial(s) kept normals within %g degrees at p99 and silhouettes within %g pixels (%.0f ms)\n",
           done->trials, options->max_error, options->silhouette, done->search_ms);
}

void print_simplification(const StySimplification *done, const StySimplifyOptions *options) {
  const StyRenderCost *full = &done->full, *simple = &done->simple;
  if (!done->is_simpler) {
    print_unsimplified(done, options);
    return;
  }
  printf("simplified: %zu of %zu triangles (%.1f %%), found in %.0f ms with %d trial(s)\n", simple->triangles,
         full->triangles, 100 * (double)simple->triangles / (double)full->triangles, done->search_ms, done->trials);
  printf("  verified: normals change by %.3f degrees at p99 (mean %.3f, most %.1f), silhouettes by %s%g pixels\n",
         done->change.p99, done->change.mean, done->change.maximum,
         done->change.silhouette >= STY_MOST_SILHOUETTE ? "at least " : "", done->change.silhouette);
  printf("  tree %.1f -> %.1f ms, rays %.1f -> %.1f ms, meshes with tree %.1f -> %.1f MiB\n", full->build_ms,
         simple->build_ms, full->trace_ms, simple->trace_ms, get_mib(full), get_mib(simple));
}

void warn_of_remains(const Options *options, const StySimplification *done, const StySimplifyOptions *asked) {
  const size_t left = done->is_simpler ? done->simple.triangles : done->full.triangles;
  if (asked->triangles && done->is_simpler && left > asked->triangles + asked->triangles / 20)
    warn(options,
         "--simplify: found that %zu triangles stay, expected %zu: around points that have several vertices within one "
         "surface, as poles have, none can go",
         left, asked->triangles);
}

static void warn_of_line(void *context, const char *line) { warn(context, "%s", line); }

void warn_of_scene(const Options *options, const StyScene *scene) {
  sty_review_scene(scene, warn_of_line, (void *)(uintptr_t)options);
}
