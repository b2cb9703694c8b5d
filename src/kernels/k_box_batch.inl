/* Boxes of texels around the fragments of a batch: where they lie, what of them can be read where
 * it is, and the planes that their taps are compared with. */

#include "../taps.h"

/* Floats in a row of a window: room for whole vectors. A row is left for those that begin at the
 * second texel of the last one. */
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

/* Where the depths of taps come from: one for all, the receiver plane, such a plane that stays
 * before the far one, or an array. */
typedef enum tap_kind { TAPS_FLAT, TAPS_PLANE, TAPS_NEAR, TAPS_GIVEN } tap_kind;

/* A batch whose fragments ask boxes of texels. */
typedef struct box_batch {
    const shb_map *map;
    const shb_receivers *receivers;
    int32_t width, height;
    bool reversed;
    tap_kind kind;
    mutual_batch *mutual;                    /* of the exact method; else NULL */
    bool same_size, all_inside;              /* so are all boxes */
    SHB_ALIGN int32_t size[SHB_BATCH];       /* texels in a row of the box */
    int32_t left[SHB_BATCH], top[SHB_BATCH]; /* its first texel */
    int32_t place[SHB_BATCH]; /* its number in a map of floats; -1: not to be read in place */
    float ref[SHB_BATCH], step_x[SHB_BATCH], step_y[SHB_BATCH]; /* as the map stores depth; of
                                                                   TAPS_FLAT ref is limited */
    int32_t limited[SHB_BATCH]; /* of TAPS_PLANE: 0, or -1 where it is not TAPS_NEAR */
    float window[(SHB_BOX_MAX + 1) * BOX_PITCH]; /* a copy of a box that cannot be read in place */
    uint32_t occluders[(SHB_BOX_MAX + 1) * BOX_PITCH]; /* of the exact method: of its occluders */
    float given[SHB_BOX_MAX * BOX_PITCH]; /* TAPS_GIVEN: of its taps, as the map stores depth */
} box_batch;

/* Fragments of a batch, whole vectors of them: those whose boxes have n texels in a row. */
typedef struct box_run {
    const box_batch *batch;
    size_t first, end;
    int n;
} box_run;

/* Where the texels of a box are, as floats, and which they are from the fragment's own one on. */
typedef struct texel_box {
    const char *texels;
    size_t stride;
    int column, row;       /* of the first */
    const float *given;    /* TAPS_GIVEN */
    const char *occluders; /* of the exact method */
    size_t occluder_stride;
} texel_box;

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

/* The depth of every tap by the naive way. */
static void give_naive_taps(box_batch *batch, size_t i, const texel_box *b) {
    const int n = batch->size[i];
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

/* Copies the box of fragment i, with far depths where it leaves the map; false: it lies outside. */
static NEVER_INLINE bool copy_box(box_batch *batch, size_t i, texel_box *b) {
    const int32_t n = batch->size[i], left = batch->left[i], top = batch->top[i];
    if (left <= -n || top <= -n || left >= batch->width || top >= batch->height)
        return false;
    const int32_t first = left < 0 ? -left : 0;
    const int32_t end = batch->width - left < n ? batch->width - left : n;
    for (int32_t row = 0; row < n; row++) {
        float *depths = batch->window + row * BOX_PITCH;
        for (int32_t column = 0; column < BOX_PITCH; column++)
            depths[column] = shb_far_depth(batch->reversed);
        if (batch->mutual)
            memset(batch->occluders + row * BOX_PITCH, -1, BOX_PITCH * sizeof *batch->occluders);
        if (top + row < 0 || top + row >= batch->height)
            continue;
        decode_texels(batch->map, top + row, left + first, end - first, depths + first);
        if (batch->mutual)
            memcpy(batch->occluders + row * BOX_PITCH + first,
                   shb_occluder_row(batch->map, top + row) + left + first,
                   (size_t)(end - first) * sizeof *batch->occluders);
    }
    *b = (texel_box){.texels = (const char *)batch->window,
                     .stride = BOX_PITCH * sizeof(float),
                     .column = left - batch->receivers->texel_x[i],
                     .row = top - batch->receivers->texel_y[i],
                     .given = batch->given,
                     .occluders = (const char *)batch->occluders,
                     .occluder_stride = BOX_PITCH * sizeof *batch->occluders};
    return true;
}

static inline ALWAYS_INLINE texel_box box_in_place(const box_batch *batch, size_t i) {
    const float *texels = batch->map->depth.texels;
    return (texel_box){.texels = (const char *)(texels + batch->place[i]),
                       .stride = batch->map->depth.stride,
                       .column = batch->left[i] - batch->receivers->texel_x[i],
                       .row = batch->top[i] - batch->receivers->texel_y[i]};
}

static bool steps_are_zero(const shb_receivers *r, size_t count) {
    vi steep = {0};
    for (size_t i = 0; i < count && !vi_any(steep); i += WIDE)
        steep = (vf_load(r->step_x + i) != 0) | (vf_load(r->step_y + i) != 0);
    return !vi_any(steep);
}

/* Of n texels in a row, those whose centres are nearest to the fragment: which is the first, from
 * the fragment's own one on. */
static inline ALWAYS_INLINE int32_t box_start(float to_center, int32_t n) {
    return (~n & (to_center < 0)) - (n >> 1);
}

/* How much more that is than half of n to the left. */
static inline ALWAYS_INLINE vi box_shift(vf to_center, vi n) {
    return ~n & (to_center < 0) & 1;
}

/* Where boxes lie, and which of them can be read where they are, with whole vectors. odd: all have
 * the same odd number of texels in a row. */
static inline ALWAYS_INLINE void place_boxes(const shb_receivers *restrict r, size_t count,
                                             bool odd, box_batch *restrict batch) {
    const bool in_place = can_gather(batch->map) && batch->kind != TAPS_GIVEN;
    const uint32_t stride = (uint32_t)(batch->map->depth.stride / 4);
    const vi width = vi_splat(batch->width), height = vi_splat(batch->height);
    const vi same_size = vi_splat(batch->size[0]), never = vi_splat(in_place ? 0 : -1);
    vi any_beyond = {0};
    for (size_t i = 0; i < count; i += WIDE) {
        const vi n = odd ? same_size : vi_load(batch->size + i);
        vi left = vi_load(r->texel_x + i) - (n >> 1), top = vi_load(r->texel_y + i) - (n >> 1);
        if (!odd) {
            left += box_shift(vf_load(r->to_center_x + i), n);
            top += box_shift(vf_load(r->to_center_y + i), n);
        }
        /* Negative where the box, in whole vectors, leaves the map. */
        const vi right = width - ((n + 15) & ~15) - left, bottom = height - n - top;
        const vi beyond = left | top | right | bottom | never;
        vi_store(batch->left + i, left);
        vi_store(batch->top + i, top);
        vi_store(batch->place + i, (vi)((vu)top * stride + (vu)left) | beyond >> 31);
        any_beyond |= beyond;
    }
    batch->all_inside = !vi_any(any_beyond < 0);
}

/* One depth for all taps of a fragment. */
static void store_depths(const shb_receivers *restrict r, size_t count, box_batch *restrict batch) {
    const float sign = batch->reversed ? -1.0f : 1.0f;
    const vf far_depth = vf_splat(shb_far_depth(batch->reversed));
    for (size_t i = 0; i < count; i += WIDE)
        vf_store(batch->ref + i, sign * vf_min(far_depth, vf_load(r->ref + i)));
    memset(batch->step_x, 0, count * sizeof *batch->step_x);
    memset(batch->step_y, 0, count * sizeof *batch->step_y);
}

/* Planes as the map stores depth. Rounding keeps the order of numbers, so no tap of a box lies
 * behind the one in the corner towards which its plane falls. */
static void store_planes(const shb_receivers *restrict r, size_t count, box_batch *restrict batch) {
    const float sign = batch->reversed ? -1.0f : 1.0f;
    const float far_depth = shb_far_depth(batch->reversed);
    for (size_t i = 0; i < count; i += WIDE) {
        const vf ref = vf_load(r->ref + i);
        const vf step_x = vf_load(r->step_x + i), step_y = vf_load(r->step_y + i);
        const vf half = __builtin_convertvector(vi_load(batch->size + i) >> 1, vf);
        const vf farthest = (ref + half * vf_abs(step_x)) + half * vf_abs(step_y);
        vi_store(batch->limited + i, ~(farthest <= far_depth));
        vf_store(batch->ref + i, sign * ref);
        vf_store(batch->step_x + i, sign * step_x);
        vf_store(batch->step_y + i, sign * step_y);
    }
}

/* texel_size: NULL for sizes in texels. */
static void box_sizes(const float *restrict texel_size, float size, float least, size_t count,
                      int32_t *restrict sizes) {
    const int32_t all = shb_box_size(size, least);
    for (size_t i = 0; i < shb_round_to_lanes(count); i++)
        sizes[i] = texel_size ? shb_box_size(size / texel_size[i], least) : all;
}

/* All but the planes. Reads the parameters size and unit. */
static void box_batch_init(const shb_filter_args *args, const shb_receivers *r, tap_kind kind,
                           float least, box_batch *batch) {
    const bool world = args->filter->params[1] == SHB_UNIT_WORLD;
    const size_t lanes = shb_round_to_lanes(args->count);
    batch->map = args->map;
    batch->receivers = r;
    batch->width = (int32_t)args->map->info.width;
    batch->height = (int32_t)args->map->info.height;
    batch->reversed = args->map->info.view.reversed;
    batch->kind = kind;
    batch->mutual = NULL;
    batch->same_size = !world;
    box_sizes(world ? r->texel_size : NULL, args->filter->params[0], least, args->count,
              batch->size);
    if (batch->same_size && batch->size[0] % 2)
        place_boxes(r, lanes, true, batch);
    else
        place_boxes(r, lanes, false, batch);
}

/* Of receiver planes; reads the parameter taps too. */
static void box_batch_of_planes(const shb_filter_args *args, float least, box_batch *batch) {
    const float taps = args->filter->params[2];
    const bool own = taps == SHB_TAPS_OWN;
    const bool flat = own || steps_are_zero(args->receivers, args->count);
    box_batch_init(args, args->receivers,
                   taps == SHB_TAPS_NAIVE ? TAPS_GIVEN
                   : flat                 ? TAPS_FLAT
                                          : TAPS_PLANE,
                   least, batch);
    if (batch->kind == TAPS_FLAT)
        store_depths(args->receivers, shb_round_to_lanes(args->count), batch);
    else
        store_planes(args->receivers, shb_round_to_lanes(args->count), batch);
}
