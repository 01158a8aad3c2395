/* What came of a batch. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "batch.h"

typedef struct Counts {
  int steps, done, failed;
} Counts;

/* Of one bundle, or of all (-1). */
static Counts count_steps(const Plan *plan, int bundle) {
  Counts counts = {0, 0, 0};
  for (int i = 0; i < plan->step_count; i++) {
    if (bundle >= 0 && plan->steps[i].bundle != bundle) continue;
    counts.steps++;
    counts.done += plan->steps[i].state == STEP_DONE;
    counts.failed += plan->steps[i].state == STEP_FAILED;
  }
  return counts;
}

static int count_styles(const Plan *plan) {
  int styles = 0;
  for (int b = 0; b < plan->bundle_count; b++) styles += plan->bundles[b].styles;
  return styles;
}

/* ---- text and JSON ---- */

/* "stylut: error: ..." or "stylut: warning: ..." line by line, with the bundle and the step between. */
static void print_lines(const PlannedStep *step, const char *bundle) {
  for (const char *line = step->said; line && *line;) {
    const size_t length = strcspn(line, "\n");
    char kind[16] = "", text[2048];
    int message = 0;
    snprintf(text, sizeof text, "%.*s", (int)length, line);
    if (sscanf(text, "stylut: %15[a-z]: %n", kind, &message) == 1 && message > 0)
      fprintf(stderr, "stylut: %s: %s, %s: %s\n", kind, clean_text(bundle), clean_text(step->what),
              clean_text(text + message));
    line += length + (line[length] == '\n');
  }
}

static void print_said(const Plan *plan) {
  for (int i = 0; i < plan->step_count; i++) {
    const PlannedStep *step = &plan->steps[i];
    const char *bundle = plan->bundles[step->bundle].name;
    if (step->state == STEP_FAILED || !plan->arguments->making.options.quiet) print_lines(step, bundle);
    if (step->state == STEP_FAILED && !step->said)
      fprintf(stderr, "stylut: error: %s, %s: found it ended without a word, expected a message\n", clean_text(bundle),
              clean_text(step->what));
  }
}

static json_t *describe_steps(const Plan *plan, int bundle) {
  json_t *out = json_array();
  for (int i = 0; i < plan->step_count; i++) {
    static const char *const states[] = {"left", "done", "failed"};
    const PlannedStep *step = &plan->steps[i];
    if (step->bundle != bundle || (step->state == STEP_LEFT && !step->said)) continue;
    json_t *entry = json_pack("{s:o, s:s}", "step", make_json_text(step->what), "state", states[step->state]);
    if (step->said) json_object_set_new(entry, "said", make_json_text(step->said));
    json_array_append_new(out, entry);
  }
  return out;
}

static StyStatus print_as_json(const Plan *plan, double milliseconds, StyError *error) {
  const Counts all = count_steps(plan, -1);
  json_t *bundles = json_array();
  for (int b = 0; b < plan->bundle_count; b++) {
    const Counts counts = count_steps(plan, b);
    json_array_append_new(
        bundles,
        json_pack("{s:o, s:o, s:i, s:i, s:i, s:i, s:o}", "name", make_json_text(plan->bundles[b].name), "manifest",
                  make_json_text(plan->bundles[b].manifest), "styles", plan->bundles[b].styles, "steps", counts.steps,
                  "done", counts.done, "failed", counts.failed, "said", describe_steps(plan, b)));
  }
  return print_json(
      json_pack("{s:s, s:o, s:i, s:i, s:i, s:i, s:o, s:f}", "schema", "stylut-batch/1", "folder",
                make_json_text(plan->arguments->making.options.output), "styles", count_styles(plan), "steps",
                all.steps, "done", all.done, "failed", all.failed, "bundles", bundles, "time_ms", milliseconds),
      error);
}

static void print_as_text(const Plan *plan, double milliseconds) {
  const Counts all = count_steps(plan, -1);
  const int styles = count_styles(plan), left = all.steps - all.done - all.failed;
  const Options *options = &plan->arguments->making.options;
  if (options->quiet) return;
  printf("%s: %d style%s in %d bundle%s: %d step%s %s, %d %s", clean_text(options->output), styles,
         styles == 1 ? "" : "s", plan->bundle_count, plan->bundle_count == 1 ? "" : "s", all.done,
         all.done == 1 ? "" : "s", options->dry_run ? "to do" : "done", left, all.failed ? "left" : "as they were");
  if (all.failed) printf(", %d failed", all.failed);
  printf(options->dry_run ? "\n" : ", in %.0f ms\n", milliseconds);
}

static void print_due(const Plan *plan) {
  for (int i = 0; i < plan->step_count; i++)
    if (plan->steps[i].state == STEP_DONE)
      printf("%s: %s\n", clean_text(plan->bundles[plan->steps[i].bundle].name), clean_text(plan->steps[i].what));
}

/* ---- JUnit XML ---- */

static void put_text(FILE *stream, const char *text) {
  for (; *text; text++) {
    const unsigned char c = (unsigned char)*text;
    switch (c) {
      case '<': fputs("&lt;", stream); break;
      case '>': fputs("&gt;", stream); break;
      case '&': fputs("&amp;", stream); break;
      case '"': fputs("&quot;", stream); break;
      default: fputc(c < 32 && c != '\n' ? '?' : c, stream);
    }
  }
}

static void put_case(FILE *stream, const char *bundle, const PlannedStep *step) {
  fprintf(stream, "  <testcase classname=\"");
  put_text(stream, bundle);
  fprintf(stream, "\" name=\"");
  put_text(stream, step->what);
  if (step->state == STEP_FAILED) {
    fprintf(stream, "\">\n   <failure>");
    put_text(stream, step->said ? step->said : "ended without a word");
    fprintf(stream, "</failure>\n  </testcase>\n");
  } else {
    fprintf(stream, "\"/>\n");
  }
}

static StyStatus write_junit(const Plan *plan, const char *path, StyError *error) {
  StyOutput output;
  const StyStatus status = sty_open_output(path, &output, error);
  if (status) return status;
  fprintf(output.stream, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n");
  for (int b = 0; b < plan->bundle_count; b++) {
    const Counts counts = count_steps(plan, b);
    fprintf(output.stream, " <testsuite name=\"");
    put_text(output.stream, plan->bundles[b].name);
    fprintf(output.stream, "\" tests=\"%d\" failures=\"%d\">\n", counts.steps, counts.failed);
    for (int i = 0; i < plan->step_count; i++)
      if (plan->steps[i].bundle == b) put_case(output.stream, plan->bundles[b].name, &plan->steps[i]);
    fprintf(output.stream, " </testsuite>\n");
  }
  fprintf(output.stream, "</testsuites>\n");
  return sty_commit_output(&output, error);
}

StyStatus report_plan(const Plan *plan, double milliseconds, StyError *error) {
  const Options *options = &plan->arguments->making.options;
  StyStatus status = STY_OK;
  print_said(plan);
  if (options->dry_run && !options->json) print_due(plan);
  if (options->json)
    status = print_as_json(plan, milliseconds, error);
  else
    print_as_text(plan, milliseconds);
  if (!status && plan->arguments->junit) status = write_junit(plan, plan->arguments->junit, error);
  return status;
}
