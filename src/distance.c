#include "strict.h"

#include "distance.h"

#include "depth_rows.h"
#include "format.h"
#include "larger.h"

/* Smaller ones stand for 1 / w at infinity, and keep k finite. */
#define LEAST_INVERSE 0x1p-60

/* A of a central projection less the far depth, which is B / w of the far plane. */
static double inverse_of_far(const shb_projection *p, double far_depth) {
    double zw = 0, ww = 0;
    for (int i = 0; i < 3; i++) {
        zw += p->row_z[i] * p->row_w[i];
        ww += p->row_w[i] * p->row_w[i];
    }
    return larger(p->sign * zw / ww - far_depth, LEAST_INVERSE);
}

shb_distance shb_distance_of(const shb_map *map) {
    const shb_projection *p = &map->projection;
    const double far_depth = (double)shb_far_depth(map->info.view.reversed);
    shb_distance distance = {
        .far_depth = (float)far_depth,
        .scale = 1,
        .relative = 8 * 0x1p-24f, /* 5 of the map's depths, the rest of receivers */
        .fixed = shb_format_step(map->info.format),
    };
    if (p->row_w[0] == 0 && p->row_w[1] == 0 && p->row_w[2] == 0)
        return distance;
    const shb_depth_range range = shb_depth_range_of(map);
    const double inverse_far = inverse_of_far(p, far_depth);
    const double farthest = far_depth - (double)range.farthest;
    const double end = larger(0.5 * (farthest - inverse_far), 0);
    const double kept = end < 0.5 ? end : 0.5;
    distance.end = (float)kept;
    distance.scale = (float)(1 / (1 - kept));
    distance.ratio = (float)((1 + inverse_far) / (kept + inverse_far) - 1);
    return distance;
}
