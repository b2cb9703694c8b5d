#include "cases.h"

#include <string.h>

static stability_cases (*const parts[])(void) = {
    stability_plane_cases, stability_view_cases,    stability_texel_cases,
    stability_shape_cases, stability_surface_cases, stability_mesh_cases,
};

const stability_case *stability_case_at(size_t index) {
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const stability_cases part = parts[i]();
        if (index < part.count)
            return &part.cases[index];
        index -= part.count;
    }
    return NULL;
}

const char *stability_mean_name(stability_mean mean) {
    return mean == STABILITY_RESOLVED ? "RESOLVED" : "ALL";
}

bool stability_mean_has(stability_mean mean, const stability_case *c) {
    return mean == STABILITY_ALL ||
           (strcmp(c->group, "gap") != 0 && strcmp(c->group, "moved") != 0 &&
            strcmp(c->group, "near-far") != 0);
}

const stability_case *stability_case_named(const char *name) {
    const stability_case *found;
    for (size_t i = 0; (found = stability_case_at(i)) != NULL; i++)
        if (strcmp(found->name, name) == 0)
            return found;
    return NULL;
}
