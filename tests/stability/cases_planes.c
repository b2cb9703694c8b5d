/* Planes: alone at every slope to the light, close to each other, and hinged. */
#include "cases.h"

#include "shapes.h"

#include <math.h>

/* A level square of half size about the vertical axis. */
static void add_square(owned_mesh *mesh, double half, double height) {
    shape_quad(mesh, (shb_vec3){-half, height, half}, (shb_vec3){half, height, half},
               (shb_vec3){half, height, -half}, (shb_vec3){-half, height, -half});
}

static void build_plane(owned_mesh *seen, owned_mesh *unseen, double unused) {
    (void)unseen, (void)unused;
    add_square(seen, 1, 0);
}

/* value: the gap by the scene's diagonal. */
static void build_gap(owned_mesh *seen, owned_mesh *unseen, double value) {
    add_square(seen, 1, 0);
    add_square(unseen, 0.5, value * sqrt(8));
}

static void build_contact(owned_mesh *seen, owned_mesh *unseen, double value) {
    const double bottom = value * sqrt(8);
    add_square(seen, 1, 0);
    shape_box(unseen, (shb_vec3){-0.3, bottom, -0.3}, (shb_vec3){0.3, bottom + 0.4, 0.3});
}

/* value: the angle of a plate that rises from the ground away from the light, in degrees. */
static void build_wedge(owned_mesh *seen, owned_mesh *unseen, double value) {
    const double angle = value * 3.14159265358979323846 / 180;
    const double x = -0.8 * cos(angle), y = 0.8 * sin(angle);
    add_square(seen, 1, 0);
    shape_quad(unseen, (shb_vec3){0, 0, 0.7}, (shb_vec3){0, 0, -0.7}, (shb_vec3){x, y, -0.7},
               (shb_vec3){x, y, 0.7});
}

#define PLANE(slope, is_quick)                                                                     \
    {                                                                                              \
        .group = "slope", .name = "plane-" #slope, .build = build_plane, .sun_height = 90 - slope, \
        .quick = is_quick                                                                          \
    }
#define SLOPE(slope, is_quick)                                                                     \
    {                                                                                              \
        .group = "slope", .name = "blocks-" #slope, .build = stability_build_blocks,               \
        .sun_height = 90 - slope, .closed = true, .quick = is_quick                                \
    }
#define GAP(gap, is_quick)                                                                         \
    {                                                                                              \
        .group = "gap", .name = "gap-" #gap, .build = build_gap, .value = gap, .aligned = true,    \
        .quick = is_quick                                                                          \
    }
#define CONTACT(gap, is_quick)                                                                     \
    {                                                                                              \
        .group = "contact", .name = "contact-" #gap, .build = build_contact, .value = gap,         \
        .aligned = true, .quick = is_quick                                                         \
    }
#define WEDGE(angle, is_quick)                                                                     \
    {                                                                                              \
        .group = "wedge", .name = "wedge-" #angle, .build = build_wedge, .value = angle,           \
        .aligned = true, .quick = is_quick                                                         \
    }

static const stability_case cases[] = {
    PLANE(0, false),      PLANE(15, false),    PLANE(30, false),     PLANE(45, true),
    PLANE(60, false),     PLANE(75, true),     PLANE(85, false),     PLANE(88, true),
    SLOPE(0, false),      SLOPE(30, false),    SLOPE(60, false),     SLOPE(80, true),
    SLOPE(89, false),     SLOPE(89.9, false),  SLOPE(89.99, true),   GAP(0, false),
    GAP(1e-7, true),      GAP(1e-6, false),    GAP(1e-5, false),     GAP(1e-4, true),
    GAP(1e-3, false),     GAP(1e-2, true),     GAP(1e-1, false),     CONTACT(0, true),
    CONTACT(1e-7, false), CONTACT(1e-6, true), CONTACT(1e-5, false), CONTACT(1e-4, true),
    CONTACT(1e-3, false), CONTACT(1e-2, true), CONTACT(1e-1, false), WEDGE(0.01, true),
    WEDGE(0.1, false),    WEDGE(1, true),      WEDGE(5, false),      WEDGE(20, true),
    WEDGE(60, false),     WEDGE(90, true),
};

stability_cases stability_plane_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
