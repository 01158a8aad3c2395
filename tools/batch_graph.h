/* The graph of a batch: its edges, each of which is a step with its recipe. */
#ifndef STYLUT_TOOLS_BATCH_GRAPH_H
#define STYLUT_TOOLS_BATCH_GRAPH_H

#include "batch.h"
#include "step.h"

/* A file of the work folder, to be written once the whole plan is made. */
StyStatus put_text(const Plan *plan, const char *name, const char *text, StyError *error);

/* One edge in the making. */
typedef struct Edge {
  json_t *recipe;
  char recipe_name[NAME_SIZE];
  json_t *outputs, *inputs; /* names; inputs besides the recipe */
  const json_t *awaited;    /* what must have passed, or NULL */
  const char *depfile;      /* or NULL */
  StyStatus status;         /* of what was added so far */
  bool is_wide;             /* uses all threads, or much memory: one such step at a time */
} Edge;

/* Takes the recipe. put_edge spends the edge, and must come. */
Edge begin_edge(json_t *recipe, const char *recipe_name);
void add_name(json_t *names, const char *name);
StyStatus put_edge(Plan *plan, int bundle, const char *what, Edge *edge, StyError *error);

/* What keeps a bundle from being planned, as a step that failed; the error is spent. */
StyStatus add_failure(Plan *plan, int bundle, StyStatus code, StyError *error);

/* What build.ninja begins with. */
extern const char *const ninja_head;

/* Puts the stamp of a file into the plan; its name goes to `name`. */
StyStatus put_stamp(Plan *plan, const char *path, char name[STAMP_SIZE], StyError *error);

/* Plans all steps of one manifest's bundle. */
StyStatus plan_bundle(Plan *plan, int number, StyError *error);

#endif
