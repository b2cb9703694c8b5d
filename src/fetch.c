/* Reading the texels of a map, whatever their format, as canonical depth. */
#include "strict.h"

#include "kernels/shade.h"

void shb_map_fetch(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                   float *depth) {
    const shb_shade_kernels *kernels = map->context->shade_kernels;
    if (map->exact_only) {
        for (size_t i = 0; i < count; i++)
            depth[i] = shb_far_depth(map->info.view.reversed);
        return;
    }
    for (size_t first = 0; first < count; first += SHB_BATCH) {
        const size_t left = count - first;
        kernels->fetch(map, left < SHB_BATCH ? left : SHB_BATCH, texel_x + first, texel_y + first,
                       depth + first);
    }
}
