/* Details about as large as a texel: walls and reliefs. */
#include "cases.h"

#include "shapes.h"

#include <stdlib.h>

/* value: thickness in texels. */
static void build_walls(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    const double thickness = value * STABILITY_TEXEL;
    shape_box(seen, (shb_vec3){-1, -0.1, -1}, (shb_vec3){1, 0, 1});
    for (int i = 0; i < 4; i++) {
        const double at = -0.6 + 0.35 * i;
        shape_box(seen, (shb_vec3){at, 0, -0.9}, (shb_vec3){at + thickness, 0.3, 0});
        shape_box(seen, (shb_vec3){-0.9, 0, 0.9 - 0.2 * i - thickness},
                  (shb_vec3){0.9, 0.1, 0.9 - 0.2 * i});
    }
}

/* A zigzag of slopes of 45 degrees; value: width of a slope in texels. */
static void build_relief(owned_mesh *seen, owned_mesh *unseen, double value) {
    (void)unseen;
    const double width = value * STABILITY_TEXEL;
    const uint32_t columns = (uint32_t)(2 / width) + 2;
    shb_vec3 *points = malloc(2 * columns * sizeof *points);
    if (!points) {
        seen->failed = true;
        return;
    }
    for (uint32_t i = 0; i < columns; i++) {
        const shb_vec3 point = {-1 + i * width, i % 2 ? width : 0, 1};
        points[i] = point;
        points[columns + i] = (shb_vec3){point.x, point.y, -1};
    }
    shape_grid(seen, points, columns, 2, false);
    free(points);
}

#define DETAIL(texels, is_quick)                                                                   \
    {.group = "wall",                                                                              \
     .name = "wall-" #texels,                                                                      \
     .build = build_walls,                                                                         \
     .value = texels,                                                                              \
     .closed = true,                                                                               \
     .quick = is_quick},                                                                           \
    {                                                                                              \
        .group = "relief", .name = "relief-" #texels, .build = build_relief, .value = texels,      \
        .quick = is_quick                                                                          \
    }

static const stability_case cases[] = {
    DETAIL(0.1, true), DETAIL(0.25, false), DETAIL(0.5, false), DETAIL(1, true),
    DETAIL(2, false),  DETAIL(4, false),    DETAIL(8, false),   DETAIL(16, false),
};

stability_cases stability_texel_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
