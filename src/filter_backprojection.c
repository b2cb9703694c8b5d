/* Soft shadows by backprojection: Guennebaud, Barthe and Paulin 2006. What the quads of the map
 * cover of the light is added up. Sides are rounded to whole parts of the light, so that the sum is
 * exact and quads that share sides cover exactly what they cover together. */
#include "strict.h"

#include "backprojection.h"

/* Of the light's width. */
#define PARTS 1024

static uint64_t covered_of_row(const shb_quad_row *row, size_t count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (uint32_t)((row->x1[i] - row->x0[i]) * (row->y1[i] - row->y0[i]));
    return sum;
}

static float visible_part(const shb_filter_args *args, const shb_light_windows *windows,
                          size_t index) {
    const uint64_t all = (uint64_t)PARTS * PARTS;
    shb_quad_window window;
    shb_quad_row row;
    uint64_t covered = 0;
    if (!shb_quad_window_open(args, windows, index, &window))
        return 1;
    for (int32_t y = 0; y < window.rows; y++)
        if (shb_quad_window_read(&window, y, PARTS, &row))
            covered += covered_of_row(&row, (size_t)window.columns);
    return covered < all ? (float)(all - covered) / (float)all : 0;
}

static void backprojection(const shb_filter_args *args) {
    shb_light_windows windows;
    shb_quad_windows_find(args, &windows);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = visible_part(args, &windows, i);
}

shb_filter shb_filter_backprojection(float light_size, int window) {
    return (shb_filter){.name = "backprojection",
                        .filter = backprojection,
                        .prepare = shb_backprojection_prepare,
                        .release = shb_backprojection_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size, (float)window}};
}
