#include "machine.h"

#include <stdio.h>
#include <string.h>

#include "options.h"
#include "stylut/parallel.h"
#include "stylut/version.h"

const char *format_libraries(char text[MACHINE_SIZE]) {
  const char *geometry = sty_get_geometry_library_version();
  snprintf(text, MACHINE_SIZE, "%s, %s, %s, %s, %s", sty_get_image_library_version(), sty_get_mesh_library_version(),
           sty_get_ray_library_version(), sty_get_search_library_version(), geometry ? geometry : "without CGAL");
  return text;
}

/* As Linux tells it on x86. */
static void find_processor(char *name, int size) {
  FILE *stream = fopen("/proc/cpuinfo", "r");
  char line[256], found[200];
  snprintf(name, (size_t)size, "unknown processor");
  while (stream && fgets(line, sizeof line, stream))
    if (sscanf(line, "model name : %199[^\n]", found) == 1) {
      snprintf(name, (size_t)size, "%s", clean_text(found));
      break;
    }
  if (stream) fclose(stream);
}

const char *format_processor(char text[MACHINE_SIZE]) {
  char processor[200];
  find_processor(processor, sizeof processor);
  const int cores = sty_get_threads(NULL);
  snprintf(text, MACHINE_SIZE, "%.100s, %d core%s", processor, cores, cores == 1 ? "" : "s");
  return text;
}

const char *format_machine(char text[MACHINE_SIZE]) {
  char processor[MACHINE_SIZE], libraries[MACHINE_SIZE];
  snprintf(text, MACHINE_SIZE, "%.120s; stylut %s; %.300s", format_processor(processor), STY_VERSION,
           format_libraries(libraries));
  return text;
}
