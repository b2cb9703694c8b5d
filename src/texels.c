/* The formats of a map's texels: reading them as canonical depth, writing them from depth. */
#include "strict.h"

#include "map.h"

#include <math.h>

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
    const float far_depth = shb_map_canonical_far(map);
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    for (size_t i = 0; i < count; i++) {
        const int inside = ((uint32_t)texel_x[i] < width) & ((uint32_t)texel_y[i] < height);
        depth[i] = inside ? sign * depth[i] : far_depth;
    }
}

/* depth * steps is exact in double: 24 bits times 24 bits. Away from the light is up, or down when
 * reversed. */
static inline double quantized(float depth, double steps, bool reversed) {
    const double scaled = (double)depth * steps;
    const double whole = reversed ? floor(scaled) : ceil(scaled);
    const double low = whole > 0 ? whole : 0;
    const double limited = low < steps ? low : steps;
    const double far_value = reversed ? 0 : steps;
    return depth == depth ? limited : far_value;
}

void shb_map_store_row(const shb_map *map, uint32_t row, const float *depths) {
    void *texels = (char *)map->depth.texels + row * map->depth.stride;
    const bool reversed = map->info.view.reversed;
    const uint32_t width = map->info.width;
    switch (map->info.format) {
    case SHB_FORMAT_FLOAT32:
        for (uint32_t i = 0; i < width; i++)
            ((float *)texels)[i] = depths[i] == depths[i] ? depths[i] : shb_map_far(map);
        break;
    case SHB_FORMAT_UNORM24:
        for (uint32_t i = 0; i < width; i++)
            ((uint32_t *)texels)[i] = (uint32_t)quantized(depths[i], UNORM24_MAX, reversed);
        break;
    case SHB_FORMAT_UNORM16:
        for (uint32_t i = 0; i < width; i++)
            ((uint16_t *)texels)[i] = (uint16_t)quantized(depths[i], UNORM16_MAX, reversed);
        break;
    }
}
