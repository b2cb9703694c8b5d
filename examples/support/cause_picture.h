/* Pictures of causes: wrong fragments in colours that people who see no red or green tell apart (M.
 * Okabe and K. Ito 2008), each with a pattern of its own for those who see no colour; all others in
 * the grey of the truth. */
#ifndef EXAMPLES_CAUSE_PICTURE_H
#define EXAMPLES_CAUSE_PICTURE_H

#include "causes.h"

/* Lit is light grey, shadow grey, and what does not count nearly white. pixels: three bytes each,
 * of the frame's size. */
void cause_picture_paint(const measure_frame *frame, const uint8_t *truth_of_pixels,
                         const uint8_t *causes, uint8_t *pixels);

/* The colour of a cause at a pixel. */
void cause_picture_color(cause kind, uint32_t x, uint32_t y, uint8_t color[3]);

#endif
