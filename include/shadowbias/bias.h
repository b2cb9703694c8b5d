/* Bias methods: each turns a fragment into a receiver plane.
 *
 * The receiver plane is the depth that the map holds, texel by texel, if nothing stands between the
 * light and the fragment: ref + m * step_x + n * step_y at the texel m columns right of and n rows
 * below the fragment's own, with the epsilon already subtracted. A filter compares it with the map.
 * Any method goes with any filter.
 *
 * Depth is canonical here: smaller is nearer to the light, 0 .. 1 from near to far in a standard
 * map, -1 .. 0 in a reversed one (the stored depth negated). No method needs to know which it is.
 *
 * A method is a plain value. It has up to three stages, each a function that may be NULL:
 *   offset   before projection: moves the points
 *   depth    after projection: writes ref, step_x, step_y; NULL: ref is the own depth, no steps
 *   combine  when the map is drawn: what it keeps of the two nearest layers; NULL: the nearest
 *
 * Outcomes where the papers are silent:
 * - fragment outside the map, behind the light, or not finite: lit (visibility 1)
 * - fragment beyond the far plane: tested as if it lay on the far plane, so empty texels light it
 * - no normal (zero or not finite): the light's direction takes its place, so the receiver faces
 *   the light and its slopes are 0
 * - plane parallel to the light ray: slopes are limited to 1 map depth per texel; 0 if undefined
 * - parameters are not checked: whatever they are, visibility stays in 0 .. 1 */
#ifndef SHADOWBIAS_BIAS_H
#define SHADOWBIAS_BIAS_H

#include "shadowbias/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct shb_bias shb_bias;

/* What a map keeps of its occluders beside their depth, for the exact method. */
typedef enum shb_occluders {
    SHB_OCCLUDERS_NONE = 0,
    SHB_OCCLUDERS_PLANES,    /* the plane of each texel's triangle: 4.5 more bytes a
                                texel */
    SHB_OCCLUDERS_TRIANGLES, /* the triangle of each texel, and the mesh in the light's space: 4
                                more bytes a texel and about 160 a triangle */
    SHB_OCCLUDERS_LISTS      /* all triangles that the light can see in each texel, or in larger
                                cells where these are few: 8 bytes an entry, in all about 100 a
                                triangle with its share of vertices and cells */
} shb_occluders;

/* What a map tells the methods and tools. Lengths in world units. */
typedef struct shb_map_info {
    shb_view view;
    shb_light_source light;
    uint32_t width, height;
    shb_format format;
    double scene_scale;  /* diagonal of the box of what was drawn, or as given in the description */
    size_t memory_bytes; /* texels and their padding (a wrapped map's, too), what is kept of
                            occluders, shared or not, and to classify, and what filters prepared */
    double draw_seconds; /* duration of the latest drawing, occluders included; 0: none yet */
    shb_occluders occluders;
} shb_map_info;

/* Both texel coordinates of a fragment that is behind the light or not finite. Those of all others
 * are clamped to -2^30 .. 2^30. */
#define SHB_TEXEL_NONE (-(1 << 30))

/* A batch of fragments as one light sees them: a structure of arrays, one element a fragment. From
 * the count up to the next multiple of 16 the arrays repeat the last fragment, so that loops may
 * run over whole vectors. A stage may read what the method's needs name and what earlier stages
 * wrote. Where texel_x is SHB_TEXEL_NONE, depth, scales and slopes are finite but meaningless. */
typedef struct shb_receivers {
    /* the fragment; the offset stage may move it */
    SHB_ALIGN float x[SHB_BATCH]; /* world position */
    float y[SHB_BATCH];
    float z[SHB_BATCH];
    /* SHB_NEEDS_NORMAL: unit geometric normal, turned to the light's side of the surface */
    float normal_x[SHB_BATCH];
    float normal_y[SHB_BATCH];
    float normal_z[SHB_BATCH];
    float cosine[SHB_BATCH]; /* of the angle between normal and light direction, 0 .. 1 */
    /* SHB_NEEDS_SCALE */
    float texel_size[SHB_BATCH];      /* longer side of a texel at the fragment, world units */
    float depth_per_world[SHB_BATCH]; /* change of map depth per world unit along the light's axis,
                                         away from the light, > 0 */
    /* the projection of the (moved) point; written before the depth stage */
    int32_t texel_x[SHB_BATCH]; /* the texel that holds the point; may lie outside the map */
    int32_t texel_y[SHB_BATCH];
    float to_center_x[SHB_BATCH]; /* from the point to that texel's centre, -0.5 .. 0.5 texels */
    float to_center_y[SHB_BATCH];
    float depth[SHB_BATCH]; /* canonical map depth of the point */
    /* SHB_NEEDS_SLOPE: of the plane through the point before it moved, canonical depth per texel */
    float slope_x[SHB_BATCH];
    float slope_y[SHB_BATCH];
    /* the receiver plane: written by the depth stage */
    float ref[SHB_BATCH];    /* at the centre of the fragment's own texel */
    float step_x[SHB_BATCH]; /* per texel to the right */
    float step_y[SHB_BATCH]; /* per texel down */
} shb_receivers;

typedef struct shb_bias_args {
    size_t count; /* 1 .. SHB_BATCH */
    const shb_bias *bias;
    const shb_map_info *map;
    shb_receivers *receivers;
    const struct shb_shade_kernels *kernels; /* the library's own; NULL when a host calls a stage */
} shb_bias_args;

/* A stage works on the whole batch; it must be thread-safe and may not fail. */
typedef void shb_bias_fn(const shb_bias_args *args);

/* Combines two layers into the depth that the map keeps, for count texels of a row: nearest[i] and
 * second[i] are canonical; absent layers hold the far depth. combined may be nearest. Like a stage,
 * it must be thread-safe and may not fail. */
typedef void shb_combine_fn(const shb_bias *bias, size_t count, const float *nearest,
                            const float *second, float *combined);

enum {
    SHB_NEEDS_NORMAL = 1,    /* the points must come with normals; fills normal_*, cosine */
    SHB_NEEDS_SCALE = 2,     /* fills texel_size, depth_per_world */
    SHB_NEEDS_SLOPE = 4,     /* the points must come with normals; fills slope_* */
    SHB_NEEDS_FLIPPED = 8,   /* the map is drawn with flip_culling */
    SHB_NEEDS_OCCLUDERS = 16 /* the map answers from the occluders it keeps: no stage is called, the
                                filter must have its function exact, and the points must come with
                                normals unless the map keeps lists */
};

struct shb_bias {
    const char *name;
    shb_bias_fn *offset;
    shb_bias_fn *depth;
    shb_combine_fn *combine;
    uint32_t needs; /* SHB_NEEDS_* */
    float params[SHB_PARAMS_MAX];
    const void *user; /* for methods of your own; must outlive the use of the value */
};

/* The unit of a constant bias. */
typedef enum shb_unit {
    SHB_UNIT_DEPTH = 0, /* of the map, whose range is 1 */
    SHB_UNIT_TEXEL,     /* width of a texel at the fragment, towards the light */
    SHB_UNIT_WORLD      /* world units towards the light */
} shb_unit;

/* "none": ref = depth. */
shb_bias shb_bias_none(void);

/* "constant": ref = depth - amount (Williams 1978). An unknown unit counts as SHB_UNIT_DEPTH.
 * Default (here and below: of tools): 0.002, SHB_UNIT_DEPTH. */
shb_bias shb_bias_constant(float amount, shb_unit unit);

/* "slope": ref = depth - min(factor * max(|slope_x|, |slope_y|) + units * 2^-24, clamp): the
 * polygon offset of OpenGL and Direct3D, applied to the receiver instead of the occluder (King
 * 2004). clamp in map depth; 0: none. Default: factor 1.1, units 4, no clamp. */
shb_bias shb_bias_slope(float factor, float units, float clamp);

/* "angle": ref = depth - depth_per_world * min(base / cosine, limit), base and limit as fractions
 * of scene_scale (Gautron, Marvie and Briand, EP 2411967, claims 1 to 3). Default: 0.001, 0.01. */
shb_bias shb_bias_angle(float base, float limit);

/* "normal-offset": the point moves texels * texel_size * sin(theta) along its normal, theta being
 * the angle between normal and light (Holbert 2011); then ref = its depth - depth, in map depth.
 * Default: 1.5, 1e-5. */
shb_bias shb_bias_normal_offset(float texels, float depth);

/* "receiver-plane": ref = plane at the texel's centre - epsilon, steps = slopes (Isidoro 2006, with
 * the exact plane instead of screen-space derivatives). epsilon in map depth. Default: 1e-5. */
shb_bias shb_bias_receiver_plane(float epsilon);

/* "texel-cone": the point moves radius * (1.16 * sin(theta) + 0.195) along its normal, radius being
 * half the diagonal of a texel at the fragment, taken for square (shadow_normal_offset of Blender's
 * EEVEE). No parameter. */
shb_bias shb_bias_texel_cone(void);

/* "midpoint": the map keeps the mean of its two nearest layers (Woo 1992); ref = depth. */
shb_bias shb_bias_midpoint(void);

/* "dual-layer": the map keeps z1 + min((z2 - z1) / 2, offset) of its two nearest layers z1 and z2
 * (Weiskopf and Ertl 2003, eq. 2); ref = depth. offset in map depth. Default: 0.01. */
shb_bias shb_bias_dual_layer(float offset);

/* "back-face": the map is drawn from the faces that would be culled (Wang and Molnar 1994); ref =
 * depth. Instances that cull nothing are drawn as they are. */
shb_bias shb_bias_back_face(void);

/* "adaptive": ref = plane at the texel's centre - depth_per_world * scene_scale * k, steps = slopes
 * (Dou et al. 2014, section 2.1 and eq. 10, whose fraction is the derivative of depth by distance,
 * depth_per_world, taken at the fragment). scene_scale in world units; 0: that of the map. Default:
 * k 1e-4, scene_scale 0. */
shb_bias shb_bias_adaptive(float k, float scene_scale);

/* "adaptive-soft": the same with the epsilon times min(1 / cosine^2, threshold) (Ehm et al. 2015,
 * eq. 3 and 4). Default: k 1e-4, scene_scale 0, threshold 100. */
shb_bias shb_bias_adaptive_soft(float k, float scene_scale, float threshold);

/* "exact": asks the occluders themselves, as far as the map keeps them (shb_map_desc.occluders). No
 * parameter, no scene scale: every tolerance is a bound of rounding. Each coordinate of a position
 * must lie within half a unit in the last place of the surface, each element of a normal within
 * 2^-22 of the triangle's.
 * - Planes: shadowed if the texel's sample lies in front of the fragment's plane, and the sample's
 *   own plane in front of the fragment; the filter hard leaves facets finer than texels lit. Right
 *   on both sides of a crease and on convex bodies; shadows end at texel borders.
 * - Triangles: walks over the mesh, from the triangles of the four nearest samples to the one that
 *   covers the fragment's own light ray, which decides; where the mesh ends or folds over on the
 *   way, as with planes. Edges are straight inside a texel, and closed meshes have no false shadow
 *   but where rounding of a position has moved its ray over an edge in grazing light: for 6 of 9
 *   million points of random bodies, and none of 19 million named by triangle and weights.
 * - Lists: the answer of a ray caster, at any map size, from the position alone.
 * In the taps of a filter, an occluder that is the fragment's own surface, bent between fragment
 * and tap, casts no shadow: triangles follow the surface over the mesh; planes do over neighbouring
 * texels whose planes meet, in boxes of pcf and pcf-smooth, around taps of jittered and poisson up
 * to 63 texels wide, and in pcss up to 15 texels to each side of the fragment's own one.
 * A triangle casts a shadow, whatever its culling, where it lies at or beyond the near plane; there
 * is no far plane. */
shb_bias shb_bias_exact(void);

/* A built-in method, for tools: its default value and the names of its parameters. */
typedef struct shb_bias_method {
    const char *name;
    const char *summary;
    shb_bias (*make)(void);                  /* with default parameters */
    const char *param_names[SHB_PARAMS_MAX]; /* in the order of shb_bias.params; NULL: none */
} shb_bias_method;

/* All built-in methods in the order above; never fails. count may be NULL. */
const shb_bias_method *shb_bias_methods(size_t *count);

/* The method that a text names: "name" or "name:param=value,param=value", with decimal numbers and
 * the point '.' in every locale; of a repeated parameter the last counts, of one left out the
 * default. SHB_ERROR_ARGUMENT for NULL, an unknown name or parameter, a unit that is not 0, 1 or 2,
 * or a number that is not finite. */
shb_result shb_bias_parse(const char *text, shb_bias *bias);

#ifdef __cplusplus
}
#endif

#endif
