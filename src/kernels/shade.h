/* The loops over batches of fragments, one implementation for each instruction set; all give the
 * same bits. Loops run over the count rounded up to whole vectors. */
#ifndef SRC_KERNELS_SHADE_H
#define SRC_KERNELS_SHADE_H

#include "../exact_triangles.h"
#include "../format.h"
#include "../next_batch.h"
#include "../pcss.h"
#include "../quick_test.h"
#include "../surface_table.h"

enum { SHB_DISPLAY_MARGIN = 13 };

/* Beside the public SHB_NEEDS_*: fills to_center_*. */
#define SHB_NEEDS_CENTERS 0x80000000u

typedef struct shb_shade_kernels {
    /* Copies count triples without gaps; the last one fills up the lanes. */
    void (*load)(const float *triples, size_t count, float *x, float *y, float *z);

    /* Positions to texels and depth; and, as needs names them, ways to centres, scales and, not
     * without centres, slopes. Either side's normals do for slopes. next: what is asked for
     * meanwhile, or NULL. */
    void (*project)(const shb_map *map, uint32_t needs, size_t count, const shb_next_batch *next,
                    shb_receivers *receivers);

    /* SHB_NEEDS_NORMAL: turns the normals to the light's side, replaces unusable ones by the
     * direction to the light, and writes the cosine. */
    void (*normals)(const shb_projection *projection, size_t count, shb_receivers *receivers);

    /* The contract of shb_map_fetch for up to SHB_BATCH texels. */
    void (*fetch)(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                  float *depth);

    /* What layers and maps write their depths with. */
    shb_format_store_fn *store;

    /* The contract of shb_filter_hard. */
    void (*hard)(const shb_map *map, size_t count, const shb_receivers *receivers,
                 float *visibility);

    /* The exact method by the planes that a map keeps. Packed points are a whole batch. */
    void (*planes)(const shb_map *map, size_t count, const shb_quick_points *points,
                   float *visibility);

    /* Places points on their triangles, which are named up to whole vectors, by weights of the
     * second and third corner. False: there is no such triangle, or a point is far from where it
     * should be. */
    bool (*place)(const shb_drawn_mesh *mesh, const float *weight_1, const float *weight_2,
                  const shb_receivers *receivers, shb_exact_points *points);

    /* Finds where the light sees the points of a group, reads the samples around them and finds
     * what those of their own texels tell. rounding: of positions, as in light_point.h. */
    void (*nearest)(const shb_map *map, double rounding, shb_walk_group *group);

    /* Goes the ways from all samples of points as far as their sheets lead towards the points. */
    void (*ways)(const shb_map *map, double rounding, shb_way_points *points);

    /* Makes the walks of a crowd as far as they go; it is empty then. */
    void (*walk)(const shb_map *map, double rounding, const shb_exact_points *points,
                 shb_walk_crowd *crowd);

    /* The hard test after projection and bias where float is sure of it: writes the visibility of
     * all fragments, and the numbers of those whose is not to be trusted; returns how many these
     * are, SIZE_MAX if it is not made for the map or sees nothing to be sure of. test: of the batch
     * before, or not known; what serves this batch is left there. NULL: none. */
    size_t (*quick)(const shb_map *map, const shb_quick_bias *bias, size_t count,
                    const shb_quick_points *points, shb_quick_test *test, float *visibility,
                    uint16_t *doubtful);

    /* Planes of count triangles, rounded up to whole vectors; transform: of their corners to the
     * world, or NULL. */
    void (*find_planes)(const shb_map *map, const shb_mat4 *transform, size_t count,
                        const shb_plane_corners *corners, shb_found_planes *planes);

    /* The same, and these planes in the world. */
    void (*find_world_planes)(const shb_map *map, const shb_mat4 *transform, size_t count,
                              const shb_plane_corners *corners, shb_found_planes *planes,
                              shb_found_world_planes *world_planes);

    /* Filters of boxes of texels, and of scattered ones. */
    shb_filter_fn *pcf, *pcf_smooth, *jittered, *poisson;
    shb_filter_fn *pcf_exact, *pcf_smooth_exact, *jittered_exact, *poisson_exact;

    /* The contract of shb_filter_pcss, with the taps SHB_TAPS_PLANE or SHB_TAPS_OWN. */
    void (*pcss)(const shb_pcss *pcss, const shb_map *map, size_t count,
                 const shb_receivers *receivers, float *visibility);

    /* The same with exact taps. */
    void (*pcss_exact)(const shb_pcss *pcss, const shb_filter_args *args);

    /* Bounds of count cells of a pyramid next to each other, each of a square of texels whose
     * canonical depths lie in rows that are pitch apart; there are depths for whole vectors. */
    void (*bound_cells)(const float *depths, size_t pitch, float far_depth, size_t count,
                        shb_pyramid_cell *cells);

    /* A row of a level, of every such cell in rows and columns of another one and the next ones to
     * its right and below; size: theirs. */
    void (*join_cells)(const shb_pyramid_level *from, uint32_t every, float size, uint32_t row,
                       const shb_pyramid_level *made);

    /* The stages of the built-in methods. */
    void (*own_depth)(size_t count, shb_receivers *receivers);
    shb_bias_fn *constant, *slope, *angle, *receiver_plane, *adaptive, *adaptive_soft;
    shb_bias_fn *normal_offset, *normal_offset_depth, *texel_cone;

    /* Takes the covered pixels of a span, at most SHB_SPAN, into a batch that has room for them:
     * writes their ids, and where the table has or shall have their triangles. */
    void (*take)(const uint32_t *ids, const shb_piece *span, shb_surface_table *table,
                 shb_fragment_batch *batch);

    /* Prepares count triangles of one instance, whose corners are read. */
    void (*triangles)(const shb_surface_view *view, const shb_surface_instance *instance,
                      size_t count, const shb_surface_corners *corners,
                      shb_prepared_triangle *triangles);

    /* Fragments whose places, centres and triangles are there: all but ids and pixels. Those
     * outside are not right yet. */
    void (*fragments)(const shb_surface_table *table, shb_fragment_batch *batch);

    /* Rounding may leave a point just beyond an edge, in the shadow of a neighbour that rises
     * there: the smaller weight becomes what the larger one leaves, which is exact from 1/2 on. */
    void (*keep_within)(size_t count, float *weight_1, float *weight_2);

    /* Writes the cosines of light number number, and takes the visibility away from triangles that
     * do not face it. */
    void (*lighting)(const shb_light_source *light, uint32_t number, size_t count,
                     const shb_fragments *fragments, const uint32_t *facing,
                     shb_lighting *lighting);

    /* Linear colours of at most SHB_BATCH pixels, rounded up to whole vectors, to the bytes of an
     * image, three a pixel; may write SHB_DISPLAY_MARGIN more. */
    void (*display)(size_t count, const float *red, const float *green, const float *blue,
                    uint8_t *bytes);

    /* The contract of the callback. */
    shb_shade_fn *lambert;
} shb_shade_kernels;

/* Never NULL. */
const shb_shade_kernels *shb_shade_kernels_of(shb_isa isa);

/* Those of the map or the frame that asks, or the scalar ones for a host that calls a stage or a
 * callback by itself. */
static inline const shb_shade_kernels *shb_stage_kernels(const shb_shade_kernels *kernels) {
    return kernels ? kernels : shb_shade_kernels_of(SHB_ISA_SCALAR);
}

extern const shb_shade_kernels shb_shade_kernels_scalar, shb_shade_kernels_sse2,
    shb_shade_kernels_avx2, shb_shade_kernels_avx512, shb_shade_kernels_neon;

#endif
