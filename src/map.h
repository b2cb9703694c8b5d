/* The inside of a shadow map. */
#ifndef SRC_MAP_H
#define SRC_MAP_H

#include "context.h"
#include "drawn_plane.h"
#include "joints.h"
#include "light_bounds.h"
#include "light_mesh.h"
#include "quick_planes.h"
#include "sheets.h"

/* What turns a world position into map coordinates, once per map, in double. */
typedef struct shb_projection {
    double row_x[4], row_y[4], row_z[4], row_w[4]; /* rows of clip_from_world */
    bool affine;                                   /* w is 1 everywhere: no division */
    double width, height;                          /* of the map, texels */
    /* The map's depth falls towards the light after multiplication by sign: 1, or -1 when reversed.
     */
    double sign;
    /* The light: a point, or a unit direction towards it when light_w is 0. */
    double light[3], light_w;
    /* For a point with clip w: width of a texel = texel_scale * w, change of canonical depth per
     * world unit away from the light = depth_scale / w^2. */
    double texel_scale, depth_scale;
    double texel_width, texel_height; /* where w is 1; texel_scale is the larger */
    /* Cross products of the first three elements of rows in texels (shb_light_rows), which the
     * slopes of a plane are made of. */
    double x_cross_y[3], x_cross_w[3], y_cross_w[3], z_cross_y[3], z_cross_w[3], x_cross_z[3];
} shb_projection;

/* The rows of the projection scaled to texels, row by row from the top, and canonical depth. */
typedef struct shb_light_rows {
    double x[4], y[4], z[4], w[4];
} shb_light_rows;

/* The instances of a scene, for their triangles' corners in the world. */
typedef struct shb_placed_scene {
    struct shb_placed_instance *instances;
    size_t count;
} shb_placed_scene;

/* What the buffers of a context's occluder_scratch hold: what a map of triangles kept of an earlier
 * drawing, for the next one, and what maps are drawn with. */
enum {
    SHB_OCCLUDER_PLANES,
    SHB_OCCLUDER_WORLD_PLANES,
    SHB_OCCLUDER_TRIANGLES,
    SHB_OCCLUDER_KEPT, /* how many there are of these */
    SHB_OCCLUDER_INSTANCES = SHB_OCCLUDER_KEPT,
    SHB_OCCLUDER_BUFFERS
};
_Static_assert(sizeof((shb_context *)0)->occluder_scratch ==
                   SHB_OCCLUDER_BUFFERS * sizeof(shb_buffer),
               "a buffer of the context for each name");

/* What a map keeps of its occluders. */
typedef struct shb_occluder_data {
    bool held;                  /* by the latest drawing */
    uint32_t *texels;           /* slopes in slope_unit (slopes.h), or a triangle's id */
    size_t stride;              /* bytes */
    double slope_unit;          /* a power of two, at most 2^-27 */
    shb_joints joints;          /* where the map keeps planes */
    shb_quick_planes quick;     /* the same */
    size_t plane_count;         /* triangles of the scene */
    shb_occluder_plane *planes; /* in kept, as world_planes and what mesh points to */
    shb_world_plane *world_planes;
    shb_buffer kept[SHB_OCCLUDER_KEPT];
    shb_topology topology; /* of the latest scene, kept for the next drawing */
    shb_light_mesh mesh;
    shb_sheets sheets;
    shb_sheet_bins bins; /* while a scene is drawn */
} shb_occluder_data;

/* What a filter made of the map's depths; by what, as in shb_filter. */
typedef struct shb_prepared {
    shb_filter filter;
    void *data;
    size_t bytes;
    bool outdated; /* the map was drawn since */
} shb_prepared;

struct shb_map {
    shb_context *context;
    shb_map_info info;
    shb_projection projection;
    shb_light_rows rows;
    shb_light_bounds bounds;
    shb_occluder_data occluders;
    struct shb_lists *lists; /* of the latest drawing, or NULL */
    size_t lists_cap;        /* bytes that they may take; 0: any number */
    shb_prepared prepared[SHB_PREPARED_MAX];
    int prepared_count;
    shb_depth_image depth;
    void *marks; /* where depths and occluders' texels are clear, see shb_clear_marks_size */
    bool owned;  /* texels were allocated by the map */
    bool empty;  /* owned and not drawn yet: serves every method */
    bool classifies;
    bool exact_only; /* lists alone: no depths, no marks */
    bool measures;   /* scene_scale is that of what is drawn */
    /* what the depths are: the method's combine stage and culling */
    shb_combine_fn *combine;
    float combine_params[SHB_PARAMS_MAX];
    const void *combine_user;
    bool flipped;
};

/* True: the latest drawing left occluders, and of this kind. */
static inline bool shb_map_holds(const shb_map *map, shb_occluders occluders) {
    return map->occluders.held && map->info.occluders == occluders;
}

/* Lists know what is certain by themselves. */
static inline bool shb_map_keeps_sheets(const shb_map *map) {
    return map->classifies && map->info.occluders != SHB_OCCLUDERS_LISTS;
}

/* Of the marks of a map that owns its depths. */
size_t shb_map_marks_size(const shb_map *map);

/* Of the depths of a map that owns them, and of their marks. */
size_t shb_map_depth_bytes(const shb_map *map);

/* Makes the map hold what the method draws into it. */
void shb_map_set_method(shb_map *map, const shb_bias *bias);

#endif
