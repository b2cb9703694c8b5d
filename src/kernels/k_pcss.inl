/* Percentage-closer soft shadows. Taps on the disk run over WIDE fragments at a time, squares of
 * texels over WIDE texels of one fragment; sums have an order that does not depend on WIDE. */

#define SQUARE SHB_SQUARE_LANES
#define SQUARE_PARTS (SQUARE / WIDE)

/* Adding this rounds a float below 2^22 to an int in its low bits, ties to even. */
#define ROUNDING 12582912.0f

/* Words with a bit for each tap on the disk. */
#define TAP_WORDS (SHB_POISSON_MAX / 32)

/* What the searches of a batch found where a map keeps planes. */
typedef struct pcss_found {
    SHB_ALIGN int32_t open[SHB_BATCH];    /* -1: there are blockers */
    float weight[SHB_BATCH];              /* of blockers */
    float depth[SHB_BATCH];               /* their sum */
    int32_t sides[SHB_BATCH];             /* of the square that holds the search */
    uint32_t taps[SHB_BATCH * TAP_WORDS]; /* on the disk that have a blocker, a bit each */
} pcss_found;

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

/* The same for taps in a row of fragment number lane. */
static vi pcss_shadowed_in_row(const pcss_lanes *own, int lane, vi hits, int32_t m, int32_t n,
                               vf stored) {
    const size_t i = own->first + (size_t)lane;
    if (own->sheets)
        hits &= ~on_sheet(own->sheets, i, m, n);
    return vi_any(hits) ? shadowed_taps_of_one(own->mutual, i, hits, m, n, stored) : hits;
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

/* SQUARE texels of a row, as they are stored, from a column on that may lie outside the map. */
static const float *read_row(const shb_map *map, int32_t column, int32_t row, float *texels) {
    const int32_t width = (int32_t)map->info.width;
    const char *start = (const char *)map->depth.texels + (size_t)row * map->depth.stride;
    if (map->info.format == SHB_FORMAT_FLOAT32 && column >= 0 && column + SQUARE <= width)
        return (const float *)(const void *)start + column;
    int32_t columns[SQUARE], rows[SQUARE];
    for (int i = 0; i < SQUARE; i++) {
        const bool inside = column + i >= 0 && column + i < width;
        columns[i] = inside ? column + i : 0;
        rows[i] = row;
    }
    read_texels(map, SQUARE, columns, rows, texels);
    for (int i = 0; i < SQUARE; i++)
        if (column + i < 0 || column + i >= width)
            texels[i] = map->info.view.reversed ? 0.0f : 1.0f;
    return texels;
}

/* The part of a texel that the square covers along the axis. */
static inline ALWAYS_INLINE vf cover_lanes(const shb_square_axis *axis, vf texel) {
    const vf off = texel - axis->center;
    const vf covered = axis->reach - vf_max(off, -off);
    return vf_min(vf_max(covered, vf_splat(0)), vf_splat(1));
}

static float sum_square(const vf *parts) {
    float lanes[SQUARE];
    memcpy(lanes, parts, sizeof lanes);
    return shb_square_sum(lanes);
}

/* Every texel that the square about fragment number lane covers, weighed by the part covered. */
static inline ALWAYS_INLINE void ask_square(const shb_pcss *pcss, const shb_map *map,
                                            const pcss_lanes *own, int lane, float radius_x,
                                            float radius_y, bool sums, pcss_blocked *blocked) {
    const shb_square_axis across = shb_square_axis_of(own->to_center_x[lane], radius_x);
    const shb_square_axis down = shb_square_axis_of(own->to_center_y[lane], radius_y);
    const int32_t own_x = own->texel_x[lane], own_y = own->texel_y[lane];
    const float ref = own->ref[lane], step_x = own->step_x[lane], step_y = own->step_y[lane];
    const float sign = map->info.view.reversed ? -1.0f : 1.0f;
    const vf far_depth = vf_splat(pcss->far_depth);
    float height = 0;
    for (int32_t n = down.first; n <= down.last; n++)
        height += shb_square_cover(&down, n);
    const int32_t top = down.first < -own_y ? -own_y : down.first;
    const int32_t rows_below = (int32_t)map->info.height - 1 - own_y;
    const int32_t bottom = down.last < rows_below ? down.last : rows_below;
    vf weight[SQUARE_PARTS] = {{0}}, depth[SQUARE_PARTS] = {{0}}, all[SQUARE_PARTS] = {{0}};
    float lanes[SQUARE], texels[SQUARE];
    for (int32_t first = across.first; first <= across.last; first += SQUARE) {
        vf width[SQUARE_PARTS], tap[SQUARE_PARTS];
        vf row_weight[SQUARE_PARTS] = {{0}}, row_depth[SQUARE_PARTS] = {{0}};
        for (int i = 0; i < SQUARE; i++)
            lanes[i] = (float)(first + i);
        for (int p = 0; p < SQUARE_PARTS; p++) {
            const vf m = vf_load(lanes + p * WIDE);
            width[p] = cover_lanes(&across, m);
            tap[p] = vf_where(width[p] > 0, ref + m * step_x, vf_splat(-INFINITY));
        }
        for (int32_t n = top; n <= bottom; n++) {
            const float *stored = read_row(map, own_x + first, own_y + n, texels);
            const vf part = vf_splat(shb_square_cover(&down, n));
            const float run = (float)n * step_y;
            for (int p = 0; p < SQUARE_PARTS; p++) {
                const vf texel = sign * vf_load(stored + p * WIDE);
                vi hit = texel < vf_min(tap[p] + run, far_depth);
                if (own->mutual && vi_any(hit))
                    hit = pcss_shadowed_in_row(own, lane, hit, first + p * WIDE, n, texel);
                row_weight[p] += vf_keep(hit, part);
                if (sums)
                    row_depth[p] += vf_keep(hit, part * texel);
            }
        }
        for (int p = 0; p < SQUARE_PARTS; p++) {
            weight[p] += width[p] * row_weight[p];
            depth[p] += width[p] * row_depth[p];
            all[p] += width[p] * height;
        }
    }
    blocked->weight[lane] = sum_square(weight);
    blocked->depth[lane] = sum_square(depth);
    blocked->all[lane] = sum_square(all);
}

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

/* Searches of a batch where a map keeps planes, and the answers where there are no blockers. Lists
 * fragments with blockers that stand on what their own texels hold. */
static size_t search_batch(const shb_pcss *pcss, size_t count, mutual_batch *mutual,
                           pcss_found *found, uint16_t *fragments, float *visibility) {
    const shb_receivers *receivers = &mutual->receivers;
    const vi most = vi_splat(SHEET_MOST);
    own_texel texels[SHB_BATCH + 1];
    size_t listed = 0;
    int pause = 0;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        pcss_lanes own;
        load_pcss_lanes(pcss, receivers, i, mutual, &own);
        own.taps = pcss->blockers ? found->taps + i * TAP_WORDS : NULL;
        pcss_open open = open_lanes(pcss, mutual->map, &own, &pause);
        vf_store(visibility + i, open.visibility);
        if (vi_any(open.lanes)) {
            for (int k = 0; k < pcss->blockers; k += 32)
                vu_store(word_of_tap(own.taps, k), (vu){0});
            take_open(pcss, receivers, open.lanes, &own);
            const pcss_blocked blockers =
                search(pcss, mutual->map, &own, open.search_x, open.search_y, open.lanes);
            open.lanes &= blockers.weight > 0;
            vf_store(found->weight + i, blockers.weight);
            vf_store(found->depth + i, blockers.depth);
            const vi reach = reach_of(vf_max(open.search_x, open.search_y)), less = reach < most;
            vi_store(found->sides + i, (reach & less) | (most & ~less));
            listed = list_lit_by_own(mutual, i, open.lanes, fragments, texels, listed);
        }
        vi_store(found->open + i, open.lanes);
    }
    return listed > 0 ? keep_on_own(mutual, texels, fragments, listed) : 0;
}

/* Of fragments whose search found blockers. */
static vf filter_on_sheets(const shb_pcss *pcss, size_t i, mutual_batch *mutual, pcss_found *found,
                           const kept_sheets *sheets, vf visibility) {
    const shb_map *map = mutual->map;
    const vf near_depth = vf_splat(pcss->near_depth);
    pcss_lanes own;
    pcss_blocked blockers = {vf_load(found->weight + i), vf_load(found->depth + i), vf_splat(0)};
    vi open = vi_load(found->open + i);
    load_pcss_lanes(pcss, &mutual->receivers, i, mutual, &own);
    take_open(pcss, &mutual->receivers, open, &own);
    if (have_sheets(sheets, i)) {
        const vf search_x = radius_lanes(pcss->texels_x, own.depth, near_depth);
        const vf search_y = radius_lanes(pcss->texels_y, own.depth, near_depth);
        own.sheets = sheets;
        blockers = pcss->blockers ? leave_sheets(pcss, map, &own, found->taps + i * TAP_WORDS,
                                                 search_x, search_y)
                                  : search(pcss, map, &own, search_x, search_y, open);
        open &= blockers.weight > 0;
    }
    return vf_where(open, lit_by_blockers(pcss, map, &own, &blockers, open), visibility);
}

/* Sheets are found for a whole batch at once. */
static void ask_pcss_on_sheets(const shb_pcss *pcss, size_t count, mutual_batch *mutual,
                               float *visibility) {
    pcss_found found;
    kept_sheets sheets;
    uint16_t fragments[SHB_BATCH + 1];
    const size_t listed = search_batch(pcss, count, mutual, &found, fragments, visibility);
    find_kept_sheets(mutual, fragments, listed, found.sides, &sheets);
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE)
        if (vi_any(vi_load(found.open + i)))
            vf_store(visibility + i,
                     filter_on_sheets(pcss, i, mutual, &found, &sheets, vf_load(visibility + i)));
}

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
