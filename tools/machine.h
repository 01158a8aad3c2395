/* What figures of speed were taken with and on. */
#ifndef STYLUT_TOOLS_MACHINE_H
#define STYLUT_TOOLS_MACHINE_H

enum { MACHINE_SIZE = 512 };

/* "OpenImageIO 2.4.7, Assimp ..., ...": returns `text`. */
const char *format_libraries(char text[MACHINE_SIZE]);

/* "PROCESSOR, N cores": returns `text`. */
const char *format_processor(char text[MACHINE_SIZE]);

/* "PROCESSOR, N cores; stylut VERSION; LIBRARIES", a single line: returns `text`. */
const char *format_machine(char text[MACHINE_SIZE]);

#endif
