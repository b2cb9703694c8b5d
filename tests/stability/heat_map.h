/* The results as a picture: cases down, methods across; the darker a cell, the more fragments are
 * wrong. The digit in a cell is how many digits the wrong fragments per million have; 0: none. */
#ifndef STABILITY_HEAT_MAP_H
#define STABILITY_HEAT_MAP_H

#include "rows.h"

/* The digits of a rate per million, 0 .. 7; a rate below 1 that is not 0 has one. */
int heat_map_digits(double rate);

/* Writes heat.ppm and heat.svg into a directory. */
shb_result heat_map_write(const stability_rows *rows, const char *directory);

#endif
