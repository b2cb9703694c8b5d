/* Boxes of texels around fragments: percentage-closer filtering (Reeves, Salesin and Cook 1987). */

#include "k_box_batch.inl"

/* How much of the last column a box of n - 1 texels around the fragment covers. */
static inline ALWAYS_INLINE double last_weight(float to_center, int n) {
    const double weight = (n % 2 ? 0.5 : 1.0) - (double)to_center;
    return n % 2 == 0 && to_center < 0 ? -(double)to_center : weight;
}

/* Lit taps of some rows, those of the outer columns by their weights, of which left and right are
 * shadowed, and shadowed of all. */
static inline ALWAYS_INLINE double weigh_columns(int32_t left, int32_t right, int32_t shadowed,
                                                 int n, int32_t rows, double right_weight) {
    const int32_t lit_left = rows - left, lit_right = rows - right;
    const int32_t inner = n * rows - shadowed - lit_left - lit_right;
    return ((1 - right_weight) * lit_left + right_weight * lit_right) + inner;
}

static inline ALWAYS_INLINE float weight_share(double lit, int n) {
    return (float)(lit * (1 / ((n - 1.0) * (n - 1.0))));
}

/* The places of lanes fragments from i on. In a run that is not whole those that are not asked for
 * get the place of one that is; false: there is none. */
static NEVER_INLINE bool readable_places(const box_run *run, size_t i, size_t lanes,
                                         int32_t *places) {
    const box_batch *batch = run->batch;
    int32_t readable = -1;
    for (size_t k = 0; k < lanes; k++)
        if (batch->size[i + k] == run->n && batch->place[i + k] >= 0)
            readable = batch->place[i + k];
    for (size_t k = 0; k < lanes; k++)
        places[k] = batch->size[i + k] == run->n && batch->place[i + k] >= 0 ? batch->place[i + k]
                                                                             : readable;
    return readable >= 0;
}

static inline ALWAYS_INLINE bool any_set(const int32_t *masks, size_t count) {
    int32_t any = 0;
    for (size_t i = 0; i < count; i++)
        any |= masks[i];
    return any != 0;
}

/* The texels of so many boxes are on their way from memory. */
#define PREFETCHED_BOXES 32

/* Asks for the corners of count boxes, if the run goes on to them: neighbours have most texels in
 * common, and what is new to one lies at its rim, first of all in the corner towards which they
 * move. width: columns that are read. Of boxes that are not read in place anything may be asked
 * for, so addresses are numbers. */
static inline ALWAYS_INLINE void prefetch_boxes(const box_run *run, size_t first, size_t count,
                                                int width) {
    const int32_t *place = run->batch->place;
    const intptr_t left = (intptr_t)run->batch->map->depth.texels;
    const intptr_t right = left + (intptr_t)sizeof(float) * (width - 1);
    const intptr_t down = (run->n - 1) * (intptr_t)run->batch->map->depth.stride;
    for (size_t i = first; i < first + count && first < run->end; i++) {
        const intptr_t offset = (intptr_t)sizeof(float) * place[i];
        __builtin_prefetch((const void *)(left + offset));
        __builtin_prefetch((const void *)(right + offset));
        __builtin_prefetch((const void *)(left + down + offset));
        __builtin_prefetch((const void *)(right + down + offset));
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

typedef void count_fn(const box_run *run, float *visibility);

/* A function for boxes of n x n texels, by the kind of taps and the direction of depth. by_twos: a
 * row is one vector, and there are few. */
#define IN_PLACE(name, width, n, by_twos, kind, reversed)                                          \
    static NEVER_INLINE void name(const box_run *run, float *visibility) {                         \
        width(count_in_place)(run, n, by_twos, kind, reversed, visibility);                        \
    }
#define IN_PLACE_KINDS(width, n, by_twos)                                                          \
    IN_PLACE(count_flat_##n, width, n, by_twos, TAPS_FLAT, false)                                  \
    IN_PLACE(count_flat_reversed_##n, width, n, by_twos, TAPS_FLAT, true)                          \
    IN_PLACE(count_plane_##n, width, n, by_twos, TAPS_PLANE, false)                                \
    IN_PLACE(count_plane_reversed_##n, width, n, by_twos, TAPS_PLANE, true)
#define IN_PLACE_ROW(n)                                                                            \
    {                                                                                              \
        {count_flat_##n, count_flat_reversed_##n}, {                                               \
            count_plane_##n, count_plane_reversed_##n                                              \
        }                                                                                          \
    }

/* The sizes that most hosts use, and any other. */
IN_PLACE_KINDS(NARROWLY, 3, NARROW >= 3)
IN_PLACE_KINDS(NARROWLY, 5, NARROW >= 5)
IN_PLACE_KINDS(NARROWLY, 7, NARROW >= 7)
IN_PLACE_KINDS(WIDELY, 9, false)
IN_PLACE_KINDS(WIDELY, 11, false)
#define ANY_SIZE run->n
IN_PLACE(count_flat_any, WIDELY, ANY_SIZE, false, TAPS_FLAT, false)
IN_PLACE(count_flat_reversed_any, WIDELY, ANY_SIZE, false, TAPS_FLAT, true)
IN_PLACE(count_plane_any, WIDELY, ANY_SIZE, false, TAPS_PLANE, false)
IN_PLACE(count_plane_reversed_any, WIDELY, ANY_SIZE, false, TAPS_PLANE, true)

static void count_run(const box_run *run, float *visibility) {
    static count_fn *const odd_sizes[5][2][2] = {IN_PLACE_ROW(3), IN_PLACE_ROW(5), IN_PLACE_ROW(7),
                                                 IN_PLACE_ROW(9), IN_PLACE_ROW(11)};
    static count_fn *const any_size[2][2] = IN_PLACE_ROW(any);
    const box_batch *batch = run->batch;
    const int n = run->n;
    const bool common = n % 2 && n >= 3 && n <= 11;
    count_fn *const(*count)[2] = common ? odd_sizes[(n - 3) / 2] : any_size;
    count[batch->kind == TAPS_PLANE][batch->reversed](run, visibility);
}

static float box_share(int n, int32_t shadowed) {
    return (float)((n * n - shadowed) * (1 / (double)(n * n)));
}

static float count_given(const box_batch *batch, size_t i, const texel_box *b) {
    const int n = batch->size[i];
    const WIDELY(wi) shadowed = batch->reversed
                                    ? WIDELY(count_box)(batch, i, b, n, TAPS_GIVEN, true)
                                    : WIDELY(count_box)(batch, i, b, n, TAPS_GIVEN, false);
    return box_share(n, WIDELY(wi_sum)(shadowed));
}

/* By the naive way, in map formats that are not float, and where the map ends. */
static NEVER_INLINE float count_copy(box_batch *batch, size_t i) {
    texel_box b;
    if (!copy_box(batch, i, &b))
        return 1;
    if (batch->kind == TAPS_GIVEN) {
        give_naive_taps(batch, i, &b);
        return count_given(batch, i, &b);
    }
    const int n = batch->size[i];
    const WIDELY(wi) shadowed = batch->reversed
                                    ? WIDELY(count_box)(batch, i, &b, n, TAPS_PLANE, true)
                                    : WIDELY(count_box)(batch, i, &b, n, TAPS_PLANE, false);
    return box_share(n, WIDELY(wi_sum)(shadowed));
}

static float weigh_one(const box_batch *batch, size_t i, const texel_box *b) {
    const int n = batch->size[i];
    double lit;
    if (batch->kind != TAPS_GIVEN)
        lit = batch->reversed ? WIDELY(weigh_box)(batch, i, b, n, TAPS_PLANE, true)
                              : WIDELY(weigh_box)(batch, i, b, n, TAPS_PLANE, false);
    else
        lit = batch->reversed ? WIDELY(weigh_box)(batch, i, b, n, TAPS_GIVEN, true)
                              : WIDELY(weigh_box)(batch, i, b, n, TAPS_GIVEN, false);
    return weight_share(lit, n);
}

static void fill_lanes(size_t count, float *visibility) {
    for (size_t i = count; i < shb_round_to_lanes(count); i++)
        visibility[i] = visibility[count - 1];
}

/* Boxes that are read in place; what the others get means nothing. */
static void count_inside(const box_batch *batch, size_t count, float *visibility) {
    const size_t lanes = shb_round_to_lanes(count);
    if (batch->same_size) {
        const box_run all = {batch, 0, lanes, batch->size[0]};
        count_run(&all, visibility);
        return;
    }
    for (size_t first = 0; first < lanes; first += SHB_LANES) {
        const int32_t *size = batch->size + first;
        uint32_t left = (1u << SHB_LANES) - 1;
        while (left) {
            const box_run run = {batch, first, first + SHB_LANES, size[__builtin_ctz(left)]};
            count_run(&run, visibility);
            for (size_t i = 0; i < SHB_LANES; i += WIDE)
                left &= ~(vi_bits(vi_load(size + i) == run.n) << i);
        }
    }
}

static void pcf(const shb_filter_args *args) {
    box_batch batch;
    box_batch_of_planes(args, 1, &batch);
    count_inside(&batch, args->count, args->visibility);
    for (size_t i = 0; i < args->count && !batch.all_inside; i++)
        if (batch.place[i] < 0)
            args->visibility[i] = count_copy(&batch, i);
    fill_lanes(args->count, args->visibility);
}

static void smooth_boxes(const shb_filter_args *args) {
    box_batch batch;
    box_batch_of_planes(args, 2, &batch);
    for (size_t i = 0; i < args->count; i++) {
        texel_box b;
        bool inside = batch.place[i] >= 0;
        if (inside) {
            b = box_in_place(&batch, i);
        } else {
            inside = copy_box(&batch, i, &b);
            if (inside && batch.kind == TAPS_GIVEN)
                give_naive_taps(&batch, i, &b);
        }
        args->visibility[i] = inside ? weigh_one(&batch, i, &b) : 1.0f;
    }
    fill_lanes(args->count, args->visibility);
}
