/* ninja, and what it says. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "batch.h"
#include "spawn.h"
#include "stylut/ceilings.h"

/* Before each line that says how far it is: "done all step". */
#define MARK "\x1e"

/* Where steps that use all threads find how many that is (see ninja_head). */
#define THREADS "STYLUT_THREADS"
/* And what they refuse files by: no reason to do anything anew. */
#define LIMITS "STYLUT_LIMITS"

enum { MOST_WORDS = 12 };

StyStatus set_step_environment(const Plan *plan, StyError *error) {
  char threads[16], limits[512], self[4096];
  const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  if (length < 0) return sty_fail(error, STY_ERROR_LIBRARY, "/proc/self/exe: cannot read: %s", strerror(errno));
  self[length] = 0;
  snprintf(threads, sizeof threads, "%d",
           sty_get_threads(&(StyRun){.threads = plan->arguments->making.options.threads}));
  sty_list_ceilings("--limit ", limits, sizeof limits);
  if (setenv("STYLUT", self, 1) == 0 && setenv(LIMITS, limits, 1) == 0 && setenv(THREADS, threads, 1) == 0 &&
      setenv("NINJA_STATUS", MARK "%f %t ", 1) == 0)
    return STY_OK;
  return sty_fail_memory(error, "environment", 0);
}

/* Its stdout and stderr come out of *said. */
static StyStatus start_ninja(const Plan *plan, bool dry, pid_t *child, FILE **said, StyError *error) {
  const char *words[MOST_WORDS] = {"ninja", "-C", plan->folder, "-j", getenv(THREADS)};
  int count = 5, ends[2];
  if (plan->arguments->keep_going) words[count++] = "-k", words[count++] = "0";
  if (dry) words[count++] = "-n";
  if (pipe2(ends, O_CLOEXEC) != 0)
    return sty_fail(error, STY_ERROR_LIBRARY, "pipe: cannot make it: %s", strerror(errno));
  const int cause = spawn_program(words, STDIN_FILENO, ends[1], ends[1], child);
  close(ends[1]);
  *said = cause ? NULL : fdopen(ends[0], "r");
  if (*said) return STY_OK;
  close(ends[0]);
  return sty_fail(error, STY_ERROR_UNAVAILABLE,
                  "ninja: cannot run it: %s; expected the program in PATH (package ninja-build)",
                  strerror(cause ? cause : errno));
}

/* Adds a line to what a step said. */
static void add_line(PlannedStep *step, const char *line) {
  const size_t before = step->said ? strlen(step->said) : 0, size = before + strlen(line) + 1;
  char *longer = realloc(step->said, size);
  if (!longer) return; /* it is one line less */
  memcpy(longer + before, line, strlen(line) + 1);
  step->said = longer;
}

typedef struct Listening {
  Plan *plan;
  StyRun run;
  PlannedStep *step; /* whose lines come now, or NULL */
  char trouble[512]; /* what ninja says of itself */
} Listening;

static void hear_line(Listening *ear, const char *line) {
  int done = 0, all = 0, number = -1;
  if (sscanf(line, MARK "%d %d %d", &done, &all, &number) == 3 && number >= 0 && number < ear->plan->step_count) {
    ear->step = &ear->plan->steps[number];
    ear->step->state = STEP_DONE;
    if (ear->run.progress && all > 0) ear->run.progress(ear->run.context, (double)done / all);
  } else if (ear->step && strncmp(line, "FAILED: ", 8) == 0) {
    ear->step->state = STEP_FAILED;
  } else if (ear->step && sscanf(line, STEP_EXIT "%d", &done) == 1) {
    ear->step->code = done > 0 && done <= STY_FILES_DIFFER ? (StyStatus)done : STY_ERROR_LIBRARY;
  } else if (ear->step && strncmp(line, "stylut: ", 8) == 0) {
    add_line(ear->step, line);
  } else if (strncmp(line, "ninja: error: ", 14) == 0) {
    snprintf(ear->trouble, sizeof ear->trouble, "%.*s", (int)strcspn(line + 14, "\n"), line + 14);
  }
}

StyStatus run_by_ninja(Plan *plan, bool dry, StyError *error) {
  pid_t child = 0;
  FILE *said = NULL;
  StyStatus status = set_step_environment(plan, error);
  if (!status) status = start_ninja(plan, dry, &child, &said, error);
  if (status) return status;
  sty_end_together(child);
  Listening ear = {.plan = plan, .run = begin_progress(&plan->arguments->making.options, "batch")};
  char *line = NULL;
  size_t room = 0;
  while (getline(&line, &room, said) > 0) hear_line(&ear, line);
  free(line);
  fclose(said);
  end_progress(&plan->arguments->making.options);
  int state = 0;
  sty_end_together(0);
  while (waitpid(child, &state, 0) < 0)
    if (errno != EINTR) return sty_fail(error, STY_ERROR_LIBRARY, "ninja: lost it: %s", strerror(errno));
  if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return STY_OK;
  for (int i = 0; i < plan->step_count; i++)
    if (plan->steps[i].state == STEP_FAILED) return STY_OK;
  return sty_fail(error, STY_ERROR_LIBRARY, "ninja: found %s %d%s%s, expected it to do what %s/build.ninja says",
                  WIFEXITED(state) ? "exit status" : "signal", WIFEXITED(state) ? WEXITSTATUS(state) : WTERMSIG(state),
                  *ear.trouble ? ": " : "", ear.trouble, plan->folder);
}

void prune_tables(const Plan *plan) {
  char *name = sty_join_path(plan->folder, SHARED_TABLES);
  DIR *folder = name ? opendir(name) : NULL;
  struct stat info;
  for (const struct dirent *entry; folder && (entry = readdir(folder));)
    if (fstatat(dirfd(folder), entry->d_name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(info.st_mode) &&
        info.st_nlink == 1)
      unlinkat(dirfd(folder), entry->d_name, 0);
  if (folder) closedir(folder);
  free(name);
}
