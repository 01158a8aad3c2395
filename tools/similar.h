/* Words that were most likely meant. */
#ifndef STYLUT_TOOLS_SIMILAR_H
#define STYLUT_TOOLS_SIMILAR_H

enum { HINT_SIZE = 64 };

/* "; did you mean 'WORD'?" for the end of a message, of the NULL-terminated words the one that is spelt most like what
 * was found; "" where none is near. Returns `out`. */
const char *hint_at(const char *found, const char *const *words, char out[HINT_SIZE]);

#endif
