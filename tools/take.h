/* Files of tools/files that the tool writes out: texts of its own, each with a zero behind it. */
#ifndef STYLUT_TOOLS_TAKE_H
#define STYLUT_TOOLS_TAKE_H

#define TAKE(name, file)                                                                           \
  __asm__(".section .rodata\n" #name ":\n.incbin \"tools/files/" file "\"\n.byte 0\n.previous\n"); \
  extern const char name[] __attribute__((visibility("hidden")))

#endif
