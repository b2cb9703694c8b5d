/* The loops of front sheets for one instruction set: plain loops over lanes, which the compiler
 * makes vectors of. The including file has chosen the target and defined SHEET_KERNELS, the name of
 * the table. */

#include "min_max.h"
#include "sheets.h"

#include <float.h>
#include <math.h>

enum { SHEET_LANES = SHB_LIST_LANES };

#include "k_sheet_triangles.inl"

/* One triangle over up to 16 texels of a row, from column x on. */
static inline void lay_row(const sheet_triangles *t, int n, bool ends, float x, float y,
                           int32_t left, float *restrict far, float *restrict front,
                           float *restrict next, int32_t *restrict state) {
    const float x0 = t->x[0][n], x1 = t->x[1][n], x2 = t->x[2][n], slope_x = t->slope_x[n];
    const float y0 = t->y[0][n] * y + t->one[0][n], y1 = t->y[1][n] * y + t->one[1][n];
    const float y2 = t->y[2][n] * y + t->one[2][n];
    const float depth = t->slope_y[n] * y + t->depth[n];
    const float aside0 = t->aside[0][n], aside1 = t->aside[1][n], aside2 = t->aside[2][n];
    const float touch = t->touch[n], inner = -t->inner[n], rise = t->rise[n];
    const float lo = t->lo[n], hi = t->hi[n];
    const float end0 = t->end[0][n], end1 = t->end[1][n], end2 = t->end[2][n];
    for (int i = 0; i < SHEET_LANES; i++) {
        const float at = x + (float)i;
        const float e0 = x0 * at + y0, e1 = x1 * at + y1, e2 = x2 * at + y2;
        const float nearest = float_min(float_min(e0, e1), e2);
        const float least = i < left ? nearest : -HUGE_VALF;
        const float z = slope_x * at + depth;
        const float begin = float_max(z - rise, lo), end = float_min(z + rise, hi);
        const float was_front = front[i], was_next = next[i], was_far = far[i];
        const int joins = (least >= -touch) & (begin <= was_front);
        const int waits = (least >= -touch) & (begin > was_front);
        const float counted = float_min(float_min(e0 + aside0, e1 + aside1), e2 + aside2);
        const int32_t covers = counted >= inner ? SHB_SHEET_COVERED : 0;
        int32_t added = covers;
        if (ends) {
            const int open = (fabsf(e0) <= end0) | (fabsf(e1) <= end1) | (fabsf(e2) <= end2);
            added = open ? SHB_SHEET_BROKEN : covers;
        }
        front[i] = (joins & (end > was_front)) ? end : was_front;
        next[i] = (waits & (begin < was_next)) ? begin : was_next;
        far[i] = ((least >= touch) & (end < was_far)) ? end : was_far;
        state[i] += joins ? added : 0;
    }
}

static void lay_triangle(shb_sheet_tile *tile, const sheet_triangles *t, int n, bool ends) {
    for (int32_t row = t->top[n]; row <= t->bottom[n]; row++)
        for (int32_t column = t->left[n]; column <= t->right[n]; column += SHEET_LANES) {
            const size_t at = (size_t)row * SHB_SHEET_PITCH + (size_t)column;
            lay_row(t, n, ends, (float)column, (float)row, t->right[n] - column + 1, tile->far + at,
                    tile->front + at, tile->next + at, tile->state + at);
        }
}

static void lay_triangles(shb_sheet_tile *tile, const shb_list_corners *corners,
                          const uint32_t ends[SHEET_LANES], uint32_t count) {
    sheet_triangles t;
    put_triangles(tile, corners, ends, &t);
    for (uint32_t n = 0; n < count; n++) {
        const bool any = (t.end[0][n] > 0) | (t.end[1][n] > 0) | (t.end[2][n] > 0);
        if (any)
            lay_triangle(tile, &t, (int)n, true);
        else
            lay_triangle(tile, &t, (int)n, false);
    }
}

/* Texels whose centre nothing covers are not whole. */
static void begin_tile_of(shb_sheet_tile *tile, float far_depth) {
    for (int32_t row = 0; row < SHB_SHEET_TILE; row++) {
        const size_t at = (size_t)row * SHB_SHEET_PITCH;
        const int32_t columns = row < tile->rows ? tile->columns : 0;
        float *restrict front = tile->front + at, *restrict next = tile->next + at;
        float *restrict far = tile->far + at;
        int32_t *restrict state = tile->state + at;
        for (int32_t i = columns; i < SHB_SHEET_PITCH; i++)
            front[i] = far_depth;
        for (int32_t i = 0; i < SHB_SHEET_PITCH; i++) {
            const int empty = front[i] >= far_depth;
            state[i] = empty ? SHB_SHEET_BROKEN : 0;
            front[i] = empty ? -HUGE_VALF : front[i];
            next[i] = HUGE_VALF;
            far[i] = HUGE_VALF;
        }
    }
}

static float farthest_front(const shb_sheet_tile *tile) {
    const float *restrict front = tile->front;
    SHB_ALIGN float lanes[SHEET_LANES];
    for (int i = 0; i < SHEET_LANES; i++)
        lanes[i] = -HUGE_VALF;
    for (size_t at = 0; at < SHB_SHEET_TILE * SHB_SHEET_PITCH; at += SHEET_LANES)
        for (int i = 0; i < SHEET_LANES; i++)
            lanes[i] = float_max(front[at + (size_t)i], lanes[i]);
    float farthest = lanes[0];
    for (int i = 1; i < SHEET_LANES; i++)
        farthest = float_max(lanes[i], farthest);
    return farthest;
}

/* Not below the value, by more than its last bit. */
static inline float sheet_raised(float value) {
    return (value + fabsf(value) * 0x1p-22f) + 0x1p-100f;
}

static void end_row(const shb_sheet_tile *tile, int32_t row, float *restrict bounds) {
    const size_t at = (size_t)row * SHB_SHEET_PITCH;
    const float *restrict front = tile->front + at, *restrict next = tile->next + at;
    const float *restrict far = tile->far + at;
    const int32_t *restrict state = tile->state + at;
    SHB_ALIGN float values[SHB_SHEET_TILE];
    SHB_ALIGN uint32_t bits[SHB_SHEET_TILE], whole[SHB_SHEET_TILE];
    for (int i = 0; i < SHB_SHEET_TILE; i++) {
        const float split = sheet_raised(front[i]), covered = sheet_raised(far[i]);
        const int is_whole = (state[i] == SHB_SHEET_COVERED) & (next[i] > sheet_raised(split));
        values[i] = is_whole ? split : covered;
        whole[i] = (uint32_t)is_whole;
    }
    memcpy(bits, values, sizeof bits);
    for (int i = 0; i < SHB_SHEET_TILE; i++)
        bits[i] = (bits[i] & ~1u) | whole[i];
    memcpy(bounds, bits, (size_t)tile->columns * sizeof *bounds);
}

static void ask_sheets(const shb_sheets *sheets, size_t count, const float *restrict px,
                       const float *restrict py, const float *restrict pz,
                       int32_t *restrict answers) {
    const shb_sheet_frame frame = sheets->frame;
    const shb_list_frame *f = &frame.list;
    const double width = sheets->width, height = sheets->height;
    const size_t lanes = shb_round_to_lanes(count);
    SHB_ALIGN double depths[SHB_BATCH];
    SHB_ALIGN int32_t column[SHB_BATCH], row[SHB_BATCH], known[SHB_BATCH];
    SHB_ALIGN float bounds[SHB_BATCH];
    for (size_t i = 0; i < lanes; i++) {
        const double x = (double)px[i], y = (double)py[i], z = (double)pz[i];
        const double w = shb_list_row(f->rows[3], x, y, z), inverse = 1 / w;
        const double at_x = shb_list_row(f->rows[0], x, y, z) * inverse;
        const double at_y = shb_list_row(f->rows[1], x, y, z) * inverse;
        const double depth = shb_list_row(f->rows[2], x, y, z) * inverse;
        const double size = double_max(double_max(fabs(x), fabs(y)), fabs(z));
        const int inside = (w >= frame.least_w) & (at_x >= 0) & (at_x < width) & (at_y >= 0) &
                           (at_y < height) & (size <= frame.reach) & (depth >= f->near_depth);
        depths[i] = depth;
        column[i] = (int32_t)(inside ? at_x : 0.0);
        row[i] = (int32_t)(inside ? at_y : 0.0);
        known[i] = inside;
    }
    for (size_t i = 0; i < lanes; i++)
        bounds[i] = sheets->bounds[(size_t)(uint32_t)row[i] * sheets->stride + (uint32_t)column[i]];
    int32_t whole[SHB_BATCH];
    memcpy(whole, bounds, lanes * sizeof *whole);
    for (size_t i = 0; i < lanes; i++) {
        const int behind = depths[i] > (double)bounds[i];
        const int32_t lit = whole[i] & 1 ? SHB_LIGHT_LIT : SHB_LIGHT_UNSURE;
        const int32_t answer = behind ? SHB_LIGHT_SHADOWED : lit;
        answers[i] = known[i] ? answer : SHB_LIGHT_UNSURE;
    }
}

const shb_sheet_kernels SHEET_KERNELS = {
    .look = look_at_triangles,
    .begin = begin_tile_of,
    .lay = lay_triangles,
    .farthest = farthest_front,
    .end = end_row,
    .ask = ask_sheets,
};
