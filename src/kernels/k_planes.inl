/* The exact method on maps that keep planes: the test of mutual planes (shb_exact_is_shadowed) of
 * each fragment and the texel that holds it. Places are found in double, as that test has them; the
 * rest is done in float, of which quick_planes.c tells what is sure. The few others are tested.
 * What is shadowed by something near looks at the texels around its own, too (light_fine_sheets).
 */

#include "lane_parts.h"

/* By which nu is multiplied, so that errors become infinite before anything else overflows. */
#define NU_SCALE 0x1p60f

/* Fragments and the texels that hold them. Names as in quick_planes.c. */
typedef struct plane_batch {
    SHB_ALIGN float position[3][SHB_BATCH], normal[3][SHB_BATCH]; /* of packed points */
    SHB_ALIGN double z[SHB_BATCH];
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH], depth[SHB_BATCH]; /* these four unless affine */
    float inverse_w[SHB_BATCH];
    float to_x[SHB_BATCH], to_y[SHB_BATCH];
    int32_t column[SHB_BATCH], row[SHB_BATCH];
    uint32_t texel[SHB_BATCH]; /* where maps are gathered from: of the depth, later of the slopes */
    int32_t inside[SHB_BATCH];
    float nu[SHB_BATCH];                                              /* times NU_SCALE */
    float steepness[SHB_BATCH], rise_x[SHB_BATCH], rise_y[SHB_BATCH]; /* D, N */
    float ahead[SHB_BATCH]; /* T less the part of d, later all of it, with errors but those by d */
    float stored[SHB_BATCH], behind[SHB_BATCH]; /* d */
    float passed[SHB_BATCH]; /* what the texel's plane passes in front by, of those that are open */
    int32_t open[SHB_BATCH]; /* -1: not surely lit by the own plane */
} plane_batch;

/* Positions and normals as arrays: where they are packed, those of the batch. */
static inline ALWAYS_INLINE shb_quick_points arrays_of(const shb_quick_points *points,
                                                       const plane_batch *batch) {
    shb_quick_points arrays = *points;
    for (int k = 0; k < 3 && points->packed; k++) {
        arrays.position[k] = batch->position[k];
        arrays.normal[k] = batch->normal[k];
    }
    return arrays;
}

static inline ALWAYS_INLINE void unpack_points(const shb_quick_points *points, size_t i,
                                               plane_batch *batch, vf position[3]) {
    vf normal[3];
    prefetch_next_batch(points, true, i);
    vf_read_triples(points->position[0] + 3 * i, position);
    vf_read_triples(points->normal[0] + 3 * i, normal);
    for (int k = 0; k < 3; k++) {
        vf_store(batch->position[k] + i, position[k]);
        vf_store(batch->normal[k] + i, normal[k]);
    }
}

/* Fragments behind the light come to lie outside of the map. */
static inline ALWAYS_INLINE void place_doubles(const shb_light_rows *rows, bool affine,
                                               const vf position[3], size_t first,
                                               plane_batch *batch) {
    const wd zero = wd_splat(0.0), none = wd_splat((double)SHB_TEXEL_NONE);
    for (size_t i = first; i < first + WIDE; i += DOUBLES) {
        const wd px = wd_part(position[0], i - first);
        const wd py = wd_part(position[1], i - first);
        const wd pz = wd_part(position[2], i - first);
        wd x = row_at(rows->x, px, py, pz);
        wd y = row_at(rows->y, px, py, pz);
        wd z = row_at(rows->z, px, py, pz);
        if (!affine) {
            const wd w = row_at(rows->w, px, py, pz);
            const wd inverse_w = 1.0 / w;
            x = wd_where_greater(w, zero, x * inverse_w, none);
            y *= inverse_w;
            z *= inverse_w;
            wd_store_floats(batch->x + i, x);
            wd_store_floats(batch->y + i, y);
            wd_store_floats(batch->depth + i, z);
            wd_store_floats(batch->inverse_w + i, inverse_w);
        }
        const wd column = wd_floor(x), row = wd_floor(y);
        wd_store(batch->z + i, z);
        wd_store_floats(batch->to_x + i, column + 0.5 - x);
        wd_store_floats(batch->to_y + i, row + 0.5 - y);
        wd_store_ints(batch->column + i, column);
        wd_store_ints(batch->row + i, row);
    }
}

static inline ALWAYS_INLINE void place_as(const shb_map *map, bool affine, size_t lanes,
                                          const shb_quick_points *points, plane_batch *batch) {
    const shb_light_rows rows = map->rows;
    for (size_t i = 0; i < lanes; i += WIDE) {
        vf position[3];
        if (points->packed)
            unpack_points(points, i, batch, position);
        else
            read_points(points->position, false, i, position);
        place_doubles(&rows, affine, position, i, batch);
    }
}

/* Places texels of four bytes, and asks for them. */
static inline ALWAYS_INLINE void prefetch_texels(const void *texels, vu places, size_t i,
                                                 plane_batch *batch) {
    vu_store(batch->texel + i, places);
    for (size_t lane = i; lane < i + WIDE; lane++)
        __builtin_prefetch((const float *)texels + batch->texel[lane]);
}

static inline ALWAYS_INLINE void prefetch_depths(const shb_map *map, plane_batch *batch, size_t i) {
    vi inside;
    const vu places =
        index_lanes(map, vi_load(batch->column + i), vi_load(batch->row + i), &inside);
    vi_store(batch->inside + i, inside);
    prefetch_texels(map->depth.texels, places, i, batch);
}

/* R: infinite or no numbers come to be small ones. What is taken away holds what underflows, and
 * keeps a sum of 0 from becoming a subnormal number, which takes processors long. It is nothing
 * beside E. */
static inline ALWAYS_INLINE vf surely_moved(const shb_quick_planes *q, bool affine,
                                            const shb_quick_points *points,
                                            const plane_batch *batch, size_t i, vf size_x,
                                            vf size_y, vf size_z) {
    vf p[3];
    read_points(points->position, false, i, p);
    const vf sum = (size_x * vf_abs(p[0]) + size_y * vf_abs(p[1])) + size_z * vf_abs(p[2]);
    vf moved = vf_min(sum, vf_splat(0x1p40f)) * q->moved - 0x1p-110f;
    if (!affine) {
        const vf inverse_w = vf_min(vf_load(batch->inverse_w + i), vf_splat(0x1p28f));
        moved = (moved * inverse_w) * inverse_w;
    }
    return moved;
}

/* Asks for the depths of texels, too: they lie anywhere in memory. */
static inline ALWAYS_INLINE void find_own_planes(const shb_map *map, bool affine, bool gathers,
                                                 size_t lanes, const shb_quick_points *points,
                                                 plane_batch *batch) {
    const shb_quick_planes q = map->occluders.quick;
    for (size_t i = 0; i < lanes; i += WIDE) {
        vf n[3];
        read_points(points->normal, false, i, n);
        const vf nx = n[0], ny = n[1], nz = n[2];
        vf ab = quick_dot(q.xy, nx, ny, nz);
        vf cb = quick_dot(q.zy, nx, ny, nz);
        vf ac = quick_dot(q.xz, nx, ny, nz);
        if (gathers)
            prefetch_depths(map, batch, i);
        if (!affine) {
            const vf x = vf_load(batch->x + i) - q.middle_x, y = vf_load(batch->y + i) - q.middle_y;
            const vf z = vf_load(batch->depth + i);
            const vf xw = quick_dot(q.xw, nx, ny, nz), yw = quick_dot(q.yw, nx, ny, nz);
            const vf zw = quick_dot(q.zw, nx, ny, nz);
            ab = (ab - y * xw) + x * yw;
            cb = (cb - y * zw) + z * yw;
            ac = (ac - z * xw) + x * zw;
        }
        const vu sign = (vu)ab & 0x80000000u;
        cb = (vf)((vu)cb ^ sign);
        ac = (vf)((vu)ac ^ sign);
        const vf size_x = vf_abs(nx), size_y = vf_abs(ny), size_z = vf_abs(nz);
        const vf nu = ((size_x + size_y) + size_z) * NU_SCALE + 0x1p-30f * NU_SCALE;
        const vf moved = surely_moved(&q, affine, points, batch, i, size_x, size_y, size_z);
        const vf run = cb * vf_load(batch->to_x + i) + ac * vf_load(batch->to_y + i);
        vf_store(batch->nu + i, nu);
        vf_store(batch->steepness + i, vf_abs(ab));
        vf_store(batch->rise_x + i, cb);
        vf_store(batch->rise_y + i, ac);
        vf_store(batch->ahead + i, (run + nu * (q.error / NU_SCALE)) - moved);
    }
}

static NEVER_INLINE void place_fragments(const shb_map *map, bool gathers, size_t lanes,
                                         const shb_quick_points *points, plane_batch *batch) {
    const shb_quick_points arrays = arrays_of(points, batch);
    if (map->projection.affine) {
        place_as(map, true, lanes, points, batch);
        find_own_planes(map, true, gathers, lanes, &arrays, batch);
    } else {
        place_as(map, false, lanes, points, batch);
        find_own_planes(map, false, gathers, lanes, &arrays, batch);
    }
}

/* Of fragments that are open. */
static inline ALWAYS_INLINE void prefetch_open(const shb_map *map, plane_batch *batch, size_t i) {
    const vi open = vi_load(batch->open + i);
    const vi row = vi_load(batch->row + i), column = vi_load(batch->column + i);
    const vu places = (vu)row * (uint32_t)(map->occluders.stride / 4) + (vu)column;
    prefetch_texels(map->occluders.texels, (vu)open & places, i, batch);
}

/* Lists the vectors of fragments that are not all lit, without a branch that nobody could foresee,
 * and asks for their texels' slopes. */
static inline ALWAYS_INLINE size_t find_open(const shb_map *map, bool gathers, size_t lanes,
                                             plane_batch *batch, uint16_t *vectors) {
    const float depth_error = map->occluders.quick.depth_error / NU_SCALE;
    const vf far_depth = vf_splat(shb_far_depth(map->info.view.reversed));
    size_t count = 0;
    for (size_t i = 0; i < lanes; i += DOUBLES)
        wd_store_floats(batch->behind + i,
                        wd_load(batch->z + i) - wd_load_floats(batch->stored + i));
    for (size_t i = 0; i < lanes; i += WIDE) {
        const vf behind = vf_load(batch->behind + i);
        const vf ahead = vf_load(batch->steepness + i) * behind + vf_load(batch->ahead + i);
        const vf error = (vf_load(batch->nu + i) * vf_abs(behind)) * depth_error;
        const vi open = (vi)(vf_load(batch->stored + i) < far_depth) & ~(vi)(ahead + error < 0);
        vf_store(batch->ahead + i, ahead);
        vi_store(batch->open + i, open);
        vectors[count] = (uint16_t)i;
        count += vi_any(open);
    }
    for (size_t n = 0; gathers && n < count; n++)
        prefetch_open(map, batch, vectors[n]);
    return count;
}

static inline ALWAYS_INLINE vu read_slopes(const shb_map *map, bool gathers,
                                           const plane_batch *batch, size_t i, vi asked) {
    if (gathers)
        return (vu)vf_read((const float *)(const void *)map->occluders.texels, batch->texel + i);
    return gather_occluders(map, vi_load(batch->column + i) & asked,
                            vi_load(batch->row + i) & asked);
}

/* What is sure of the planes of WIDE texels at the fragments' places: that they pass in front of
 * them, or that they do not; those too steep to have slopes do not. */
typedef struct occluder_side {
    vi passes, clears;
    vf slopes; /* sum of sizes */
} occluder_side;

static inline ALWAYS_INLINE occluder_side judge_occluders(const shb_quick_planes *q, vu texels,
                                                          plane_batch *batch, size_t i, vf psi) {
    const vf step = slope_steps(texels) * q->step_unit;
    const vf slope_x = x_mantissas(texels) * step, slope_y = y_mantissas(texels) * step;
    const vf slopes = vf_abs(slope_x) + vf_abs(slope_y);
    const vf behind = vf_load(batch->behind + i);
    const vf to_x = vf_load(batch->to_x + i), to_y = vf_load(batch->to_y + i);
    const vf passed = behind + (slope_x * to_x + slope_y * to_y);
    const vf steps = step * (vf_abs(to_x) + vf_abs(to_y)), half = 0.5f * steps;
    const vf rounding = (0x1p-22f * vf_abs(behind) + 0x1p-100f) + SLOPE_MORE * steps;
    vf_store(batch->passed + i, passed);
    const vf most =
        (half + rounding) + psi * (q->occluder_by_place + q->occluder_by_slope * slopes);
    const vi known = have_slopes(texels);
    return (occluder_side){known & (passed > most), (vi)(passed < half - rounding) | ~known,
                           slopes};
}

/* -1 where the stored depths surely lie in front of the fragments' own planes. */
static inline ALWAYS_INLINE vi are_behind(const shb_quick_planes *q, const plane_batch *batch,
                                          size_t i, vf psi, vf by_w, vf slopes) {
    const float snapped = (float)SHB_SNAPPED_TEXELS * (1 + 0x1p-8f);
    const vf gap = vf_abs(vf_load(batch->behind + i)), steepness = vf_load(batch->steepness + i);
    const vf nu = vf_load(batch->nu + i) * (1 / NU_SCALE);
    const vf rises = vf_abs(vf_load(batch->rise_x + i)) + vf_abs(vf_load(batch->rise_y + i));
    const vf most =
        nu * ((q->own_by_normal + q->depth_error * gap) + psi * (q->own_by_place + by_w)) +
        (((0x1p-11f + snapped) * rises + steepness * (snapped * slopes)) + q->own);
    const vf least_steepness = q->steep + nu * (0x1p-12f + psi * q->steep_by_place);
    return (psi < q->farthest) & (gap < 2) & (steepness > least_steepness) &
           (vf_load(batch->ahead + i) > most);
}

/* Writes who is surely shadowed; bits of those that are open and not sure. */
static inline ALWAYS_INLINE uint32_t settle_open(const shb_map *map, bool affine, bool gathers,
                                                 const shb_quick_points *points, plane_batch *batch,
                                                 size_t i, float *restrict visibility) {
    const shb_quick_planes *q = &map->occluders.quick;
    const vi open = vi_load(batch->open + i);
    const vu texels = read_slopes(map, gathers, batch, i, open);
    vf p[3];
    read_points(points->position, false, i, p);
    const vf place = (vf_abs(p[0]) + vf_abs(p[1])) + vf_abs(p[2]);
    vf psi = 3 * place + q->beta, by_w = vf_splat(q->own_by_w);
    if (!affine) {
        const vf inverse_w = vf_load(batch->inverse_w + i);
        psi *= inverse_w;
        by_w *= inverse_w;
    }
    const occluder_side occluders = judge_occluders(q, texels, batch, i, psi);
    const vi is_shadowed =
        open & occluders.passes & are_behind(q, batch, i, psi, by_w, occluders.slopes);
    vf_store(visibility + i, vf_keep(~is_shadowed, vf_splat(1.0f)));
    return vi_bits(open & ~(is_shadowed | occluders.clears));
}

/* Up to DOUBLES fragments and their texels, which hold occluders. */
typedef struct plane_lanes {
    float position[3][DOUBLES], normal[3][DOUBLES];
    float center_x[DOUBLES], center_y[DOUBLES], depth[DOUBLES];
    float slope_x[DOUBLES], slope_y[DOUBLES], slope_step[DOUBLES];
} plane_lanes;

/* The first one fills up the lanes. */
static inline void pick_lanes(const shb_map *map, const shb_quick_points *points,
                              const plane_batch *batch, const uint16_t *numbers, size_t count,
                              plane_lanes *lanes) {
    for (size_t k = 0; k < DOUBLES; k++) {
        const size_t i = numbers[k < count ? k : 0];
        const uint32_t slopes = shb_occluder_row(map, batch->row[i])[batch->column[i]];
        for (int axis = 0; axis < 3; axis++) {
            lanes->position[axis][k] = points->position[axis][i];
            lanes->normal[axis][k] = points->normal[axis][i];
        }
        lanes->center_x[k] = (float)batch->column[i] + 0.5f;
        lanes->center_y[k] = (float)batch->row[i] + 0.5f;
        lanes->depth[k] = batch->stored[i];
        lanes->slope_x[k] = (float)shb_slope_x(slopes);
        lanes->slope_y[k] = (float)shb_slope_y(slopes);
        lanes->slope_step[k] = (float)shb_slopes_step(slopes);
    }
}

static NEVER_INLINE void test_planes(const shb_map *map, const shb_quick_points *points,
                                     const plane_batch *batch, const uint16_t *numbers,
                                     size_t count, float *visibility) {
    const double unit = map->occluders.slope_unit;
    plane_lanes lanes;
    wd position[3], normal[3];
    pick_lanes(map, points, batch, numbers, count, &lanes);
    for (int k = 0; k < 3; k++) {
        position[k] = wd_load_floats(lanes.position[k]);
        normal[k] = wd_load_floats(lanes.normal[k]);
    }
    const wd slope_error = wd_load_floats(lanes.slope_step) * (unit / 2);
    const wide_exact_sample samples = {.center_x = wd_load_floats(lanes.center_x),
                                       .center_y = wd_load_floats(lanes.center_y),
                                       .depth = wd_load_floats(lanes.depth),
                                       .slope_x = wd_load_floats(lanes.slope_x) * unit,
                                       .slope_y = wd_load_floats(lanes.slope_y) * unit,
                                       .slope_error_x = slope_error,
                                       .slope_error_y = slope_error};
    const wide_light_point placed = wide_light_point_at(&map->rows, position, SHB_FLOAT_ROUNDING);
    const wide_light_slopes slopes = wide_exact_slopes_of(&map->rows, &placed, normal);
    const wd errors = wide_exact_error_of(&placed, &slopes);
    const uint32_t shadowed = wide_exact_shadowed_bits(&placed, &slopes, errors, &samples);
    for (size_t k = 0; k < DOUBLES && k < count; k++)
        visibility[numbers[k]] = shadowed >> k & 1 ? 0.0f : 1.0f;
}

/* How far these planes miss the occluders of the four texels next to theirs, but for the one that
 * each misses least, and for rounding; infinite where no two of them hold an occluder. */
static inline ALWAYS_INLINE vf second_miss(const shb_map *map, bool gathers,
                                           const plane_batch *batch, size_t i,
                                           const texel_slopes *slopes) {
    static const int32_t to_x[4] = {-1, 1, 0, 0}, to_y[4] = {0, 0, -1, 1};
    const bool reversed = map->info.view.reversed;
    const float far_depth = shb_far_depth(reversed);
    const float step = shb_format_step(map->info.format);
    const vf stored = vf_load(batch->stored + i);
    vf least = vf_splat(INFINITY), second = least;
    for (int k = 0; k < 4; k++) {
        vi inside;
        /* fragments outside of the map may have the least number for a place */
        const vu column = (vu)vi_load(batch->column + i) + (uint32_t)to_x[k];
        const vu row = (vu)vi_load(batch->row + i) + (uint32_t)to_y[k];
        const vf texel = read_lanes(map, gathers, (vi)column, (vi)row, &inside);
        const vf z = reversed ? -texel : texel;
        const vf rise = (float)to_x[k] * slopes->x + (float)to_y[k] * slopes->y;
        const vf depths = vf_abs(stored) + vf_abs(z);
        const vf rounding = slopes->error + (8 * (float)SHB_FLOAT_ROUNDING * depths + step);
        const vf off = vf_max(vf_abs(z - (stored + rise)) - rounding, vf_splat(0.0f));
        const vf miss = vf_where(inside & (z < far_depth), off, vf_splat(INFINITY));
        second = vf_min(second, vf_max(least, miss));
        least = vf_min(least, miss);
    }
    return second;
}

/* Lights those of WIDE fragments that seem to be shadowed by their own surface where that is finer
 * than texels: facets of a relief that are turned alike, which two planes alone take for sheets one
 * above the other. There the texel's plane misses its neighbours, and passes in front of the
 * fragment by no more than twice that. What lies four texels in front, or is turned by more than
 * half of a right angle, is another surface. */
static inline ALWAYS_INLINE void light_fine_sheets(const shb_map *map, bool affine, bool gathers,
                                                   const plane_batch *batch, size_t i,
                                                   float *restrict visibility) {
    const vf shown = vf_load(visibility + i), passed = vf_load(batch->passed + i);
    vf texel = vf_splat(map->occluders.quick.diagonal);
    if (!affine)
        texel *= vf_load(batch->inverse_w + i);
    vi asked = (shown == 0.0f) & (passed < 4 * texel);
    if (!vi_any(asked))
        return;
    const texel_slopes slopes =
        slopes_of_texels(read_slopes(map, gathers, batch, i, asked), step_unit(map));
    const vf steepness = vf_load(batch->steepness + i);
    const vf turn = vf_abs(vf_load(batch->rise_x + i) - steepness * slopes.x) +
                    vf_abs(vf_load(batch->rise_y + i) - steepness * slopes.y);
    asked &= turn < steepness * texel;
    if (!vi_any(asked))
        return;
    const vf second = second_miss(map, gathers, batch, i, &slopes);
    const vi are_lit = asked & (second < INFINITY) & (passed < 2 * second);
    vf_store(visibility + i, vf_where(are_lit, vf_splat(1.0f), shown));
}

static inline ALWAYS_INLINE void ask_planes_as(const shb_map *map, bool affine, bool gathers,
                                               size_t lanes, const shb_quick_points *points,
                                               float *visibility) {
    plane_batch batch;
    uint16_t vectors[SHB_BATCH], unsure[SHB_BATCH];
    size_t unsure_count = 0;
    const shb_quick_points arrays = arrays_of(points, &batch);
    place_fragments(map, gathers, lanes, points, &batch);
    if (gathers)
        read_placed(map, lanes, batch.texel, batch.inside, batch.stored);
    else
        fetch_whole(map, lanes, batch.column, batch.row, batch.stored);
    for (size_t i = 0; i < lanes; i += WIDE)
        vf_store(visibility + i, vf_splat(1.0f));
    const size_t vector_count = find_open(map, gathers, lanes, &batch, vectors);
    for (size_t n = 0; n < vector_count; n++) {
        const size_t i = vectors[n];
        uint32_t bits = settle_open(map, affine, gathers, &arrays, &batch, i, visibility);
        for (; bits; bits &= bits - 1)
            unsure[unsure_count++] = (uint16_t)(i + (size_t)__builtin_ctz(bits));
    }
    for (size_t n = 0; n < unsure_count; n += DOUBLES)
        test_planes(map, &arrays, &batch, unsure + n, unsure_count - n, visibility);
    for (size_t n = 0; n < vector_count; n++)
        light_fine_sheets(map, affine, gathers, &batch, vectors[n], visibility);
}

static void ask_planes(const shb_map *map, size_t count, const shb_quick_points *points,
                       float *visibility) {
    const size_t lanes = shb_round_to_lanes(count);
    const bool gathers =
        can_gather(map) && map->occluders.stride / 4 <= (size_t)INT32_MAX / map->info.height;
    if (!gathers)
        ask_planes_as(map, map->projection.affine, false, lanes, points, visibility);
    else if (map->projection.affine)
        ask_planes_as(map, true, true, lanes, points, visibility);
    else
        ask_planes_as(map, false, true, lanes, points, visibility);
}
