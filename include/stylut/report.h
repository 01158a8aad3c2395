/* The audit as a page that people read: a verdict and advice in plain words,
 * maps, and charts, in one HTML file that needs no other. */
#ifndef STYLUT_REPORT_H
#define STYLUT_REPORT_H

#include <stdio.h>

#include "stylut/audit.h"
#include "stylut/file.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A file that the report is about. Names may hold any bytes: the page shows them
 * escaped, with '?' where they aren't text. */
typedef struct StyReportFile {
  const char *role; /* "table", "guide", "frame" */
  const char *name;
  char hash[STY_HASH_SIZE]; /* empty: not told */
} StyReportFile;

/* All that a report is made of; everything is borrowed. `audit` and `maps` come
 * from sty_audit_lut with the same lut, exact and guide. */
typedef struct StyReport {
  const StyReportFile *files; /* the table, its guide, then frames */
  int file_count;             /* 2 at least */
  const char *command;        /* how the page was made; NULL: not told */
  const StyLut *lut, *exact;
  const StyImage *guide;
  const StyAudit *audit;
  const StyAuditMaps *maps;
  bool of_another; /* the table says that it was made of another guide */
} StyReport;

typedef enum StyJudgement { STY_JUDGED_GOOD, STY_JUDGED_FAIR, STY_JUDGED_BAD } StyJudgement;
extern const char *const sty_judgement_names[]; /* "good", "fair", "bad", NULL */

enum { STY_MOST_ADVICE = 12 };

/* Plain sentences in ASCII. */
typedef struct StyOpinion {
  StyJudgement judgement;
  char headline[256];
  char reason[512];
  int advice_count;
  char advice[STY_MOST_ADVICE][512];
} StyOpinion;

/* What is to be thought of the table. STY_ERROR_LIBRARY: memory. */
StyStatus sty_judge_report(const StyReport *report, StyOpinion *out, StyError *error);

/* Writes the page; the same bytes for the same report. It stays below
 * STY_MOST_REPORT_BYTES: tables beyond 512 texels a side, and smaller ones whose
 * maps don't fit, are shown in cells of several texels. Errors: STY_ERROR_LIBRARY
 * (memory), STY_ERROR_INPUT (names so long that no page can hold them); those of the stream
 * are left to sty_commit_output. */
#define STY_MOST_REPORT_BYTES 3000000
StyStatus sty_write_report(const StyReport *report, FILE *stream, StyError *error);

#ifdef __cplusplus
}
#endif
#endif
