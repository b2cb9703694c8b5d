/* The table of all filters, and their text form. */
#include "shadowbias/filter.h"
#include "method_text.h"

static shb_filter variance(void) {
    return shb_filter_variance(5, 0.2f);
}

static shb_filter exponential_variance(void) {
    return shb_filter_exponential_variance(5, 80, 10, 0);
}

static shb_filter moments(void) {
    return shb_filter_moments(5);
}

static const shb_filter_method methods[] = {
    {"hard", "one tap", shb_filter_hard, {NULL}},
    {"variance", "bound by mean and variance of distance", variance, {"size", "bleeding"}},
    {"exponential-variance",
     "the same for exponentials of distance",
     exponential_variance,
     {"size", "positive", "negative", "bleeding"}},
    {"moments", "bound by four moments of distance", moments, {"size"}},
};

enum { METHOD_COUNT = sizeof methods / sizeof *methods };

const shb_filter_method *shb_filter_methods(size_t *count) {
    if (count)
        *count = METHOD_COUNT;
    return methods;
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
        *filter = read;
        return SHB_OK;
    }
    return SHB_ERROR_ARGUMENT;
}
