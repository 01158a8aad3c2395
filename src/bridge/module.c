#include "bridge/module.h"

#include <dlfcn.h>
#include <pthread.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* Found beside the program, in ../lib, or where the system looks. Stays open:
 * libraries with threads of their own don't survive being unloaded. */
static StyStatus load(const StyModule *module, StyError *error) {
  const double room = sty_get_address_room(), threads = module->has_threads ? (double)sysconf(_SC_NPROCESSORS_ONLN) : 0,
               needed = module->addresses + threads * STY_THREAD_ADDRESSES;
  if (room < needed)
    return sty_fail(error, STY_ERROR_LIBRARY, "%s: found %.0f MB of addresses left, expected %.0f or more (ulimit -v)",
                    module->what, room / 1e6, needed / 1e6);
  void *handle = dlopen(module->file, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  for (int s = 0; handle && s < module->symbol_count; s++) {
    void *found = dlsym(handle, module->symbols[s].name);
    if (!found) handle = NULL;
    memcpy(module->symbols[s].place, &found, sizeof found);
  }
  if (handle) return STY_OK;
  return sty_fail(error, STY_ERROR_UNAVAILABLE, "%s: %s; expected %s beside stylut or in ../lib", module->what,
                  dlerror(), module->file);
}

StyStatus sty_open_module(StyModule *module, StyError *error) {
  pthread_mutex_lock(&lock);
  if (!module->is_open && !module->cause.status) module->is_open = !load(module, &module->cause);
  pthread_mutex_unlock(&lock);
  return module->is_open ? STY_OK : sty_fail(error, module->cause.status, "%s", module->cause.text);
}
