/* Percentage-closer filtering over boxes of texels and over scattered ones: Reeves, Salesin and
 * Cook, Rendering antialiased shadows with depth maps, 1987; taps as in Ehm et al., Adaptive depth
 * bias for soft shadows, 2015.
 */
#include "strict.h"

#include "filter_needs.h"
#include "kernels/shade.h"
#include "stages.h"
#include "taps.h"

static void pcf(const shb_filter_args *args) {
    args->map->context->shade_kernels->pcf(args);
}

static void pcf_exact(const shb_filter_args *args) {
    args->map->context->shade_kernels->pcf_exact(args);
}

bool shb_pcf_is_centered(const shb_filter *filter) {
    const float *params = filter->params;
    return filter->filter == pcf && params[1] != SHB_UNIT_WORLD && shb_box_size(params[0], 1) % 2;
}

shb_filter shb_filter_pcf(float size, shb_unit unit, shb_taps taps) {
    return (shb_filter){.name = "pcf",
                        .filter = pcf,
                        .exact = pcf_exact,
                        .needs = SHB_NEEDS_SAMPLES | shb_filter_needs_of(unit, taps),
                        .params = {size, (float)unit, (float)taps}};
}

static void pcf_smooth(const shb_filter_args *args) {
    args->map->context->shade_kernels->pcf_smooth(args);
}

static void pcf_smooth_exact(const shb_filter_args *args) {
    args->map->context->shade_kernels->pcf_smooth_exact(args);
}

shb_filter shb_filter_pcf_smooth(float size, shb_unit unit, shb_taps taps) {
    return (shb_filter){.name = "pcf-smooth",
                        .filter = pcf_smooth,
                        .exact = pcf_smooth_exact,
                        .needs = SHB_NEEDS_SAMPLES | shb_filter_needs_of(unit, taps),
                        .params = {size, (float)unit, (float)taps}};
}

static void jittered(const shb_filter_args *args) {
    args->map->context->shade_kernels->jittered(args);
}

static void jittered_exact(const shb_filter_args *args) {
    args->map->context->shade_kernels->jittered_exact(args);
}

shb_filter shb_filter_jittered(float size, shb_unit unit, shb_taps taps) {
    return (shb_filter){.name = "jittered",
                        .filter = jittered,
                        .exact = jittered_exact,
                        .needs = SHB_NEEDS_SAMPLES | shb_filter_needs_of(unit, taps),
                        .params = {size, (float)unit, (float)taps}};
}

static void poisson(const shb_filter_args *args) {
    args->map->context->shade_kernels->poisson(args);
}

static void poisson_exact(const shb_filter_args *args) {
    args->map->context->shade_kernels->poisson_exact(args);
}

shb_filter shb_filter_poisson(float count, float radius, shb_unit unit, shb_taps taps) {
    return (shb_filter){.name = "poisson",
                        .filter = poisson,
                        .exact = poisson_exact,
                        .needs = SHB_NEEDS_SAMPLES | shb_filter_needs_of(unit, taps),
                        .params = {count, radius, (float)unit, (float)taps}};
}
