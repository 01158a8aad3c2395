/* Libraries that most commands never call are opened at their first use: loading Embree, Assimp and FLANN takes longer
 * than building a table does, and OpenImageIO much longer. Each is behind a module of ours beside the program, which is
 * linked to it and else holds nothing (for OpenImageIO: what must be C++). */
#ifndef STYLUT_BRIDGE_MODULE_H
#define STYLUT_BRIDGE_MODULE_H

#include <stdbool.h>

#include "stylut/status.h"

/* What of a module is called, and the pointer that is to know where it is. */
typedef struct StySymbol {
  const char *name;
  void *place;
} StySymbol;

typedef struct StyModule {
  const char *what, *file; /* what is in it, for messages */
  double addresses;        /* that it takes, in bytes: without room for them its start may end the process */
  bool has_threads;        /* and starts one per processor */
  const StySymbol *symbols;
  int symbol_count;
  bool is_open;   /* private, as what follows */
  StyError cause; /* of its not being open */
} StyModule;

/* A struct of pointers to a library's functions, and the list to fill it from, both from one X-macro of names. */
#define STY_MODULE_MEMBER(name) __typeof__(name) *name;
#define STY_MODULE_SYMBOL(owner, name) \
  { #name, &(owner).name }
#define STY_MODULE(what, file, addresses, has_threads, symbols)                                                    \
  {                                                                                                                \
    what, file, addresses, has_threads, symbols, (int)(sizeof(symbols) / sizeof *(symbols)), false, { STY_OK, "" } \
  }

/* Thread-safe; costs a lock once the module is open. STY_ERROR_LIBRARY: no room, STY_ERROR_UNAVAILABLE: not found. */
StyStatus sty_open_module(StyModule *module, StyError *error);

#endif
