/* Percentage-closer soft shadows. Taps on the disk run over WIDE fragments at a time, squares of
 * texels over WIDE texels of one fragment; sums have an order that does not depend on WIDE. */

/* WIDE fragments. */
typedef struct pcss_lanes {
    vi texel_x, texel_y;
    vf to_center_x, to_center_y;
    vf depth; /* not beyond the far plane */
    vf ref, step_x, step_y;
    vf cosine, sine;           /* of the disk's turn */
    mutual_batch *mutual;      /* of the exact method; else NULL */
    size_t first;              /* the number of the first of these in it */
    const kept_sheets *sheets; /* that they are known to stand on, or NULL */
    uint32_t *taps;            /* of the search, where they are to be noted; else NULL */
} pcss_lanes;

/* What stands in front of the receiver plane, as the sum of taps and of their depths. */
typedef struct pcss_blocked {
    vf weight, depth;
    vf all; /* weight of all taps */
} pcss_blocked;

#include "k_pcss_disk.inl"

#include "k_pcss_square.inl"

/* A stage's taps; sums: depths are asked for. */
static inline ALWAYS_INLINE pcss_blocked ask_taps(const shb_pcss *pcss, const shb_map *map,
                                                  const pcss_lanes *own, vf radius_x, vf radius_y,
                                                  int count, vi wanted, bool sums) {
    if (count)
        return ask_disk_of(pcss, map, own, radius_x, radius_y, count, sums);
    pcss_blocked blocked = {{0}, {0}, {0}};
    const vi large = (radius_x > SHB_PCSS_SQUARE_MOST) | (radius_y > SHB_PCSS_SQUARE_MOST);
    if (vi_any(large & wanted))
        blocked = ask_disk_of(pcss, map, own, radius_x, radius_y, SHB_PCSS_SPREAD, sums);
    for (int lane = 0; lane < WIDE; lane++)
        if (wanted[lane] && !large[lane])
            ask_square(pcss, map, own, lane, radius_x[lane], radius_y[lane], sums, &blocked);
    return blocked;
}

static NEVER_INLINE pcss_blocked search(const shb_pcss *pcss, const shb_map *map,
                                        const pcss_lanes *own, vf radius_x, vf radius_y,
                                        vi wanted) {
    return ask_taps(pcss, map, own, radius_x, radius_y, pcss->blockers, wanted, true);
}

static NEVER_INLINE pcss_blocked filter(const shb_pcss *pcss, const shb_map *map,
                                        const pcss_lanes *own, vf radius_x, vf radius_y,
                                        vi wanted) {
    return ask_taps(pcss, map, own, radius_x, radius_y, pcss->samples, wanted, false);
}

static vf radius_lanes(float texels, vf depth, vf blocker) {
    const vf radius = texels * (depth - blocker);
    return vf_min(vf_max(radius, vf_splat(SHB_PCSS_LEAST)), vf_splat(SHB_PCSS_MOST));
}

/* How far taps of a kernel lie from the fragment on an axis, texels. */
static vf exact_reach(vf radius) {
    return 1.5f * radius + 2.0f;
}

/* All but the turn of the disk. */
static inline ALWAYS_INLINE void load_pcss_lanes(const shb_pcss *pcss, const shb_receivers *r,
                                                 size_t i, mutual_batch *mutual, pcss_lanes *own) {
    own->texel_x = vi_load(r->texel_x + i);
    own->texel_y = vi_load(r->texel_y + i);
    own->to_center_x = vf_load(r->to_center_x + i);
    own->to_center_y = vf_load(r->to_center_y + i);
    own->depth = vf_min(vf_load(r->depth + i), vf_splat(pcss->far_depth));
    own->ref = vf_load(r->ref + i);
    own->step_x = pcss->own_depth ? vf_splat(0) : vf_load(r->step_x + i);
    own->step_y = pcss->own_depth ? vf_splat(0) : vf_load(r->step_y + i);
    own->mutual = mutual;
    own->first = i;
    own->sheets = NULL;
    own->taps = NULL;
}

static inline ALWAYS_INLINE void load_turns(const shb_pcss *pcss, const shb_receivers *r, size_t i,
                                            pcss_lanes *own) {
    int32_t turns[WIDE];
    for (size_t k = 0; k < WIDE; k++)
        turns[k] = 2 * (int32_t)shb_poisson_turn(r->x[i + k], r->y[i + k], r->z[i + k]);
    own->cosine = vf_gather(pcss->turns, vi_load(turns));
    own->sine = vf_gather(pcss->turns + 1, vi_load(turns));
}

/* What the pyramid tells of kernels of this size about wanted texels of the map. Not inlined: where
 * gcc 12 sees the comparison that a mask of one lane comes from, it takes the lane for not set. */
static NEVER_INLINE plain_outcome ask_pyramid(const shb_pcss *pcss, const shb_map *map,
                                              const pcss_lanes *own, vf radius_x, vf radius_y,
                                              vi wanted) {
    const vi reach_x = reach_of(radius_x), reach_y = reach_of(radius_y);
    plain_group group = {.texel_x = own->texel_x,
                         .texel_y = own->texel_y,
                         .ref = own->ref,
                         .step_x = own->step_x,
                         .step_y = own->step_y};
    set_rectangle(&group, wanted, own->texel_x - reach_x, own->texel_y - reach_y,
                  own->texel_x + reach_x, own->texel_y + reach_y);
    const plain_outcome plain = find_plain(pcss->pyramid, map, &group);
    return (plain_outcome){plain.lit & wanted, plain.dark & wanted};
}

/* WIDE fragments: those that the pyramid left open, and the answers to all others; half widths of
 * their searches. */
typedef struct pcss_open {
    vi lanes;
    vf visibility;
    vf search_x, search_y;
} pcss_open;

/* After a question to the pyramid that settled nothing, so many vectors are not asked for. */
#define PCSS_PAUSE 3

/* The filter's kernel lies within that of the search, so what is plain there is plain here; but
 * what is dark before the fragment's plane need not be so by the exact method. */
static inline ALWAYS_INLINE pcss_open open_lanes(const shb_pcss *pcss, const shb_map *map,
                                                 const pcss_lanes *own, int *pause) {
    const vf near_depth = vf_splat(pcss->near_depth);
    pcss_open open = {((vu)own->texel_x < map->info.width) & ((vu)own->texel_y < map->info.height),
                      vf_splat(1.0f), radius_lanes(pcss->texels_x, own->depth, near_depth),
                      radius_lanes(pcss->texels_y, own->depth, near_depth)};
    if (pcss->pyramid && vi_any(open.lanes) && (*pause)-- <= 0) {
        plain_outcome plain = ask_pyramid(pcss, map, own, open.search_x, open.search_y, open.lanes);
        if (own->mutual)
            plain.dark = vi_splat(0);
        open.visibility = vf_where(plain.dark, vf_splat(0.0f), open.visibility);
        open.lanes &= ~(plain.lit | plain.dark);
        *pause = vi_any(plain.lit | plain.dark) ? 0 : PCSS_PAUSE;
    }
    return open;
}

/* The rest has nothing in front of its planes. */
static inline ALWAYS_INLINE void take_open(const shb_pcss *pcss, const shb_receivers *receivers,
                                           vi lanes, pcss_lanes *own) {
    own->ref = vf_where(lanes, own->ref, vf_splat(-INFINITY));
    load_turns(pcss, receivers, own->first, own);
}

/* What a kernel as wide as the penumbra of the blockers finds. */
static inline ALWAYS_INLINE vf lit_by_blockers(const shb_pcss *pcss, const shb_map *map,
                                               const pcss_lanes *own, const pcss_blocked *blockers,
                                               vi lanes) {
    const vf mean = vf_max(blockers->depth / blockers->weight, vf_splat(pcss->near_depth));
    const vf radius_x = radius_lanes(pcss->texels_x, own->depth, mean);
    const vf radius_y = radius_lanes(pcss->texels_y, own->depth, mean);
    const pcss_blocked filtered = filter(pcss, map, own, radius_x, radius_y, lanes);
    return (filtered.all - filtered.weight) / filtered.all;
}

/* mutual: of the exact method where a map keeps triangles; else NULL. */
static void ask_pcss(const shb_pcss *pcss, const shb_map *map, size_t count,
                     const shb_receivers *restrict receivers, mutual_batch *mutual,
                     float *restrict visibility) {
    int pause = 0;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        pcss_lanes own;
        load_pcss_lanes(pcss, receivers, i, mutual, &own);
        pcss_open open = open_lanes(pcss, map, &own, &pause);
        if (vi_any(open.lanes)) {
            take_open(pcss, receivers, open.lanes, &own);
            const pcss_blocked blockers =
                search(pcss, map, &own, open.search_x, open.search_y, open.lanes);
            open.lanes &= blockers.weight > 0;
            if (vi_any(open.lanes))
                open.visibility =
                    vf_where(open.lanes, lit_by_blockers(pcss, map, &own, &blockers, open.lanes),
                             open.visibility);
        }
        vf_store(visibility + i, open.visibility);
    }
}

#include "k_pcss_sheets.inl"

static void pcss_batch(const shb_pcss *pcss, const shb_map *map, size_t count,
                       const shb_receivers *receivers, float *visibility) {
    ask_pcss(pcss, map, count, receivers, NULL, visibility);
}

/* By the exact method; the planes of fragments are written for the reach of their searches. */
static void pcss_exact(const shb_pcss *pcss, const shb_filter_args *args) {
    const vf near_depth = vf_splat(pcss->near_depth);
    mutual_batch mutual;
    mutual_batch_init(args, &mutual);
    for (size_t i = 0; i < shb_round_to_lanes(args->count); i += WIDE) {
        const vf depth = vf_min(vf_load(mutual.receivers.depth + i), vf_splat(pcss->far_depth));
        vf_store(mutual.reach + i,
                 exact_reach(vf_max(radius_lanes(pcss->texels_x, depth, near_depth),
                                    radius_lanes(pcss->texels_y, depth, near_depth))));
    }
    mutual_batch_finish(&mutual, args->count);
    if (args->map->info.occluders == SHB_OCCLUDERS_TRIANGLES)
        ask_pcss(pcss, args->map, args->count, &mutual.receivers, &mutual, args->visibility);
    else
        ask_pcss_on_sheets(pcss, args->count, &mutual, args->visibility);
}
