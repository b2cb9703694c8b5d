/* The loops over batches of fragments, one implementation for each instruction set; all give the
 * same bits. Loops run over the count rounded up to whole vectors. */
#ifndef SRC_KERNELS_SHADE_H
#define SRC_KERNELS_SHADE_H

#include "../pcss.h"
#include "../surface_runs.h"

/* A row of pixels of a frame of this size. */
typedef struct shb_pixel_row {
    uint32_t width, height;
    uint32_t row;
} shb_pixel_row;

typedef struct shb_shade_kernels {
    /* Copies count triples without gaps; the last one fills up the lanes. */
    void (*load)(const float *triples, size_t count, float *x, float *y, float *z);

    /* Positions to texels and depth; and, as needs names them, scales and slopes. Either side's
     * normals do for slopes. */
    void (*project)(const shb_map *map, uint32_t needs, size_t count, shb_receivers *receivers);

    /* SHB_NEEDS_NORMAL: turns the normals to the light's side, replaces unusable ones by the
     * direction to the light, and writes the cosine. */
    void (*normals)(const shb_projection *projection, size_t count, shb_receivers *receivers);

    /* The contract of shb_map_fetch for up to SHB_BATCH texels. */
    void (*fetch)(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                  float *depth);

    /* The contract of shb_filter_hard. */
    void (*hard)(const shb_map *map, size_t count, const shb_receivers *receivers,
                 float *visibility);

    /* Filters of boxes of texels, and of scattered ones. */
    shb_filter_fn *pcf, *pcf_smooth, *jittered, *poisson;
    shb_filter_fn *pcf_exact, *pcf_smooth_exact, *jittered_exact, *poisson_exact;

    /* The contract of shb_filter_pcss, with the taps SHB_TAPS_PLANE or SHB_TAPS_OWN. */
    void (*pcss)(const shb_pcss *pcss, const shb_map *map, size_t count,
                 const shb_receivers *receivers, float *visibility);

    /* The same with exact taps. */
    void (*pcss_exact)(const shb_pcss *pcss, const shb_filter_args *args);

    /* The stages of the built-in methods. */
    void (*own_depth)(size_t count, shb_receivers *receivers);
    shb_bias_fn *constant, *slope, *angle, *receiver_plane, *adaptive, *adaptive_soft;
    shb_bias_fn *normal_offset, *normal_offset_depth, *texel_cone;

    /* Prepares the triangles of runs first .. end - 1, all of one instance, whose positions and
     * normals are written. */
    void (*runs)(const shb_run_view *view, const shb_surface_instance *instance, size_t first,
                 size_t end, shb_surface_runs *runs);

    /* Fragments of pixels whose pixel_x is written; run_of[i] is the run of fragment i, that of the
     * fragment before or the next one; their triangles are prepared. outside[i] is NaN where the
     * pixel's centre lies outside of it: that fragment is not right yet. */
    void (*fragments)(const shb_pixel_row *row, size_t count, const shb_surface_runs *runs,
                      const int32_t *run_of, shb_fragments *fragments, float *outside);

    /* Writes the cosines of light number number, and takes the visibility away from triangles that
     * do not face it. */
    void (*lighting)(const shb_light_source *light, uint32_t number, size_t count,
                     const shb_fragments *fragments, const uint32_t *facing,
                     shb_lighting *lighting);

    /* Linear colours to bytes of an image. */
    void (*display)(size_t count, const float *linear, uint8_t *bytes);
} shb_shade_kernels;

/* Never NULL. */
const shb_shade_kernels *shb_shade_kernels_of(shb_isa isa);

/* Those of the map that asks, or the scalar ones for a host that calls a stage by itself. */
static inline const shb_shade_kernels *shb_stage_kernels(const shb_bias_args *args) {
    return args->kernels ? args->kernels : shb_shade_kernels_of(SHB_ISA_SCALAR);
}

extern const shb_shade_kernels shb_shade_kernels_scalar, shb_shade_kernels_sse2,
    shb_shade_kernels_avx2, shb_shade_kernels_avx512, shb_shade_kernels_neon;

#endif
