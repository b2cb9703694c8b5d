/* Reading a map's texels, and the hard test. */

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

/* True if 32-bit numbers of texels lead to every texel of a map of floats. */
static bool can_gather(const shb_map *map) {
    return map->info.format == SHB_FORMAT_FLOAT32 &&
           map->depth.stride / 4 <= (size_t)INT32_MAX / map->info.height;
}

/* WIDE texels as they are stored; inside tells which lie in the map, the others mean nothing.
 * gathers: can_gather(map). */
static inline ALWAYS_INLINE vf read_lanes(const shb_map *map, bool gathers, vi x, vi y,
                                          vi *inside) {
    *inside = (vi)((vu)x < map->info.width) & (vi)((vu)y < map->info.height);
    x &= *inside;
    y &= *inside;
    if (gathers)
        return vf_gather(map->depth.texels, y * (int32_t)(map->depth.stride / 4) + x);
    int32_t columns[WIDE], rows[WIDE];
    float stored[WIDE] = {0};
    vi_store(columns, x);
    vi_store(rows, y);
    read_texels(map, WIDE, columns, rows, stored);
    return vf_load(stored);
}

/* Indices of WIDE texels, and -1 where these lie in the map; those of others are 0. */
static inline ALWAYS_INLINE vu index_lanes(const shb_map *map, vi x, vi y, vi *inside) {
    const vu column = (vu)x, row = (vu)y;
    *inside = (vi)(column < map->info.width) & (vi)(row < map->info.height);
    return (vu)*inside & (row * (uint32_t)(map->depth.stride / 4) + column);
}

static void place_texels(const shb_map *map, size_t lanes, const int32_t *restrict texel_x,
                         const int32_t *restrict texel_y, uint32_t *restrict indices,
                         int32_t *restrict inside) {
    for (size_t i = 0; i < lanes; i += WIDE) {
        vi in_map;
        vu_store(indices + i,
                 index_lanes(map, vi_load(texel_x + i), vi_load(texel_y + i), &in_map));
        vi_store(inside + i, in_map);
    }
}

static void read_placed(const shb_map *map, size_t lanes, const uint32_t *indices,
                        const int32_t *inside, float *restrict depth) {
    const bool reversed = map->info.view.reversed;
    const vf far_depth = vf_splat(shb_far_depth(reversed));
    const float sign = reversed ? -1.0f : 1.0f;
    const float *texels = map->depth.texels;
    for (size_t i = 0; i < lanes; i += WIDE)
        vf_store(depth + i,
                 vf_where(vi_load(inside + i), sign * vf_read(texels, indices + i), far_depth));
}

/* Texels are placed before any is read: in one loop there would be too few registers for both. */
static void fetch_gathered(const shb_map *map, size_t lanes, const int32_t *texel_x,
                           const int32_t *texel_y, float *restrict depth) {
    SHB_ALIGN uint32_t indices[SHB_BATCH];
    SHB_ALIGN int32_t inside[SHB_BATCH];
    place_texels(map, lanes, texel_x, texel_y, indices, inside);
    read_placed(map, lanes, indices, inside, depth);
}

static void fetch_others(const shb_map *map, size_t lanes, const int32_t *restrict texel_x,
                         const int32_t *restrict texel_y, float *restrict depth) {
    const bool reversed = map->info.view.reversed;
    const vf far_depth = vf_splat(shb_far_depth(reversed));
    const float sign = reversed ? -1.0f : 1.0f;
    for (size_t i = 0; i < lanes; i += WIDE) {
        vi inside;
        const vf stored =
            read_lanes(map, false, vi_load(texel_x + i), vi_load(texel_y + i), &inside);
        vf_store(depth + i, vf_where(inside, sign * stored, far_depth));
    }
}

static void fetch_whole(const shb_map *map, size_t lanes, const int32_t *texel_x,
                        const int32_t *texel_y, float *depth) {
    if (can_gather(map))
        fetch_gathered(map, lanes, texel_x, texel_y, depth);
    else
        fetch_others(map, lanes, texel_x, texel_y, depth);
}

static void fetch(const shb_map *map, size_t count, const int32_t *texel_x, const int32_t *texel_y,
                  float *depth) {
    const size_t whole = count - count % WIDE;
    fetch_whole(map, whole, texel_x, texel_y, depth);
    if (whole == count)
        return;
    int32_t columns[WIDE] = {0}, rows[WIDE] = {0};
    float depths[WIDE];
    memcpy(columns, texel_x + whole, (count - whole) * sizeof *columns);
    memcpy(rows, texel_y + whole, (count - whole) * sizeof *rows);
    fetch_whole(map, WIDE, columns, rows, depths);
    memcpy(depth + whole, depths, (count - whole) * sizeof *depth);
}

/* A NaN on either side compares as lit. */
static inline ALWAYS_INLINE void test_lanes(const shb_map *map, bool gathers, size_t lanes,
                                            const shb_receivers *restrict receivers,
                                            float *restrict visibility) {
    const bool reversed = map->info.view.reversed;
    const vf far_depth = vf_splat(shb_far_depth(reversed)), one = vf_splat(1.0f);
    const float sign = reversed ? -1.0f : 1.0f;
    for (size_t i = 0; i < lanes; i += WIDE) {
        vi inside;
        const vf stored = sign * read_lanes(map, gathers, vi_load(receivers->texel_x + i),
                                            vi_load(receivers->texel_y + i), &inside);
        const vf nearest = vf_min(far_depth, vf_load(receivers->ref + i));
        vf_store(visibility + i, vf_keep(~(inside & (vi)(stored < nearest)), one));
    }
}

static void hard(const shb_map *map, size_t count, const shb_receivers *receivers,
                 float *visibility) {
    const size_t lanes = shb_round_to_lanes(count);
    if (can_gather(map))
        test_lanes(map, true, lanes, receivers, visibility);
    else
        test_lanes(map, false, lanes, receivers, visibility);
}
