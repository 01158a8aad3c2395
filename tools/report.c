/* stylut report LUT --guide GUIDE -o report.html */
#include "stylut/report.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "audits.h"
#include "commands.h"
#include "options.h"

/* The table, its guide, and all frames. */
enum { MOST_FILES = 2 + MOST_FRAMES };

static StyStatus check_output(AuditCommand *command) {
  Options *options = &command->options;
  const char *inputs[MOST_FILES] = {command->audit.lut, command->audit.guide};
  const int count = append_frames(&command->audit.frames, inputs, 2);
  StyStatus status = require_output(options);
  if (status) return status;
  const char *dot = strrchr(options->output, '.');
  if (!dot || (strcasecmp(dot, ".html") != 0 && strcasecmp(dot, ".htm") != 0))
    return sty_fail(&options->error, STY_ERROR_USAGE, "option '--output': found %s, expected a name ending in .html",
                    options->output);
  return protect_inputs(options, options->output, inputs, count);
}

static error_t parse_option(int key, char *text, struct argp_state *state) {
  AuditCommand *command = state->input;
  begin_option(key, text, state);
  switch (key) {
    case ARGP_KEY_INIT: return 0;
    case ARGP_KEY_ARG: return end_option(take_audit_argument(command, text));
    case ARGP_KEY_END: {
      const StyStatus status = check_audit_arguments(command);
      return end_option(status ? status : check_output(command));
    }
    default: return ARGP_ERR_UNKNOWN;
  }
}

static const struct argp_child children[] = {
    {&audit_argp, 0, NULL, 0}, {&output_argp, 0, NULL, 0}, {&seed_argp, 0, NULL, 0}, {&common_argp, 0, NULL, 0}, {0}};
static const struct argp parser = {
    .parser = parse_option,
    .args_doc = "LUT --guide GUIDE",
    .doc =
        "Writes the audit of a table as one HTML page: a verdict and advice in plain words, maps, and charts.\v"
        "The page is a single file that loads nothing, below 3 MB; any browser of the last years shows it. Tables "
        "beyond "
        "512 texels a side are shown in cells of several texels, each with its worst; the figures are of all texels. "
        "With --frames they speak of what those frames ask for.",
    .children = children,
};

/* ---- the page ------------------------------------------------------------------ */

static StyStatus name_files(const AuditCommand *command, StyReportFile files[MOST_FILES], StyError *error) {
  const AuditArguments *audit = &command->audit;
  StyStatus status = STY_OK;
  for (int f = 0; !status && f < 2 + audit->frames.count; f++) {
    files[f] = (StyReportFile){.role = f == 0   ? "table"
                                       : f == 1 ? "guide"
                                                : "frame",
                               .name = f == 0   ? audit->lut
                                       : f == 1 ? audit->guide
                                                : audit->frames.files[f - 2]};
    if (!command->options.no_history) status = sty_hash_file(files[f].name, files[f].hash, error);
  }
  return status;
}

static StyStatus write_page(const AuditCommand *command, const StyReport *report, StyError *error) {
  StyOutput output;
  StyStatus status = sty_open_output(command->options.output, &output, error);
  if (status) return status;
  status = sty_write_report(report, output.stream, error);
  if (!status) return sty_commit_output(&output, error);
  sty_discard_output(&output);
  return status;
}

static StyStatus print_opinion(const AuditCommand *command, const StyOpinion *opinion, StyError *error) {
  const Options *options = &command->options;
  if (options->json) {
    json_t *advice = json_array();
    for (int i = 0; i < opinion->advice_count; i++) json_array_append_new(advice, json_string(opinion->advice[i]));
    return print_json(json_pack("{s:s, s:o, s:s, s:s, s:s, s:o}", "schema", "stylut-report/1", "output",
                                make_json_text(options->output), "judgement", sty_judgement_names[opinion->judgement],
                                "headline", opinion->headline, "reason", opinion->reason, "advice", advice),
                      error);
  }
  if (options->quiet) return STY_OK;
  printf("%s\n%s\n", opinion->headline, opinion->reason);
  for (int i = 0; i < opinion->advice_count; i++) printf("- %s\n", opinion->advice[i]);
  return STY_OK;
}

static StyStatus write_and_print(const AuditCommand *command, const AuditCase *subject, const StyAudit *audit,
                                 const StyAuditMaps *maps, StyError *error) {
  const Options *options = &command->options;
  StyReportFile files[MOST_FILES];
  json_t *line = options->no_history ? NULL : get_command_line(options, "report");
  const StyReport report = {.files = files,
                            .file_count = 2 + command->audit.frames.count,
                            .command = json_string_value(line),
                            .lut = subject->lut,
                            .exact = subject->exact,
                            .guide = subject->guide,
                            .audit = audit,
                            .maps = maps,
                            .of_another = subject->of_another};
  StyOpinion opinion;
  StyStatus status = name_files(command, files, error);
  if (!status) status = sty_judge_report(&report, &opinion, error);
  if (!status) status = write_page(command, &report, error);
  if (!status) status = print_opinion(command, &opinion, error);
  json_decref(line);
  return status;
}

static StyStatus run(AuditCommand *command) {
  Options *options = &command->options;
  AuditCase subject = {0};
  StyAudit audit;
  StyAuditMaps maps = {0};
  StyStatus status = open_audit(command, &subject, &options->error);
  if (!status && options->dry_run)
    status = report_dry_run(options, "the audit of %s against %s", command->audit.lut, command->audit.guide);
  else if (!status)
    status = run_audit(command, &subject, &audit, &maps, &options->error);
  if (!status && !options->dry_run) status = write_and_print(command, &subject, &audit, &maps, &options->error);
  sty_free_audit_maps(&maps);
  close_audit(&subject);
  return status;
}

StyStatus run_report(int argc, char **argv) {
  AuditCommand command = {.audit = default_audit_arguments};
  StyStatus status = parse_arguments(&parser, argc, argv, &command);
  if (!status && !command.options.helped) status = run(&command);
  return finish_command(&command.options, status);
}
