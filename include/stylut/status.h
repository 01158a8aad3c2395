/* Outcomes. Every function of stylut that can fail returns a StyStatus and
 * takes, last, a StyError that it fills with one line for people: which file
 * or option, what was found, what was expected.
 *
 * Out parameters are written only on success. `error` may be NULL. No state is
 * kept between calls, so all of this is safe from any thread. */
#ifndef STYLUT_STATUS_H
#define STYLUT_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/* The values are the exit codes of the command line. */
typedef enum StyStatus {
  STY_OK = 0,
  STY_ERROR_USAGE = 1,       /* an option or argument makes no sense */
  STY_ERROR_FILE = 2,        /* a file cannot be read or written */
  STY_ERROR_INPUT = 3,       /* a file was read, but what it holds is not valid */
  STY_ERROR_LIBRARY = 4,     /* a library failed, or memory ran out */
  STY_ERROR_UNAVAILABLE = 5, /* not built in */
  STY_CHECK_FAILED = 6,      /* a budget is exceeded (command line only) */
  STY_FILES_DIFFER = 7       /* compared files differ */
} StyStatus;

typedef struct StyError {
  StyStatus status;
  char text[1024]; /* one line, no newline, control characters replaced by '?' */
} StyError;

/* Fills `error` (unless NULL) and returns `status`, so that a function can end
 * with `return sty_fail(error, STY_ERROR_INPUT, "%s: ...", path);`. */
StyStatus sty_fail(StyError *error, StyStatus status, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Replaces control characters by '?': file names may hold anything, and a
 * terminal must not obey it. */
void sty_clean_text(char *text);

/* Out of memory, said in one way: `what` names what the memory was for. */
StyStatus sty_fail_memory(StyError *error, const char *what, double bytes);

#ifdef __cplusplus
}
#endif
#endif
