/* Reading the texels of a map, whatever their format, as canonical depth. */
#include "strict.h"

#include "format.h"
#include "map.h"

#define UNORM24_MAX 0xffffff
#define UNORM16_MAX 0xffff

/* Where a texel lies in the map, or the first texel for those outside, so that every lane can load.
 */
static inline size_t texel_offset(const shb_map *map, int32_t x, int32_t y, size_t texel_size) {
    const bool inside = (uint32_t)x < map->info.width && (uint32_t)y < map->info.height;
    return inside ? (size_t)y * map->depth.stride + (size_t)x * texel_size : 0;
}

static void fetch_float32(const shb_map *map, size_t count, const int32_t *texel_x,
                          const int32_t *texel_y, float *depth) {
    const char *texels = map->depth.texels;
    for (size_t i = 0; i < count; i++)
        depth[i] = *(const float *)(texels + texel_offset(map, texel_x[i], texel_y[i], 4));
}

static void fetch_unorm24(const shb_map *map, size_t count, const int32_t *texel_x,
                          const int32_t *texel_y, float *depth) {
    const char *texels = map->depth.texels;
    for (size_t i = 0; i < count; i++) {
        const size_t offset = texel_offset(map, texel_x[i], texel_y[i], 4);
        depth[i] = (float)*(const uint32_t *)(texels + offset) / (float)UNORM24_MAX;
    }
}

static void fetch_unorm16(const shb_map *map, size_t count, const int32_t *texel_x,
                          const int32_t *texel_y, float *depth) {
    const char *texels = map->depth.texels;
    for (size_t i = 0; i < count; i++) {
        const size_t offset = texel_offset(map, texel_x[i], texel_y[i], 2);
        depth[i] = (float)*(const uint16_t *)(texels + offset) / (float)UNORM16_MAX;
    }
}

void shb_map_fetch(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                   float *depth) {
    switch (map->info.format) {
    case SHB_FORMAT_FLOAT32:
        fetch_float32(map, count, texel_x, texel_y, depth);
        break;
    case SHB_FORMAT_UNORM24:
        fetch_unorm24(map, count, texel_x, texel_y, depth);
        break;
    case SHB_FORMAT_UNORM16:
        fetch_unorm16(map, count, texel_x, texel_y, depth);
        break;
    }
    const uint32_t width = map->info.width, height = map->info.height;
    const float far_depth = shb_far_depth(map->info.view.reversed);
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    for (size_t i = 0; i < count; i++) {
        const int inside = ((uint32_t)texel_x[i] < width) & ((uint32_t)texel_y[i] < height);
        depth[i] = inside ? sign * depth[i] : far_depth;
    }
}
