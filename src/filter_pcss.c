/* Percentage-closer soft shadows: Fernando 2005, with one receiver plane in both stages (Ehm et al.
 * 2015, section 4.2). */
#include "strict.h"

#include "filter_check.h"
#include "filter_needs.h"
#include "format.h"
#include "kernels/shade.h"
#include "pcss.h"
#include "taps.h"

#include <float.h>

enum { LIGHT_SIZE, BLOCKERS, SAMPLES, TAPS };

static float to_float(double value) {
    return (float)(value < (double)FLT_MAX ? value : (double)FLT_MAX);
}

/* Half width of a penumbra in texels per difference of depth; see pcss.h. */
static double texels_per_depth(const shb_projection *p, double light_size, double texel) {
    return light_size / 2 * shb_projection_w(p) / (p->depth_scale * texel);
}

/* A number of taps: 0 for every texel. */
static int tap_count(float param) {
    return param >= 1 ? (int)(param < SHB_POISSON_MAX ? param : SHB_POISSON_MAX) : 0;
}

static void prepare_batch(const shb_filter_args *args, shb_pcss *pcss) {
    const shb_projection *projection = &args->map->projection;
    const float *params = args->filter->params;
    const double light_size = params[LIGHT_SIZE] > 0 ? (double)params[LIGHT_SIZE] : 0;
    const bool reversed = args->info->view.reversed;
    pcss->texels_x = to_float(texels_per_depth(projection, light_size, projection->texel_width));
    pcss->texels_y = to_float(texels_per_depth(projection, light_size, projection->texel_height));
    pcss->near_depth = reversed ? -1.0f : 0.0f;
    pcss->far_depth = shb_far_depth(reversed);
    pcss->blockers = tap_count(params[BLOCKERS]);
    pcss->samples = tap_count(params[SAMPLES]);
    pcss->own_depth = params[TAPS] == SHB_TAPS_OWN;
    pcss->pyramid = args->prepared;
    int points = pcss->blockers > pcss->samples ? pcss->blockers : pcss->samples;
    points = points > SHB_PCSS_SPREAD ? points : SHB_PCSS_SPREAD;
    for (int i = 0; i < points; i++)
        for (int axis = 0; axis < 2; axis++)
            pcss->points[i][axis] = (float)shb_poisson_disk[i][axis] * SHB_POISSON_UNIT;
    for (int i = 0; i < SHB_POISSON_TURNS; i++)
        for (int axis = 0; axis < 2; axis++)
            pcss->turns[2 * i + axis] = (float)shb_poisson_turns[i][axis] * SHB_POISSON_UNIT;
}

/* A fragment's taps that cut its plane in the world. */
typedef struct naive_taps {
    const shb_map *map;
    int32_t texel_x, texel_y;
    shb_tap_surface surface;
    float far_depth;
} naive_taps;

static bool is_blocked_naive(const void *state, int32_t m, int32_t n, float *depth) {
    const naive_taps *taps = state;
    const int32_t x = taps->texel_x + m, y = taps->texel_y + n;
    shb_map_fetch(taps->map, 1, &x, &y, depth);
    return *depth < taps->far_depth &&
           *depth < shb_tap_naive(&taps->map->rows, &taps->surface, m, n);
}

static void ask_naive(const shb_filter_args *args, const shb_pcss *pcss) {
    const shb_map *map = args->map;
    const shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        const naive_taps taps = {map, r->texel_x[i], r->texel_y[i],
                                 shb_tap_surface_of(&map->rows, r, i), pcss->far_depth};
        const shb_pcss_fragment fragment = {
            .texel_x = r->texel_x[i],
            .texel_y = r->texel_y[i],
            .to_center_x = r->to_center_x[i],
            .to_center_y = r->to_center_y[i],
            .depth = r->depth[i] < pcss->far_depth ? r->depth[i] : pcss->far_depth,
            .turn = shb_poisson_turn(r->x[i], r->y[i], r->z[i]),
            .is_blocked = is_blocked_naive,
            .taps = &taps};
        args->visibility[i] = shb_pcss_visibility(pcss, map, &fragment);
    }
}

static void pcss_filter(const shb_filter_args *args) {
    shb_pcss pcss;
    prepare_batch(args, &pcss);
    if (args->filter->params[TAPS] == SHB_TAPS_NAIVE)
        ask_naive(args, &pcss);
    else
        args->map->context->shade_kernels->pcss(&pcss, args->map, args->count, args->receivers,
                                                args->visibility);
}

static void pcss_exact(const shb_filter_args *args) {
    shb_pcss pcss;
    prepare_batch(args, &pcss);
    pcss.own_depth = false;
    args->map->context->shade_kernels->pcss_exact(&pcss, args);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    shb_pyramid *pyramid = shb_pyramid_create(map, bytes);
    if (!pyramid)
        return shb_filter_no_memory(map, filter);
    *prepared = pyramid;
    return SHB_OK;
}

shb_filter shb_filter_pcss(float light_size, int blocker_samples, int filter_samples,
                           shb_taps taps) {
    return (shb_filter){
        .name = "pcss",
        .filter = pcss_filter,
        .exact = pcss_exact,
        .prepare = prepare,
        .release = shb_pyramid_destroy,
        .needs = SHB_NEEDS_SAMPLES | shb_filter_needs_of(SHB_UNIT_TEXEL, taps),
        .params = {light_size, (float)blocker_samples, (float)filter_samples, (float)taps}};
}
