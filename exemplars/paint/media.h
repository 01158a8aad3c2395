/* The five media: each fills a new canvas; NULL when memory is short. */
#ifndef PAINT_MEDIA_H
#define PAINT_MEDIA_H

#include "canvas.h"

Canvas *paint_pencil(void);
Canvas *paint_stipple(void);
Canvas *paint_watercolour(void);
Canvas *paint_oil(void);
Canvas *paint_charcoal(void);

#endif
