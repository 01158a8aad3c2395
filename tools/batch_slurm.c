/* The plan of a batch as Slurm job arrays. Steps that are due are dealt into waves: a step's wave is behind those of
 * all that make what it takes. A wave is an array of tasks that do its steps by turns, and waits for the wave before
 * it; all arrays are in the queue at once, so that the cluster needs nobody to feed it. Steps leave what they said and
 * their exit code in files; those say what came of each. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "batch.h"
#include "spawn.h"
#include "step_due.h"
#include "take.h"

TAKE(slurm_task, "task.sh");

#define SLURM "slurm"
#define JOBS SLURM "/jobs"

/* Tasks of an array at most: steps are short, and Slurm takes its time with each. */
enum {
  MOST_TASKS = 256,
  MOST_WORDS = 64,
  MOST_SAID = 1 << 20,
  SHORTEST_NAP = 50,
  LONGEST_NAP = 2000 /* ms */,
  LATE_LOOKS = 6
};

typedef struct Wave {
  int *steps; /* their numbers */
  int count;
  bool is_wide;
} Wave;

typedef struct Queue {
  Plan *plan;
  int *waves;     /* of each step, from 1; 0: not due */
  json_t *makers; /* of files: numbers of steps */
  int depth;      /* the last wave */
  char *jobs;     /* numbers of the arrays that are in Slurm's queue, with commas between */
} Queue;

/* ---- what is due ---- */

static bool is_due(const Plan *plan, const PlannedStep *step) {
  char *before = getcwd(NULL, 0);
  StyDocument recipe = {NULL, NULL, NULL};
  bool due = true;
  /* Notes name files as steps see them: in the work folder. */
  if (before && chdir(plan->folder) == 0) {
    due = sty_read_document(step->recipe, &recipe, NULL) != STY_OK || is_step_due(&recipe);
    if (chdir(before) != 0) due = true;
  }
  sty_close_document(&recipe);
  free(before);
  return due;
}

/* The last wave of those that make these files, 0: none is due. */
static int find_last_maker(const Queue *queue, const json_t *files) {
  const json_t *file;
  size_t i;
  int last = 0;
  json_array_foreach(files, i, file) {
    const json_t *maker = json_object_get(queue->makers, json_string_value(file));
    const int wave = maker ? queue->waves[json_integer_value(maker)] : 0;
    if (wave > last) last = wave;
  }
  return last;
}

/* Steps stand behind those that make what they take. */
static void deal_steps(Queue *queue) {
  const json_t *file;
  size_t k;
  for (int i = 0; i < queue->plan->step_count; i++) {
    const PlannedStep *step = &queue->plan->steps[i];
    if (!step->recipe) continue;
    json_array_foreach(step->makes, k, file)
        json_object_set_new(queue->makers, json_string_value(file), json_integer(i));
    int before = find_last_maker(queue, step->takes);
    const int awaited = find_last_maker(queue, step->awaits);
    if (awaited > before) before = awaited;
    queue->waves[i] = before || is_due(queue->plan, step) ? before + 1 : 0;
    if (queue->waves[i] > queue->depth) queue->depth = queue->waves[i];
  }
}

/* ---- files of the work folder ---- */

static char *name_result(const Queue *queue, int step, const char *ending) {
  char *name = NULL;
  return asprintf(&name, "%s/" SLURM "/%d.%s", queue->plan->folder, step, ending) < 0 ? NULL : name;
}

static void forget_result(const Queue *queue, int step) {
  static const char *const endings[] = {"said", "code"};
  for (int e = 0; e < 2; e++) {
    char *name = name_result(queue, step, endings[e]);
    if (name) unlink(name);
    free(name);
  }
}

static void list_makers(const Queue *queue, const json_t *files, FILE *stream, int *count) {
  const json_t *file;
  size_t i;
  json_array_foreach(files, i, file) {
    const json_t *maker = json_object_get(queue->makers, json_string_value(file));
    if (!maker || !queue->waves[json_integer_value(maker)]) continue;
    fprintf(stream, "%s%lld", (*count)++ ? "," : "", (long long)json_integer_value(maker));
  }
}

/* One line a step, as task.sh reads it. */
static StyStatus write_list(const Queue *queue, const Wave *wave, const char *path, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  for (int i = 0; i < wave->count; i++) {
    const PlannedStep *step = &queue->plan->steps[wave->steps[i]];
    int count = 0;
    fprintf(output.stream, "%d ", wave->steps[i]);
    list_makers(queue, step->takes, output.stream, &count);
    list_makers(queue, step->awaits, output.stream, &count);
    fprintf(output.stream, "%s %s\n", count ? "" : "-", step->recipe);
  }
  return sty_commit_output(&output, error);
}

/* ---- Slurm's programs ---- */

/* Runs one to its end; the first line that it says comes out, without the line's end. */
static StyStatus ask(const char *const *words, char *said, size_t size, StyError *error) {
  int ends[2], state = 0;
  pid_t child = 0;
  *said = 0;
  if (pipe2(ends, O_CLOEXEC) != 0)
    return sty_fail(error, STY_ERROR_LIBRARY, "pipe: cannot make it: %s", strerror(errno));
  const int cause = spawn_program(words, STDIN_FILENO, ends[1], ends[1], &child);
  close(ends[1]);
  FILE *stream = cause ? NULL : fdopen(ends[0], "r");
  if (!stream) {
    close(ends[0]);
    return sty_fail(error, STY_ERROR_UNAVAILABLE, "%s: cannot run it: %s; expected Slurm's programs in PATH", words[0],
                    strerror(cause ? cause : errno));
  }
  char line[4096];
  for (bool first = true; fgets(line, sizeof line, stream); first = false)
    if (first) snprintf(said, size, "%.*s", (int)strcspn(line, "\n"), line);
  fclose(stream);
  while (waitpid(child, &state, 0) < 0)
    if (errno != EINTR) return sty_fail(error, STY_ERROR_LIBRARY, "%s: lost it: %s", words[0], strerror(errno));
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return STY_OK;
  return sty_fail(error, STY_ERROR_UNAVAILABLE, "%s: %s", words[0], *said ? said : "failed without a word");
}

/* Whether any of the arrays is still to end; a queue that doesn't answer for once is asked again. */
static bool are_queued(const char *jobs) {
  char said[4096];
  StyError ignored;
  const char *const words[] = {"squeue", "--noheader", "--format=%i", "--jobs", jobs, NULL};
  const StyStatus status = ask(words, said, sizeof said, &ignored);
  /* Slurm forgets jobs, and calls their numbers invalid then. */
  return status ? !strstr(ignored.text, "Invalid job id") : *said != 0;
}

static void cancel(const char *jobs) {
  char said[512];
  char *copy = strdup(jobs), *at = NULL;
  for (char *job = copy ? strtok_r(copy, ",", &at) : NULL; job; job = strtok_r(NULL, ",", &at))
    ask((const char *const[]){"scancel", job, NULL}, said, sizeof said, NULL);
  free(copy);
}

static void nap(int milliseconds) { usleep((useconds_t)milliseconds * 1000); }

/* What an earlier run, ended before its arrays were, has left in the queue. */
static StyStatus clear_queue(const Plan *plan, StyError *error) {
  char *path = sty_join_path(plan->folder, JOBS);
  unsigned char *jobs = NULL;
  size_t size = 0;
  if (!path) return sty_fail_memory(error, JOBS, 0);
  if (sty_read_file(path, MOST_SAID, &jobs, &size, NULL) == STY_OK && size > 0) {
    cancel((const char *)jobs);
    while (are_queued((const char *)jobs)) nap(LONGEST_NAP / 4);
  }
  unlink(path);
  free(jobs);
  free(path);
  return STY_OK;
}

static StyStatus add_job(Queue *queue, const char *job, StyError *error) {
  char *longer = NULL, *path = sty_join_path(queue->plan->folder, JOBS);
  StyOutput output;
  if (!path || asprintf(&longer, "%s%s%s", queue->jobs ? queue->jobs : "", queue->jobs ? "," : "", job) < 0) {
    free(path);
    return sty_fail_memory(error, JOBS, 0);
  }
  free(queue->jobs);
  queue->jobs = longer;
  StyStatus status = sty_open_output(path, &output, error);
  if (!status) fputs(queue->jobs, output.stream);
  if (!status) status = sty_commit_output(&output, error);
  free(path);
  return status;
}

/* ---- arrays ---- */

/* Puts a wave, or the wide steps of one, into the queue behind the jobs `before` (NULL: none). */
static StyStatus submit(Queue *queue, int number, const Wave *wave, const char *before, StyError *error) {
  const BatchArguments *arguments = queue->plan->arguments;
  const int tasks = wave->count < MOST_TASKS ? wave->count : MOST_TASKS;
  const int threads = wave->is_wide && arguments->making.options.threads > 1 ? arguments->making.options.threads : 1;
  char list[64], array[64], cpus[64], count[32], width[32], said[4096], *depends = NULL, *chdir_to = NULL, *path = NULL;
  snprintf(list, sizeof list, SLURM "/%d.%s.list", number, wave->is_wide ? "wide" : "narrow");
  snprintf(array, sizeof array, "--array=0-%d", tasks - 1);
  snprintf(cpus, sizeof cpus, "--cpus-per-task=%d", threads);
  snprintf(count, sizeof count, "%d", tasks);
  snprintf(width, sizeof width, "%d", threads);
  const char *words[MOST_WORDS] = {"sbatch", "--parsable", "--job-name=stylut", "--output=/dev/null", "--export=ALL",
                                   array,    cpus};
  int used = 7;
  bool failed = asprintf(&chdir_to, "--chdir=%s", queue->plan->folder) < 0;
  words[used++] = chdir_to;
  if (before) {
    failed =
        failed || asprintf(&depends, "--dependency=%s:%s", arguments->keep_going ? "afterany" : "afterok", before) < 0;
    words[used++] = depends;
    words[used++] = "--kill-on-invalid-dep=yes";
  }
  for (int i = 0; i < arguments->sbatch_count; i++) words[used++] = arguments->sbatch[i];
  const char *const rest[] = {SLURM "/task.sh", list, count, width, arguments->keep_going ? "on" : "off"};
  path = sty_join_path(queue->plan->folder, list);
  char *script = sty_join_path(queue->plan->folder, SLURM "/task.sh");
  words[used++] = script;
  for (int i = 1; i < 5; i++) words[used++] = rest[i];
  StyStatus status = failed || !path || !script ? sty_fail_memory(error, list, 0) : STY_OK;
  if (!status) status = write_list(queue, wave, path, error);
  if (!status) status = ask(words, said, sizeof said, error);
  said[strcspn(said, ";")] = 0; /* a cluster's name */
  if (!status) status = add_job(queue, said, error);
  free(script);
  free(path);
  free(depends);
  free(chdir_to);
  return status;
}

/* The steps of a wave that are wide, or not. */
static Wave gather(const Queue *queue, int number, bool is_wide, int *steps) {
  Wave wave = {.steps = steps, .is_wide = is_wide};
  for (int i = 0; i < queue->plan->step_count; i++)
    if (queue->waves[i] == number && queue->plan->steps[i].is_wide == is_wide) wave.steps[wave.count++] = i;
  return wave;
}

static StyStatus submit_all(Queue *queue, StyError *error) {
  int *steps = malloc((size_t)queue->plan->step_count * sizeof *steps);
  StyStatus status = steps ? STY_OK : sty_fail_memory(error, "plan", 0);
  char *before = NULL;
  for (int number = 1; !status && number <= queue->depth; number++) {
    const size_t begun = queue->jobs ? strlen(queue->jobs) + 1 : 0;
    for (int wide = 0; !status && wide < 2; wide++) {
      const Wave wave = gather(queue, number, wide, steps);
      if (wave.count) status = submit(queue, number, &wave, before, error);
    }
    free(before);
    before = status ? NULL : strdup(queue->jobs + begun);
    for (char *c = before; c && *c; c++)
      if (*c == ',') *c = ':';
    if (!status && !before) status = sty_fail_memory(error, JOBS, 0);
  }
  free(before);
  free(steps);
  return status;
}

/* ---- results ---- */

static char *read_result(const Queue *queue, int step, const char *ending) {
  char *name = name_result(queue, step, ending);
  unsigned char *text = NULL;
  size_t size = 0;
  if (name && sty_read_file(name, MOST_SAID, &text, &size, NULL) != STY_OK) text = NULL;
  free(name);
  return (char *)text;
}

/* Whether the step's result is there; it is taken then. */
static bool take_result(const Queue *queue, int number) {
  PlannedStep *step = &queue->plan->steps[number];
  char *code = read_result(queue, number, "code");
  if (!code) return false;
  const int value = atoi(code);
  step->state = strncmp(code, "left", 4) == 0 ? STEP_LEFT : value == 0 ? STEP_DONE : STEP_FAILED;
  if (step->state == STEP_FAILED)
    step->code = value > 0 && value <= STY_FILES_DIFFER ? (StyStatus)value : STY_ERROR_LIBRARY;
  step->said = read_result(queue, number, "said");
  if (step->said && !*step->said) {
    free(step->said);
    step->said = NULL;
  }
  free(code);
  return true;
}

static bool has_failed(const Queue *queue) {
  for (int i = 0; i < queue->plan->step_count; i++)
    if (queue->plan->steps[i].state == STEP_FAILED) return true;
  return false;
}

/* Steps of which nothing was heard when all arrays had ended: left, if others failed before; else Slurm ended them. */
static void account_for_lost(const Queue *queue, const bool *is_taken) {
  for (int i = 0; !has_failed(queue) && i < queue->plan->step_count; i++) {
    PlannedStep *step = &queue->plan->steps[i];
    if (!queue->waves[i] || is_taken[i]) continue;
    step->state = STEP_FAILED;
    step->code = STY_ERROR_LIBRARY;
    step->said = strdup("stylut: error: Slurm ended it before it was done\n");
  }
}

/* How many of the results that were missing are there. */
static int take_results(const Queue *queue, bool *is_taken) {
  int taken = 0;
  for (int i = 0; i < queue->plan->step_count; i++)
    if (queue->waves[i] && !is_taken[i] && take_result(queue, i)) {
      is_taken[i] = true;
      taken++;
    }
  return taken;
}

static void await_results(Queue *queue, bool *is_taken) {
  const StyRun run = begin_progress(&queue->plan->arguments->making.options, "batch");
  int due = 0, taken = 0, rest = SHORTEST_NAP, looks = LATE_LOOKS;
  for (int i = 0; i < queue->plan->step_count; i++) due += queue->waves[i] > 0;
  while (taken < due && looks > 0) {
    const bool queued = are_queued(queue->jobs); /* asked before, so that what ends meanwhile is seen */
    const int more = take_results(queue, is_taken);
    taken += more;
    if (run.progress) run.progress(run.context, (double)taken / due);
    rest = more ? SHORTEST_NAP : rest < LONGEST_NAP ? 2 * rest : LONGEST_NAP;
    /* Files that a node has written may take a moment to be seen from here; what a failure has stopped never comes. */
    if (!queued) looks = has_failed(queue) ? 0 : looks - 1;
    if (taken < due && looks > 0) nap(rest);
  }
  end_progress(&queue->plan->arguments->making.options);
}

static StyStatus do_due(Queue *queue, StyError *error) {
  bool *is_taken = calloc((size_t)queue->plan->step_count + 1, sizeof *is_taken);
  char *jobs = sty_join_path(queue->plan->folder, JOBS);
  StyStatus status = is_taken && jobs ? STY_OK : sty_fail_memory(error, "plan", 0);
  for (int i = 0; !status && i < queue->plan->step_count; i++) forget_result(queue, i);
  if (!status) status = submit_all(queue, error);
  if (status && queue->jobs) cancel(queue->jobs);
  if (!status) {
    await_results(queue, is_taken);
    account_for_lost(queue, is_taken);
    unlink(jobs);
  }
  free(jobs);
  free(is_taken);
  return status;
}

static StyStatus write_script(const Plan *plan, StyError *error) {
  char *folder = sty_join_path(plan->folder, SLURM), *script = sty_join_path(plan->folder, SLURM "/task.sh");
  StyStatus status = folder && script ? STY_OK : sty_fail_memory(error, SLURM, 0);
  if (!status && mkdir(folder, 0777) != 0 && errno != EEXIST)
    status = sty_fail(error, STY_ERROR_FILE, "%s: cannot make the folder: %s", folder, strerror(errno));
  if (!status) status = write_text(script, slurm_task, error);
  free(script);
  free(folder);
  return status;
}

StyStatus run_by_slurm(Plan *plan, bool dry, StyError *error) {
  char *shown = plan->folder, *folder = realpath(plan->folder, NULL);
  if (!folder) return sty_fail(error, STY_ERROR_FILE, "%s: %s", plan->folder, strerror(errno));
  plan->folder = folder; /* from the root: jobs begin elsewhere */
  Queue queue = {
      .plan = plan, .waves = calloc((size_t)plan->step_count + 1, sizeof *queue.waves), .makers = json_object()};
  StyStatus status = queue.waves ? set_step_environment(plan, error) : sty_fail_memory(error, "plan", 0);
  if (!status && !dry) status = write_script(plan, error);
  if (!status && !dry) status = clear_queue(plan, error);
  if (!status) deal_steps(&queue);
  if (!status && !dry && queue.depth) status = do_due(&queue, error);
  for (int i = 0; !status && dry && i < plan->step_count; i++)
    if (queue.waves[i]) plan->steps[i].state = STEP_DONE;
  plan->folder = shown;
  json_decref(queue.makers);
  free(queue.waves);
  free(queue.jobs);
  free(folder);
  return status;
}
