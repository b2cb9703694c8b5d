/* Reading a map's texels, and the hard test. */

#define UNORM24_MAX 16777215.0f
#define UNORM16_MAX 65535.0f

/* Reads the texels as they are stored; those outside the map read its first one. */
#define READ_TEXELS(type)                                                                          \
    for (size_t i = 0; i < count; i++) {                                                           \
        const char *row = texels + (size_t)(uint32_t)y[i] * stride;                                \
        depth[i] = (float)((const type *)(const void *)row)[(uint32_t)x[i]];                       \
    }

static void read_texels(const shb_map *map, size_t count, const int32_t *restrict x,
                        const int32_t *restrict y, float *restrict depth) {
    const char *texels = map->depth.texels;
    const size_t stride = map->depth.stride;
    switch (map->info.format) {
    case SHB_FORMAT_FLOAT32:
        READ_TEXELS(float)
        break;
    case SHB_FORMAT_UNORM24:
        READ_TEXELS(uint32_t)
        for (size_t i = 0; i < count; i++)
            depth[i] = depth[i] / UNORM24_MAX;
        break;
    case SHB_FORMAT_UNORM16:
        READ_TEXELS(uint16_t)
        for (size_t i = 0; i < count; i++)
            depth[i] = depth[i] / UNORM16_MAX;
        break;
    }
}

/* Coordinates that are inside the map, for every lane to read; outside[i] is -1 or 0. */
static void clamp_texels(const shb_map *map, size_t count, const int32_t *restrict texel_x,
                         const int32_t *restrict texel_y, int32_t *restrict x, int32_t *restrict y,
                         int32_t *restrict outside) {
    const uint32_t width = map->info.width, height = map->info.height;
    for (size_t i = 0; i < count; i++) {
        const bool inside = ((uint32_t)texel_x[i] < width) & ((uint32_t)texel_y[i] < height);
        x[i] = inside ? texel_x[i] : 0;
        y[i] = inside ? texel_y[i] : 0;
        outside[i] = inside ? 0 : -1;
    }
}

static void fetch(const shb_map *map, size_t count, const int32_t *restrict texel_x,
                  const int32_t *restrict texel_y, float *restrict depth) {
    SHB_ALIGN int32_t x[SHB_BATCH], y[SHB_BATCH], outside[SHB_BATCH];
    clamp_texels(map, count, texel_x, texel_y, x, y, outside);
    read_texels(map, count, x, y, depth);
    const bool reversed = map->info.view.reversed;
    const float far_depth = shb_far_depth(reversed), sign = reversed ? -1.0f : 1.0f;
    for (size_t i = 0; i < count; i++)
        depth[i] = outside[i] ? far_depth : sign * depth[i];
}

/* A NaN on either side compares as lit. */
static void hard(const shb_map *map, size_t count, const shb_receivers *restrict receivers,
                 float *restrict visibility) {
    const size_t lanes = shb_round_to_lanes(count);
    const float far_depth = shb_far_depth(map->info.view.reversed);
    SHB_ALIGN float stored[SHB_BATCH];
    fetch(map, lanes, receivers->texel_x, receivers->texel_y, stored);
    for (size_t i = 0; i < lanes; i++) {
        const bool shadowed = (stored[i] < receivers->ref[i]) & (stored[i] < far_depth);
        visibility[i] = shadowed ? 0.0f : 1.0f;
    }
}
