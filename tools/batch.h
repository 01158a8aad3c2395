/* A batch: manifests become a plan of steps, ninja takes them, and what came of it is reported. */
#ifndef STYLUT_TOOLS_BATCH_H
#define STYLUT_TOOLS_BATCH_H

#include "batch_inputs.h"
#include "pack.h"

typedef struct BatchArguments {
  PackArguments making;
  const char **manifests;
  int manifest_count;
  bool keep_going, check;
  const char *junit; /* or NULL */
} BatchArguments;

typedef enum StepState { STEP_LEFT, STEP_DONE, STEP_FAILED } StepState;

typedef struct PlannedStep {
  char *what; /* "lut of 'pencil'" */
  int bundle;
  StepState state;
  StyStatus code; /* exit code, where it failed */
  char *said;     /* lines of errors and warnings, or NULL */
} PlannedStep;

typedef struct PlannedBundle {
  char *manifest, *name;
  int styles;
} PlannedBundle;

typedef struct Plan {
  BatchArguments *arguments;
  char *folder; /* the work folder, which holds build.ninja */
  Inputs inputs;
  json_t *files;  /* texts of the work folder's files, by name */
  FILE *ninja;    /* while the plan is made */
  json_t *guides; /* those that have a step already, by their names */
  PlannedStep *steps;
  int step_count, step_room;
  PlannedBundle *bundles; /* one a manifest */
  int bundle_count;
} Plan;

#define WORK_FOLDER ".stylut"
/* Folders in it: of stamps, and of tables that styles share, by what they are made of. */
#define STAMPS "inputs"
#define SHARED_TABLES "tables"

/* What a step that failed ends with: its exit code follows. */
#define STEP_EXIT "stylut: exit "

/* Makes the plan of all manifests: recipes, stamps and build.ninja, all in memory. The caller closes it, after a
 * failure too. */
StyStatus open_plan(BatchArguments *arguments, Plan *out, StyError *error);
void close_plan(Plan *plan);

/* Writes it into the work folder. */
StyStatus write_plan(Plan *plan, StyError *error);

/* Has ninja do what is to be done. Steps that fail aren't a failure of this: they are marked so. STY_ERROR_UNAVAILABLE
 * where ninja isn't found. */
StyStatus run_plan(Plan *plan, bool dry, StyError *error);

/* Removes tables that no style has any more. */
void prune_tables(const Plan *plan);

/* The results as text or JSON on stdout, and as JUnit XML where that is asked for; failures go to stderr. */
StyStatus report_plan(const Plan *plan, double milliseconds, StyError *error);

#endif
