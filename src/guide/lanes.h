/* Eight of a thing by component, so that a compiler can work on all of them at once. */
#ifndef STYLUT_GUIDE_LANES_H
#define STYLUT_GUIDE_LANES_H

enum { STY_LANES = 8 };

typedef double StyLane[STY_LANES]; /* one number of each */
typedef float StyFloatLane[STY_LANES];

/* Where they are pixels, they are a block of so many columns and rows. */
enum { STY_BLOCK_WIDTH = 4, STY_BLOCK_HEIGHT = STY_LANES / STY_BLOCK_WIDTH };

#define EACH_LANE for (int i = 0; i < STY_LANES; i++)

#endif
