/* The table of all filters, and their text form. */
#include "shadowbias/filter.h"
#include "method_text.h"

static shb_filter make_pcf(void) {
    return shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
}

static shb_filter make_pcf_smooth(void) {
    return shb_filter_pcf_smooth(2, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
}

static shb_filter make_jittered(void) {
    return shb_filter_jittered(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
}

static shb_filter make_poisson(void) {
    return shb_filter_poisson(16, 3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
}

static shb_filter variance(void) {
    return shb_filter_variance(5, 0.2f);
}

static shb_filter exponential_variance(void) {
    return shb_filter_exponential_variance(5, 80, 10, 0);
}

static shb_filter moments(void) {
    return shb_filter_moments(5);
}

static shb_filter variance_soft(void) {
    return shb_filter_variance_soft(0.05f, 0.1f);
}

static shb_filter exponential_variance_soft(void) {
    return shb_filter_exponential_variance_soft(0.05f, 20, 40, 0);
}

static shb_filter moments_soft(void) {
    return shb_filter_moments_soft(0.05f);
}

static shb_filter backprojection(void) {
    return shb_filter_backprojection(1, 32);
}

static shb_filter bitmask(void) {
    return shb_filter_bitmask(1, 32, 64);
}

static shb_filter pcss(void) {
    return shb_filter_pcss(0.05f, 25, 25, SHB_TAPS_PLANE);
}

static const shb_filter_method methods[] = {
    {"hard", "one tap", shb_filter_hard, {NULL}},
    {"pcf", "share of lit texels in a box", make_pcf, {"size", "unit", "taps"}},
    {"pcf-smooth", "the same with soft edges", make_pcf_smooth, {"size", "unit", "taps"}},
    {"jittered", "16 taps, each in a cell of its own", make_jittered, {"size", "unit", "taps"}},
    {"poisson", "taps on a disk", make_poisson, {"count", "radius", "unit", "taps"}},
    {"variance", "bound by mean and variance of distance", variance, {"size", "bleeding"}},
    {"exponential-variance",
     "the same for exponentials of distance",
     exponential_variance,
     {"size", "positive", "negative", "bleeding"}},
    {"moments", "bound by four moments of distance", moments, {"size"}},
    {"variance-soft",
     "variance over kernels as wide as the penumbra",
     variance_soft,
     {"light", "bleeding"}},
    {"exponential-variance-soft",
     "exponential-variance over such kernels",
     exponential_variance_soft,
     {"light", "positive", "negative", "bleeding"}},
    {"moments-soft", "moments over such kernels", moments_soft, {"light"}},
    {"backprojection",
     "sum of what texels cover of a square light",
     backprojection,
     {"light", "window"}},
    {"bitmask",
     "samples of a square light that no texel covers",
     bitmask,
     {"light", "window", "samples"}},
    {"pcss",
     "kernels as wide as the penumbra of what blocks the light",
     pcss,
     {"light", "blockers", "samples", "taps"}},
};

enum { METHOD_COUNT = sizeof methods / sizeof *methods };

const shb_filter_method *shb_filter_methods(size_t *count) {
    if (count)
        *count = METHOD_COUNT;
    return methods;
}

static bool is_one_of_three(float value) {
    return value == 0 || value == 1 || value == 2;
}

/* What a filter needs follows from its parameters. False for an unknown unit or taps. */
static bool rebuild(shb_filter *filter, shb_filter (*make)(void)) {
    const float *p = filter->params;
    const float unit = p[make == make_poisson ? 2 : 1], taps = p[make == make_poisson ? 3 : 2];
    if (make == pcss) {
        filter->needs = SHB_NEEDS_SAMPLES | (p[3] == SHB_TAPS_NAIVE ? SHB_NEEDS_NORMAL : 0u);
        return is_one_of_three(p[3]);
    }
    if (make != make_pcf && make != make_pcf_smooth && make != make_jittered &&
        make != make_poisson)
        return true;
    if (!is_one_of_three(unit) || !is_one_of_three(taps))
        return false;
    if (make == make_pcf)
        *filter = shb_filter_pcf(p[0], (shb_unit)unit, (shb_taps)taps);
    else if (make == make_pcf_smooth)
        *filter = shb_filter_pcf_smooth(p[0], (shb_unit)unit, (shb_taps)taps);
    else if (make == make_jittered)
        *filter = shb_filter_jittered(p[0], (shb_unit)unit, (shb_taps)taps);
    else
        *filter = shb_filter_poisson(p[0], p[1], (shb_unit)unit, (shb_taps)taps);
    return true;
}

shb_result shb_filter_parse(const char *text, shb_filter *filter) {
    if (!text || !filter)
        return SHB_ERROR_ARGUMENT;
    for (size_t i = 0; i < METHOD_COUNT; i++) {
        if (!shb_text_has_name(text, methods[i].name))
            continue;
        shb_filter read = methods[i].make();
        if (!shb_text_read_params(text, methods[i].param_names, read.params))
            return SHB_ERROR_ARGUMENT;
        if (!rebuild(&read, methods[i].make))
            return SHB_ERROR_ARGUMENT;
        *filter = read;
        return SHB_OK;
    }
    return SHB_ERROR_ARGUMENT;
}
