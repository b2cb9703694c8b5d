/* The cases of the stability suite: what is drawn, how it is lit and what the map is like.
 *
 * A builder works in units of its own, about 2 across with y up. The scene is then turned about an
 * odd axis, so that no rounding vanishes by chance, scaled and moved. */
#ifndef STABILITY_CASES_H
#define STABILITY_CASES_H

#include "owned_mesh.h"

#include "shadowbias/raster.h"

enum { STABILITY_MAP_SIZE = 1024 };

/* The width of a texel of a map of standard size over the builder's ground, in its units. */
#define STABILITY_TEXEL (2.9 / STABILITY_MAP_SIZE)

typedef struct stability_case {
    const char *group, *name;
    /* Fills the meshes. The camera looks through what is unseen; it casts shadows all the same. */
    void (*build)(owned_mesh *seen, owned_mesh *unseen, double value);
    double value;
    const char *file;     /* a mesh in place of a builder; without the file there is no case */
    double scale;         /* world units a unit of the builder; 0: 1 */
    double moved;         /* world units from the origin */
    double sun_height;    /* of the light above the ground in degrees; 0: 50 */
    double spot_distance; /* from the middle, in diagonals of the scene; 0: a directional light */
    double far_to_near;   /* ratio of the spot light's distances; 0: as close as they fit */
    uint32_t map_size;    /* 0: STABILITY_MAP_SIZE */
    shb_format format;
    bool reversed;
    bool aligned; /* not turned, where rounding would spoil what the case is about */
    bool closed;  /* solids: back faces are culled */
    bool quick;   /* one of the few of a quick run */
} stability_case;

/* What means are taken over. */
typedef enum stability_mean {
    STABILITY_RESOLVED = 0, /* without the groups gap, moved and near-far, whose gaps, positions or
                               depths are finer than floats can tell */
    STABILITY_ALL,
    STABILITY_MEANS
} stability_mean;

/* Its name as a case and a group of tables. */
const char *stability_mean_name(stability_mean mean);
bool stability_mean_has(stability_mean mean, const stability_case *c);

/* A part of the suite. */
typedef struct stability_cases {
    const stability_case *cases;
    size_t count;
} stability_cases;

stability_cases stability_plane_cases(void);
stability_cases stability_view_cases(void);
stability_cases stability_texel_cases(void);
stability_cases stability_shape_cases(void);
stability_cases stability_surface_cases(void);
stability_cases stability_mesh_cases(void);

/* All cases are numbered through the parts in the order above; NULL behind the last one. */
const stability_case *stability_case_at(size_t index);

/* NULL if there is none of that name. */
const stability_case *stability_case_named(const char *name);

/* Boxes and a ball on a slab, all closed: the scene of cases that are about something else. */
void stability_build_blocks(owned_mesh *seen, owned_mesh *unseen, double unused);

#endif
