/* Boxes of texels by the exact method, where a map keeps planes. A tap is shadowed if its texel
 * lies in front of the fragment's plane, and that of the texel passes in front of the fragment, and
 * the texel is not on the fragment's sheet. All for whole vectors of columns without a branch,
 * which the hits of single rows would often mislead. */

#include "k_joints.inl"

/* What a tap has to be to be shadowed: before the fragment's plane, and of a plane that passes in
 * front of the fragment. */
enum { IN_FRONT = 1, PASSING = 2 };

/* How the rows of boxes of WIDE fragments lie to them, counted from the first row. */
typedef struct row_ways {
    float drop[SHB_BOX_MAX][WIDE]; /* of a fragment's plane, as its ref and steps */
    float rising[SHB_BOX_MAX][WIDE], falling[SHB_BOX_MAX][WIDE], error[SHB_BOX_MAX][WIDE];
} row_ways;

static inline ALWAYS_INLINE void find_row_ways(const box_batch *batch, const uint16_t *fragments,
                                               int n, int asked, row_ways *ways) {
    const shb_receivers *r = batch->receivers;
    const float unit = step_unit(batch->map);
    float first[WIDE], to_center[WIDE], step[WIDE], moved[WIDE];
    for (int lane = 0; lane < WIDE; lane++) {
        const size_t i = fragments[lane];
        first[lane] = (float)(batch->top[i] - r->texel_y[i]);
        to_center[lane] = r->to_center_y[i];
        step[lane] = r->step_y[i];
        moved[lane] = batch->mutual->moved_y[i];
    }
    for (int k = 0; k < n; k++) {
        const vf row = vf_load(first) + (float)k;
        const mutual_way way = mutual_way_of(vf_load(moved), vf_load(to_center) + row, unit);
        if (asked & IN_FRONT)
            vf_store(ways->drop[k], row * vf_load(step));
        if (asked & PASSING) {
            vf_store(ways->rising[k], way.rising);
            vf_store(ways->falling[k], way.falling);
            vf_store(ways->error[k], way.error);
        }
    }
}

static inline ALWAYS_INLINE texel_box exact_box_in_place(const box_batch *batch, size_t i) {
    texel_box b = box_in_place(batch, i);
    b.occluders = (const char *)(shb_occluder_row(batch->map, batch->top[i]) + batch->left[i]);
    b.occluder_stride = batch->map->occluders.stride;
    return b;
}

/* What so many boxes need of slopes is on its way from memory. */
#define BOXES_AHEAD 8

/* Room behind lists of fragments, for whole vectors and what is asked for ahead. */
#define LIST_MARGIN (SHB_LANES + BOXES_AHEAD)

static inline ALWAYS_INLINE void fill_list(uint16_t *fragments, size_t count) {
    for (size_t k = 0; k < LIST_MARGIN; k++)
        fragments[count + k] = fragments[count - 1];
}

static inline ALWAYS_INLINE void prefetch_slopes(const box_batch *batch, size_t i, int n) {
    const texel_box b = exact_box_in_place(batch, i);
    for (int row = 0; row < n; row++)
        __builtin_prefetch(b.occluders + (size_t)row * b.occluder_stride);
}

static inline ALWAYS_INLINE void prefetch_own_slopes(const box_batch *batch, size_t i) {
    const shb_receivers *r = batch->receivers;
    __builtin_prefetch(shb_occluder_row(batch->map, r->texel_y[i]) + r->texel_x[i]);
}

/* What the map holds at a fragment. */
typedef struct own_texel {
    float stored;
    uint32_t slopes;
} own_texel;

static inline ALWAYS_INLINE own_texel own_texel_of(const texel_box *b, bool reversed) {
    const size_t column = (size_t)-b->column, row = (size_t)-b->row;
    own_texel own;
    float depth;
    memcpy(&depth, b->texels + column * sizeof depth + row * b->stride, sizeof depth);
    own.stored = reversed ? -depth : depth;
    memcpy(&own.slopes, b->occluders + column * sizeof own.slopes + row * b->occluder_stride,
           sizeof own.slopes);
    return own;
}

/* Numbers of WIDE fragments. */
typedef struct standing {
    float z[WIDE], step_x[WIDE], step_y[WIDE], to_x[WIDE], to_y[WIDE], error[WIDE];
    float base[WIDE], moved_x[WIDE], moved_y[WIDE], stored[WIDE];
    uint32_t slopes[WIDE];
} standing;

/* Whether fragments that their own texels do not shadow stand on what these hold, a bit each: not
 * if they lie before the texel's plane at their own place, and their own plane does at the centre.
 * boxes: numbers of count fragments and their texels. */
static inline ALWAYS_INLINE uint32_t stand_on_own_texels(const mutual_batch *mutual,
                                                         const uint16_t *fragments,
                                                         const own_texel *own,
                                                         const uint16_t *boxes, size_t count) {
    const shb_receivers *r = &mutual->receivers;
    const shb_map_info *info = &mutual->map->info;
    standing s;
    for (size_t lane = 0; lane < WIDE; lane++) {
        const size_t box = boxes[lane < count ? lane : 0], i = fragments[box];
        s.z[lane] = r->depth[i];
        s.step_x[lane] = r->step_x[i];
        s.step_y[lane] = r->step_y[i];
        s.to_x[lane] = r->to_center_x[i];
        s.to_y[lane] = r->to_center_y[i];
        s.error[lane] = mutual->error[i] + mutual->slope_error[i];
        s.base[lane] = mutual->base[i];
        s.moved_x[lane] = mutual->moved_x[i];
        s.moved_y[lane] = mutual->moved_y[i];
        s.stored[lane] = own[box].stored;
        s.slopes[lane] = own[box].slopes;
    }
    const texel_slopes slopes = slopes_of_texels(vu_load(s.slopes), step_unit(mutual->map));
    const vf stored = vf_load(s.stored), z = vf_load(s.z);
    const vf to_x = vf_load(s.to_x), to_y = vf_load(s.to_y);
    const vf own_rise = vf_load(s.step_x) * to_x + vf_load(s.step_y) * to_y;
    const vf occluder_rise = slopes.x * to_x + slopes.y * to_y;
    const float step = shb_format_step(info->format);
    const vf error = vf_load(s.error) + (SHEET_DEPTH_ERROR * (vf_abs(z) + vf_abs(stored)) + step);
    const vf occluder_error =
        (vf_load(s.base) + step) +
        ((vf_abs(slopes.x) * vf_load(s.moved_x) + vf_abs(slopes.y) * vf_load(s.moved_y)) +
         slopes.error);
    const vf behind = stored - (z + own_rise), behind_at_fragment = (stored - occluder_rise) - z;
    return vi_bits((stored < shb_far_depth(info->view.reversed)) &
                   ~((behind > error) & (behind_at_fragment > occluder_error)));
}

/* Leaves those of a list of boxes whose fragments stand on their own texels. */
static size_t keep_standing(const mutual_batch *mutual, const uint16_t *fragments,
                            const own_texel *own, uint16_t *boxes, size_t count) {
    size_t kept = 0;
    for (size_t k = 0; k < count; k += WIDE) {
        const size_t lanes = count - k < WIDE ? count - k : WIDE;
        const uint32_t stands = stand_on_own_texels(mutual, fragments, own, boxes + k, lanes);
        for (size_t lane = 0; lane < lanes; lane++) {
            boxes[kept] = boxes[k + lane];
            kept += stands >> lane & 1;
        }
    }
    return kept;
}

/* Boxes with more texels in a row are followed over sheets before slopes are asked: most of what
 * lies in front is on the sheet. Smaller ones are asked in less time than they are followed. */
#define SLOPES_FIRST 8

/* Puts boxes in place first whose own texels lie before the fragments' planes: there most of what
 * lies in front shadows, and where these are many so it does in others. Returns for how many slopes
 * are to be asked before sheets. Not more than SHB_BATCH. */
static size_t put_hidden_first(const box_batch *batch, uint16_t *fragments, size_t count,
                               bool reversed) {
    const shb_receivers *r = batch->receivers;
    const char *texels = batch->map->depth.texels;
    const size_t stride = batch->map->depth.stride;
    uint16_t others[SHB_BATCH];
    size_t hidden = 0, left = 0;
    for (size_t k = 0; k < count; k++) {
        const uint16_t i = fragments[k];
        const float *row = (const float *)(const void *)(texels + (size_t)r->texel_y[i] * stride);
        const float depth = row[r->texel_x[i]];
        const bool is_hidden = (reversed ? -depth : depth) < r->ref[i];
        fragments[hidden] = others[left] = i;
        hidden += is_hidden;
        left += !is_hidden;
    }
    memcpy(fragments + hidden, others, left * sizeof *others);
    return 3 * hidden > count ? count : hidden;
}

/* Bits of the rows that hold boxes of n texels in a row. */
static inline ALWAYS_INLINE int row_bits_of(int n) {
    return n <= 16 ? 16 : n <= 32 ? 32 : 64;
}

#define ROW_BITS 16
#include "k_box_rows.inl"
#undef ROW_BITS
#define ROW_BITS 32
#include "k_box_rows.inl"
#undef ROW_BITS
#define ROW_BITS 64
#include "k_box_rows.inl"
#undef ROW_BITS

/* Fragments in place that their own planes do not light in all taps; room for more of them. */
static size_t list_open_boxes(const box_batch *batch, size_t count, const float *visibility,
                              uint16_t *fragments) {
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        fragments[found] = (uint16_t)i;
        found += (batch->place[i] >= 0) & (visibility[i] != 1);
    }
    return found;
}

/* Takes the fragments with boxes of n texels in a row out of the list. */
static size_t list_of_size(const box_batch *batch, int n, uint16_t *open, size_t *open_count,
                           uint16_t *fragments) {
    size_t found = 0, left = 0;
    if (batch->same_size) {
        memcpy(fragments, open, *open_count * sizeof *open);
        found = *open_count;
        *open_count = 0;
        return found;
    }
    for (size_t k = 0; k < *open_count; k++) {
        const uint16_t i = open[k];
        fragments[found] = open[left] = i;
        found += batch->size[i] == n;
        left += batch->size[i] != n;
    }
    *open_count = left;
    return found;
}

/* Fragments and more to fill the vectors. */
static NEVER_INLINE void ask_listed(const box_batch *batch, bool smooth, uint16_t *fragments,
                                    size_t count, int n, bool reversed, float *visibility) {
    if (n <= 16 && reversed)
        ask_listed16(batch, smooth, fragments, count, n, true, visibility);
    else if (n <= 16)
        ask_listed16(batch, smooth, fragments, count, n, false, visibility);
    else if (n <= 32)
        ask_listed32(batch, smooth, fragments, count, n, reversed, visibility);
    else
        ask_listed64(batch, smooth, fragments, count, n, reversed, visibility);
}

static void ask_open_boxes(const box_batch *batch, bool smooth, size_t count, float *visibility) {
    uint16_t open[SHB_BATCH + 1], fragments[SHB_BATCH + LIST_MARGIN];
    size_t left = list_open_boxes(batch, count, visibility, open);
    while (left) {
        const int n = batch->size[open[0]];
        const size_t found = list_of_size(batch, n, open, &left, fragments);
        fill_list(fragments, found);
        ask_listed(batch, smooth, fragments, found, n, batch->reversed, visibility);
    }
}

/* Boxes whose texels all lie behind the fragment's plane are lit. */
static void ask_plane_boxes(box_batch *batch, bool smooth, size_t count, float *visibility) {
    count_inside(batch, count, visibility);
    ask_open_boxes(batch, smooth, count, visibility);
    if (batch->all_inside)
        return;
    ask_copies16(batch, smooth, count, visibility);
    ask_copies32(batch, smooth, count, visibility);
    ask_copies64(batch, smooth, count, visibility);
}
