#include "base/leftovers.h"

#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "stylut/file.h"

/* The latest first, so that files go before the folder that they are in. */
typedef struct Leftover {
  struct Leftover *next;
  char path[];
} Leftover;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static Leftover *leftovers;

void sty_lock_leftovers(void) { pthread_mutex_lock(&lock); }
void sty_unlock_leftovers(void) { pthread_mutex_unlock(&lock); }

void sty_note_leftover(const char *path) {
  const size_t size = strlen(path) + 1;
  Leftover *leftover = malloc(sizeof *leftover + size);
  if (!leftover) return;
  leftover->next = leftovers;
  memcpy(leftover->path, path, size);
  leftovers = leftover;
}

void sty_forget_leftover(const char *path) {
  for (Leftover **at = &leftovers; *at; at = &(*at)->next) {
    if (strcmp((*at)->path, path) != 0) continue;
    Leftover *found = *at;
    *at = found->next;
    free(found);
    return;
  }
}

void sty_remove_folder(const char *path) {
  DIR *folder = opendir(path);
  for (const struct dirent *entry; folder && (entry = readdir(folder));) unlinkat(dirfd(folder), entry->d_name, 0);
  if (folder) closedir(folder);
  rmdir(path);
}

/* ---- the end ---- */

static pid_t child; /* 0: none */

void sty_end_together(pid_t process) {
  sty_lock_leftovers();
  child = process;
  sty_unlock_leftovers();
}

/* A thread of its own may take locks and read folders, as no handler may. */
static void *await_end(void *signals) {
  int number = 0;
  sigset_t awaited = *(sigset_t *)signals;
  if (sigwait(&awaited, &number) != 0) return NULL;
  sty_lock_leftovers();
  if (child > 0) kill(child, SIGTERM);
  for (const Leftover *leftover = leftovers; leftover; leftover = leftover->next)
    if (unlink(leftover->path) != 0) sty_remove_folder(leftover->path);
  signal(number, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &awaited, NULL);
  raise(number);
  return NULL;
}

/* One that is ignored (nohup, a shell's background) stays so. */
static bool is_heeded(int number) {
  struct sigaction found;
  return sigaction(number, NULL, &found) == 0 && found.sa_handler == SIG_DFL;
}

void sty_clean_up_when_ended(void) {
  static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
  static sigset_t signals; /* the thread's as long as it lives */
  pthread_t thread;
  signal(SIGPIPE, SIG_IGN); /* writing fails instead, and its error has a way to go */
  signal(SIGXFSZ, SIG_IGN);
  sigemptyset(&signals);
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    if (is_heeded(numbers[i])) sigaddset(&signals, numbers[i]);
  pthread_sigmask(SIG_BLOCK, &signals, NULL);
  if (pthread_create(&thread, NULL, await_end, &signals) == 0)
    pthread_detach(thread);
  else
    pthread_sigmask(SIG_UNBLOCK, &signals, NULL);
}
