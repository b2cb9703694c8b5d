#include "strict.h"

#include "light_span.h"

#include "format.h"
#include "project.h"

/* Keeps products of spans, depths and texels within floats. */
#define SPAN_LIMIT 0x1p60

static float limited(double span) {
    const double at_most = span < SPAN_LIMIT ? span : SPAN_LIMIT;
    return (float)(at_most > 1 / SPAN_LIMIT ? at_most : 1 / SPAN_LIMIT);
}

bool shb_light_span_create(const shb_map *map, float light_size, shb_light_span *span) {
    const shb_projection *p = &map->projection;
    const double size = (double)light_size * (shb_projection_w(p) / p->depth_scale);
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
