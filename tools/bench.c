#include "commands.h"

StyStatus run_bench(int argc, char **argv) {
  (void)argc, (void)argv;
  return STY_OK;
}
