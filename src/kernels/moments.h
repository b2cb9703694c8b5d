/* The loops over moments of distance, one implementation for each instruction set; all give the
 * same bits. */
#ifndef SRC_KERNELS_MOMENTS_H
#define SRC_KERNELS_MOMENTS_H

#include "../light_span.h"
#include "../moment_pyramid.h"

/* Texels of a row that are worked on at once. */
enum { SHB_MOMENT_SPAN = 128, SHB_MOMENT_READ = SHB_MOMENT_SPAN + SHB_MOMENT_SIZE_MAX - 1 };

/* One moment of texels side by side. */
typedef float shb_moment_row[SHB_MOMENT_SPAN];

typedef struct shb_moment_kernels {
    /* Canonical depths to what is averaged of them. */
    void (*warp)(const shb_distance *distance, float exponent, size_t count, float *values);

    /* The moments of size neighbours each. */
    void (*mix_neighbours)(int moments, int size, size_t count, const float *values,
                           shb_moment_row *out);

    /* The moments of size rows together, texel by texel. */
    void (*mix_rows)(int moments, int size, size_t count, const shb_moment_row *const *rows,
                     float *texels);

    /* The moments between the four texels around each fragment. Those of fragments outside the map
     * mean nothing. */
    void (*sample_image)(const shb_moment_image *image, size_t count,
                         const shb_receivers *receivers, shb_moment_batch *out);

    /* The moments of a kernel around each fragment; square_widths lie between the pyramid's least
     * and most. Those of fragments outside the map mean nothing. */
    void (*sample_pyramid)(const shb_moment_pyramid *pyramid, const shb_map_info *info,
                           size_t count, const shb_receivers *receivers, const float *square_widths,
                           shb_moment_batch *out);

    /* Boxes of four texels: of columns + 1 values of a row and of the one below it. */
    void (*join_texels)(int moments, uint32_t columns, const float *row, const float *below,
                        float *boxes);

    /* Row y of a level, from the level before it. */
    void (*join_boxes)(const shb_moment_pyramid *pyramid, int level, uint32_t y);

    /* The windows of fragments: what could stand between them and a light. */
    void (*windows)(const shb_map *map, const shb_light_span *span, size_t count,
                    const shb_receivers *receivers, shb_light_windows *out);

    /* Receivers, taken nearer by the standard deviation of their own planes over kernels of these
     * square widths, texels. */
    void (*receivers)(const shb_distance *distance, size_t count, const shb_receivers *receivers,
                      const float *square_widths, shb_distance_batch *out);

    shb_moment_judge *variance, *exponentials, *moments;
} shb_moment_kernels;

/* Never NULL. */
const shb_moment_kernels *shb_moment_kernels_of(shb_isa isa);

/* Those of the map that is asked. */
static inline const shb_moment_kernels *shb_moment_kernels_in(const shb_filter_args *args) {
    return shb_moment_kernels_of(args->map->context->isa);
}

extern const shb_moment_kernels shb_moment_kernels_scalar, shb_moment_kernels_sse2,
    shb_moment_kernels_avx2, shb_moment_kernels_avx512, shb_moment_kernels_neon;

#endif
