/* Boxes of texels around fragments: percentage-closer filtering (Reeves, Salesin and Cook 1987). */

#include "../taps.h"

#define BOX_MAX 63

/* Floats in a row of a window: room for whole vectors. */
#define BOX_PITCH 64

/* Columns of a box counted from the one after its last, for boxes that begin at an element
 * BOX_PITCH - n; NaN beyond the box, which shadows nothing. */
static const float columns_from_end[2 * BOX_PITCH] = {
    -64, -63, -62, -61, -60, -59, -58, -57, -56, -55, -54, -53, -52, -51, -50, -49,
    -48, -47, -46, -45, -44, -43, -42, -41, -40, -39, -38, -37, -36, -35, -34, -33,
    -32, -31, -30, -29, -28, -27, -26, -25, -24, -23, -22, -21, -20, -19, -18, -17,
    -16, -15, -14, -13, -12, -11, -10, -9,  -8,  -7,  -6,  -5,  -4,  -3,  -2,  -1,
    NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN,
};

/* Where the depths of taps come from: one for all, the receiver plane, or an array. */
typedef enum tap_kind { TAPS_FLAT, TAPS_PLANE, TAPS_GIVEN } tap_kind;

/* A batch whose fragments ask boxes of texels. */
typedef struct box_batch {
    const shb_map *map;
    const shb_receivers *receivers;
    int32_t width, height;
    float far_stored; /* as the map stores it */
    bool reversed;
    bool direct; /* texels are floats: boxes inside the map are read where they are */
    tap_kind kind;
    float window[BOX_MAX * BOX_PITCH]; /* a copy of a box that cannot be read in place */
    float given[BOX_MAX * BOX_PITCH];  /* TAPS_GIVEN: depths of its taps, as the map stores depth */
    int32_t size[SHB_BATCH];           /* of the boxes */
    int32_t shadowed[SHB_BATCH];       /* taps */
    double lit[SHB_BATCH];             /* taps by weight */
} box_batch;

/* Where the texels of a box are, as floats, and which they are from the fragment's own one on. */
typedef struct box {
    const char *texels;
    size_t stride;
    int column, row; /* of the first */
} box;

/* The row from texel first on as floats, as they are stored. Products in double round to the same
 * floats as the quotients that define the formats. */
static void decode_texels(const shb_map *map, int32_t row, int32_t first, int32_t count,
                          float *restrict depths) {
    const char *texels = (const char *)map->depth.texels + (size_t)row * map->depth.stride;
    switch (map->info.format) {
    case SHB_FORMAT_FLOAT32:
        memcpy(depths, (const float *)(const void *)texels + first, (size_t)count * sizeof *depths);
        break;
    case SHB_FORMAT_UNORM24: {
        const uint32_t *stored = (const uint32_t *)(const void *)texels + first;
        for (int32_t i = 0; i < count; i++)
            depths[i] = (float)((double)(float)stored[i] * (1 / (double)UNORM24_MAX));
        break;
    }
    case SHB_FORMAT_UNORM16: {
        const uint16_t *stored = (const uint16_t *)(const void *)texels + first;
        for (int32_t i = 0; i < count; i++)
            depths[i] = (float)((double)stored[i] * (1 / (double)UNORM16_MAX));
        break;
    }
    }
}

/* Copies the box at (left, top) with far depths where it leaves the map. */
static void fill_window(box_batch *batch, int32_t left, int32_t top, int n, int padded) {
    const int32_t first = left < 0 ? -left : 0;
    const int32_t inside = batch->width - left < n ? batch->width - left : n;
    for (int32_t row = 0; row < n; row++) {
        float *depths = batch->window + row * BOX_PITCH;
        for (int32_t column = 0; column < padded; column++)
            depths[column] = batch->far_stored;
        if (top + row >= 0 && top + row < batch->height)
            decode_texels(batch->map, top + row, left + first, inside - first, depths + first);
    }
}

/* Of n texels in a row, those whose centres are nearest to the fragment: which is the first, from
 * the fragment's own one on. */
static inline ALWAYS_INLINE int box_start(float to_center, int n) {
    return (n % 2 == 0 && to_center < 0) - n / 2;
}

/* The n x n texels of fragment i, rows of padded elements; false: none is in the map. */
static inline ALWAYS_INLINE bool find_box(box_batch *batch, size_t i, int n, int padded, box *b) {
    const shb_receivers *r = batch->receivers;
    b->column = box_start(r->to_center_x[i], n);
    b->row = box_start(r->to_center_y[i], n);
    const int32_t left = r->texel_x[i] + b->column, top = r->texel_y[i] + b->row;
    const bool inside =
        (left >= 0) & (top >= 0) & (left <= batch->width - padded) & (top <= batch->height - n);
    if (inside & batch->direct) {
        b->stride = batch->map->depth.stride;
        b->texels = (const char *)batch->map->depth.texels + (size_t)top * b->stride +
                    (size_t)left * sizeof(float);
        return true;
    }
    if (left <= -n || top <= -n || left >= batch->width || top >= batch->height)
        return false;
    fill_window(batch, left, top, n, padded);
    b->stride = BOX_PITCH * sizeof(float);
    b->texels = (const char *)batch->window;
    return true;
}

/* How much of the last column a box of n - 1 texels around the fragment covers. */
static inline ALWAYS_INLINE double last_weight(float to_center, int n) {
    const double weight = (n % 2 ? 0.5 : 1.0) - (double)to_center;
    return n % 2 == 0 && to_center < 0 ? -(double)to_center : weight;
}

/* The depth of every tap anew. */
static void give_taps(box_batch *batch, size_t i, const box *b, int n) {
    const shb_light_rows *rows = &batch->map->rows;
    const shb_tap_surface surface = shb_tap_surface_of(rows, batch->receivers, i);
    const float sign = batch->reversed ? -1.0f : 1.0f;
    for (int row = 0; row < n; row++) {
        float *given = batch->given + row * BOX_PITCH;
        for (int column = 0; column < n; column++)
            given[column] = sign * shb_tap_naive(rows, &surface, b->column + column, b->row + row);
        for (int column = n; column < BOX_PITCH; column++)
            given[column] = NAN;
    }
}

#define LANES NARROW
#include "k_box.inl"
#undef LANES
#if WIDE != NARROW
#define LANES WIDE
#include "k_box.inl"
#undef LANES
#endif

#define NARROWLY(name) SHB_JOIN(name, NARROW)
#define WIDELY(name) SHB_JOIN(name, WIDE)

/* The sizes that most hosts use get code of their own; a run has boxes of one size. */
static inline ALWAYS_INLINE void count_kind(box_batch *batch, size_t first, size_t end,
                                            tap_kind kind) {
    switch (batch->size[first]) {
    case 3:
        NARROWLY(count_run)(batch, first, end, 3, kind);
        break;
    case 5:
        NARROWLY(count_run)(batch, first, end, 5, kind);
        break;
    case 7:
        NARROWLY(count_run)(batch, first, end, 7, kind);
        break;
    case 9:
        WIDELY(count_run)(batch, first, end, 9, kind);
        break;
    case 11:
        WIDELY(count_run)(batch, first, end, 11, kind);
        break;
    default:
        WIDELY(count_run)(batch, first, end, batch->size[first], kind);
    }
}

static void count_run(box_batch *batch, size_t first, size_t end) {
    if (batch->kind == TAPS_GIVEN)
        WIDELY(count_run)(batch, first, end, batch->size[first], TAPS_GIVEN);
    else if (batch->kind == TAPS_FLAT)
        count_kind(batch, first, end, TAPS_FLAT);
    else
        count_kind(batch, first, end, TAPS_PLANE);
}

static void weigh_run(box_batch *batch, size_t first, size_t end) {
    const int n = batch->size[first];
    if (batch->kind == TAPS_GIVEN)
        WIDELY(weigh_run)(batch, first, end, n, TAPS_GIVEN);
    else if (n == 2)
        NARROWLY(weigh_run)(batch, first, end, 2, TAPS_PLANE);
    else
        WIDELY(weigh_run)(batch, first, end, n, TAPS_PLANE);
}

static bool steps_are_zero(const shb_receivers *r, size_t count) {
    bool zero = true;
    for (size_t i = 0; i < count; i++)
        zero &= (r->step_x[i] == 0) & (r->step_y[i] == 0);
    return zero;
}

static int32_t box_size(float size, float least) {
    const float some = size > least ? size : least;
    return (int32_t)((some < BOX_MAX ? some : BOX_MAX) + 0.5f);
}

/* Reads the parameters size, unit and taps. */
static void box_batch_init(const shb_filter_args *args, float least, box_batch *batch) {
    const shb_map *map = args->map;
    const float size = args->filter->params[0], taps = args->filter->params[2];
    batch->map = map;
    batch->receivers = args->receivers;
    batch->width = (int32_t)map->info.width;
    batch->height = (int32_t)map->info.height;
    batch->reversed = map->info.view.reversed;
    batch->far_stored = shb_far_depth(batch->reversed);
    batch->direct = map->info.format == SHB_FORMAT_FLOAT32;
    batch->kind = taps == SHB_TAPS_NAIVE ? TAPS_GIVEN
                  : taps == SHB_TAPS_OWN || steps_are_zero(args->receivers, args->count)
                      ? TAPS_FLAT
                      : TAPS_PLANE;
    const bool world = args->filter->params[1] == SHB_UNIT_WORLD;
    for (size_t i = 0; i < args->count; i++)
        batch->size[i] = box_size(world ? size / args->receivers->texel_size[i] : size, least);
}

/* Where the run of boxes of one size that begins at first ends. */
static size_t run_end(const box_batch *batch, size_t first, size_t count) {
    size_t end = first + 1;
    while (end < count && batch->size[end] == batch->size[first])
        end++;
    return end;
}

static void fill_lanes(size_t count, float *visibility) {
    for (size_t i = count; i < shb_round_to_lanes(count); i++)
        visibility[i] = visibility[count - 1];
}

static void pcf(const shb_filter_args *args) {
    box_batch batch;
    box_batch_init(args, 1, &batch);
    for (size_t first = 0, end; first < args->count; first = end) {
        end = run_end(&batch, first, args->count);
        count_run(&batch, first, end);
        const int32_t taps = batch.size[first] * batch.size[first];
        const double share = 1 / (double)taps;
        for (size_t i = first; i < end; i++)
            args->visibility[i] = (float)(share * (taps - batch.shadowed[i]));
    }
    fill_lanes(args->count, args->visibility);
}

static void pcf_smooth(const shb_filter_args *args) {
    box_batch batch;
    box_batch_init(args, 2, &batch);
    for (size_t first = 0, end; first < args->count; first = end) {
        end = run_end(&batch, first, args->count);
        weigh_run(&batch, first, end);
        const double share = 1 / ((batch.size[first] - 1.0) * (batch.size[first] - 1.0));
        for (size_t i = first; i < end; i++)
            args->visibility[i] = (float)(share * batch.lit[i]);
    }
    fill_lanes(args->count, args->visibility);
}
