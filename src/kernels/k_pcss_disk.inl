/* Taps of pcss on the disk, of WIDE fragments at a time. */

/* Adding this rounds a float below 2^22 to an int in its low bits, ties to even. */
#define ROUNDING 12582912.0f

/* Where point number k of the disk lies: texels counted from the own ones, and, before ROUNDING is
 * taken off, in the low bits of floats. */
typedef struct pcss_disk {
    const shb_pcss *pcss;
    vf xx, xy, yx, yy, to_center_x, to_center_y;
} pcss_disk;

static inline ALWAYS_INLINE pcss_disk disk_of(const shb_pcss *pcss, const pcss_lanes *own,
                                              vf radius_x, vf radius_y) {
    return (pcss_disk){pcss,
                       radius_x * own->cosine,
                       radius_x * own->sine,
                       radius_y * own->sine,
                       radius_y * own->cosine,
                       own->to_center_x,
                       own->to_center_y};
}

static inline ALWAYS_INLINE vf column_bits(const pcss_disk *disk, int k) {
    const float px = disk->pcss->points[k][0], py = disk->pcss->points[k][1];
    return ((disk->xx * px - disk->xy * py) - disk->to_center_x) + ROUNDING;
}

static inline ALWAYS_INLINE vf row_bits(const pcss_disk *disk, int k) {
    const float px = disk->pcss->points[k][0], py = disk->pcss->points[k][1];
    return ((disk->yx * px + disk->yy * py) - disk->to_center_y) + ROUNDING;
}

/* Of hits, by the exact method, taps that are shadowed; m and n: their texels, from the own ones.
 */
static vi pcss_shadowed(const pcss_lanes *own, vi hits, vf m, vf n, vf stored) {
    if (own->sheets)
        hits &= ~on_sheets(own->sheets, own->first, m, n);
    return vi_any(hits) ? shadowed_taps(own->mutual, own->first, hits, m, n, stored) : hits;
}

/* The same where planes can be gathered; hits: those that matter. */
static inline ALWAYS_INLINE vi shadowed_by_planes(const shb_map *map, const mutual_lanes *lanes,
                                                  const pcss_lanes *own, vi hits, vf m, vf n,
                                                  vf stored) {
    const vi x = own->texel_x + __builtin_convertvector(m, vi);
    const vi y = own->texel_y + __builtin_convertvector(n, vi);
    const vu texels = gather_kept(map, x & hits, y & hits);
    return pass_before(*lanes, own->to_center_x + m, own->to_center_y + n, map, stored, texels);
}

static inline ALWAYS_INLINE vf plane_at(const pcss_lanes *own, vf m, vf n, vf far_depth) {
    return vf_min((own->ref + m * own->step_x) + n * own->step_y, far_depth);
}

/* Of WIDE fragments. */
static inline ALWAYS_INLINE uint32_t *word_of_tap(uint32_t *taps, int k) {
    return taps + k / 32 * WIDE;
}

static inline ALWAYS_INLINE void note_tap(uint32_t *taps, int k, vi blocked) {
    uint32_t *word = word_of_tap(taps, k);
    vu_store(word, vu_load(word) | ((vu)blocked & 1u << k % 32));
}

/* The outcome of a search whose taps were noted, less those on sheets that have been found. */
static pcss_blocked leave_sheets(const shb_pcss *pcss, const shb_map *map, const pcss_lanes *own,
                                 uint32_t *taps, vf radius_x, vf radius_y) {
    const pcss_disk disk = disk_of(pcss, own, radius_x, radius_y);
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    const bool gathers = can_gather(map);
    vf depth = {0};
    vi hits = {0};
    for (int k = 0; k < pcss->blockers; k++) {
        vi in_map, blocked = -(vi)(vu_load(word_of_tap(taps, k)) >> k % 32 & 1);
        if (!vi_any(blocked))
            continue;
        const vf m = column_bits(&disk, k) - ROUNDING, n = row_bits(&disk, k) - ROUNDING;
        blocked &= ~on_sheets(own->sheets, own->first, m, n);
        if (!vi_any(blocked))
            continue;
        const vi x = own->texel_x + __builtin_convertvector(m, vi);
        const vi y = own->texel_y + __builtin_convertvector(n, vi);
        hits -= blocked;
        depth +=
            vf_keep(blocked, sign * read_lanes(map, gathers, x & blocked, y & blocked, &in_map));
    }
    return (pcss_blocked){__builtin_convertvector(hits, vf), depth,
                          vf_splat((float)pcss->blockers)};
}

/* The first count points of the disk, wherever they lie and whatever the format. sums: depths are
 * asked for. */
static inline ALWAYS_INLINE pcss_blocked ask_disk(const shb_pcss *pcss, const shb_map *map,
                                                  const pcss_lanes *own, vf radius_x, vf radius_y,
                                                  int count, bool sums) {
    const pcss_disk disk = disk_of(pcss, own, radius_x, radius_y);
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    const vf far_depth = vf_splat(pcss->far_depth);
    const vu rounding = (vu)vf_splat(ROUNDING);
    const bool gathers = can_gather(map);
    vf depth = {0};
    vi hits = {0};
    for (int k = 0; k < count; k++) {
        const vf x = column_bits(&disk, k), y = row_bits(&disk, k);
        const vf m = x - ROUNDING, n = y - ROUNDING;
        vi in_map;
        const vf stored =
            sign * read_lanes(map, gathers, (vi)((vu)own->texel_x + ((vu)x - rounding)),
                              (vi)((vu)own->texel_y + ((vu)y - rounding)), &in_map);
        vi blocked = in_map & (stored < plane_at(own, m, n, far_depth));
        if (own->mutual && vi_any(blocked)) {
            blocked = pcss_shadowed(own, blocked, m, n, stored);
            if (sums && own->taps)
                note_tap(own->taps, k, blocked);
        }
        hits -= blocked;
        if (sums)
            depth += vf_keep(blocked, stored);
    }
    return (pcss_blocked){__builtin_convertvector(hits, vf), depth, vf_splat((float)count)};
}

/* So many taps are placed before their texels are read: in one loop there would be too few
 * registers for both. */
#define PLACED 32

/* Indices of texels and the receiver plane at taps from first on. Sums of ints wrap, so that the
 * bits of ROUNDING leave an index by one subtraction for all taps. */
static inline ALWAYS_INLINE void place_taps(const pcss_disk *disk, const pcss_lanes *own,
                                            uint32_t stride, int first, int count,
                                            uint32_t (*indices)[WIDE], vf *planes) {
    const vf far_depth = vf_splat(disk->pcss->far_depth);
    const vu rounding = (vu)vf_splat(ROUNDING);
    const vu origin = (((vu)own->texel_y - rounding) * stride + (vu)own->texel_x) - rounding;
    for (int k = 0; k < count; k++) {
        const vf x = column_bits(disk, first + k), y = row_bits(disk, first + k);
        const vu index = ((vu)y * stride + origin) + (vu)x;
        memcpy(indices[k], &index, sizeof index);
        planes[k] = plane_at(own, x - ROUNDING, y - ROUNDING, far_depth);
    }
}

/* The same for taps that all lie inside a map whose texels can be gathered. */
static inline ALWAYS_INLINE pcss_blocked ask_disk_inside(const shb_pcss *pcss, const shb_map *map,
                                                         const pcss_lanes *own, vf radius_x,
                                                         vf radius_y, int count, bool sums) {
    const pcss_disk disk = disk_of(pcss, own, radius_x, radius_y);
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    uint32_t indices[PLACED][WIDE];
    vf planes[PLACED];
    vf depth = {0};
    vi hits = {0};
    for (int first = 0; first < count; first += PLACED) {
        const int some = count - first < PLACED ? count - first : PLACED;
        place_taps(&disk, own, (uint32_t)(map->depth.stride / 4), first, some, indices, planes);
        for (int k = 0; k < some; k++) {
            const vf stored = sign * vf_read(map->depth.texels, indices[k]);
            const vi blocked = stored < planes[k];
            hits -= blocked;
            if (sums)
                depth += vf_keep(blocked, stored);
        }
    }
    return (pcss_blocked){__builtin_convertvector(hits, vf), depth, vf_splat((float)count)};
}

/* Taps that lie in front of planes of fragments. */
typedef struct pcss_hits {
    int count;
    int taps[PLACED];
    vi blocked[PLACED];
    vf stored[PLACED];
} pcss_hits;

/* Of taps from first on, whose texels lie at these indices. Without a branch, which would often be
 * taken the wrong way. */
static inline ALWAYS_INLINE void list_hits(const shb_map *map, int first, int count,
                                           uint32_t (*indices)[WIDE], const vf *planes,
                                           pcss_hits *hits) {
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    hits->count = 0;
    for (int k = 0; k < count; k++) {
        const vf stored = sign * vf_read(map->depth.texels, indices[k]);
        const vi blocked = stored < planes[k];
        const int at = hits->count;
        hits->taps[at] = first + k;
        memcpy(&hits->blocked[at], &blocked, sizeof blocked);
        memcpy(&hits->stored[at], &stored, sizeof stored);
        hits->count += vi_any(blocked);
    }
}

/* The same by the exact method. */
static inline ALWAYS_INLINE pcss_blocked ask_disk_exactly(const shb_pcss *pcss, const shb_map *map,
                                                          const pcss_lanes *own, vf radius_x,
                                                          vf radius_y, int count, bool sums) {
    const pcss_disk disk = disk_of(pcss, own, radius_x, radius_y);
    const bool by_planes =
        map->info.occluders != SHB_OCCLUDERS_TRIANGLES && can_gather_occluders(map);
    const mutual_lanes lanes = mutual_lanes_at(own->mutual, own->first);
    uint32_t indices[PLACED][WIDE];
    vf planes[PLACED];
    pcss_hits found;
    vf depth = {0};
    vi hits = {0};
    for (int first = 0; first < count; first += PLACED) {
        const int some = count - first < PLACED ? count - first : PLACED;
        place_taps(&disk, own, (uint32_t)(map->depth.stride / 4), first, some, indices, planes);
        list_hits(map, first, some, indices, planes, &found);
        for (int k = 0; k < found.count; k++) {
            const int tap = found.taps[k];
            const vf m = column_bits(&disk, tap) - ROUNDING, n = row_bits(&disk, tap) - ROUNDING;
            const vf stored = found.stored[k];
            vi blocked = found.blocked[k];
            if (own->sheets)
                blocked &= ~on_sheets(own->sheets, own->first, m, n);
            if (by_planes)
                blocked &= shadowed_by_planes(map, &lanes, own, blocked, m, n, stored);
            else if (vi_any(blocked))
                blocked = shadowed_taps(own->mutual, own->first, blocked, m, n, stored);
            if (sums && own->taps)
                note_tap(own->taps, tap, blocked);
            hits -= blocked;
            if (sums)
                depth += vf_keep(blocked, stored);
        }
    }
    return (pcss_blocked){__builtin_convertvector(hits, vf), depth, vf_splat((float)count)};
}

/* How many texels a kernel reaches from the own one. Points and turns are a little longer than 1,
 * and a place within the own texel adds half of one, rounding to a texel another half. */
static inline ALWAYS_INLINE vi reach_of(vf radius) {
    return __builtin_convertvector(radius * (1 + 0x1p-10f) + 1.0f, vi);
}

/* True if no tap leaves the map. */
static bool all_inside(const shb_map *map, const pcss_lanes *own, vf radius_x, vf radius_y) {
    const vi reach_x = reach_of(radius_x), reach_y = reach_of(radius_y);
    const vi outside = (own->texel_x < reach_x) | (own->texel_y < reach_y) |
                       (own->texel_x >= (int32_t)map->info.width - reach_x) |
                       (own->texel_y >= (int32_t)map->info.height - reach_y);
    return !vi_any(outside);
}

static inline ALWAYS_INLINE pcss_blocked ask_disk_of(const shb_pcss *pcss, const shb_map *map,
                                                     const pcss_lanes *own, vf radius_x,
                                                     vf radius_y, int count, bool sums) {
    if (can_gather(map) && all_inside(map, own, radius_x, radius_y))
        return own->mutual ? ask_disk_exactly(pcss, map, own, radius_x, radius_y, count, sums)
                           : ask_disk_inside(pcss, map, own, radius_x, radius_y, count, sums);
    return ask_disk(pcss, map, own, radius_x, radius_y, count, sums);
}
