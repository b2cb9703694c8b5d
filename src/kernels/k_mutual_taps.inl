/* Taps of the exact method, by whatever the map keeps. */

static void mutual_batch_init(const shb_filter_args *args, mutual_batch *batch) {
    const bool affine = args->map->projection.affine;
    batch->map = args->map;
    memcpy(&batch->receivers, args->receivers, offsetof(shb_receivers, cosine));
    project_batch(args->map, (args->filter->needs & SHB_NEEDS_SCALE) | SHB_NEEDS_CENTERS,
                  args->count, NULL, &batch->receivers);
    if (affine)
        find_bounds(true, args->count, batch);
    else
        find_bounds(false, args->count, batch);
}

/* After batch->reach was written. */
static void mutual_batch_finish(mutual_batch *batch, size_t count) {
    write_mutual_planes(batch, count);
    if (batch->map->info.occluders != SHB_OCCLUDERS_TRIANGLES)
        return;
    memset(batch->memo.keys, -1, sizeof batch->memo.keys);
    find_points(batch->map->projection.affine, count, batch);
    find_plain_triangles(batch, count);
}

/* True if 32-bit numbers lead to what the map keeps at every texel. */
static bool can_gather_occluders(const shb_map *map) {
    return map->occluders.stride / sizeof(uint32_t) <= (size_t)INT32_MAX / map->info.height;
}

/* What the map keeps at places inside it, where that can be gathered. */
static inline ALWAYS_INLINE vu gather_kept(const shb_map *map, vi x, vi y) {
    const int32_t stride = (int32_t)(map->occluders.stride / sizeof(uint32_t));
    return (vu)vf_gather((const float *)shb_occluder_row(map, 0), y * stride + x);
}

/* The same everywhere. */
static inline ALWAYS_INLINE vu gather_occluders(const shb_map *map, vi x, vi y) {
    vu texels;
    if (can_gather_occluders(map))
        return gather_kept(map, x, y);
    for (int lane = 0; lane < WIDE; lane++)
        texels[lane] = shb_occluder_row(map, y[lane])[x[lane]];
    return texels;
}

static inline ALWAYS_INLINE vi pass_before(mutual_lanes own, vf to_x, vf to_y, const shb_map *map,
                                           vf stored, vu texels) {
    const float unit = step_unit(map);
    const mutual_way x = mutual_way_of(own.moved_x, to_x, unit);
    const mutual_way y = mutual_way_of(own.moved_y, to_y, unit);
    return passes_in_front(own.z, own.base, &x, &y, stored, texels);
}

/* WIDE taps of fragments first, first + 1, ..., m columns to the right and n rows below the own
 * texels. hits: those inside the map where what it holds, stored, lies in front of the fragment's
 * plane. Returns the taps that are shadowed. */
static NEVER_INLINE vi shadowed_taps(mutual_batch *batch, size_t first, vi hits, vf m, vf n,
                                     vf stored) {
    const shb_receivers *r = &batch->receivers;
    const vi x = vi_load(r->texel_x + first) + __builtin_convertvector(m, vi);
    const vi y = vi_load(r->texel_y + first) + __builtin_convertvector(n, vi);
    const vu texels = gather_occluders(batch->map, x & hits, y & hits);
    const vf to_x = vf_load(r->to_center_x + first) + m, to_y = vf_load(r->to_center_y + first) + n;
    if (batch->map->info.occluders == SHB_OCCLUDERS_TRIANGLES)
        return shadowed_by_triangles(
            batch, first, 1, open_to_triangles(batch, first, 1, hits, texels), texels, to_x, to_y);
    return hits &
           pass_before(mutual_lanes_at(batch, first), to_x, to_y, batch->map, stored, texels);
}

/* The same for WIDE taps in a row of fragment i, from m columns to the right on. */
static NEVER_INLINE vi shadowed_taps_of_one(mutual_batch *batch, size_t i, vi hits, int32_t m,
                                            int32_t n, vf stored) {
    const shb_receivers *r = &batch->receivers;
    const vi columns = vi_numbers() + m;
    const vu texels = gather_occluders(batch->map, (r->texel_x[i] + columns) & hits,
                                       vi_splat(r->texel_y[i] + n) & hits);
    const vf to_x = r->to_center_x[i] + __builtin_convertvector(columns, vf);
    const vf to_y = vf_splat(r->to_center_y[i] + (float)n);
    if (batch->map->info.occluders == SHB_OCCLUDERS_TRIANGLES)
        return shadowed_by_triangles(batch, i, 0, open_to_triangles(batch, i, 0, hits, texels),
                                     texels, to_x, to_y);
    return hits &
           pass_before(mutual_lanes_of_one(batch, i), to_x, to_y, batch->map, stored, texels);
}
