/* Moments of distance between texels and between boxes: distributions mixed, the formulas of
 * moments.h. The including file has chosen the target and defined WIDE and MOMENT_KERNELS, the name
 * of the table. */

#include "moments.h"

#include "k_blur.inl"

/* Moments of WIDE distributions. */
typedef struct wide_moments {
    vf at[SHB_MOMENTS_MAX];
} wide_moments;

/* 1 - f parts of a and f parts of b. With e = f (1 - f) and d between the means, what the moments
 * about the common mean add up to beyond the mixed ones is
 *     variance   e d^2
 *     third      3 e d (variance_b - variance_a) + e (1 - 2 f) d^3
 *     fourth     4 e d (third_b - third_a) + 6 e d^2 (f variance_a + (1 - f) variance_b)
 *                + e (1 - 3 e) d^4 */
static inline ALWAYS_INLINE wide_moments mix(int moments, vf f, wide_moments a, wide_moments b) {
    const vf rest = 1.0f - f, e = f * rest, d = b.at[0] - a.at[0], ed = e * d, d2 = d * d;
    const vf variances = b.at[1] - a.at[1];
    wide_moments mixed;
    mixed.at[0] = a.at[0] + f * d;
    mixed.at[1] = a.at[1] + f * variances + ed * d;
    if (moments == 4) {
        const vf thirds = b.at[2] - a.at[2];
        const vf crossed = f * a.at[1] + rest * b.at[1];
        mixed.at[2] = a.at[2] + f * thirds + ed * (3.0f * variances + (1.0f - 2.0f * f) * d2);
        mixed.at[3] = a.at[3] + f * (b.at[3] - a.at[3]) +
                      ed * (4.0f * thirds + d * (6.0f * crossed + (1.0f - 3.0f * e) * d2));
    }
    return mixed;
}

/* Distributions at the corners of a cell, row by row, and a place in it, 0 .. 1 from the left and
 * from the top. */
typedef struct wide_corners {
    wide_moments at[4];
    vf x, y;
} wide_corners;

static inline ALWAYS_INLINE wide_moments mix_corners(int moments, const wide_corners *corners) {
    const wide_moments above = mix(moments, corners->x, corners->at[0], corners->at[1]);
    const wide_moments below = mix(moments, corners->x, corners->at[2], corners->at[3]);
    return mix(moments, corners->y, above, below);
}

/* Distributions beside each other, of which the left one begins at a float. */
static inline ALWAYS_INLINE void read_both(int moments, const float *from, vu begin,
                                           wide_moments both[2]) {
    vf four[4];
    vf_read_quads(from, begin, four);
    if (moments == 2) {
        for (int m = 0; m < 2; m++) {
            both[0].at[m] = four[m];
            both[1].at[m] = four[2 + m];
        }
        return;
    }
    memcpy(both[0].at, four, sizeof four);
    vf_read_quads(from, begin + 4, both[1].at);
}

static inline ALWAYS_INLINE void write_moments(int moments, const wide_moments *from, size_t i,
                                               shb_moment_batch *out) {
    for (int m = 0; m < moments; m++)
        vf_store(out->at[m] + i, from->at[m]);
}

/* ---- between texels of an image ---- */

static inline ALWAYS_INLINE vi limit_texels(vi texel, uint32_t size) {
    const vi last = vi_splat((int32_t)size - 1);
    const vi at_least = texel & (texel > 0);
    return at_least + ((last - at_least) & (last < at_least));
}

/* The centre of the fragment's own texel lies before or behind it. */
static inline ALWAYS_INLINE void sample_texels(int moments, const shb_moment_image *image,
                                               size_t lanes, const shb_receivers *r,
                                               shb_moment_batch *out) {
    const uint32_t stride = image->width * (uint32_t)moments;
    for (size_t i = 0; i < lanes; i += WIDE) {
        const vf to_x = vf_load(r->to_center_x + i), to_y = vf_load(r->to_center_y + i);
        const vi before = to_x > 0.0f, above = to_y > 0.0f; /* -1 */
        const vi column = limit_texels(vi_load(r->texel_x + i), image->width - 2) + 1 + before;
        const vi row = limit_texels(vi_load(r->texel_y + i), image->height - 2) + 1 + above;
        const vu first = (vu)row * stride + (vu)column * (uint32_t)moments;
        wide_corners corners = {.x = vf_keep(before, vf_splat(1)) - to_x,
                                .y = vf_keep(above, vf_splat(1)) - to_y};
        read_both(moments, image->texels, first, corners.at);
        read_both(moments, image->texels, first + stride, corners.at + 2);
        const wide_moments mixed = mix_corners(moments, &corners);
        write_moments(moments, &mixed, i, out);
    }
}

static void sample_image(const shb_moment_image *image, size_t count,
                         const shb_receivers *receivers, shb_moment_batch *out) {
    const size_t lanes = shb_round_to_lanes(count);
    if (image->count == 4)
        sample_texels(4, image, lanes, receivers, out);
    else
        sample_texels(2, image, lanes, receivers, out);
}

/* ---- between boxes of a pyramid ---- */

static inline ALWAYS_INLINE vu look_up(const uint32_t *table, vi index) {
    vu found;
    for (int i = 0; i < WIDE; i++)
        found[i] = table[index[i]];
    return found;
}

/* 2^-shift for shifts of 0 to 126. */
static inline ALWAYS_INLINE vf inverse_power(vi shift) {
    return (vf)((127 - shift) << 23);
}

/* A place along an axis, between two boxes that lie 2^shift texels apart. */
static inline ALWAYS_INLINE vi place_between(vi texel, vf to_center, uint32_t size, vi shift,
                                             vf *between) {
    const vi inside = limit_texels(texel, size);
    const vi box = inside >> shift;
    const vf off = __builtin_convertvector(inside - (box << shift), vf) + (0.5f - to_center);
    *between = off * inverse_power(shift);
    return box;
}

static inline ALWAYS_INLINE wide_moments sample_level(const shb_moment_pyramid *pyramid,
                                                      const shb_map_info *info, int moments,
                                                      const shb_receivers *r, size_t i, vi level) {
    const vi shift = level + (vi)(level > 0); /* boxes of the two finest lie a texel apart */
    const vi one = vi_splat(1), columns_less = vi_splat((int32_t)info->width) - 1;
    const vu columns = (vu)((columns_less + (one << shift)) >> shift) + 2;
    wide_corners corners;
    const vi column = place_between(vi_load(r->texel_x + i), vf_load(r->to_center_x + i),
                                    info->width, shift, &corners.x);
    const vi row = place_between(vi_load(r->texel_y + i), vf_load(r->to_center_y + i), info->height,
                                 shift, &corners.y);
    const vu box = look_up(pyramid->firsts, level) + (vu)row * columns + (vu)column;
    const vu first = box * (uint32_t)moments;
    read_both(moments, pyramid->boxes, first, corners.at);
    read_both(moments, pyramid->boxes, first + columns * (uint32_t)moments, corners.at + 2);
    return mix_corners(moments, &corners);
}

/* The finer one of the two levels of each kernel. */
static inline ALWAYS_INLINE vi choose_levels(const shb_moment_pyramid *pyramid, vf square_width) {
    vi level = vi_splat(0);
    for (int k = 1; k < pyramid->level_count - 1; k++)
        level -= square_width > pyramid->square_widths[k];
    return level;
}

static inline ALWAYS_INLINE void sample_boxes(int moments, const shb_moment_pyramid *pyramid,
                                              const shb_map_info *info, size_t lanes,
                                              const shb_receivers *r, const float *square_widths,
                                              shb_moment_batch *out) {
    for (size_t i = 0; i < lanes; i += WIDE) {
        const vf square_width = vf_load(square_widths + i);
        const vi level = choose_levels(pyramid, square_width);
        wide_moments mixed = sample_level(pyramid, info, moments, r, i, level);
        if (pyramid->level_count > 1) {
            const vf fine = vf_gather(pyramid->square_widths, level);
            const vf coarse = vf_gather(pyramid->square_widths, level + 1);
            mixed = mix(moments, (square_width - fine) / (coarse - fine), mixed,
                        sample_level(pyramid, info, moments, r, i, level + 1));
        }
        write_moments(moments, &mixed, i, out);
    }
}

static void sample_pyramid(const shb_moment_pyramid *pyramid, const shb_map_info *info,
                           size_t count, const shb_receivers *receivers, const float *square_widths,
                           shb_moment_batch *out) {
    const size_t lanes = shb_round_to_lanes(count);
    if (pyramid->count == 4)
        sample_boxes(4, pyramid, info, lanes, receivers, square_widths, out);
    else
        sample_boxes(2, pyramid, info, lanes, receivers, square_widths, out);
}

/* ---- boxes of boxes ---- */

/* At most WIDE distributions, one after the other. */
static inline ALWAYS_INLINE void write_boxes(int moments, const wide_moments *from, size_t count,
                                             float *boxes) {
    if (moments == 4 && count == WIDE) {
        vf_write_quads(boxes, 4 * sizeof *boxes, from->at);
        return;
    }
    for (int m = 0; m < moments; m++)
        for (size_t i = 0; i < count; i++)
            boxes[i * (size_t)moments + (size_t)m] = from->at[m][i];
}

/* Texels are boxes without spread. */
static inline ALWAYS_INLINE wide_moments without_spread(const float *values) {
    return (wide_moments){{vf_load(values), vf_splat(0), vf_splat(0), vf_splat(0)}};
}

static inline ALWAYS_INLINE size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

static inline ALWAYS_INLINE void join_four(int moments, uint32_t columns, const float *row,
                                           const float *below, float *boxes) {
    wide_corners corners = {.x = vf_splat(0.5f), .y = vf_splat(0.5f)};
    for (uint32_t x = 0; x < columns; x += WIDE) {
        corners.at[0] = without_spread(row + x);
        corners.at[1] = without_spread(row + x + 1);
        corners.at[2] = without_spread(below + x);
        corners.at[3] = without_spread(below + x + 1);
        const wide_moments mixed = mix_corners(moments, &corners);
        write_boxes(moments, &mixed, smaller(columns - x, WIDE), boxes + x * (size_t)moments);
    }
}

static void join_texels(int moments, uint32_t columns, const float *row, const float *below,
                        float *boxes) {
    if (moments == 4)
        join_four(4, columns, row, below, boxes);
    else
        join_four(2, columns, row, below, boxes);
}

/* Boxes of a level's row from a column on, step boxes apart. What the level does not hold lies
 * outside the map. */
static inline ALWAYS_INLINE wide_moments read_boxes(int moments, const shb_moment_pyramid *pyramid,
                                                    int level, vi column, int64_t y) {
    const shb_moment_level *from = &pyramid->levels[level];
    const vf far = vf_splat(pyramid->far);
    if (y < 0 || y >= from->rows)
        return (wide_moments){{far, vf_splat(0), vf_splat(0), vf_splat(0)}};
    const float *row = from->boxes + (size_t)y * from->columns * (size_t)moments;
    const vi inside = (column >= 0) & (column < (int32_t)from->columns);
    const vi first = (column & inside) * moments;
    wide_moments read = {{vf_splat(0)}};
    if (moments == 4)
        vf_read_quads(row, (vu)first, read.at);
    else
        for (int m = 0; m < 2; m++)
            read.at[m] = vf_gather(row, first + m);
    read.at[0] = vf_where(inside, read.at[0], far);
    for (int m = 1; m < moments; m++)
        read.at[m] = vf_keep(inside, read.at[m]);
    return read;
}

/* Each box from four of half its width. */
static inline ALWAYS_INLINE void join_row_of(int moments, const shb_moment_pyramid *pyramid,
                                             int level, uint32_t y) {
    const shb_moment_level *to = &pyramid->levels[level];
    const int step = level > 1 ? 2 : 1, reach = step;
    float *boxes = to->boxes + (size_t)y * to->columns * (size_t)moments;
    wide_corners corners = {.x = vf_splat(0.5f), .y = vf_splat(0.5f)};
    for (uint32_t x = 0; x < to->columns; x += WIDE) {
        const vi column = ((int32_t)x + vi_numbers()) * step;
        for (int k = 0; k < 4; k++)
            corners.at[k] =
                read_boxes(moments, pyramid, level - 1, column + (k & 1 ? reach : -reach),
                           (int64_t)y * step + (k >> 1 ? reach : -reach));
        const wide_moments mixed = mix_corners(moments, &corners);
        write_boxes(moments, &mixed, smaller(to->columns - x, WIDE), boxes + x * (size_t)moments);
    }
}

static void join_boxes(const shb_moment_pyramid *pyramid, int level, uint32_t y) {
    if (pyramid->count == 4)
        join_row_of(4, pyramid, level, y);
    else
        join_row_of(2, pyramid, level, y);
}

#include "k_windows.inl"

#include "k_judge.inl"

const shb_moment_kernels MOMENT_KERNELS = {
    .warp = warp,
    .mix_neighbours = mix_neighbours,
    .mix_rows = mix_rows,
    .sample_image = sample_image,
    .sample_pyramid = sample_pyramid,
    .join_texels = join_texels,
    .join_boxes = join_boxes,
    .windows = find_windows,
    .receivers = place_receivers,
    .variance = judge_variance,
    .exponentials = judge_exponentials,
    .moments = judge_moments,
};
