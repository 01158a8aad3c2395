/* Every engine, and the libraries on their own, on every guide of cases.c and on
 * the same with one pixel of noise: a page of Markdown on stdout, which `make zoo`
 * puts into exemplars/charts/zoo.md. Each run is a process of its own, so that a
 * crash or a hang is a cell and not the end. Fails when one of our claims does.
 * Usage: zoo [CASE...]: these cases only. */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../bench/peers.h"
#include "base/processor.h"
#include "cases.h"
#include "judge.h"
#include "stylut/version.h"

/* Of the processor's time, for one table. */
enum { PATIENCE = 10 }; /* seconds */

static _Noreturn void give_up(const char *why) {
  fprintf(stderr, "zoo: %s\n", why);
  exit(EXIT_FAILURE);
}

static void *allocate(size_t size) {
  void *memory = malloc(size);
  if (!memory) give_up("found too little memory");
  return memory;
}

/* ---- what is searched ----------------------------------------------------------- */

typedef struct Subject {
  const ZooCase *zoo;
  bool noisy;
  StyImage *guide;
  StySites *sites; /* NULL: the guide is refused */
  StyLut *references[ZOO_LOOKS];
  /* For raw libraries, which get every covered pixel's value as it is: */
  float *values, *queries;
  size_t count, query_count;
  double *least;  /* per query: the least distance there is; negative: there is none */
  size_t *lowest; /* per query: the first value at it by the tie rule */
} Subject;

static void collect_values(Subject *subject) {
  const float *covered = sty_find_channel(subject->guide, "A");
  const float *x = sty_find_channel(subject->guide, "normal.X"), *y = sty_find_channel(subject->guide, "normal.Y");
  const size_t pixels = sty_count_pixels(subject->guide);
  subject->values = allocate(2 * pixels * sizeof *subject->values);
  for (size_t i = 0; i < pixels; i++) {
    if (!(covered[i] > 0)) continue;
    subject->values[2 * subject->count] = x[i];
    subject->values[2 * subject->count++ + 1] = y[i];
  }
}

static void collect_queries(Subject *subject) {
  const StyLutSpec spec = describe_zoo_look(0, subject->zoo->table);
  subject->query_count = subject->zoo->asked ? 1 : sty_count_texels(&spec);
  subject->queries = allocate(2 * subject->query_count * sizeof *subject->queries);
  for (size_t q = 0; q < subject->query_count; q++)
    sty_get_texel_value(&spec, (int)q % spec.width, (int)q / spec.width, subject->queries + 2 * q);
  if (subject->zoo->asked) memcpy(subject->queries, subject->zoo->asked, 2 * sizeof *subject->queries);
}

static bool is_searchable(const float g[2]) {
  return fabsf(g[0]) <= STY_MAX_GUIDE_VALUE && fabsf(g[1]) <= STY_MAX_GUIDE_VALUE;
}

static double measure(const float a[2], const float b[2]) {
  return hypot((double)a[0] - (double)b[0], (double)a[1] - (double)b[1]);
}

/* The right answers, among the values that can be searched. */
static void answer_queries(Subject *subject) {
  subject->least = allocate(subject->query_count * sizeof *subject->least);
  subject->lowest = allocate(subject->query_count * sizeof *subject->lowest);
  for (size_t q = 0; q < subject->query_count; q++) {
    const float *query = subject->queries + 2 * q;
    float best = INFINITY;
    subject->least[q] = -1;
    for (size_t i = 0; is_searchable(query) && i < subject->count; i++) {
      const float *value = subject->values + 2 * i, squared = sty_square_distance(2, query, value);
      if (!(squared < best) || !is_searchable(value)) continue;
      best = squared;
      subject->lowest[q] = i;
      subject->least[q] = measure(query, value);
    }
  }
}

static Subject open_subject(const ZooCase *zoo, bool noisy) {
  Subject subject = {.zoo = zoo, .noisy = noisy, .guide = make_zoo_guide(zoo, noisy)};
  if (!subject.guide) give_up("found too little memory for a guide");
  if (!is_zoo_refused(zoo, noisy) || zoo->asked) {
    StyError error;
    if (sty_collect_sites(zoo->name, subject.guide, &subject.sites, &error)) give_up(error.text);
  }
  collect_values(&subject);
  collect_queries(&subject);
  answer_queries(&subject);
  return subject;
}

static void close_subject(Subject *subject) {
  sty_destroy_image(&subject->guide);
  sty_destroy_sites(&subject->sites);
  for (int look = 0; look < ZOO_LOOKS; look++) sty_destroy_lut(&subject->references[look]);
  free(subject->values);
  free(subject->queries);
  free(subject->least);
  free(subject->lowest);
}

/* ---- the columns ---------------------------------------------------------------- */

typedef struct Column {
  const char *name;
  const StyEngine *engine; /* NULL: another's, or the choice among nearly equal pixels */
  Peer *peer;
} Column;

/* Starts the clock that ends this process when a table takes too long; asleep it gets ten times as long. */
static void begin_table(void) {
  const struct itimerval limit = {.it_value = {.tv_sec = PATIENCE}};
  setitimer(ITIMER_PROF, &limit, NULL);
  alarm(10 * PATIENCE);
}

/* From look to look: all of them, but every third of a million pixels. */
static int get_step(const ZooCase *zoo) { return is_zoo_case_large(zoo) ? 3 : 1; }

static void build_references(Subject *subject, ZooVerdict *verdict) {
  for (int look = 0; look < ZOO_LOOKS && verdict->outcome != ZOO_BROKEN; look += get_step(subject->zoo)) {
    const StyLutSpec spec = describe_zoo_look(look, subject->zoo->table);
    const StyRun run = {.threads = 1};
    StyError error = {STY_OK, ""};
    begin_table();
    verdict->outcome = ZOO_EXACT;
    if (sty_build_lut(subject->sites, &sty_engines[0], NULL, &spec, &run, &subject->references[look], &error))
      break_verdict(verdict, "%s: %s", sty_engines[0].name, error.text);
  }
}

static void run_engine(Subject *subject, const StyEngine *engine, ZooVerdict *verdict) {
  for (int look = 0; look < ZOO_LOOKS; look += get_step(subject->zoo)) {
    judge_engine(subject->guide, subject->sites, engine, subject->references[look], verdict);
  }
}

static void run_resolve(Subject *subject, ZooVerdict *verdict) {
  for (int look = 0; look < ZOO_LOOKS; look += get_step(subject->zoo)) {
    judge_resolve(subject->guide, subject->sites, subject->references[look], verdict);
    judge_audit(subject->guide, subject->references[look], (StyWeights)(look % 3), verdict);
  }
}

static void run_ours(Subject *subject, const Column *column, ZooVerdict *verdict) {
  begin_table();
  if (!subject->sites)
    judge_refusal(subject->guide, subject->zoo->refusal, verdict);
  else if (subject->zoo->asked && column->engine)
    judge_question(subject->sites, column->engine, subject->zoo->asked, subject->zoo->refusal, verdict);
  else if (subject->zoo->asked)
    verdict->outcome = ZOO_REFUSED; /* there is no table to choose from */
  else if (!column->engine)
    run_resolve(subject, verdict);
  else if (column->engine == &sty_engines[0])
    build_references(subject, verdict);
  else
    run_engine(subject, column->engine, verdict);
}

/* More than rounding explains; squares of what is smaller than that vanish in float. */
static bool is_farther(double distance, double least) { return !(distance <= least * (1 + 1e-6) + 1e-18); }

/* Where there is no answer, which of the numbers that are none comes back, or whose, is the heap's chance. */
static void judge_answers(const Subject *subject, const int *nearest, ZooVerdict *verdict) {
  size_t answerable = 0;
  for (size_t q = 0; q < subject->query_count; q++) {
    if (subject->least[q] < 0) continue;
    answerable++;
    if (nearest[q] < 0 || (size_t)nearest[q] >= subject->count ||
        is_farther(measure(subject->queries + 2 * q, subject->values + 2 * nearest[q]), subject->least[q]))
      verdict->wrong++;
    else
      verdict->ties += (size_t)nearest[q] != subject->lowest[q];
  }
  verdict->texels = answerable;
  verdict->outcome = !answerable ? ZOO_BLIND : verdict->wrong ? ZOO_WRONG : verdict->ties ? ZOO_TIES : ZOO_SAME;
}

static void run_peer(const Subject *subject, Peer *peer, ZooVerdict *verdict) {
  int *nearest = allocate(subject->query_count * sizeof *nearest);
  for (size_t q = 0; q < subject->query_count; q++) nearest[q] = -1;
  if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(EXIT_FAILURE);
  begin_table();
  if (peer(subject->values, subject->count, subject->queries, subject->query_count, nearest) < 0)
    verdict->outcome = ZOO_ERROR;
  else
    judge_answers(subject, nearest, verdict);
  free(nearest);
}

/* ---- processes ------------------------------------------------------------------ */

static void run_child(Subject *subject, const Column *column, int to_parent) {
  static ZooVerdict verdict;
  setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
  if (column->peer)
    run_peer(subject, column->peer, &verdict);
  else
    run_ours(subject, column, &verdict);
  _exit(write(to_parent, &verdict, sizeof verdict) == (ssize_t)sizeof verdict ? EXIT_SUCCESS : EXIT_FAILURE);
}

static ZooVerdict run_apart(Subject *subject, const Column *column) {
  static ZooVerdict verdict;
  int ends[2], status = 0;
  fflush(stdout);
  const pid_t child = pipe(ends) ? -1 : fork();
  if (child < 0) give_up("a process could not be begun");
  if (child == 0) run_child(subject, column, ends[1]);
  close(ends[1]);
  const bool complete = read(ends[0], &verdict, sizeof verdict) == (ssize_t)sizeof verdict;
  close(ends[0]);
  waitpid(child, &status, 0);
  if (complete) return verdict;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  const bool hung = signal == SIGPROF || signal == SIGALRM;
  return (ZooVerdict){.outcome = hung ? ZOO_HUNG : ZOO_CRASHED, .signal = signal};
}

/* ---- cells ---------------------------------------------------------------------- */

enum { CELL = 120 };

/* With a comma every three digits. */
static const char *format_count(size_t count, char text[32]) {
  char digits[32];
  const int length = snprintf(digits, sizeof digits, "%zu", count);
  char *to = text;
  for (int i = 0; i < length; i++) {
    if (i && (length - i) % 3 == 0) *to++ = ',';
    *to++ = digits[i];
  }
  *to = '\0';
  return text;
}

static void format_share(const char *before, size_t count, size_t of, const char *after, char cell[CELL]) {
  char a[32], b[32];
  snprintf(cell, CELL, "%s%s of %s%s", before, format_count(count, a), format_count(of, b), after);
}

static void format_verdict(const ZooVerdict *v, char cell[CELL]) {
  static const char *const words[] = {
      [ZOO_NOTHING] = "**nothing**", [ZOO_EXACT] = "exact",         [ZOO_REFUSED] = "refused",
      [ZOO_UNSUITED] = "declined",   [ZOO_NOT_BUILT] = "not built", [ZOO_BROKEN] = "**BROKEN**",
      [ZOO_SAME] = "fine",           [ZOO_BLIND] = "**no error**",  [ZOO_ERROR] = "an error",
      [ZOO_HUNG] = "**hangs**",
  };
  switch (v->outcome) {
    case ZOO_APPROXIMATE:
      if (v->right == v->texels)
        snprintf(cell, CELL, "recall 1");
      else /* rounded down: 1 is for all of them */
        snprintf(cell, CELL, "recall %.3f, excess %.2g", floor(1e3 * (double)v->right / (double)v->texels) / 1e3,
                 v->worst);
      break;
    case ZOO_CALM:
      snprintf(cell, CELL, v->before ? "jumps %.1f to %.1f %%" : "no jumps", 100 * (double)v->before / (double)v->pairs,
               100 * (double)v->after / (double)v->pairs);
      break;
    case ZOO_TIES: format_share("", v->ties, v->texels, " other ties", cell); break;
    case ZOO_WRONG: format_share("**", v->wrong, v->texels, " wrong**", cell); break;
    case ZOO_CRASHED:
      if (v->signal)
        snprintf(cell, CELL, "**SIG%s**", sigabbrev_np(v->signal));
      else
        snprintf(cell, CELL, "**exits**");
      break;
    default: snprintf(cell, CELL, "%s", words[v->outcome]); break;
  }
}

/* Of the guide, and of it with noise: once if they are of one kind. */
static void format_cell(const ZooVerdict *plain, const ZooVerdict *noisy, char cell[CELL]) {
  if (plain->outcome != noisy->outcome || plain->signal != noisy->signal) {
    char a[CELL], b[CELL];
    format_verdict(plain, a);
    format_verdict(noisy, b);
    snprintf(cell, CELL, "%.50s; noisy: %.50s", a, b);
    return;
  }
  ZooVerdict both = *plain;
  both.texels += noisy->texels;
  both.right += noisy->right;
  both.worst = fmax(both.worst, noisy->worst);
  both.pairs += noisy->pairs;
  both.before += noisy->before;
  both.after += noisy->after;
  both.ties += noisy->ties;
  both.wrong += noisy->wrong;
  format_verdict(&both, cell);
}

/* ---- the page ------------------------------------------------------------------- */

static const Column raw_columns[] = {
    {"FLANN single", NULL, search_with_flann},        {"FLANN forest", NULL, search_with_flann_forest},
    {"FLANN linear", NULL, search_with_flann_linear}, {"CGAL", NULL, search_with_cgal},
    {"nanoflann", NULL, search_with_nanoflann},
};
enum { RAW = sizeof raw_columns / sizeof *raw_columns, MOST_COLUMNS = 24, MOST_CASES = 64 };

typedef struct Page {
  Column columns[MOST_COLUMNS]; /* ours, then the raw ones */
  int ours, count;
  const ZooCase *cases[MOST_CASES];
  int case_count;
  char cells[MOST_CASES][MOST_COLUMNS][CELL];
  bool broken;
} Page;

static void set_columns(Page *page) {
  for (const StyEngine *engine = sty_engines; engine->name; engine++)
    page->columns[page->ours++] = (Column){.name = engine->name, .engine = engine};
  page->columns[page->ours++] = (Column){.name = "coherent"};
  memcpy(page->columns + page->ours, raw_columns, sizeof raw_columns);
  page->count = page->ours + RAW;
}

/* The first column's is the reference: what others do without it means nothing. */
static void run_columns(Page *page, Subject *subject, ZooVerdict verdicts[]) {
  for (int c = 0; c < page->count; c++) {
    const Column *column = &page->columns[c];
    verdicts[c] = run_apart(subject, column);
    if (column->engine && verdicts[c].outcome == ZOO_REFUSED && strcmp(verdicts[c].note, verdicts[0].note) != 0)
      break_verdict(&verdicts[c], "refused otherwise than by %s: %s", page->columns[0].name, verdicts[0].note);
    if (!column->peer && is_claim_broken(&verdicts[c])) {
      page->broken = true;
      char cell[CELL];
      format_verdict(&verdicts[c], cell);
      fprintf(stderr, "zoo: %s%s: %s: %s %s\n", subject->zoo->name, subject->noisy ? ", noisy" : "", column->name, cell,
              verdicts[c].note);
    }
    if (c > 0 || !subject->sites || subject->zoo->asked) continue;
    if (is_claim_broken(&verdicts[c])) give_up("there is no reference to compare with");
    build_references(subject, &(ZooVerdict){0});
    setitimer(ITIMER_PROF, &(struct itimerval){0}, NULL);
    alarm(0);
  }
}

static void run_case(Page *page, const ZooCase *zoo) {
  static ZooVerdict verdicts[2][MOST_COLUMNS];
  fprintf(stderr, "zoo: %s\n", zoo->name);
  for (int noisy = 0; noisy < 2; noisy++) {
    Subject subject = open_subject(zoo, noisy);
    run_columns(page, &subject, verdicts[noisy]);
    close_subject(&subject);
  }
  for (int c = 0; c < page->count; c++) format_cell(&verdicts[0][c], &verdicts[1][c], page->cells[page->case_count][c]);
  page->cases[page->case_count++] = zoo;
}

static void print_table(const Page *page, int begin, int end) {
  printf("| |");
  for (int c = begin; c < end; c++) printf(" %s |", page->columns[c].name);
  printf("\n|---|");
  for (int c = begin; c < end; c++) printf("---|");
  printf("\n");
  for (int r = 0; r < page->case_count; r++) {
    printf("| %s |", page->cases[r]->name);
    for (int c = begin; c < end; c++) printf(" %s |", page->cells[r][c]);
    printf("\n");
  }
  printf("\n");
}

static void print_processor(void) {
  static const char *const units[] = {"plain", "plain, avx2", "plain, avx2, avx512"};
  char line[512], name[256] = "unknown processor";
  FILE *file = fopen("/proc/cpuinfo", "r");
  while (file && fgets(line, sizeof line, file))
    if (sscanf(line, "model name : %255[^\n]", name) == 1) break;
  if (file) fclose(file);
  printf("%s (vector units: %s)", name, units[sty_get_vector_unit()]);
}

static void print_page(const Page *page) {
  printf(
      "# The zoo\n\n"
      "Guides that try to hurt a search, and what became of it: first stylut's engines, then the libraries on their\n"
      "own, as a plugin would call them. Made by `make zoo` (`tests/zoo`); each cell is a process of its own.\n\n"
      "Seen on ");
  print_processor();
  const char *cgal = sty_get_geometry_library_version();
  printf(", %s, %s, nanoflann %s.\n\n", sty_get_search_library_version(), cgal ? cgal : "CGAL",
         get_nanoflann_version());
  printf(
      "Each row stands for two guides: the one described below, and the same with one pixel of noise; where they\n"
      "differ in kind, both are named.\n\n"
      "## stylut\n\n"
      "Every engine builds eight tables of each guide: three samplings, two maps, two metrics; of a million\n"
      "pixels three of these. `grid` does it once for each vector unit. `brute` is the reference.\n\n");
  print_table(page, 0, page->ours);
  printf(
      "- **exact**: the bytes of brute force, pixels and distances, ties included.\n"
      "- **recall, excess**: engines that don't claim exactness: the share of texels that hold a pixel as near as any\n"
      "  (rounded down), and the most that one is too far, in guide units. Every answer is a covered pixel.\n"
      "- **declined**: the engine says that it isn't for such a guide: analytic is for spheres that fill the\n"
      "  picture (by xy).\n"
      "- **refused**: one line that names the pixel or the value, the same from every engine.\n"
      "- **coherent**: `--resolve coherent` on the exact tables, with slacks of 2 levels and of 0: no texel beyond\n"
      "  the slack; jumps are neighbouring texels on source pixels far apart, before and after (2 levels), never more\n"
      "  than before. It was run on the tables of approximate engines as well.\n"
      "- No table took %d s of the processor's time or more.\n\n"
      "## The libraries on their own\n\n"
      "One neighbour (xy) for every texel's centre, from all covered pixels as they are.\n\n",
      PATIENCE);
  print_table(page, page->ours, page->count);
  printf(
      "- **fine**: the answers of brute force, ties to the lowest pixel included.\n"
      "- **other ties**: pixels as near, up to rounding, but not the lowest: which one is the library's choice.\n"
      "- **wrong**: farther pixels than need be, by more than rounding; or none, where there is one.\n"
      "- **no error**: success is returned where there is no answer, with some pixel or with an index that is none.\n"
      "- **an error**: the library says that it failed.\n"
      "- **SIG...**: it took the process with it: SIGSEGV by memory that isn't there, SIGABRT by an assertion.\n"
      "- **hangs**: no answer after %d s of the processor's time.\n\n"
      "## The guides\n\n"
      "| | what | pixels | table |\n|---|---|---|---|\n",
      PATIENCE);
  for (int r = 0; r < page->case_count; r++) {
    const ZooCase *zoo = page->cases[r];
    printf("| %s | %s | %d x %d | %d x %d |\n", zoo->name, zoo->what, zoo->width, zoo->height, zoo->table, zoo->table);
  }
}

static bool is_wanted(const ZooCase *zoo, int argc, char **argv) {
  for (int i = 1; i < argc; i++)
    if (strcmp(argv[i], zoo->name) == 0) return true;
  return argc == 1;
}

int main(int argc, char **argv) {
  static Page page;
  zoo_clock = begin_table;
  set_columns(&page);
  for (const ZooCase *zoo = zoo_cases; zoo->name; zoo++)
    if (is_wanted(zoo, argc, argv)) run_case(&page, zoo);
  print_page(&page);
  return page.broken ? EXIT_FAILURE : EXIT_SUCCESS;
}
