/* The table of all filters, and their text form. */
#include "filter_needs.h"
#include "method_text.h"

#include <string.h>

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

static shb_filter make_variance(void) {
    return shb_filter_variance(5, 0.2f);
}

static shb_filter make_exponential_variance(void) {
    return shb_filter_exponential_variance(5, 80, 10, 0);
}

static shb_filter make_moments(void) {
    return shb_filter_moments(5);
}

static shb_filter make_variance_soft(void) {
    return shb_filter_variance_soft(0.05f, 0.1f);
}

static shb_filter make_exponential_variance_soft(void) {
    return shb_filter_exponential_variance_soft(0.05f, 20, 40, 0);
}

static shb_filter make_moments_soft(void) {
    return shb_filter_moments_soft(0.05f);
}

static shb_filter make_backprojection(void) {
    return shb_filter_backprojection(1, 32);
}

static shb_filter make_bitmask(void) {
    return shb_filter_bitmask(1, 32, 64);
}

static shb_filter make_pcss(void) {
    return shb_filter_pcss(0.05f, 25, 25, SHB_TAPS_PLANE);
}

static const shb_filter_method methods[] = {
    {"hard", "one tap", shb_filter_hard, {NULL}},
    {"pcf", "share of lit texels in a box", make_pcf, {"size", "unit", "taps"}},
    {"pcf-smooth", "the same with soft edges", make_pcf_smooth, {"size", "unit", "taps"}},
    {"jittered", "16 taps, each in a cell of its own", make_jittered, {"size", "unit", "taps"}},
    {"poisson", "taps on a disk", make_poisson, {"count", "radius", "unit", "taps"}},
    {"variance", "bound by mean and variance of distance", make_variance, {"size", "bleeding"}},
    {"exponential-variance",
     "the same for exponentials of distance",
     make_exponential_variance,
     {"size", "positive", "negative", "bleeding"}},
    {"moments", "bound by four moments of distance", make_moments, {"size"}},
    {"variance-soft",
     "variance over kernels as wide as the penumbra",
     make_variance_soft,
     {"light", "bleeding"}},
    {"exponential-variance-soft",
     "exponential-variance over such kernels",
     make_exponential_variance_soft,
     {"light", "positive", "negative", "bleeding"}},
    {"moments-soft", "moments over such kernels", make_moments_soft, {"light"}},
    {"backprojection",
     "sum of what texels cover of a square light",
     make_backprojection,
     {"light", "window"}},
    {"bitmask",
     "samples of a square light that no texel covers",
     make_bitmask,
     {"light", "window", "samples"}},
    {"pcss",
     "kernels as wide as the penumbra of what blocks the light",
     make_pcss,
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

/* The value of a parameter, or 0 without one of this name. */
static float param_of(const shb_filter_method *method, const shb_filter *filter, const char *name) {
    for (int i = 0; i < SHB_PARAMS_MAX && method->param_names[i]; i++)
        if (strcmp(method->param_names[i], name) == 0)
            return filter->params[i];
    return 0;
}

/* Adds what other units and taps than the default ones need. False: an unknown unit or taps. */
static bool add_needs(const shb_filter_method *method, shb_filter *filter) {
    const float unit = param_of(method, filter, "unit"), taps = param_of(method, filter, "taps");
    if (!is_one_of_three(unit) || !is_one_of_three(taps))
        return false;
    filter->needs |= shb_filter_needs_of((shb_unit)unit, (shb_taps)taps);
    return true;
}

shb_result shb_filter_parse(const char *text, shb_filter *filter) {
    if (!text || !filter)
        return SHB_ERROR_ARGUMENT;
    for (size_t i = 0; i < METHOD_COUNT; i++) {
        if (!shb_text_has_name(text, methods[i].name))
            continue;
        shb_filter read = methods[i].make();
        if (!shb_text_read_params(text, methods[i].param_names, read.params) ||
            !add_needs(&methods[i], &read))
            return SHB_ERROR_ARGUMENT;
        *filter = read;
        return SHB_OK;
    }
    return SHB_ERROR_ARGUMENT;
}
