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

/* Corners from vertices, two lanes at a time. */
static inline void gather_corners(const shb_list_vertex *vertices,
                                  const uint32_t *const corners[LIST_LANES],
                                  shb_list_corners *restrict out) {
    typedef double list_pair __attribute__((vector_size(16), may_alias));
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LIST_LANES; i += 2) {
            const list_pair *a = (const list_pair *)&vertices[corners[i][k]];
            const list_pair *b = (const list_pair *)&vertices[corners[i + 1][k]];
            *(list_pair *)&out->x[k][i] = __builtin_shufflevector(a[0], b[0], 0, 2);
            *(list_pair *)&out->y[k][i] = __builtin_shufflevector(a[0], b[0], 1, 3);
            *(list_pair *)&out->z[k][i] = __builtin_shufflevector(a[1], b[1], 0, 2);
            *(list_pair *)&out->inverse_w[k][i] = __builtin_shufflevector(a[1], b[1], 1, 3);
        }
}

/* Lanes with a corner in front of the near plane or too near to the light's own. */
static uint32_t find_cut(const shb_list_frame *frame, const shb_list_corners *restrict c) {
    const wd least = wd_splat(0x1p-4 / frame->errors[3]), none = wd_splat(0);
    uint32_t cut = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < LIST_LANES; i += DOUBLES) {
            const wd inverse = wd_load(c->inverse_w[k] + i);
            const uint32_t whole = wd_greater_bits(inverse, none) & wd_greater_bits(least, inverse);
            cut |= (~whole & ((1u << DOUBLES) - 1)) << i;
        }
    return cut;
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

static uint32_t prepare_triangles(const shb_list_frame *frame, const shb_list_vertex *vertices,
                                  const uint32_t *const corners[LIST_LANES],
                                  shb_list_triangle triangles[LIST_LANES],
                                  shb_list_box boxes[LIST_LANES]) {
    shb_list_corners c;
    list_spread spread;
    prepared made;
    gather_corners(vertices, corners, &c);
    bound_triangles(frame, &c, &spread, &made);
    prepare_planes(frame, &c, &spread, &made);
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
    return find_cut(frame, &c);
}

/* Linear functions over a tile, from its corner: the weights at the best corner of a cell, which
 * are negative where the triangle misses the cell for sure; what their worst corner has less; and
 * depths at which the triangle begins and ends in a cell. */
typedef struct cell_functions {
    float x[3], y[3], best[3], worst[3];
    float slope_x, slope_y, begin, end;
    float nearest;
} cell_functions;

static inline cell_functions cell_functions_of(const shb_list_cover *cover, uint32_t number,
                                               float nearest) {
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
    f.nearest = nearest;
    return f;
}

static inline uint32_t first_block(uint32_t texel, uint32_t tile, int bits) {
    return (texel > tile ? texel - tile : 0) >> bits;
}

static inline uint32_t last_block(uint32_t texel, uint32_t tile, int bits) {
    const uint32_t last = texel - tile;
    return (last < SHB_LIST_TILE ? last : SHB_LIST_TILE - 1) >> bits;
}

/* Blocks of a row that have cells which do not hide a depth, one bit each. */
static inline uint32_t open_blocks(const shb_list_cover *cover, uint32_t row, float depth) {
    const float *farthest = cover->farthest + (size_t)row * SHB_LIST_BLOCKS;
    uint32_t hidden = 0;
    for (int i = 0; i < SHB_LIST_BLOCKS; i += WIDE)
        hidden |= vi_bits(depth > vf_load(farthest + i)) << i;
    return ~hidden;
}

static inline float largest_of_block(const float *values) {
#if WIDE == 16
    return _mm512_reduce_max_ps(_mm512_loadu_ps(values));
#else
    vf most = vf_load(values);
    for (int i = WIDE; i < LIST_LANES; i += WIDE)
        most = vf_max(most, vf_load(values + i));
    float largest = most[0];
    for (int i = 1; i < WIDE; i++)
        largest = list_maxf(largest, most[i]);
    return largest;
#endif
}

/* The cells of a block that a triangle goes into, one bit each, and the least depth of the triangle
 * in each. */
static inline uint32_t cover_block(const shb_list_cover *cover, const cell_functions *f,
                                   uint32_t column, uint32_t row, shb_list_block *block,
                                   float begins[LIST_LANES]) {
    static const SHB_ALIGN float lane_x[LIST_LANES] = {0, 1, 2, 3, 0, 1, 2, 3,
                                                       0, 1, 2, 3, 0, 1, 2, 3};
    static const SHB_ALIGN float lane_y[LIST_LANES] = {0, 0, 0, 0, 1, 1, 1, 1,
                                                       2, 2, 2, 2, 3, 3, 3, 3};
    const float left = (float)(int32_t)(column << (cover->cell_bits + 2));
    const float top = (float)(int32_t)(row << (cover->cell_bits + 2));
    const float size = (float)(1 << cover->cell_bits);
    float *far = block->far;
    int32_t *counts = block->counts;
    uint32_t bits = 0;
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vf x = left + size * vf_load(lane_x + i), y = top + size * vf_load(lane_y + i);
        const vf u = (f->x[0] * x + f->y[0] * y) + f->best[0];
        const vf v = (f->x[1] * x + f->y[1] * y) + f->best[1];
        const vf w = (f->x[2] * x + f->y[2] * y) + f->best[2];
        const vf depth = f->slope_x * x + f->slope_y * y;
        const vf begin = vf_max(depth + f->begin, vf_splat(f->nearest)), end = depth + f->end;
        const vf before = vf_load(far + i);
        const vf most = vf_min(vf_min(u, v), w);
        const vf least = vf_min(vf_min(u + f->worst[0], v + f->worst[1]), w + f->worst[2]);
        const vi enters = (most >= 0) & (begin <= before), hidden = (least >= 0) & (end < before);
        vf_store(begins + i, begin);
        vi_store(counts + i, vi_load(counts + i) - enters);
        bits |= vi_bits(enters) << i;
        vf_store(far + i, vf_where(hidden, end, before));
    }
    return bits;
}

/* Appends entries of a block's cells; the room for all of them is there. Returns how many. */
static inline size_t append_entries(const shb_list_unsorted *entries, size_t end, uint32_t number,
                                    uint32_t cell, uint32_t bits, const float *begins) {
#if WIDE == 16
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    const __m512i cells = _mm512_add_epi32(lanes, _mm512_set1_epi32((int32_t)cell));
    _mm512_storeu_si512(entries->cells + end, _mm512_maskz_compress_epi32((__mmask16)bits, cells));
    _mm512_storeu_ps(entries->begins + end,
                     _mm512_maskz_compress_ps((__mmask16)bits, _mm512_loadu_ps(begins)));
    _mm512_storeu_si512(entries->triangles + end, _mm512_set1_epi32((int32_t)number));
    return (size_t)__builtin_popcount(bits);
#else
    size_t count = end;
    for (; bits; bits &= bits - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(bits);
        entries->triangles[count] = number;
        entries->begins[count] = begins[lane];
        entries->cells[count++] = cell + lane;
    }
    return count - end;
#endif
}

/* Where a triangle lies in a tile, in blocks. */
typedef struct list_blocks {
    uint32_t columns; /* one bit each */
    uint32_t first_row, last_row;
} list_blocks;

static inline list_blocks blocks_of(const shb_list_cover *cover, const shb_list_box *box) {
    const int bits = cover->cell_bits + 2; /* texels of a block's side */
    const uint32_t first_column = first_block(box->first_column, cover->column, bits);
    const uint32_t last_column = last_block(box->last_column, cover->column, bits);
    return (list_blocks){(2u << last_column) - (1u << first_column),
                         first_block(box->first_row, cover->row, bits),
                         last_block(box->last_row, cover->row, bits)};
}

/* True if all cells of all blocks that a triangle reaches hide it. */
static inline bool is_hidden(const shb_list_cover *cover, const list_blocks *blocks,
                             float nearest) {
    uint32_t open = 0;
    for (uint32_t row = blocks->first_row; row <= blocks->last_row; row++)
        open |= open_blocks(cover, row, nearest);
    return !(open & blocks->columns);
}

static inline void cover_blocks(shb_list_cover *cover, const list_blocks *blocks, bool hides,
                                uint32_t number, const cell_functions *f) {
    SHB_ALIGN float begins[LIST_LANES];
    size_t count = cover->entries.count;
    for (uint32_t row = blocks->first_row; row <= blocks->last_row; row++) {
        uint32_t open = blocks->columns;
        if (hides)
            open &= open_blocks(cover, row, f->nearest);
        for (; open; open &= open - 1) {
            const uint32_t column = (uint32_t)__builtin_ctz(open);
            const uint32_t block = row * (SHB_LIST_BLOCKS >> cover->cell_bits) + column;
            const uint32_t cell = block * LIST_LANES;
            const uint32_t bits = cover_block(cover, f, column, row, &cover->blocks[block], begins);
            count += append_entries(&cover->entries, count, number, cell, bits, begins);
        }
    }
    cover->entries.count = count;
}

/* Finds how far the cells of each block let triangles be seen; true if some block hides any. */
static bool find_farthest(shb_list_cover *cover) {
    const uint32_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    bool hides = false;
    for (uint32_t row = 0; row < blocks; row++)
        for (uint32_t column = 0; column < blocks; column++) {
            const float farthest = largest_of_block(cover->blocks[row * blocks + column].far);
            cover->farthest[row * SHB_LIST_BLOCKS + column] = farthest;
            hides |= farthest < HUGE_VALF;
        }
    return hides;
}

/* LIST_AHEAD: triangles that are fetched before they are used; LIST_SPELL: triangles after which
 * blocks are looked at anew. */
enum { LIST_AHEAD = 8, LIST_SPELL = 128 };

static bool cover_cells(shb_list_cover *cover) {
    const size_t blocks = SHB_LIST_BLOCKS >> cover->cell_bits;
    const size_t room = (blocks * blocks + 1) * LIST_LANES; /* for one triangle */
    bool hides = false;
    for (size_t k = 0; k < cover->count; k++) {
        if (k + LIST_AHEAD < cover->count)
            __builtin_prefetch(&cover->triangles[(uint32_t)cover->keys[k + LIST_AHEAD]]);
        if (cover->entries.capacity - cover->entries.count < room)
            return false;
        if (k % LIST_SPELL == LIST_SPELL - 1)
            hides = find_farthest(cover);
        const uint32_t number = (uint32_t)cover->keys[k];
        const float nearest =
            (float)shb_list_level_depth(cover->frame, (double)(cover->keys[k] >> 32));
        const list_blocks reached = blocks_of(cover, &cover->boxes[number]);
        if (hides && is_hidden(cover, &reached, nearest))
            continue;
        const cell_functions f = cell_functions_of(cover, number, nearest);
        cover_blocks(cover, &reached, hides, number, &f);
    }
    return true;
}

#include "k_list_ask.inl"

const shb_list_kernels LIST_KERNELS = {prepare_triangles, cover_cells, locate_points, take_entries,
                                       answer_questions};
