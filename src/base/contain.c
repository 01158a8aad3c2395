#include "base/contain.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/memory.h"

#include "stylut/parallel.h"

/* Sanitizers reserve more address space than any limit would allow. */
#if defined(__SANITIZE_ADDRESS__)
#define UNLIMITED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define UNLIMITED 1
#endif
#endif

struct StyPipe {
  int end;
  double deadline; /* milliseconds of sty_get_milliseconds; 0: none */
};

typedef struct Reply {
  StyStatus status;
  StyError error;
} Reply;

/* ---- in the child --------------------------------------------------------------- */

static void limit(int resource, double value) {
  struct rlimit found;
  if (getrlimit(resource, &found) != 0) return;
  if (found.rlim_max == RLIM_INFINITY || value < (double)found.rlim_max) found.rlim_cur = (rlim_t)value;
  setrlimit(resource, &found);
}

/* A crash leaves no core, and nothing that a library prints reaches the terminal. */
static void settle_child(const StyContained *contained) {
  static const int crashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  for (size_t i = 0; i < sizeof crashes / sizeof *crashes; i++) signal(crashes[i], SIG_DFL); /* not the caller's */
  sigset_t none; /* is blocked; and nobody is left to wait for it when the parent is ended */
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int nowhere = open("/dev/null", O_WRONLY);
  if (nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, contained->seconds + 5); /* should nobody be left to end it */
#ifndef UNLIMITED
  limit(RLIMIT_AS, sty_get_held_addresses() + contained->bytes);
#endif
}

void sty_send(StyPipe *pipe, const void *data, size_t size) {
  for (const char *at = data; size > 0;) {
    const ssize_t sent = write(pipe->end, at, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) _exit(EXIT_FAILURE);
    at += sent;
    size -= (size_t)sent;
  }
}

static void run_child(const StyContained *contained, int end) {
  StyPipe pipe = {.end = end};
  Reply reply = {.status = STY_OK};
  settle_child(contained);
  reply.status = contained->work(contained->context, &reply.error);
  sty_send(&pipe, &reply, sizeof reply);
  if (!reply.status) contained->send(contained->context, &pipe);
  _exit(EXIT_SUCCESS);
}

/* ---- in the parent -------------------------------------------------------------- */

/* Whether there is something to read before the deadline. */
static bool await_pipe(const StyPipe *pipe) {
  for (;;) {
    const double left = pipe->deadline - sty_get_milliseconds();
    struct pollfd poll_end = {.fd = pipe->end, .events = POLLIN};
    if (left <= 0) return false;
    const int ready = poll(&poll_end, 1, left < 1e9 ? (int)left + 1 : 1000000000);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

bool sty_receive(StyPipe *pipe, void *data, size_t size) {
  for (char *at = data; size > 0;) {
    if (!await_pipe(pipe)) return false;
    const ssize_t got = read(pipe->end, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= (size_t)got;
  }
  return true;
}

static StyStatus fail_child(const StyContained *contained, const StyPipe *pipe, int outcome, StyError *error) {
  if (sty_get_milliseconds() >= pipe->deadline)
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: %s was still at it after %.0f s and was stopped; expected a file that it can read, or %s",
                    contained->name, contained->worker, contained->seconds, contained->more_seconds);
  if (WIFSIGNALED(outcome))
    return sty_fail(error, STY_ERROR_INPUT,
                    "%s: %s crashed on it (signal %d), or found less than %.0f MB too little; expected a file that it "
                    "can read, or %s",
                    contained->name, contained->worker, WTERMSIG(outcome), contained->bytes / 1e6,
                    contained->more_bytes);
  return sty_fail(error, STY_ERROR_INPUT, "%s: %s gave up without a word; expected a file that it can read",
                  contained->name, contained->worker);
}

static int end_child(pid_t child, double *peak_bytes) {
  int outcome = 0;
  struct rusage usage = {0};
  while (wait4(child, &outcome, 0, &usage) < 0 && errno == EINTR) continue;
  *peak_bytes = 1024.0 * (double)usage.ru_maxrss;
  return outcome;
}

static StyStatus run_parent(StyContained *contained, pid_t child, int end, StyError *error) {
  StyPipe pipe = {end, sty_get_milliseconds() + contained->seconds * 1000};
  StyError cause = {STY_OK, ""};
  Reply reply;
  const bool answered = sty_receive(&pipe, &reply, sizeof reply);
  StyStatus status = STY_OK;
  if (answered) status = reply.status ? reply.status : contained->receive(contained->context, &pipe, &cause);
  close(end);
  if (!answered || status) kill(child, SIGKILL);
  const int outcome = end_child(child, &contained->peak_bytes);
  if (!answered) return fail_child(contained, &pipe, outcome, error);
  if (!status) return STY_OK;
  return sty_fail(error, status, "%s", reply.status ? reply.error.text : cause.text);
}

StyStatus sty_run_contained(StyContained *contained, StyError *error) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    return sty_fail(error, STY_ERROR_LIBRARY, "%s: found no pipe for %s: %s", contained->name, contained->worker,
                    strerror(errno));
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_child(contained, ends[1]);
  }
  close(ends[1]);
  if (child > 0) return run_parent(contained, child, ends[0], error);
  close(ends[0]);
  return sty_fail(error, STY_ERROR_LIBRARY, "%s: found no process for %s: %s", contained->name, contained->worker,
                  strerror(errno));
}
