/* Text for pictures: printable ASCII in cells of 6 x 9 dots. */
#ifndef EXAMPLES_FONT_H
#define EXAMPLES_FONT_H

#include "shadowbias/image.h"

#define FONT_WIDTH 6
#define FONT_HEIGHT 9

/* Draws text with its upper left corner at (x, y), each dot scale x scale pixels; what falls
 * outside the image is left out, other characters appear as '?'. */
void font_draw(shb_image *image, int64_t x, int64_t y, uint32_t scale, const uint8_t color[3],
               const char *text);

#endif
