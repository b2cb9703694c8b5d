#include "methods.h"

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

bool stability_method_at(size_t index, stability_method *method) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    for (size_t i = 0; i < count; i++) {
        const bool exact = methods[i].make().needs & SHB_NEEDS_OCCLUDERS;
        const size_t maps = exact ? sizeof exact_maps / sizeof *exact_maps : 1;
        if (index < maps) {
            *method = exact ? (stability_method){exact_maps[index].name, &methods[i],
                                                 exact_maps[index].occluders}
                            : (stability_method){methods[i].name, &methods[i], SHB_OCCLUDERS_NONE};
            return true;
        }
        index -= maps;
    }
    return false;
}

bool stability_method_named(const char *name, stability_method *method) {
    stability_method found;
    for (size_t i = 0; stability_method_at(i, &found); i++)
        if (strcmp(found.name, name) == 0) {
            *method = found;
            return true;
        }
    return false;
}
