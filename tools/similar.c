#include "similar.h"

#include <stdio.h>
#include <string.h>

enum { LONGEST = 16, FARTHEST = 2 };

static int get_least(int a, int b) { return a < b ? a : b; }

/* Letters to put in, leave out, replace or swap with the next one (Damerau 1964), each once at most. */
static int count_slips(const char *a, const char *b) {
  const int rows = (int)strlen(a), columns = (int)strlen(b);
  int slips[LONGEST + 1][LONGEST + 1];
  if (rows > LONGEST || columns > LONGEST) return LONGEST;
  for (int i = 0; i <= rows; i++)
    for (int j = 0; j <= columns; j++) {
      slips[i][j] = i + j;
      if (i && j) {
        slips[i][j] = get_least(slips[i - 1][j], slips[i][j - 1]) + 1;
        slips[i][j] = get_least(slips[i][j], slips[i - 1][j - 1] + (a[i - 1] != b[j - 1]));
      }
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        slips[i][j] = get_least(slips[i][j], slips[i - 2][j - 2] + 1);
    }
  return slips[rows][columns];
}

const char *hint_at(const char *found, const char *const *words, char out[HINT_SIZE]) {
  const char *nearest = NULL;
  int least = FARTHEST + 1;
  for (int w = 0; words[w]; w++) {
    const int slips = count_slips(found, words[w]);
    if (slips >= least || slips >= (int)strlen(words[w]) - 1) continue;
    least = slips;
    nearest = words[w];
  }
  out[0] = '\0';
  if (nearest) snprintf(out, HINT_SIZE, "; did you mean '%s'?", nearest);
  return out;
}
