#include "sheet.h"

#include "font.h"

#include <stdlib.h>
#include <string.h>

enum { gap = 8, text_scale = 2, caption_height = FONT_HEIGHT * text_scale + 6 };

bool sheet_create(contact_sheet *sheet, uint32_t columns, uint32_t count, uint32_t tile_width,
                  uint32_t tile_height) {
    const uint32_t rows = (count + columns - 1) / columns;
    const shb_image image = {.width = columns * (tile_width + gap) + gap,
                             .height = rows * (tile_height + caption_height + gap) + gap};
    const size_t size = 3 * (size_t)image.width * image.height;
    *sheet = (contact_sheet){image, columns, tile_width, tile_height};
    sheet->image.pixels = malloc(size);
    if (sheet->image.pixels)
        memset(sheet->image.pixels, 24, size);
    return sheet->image.pixels != NULL;
}

static uint8_t mean_of_square(const shb_image *picture, size_t x, size_t y, uint32_t size,
                              size_t channel) {
    const size_t stride = picture->stride ? picture->stride : 3 * (size_t)picture->width;
    uint32_t sum = 0;
    for (size_t row = 0; row < size; row++)
        for (size_t column = 0; column < size; column++)
            sum += picture->pixels[(y + row) * stride + 3 * (x + column) + channel];
    return (uint8_t)((sum + size * size / 2) / (size * size));
}

void sheet_place(contact_sheet *sheet, uint32_t index, const shb_image *picture, uint32_t divisor,
                 const char *caption) {
    const size_t left = gap + index % sheet->columns * (sheet->tile_width + gap);
    const size_t top = gap + index / sheet->columns * (sheet->tile_height + caption_height + gap);
    for (size_t y = 0; y < sheet->tile_height; y++)
        for (size_t x = 0; x < sheet->tile_width; x++) {
            uint8_t *pixel = sheet->image.pixels + 3 * ((top + y) * sheet->image.width + left + x);
            for (size_t k = 0; k < 3; k++)
                pixel[k] = mean_of_square(picture, divisor * x, divisor * y, divisor, k);
        }
    static const uint8_t white[3] = {235, 235, 235};
    font_draw(&sheet->image, (int64_t)left + 2, (int64_t)(top + sheet->tile_height) + 5, text_scale,
              white, caption);
}

void sheet_destroy(contact_sheet *sheet) {
    free(sheet->image.pixels);
    *sheet = (contact_sheet){0};
}
