/* The table of all filters, and their text form. */
#include "shadowbias/filter.h"
#include "method_text.h"

static const shb_filter_method methods[] = {
    {"hard", "one tap", shb_filter_hard, {NULL}},
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
