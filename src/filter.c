/* Filters by their text form. */
#include "shadowbias/filter.h"
#include "method_text.h"

typedef struct filter_method {
    const char *name;
    shb_filter (*make)(void);
    const char *param_names[SHB_PARAMS_MAX];
} filter_method;

static const filter_method filters[] = {
    {"hard", shb_filter_hard, {NULL}},
};

shb_result shb_filter_parse(const char *text, shb_filter *filter) {
    if (!text || !filter)
        return SHB_ERROR_ARGUMENT;
    for (size_t i = 0; i < sizeof filters / sizeof *filters; i++) {
        if (!shb_text_has_name(text, filters[i].name))
            continue;
        shb_filter read = filters[i].make();
        if (!shb_text_read_params(text, filters[i].param_names, read.params))
            return SHB_ERROR_ARGUMENT;
        *filter = read;
        return SHB_OK;
    }
    return SHB_ERROR_ARGUMENT;
}
