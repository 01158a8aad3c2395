/* A batch: manifests become a plan of steps, ninja takes them, and what came of it is reported. */
#ifndef STYLUT_TOOLS_BATCH_H
#define STYLUT_TOOLS_BATCH_H

#include "batch_inputs.h"
#include "pack.h"

enum { MOST_SBATCH = 32 };
typedef enum Executor { BY_NINJA, BY_SLURM } Executor;

typedef struct BatchArguments {
  PackArguments making;
  const char **manifests;
  int manifest_count;
  bool keep_going, check;
  const char *junit;               /* or NULL */
  int executor;                    /* an Executor */
  const char *sbatch[MOST_SBATCH]; /* options for sbatch, as they are */
  int sbatch_count;
} BatchArguments;

typedef enum StepState { STEP_LEFT, STEP_DONE, STEP_FAILED } StepState;

typedef struct PlannedStep {
  char *what;                     /* "table of 'pencil'" */
  char *recipe;                   /* the work folder's file; NULL: what couldn't be planned */
  json_t *makes, *takes, *awaits; /* files; the last must be there, but their contents are no matter */
  bool is_wide;                   /* uses all threads, or much memory */
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

void free_step(PlannedStep *step);

/* What a step that failed ends with: its exit code follows. */
#define STEP_EXIT "stylut: exit "

/* Makes the plan of all manifests: recipes, stamps and build.ninja, all in memory. The caller closes it, after a
 * failure too. */
StyStatus open_plan(BatchArguments *arguments, Plan *out, StyError *error);
void close_plan(Plan *plan);

/* Writes it into the work folder. */
StyStatus write_plan(Plan *plan, StyError *error);

/* Have ninja or Slurm do what is to be done. Steps that fail aren't a failure of this: they are marked so.
 * STY_ERROR_UNAVAILABLE where their programs aren't found, or don't work. */
StyStatus run_by_ninja(Plan *plan, bool dry, StyError *error);
StyStatus run_by_slurm(Plan *plan, bool dry, StyError *error);

/* What steps find in the environment: the tool, threads of wide ones, limits. */
StyStatus set_step_environment(const Plan *plan, StyError *error);

/* Removes tables that no style has any more. */
void prune_tables(const Plan *plan);

/* The results as text or JSON on stdout, and as JUnit XML where that is asked for; failures go to stderr. */
StyStatus report_plan(const Plan *plan, double milliseconds, StyError *error);

#endif
