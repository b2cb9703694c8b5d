#include "strict.h"

#include "light_span.h"

#include <math.h>

#include "format.h"

/* Keeps products of spans, depths and texels within floats. */
#define SPAN_LIMIT 0x1p60

static float limited(double span) {
    const double at_most = span < SPAN_LIMIT ? span : SPAN_LIMIT;
    return (float)(at_most > 1 / SPAN_LIMIT ? at_most : 1 / SPAN_LIMIT);
}

/* 1 / q: w counts distances along the light's axis in units of 1 / |row w|, and is the same
 * everywhere under parallel rays. */
static double inverse_per_depth(const shb_projection *p) {
    const double *w = p->row_w;
    const double length = sqrt((w[0] * w[0] + w[1] * w[1]) + w[2] * w[2]);
    return (length > 0 ? length : w[3]) / p->depth_scale;
}

bool shb_light_span_create(const shb_map *map, float light_size, shb_light_span *span) {
    const shb_projection *p = &map->projection;
    const double size = (double)light_size * inverse_per_depth(p);
    const bool reversed = map->info.view.reversed;
    *span = (shb_light_span){.x = limited(size / p->texel_width),
                             .y = limited(size / p->texel_height),
                             .near_depth = reversed ? -1.0f : 0.0f,
                             .far_depth = shb_far_depth(reversed)};
    return shb_depth_minima_create(map, &span->minima);
}

void shb_light_span_fill(const shb_map *map, const shb_light_span *span) {
    shb_depth_minima_fill(map, &span->minima);
}

void shb_light_span_destroy(const shb_map *map, shb_light_span *span) {
    shb_depth_minima_destroy(map, &span->minima);
}
