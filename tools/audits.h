/* What all commands that audit a table share: its options, and the reading of
 * what it needs. */
#ifndef STYLUT_TOOLS_AUDITS_H
#define STYLUT_TOOLS_AUDITS_H

#include "inputs.h"
#include "options.h"
#include "stylut/audit.h"

typedef struct AuditArguments {
  const char *lut, *guide;
  int foreign; /* a StyForeign */
  int weights; /* a StyWeights */
  Frames frames;
  double tolerance, precision, jump; /* 8-bit levels, 8-bit levels, pixels; the last two 0: by themselves */
} AuditArguments;

/* First member of the arguments of a command that uses audit_argp or table_argp. */
typedef struct AuditCommand {
  Options options;
  AuditArguments audit;
} AuditCommand;

extern const struct argp audit_argp; /* --guide --as --weights --frames --tolerance --precision --jump */
extern const struct argp table_argp; /* --guide --as --precision --jump: all that looking into a table needs */
extern const AuditArguments default_audit_arguments;

/* The command's arguments: the table, then more frames once --frames was given. */
StyStatus take_audit_argument(AuditCommand *command, const char *text);
StyStatus check_audit_arguments(AuditCommand *command);

/* All that an audit is about. */
typedef struct AuditCase {
  StyImage *guide;
  StySites *sites;
  StyLut *lut, *exact;
  StyImage *frames[MOST_FRAMES];
  bool of_another; /* the table says that it was made of another guide */
} AuditCase;

/* All but the exact table. */
StyStatus open_table(const AuditCommand *command, AuditCase *out, StyError *error);
StyStatus open_audit(AuditCommand *command, AuditCase *out, StyError *error);
void close_audit(AuditCase *subject);

/* `maps` may be NULL. */
StyStatus run_audit(AuditCommand *command, const AuditCase *subject, StyAudit *out, StyAuditMaps *maps,
                    StyError *error);

#endif
