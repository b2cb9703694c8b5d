#include "method_list.h"

#include <string.h>

/* One map each, with the method's name followed by what it keeps. */
static const struct {
    const char *name;
    shb_occluders occluders;
} exact_maps[] = {
    {"exact-planes", SHB_OCCLUDERS_PLANES},
    {"exact-triangles", SHB_OCCLUDERS_TRIANGLES},
    {"exact-lists", SHB_OCCLUDERS_LISTS},
};

bool method_list_at(size_t index, listed_method *method) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    for (size_t i = 0; i < count; i++) {
        const bool exact = methods[i].make().needs & SHB_NEEDS_OCCLUDERS;
        const size_t maps = exact ? sizeof exact_maps / sizeof *exact_maps : 1;
        if (index < maps) {
            *method = exact ? (listed_method){exact_maps[index].name, &methods[i],
                                              exact_maps[index].occluders}
                            : (listed_method){methods[i].name, &methods[i], SHB_OCCLUDERS_NONE};
            return true;
        }
        index -= maps;
    }
    return false;
}

bool method_list_named(const char *name, listed_method *method) {
    listed_method found;
    for (size_t i = 0; method_list_at(i, &found); i++)
        if (strcmp(found.name, name) == 0) {
            *method = found;
            return true;
        }
    return false;
}
