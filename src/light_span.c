#include "strict.h"

#include "light_span.h"

#include <math.h>

#include "format.h"

/* Keeps products of spans, depths and texels within floats. */
#define SPAN_LIMIT 0x1p60

/* The nearest texel of a window makes it smaller, and that its nearest texel farther. */
enum { NARROWINGS = 3 };

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

void shb_light_span_destroy(const shb_map *map, shb_light_span *span) {
    shb_depth_minima_destroy(map, &span->minima);
}

bool shb_light_place_of(const shb_map *map, const shb_light_span *span,
                        const shb_receivers *receivers, size_t index, shb_light_place *place) {
    const shb_receivers *r = receivers;
    const int32_t texel_x = r->texel_x[index], texel_y = r->texel_y[index];
    const float to_x = r->to_center_x[index], to_y = r->to_center_y[index];
    const float own = r->ref[index] - (r->step_x[index] * to_x + r->step_y[index] * to_y);
    place->x = ((float)texel_x + 0.5f) - to_x;
    place->y = ((float)texel_y + 0.5f) - to_y;
    place->depth = own < span->far_depth ? own : span->far_depth;
    return (uint32_t)texel_x < map->info.width && (uint32_t)texel_y < map->info.height &&
           own > span->near_depth;
}

/* The texel that holds a place, or the map's first or last one. */
static int32_t texel_at(float place, uint32_t size) {
    const float last = (float)(size - 1);
    const float at_most = place < last ? place : last;
    return (int32_t)(at_most > 0 ? at_most : 0);
}

shb_texel_box shb_light_span_box(const shb_map *map, const shb_light_span *span,
                                 const shb_light_place *place, float nearer_by) {
    const uint32_t width = map->info.width, height = map->info.height;
    const float reach_x = 0.5f * span->x * nearer_by, reach_y = 0.5f * span->y * nearer_by;
    return (shb_texel_box){
        texel_at(place->x - reach_x, width), texel_at(place->y - reach_y, height),
        texel_at(place->x + reach_x, width), texel_at(place->y + reach_y, height)};
}

float shb_light_span_nearest(const shb_map *map, const shb_light_span *span,
                             const shb_light_place *place) {
    float nearest = span->near_depth;
    for (int i = 0; i < NARROWINGS && nearest < place->depth; i++) {
        const shb_texel_box box = shb_light_span_box(map, span, place, place->depth - nearest);
        nearest = shb_depth_minima_over(&span->minima, &box);
    }
    return nearest;
}
