/* The loops of building lists and asking them for one instruction set: plain loops over lanes,
 * which the compiler makes vectors of. The including file has chosen the target and defined
 * LIST_KERNELS, the name of the table.
 *
 * Bounds. Let d bound the rounding of a corner's and of a point's X and Y together, and L the sizes
 * of the triangle's box. Twice the area of the triangle is then known within 2 d L, and so is the
 * part of it that is a weight times the area at a point in or near the box. While the area is known
 * to a half, a weight is off by no more than 6 d L / area; and where the area is not known at all a
 * point inside has no weight below -6 d L / area either. Elements rounded to floats, and
 * cells that are asked in floats, add 2^-21 (1 + sum of sizes): X, Y, two products and sums each,
 * and the first weight is 1 less two others.
 *
 * The plane's distance at a point of weights b_k moves by sum b_k (dz + |slope x| dx + |slope y|
 * dy) with its corners and by as much with the point, as long as the area is known well. Rounding
 * of the slopes: the area carries its two products' sizes, hence `condition`. */

#include <float.h>
#include <math.h>

#include "lists.h"
#include "vectors.h"

enum { LIST_LANES = SHB_LIST_LANES };

/* A bound of a depth in float, not below the value. */
#define ROUNDED_UP(value) ((float)((value) * (1 + 0x1p-22)))

static inline double list_min(double a, double b) {
    return a < b ? a : b;
}

static inline double list_max(double a, double b) {
    return a > b ? a : b;
}

static inline float list_minf(float a, float b) {
    return a < b ? a : b;
}

static inline float list_maxf(float a, float b) {
    return a > b ? a : b;
}

/* The results of prepare, lane by lane. */
typedef struct prepared {
    SHB_ALIGN double plane[3][LIST_LANES];
    float u[3][LIST_LANES], v[3][LIST_LANES], rest[LIST_LANES];
    float margin[LIST_LANES], bound[LIST_LANES], clear[LIST_LANES];
    int32_t first_column[LIST_LANES], first_row[LIST_LANES];
    int32_t last_column[LIST_LANES], last_row[LIST_LANES], level[LIST_LANES];
} prepared;

/* Outward bounds of what a triangle's corners are off by. */
typedef struct list_spread {
    SHB_ALIGN double x[LIST_LANES];
    double y[LIST_LANES], z[LIST_LANES];
    double width[LIST_LANES], height[LIST_LANES]; /* of the box, and a texel */
    double inverse_w[LIST_LANES];                 /* the largest */
} list_spread;

static void bound_triangles(const shb_list_frame *frame, const shb_list_corners *restrict c,
                            list_spread *restrict spread, prepared *restrict out) {
    const double width = frame->width, height = frame->height;
    const double *e = frame->errors;
    for (int i = 0; i < LIST_LANES; i++) {
        const double inverse =
            list_max(list_max(c->inverse_w[0][i], c->inverse_w[1][i]), c->inverse_w[2][i]);
        const double lo_x = list_min(list_min(c->x[0][i], c->x[1][i]), c->x[2][i]);
        const double hi_x = list_max(list_max(c->x[0][i], c->x[1][i]), c->x[2][i]);
        const double lo_y = list_min(list_min(c->y[0][i], c->y[1][i]), c->y[2][i]);
        const double hi_y = list_max(list_max(c->y[0][i], c->y[1][i]), c->y[2][i]);
        const double lo_z = list_min(list_min(c->z[0][i], c->z[1][i]), c->z[2][i]);
        const double hi_z = list_max(list_max(c->z[0][i], c->z[1][i]), c->z[2][i]);
        const double far_x = list_max(list_max(-lo_x, hi_x), width);
        const double far_y = list_max(list_max(-lo_y, hi_y), height);
        const double far_z = list_max(-lo_z, hi_z);
        const double x = (e[0] + far_x * e[3]) * inverse, y = (e[1] + far_y * e[3]) * inverse;
        const double z = (e[2] + far_z * e[3]) * inverse;
        spread->inverse_w[i] = inverse;
        spread->x[i] = x;
        spread->y[i] = y;
        spread->z[i] = z;
        spread->width[i] = hi_x - lo_x + 1;
        spread->height[i] = hi_y - lo_y + 1;
        const int seen = (hi_x + 4 * x >= 0) & (lo_x - 4 * x <= width) & (hi_y + 4 * y >= 0) &
                         (lo_y - 4 * y <= height);
        out->first_column[i] = (int32_t)list_min(list_max(lo_x - 4 * x, 0), width - 1);
        out->last_column[i] = (int32_t)list_min(list_max(hi_x + 4 * x, 0), width - 1);
        out->first_row[i] = seen ? (int32_t)list_min(list_max(lo_y - 4 * y, 0), height - 1) : 1;
        out->last_row[i] = seen ? (int32_t)list_min(list_max(hi_y + 4 * y, 0), height - 1) : 0;
        const double level = ((lo_z - 4 * z) - frame->level_origin) * frame->levels;
        out->level[i] = (int32_t)list_min(list_max(level, 0), SHB_LIST_LEVELS - 1);
    }
}

static void prepare_planes(const shb_list_frame *frame, const shb_list_corners *restrict c,
                           const list_spread *restrict spread, prepared *restrict out) {
    const double width = frame->width, height = frame->height, reach = frame->reach;
    double rows[4][3];
    memcpy(rows[0], frame->rows[0], sizeof rows[0]);
    memcpy(rows[1], frame->rows[1], sizeof rows[1]);
    memcpy(rows[2], frame->rows[2], sizeof rows[2]);
    memcpy(rows[3], frame->rows[3], sizeof rows[3]);
    for (int i = 0; i < LIST_LANES; i++) {
        const double x0 = c->x[0][i], y0 = c->y[0][i], z0 = c->z[0][i];
        const double x1 = c->x[1][i] - x0, y1 = c->y[1][i] - y0, z1 = c->z[1][i] - z0;
        const double x2 = c->x[2][i] - x0, y2 = c->y[2][i] - y0, z2 = c->z[2][i] - z0;
        const double area = x1 * y2 - x2 * y1, size = fabs(x1 * y2) + fabs(x2 * y1);
        const int flat = !(fabs(area) > 0x1p-64);
        const double inverse = flat ? 0x1p64 : 1 / area, scale = fabs(inverse);
        const double ux = y2 * inverse, uy = -x2 * inverse;
        const double vx = -y1 * inverse, vy = x1 * inverse;
        const double u_one = -(ux * x0 + uy * y0), v_one = -(vx * x0 + vy * y0);
        const double sizes = ((fabs(ux) + fabs(vx)) * width + (fabs(uy) + fabs(vy)) * height) +
                             (fabs(u_one) + fabs(v_one));
        const double off =
            (spread->x[i] + spread->y[i]) * (spread->width[i] + spread->height[i]) * scale;
        const double margin = 12 * off + 0x1p-21 * (1 + sizes) + (flat ? 2.0 : 0.0);
        const double slope_x = ux * z1 + vx * z2, slope_y = uy * z1 + vy * z2;
        const double condition = 1 + size * scale;
        const double rounding_x = (fabs(y2 * z1) + fabs(y1 * z2)) * scale * condition;
        const double rounding_y = (fabs(x2 * z1) + fabs(x1 * z2)) * scale * condition;
        const double moved =
            spread->z[i] + fabs(slope_x) * spread->x[i] + fabs(slope_y) * spread->y[i];
        const double evaluated = fabs(slope_x) * (width + fabs(x0)) +
                                 fabs(slope_y) * (height + fabs(y0)) + fabs(z0) + fabs(z1) +
                                 fabs(z2);
        const double rounding = rounding_x * spread->width[i] + rounding_y * spread->height[i];
        const double bound = (3 + 12 * margin) * moved + 0x1p-50 * (rounding + evaluated);
        const double one = z0 - (slope_x * x0 + slope_y * y0);
        double change = 0;
        for (int k = 0; k < 3; k++)
            change += fabs((rows[2][k] - slope_x * rows[0][k]) -
                           (slope_y * rows[1][k] + one * rows[3][k]));
        const double clear = bound + 0x1.01p-24 * change * reach * spread->inverse_w[i];
        const int known = (off < 0x1p-10) & !flat & (clear < 0x1p100);
        out->plane[0][i] = known ? -slope_x : 0.0;
        out->plane[1][i] = known ? -slope_y : 0.0;
        out->plane[2][i] = known ? -one : 0.0;
        out->bound[i] = known ? ROUNDED_UP(bound) : HUGE_VALF;
        out->clear[i] = known ? ROUNDED_UP(clear) : HUGE_VALF;
        const int usable = margin < 0x1p90;
        out->u[0][i] = usable ? (float)ux : 0.0f;
        out->u[1][i] = usable ? (float)uy : 0.0f;
        out->u[2][i] = usable ? (float)(u_one + margin) : 0.0f;
        out->v[0][i] = usable ? (float)vx : 0.0f;
        out->v[1][i] = usable ? (float)vy : 0.0f;
        out->v[2][i] = usable ? (float)(v_one + margin) : 0.0f;
        out->rest[i] = usable ? ROUNDED_UP(1 + 3 * margin) : HUGE_VALF;
        out->margin[i] = usable ? ROUNDED_UP(margin) : HUGE_VALF;
    }
}

static void prepare_triangles(const shb_list_frame *frame, const shb_list_corners *corners,
                              shb_list_triangle triangles[LIST_LANES],
                              shb_list_box boxes[LIST_LANES]) {
    list_spread spread;
    prepared made;
    bound_triangles(frame, corners, &spread, &made);
    prepare_planes(frame, corners, &spread, &made);
    for (int i = 0; i < LIST_LANES; i++) {
        triangles[i] = (shb_list_triangle){
            .plane = {made.plane[0][i], made.plane[1][i], made.plane[2][i]},
            .u = {made.u[0][i], made.u[1][i], made.u[2][i]},
            .v = {made.v[0][i], made.v[1][i], made.v[2][i]},
            .rest = made.rest[i],
            .margin = made.margin[i],
            .bound = made.bound[i],
            .clear = made.clear[i],
        };
        boxes[i] = (shb_list_box){(uint16_t)made.first_column[i], (uint16_t)made.first_row[i],
                                  (uint16_t)made.last_column[i], (uint16_t)made.last_row[i],
                                  (uint16_t)made.level[i]};
    }
}

/* Linear functions over a tile, from its corner: the weights at the best corner of a cell, which
 * are negative where the triangle misses the cell for sure; what their worst corner has less; and
 * depths at which the triangle begins and ends in a cell. */
typedef struct cell_functions {
    float x[3], y[3], best[3], worst[3];
    float slope_x, slope_y, begin, end;
    float nearest;
} cell_functions;

static inline cell_functions cell_functions_of(const shb_list_cover *cover, uint32_t number) {
    const shb_list_triangle *t = &cover->triangles[number];
    const float column = (float)cover->column, row = (float)cover->row;
    const float size = (float)(1 << cover->cell_bits);
    const float weights[3][3] = {{-(t->u[0] + t->v[0]), -(t->u[1] + t->v[1]), 0},
                                 {t->u[0], t->u[1], t->u[2]},
                                 {t->v[0], t->v[1], t->v[2]}};
    cell_functions f;
    for (int k = 0; k < 3; k++) {
        const float x = weights[k][0], y = weights[k][1];
        const float first = k ? weights[k][2] : (t->rest - t->u[2]) - t->v[2];
        const float one = ((x * column + y * row) + first) + t->margin;
        f.x[k] = x;
        f.y[k] = y;
        f.best[k] = one + size * (list_maxf(x, 0) + list_maxf(y, 0));
        f.worst[k] = -size * (fabsf(x) + fabsf(y)) - 4 * t->margin;
    }
    const double depth = -shb_list_behind(t, (double)cover->column, (double)cover->row, 0);
    const float z = (float)depth, x = (float)-t->plane[0], y = (float)-t->plane[1];
    const float rounding = 0x1p-21f * (fabsf(z) + SHB_LIST_TILE * (fabsf(x) + fabsf(y)));
    f.slope_x = x;
    f.slope_y = y;
    f.begin = z + size * (list_minf(x, 0) + list_minf(y, 0)) - rounding - t->bound;
    f.end = z + size * (list_maxf(x, 0) + list_maxf(y, 0)) + rounding + t->clear;
    f.nearest = (float)shb_list_level_depth(cover->frame, (double)cover->boxes[number].level);
    return f;
}

/* The cells of a block that a triangle goes into, one bit each, and the least depth of the triangle
 * in each; x, y: the block's corner. */
static inline uint32_t cover_block(const cell_functions *f, float x, float y,
                                   const float *restrict lane_x, const float *restrict lane_y,
                                   float *restrict far, float *restrict begins) {
    uint32_t bits = 0;
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf at_x = x + vf_load(lane_x + i), at_y = y + vf_load(lane_y + i);
        const vf u = (f->x[0] * at_x + f->y[0] * at_y) + f->best[0];
        const vf v = (f->x[1] * at_x + f->y[1] * at_y) + f->best[1];
        const vf w = (f->x[2] * at_x + f->y[2] * at_y) + f->best[2];
        const vf depth = f->slope_x * at_x + f->slope_y * at_y;
        const vf begin = vf_max(depth + f->begin, vf_splat(f->nearest)), end = depth + f->end;
        const vf before = vf_load(far + i);
        const vf most = vf_min(vf_min(u, v), w);
        const vf least = vf_min(vf_min(u + f->worst[0], v + f->worst[1]), w + f->worst[2]);
        bits |= vi_bits((most >= 0) & (begin <= before)) << i;
        vf_store(begins + i, begin);
        vf_store(far + i, vf_where((least >= 0) & (end < before), end, before));
    }
    return bits;
}

/* Appends entries of a block's cells; the room for all of them is there. Returns how many. */
static inline size_t append_entries(uint32_t number, uint32_t cell, uint32_t bits,
                                    const float *begins, shb_list_entry *entries, uint32_t *cells) {
#if WIDE == 16
    const __m512i id = _mm512_set1_epi64(number);
    const __m512i depths = _mm512_loadu_si512(begins);
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i low = _mm512_cvtepu32_epi64(_mm512_castsi512_si256(depths));
    const __m512i high = _mm512_cvtepu32_epi64(_mm512_extracti64x4_epi64(depths, 1));
    const size_t half = (size_t)__builtin_popcount(bits & 0xff);
    _mm512_storeu_si512(
        entries, _mm512_maskz_compress_epi64((__mmask8)bits,
                                             _mm512_or_si512(_mm512_slli_epi64(low, 32), id)));
    _mm512_storeu_si512(entries + half, _mm512_maskz_compress_epi64(
                                            (__mmask8)(bits >> 8),
                                            _mm512_or_si512(_mm512_slli_epi64(high, 32), id)));
    _mm512_storeu_si512(
        cells, _mm512_maskz_compress_epi32(
                   (__mmask16)bits, _mm512_add_epi32(lanes, _mm512_set1_epi32((int32_t)cell))));
    return (size_t)__builtin_popcount(bits);
#else
    size_t count = 0;
    for (; bits; bits &= bits - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(bits);
        entries[count] = (shb_list_entry){number, begins[lane]};
        cells[count++] = cell + lane;
    }
    return count;
#endif
}

static inline uint32_t first_block(uint32_t texel, uint32_t tile, int bits) {
    return (texel > tile ? texel - tile : 0) >> bits;
}

static inline uint32_t last_block(uint32_t texel, uint32_t tile, int bits) {
    const uint32_t last = texel - tile;
    return (last < SHB_LIST_TILE ? last : SHB_LIST_TILE - 1) >> bits;
}

/* Triangles that are fetched before they are used. */
enum { LIST_AHEAD = 8 };

static inline void fetch_triangle(const shb_list_cover *cover, uint32_t number) {
    __builtin_prefetch(&cover->triangles[number]);
}

static bool cover_cells(shb_list_cover *cover) {
    const int block_bits = cover->cell_bits + 2; /* texels of a block's side */
    const uint32_t blocks = SHB_LIST_TILE >> block_bits;
    float lane_x[LIST_LANES], lane_y[LIST_LANES];
    SHB_ALIGN float begins[LIST_LANES];
    for (int i = 0; i < LIST_LANES; i++) {
        lane_x[i] = (float)((i & 3) << cover->cell_bits);
        lane_y[i] = (float)((i >> 2) << cover->cell_bits);
    }
    size_t count = 0;
    for (size_t k = 0; k < cover->count; k++) {
        const uint32_t number = (uint32_t)cover->keys[k];
        if (k + LIST_AHEAD < cover->count)
            fetch_triangle(cover, (uint32_t)cover->keys[k + LIST_AHEAD]);
        if (cover->entry_capacity - count < (size_t)(blocks * blocks + 1) * LIST_LANES)
            return false;
        const shb_list_box *box = &cover->boxes[number];
        const cell_functions f = cell_functions_of(cover, number);
        const uint32_t last_column = last_block(box->last_column, cover->column, block_bits);
        const uint32_t last_row = last_block(box->last_row, cover->row, block_bits);
        for (uint32_t y = first_block(box->first_row, cover->row, block_bits); y <= last_row; y++)
            for (uint32_t x = first_block(box->first_column, cover->column, block_bits);
                 x <= last_column; x++) {
                const uint32_t cell = (y * blocks + x) * LIST_LANES;
                const uint32_t bits =
                    cover_block(&f, (float)(x << block_bits), (float)(y << block_bits), lane_x,
                                lane_y, &cover->far[cell], begins);
                count += append_entries(number, cell, bits, begins, cover->entries + count,
                                        cover->cells + count);
            }
    }
    cover->entry_count = count;
    return true;
}

#include "k_list_ask.inl"

const shb_list_kernels LIST_KERNELS = {prepare_triangles, cover_cells, locate_points, take_entries,
                                       answer_questions};
