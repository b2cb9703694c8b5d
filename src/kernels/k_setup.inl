/* Set-up of a chunk of triangles: plain loops over lanes that the compiler vectorises, free of
 * branches. The formulas, their order and the proofs of their widths are those of setup.h and
 * plane.h. */

#include "../slopes.h"

#define MIN(a, b) ((a) < (b) ? (a) : (b))
#define MAX(a, b) ((a) > (b) ? (a) : (b))

typedef struct sample_rectangle {
    int32_t left, top, right, bottom; /* right and bottom are the first ones outside */
} sample_rectangle;

/* Window corners of the chunk's triangles. */
typedef struct chunk_corners {
    SHB_ALIGN double x[3][SHB_CHUNK];
    double y[3][SHB_CHUNK], z[3][SHB_CHUNK];
} chunk_corners;

/* Loops run over whole vectors of the widest kind: what is beyond a count repeats its last triangle
 * and is not kept. */
#define LANES_TOGETHER 16

static inline int lanes_of(int count) {
    return (count + LANES_TOGETHER - 1) / LANES_TOGETHER * LANES_TOGETHER;
}

/* What is being drawn: triangles by the numbers of their vertices. */
typedef struct corner_list {
    const shb_vertex *vertices;
    const uint32_t *indices; /* three a triangle, for all lanes */
    int count;
} corner_list;

typedef int32_t quad __attribute__((vector_size(16)));

/* Snapped corners, boxes and areas. The box is that of all samples that the triangle can cover. */
typedef struct chunk_boxes {
    SHB_ALIGN int32_t corner_x[3][SHB_CHUNK];
    int32_t corner_y[3][SHB_CHUNK];
    int32_t x[SHB_CHUNK], y[SHB_CHUNK], width[SHB_CHUNK], height[SHB_CHUNK];
    int32_t seen[SHB_CHUNK]; /* 1: usable, its box has a sample in the region */
    int32_t kept[SHB_CHUNK]; /* 1: seen and faces the right way */
    int32_t sign[SHB_CHUNK]; /* -1 if the area is negative, else 1 */
} chunk_boxes;

/* Edges and depths, counted from the box's first sample. A sample is inside where no edge value is
 * negative: they are floor((E + bias) / 256) of the exact edge function E, bias -1 on an edge that
 * is neither top nor left. 32 bits hold them in boxes of up to SHB_SMALL samples. */
typedef struct chunk_planes {
    SHB_ALIGN int32_t edge[3][SHB_CHUNK];
    int32_t edge_x[3][SHB_CHUNK], edge_y[3][SHB_CHUNK];
    float depth[SHB_CHUNK], depth_x[SHB_CHUNK], depth_y[SHB_CHUNK];
    float anchor[SHB_CHUNK];  /* added last; where planes are drawn, otherwise none */
    int32_t plain[SHB_CHUNK]; /* 1: depth is evaluated in float, 0: in double */
    double base[SHB_CHUNK], step_x[SHB_CHUNK], step_y[SHB_CHUNK], lo[SHB_CHUNK], hi[SHB_CHUNK];
} chunk_planes;

static inline uint32_t triangle_of(const shb_chunk *chunk, uint32_t t) {
    return chunk->triangles ? chunk->triangles[t] : chunk->first + t;
}

/* Fills up the lanes beyond the count. */
static void repeat_last(int count, uint32_t *indices) {
    const uint32_t a = indices[3 * count - 3], b = indices[3 * count - 2];
    const uint32_t c = indices[3 * count - 1];
    for (int t = count, end = lanes_of(count); t < end; t++) {
        indices[3 * t] = a;
        indices[3 * t + 1] = b;
        indices[3 * t + 2] = c;
    }
}

static void list_local(uint32_t count, const uint8_t *restrict corners,
                       uint32_t *restrict indices) {
    for (uint32_t t = 0; t < count; t++)
        for (uint32_t k = 0; k < 3; k++)
            indices[3 * t + k] = corners[shb_corner_place(t, k)];
}

static void list_of_mesh(const shb_chunk *chunk, uint32_t *restrict indices) {
    const shb_mesh *mesh = chunk->instance->mesh;
    const uint16_t *narrow = mesh->index_size == 2 ? mesh->indices : NULL;
    const uint32_t *wide = narrow ? NULL : mesh->indices;
    const uint32_t count = chunk->count;
    for (uint32_t t = 0; t < count; t++) {
        const size_t corner = 3 * (size_t)triangle_of(chunk, t);
        for (uint32_t k = 0; k < 3; k++)
            indices[3 * t + k] = wide     ? wide[corner + k]
                                 : narrow ? narrow[corner + k]
                                          : (uint32_t)corner + k;
    }
}

/* The chunk's vertex indices, three a triangle, for all lanes. */
static const uint32_t *list_indices(const shb_chunk *chunk, uint32_t indices[3 * SHB_CHUNK]) {
    const shb_mesh *mesh = chunk->instance->mesh;
    const int count = (int)chunk->count;
    if (chunk->vertices && mesh->indices && mesh->index_size != 2 && !chunk->triangles &&
        count == lanes_of(count))
        return (const uint32_t *)mesh->indices + 3 * (size_t)chunk->first;
    if (chunk->vertices)
        list_of_mesh(chunk, indices);
    else
        list_local(chunk->count, chunk->cluster.corners, indices);
    repeat_last(count, indices);
    return indices;
}

/* Transposes the snapped corners of four triangles at a time. */
static void fetch_snapped(const corner_list *list, chunk_boxes *boxes) {
    for (int t = 0; t < lanes_of(list->count); t += 4) {
        const uint32_t *at = list->indices + 3 * t;
        for (int k = 0; k < 3; k++) {
            uint64_t v[4];
            for (int i = 0; i < 4; i++)
                memcpy(&v[i], &list->vertices[at[3 * i + k]].snapped_x, sizeof v[i]);
            const quad a = (quad)(bits_pair){v[0], v[1]}, b = (quad)(bits_pair){v[2], v[3]};
            *(quad *)&boxes->corner_x[k][t] = __builtin_shufflevector(a, b, 0, 2, 4, 6);
            *(quad *)&boxes->corner_y[k][t] = __builtin_shufflevector(a, b, 1, 3, 5, 7);
        }
    }
}

/* Transposes the corners of four triangles at a time. */
static void fetch_corners(const corner_list *list, chunk_corners *restrict corners) {
    const shb_vertex *const vertices = list->vertices;
    const uint32_t *at = list->indices;
    for (int t = 0, lanes = lanes_of(list->count); t < lanes; t += 4, at += 12)
        for (int k = 0; k < 3; k++)
            wide_transpose(&vertices[at[k]], &vertices[at[3 + k]], &vertices[at[6 + k]],
                           &vertices[at[9 + k]], &corners->x[k][t], &corners->y[k][t],
                           &corners->z[k][t]);
}

/* Differences below 2^15, in boxes of up to 127 samples: twice the areas fit into 32 bits. Returns
 * a negative number if a box is larger. */
static int32_t find_small_areas(int32_t keep_positive, int32_t keep_negative, int count,
                                chunk_boxes *restrict boxes) {
    int32_t larger = 0;
    for (int t = 0; t < lanes_of(count); t++) {
        const int32_t ax = boxes->corner_x[0][t], ay = boxes->corner_y[0][t];
        const int32_t bx = boxes->corner_x[1][t] - ax, by = boxes->corner_y[1][t] - ay;
        const int32_t cx = boxes->corner_x[2][t] - ax, cy = boxes->corner_y[2][t] - ay;
        const int32_t area = (int32_t)((uint32_t)bx * (uint32_t)cy - (uint32_t)cx * (uint32_t)by);
        const int32_t facing = area > 0 ? keep_positive : keep_negative;
        boxes->sign[t] = area < 0 ? -1 : 1;
        boxes->kept[t] = area == 0 ? 0 : facing & boxes->seen[t];
        larger |= (126 - boxes->width[t]) | (126 - boxes->height[t]);
    }
    return larger;
}

/* Differences stay below 2^23, products below 2^46: exact in double. */
static void find_large_areas(double keep_positive, double keep_negative, int count,
                             chunk_boxes *restrict boxes) {
    for (int t = 0; t < lanes_of(count); t++) {
        const int32_t ax = boxes->corner_x[0][t], ay = boxes->corner_y[0][t];
        const double bx = boxes->corner_x[1][t] - ax, by = boxes->corner_y[1][t] - ay;
        const double cx = boxes->corner_x[2][t] - ax, cy = boxes->corner_y[2][t] - ay;
        const double area = bx * cy - cx * by;
        const double facing = area > 0 ? keep_positive : keep_negative;
        boxes->sign[t] = area < 0 ? -1 : 1;
        boxes->kept[t] = (int32_t)(area == 0 ? 0.0 : facing) & boxes->seen[t];
    }
}

/* The boxes must be known. */
static void find_areas(const shb_draw_instance *instance, int count, chunk_boxes *boxes) {
    if (find_small_areas(instance->keep_positive, instance->keep_negative, count, boxes) < 0)
        find_large_areas(instance->keep_positive, instance->keep_negative, count, boxes);
}

/* Triangles are seen whose vertices are usable and whose box has samples in the rectangle. Returns
 * the part of it that holds all boxes. */
static sample_rectangle find_boxes(int count, sample_rectangle within,
                                   chunk_boxes *restrict boxes) {
    const int32_t x0 = within.left, y0 = within.top, x1 = within.right, y1 = within.bottom;
    int32_t first_x = x1, first_y = y1, last_x = x0, last_y = y0;
    for (int t = 0; t < lanes_of(count); t++) {
        const int32_t ax = boxes->corner_x[0][t], ay = boxes->corner_y[0][t];
        const int32_t bx = boxes->corner_x[1][t], by = boxes->corner_y[1][t];
        const int32_t cx = boxes->corner_x[2][t], cy = boxes->corner_y[2][t];
        const int32_t lo_x = MIN(ax, MIN(bx, cx)), hi_x = MAX(ax, MAX(bx, cx));
        const int32_t lo_y = MIN(ay, MIN(by, cy)), hi_y = MAX(ay, MAX(by, cy));
        const int32_t left = (lo_x + 127) >> 8, right = (hi_x - 129) >> 8;
        const int32_t top = (lo_y + 127) >> 8, bottom = (hi_y - 129) >> 8;
        const int32_t columns = MIN(right, x1 - 1) - MAX(left, x0);
        const int32_t rows = MIN(bottom, y1 - 1) - MAX(top, y0);
        boxes->x[t] = left;
        boxes->y[t] = top;
        boxes->width[t] = right - left + 1;
        boxes->height[t] = bottom - top + 1;
        boxes->seen[t] = (columns | rows | (SHB_UNUSABLE - 1 - hi_x)) < 0 ? 0 : 1;
        first_x = MIN(first_x, left);
        first_y = MIN(first_y, top);
        last_x = MAX(last_x, right);
        last_y = MAX(last_y, bottom);
    }
    return (sample_rectangle){MAX(first_x, x0), MAX(first_y, y0), MIN(last_x + 1, x1),
                              MIN(last_y + 1, y1)};
}

/* How many triangles are kept. */
static uint32_t count_kept(int count, const chunk_boxes *boxes) {
    int32_t kept = 0;
    for (int t = 0; t < lanes_of(count); t++)
        kept += boxes->kept[t];
    return (uint32_t)kept;
}

/* How many kept triangles have the first sample that they have in the target in the tile. */
static uint32_t count_own(int count, const shb_tile *tile, const chunk_boxes *boxes) {
    const int32_t left = tile->x0 == 0 ? INT32_MIN : tile->x0;
    const int32_t top = tile->y0 == 0 ? INT32_MIN : tile->y0;
    int32_t own = 0;
    for (int t = 0; t < lanes_of(count); t++)
        own += boxes->x[t] < left || boxes->y[t] < top ? 0 : boxes->kept[t];
    return (uint32_t)own;
}

/* Everything about fetched triangles up to their boxes, which are reduced to the part of the
 * rectangle that holds them. Returns how many are kept. */
static uint32_t look_at_corners(const shb_draw_instance *instance, const corner_list *list,
                                sample_rectangle *rectangle, chunk_boxes *boxes) {
    *rectangle = find_boxes(list->count, *rectangle, boxes);
    find_areas(instance, list->count, boxes);
    for (int t = list->count; t < lanes_of(list->count); t++)
        boxes->kept[t] = 0;
    return count_kept(list->count, boxes);
}

/* Unsigned arithmetic wraps where a box is too large for 32 bits; such values are not used. */
static void set_up_edges(int count, const chunk_boxes *restrict boxes,
                         chunk_planes *restrict planes) {
    for (int k = 0; k < 3; k++) {
        const int next = k == 2 ? 0 : k + 1;
        for (int t = 0; t < lanes_of(count); t++) {
            const int32_t sign = boxes->sign[t];
            const int32_t px = boxes->corner_x[k][t], py = boxes->corner_y[k][t];
            const int32_t dx = (boxes->corner_x[next][t] - px) * sign;
            const int32_t dy = (boxes->corner_y[next][t] - py) * sign;
            const int32_t to_x = boxes->x[t] * 256 + 128 - px;
            const int32_t to_y = boxes->y[t] * 256 + 128 - py;
            const uint32_t value = (uint32_t)dx * (uint32_t)to_y - (uint32_t)dy * (uint32_t)to_x;
            const int32_t top_left = dy < 0 ? 0 : -1;
            const int32_t bias = dy == 0 ? dx >> 31 : top_left;
            planes->edge[k][t] = (int32_t)(value + (uint32_t)bias) >> 8;
            planes->edge_x[k][t] = -dy;
            planes->edge_y[k][t] = dx;
        }
    }
}

/* The edges at the samples of a box of up to two by two, negative outside. */
static inline __attribute__((always_inline)) void find_tiny_edges(const chunk_planes *planes, int t,
                                                                  int32_t edges[4]) {
    const int32_t a = planes->edge[0][t], ax = planes->edge_x[0][t], ay = planes->edge_y[0][t];
    const int32_t b = planes->edge[1][t], bx = planes->edge_x[1][t], by = planes->edge_y[1][t];
    const int32_t c = planes->edge[2][t], cx = planes->edge_x[2][t], cy = planes->edge_y[2][t];
    edges[0] = a | b | c;
    edges[1] = (a + ax) | (b + bx) | (c + cx);
    edges[2] = (a + ay) | (b + by) | (c + cy);
    edges[3] = (a + ax + ay) | (b + bx + by) | (c + cx + cy);
}

/* Keeps no triangle that is so small that it lies between all samples; returns how many are kept.
 */
static uint32_t drop_missed(int count, const chunk_planes *restrict planes,
                            chunk_boxes *restrict boxes) {
    for (int t = 0; t < lanes_of(count); t++) {
        int32_t edges[4];
        find_tiny_edges(planes, t, edges);
        const int32_t not_tiny = (2 - boxes->width[t]) | (2 - boxes->height[t]);
        const int32_t missed = (edges[0] & edges[1] & edges[2] & edges[3]) & ~not_tiny;
        boxes->kept[t] = missed < 0 ? 0 : boxes->kept[t];
    }
    return count_kept(count, boxes);
}

/* Conditions are numbers, 1 or 0, so that the loop stays in vectors of doubles. */
static void set_up_depths(int count, const chunk_corners *restrict corners,
                          const chunk_boxes *restrict boxes, chunk_planes *restrict planes) {
    for (int t = 0; t < lanes_of(count); t++) {
        const double x0 = corners->x[0][t], y0 = corners->y[0][t], z0 = corners->z[0][t];
        const double dx1 = corners->x[1][t] - x0, dx2 = corners->x[2][t] - x0;
        const double dy1 = corners->y[1][t] - y0, dy2 = corners->y[2][t] - y0;
        const double z1 = corners->z[1][t], z2 = corners->z[2][t];
        const double dz1 = z1 - z0, dz2 = z2 - z0;
        const double area = dx1 * dy2 - dx2 * dy1;
        const double gx = (dz1 * dy2 - dz2 * dy1) / area;
        const double gy = (dx1 * dz2 - dx2 * dz1) / area;
        const double to_x = ((double)boxes->x[t] + 0.5) - x0;
        const double to_y = ((double)boxes->y[t] + 0.5) - y0;
        const double base = (z0 + gx * to_x) + gy * to_y;
        const double lo = MIN(z0, MIN(z1, z2)), hi = MAX(z0, MAX(z1, z2));
        const double steep_x = fabs(gx), steep_y = fabs(gy);
        double usable = steep_x <= SHB_PLANE_MAX ? 1.0 : 0.0;
        usable = steep_y <= SHB_PLANE_MAX ? usable : 0.0;
        usable = fabs(base) <= SHB_PLANE_MAX ? usable : 0.0;
        const double width = boxes->width[t], height = boxes->height[t];
        const double smallest = MIN(fabs(lo), fabs(hi));
        double plain = steep_x * width + steep_y * height <= 0.5 * smallest ? usable : 0.0;
        plain = width * height <= 128 * fabs(area) ? plain : 0.0;
        plain = steep_x + steep_y <= 16 * (hi - lo) ? plain : 0.0;
        plain = smallest >= 0x1p-64 ? plain : 0.0;
        plain = smallest <= 0x1p64 ? plain : 0.0;
        planes->base[t] = usable > 0 ? base : ((z0 + z1) + z2) / 3;
        planes->step_x[t] = usable > 0 ? gx : 0.0;
        planes->step_y[t] = usable > 0 ? gy : 0.0;
        planes->lo[t] = lo;
        planes->hi[t] = MIN(hi, SHB_DEPTH_CEILING);
        planes->plain[t] = (int32_t)plain;
        planes->depth[t] = (float)base;
        planes->depth_x[t] = (float)gx;
        planes->depth_y[t] = (float)gy;
    }
}

/* Edges of a block of samples, in 32 bits. An edge that covers the whole block is 0 everywhere. */
typedef struct block_edges {
    int32_t value[3], step_x[3], step_y[3];
} block_edges;

/* The edges at the box's first sample, in 64 bits. Those of a box that find_small_areas is for are
 * known already. */
static void find_wide_edges(const chunk_boxes *boxes, const chunk_planes *planes, int t,
                            int64_t first[3]) {
    if (boxes->width[t] < 128 && boxes->height[t] < 128) {
        for (int k = 0; k < 3; k++)
            first[k] = planes->edge[k][t];
        return;
    }
    for (int k = 0; k < 3; k++) {
        const int64_t dx = planes->edge_y[k][t], dy = -(int64_t)planes->edge_x[k][t];
        const int64_t to_x = (int64_t)boxes->x[t] * 256 + 128 - boxes->corner_x[k][t];
        const int64_t to_y = (int64_t)boxes->y[t] * 256 + 128 - boxes->corner_y[k][t];
        const int64_t bias = -((dy > 0) | ((dy == 0) & (dx < 0)));
        first[k] = (dx * to_y - dy * to_x + bias) >> 8;
    }
}

/* The edges of the block that starts i columns and j rows from the box's first sample; false if one
 * of them rejects the whole block. An edge that crosses the block is at most
 * (|step_x| + |step_y|) * 80 < 2^31 anywhere in it. */
static bool find_block_edges(const chunk_planes *planes, int t, const int64_t first[3], int32_t i,
                             int32_t j, int32_t width, int32_t height, block_edges *edges) {
    for (int k = 0; k < 3; k++) {
        const int64_t step_x = planes->edge_x[k][t], step_y = planes->edge_y[k][t];
        const int64_t corner = first[k] + step_x * i + step_y * j;
        const int64_t across = step_x * (width - 1), down = step_y * (height - 1);
        const int64_t lo = corner + MIN(across, 0) + MIN(down, 0);
        const int64_t hi = corner + MAX(across, 0) + MAX(down, 0);
        if (hi < 0)
            return false;
        const bool covers = lo >= 0;
        edges->value[k] = covers ? 0 : (int32_t)corner;
        edges->step_x[k] = covers ? 0 : (int32_t)step_x;
        edges->step_y[k] = covers ? 0 : (int32_t)step_y;
    }
    return true;
}
