#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "audit/facts.h"

const char *const sty_judgement_names[] = {"good", "fair", "bad", NULL};

/* What a table or guide may show before it is spoken of. */
static const double hardly_any = 0.001;   /* share of texels */
static const double close_excess = 0.1;   /* degrees: nobody sees them in a normal */
static const double wrong_excess = 1;     /* degrees */
static const double much = 0.1;           /* share of texels */
static const double torn = 0.25;          /* share of neighbours that jump */
static const double lacking = 0.4;        /* coverage of a direction */
static const double least_demand = 0.005; /* share of the frames' pixels */
static const double bare = 0.9;           /* coverage in all */
static const double growth_between = 1.5; /* lookup over assignment error */
static const double growth_by_rounding = 1.1;
static const double coarse = 2; /* degrees, of the median lookup: strokes go visibly elsewhere */
static const size_t few_directions = 16;
enum { LIST_SIZE = 300, MOST_NAMED_SECTORS = 4 };

static void advise(StyOpinion *out, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void advise(StyOpinion *out, const char *format, ...) {
  if (out->advice_count == STY_MOST_ADVICE) return;
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(out->advice[out->advice_count++], sizeof out->advice[0], format, arguments);
  va_end(arguments);
}

/* A share as people write it: never "100" or "0" for what is only nearly so. */
typedef struct ShareText {
  char text[16];
} ShareText;

static ShareText say_share(double share) {
  ShareText out;
  const double percent = 100 * share;
  if (percent > 0 && percent < 0.1)
    snprintf(out.text, sizeof out.text, "under 0.1 %%");
  else if (percent < 100 && percent > 99.9)
    snprintf(out.text, sizeof out.text, "over 99.9 %%");
  else
    snprintf(out.text, sizeof out.text,
             percent < 10 && percent > 0 ? "%.1f %%"
             : percent < 99              ? "%.0f %%"
                                         : "%.3g %%",
             percent);
  return out;
}

/* A jump to the very next pixel cuts nothing. */
static bool can_tear(const StyAudit *audit) { return audit->jump > 1.5; }

/* Weights are floats, whose sum is 1 but for their rounding. */
static bool is_exact(const StyAudit *audit) { return audit->optimal >= 1 - 1e-7 && audit->excess.max <= 0; }
static bool is_ambiguous(const StyAudit *audit) { return audit->ambiguous > much; }

static bool is_torn(const StyAudit *audit) { return audit->jumps > torn && can_tear(audit); }

static bool weighs_frames(const StyReport *report) { return report->audit->weights == STY_WEIGHT_FRAMES; }

/* Chosen with slack, and within it: what it errs more than an exact table is as asked for. */
static bool is_as_chosen(const StyAudit *audit) {
  return audit->slack > 0 && !audit->beyond_slack && !audit->background;
}

/* Whether a larger table would err less. */
static bool is_small(const StyReport *report) {
  const StyAudit *audit = report->audit;
  const StyLutSpec *spec = &audit->spec;
  const int table = spec->width > spec->height ? spec->width : spec->height;
  const int source = report->guide->width > report->guide->height ? report->guide->width : report->guide->height;
  return audit->lookup.mean > growth_between * audit->assignment.mean && source > table &&
         spec->sampling != STY_SAMPLE_UNORM8;
}

/* ---- the verdict --------------------------------------------------------------- */

/* Of tables that hold what they are meant to: exact ones, and those chosen within a slack. */
static void judge_sound(const StyReport *report, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  const char *but = "";
  if (audit->coverage < bare)
    but = ", but the guide lacks directions";
  else if (audit->lookup.p50 > coarse && is_small(report))
    but = ", but the table is small for its guide";
  else if (is_exact(audit) && is_ambiguous(audit))
    but = ", but the guide is ambiguous";
  else if (is_torn(audit))
    but = ", but neighbours lie far apart";
  out->judgement = *but ? STY_JUDGED_FAIR : STY_JUDGED_GOOD;
  if (is_exact(audit))
    snprintf(out->headline, sizeof out->headline, "Exact: every texel holds the nearest pixel%s.", but);
  else
    snprintf(out->headline, sizeof out->headline,
             "Chosen: every texel holds a pixel within the slack of %.3g levels, %.2f degrees more than the nearest on "
             "average%s.",
             audit->slack / STY_LEVEL, audit->excess.mean, but);
}

static void judge_inexact(const StyReport *report, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  const ShareText optimal = say_share(audit->optimal);
  char background[64] = "";
  if (audit->background)
    snprintf(background, sizeof background, "; %zu point%s at the background", audit->background,
             audit->background == 1 ? "s" : "");
  if (audit->background || audit->excess.mean > wrong_excess) {
    out->judgement = STY_JUDGED_BAD;
    if (audit->optimal < hardly_any)
      snprintf(out->headline, sizeof out->headline, "Wrong: hardly any texel holds the nearest pixel%s.", background);
    else
      snprintf(out->headline, sizeof out->headline, "Wrong%s: only %s of the texels hold the nearest pixel%s.",
               audit->optimal > 0.5 ? " in places" : "", optimal.text, background);
  } else if (audit->excess.mean > close_excess) {
    out->judgement = STY_JUDGED_FAIR;
    snprintf(out->headline, sizeof out->headline,
             "Not exact: %s of the texels hold the nearest pixel; the others cost %.2f degrees on average.",
             optimal.text, audit->excess.mean / (1 - audit->optimal));
  } else {
    out->judgement =
        is_ambiguous(audit) || is_torn(audit) || audit->coverage < bare ? STY_JUDGED_FAIR : STY_JUDGED_GOOD;
    snprintf(out->headline, sizeof out->headline,
             "Close: %s of the texels hold the nearest pixel, 99 %% one at most %.2f degrees off it.", optimal.text,
             audit->excess.p99);
  }
}

static void give_reason(const StyReport *report, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  const StyFigures *lookup = &audit->lookup;
  const ShareText ambiguous = say_share(audit->ambiguous), jumps = say_share(audit->jumps);
  snprintf(out->reason, sizeof out->reason,
           "Half of the %s are answered within %.2f degrees, 99 %% within %.2f; the worst is %.1f off. "
           "Places far apart on the guide fit equally well for %s of the texels; %s of neighbouring texels lie far "
           "apart on it.",
           weighs_frames(report) ? "frames' pixels" : "directions", lookup->p50, lookup->p99, lookup->max,
           ambiguous.text, jumps.text);
}

/* ---- advice -------------------------------------------------------------------- */

static void advise_on_errors(const StyReport *report, const StyFacts *facts, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  if (report->of_another)
    advise(out,
           "The table says that it was made of another guide than this one. If so, nothing here holds: audit it "
           "against its own.");
  if (audit->background)
    advise(out,
           "%zu texel%s at the background of the guide, where nothing is painted: what asks for it comes out empty. "
           "Build the table anew with stylut lut.",
           audit->background, audit->background == 1 ? " points" : "s point");
  if (is_exact(audit) || is_as_chosen(audit)) return;
  if (audit->beyond_slack)
    advise(out, "%zu texel%s a pixel beyond the slack of %.3g levels that the table was made with.",
           audit->beyond_slack, audit->beyond_slack == 1 ? " holds" : "s hold", audit->slack / STY_LEVEL);
  if (facts->lost_to_bytes)
    advise(out,
           "The table names only pixels that 8 bits a coordinate can name, of a source of %d x %d: it went through rg8 "
           "and lost its precision. Store it as rg16, rg8x2 or f32.",
           report->lut->source_width, report->lut->source_height);
  advise(out,
         "An exact table of this guide would err %.2f degrees less on average, and up to %.1f less (at texel %d, %d): "
         "stylut lut with any exact engine.",
         audit->excess.mean, audit->excess.max, audit->excess.texel[0], audit->excess.texel[1]);
}

/* "left (4.1 %), lower left (2 %)": directions that the guide lacks, the most wanted first. */
static double list_lacking(const StyReport *report, const StyFacts *facts, char *text) {
  bool named[STY_SECTORS] = {false};
  double demand = 0;
  size_t used = 0;
  *text = 0;
  for (int n = 0; n <= MOST_NAMED_SECTORS; n++) {
    int best = -1;
    for (int s = 0; s < STY_SECTORS; s++) {
      const StySector *sector = &facts->sectors[s];
      if (named[s] || sector->coverage >= lacking || (weighs_frames(report) && sector->demand < least_demand)) continue;
      if (best < 0 || sector->demand > facts->sectors[best].demand) best = s;
    }
    if (best < 0) break;
    if (n == MOST_NAMED_SECTORS) {
      snprintf(text + used, LIST_SIZE - used, " and others");
      break;
    }
    named[best] = true;
    demand += facts->sectors[best].demand;
    used += (size_t)snprintf(text + used, LIST_SIZE - used, "%s%s", used ? ", " : "", sty_sector_names[best]);
    if (weighs_frames(report))
      used += (size_t)snprintf(text + used, LIST_SIZE - used, " (%s)", say_share(facts->sectors[best].demand).text);
  }
  return demand;
}

static void advise_on_coverage(const StyReport *report, const StyFacts *facts, StyOpinion *out) {
  char list[LIST_SIZE];
  const size_t shown = report->exact->unique;
  if (shown && shown <= few_directions && !weighs_frames(report)) {
    advise(out,
           "The guide shows only %zu direction%s, as of flat faces: whatever faces elsewhere gets the nearest of them. "
           "Name frames of your shots with --frames to learn whether they ask for others.",
           shown, shown == 1 ? "" : "s");
    return;
  }
  const double demand = list_lacking(report, facts, list);
  if (*list && weighs_frames(report))
    advise(out,
           "The exemplar has next to no surface facing %s: the frames ask for it in %s of their pixels. Paint an "
           "exemplar that shows these directions.",
           list, say_share(demand).text);
  else if (*list)
    advise(out,
           "The exemplar has next to no surface facing %s. Name frames of your shots with --frames to learn whether "
           "they ask for it.",
           list);
}

static void advise_on_guide(const StyReport *report, const StyFacts *facts, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  const bool jumps = audit->jumps > much && can_tear(audit);
  const char *const resolve = weighs_frames(report) ? "both with these frames" : "coherent";
  if (is_ambiguous(audit) && !is_as_chosen(audit) && jumps)
    advise(out,
           "The guide is ambiguous: for %s of the texels the pixels that fit equally well lie in several places or far "
           "apart, on average %.0f pixels from their middle. Trifles decide between them, and copied pieces get small: "
           "build with --resolve %s, so that neighbours choose alike.",
           say_share(audit->ambiguous).text, facts->spread, resolve);
  else if (is_ambiguous(audit) && !is_as_chosen(audit))
    advise(out,
           "The guide is ambiguous: for %s of the texels the pixels that fit equally well lie in several places or far "
           "apart, on average %.0f pixels from their middle. Trifles decide between them, but here neighbours choose "
           "alike.",
           say_share(audit->ambiguous).text, facts->spread);
  else if (jumps && is_as_chosen(audit))
    advise(out,
           "%s of neighbouring texels lie more than %.3g source pixels apart: strokes will be cut there. A larger "
           "--slack leaves more to choose from.",
           say_share(audit->jumps).text, audit->jump);
  else if (jumps)
    advise(out,
           "%s of neighbouring texels lie more than %.3g source pixels apart: strokes will be cut there. --resolve %s "
           "keeps neighbours together.",
           say_share(audit->jumps).text, audit->jump, resolve);
  if (audit->unstable > much && report->guide->bits < 32)
    advise(out,
           "%s of the texels go elsewhere when the guide is disturbed by its own %d-bit rounding. Float normals "
           "(EXR) decide firmly where frames have them, too.",
           say_share(audit->unstable).text, report->guide->bits);
}

static void advise_on_size(const StyReport *report, const StyFacts *facts, StyOpinion *out) {
  const StyAudit *audit = report->audit;
  if (is_small(report))
    advise(out,
           "The table is small for its guide: at its texels the error is %.2f degrees on average, between them %.2f "
           "(p99 %.2f). A larger -s closes the gap; where the frames' guides are 8-bit, --sampling unorm8 -s 256 does.",
           audit->assignment.mean, audit->lookup.mean, audit->lookup.p99);
  if (facts->rim > 0.8 && audit->spec.map == STY_MAP_XY && audit->assignment.p99 > 3 * audit->assignment.p50 &&
      is_exact(audit) && audit->coverage >= bare && report->guide->bits > 8)
    advise(
        out,
        "The worst errors sit at the rim, where a small step turns the normal far: %s of the worst hundredth lies in "
        "the outer twentieth of the disc. For float guides --map equal-area spends texels evenly over directions.",
        say_share(facts->rim).text);
  const size_t covered = audit->usage[0] + audit->usage[1] + audit->usage[2] + audit->usage[3] + audit->usage[4];
  /* Where directions are lacking, texels crowd on the pixels that come nearest to them. */
  if (is_exact(audit) && audit->coverage >= bare && audit->feasible > covered && audit->unused > 0.3 &&
      !weighs_frames(report))
    advise(out,
           "Though the table has more texels than the guide has pixels, %s of the pixels are never the answer: they "
           "show directions that others show, too.",
           say_share(audit->unused).text);
}

static void advise_on_encoding(const StyFacts *facts, StyOpinion *out) {
  const StyEncodingCost *exact = &facts->encodings[STY_ENCODE_F32], *bytes = &facts->encodings[STY_ENCODE_RG8];
  if (bytes->mean > growth_by_rounding * exact->mean && bytes->mean > exact->mean + close_excess / 10)
    advise(out,
           "Keep 16 bits a coordinate: rg8 would name another pixel for %s of the texels, and the mean error would go "
           "from %.2f to %.2f degrees (p99 from %.2f to %.2f).",
           say_share(bytes->moved).text, exact->mean, bytes->mean, exact->p99, bytes->p99);
}

void sty_form_opinion(const StyReport *report, const StyFacts *facts, StyOpinion *out) {
  *out = (StyOpinion){0};
  if (is_exact(report->audit) || is_as_chosen(report->audit))
    judge_sound(report, out);
  else
    judge_inexact(report, out);
  give_reason(report, out);
  advise_on_errors(report, facts, out);
  advise_on_coverage(report, facts, out);
  advise_on_guide(report, facts, out);
  advise_on_size(report, facts, out);
  advise_on_encoding(facts, out);
}

StyStatus sty_judge_report(const StyReport *report, StyOpinion *out, StyError *error) {
  StyFacts facts;
  const StyStatus status = sty_gather_facts(report, &facts, error);
  if (!status) sty_form_opinion(report, &facts, out);
  return status;
}
