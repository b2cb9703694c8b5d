#include "cause_picture.h"

#include <string.h>

/* Two tones, and where the second one is: rows of four pixels from top to bottom, the left pixel in
 * the highest of four bits. */
static const struct {
    uint8_t first[3], second[3];
    uint8_t rows[4];
} looks[CAUSES] = {
    [CAUSE_KERNEL] = {{240, 228, 66}, {150, 138, 20}, {10, 5, 10, 5}},
    [CAUSE_QUANTISATION] = {{86, 180, 233}, {10, 70, 120}, {8, 0, 2, 0}},
    [CAUSE_SLOPE] = {{230, 159, 0}, {120, 78, 0}, {15, 0, 0, 0}},
    [CAUSE_BIAS] = {{0, 114, 178}, {0, 114, 178}, {0, 0, 0, 0}},
    [CAUSE_OFFSET] = {{204, 121, 167}, {110, 40, 80}, {8, 4, 2, 1}},
    [CAUSE_CREASE] = {{213, 94, 0}, {255, 190, 140}, {8, 8, 8, 8}},
    [CAUSE_EXTRAPOLATION] = {{0, 158, 115}, {150, 230, 205}, {1, 2, 4, 8}},
    [CAUSE_SAMPLING] = {{25, 25, 25}, {25, 25, 25}, {0, 0, 0, 0}},
    [CAUSE_UNEXPLAINED] = {{255, 255, 255}, {255, 0, 0}, {9, 6, 6, 9}},
};

void cause_picture_color(cause kind, uint32_t x, uint32_t y, uint8_t color[3]) {
    const bool second = looks[kind].rows[y % 4] >> (3 - x % 4) & 1;
    memcpy(color, second ? looks[kind].second : looks[kind].first, 3);
}

static uint8_t grey_of(uint8_t truth) {
    return truth == SHB_TRUTH_NONE ? 240 : truth & SHB_TRUTH_LIT ? 205 : 150;
}

void cause_picture_paint(const measure_frame *frame, const uint8_t *truth_of_pixels,
                         const uint8_t *causes, uint8_t *pixels) {
    const uint32_t width = frame->frame.width, height = frame->frame.height;
    for (size_t i = 0; i < (size_t)width * height; i++)
        memset(pixels + 3 * i, grey_of(truth_of_pixels[i]), 3);
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const uint32_t pixel = frame->pixels[i];
        if (causes[i] != CAUSE_NONE)
            cause_picture_color((cause)causes[i], pixel % width, pixel / width,
                                pixels + 3 * (size_t)pixel);
    }
}
