/* Where a target's images are clear, from one drawing to the next: a byte for each cell. */
#ifndef SRC_MARKS_H
#define SRC_MARKS_H

#include "shadowbias/raster.h"

/* Cells of a row. */
size_t shb_marks_stride(uint32_t width);

/* The description's marks, row after row: SHB_MARK_CLEAR where all of its images are clear, as far
 * as that is known; 0 everywhere if it speaks of other images than the drawing before. NULL: it has
 * none. */
uint8_t *shb_marks_open(const shb_draw_desc *desc);

/* Nothing is known to be clear any more; marks may be NULL. */
void shb_marks_forget(uint8_t *marks, uint32_t width, uint32_t height);

#endif
