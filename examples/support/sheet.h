/* Contact sheets: pictures in a grid, each with a caption. */
#ifndef EXAMPLES_SHEET_H
#define EXAMPLES_SHEET_H

#include "shadowbias/image.h"

typedef struct contact_sheet {
    shb_image image;
    uint32_t columns;
    uint32_t tile_width, tile_height; /* pixels of a picture on the sheet */
} contact_sheet;

/* An empty sheet for count tiles. False: out of memory. */
bool sheet_create(contact_sheet *sheet, uint32_t columns, uint32_t count, uint32_t tile_width,
                  uint32_t tile_height);

/* Fills tile number index: a picture that is divisor times as large as the tile, reduced so that
 * each pixel is the mean of a square, and a caption below it. */
void sheet_place(contact_sheet *sheet, uint32_t index, const shb_image *picture, uint32_t divisor,
                 const char *caption);

void sheet_destroy(contact_sheet *sheet);

#endif
