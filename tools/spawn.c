#include "spawn.h"

#include <signal.h>
#include <spawn.h>
#include <unistd.h>

int spawn_program(const char *const *words, int in, int out, int said, pid_t *child) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  sigset_t none, all; /* blocked; as they are by default */
  sigemptyset(&none);
  sigfillset(&all);
  int cause = posix_spawn_file_actions_init(&actions);
  if (cause) return cause;
  cause = posix_spawnattr_init(&attributes);
  if (cause) {
    posix_spawn_file_actions_destroy(&actions);
    return cause;
  }
  cause = posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
  if (!cause) cause = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  if (!cause) cause = posix_spawn_file_actions_adddup2(&actions, said, STDERR_FILENO);
  if (!cause) cause = posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  if (!cause) cause = posix_spawnattr_setsigdefault(&attributes, &all);
  if (!cause) cause = posix_spawnattr_setsigmask(&attributes, &none);
  if (!cause) cause = posix_spawnp(child, words[0], &actions, &attributes, (char *const *)words, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return cause;
}
