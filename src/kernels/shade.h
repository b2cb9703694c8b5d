/* The loops over batches of fragments, one implementation for each instruction set; all give the
 * same bits. Loops run over the count rounded up to whole vectors. */
#ifndef SRC_KERNELS_SHADE_H
#define SRC_KERNELS_SHADE_H

#include "../project.h"

typedef struct shb_shade_kernels {
    /* Copies count triples without gaps; the last one fills up the lanes. */
    void (*load)(const float *triples, size_t count, float *x, float *y, float *z);

    /* Positions to texels and depth; and, as needs names them, scales and slopes. Either side's
     * normals do for slopes. */
    void (*project)(const shb_projection *projection, uint32_t needs, size_t count,
                    shb_receivers *receivers);

    /* SHB_NEEDS_NORMAL: turns the normals to the light's side, replaces unusable ones by the
     * direction to the light, and writes the cosine. */
    void (*normals)(const shb_projection *projection, size_t count, shb_receivers *receivers);

    /* The contract of shb_map_fetch for up to SHB_BATCH texels. */
    void (*fetch)(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                  float *depth);

    /* The contract of shb_filter_hard. */
    void (*hard)(const shb_map *map, size_t count, const shb_receivers *receivers,
                 float *visibility);

    /* The stages of the built-in methods. */
    void (*own_depth)(size_t count, shb_receivers *receivers);
    shb_bias_fn *constant, *slope, *angle, *receiver_plane, *adaptive, *adaptive_soft;
    shb_bias_fn *normal_offset, *normal_offset_depth, *texel_cone;
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
