/* The report's page: its parts are files beside this one, that the assembler
 * brings in as they are. The page says in its policy that nothing may be loaded
 * and that no script but its own may run, so that even a slip in escaping would
 * do no harm. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "audit/facts.h"
#include "audit/planes.h"

#define INCLUDE_TEXT(name, path)                                                                   \
  __asm__(".section .rodata\n.global sty_report_" #name "\nsty_report_" #name ":\n.incbin \"" path \
          "\"\n.byte 0\n.previous\n");                                                             \
  extern const char sty_report_##name[]
INCLUDE_TEXT(page, "src/audit/report.html");
INCLUDE_TEXT(style, "src/audit/report.css");
INCLUDE_TEXT(script, "src/audit/report.js");

/* What the page's parts are written from. */
typedef struct Page {
  const StyReport *report;
  StyOpinion opinion;
  char *audit, *facts, *table, *guide; /* JSON */
  FILE *stream;
} Page;

/* ---- text ---------------------------------------------------------------------- */

static void write_escaped(FILE *stream, const char *text) {
  for (const char *c = text; *c; c++) switch (*c) {
      case '<': fputs("&lt;", stream); break;
      case '>': fputs("&gt;", stream); break;
      case '&': fputs("&amp;", stream); break;
      case '"': fputs("&quot;", stream); break;
      case '\'': fputs("&#39;", stream); break;
      default: fputc((unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c, stream);
    }
}

/* Text of unknown origin, which need not be UTF-8. */
static void write_foreign(FILE *stream, const char *text) {
  json_t *checked = json_string(text);
  char *plain = checked ? NULL : strdup(text);
  for (char *c = plain; c && *c; c++)
    if ((unsigned char)*c > 0x7f) *c = '?';
  write_escaped(stream, checked ? text : plain ? plain : "");
  json_decref(checked);
  free(plain);
}

/* JSON inside HTML: a string that holds </script> or <!-- must not end it. */
static void write_json(FILE *stream, const char *json) {
  for (const char *c = json; *c; c++)
    if (*c == '<' || *c == '>' || *c == '&')
      fprintf(stream, "\\u%04x", (unsigned)*c);
    else
      fputc(*c, stream);
}

/* ---- the parts ----------------------------------------------------------------- */

static void write_title(const Page *page) {
  write_foreign(page->stream, sty_get_base_name(page->report->files[0].name));
}

static void write_table_name(const Page *page) { write_foreign(page->stream, page->report->files[0].name); }
static void write_guide_name(const Page *page) { write_foreign(page->stream, page->report->files[1].name); }

static void write_kind(const Page *page) {
  const StyLut *lut = page->report->lut;
  const StyLutSpec *spec = &lut->spec;
  fprintf(page->stream, "%d &times; %d texels, sampling %s, map %s, metric %s; source %d &times; %d, %s", spec->width,
          spec->height, sty_sampling_names[spec->sampling], sty_map_names[spec->map], sty_metric_names[spec->metric],
          lut->source_width, lut->source_height,
          page->report->guide->bits == 32   ? "float"
          : page->report->guide->bits == 16 ? "16 bit"
                                            : "8 bit");
  const int frames = page->report->file_count - 2;
  if (frames > 0) fprintf(page->stream, "; weighed by %d frame%s", frames, frames > 1 ? "s" : "");
}

static void write_policy(const Page *page) {
  char hash[STY_HASH_SIZE];
  unsigned char bytes[(STY_HASH_SIZE - 1) / 2];
  sty_hash_bytes(sty_report_script, strlen(sty_report_script), hash);
  for (size_t i = 0; i < sizeof bytes; i++) {
    const char digits[3] = {hash[2 * i], hash[2 * i + 1], 0};
    bytes[i] = (unsigned char)strtoul(digits, NULL, 16);
  }
  char *text = sty_encode_base64(bytes, sizeof bytes);
  fprintf(page->stream,
          "default-src 'none'; base-uri 'none'; form-action 'none'; img-src data:; style-src 'unsafe-inline'; "
          "script-src 'sha256-%s'",
          text ? text : "");
  free(text);
}

static void write_style(const Page *page) { fputs(sty_report_style, page->stream); }
static void write_script(const Page *page) { fputs(sty_report_script, page->stream); }
static void write_judgement(const Page *page) { fputs(sty_judgement_names[page->opinion.judgement], page->stream); }
static void write_headline(const Page *page) { write_escaped(page->stream, page->opinion.headline); }
static void write_reason(const Page *page) { write_escaped(page->stream, page->opinion.reason); }

static void write_advice(const Page *page) {
  if (!page->opinion.advice_count) fputs("<li>Nothing to mend.</li>", page->stream);
  for (int i = 0; i < page->opinion.advice_count; i++) {
    fputs("<li>", page->stream);
    write_escaped(page->stream, page->opinion.advice[i]);
    fputs("</li>\n", page->stream);
  }
}

static void write_files(const Page *page) {
  for (int f = 0; f < page->report->file_count; f++) {
    const StyReportFile *file = &page->report->files[f];
    fprintf(page->stream, "<dt>%s</dt><dd><bdi>", file->role);
    write_foreign(page->stream, file->name);
    fprintf(page->stream, "</bdi>%s<code>%s</code></dd>\n", *file->hash ? "<br>SHA-256 " : "", file->hash);
  }
}

static void write_command(const Page *page) {
  if (!page->report->command) return;
  fprintf(page->stream, "<dt>made with</dt><dd>stylut %s: <code>", STY_VERSION);
  write_foreign(page->stream, page->report->command);
  fputs("</code></dd>\n", page->stream);
}

static void write_audit(const Page *page) { write_json(page->stream, page->audit); }
static void write_facts(const Page *page) { write_json(page->stream, page->facts); }
static void write_table(const Page *page) { write_json(page->stream, page->table); }
static void write_guide(const Page *page) { write_json(page->stream, page->guide); }

static const struct {
  const char *name;
  void (*write)(const Page *page);
} parts[] = {
    {"title", write_title},     {"table-name", write_table_name}, {"guide-name", write_guide_name},
    {"kind", write_kind},       {"policy", write_policy},         {"style", write_style},
    {"script", write_script},   {"judgement", write_judgement},   {"headline", write_headline},
    {"reason", write_reason},   {"advice", write_advice},         {"files", write_files},
    {"command", write_command}, {"audit", write_audit},           {"facts", write_facts},
    {"table", write_table},     {"guide", write_guide},
};

static void write_part(const Page *page, const char *name, size_t length) {
  for (size_t p = 0; p < sizeof parts / sizeof *parts; p++)
    if (strlen(parts[p].name) == length && memcmp(parts[p].name, name, length) == 0) parts[p].write(page);
}

/* The page's text with {{name}} replaced by that part. */
static void write_page(const Page *page) {
  const char *at = sty_report_page;
  for (const char *open; (open = strstr(at, "{{")); at = strstr(open, "}}") + 2) {
    fwrite(at, 1, (size_t)(open - at), page->stream);
    write_part(page, open + 2, (size_t)(strstr(open, "}}") - open - 2));
  }
  fputs(at, page->stream);
}

/* ---- facts as JSON --------------------------------------------------------------- */

/* Six digits: more would only be noise. */
static json_t *make_number(double value) {
  char text[32];
  snprintf(text, sizeof text, "%.6g", value);
  return json_real(strtod(text, NULL));
}

static json_t *list_shares(const StyFigures *figures) {
  json_t *list = json_array();
  for (int b = 0; b < STY_ERROR_BINS; b++) json_array_append_new(list, make_number(figures->shares[b]));
  return list;
}

static json_t *list_sectors(const StyFacts *facts) {
  json_t *list = json_array();
  for (int s = 0; s < STY_SECTORS; s++)
    json_array_append_new(
        list, json_pack("{s:s, s:o, s:o}", "name", sty_sector_names[s], "coverage",
                        make_number(facts->sectors[s].coverage), "demand", make_number(facts->sectors[s].demand)));
  return list;
}

static json_t *list_rings(const StyFacts *facts) {
  json_t *list = json_array();
  for (int r = 0; r < STY_RINGS; r++) {
    const StyRing *ring = &facts->rings[r];
    json_array_append_new(list, ring->max < 0 ? json_null()
                                              : json_pack("[o,o,o]", make_number(ring->p50), make_number(ring->p95),
                                                          make_number(ring->max)));
  }
  return list;
}

static json_t *list_encodings(const StyFacts *facts) {
  json_t *list = json_array();
  for (int e = 0; e < STY_ENCODINGS; e++)
    json_array_append_new(
        list,
        json_pack("{s:s, s:o, s:o, s:o}", "name", sty_encoding_names[e], "mean", make_number(facts->encodings[e].mean),
                  "p99", make_number(facts->encodings[e].p99), "moved", make_number(facts->encodings[e].moved)));
  return list;
}

static char *format_facts(const StyReport *report, const StyFacts *facts) {
  const StyLutSpec *spec = &report->lut->spec;
  json_t *root =
      json_pack("{s:[ii], s:[ii], s:f, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:b}", "texels", spec->width, spec->height,
                "source", report->lut->source_width, report->lut->source_height, "leastError", STY_LEAST_ERROR,
                "binsADecade", STY_ERROR_BINS_A_DECADE, "assignment", list_shares(&report->audit->assignment), "lookup",
                list_shares(&report->audit->lookup), "excess", list_shares(&report->audit->excess), "sectors",
                list_sectors(facts), "rings", list_rings(facts), "encodings", list_encodings(facts), "frames",
                report->audit->weights == STY_WEIGHT_FRAMES);
  char *text = root ? json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(9)) : NULL;
  json_decref(root);
  return text;
}

/* ---- the whole ------------------------------------------------------------------- */

static char *dump_and_drop(json_t *root) {
  char *text = json_dumps(root, JSON_COMPACT | JSON_REAL_PRECISION(12));
  json_decref(root);
  return text;
}

static StyStatus pack_guide(Page *page, StyError *error) {
  json_t *guide = NULL;
  const StyStatus status = sty_pack_guide(page->report, &guide, error);
  if (!status) page->guide = dump_and_drop(guide);
  return status;
}

/* The page with maps in cells of `step` texels a side; the caller frees it. */
static StyStatus compose_page(Page *page, int step, char **text, size_t *size, StyError *error) {
  json_t *table = NULL;
  const StyStatus status = sty_pack_table(page->report, step, &table, error);
  if (status) return status;
  free(page->table);
  page->table = dump_and_drop(table);
  page->stream = page->table ? open_memstream(text, size) : NULL;
  if (!page->stream) return sty_fail_memory(error, "report", STY_MOST_REPORT_BYTES);
  write_page(page);
  if (fclose(page->stream) == 0) return STY_OK;
  free(*text);
  return sty_fail_memory(error, "report", STY_MOST_REPORT_BYTES);
}

/* Maps of noise don't compress: coarser cells, until they fit. */
static StyStatus write_fitting_page(Page *page, FILE *stream, StyError *error) {
  const StyLutSpec *spec = &page->report->lut->spec;
  const int coarsest = spec->width > spec->height ? spec->width : spec->height;
  for (int step = 1; step <= coarsest; step++) {
    char *text = NULL;
    size_t size = 0;
    const StyStatus status = compose_page(page, step, &text, &size, error);
    if (status) return status;
    const bool fits = size < STY_MOST_REPORT_BYTES;
    if (fits) fwrite(text, 1, size, stream);
    free(text);
    if (fits) return STY_OK;
    if (size - strlen(page->table) >= STY_MOST_REPORT_BYTES) break;
  }
  return sty_fail(error, STY_ERROR_INPUT, "report: found %d files whose names alone fill the page, expected fewer",
                  page->report->file_count);
}

StyStatus sty_write_report(const StyReport *report, FILE *stream, StyError *error) {
  Page page = {.report = report};
  StyFacts facts;
  StyStatus status = sty_gather_facts(report, &facts, error);
  if (!status) {
    sty_form_opinion(report, &facts, &page.opinion);
    page.audit = sty_format_audit(report->audit);
    page.facts = format_facts(report, &facts);
    status = pack_guide(&page, error);
  }
  if (!status && !(page.audit && page.facts && page.guide)) status = sty_fail_memory(error, "report", 0);
  if (!status) status = write_fitting_page(&page, stream, error);
  free(page.audit);
  free(page.facts);
  free(page.table);
  free(page.guide);
  return status;
}
