#include "audits.h"

#include "inputs.h"
#include "stylut/parse.h"

enum { KEY_GUIDE = 0x400, KEY_AS, KEY_WEIGHTS, KEY_FRAMES, KEY_TOLERANCE, KEY_PRECISION, KEY_JUMP };

enum { NO_WEIGHTS = -1 };
const AuditArguments default_audit_arguments = {.tolerance = 4, .weights = NO_WEIGHTS};

/* What only audits ask for comes first, so that table_argp is the rest. */
static const struct argp_option options_table[] = {
    {"weights", KEY_WEIGHTS, "KIND", 0,
     "what counts how much: disc (every place alike), sphere (solid angle), frames (default: disc, or frames where "
     "they are given)",
     0},
    {"frames", KEY_FRAMES, "FILE...", 0, "guides of real frames: weigh by what they ask for", 0},
    {"tolerance", KEY_TOLERANCE, "LEVELS", 0,
     "a value is covered when a source pixel lies within so many 8-bit levels (default: 4)", 0},
    {"guide", KEY_GUIDE, "FILE", 0, "the guide the table was made for", 0},
    {"as", KEY_AS, "KIND", 0,
     "how to read a table: stylut, as the file says, or as one of another tool: unity (StyleBlitUnity: 8-bit, y up), "
     "rg8, rg16, rg8x2 (default: stylut)",
     0},
    {"precision", KEY_PRECISION, "LEVELS", 0,
     "what the guide's values can be trusted to, in 8-bit levels: rules ambiguity and stability (default: one step of "
     "the guide's own format)",
     0},
    {"jump", KEY_JUMP, "PIXELS", 0,
     "how far apart source pixels are a jump (default: 4 times the source's longer side over the table's, 1 at least)",
     0},
    {0},
};
enum { AUDITS_ONLY = 3 };

static error_t parse_audit(int key, char *text, struct argp_state *state) {
  AuditCommand *command = state->input;
  AuditArguments *audit = &command->audit;
  StyError *error = &command->options.error;
  StyStatus status = STY_OK;
  if (key >= KEY_GUIDE && key <= KEY_JUMP) begin_option(key, text, state);
  switch (key) {
    case KEY_GUIDE: audit->guide = text; break;
    case KEY_AS: status = sty_parse_choice("--as", text, sty_foreign_names, &audit->foreign, error); break;
    case KEY_WEIGHTS: status = sty_parse_choice("--weights", text, sty_weights_names, &audit->weights, error); break;
    case KEY_FRAMES: status = add_frame(&audit->frames, text, error); break;
    case KEY_TOLERANCE: status = sty_parse_number("--tolerance", text, 0, 255, &audit->tolerance, error); break;
    case KEY_PRECISION: status = sty_parse_number("--precision", text, 1e-6, 255, &audit->precision, error); break;
    case KEY_JUMP: status = sty_parse_number("--jump", text, 0.5, STY_MAX_SIDE, &audit->jump, error); break;
    default: return ARGP_ERR_UNKNOWN;
  }
  return end_option(status);
}

const struct argp audit_argp = {.options = options_table, .parser = parse_audit};
const struct argp table_argp = {.options = options_table + AUDITS_ONLY, .parser = parse_audit};

StyStatus take_audit_argument(AuditCommand *command, const char *text) {
  return take_argument_or_frame(&command->options, &command->audit.lut, &command->audit.frames, text);
}

StyStatus check_audit_arguments(AuditCommand *command) {
  AuditArguments *audit = &command->audit;
  StyError *error = &command->options.error;
  const StyStatus status = require_argument(&command->options, audit->lut, "the table's file name");
  if (status) return status;
  if (!audit->guide)
    return sty_fail(error, STY_ERROR_USAGE, "option '--guide': found none, expected the guide the table was made for");
  if (audit->weights == NO_WEIGHTS) audit->weights = audit->frames.count ? STY_WEIGHT_FRAMES : STY_WEIGHT_DISC;
  if (!audit->frames.count && audit->weights == STY_WEIGHT_FRAMES)
    return sty_fail(error, STY_ERROR_USAGE, "--weights: found frames without --frames, expected files to weigh by");
  if (audit->frames.count && audit->weights != STY_WEIGHT_FRAMES)
    return sty_fail(error, STY_ERROR_USAGE, "--frames: found with --weights %s, expected with frames",
                    sty_weights_names[audit->weights]);
  return STY_OK;
}

StyStatus open_table(const AuditCommand *command, AuditCase *out, StyError *error) {
  const AuditArguments *audit = &command->audit;
  StyStatus status = read_guide(&command->options, audit->guide, &out->guide, error);
  if (!status) {
    const StyLutHints hints = {out->guide->width, out->guide->height, -1, (StyForeign)audit->foreign};
    status = read_lut(&command->options, audit->lut, audit->guide, &hints, &out->lut, &out->of_another, error);
    if (status) sty_fail(error, status, "%s (its guide being %s)", error->text, audit->guide);
  }
  if (!status) status = read_frames(&command->options, &audit->frames, out->frames, error);
  if (!status) status = sty_collect_sites(audit->guide, out->guide, &out->sites, error);
  return status;
}

StyStatus open_audit(AuditCommand *command, AuditCase *out, StyError *error) {
  const StyEngine *engine = NULL;
  StyStatus status = open_table(command, out, error);
  if (!status) status = sty_find_engine("engine", "auto", &engine, error);
  if (!status) {
    const StyRun run = begin_progress(&command->options, "searching");
    status = sty_build_lut(out->sites, engine, NULL, &out->lut->spec, &run, &out->exact, error);
    end_progress(&command->options);
  }
  return status;
}

void close_audit(AuditCase *subject) {
  sty_destroy_image(&subject->guide);
  sty_destroy_sites(&subject->sites);
  sty_destroy_lut(&subject->lut);
  sty_destroy_lut(&subject->exact);
  destroy_frames(subject->frames);
}

StyStatus run_audit(AuditCommand *command, const AuditCase *subject, StyAudit *out, StyAuditMaps *maps,
                    StyError *error) {
  const AuditArguments *audit = &command->audit;
  const StyAuditOptions options = {.tolerance = audit->tolerance * STY_LEVEL,
                                   .precision = audit->precision * STY_LEVEL,
                                   .jump = audit->jump,
                                   .weights = (StyWeights)audit->weights,
                                   .frames = (const StyImage *const *)subject->frames,
                                   .frame_count = audit->frames.count,
                                   .seed = command->options.seed};
  const StyRun run = begin_progress(&command->options, "auditing");
  const StyStatus status =
      sty_audit_lut(subject->lut, subject->exact, subject->guide, &options, &run, out, maps, error);
  end_progress(&command->options);
  if (status) sty_fail(error, status, "%s: %s", audit->lut, error->text);
  return status;
}
