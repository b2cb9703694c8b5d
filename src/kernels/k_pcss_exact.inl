/* Percentage-closer soft shadows by the exact method: in both stages every tap is asked for the
 * plane of its own occluder, too. Few fragments are: those with nothing in front of their own plane
 * are lit. */

typedef struct exact_taps {
    const shb_map *map;
    const shb_receivers *receivers;
    const mutual_fragment *fragment;
    size_t index;
    float far_depth;
} exact_taps;

static bool is_blocked_exactly(const void *state, int32_t m, int32_t n, float *depth) {
    const exact_taps *taps = state;
    const shb_receivers *r = taps->receivers;
    const size_t i = taps->index;
    const int32_t x = r->texel_x[i] + m, y = r->texel_y[i] + n;
    read_texels(taps->map, 1, &x, &y, depth);
    if (taps->map->info.view.reversed)
        *depth = -*depth;
    const float plane = shb_tap_depth(r->ref[i], r->step_x[i], r->step_y[i], (float)m, (float)n);
    const bool in_front = *depth < plane || taps->map->info.occluders != SHB_OCCLUDERS_PLANES;
    return in_front && *depth < taps->far_depth &&
           *depth < mutual_tap(taps->map, taps->fragment, x, y, *depth, plane);
}

/* The planes of fragments for the reach of their searches. */
static void write_search_planes(const shb_pcss *pcss, size_t lanes, mutual_batch *batch) {
    shb_receivers *r = &batch->receivers;
    for (size_t i = 0; i < lanes; i++) {
        const float depth = r->depth[i] < pcss->far_depth ? r->depth[i] : pcss->far_depth;
        const float x = shb_pcss_radius(pcss->texels_x, depth, pcss->near_depth);
        const float y = shb_pcss_radius(pcss->texels_y, depth, pcss->near_depth);
        write_mutual_plane(&batch->fragments[i], (double)(x > y ? x : y) * 1.5 + 2, r, i);
    }
}

/* Fragments whose search meets something in front of their planes. */
static void find_searched(const shb_pcss *pcss, const shb_map *map, size_t lanes,
                          const shb_receivers *receivers, int32_t *searched) {
    const vf near_depth = vf_splat(pcss->near_depth);
    for (size_t i = 0; i < lanes; i += WIDE) {
        const pcss_lanes own = load_pcss_lanes(pcss, receivers, i);
        const vf radius_x = radius_lanes(pcss->texels_x, own.depth, near_depth);
        const vf radius_y = radius_lanes(pcss->texels_y, own.depth, near_depth);
        vi open = ((vu)own.texel_x < map->info.width) & ((vu)own.texel_y < map->info.height);
        if (pcss->pyramid)
            open &= ~ask_pyramid(pcss, map, &own, radius_x, radius_y, open).lit;
        if (vi_any(open))
            open &= search(pcss, map, &own, radius_x, radius_y, open).weight > 0;
        vi_store(searched + i, open);
    }
}

/* The depths of a map that keeps triangles are not those of their planes: there all are asked. */
static void pcss_exact(const shb_pcss *pcss, const shb_filter_args *args) {
    const shb_map *map = args->map;
    const size_t lanes = shb_round_to_lanes(args->count);
    SHB_ALIGN int32_t searched[SHB_BATCH];
    mutual_batch batch;
    mutual_batch_init(args, &batch);
    write_search_planes(pcss, lanes, &batch);
    const shb_receivers *r = &batch.receivers;
    memset(searched, -1, sizeof searched);
    if (map->info.occluders == SHB_OCCLUDERS_PLANES)
        find_searched(pcss, map, lanes, r, searched);
    for (size_t i = 0; i < args->count; i++) {
        const exact_taps taps = {map, r, &batch.fragments[i], i, pcss->far_depth};
        const shb_pcss_fragment fragment = {
            .texel_x = r->texel_x[i],
            .texel_y = r->texel_y[i],
            .to_center_x = r->to_center_x[i],
            .to_center_y = r->to_center_y[i],
            .depth = r->depth[i] < pcss->far_depth ? r->depth[i] : pcss->far_depth,
            .turn = shb_poisson_turn(r->x[i], r->y[i], r->z[i]),
            .is_blocked = is_blocked_exactly,
            .taps = &taps};
        args->visibility[i] = searched[i] ? shb_pcss_visibility(pcss, map, &fragment) : 1;
    }
}
