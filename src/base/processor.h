/* Which of the processor's vector units to use. Every unit gives the same
 * bytes; the choice is speed alone. */
#ifndef STYLUT_SRC_BASE_PROCESSOR_H
#define STYLUT_SRC_BASE_PROCESSOR_H

typedef enum StyVectorUnit { STY_UNIT_PLAIN, STY_UNIT_AVX2, STY_UNIT_AVX512 } StyVectorUnit;

/* The widest there is, or what the environment's STYLUT_VECTOR (plain, avx2 or
 * avx512) asks for, if the processor has it. */
StyVectorUnit sty_get_vector_unit(void);

#endif
