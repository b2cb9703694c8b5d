/* One scene at every scale and place, under near and far lights, in maps of all sizes and formats.
 */
#include "cases.h"

#include "shapes.h"

void stability_build_blocks(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    shape_box(seen, (shb_vec3){-1, -0.1, -1}, (shb_vec3){1, 0, 1});
    shape_box(seen, (shb_vec3){-0.6, 0, -0.5}, (shb_vec3){-0.2, 0.5, -0.1});
    shape_box(seen, (shb_vec3){0.1, 0, 0.2}, (shb_vec3){0.5, 0.2, 0.6});
    shape_box(seen, (shb_vec3){0.2, 0.35, -0.6}, (shb_vec3){0.7, 0.4, -0.1});
    shape_box(seen, (shb_vec3){0.75, 0, 0.1}, (shb_vec3){0.78, 0.6, 0.13});
    shape_ball(seen, (shb_vec3){-0.4, 0.25, 0.45}, 0.25, 48);
}

#define BLOCKS(case_group, case_name, is_quick)                                                    \
    .group = case_group, .name = case_name, .build = stability_build_blocks, .closed = true,       \
    .quick = is_quick

#define SCALE(factor, is_quick)                                                                    \
    { BLOCKS("scale", "scale-" #factor, is_quick), .scale = factor }
#define MOVED(distance, is_quick)                                                                  \
    { BLOCKS("moved", "moved-" #distance, is_quick), .scale = 10, .moved = distance }
#define RANGE(ratio, is_quick)                                                                     \
    {BLOCKS("near-far", "near-far-" #ratio, is_quick), .spot_distance = 1, .far_to_near = ratio},  \
    {                                                                                              \
        BLOCKS("near-far", "near-far-" #ratio "-reversed", is_quick),                              \
            .spot_distance = 1, .far_to_near = ratio, .reversed = true                             \
    }
#define DISTANCE(diagonals, is_quick)                                                              \
    { BLOCKS("light-distance", "light-distance-" #diagonals, is_quick), .spot_distance = diagonals }
#define SIZE(texels, is_quick)                                                                     \
    { BLOCKS("map-size", "map-size-" #texels, is_quick), .map_size = texels }
#define FORMAT(text, stored, is_quick)                                                             \
    {BLOCKS("format", "sun-" text, is_quick), .format = stored},                                   \
        {BLOCKS("format", "sun-" text "-reversed", is_quick), .format = stored, .reversed = true}, \
        {BLOCKS("format", "spot-" text, is_quick), .format = stored, .spot_distance = 1,           \
         .far_to_near = 30},                                                                       \
    {                                                                                              \
        BLOCKS("format", "spot-" text "-reversed", is_quick),                                      \
            .format = stored, .spot_distance = 1, .far_to_near = 30, .reversed = true              \
    }

static const stability_case cases[] = {
    SCALE(1e-4, true),
    SCALE(1e-2, false),
    SCALE(1, false),
    SCALE(1e2, false),
    SCALE(1e4, false),
    SCALE(1e7, true),
    MOVED(1e3, true),
    MOVED(1e4, false),
    MOVED(1e5, true),
    MOVED(1e6, false),
    MOVED(1e7, false),
    RANGE(1e1, false),
    RANGE(1e2, true),
    RANGE(1e3, false),
    RANGE(1e4, false),
    RANGE(1e5, false),
    RANGE(1e6, true),
    DISTANCE(1, false),
    DISTANCE(1e1, false),
    DISTANCE(1e2, false),
    DISTANCE(1e3, true),
    DISTANCE(1e4, false),
    DISTANCE(1e5, false),
    DISTANCE(1e6, true),
    SIZE(64, true),
    SIZE(128, false),
    SIZE(256, true),
    SIZE(512, false),
    SIZE(2048, false),
    SIZE(4096, false),
    SIZE(8192, false),
    FORMAT("float32", SHB_FORMAT_FLOAT32, false),
    FORMAT("unorm24", SHB_FORMAT_UNORM24, false),
    FORMAT("unorm16", SHB_FORMAT_UNORM16, true),
};

stability_cases stability_view_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
