/* A chunk of triangles into a tile: classes by size, each with a loop of its own.
 *
 * Before inclusion the instruction set's file has defined NARROW and WIDE (the numbers of lanes for
 * small and for larger triangles) and included k_rows.inl for each of them. */

/* How a triangle is drawn, small ones first. Rows are plain and lie in the tile: in one narrow
 * vector 1 .. 8 rows or an even number of up to 16, in PAIR samples or two PAIRs an even number of
 * up to 16. */
enum {
    CLASS_NONE = 0,
    CLASS_SINGLE = 1, /* one sample */
    CLASS_TINY = 2,
    CLASS_NARROW = 3, /* one row; twelve classes */
    CLASS_PAIR = 15,  /* two rows; eight classes */
    CLASS_PAIRS = 23, /* two rows of several pairs; eight classes */
    CLASS_SMALL = 31,
    CLASS_SMALL_CAREFUL,
    CLASS_LARGE,
    CLASS_LARGE_CAREFUL
};

#define PAIR (2 * NARROW)
#define ROWS_EXACT 8
#define ROWS_MAX 16

/* Two pairs where vectors are short, of depth alone: triangles that wide were nearly half of the
 * time without a class of their own. Of more layers what lies beside the box costs as much. */
static inline int32_t rows_width(int layers) {
    return NARROW == 4 && layers == 0 ? 2 * PAIR : PAIR;
}

/* Returns the highest class of all. Comparisons are written as signs of differences, which stay
 * within 2^17: vectors of integers. */
static uint8_t classify(int count, int layers, const shb_tile *tile,
                        const chunk_boxes *restrict boxes, const chunk_planes *restrict planes,
                        uint8_t classes[SHB_CHUNK]) {
    int32_t wide[SHB_CHUNK];
    uint8_t highest = CLASS_NONE;
    const int32_t x0 = tile->x0, y0 = tile->y0, x1 = tile->x1, y1 = tile->y1;
    const int32_t rows_most = rows_width(layers);
    for (int t = 0; t < lanes_of(count); t++) {
        const int32_t x = boxes->x[t], y = boxes->y[t];
        const int32_t width = boxes->width[t], height = boxes->height[t];
        const int32_t pairs = (height + 1) >> 1;
        const int32_t not_small = (SHB_SMALL - width) | (SHB_SMALL - height);
        const int32_t outside = (x - x0) | (y - y0) | (x1 - x - width) | (y1 - y - 2 * pairs);
        const int32_t not_rows = outside | (rows_most - width) | (ROWS_MAX - height);
        const int32_t not_tiny = outside | (2 - width) | (2 - height) | (x1 - x - 2);
        const int32_t not_single = not_tiny | (1 - width) | (1 - height);
        const int32_t careful = not_small < 0 ? CLASS_LARGE_CAREFUL : CLASS_SMALL_CAREFUL;
        const int32_t even = CLASS_NARROW + ROWS_EXACT / 2 - 1 + pairs;
        const int32_t narrow = ROWS_EXACT - height < 0 ? even : CLASS_NARROW - 1 + height;
        const int32_t wider = (PAIR - width) >> 31 & (CLASS_PAIRS - CLASS_PAIR);
        const int32_t rows = NARROW - width < 0 ? CLASS_PAIR - 1 + pairs + wider : narrow;
        int32_t class = not_small < 0 ? CLASS_LARGE : CLASS_SMALL;
        class = not_rows < 0 ? class : rows;
        class = not_tiny < 0 ? class : CLASS_TINY;
        class = not_single < 0 ? class : CLASS_SINGLE;
        class = planes->plain[t] == 0 ? careful : class;
        wide[t] = boxes->kept[t] == 0 ? CLASS_NONE : class;
    }
    for (int t = 0; t < lanes_of(count); t++)
        classes[t] = (uint8_t)wide[t];
    memset(classes + lanes_of(count), CLASS_NONE, (size_t)(SHB_CHUNK - lanes_of(count)));
    for (int t = 0; t < SHB_CHUNK; t++)
        highest = classes[t] > highest ? classes[t] : highest;
    return highest;
}

static bool has_class(const uint8_t classes[SHB_CHUNK], uint8_t class) {
    return (wide_equal_bytes(classes, class) | wide_equal_bytes(classes + 64, class)) != 0;
}

/* The four samples of each tiny triangle, row by row: its depth, or beyond the far depth where it
 * is outside. */
typedef struct tiny_samples {
    SHB_ALIGN float depth[SHB_CHUNK][4];
} tiny_samples;

static inline __attribute__((always_inline)) void
sample_tiny_with(int count, const chunk_planes *restrict planes, const float *restrict anchors,
                 tiny_samples *restrict samples) {
    const float outside = 2.0f;
    for (int t = 0; t < lanes_of(count); t++) {
        int32_t edges[4];
        find_tiny_edges(planes, t, edges);
        float depth[4] = {planes->depth[t], 0, planes->depth[t] + planes->depth_y[t], 0};
        depth[1] = depth[0] + planes->depth_x[t];
        depth[3] = depth[2] + planes->depth_x[t];
        for (int i = 0; i < 4; i++)
            samples->depth[t][i] =
                edges[i] < 0 ? outside : (anchors ? anchors[t] + depth[i] : depth[i]);
    }
}

static void sample_tiny(int count, int layers, const chunk_planes *planes, tiny_samples *samples) {
    if (layers & LAYER_PLANES)
        sample_tiny_with(count, planes, planes->anchor, samples);
    else
        sample_tiny_with(count, planes, NULL, samples);
}

typedef float quad_floats __attribute__((vector_size(16)));

/* Two by two samples of a layer. */
static inline quad load_square(const void *texels, ptrdiff_t stride) {
    uint64_t rows[2];
    memcpy(&rows[0], texels, sizeof rows[0]);
    memcpy(&rows[1], (const float *)texels + stride, sizeof rows[1]);
    return (quad)(bits_pair){rows[0], rows[1]};
}

static inline void store_square(void *texels, ptrdiff_t stride, quad square) {
    const bits_pair rows = (bits_pair)square;
    memcpy(texels, &rows, sizeof rows[0]);
    memcpy((float *)texels + stride, (const uint64_t *)&rows + 1, sizeof rows[1]);
}

static inline quad pick(quad mask, quad yes, quad no) {
    return (mask & yes) | (~mask & no);
}

static inline __attribute__((always_inline)) void draw_tiny(const shb_tile *tile, int layers,
                                                            const chunk_boxes *boxes,
                                                            const tiny_samples *samples, int t,
                                                            uint32_t id) {
    const ptrdiff_t stride = tile->stride;
    const ptrdiff_t at = (boxes->y[t] - tile->y0) * stride + boxes->x[t] - tile->x0;
    const quad z = load_square(samples->depth[t], 2);
    const quad nearest = load_square(tile->depth + at, stride);
    const quad closer = (quad_floats)z < (quad_floats)nearest;
    store_square(tile->depth + at, stride, pick(closer, z, nearest));
    if (layers & LAYER_IDS) {
        const quad own = (int32_t)id - (quad){0}, old = load_square(tile->ids + at, stride);
        const quad equal = (quad_floats)z == (quad_floats)nearest;
        store_square(tile->ids + at, stride, pick(closer | (equal & (own < old)), own, old));
    }
    if (layers & LAYER_SECOND) {
        const quad second = load_square(tile->second + at, stride);
        const quad loser = pick((quad_floats)z > (quad_floats)nearest, z, nearest);
        const quad next = (quad_floats)loser < (quad_floats)second;
        store_square(tile->second + at, stride, pick(next, loser, second));
    }
}

static inline __attribute__((always_inline)) void merge_sample(const shb_tile *tile, int layers,
                                                               ptrdiff_t at, float z, uint32_t id) {
    const float nearest = tile->depth[at];
    if (layers & LAYER_IDS) {
        const bool wins = (z < nearest) | ((z == nearest) & ((int32_t)id < (int32_t)tile->ids[at]));
        tile->ids[at] = wins ? id : tile->ids[at];
    }
    if (layers & LAYER_SECOND) {
        const float loser = MAX(z, nearest);
        tile->second[at] = MIN(loser, tile->second[at]);
    }
    tile->depth[at] = MIN(z, nearest);
}

/* The only sample of a triangle that covers it. */
static inline __attribute__((always_inline)) void draw_single(const shb_tile *tile, int layers,
                                                              const chunk_boxes *boxes,
                                                              const chunk_planes *planes, int t,
                                                              uint32_t id) {
    const ptrdiff_t at = (boxes->y[t] - tile->y0) * tile->stride + boxes->x[t] - tile->x0;
    const float z = planes->depth[t];
    merge_sample(tile, layers, at, layers & LAYER_PLANES ? planes->anchor[t] + z : z, id);
}

/* Where so many columns, which begin with the triangle's box, lie in the tile. */
static inline int32_t left_of(const shb_tile *tile, const chunk_boxes *boxes, int t,
                              int32_t columns) {
    return MIN(boxes->x[t], tile->x1 - columns);
}

/* Calls draw for every triangle of the half chunk that is of the class. */
#define FOR_CLASS(class, draw)                                                                     \
    for (uint64_t members = wide_equal_bytes(classes + half, (class)); members;                    \
         members &= members - 1) {                                                                 \
        const int t = half + __builtin_ctzll(members);                                             \
        const uint32_t id = ids[t];                                                                \
        draw;                                                                                      \
    }

#define NARROW_DRAW(name) SHB_JOIN(name, NARROW)
#define WIDE_DRAW(name) SHB_JOIN(name, WIDE)
#define DRAW_NARROW(class, rows)                                                                   \
    FOR_CLASS(CLASS_NARROW - 1 + (class),                                                          \
              NARROW_DRAW(draw_rows)(tile, layers, boxes, planes, t, id,                           \
                                     left_of(tile, boxes, t, NARROW), NARROW, rows))
#define DRAW_PAIR(rows)                                                                            \
    FOR_CLASS(CLASS_PAIR - 1 + (rows) / 2,                                                         \
              WIDE_DRAW(draw_rows)(tile, layers, boxes, planes, t, id,                             \
                                   left_of(tile, boxes, t, PAIR), PAIR, rows))
#define DRAW_PAIRS(rows)                                                                           \
    FOR_CLASS(CLASS_PAIRS - 1 + (rows) / 2, {                                                      \
        const int32_t left = left_of(tile, boxes, t, 2 * PAIR);                                    \
        WIDE_DRAW(draw_rows)(tile, layers, boxes, planes, t, id, left, PAIR, rows);                \
        WIDE_DRAW(draw_rows)(tile, layers, boxes, planes, t, id, left + PAIR, PAIR, rows);         \
    })

static inline __attribute__((always_inline)) void
draw_classes(const uint32_t ids[SHB_CHUNK], const shb_tile *tile, int layers,
             const chunk_boxes *boxes, const chunk_planes *planes, const tiny_samples *samples,
             const uint8_t classes[SHB_CHUNK], uint8_t highest) {
    for (int half = 0; half < SHB_CHUNK; half += 64) {
        FOR_CLASS(CLASS_SINGLE, draw_single(tile, layers, boxes, planes, t, id))
        FOR_CLASS(CLASS_TINY, draw_tiny(tile, layers, boxes, samples, t, id))
        DRAW_NARROW(1, 1)
        DRAW_NARROW(2, 2)
        DRAW_NARROW(3, 3)
        DRAW_NARROW(4, 4)
        DRAW_NARROW(5, 5)
        DRAW_NARROW(6, 6)
        DRAW_NARROW(7, 7)
        DRAW_NARROW(8, 8)
        DRAW_NARROW(9, 10)
        DRAW_NARROW(10, 12)
        DRAW_NARROW(11, 14)
        DRAW_NARROW(12, 16)
        if (highest < CLASS_PAIR)
            continue;
        DRAW_PAIR(2)
        DRAW_PAIR(4)
        DRAW_PAIR(6)
        DRAW_PAIR(8)
        DRAW_PAIR(10)
        DRAW_PAIR(12)
        DRAW_PAIR(14)
        DRAW_PAIR(16)
        if (rows_width(layers) > PAIR) {
            DRAW_PAIRS(2)
            DRAW_PAIRS(4)
            DRAW_PAIRS(6)
            DRAW_PAIRS(8)
            DRAW_PAIRS(10)
            DRAW_PAIRS(12)
            DRAW_PAIRS(14)
            DRAW_PAIRS(16)
        }
        FOR_CLASS(CLASS_SMALL, WIDE_DRAW(draw_small)(tile, layers, boxes, planes, t, id, true))
        FOR_CLASS(CLASS_SMALL_CAREFUL,
                  WIDE_DRAW(draw_small)(tile, layers, boxes, planes, t, id, false))
        FOR_CLASS(CLASS_LARGE, WIDE_DRAW(draw_large)(tile, layers, boxes, planes, t, id, true))
        FOR_CLASS(CLASS_LARGE_CAREFUL,
                  WIDE_DRAW(draw_large)(tile, layers, boxes, planes, t, id, false))
    }
}

/* Functions of their own, as one for all takes compilers twice as long. */
#define DRAW_LAYERS(name, layers)                                                                  \
    static __attribute__((noinline)) void name(                                                    \
        const uint32_t ids[SHB_CHUNK], const shb_tile *tile, const chunk_boxes *boxes,             \
        const chunk_planes *planes, const tiny_samples *samples, const uint8_t classes[SHB_CHUNK], \
        uint8_t highest) {                                                                         \
        draw_classes(ids, tile, layers, boxes, planes, samples, classes, highest);                 \
    }
DRAW_LAYERS(draw_depths, 0)
DRAW_LAYERS(draw_ids, LAYER_IDS)
DRAW_LAYERS(draw_seconds, LAYER_SECOND)
DRAW_LAYERS(draw_planes, LAYER_IDS | LAYER_PLANES)
DRAW_LAYERS(draw_all, LAYER_IDS | LAYER_SECOND)
#undef DRAW_LAYERS

/* Of the chunk's triangles, or of those listed. */
static void find_ids(const shb_chunk *chunk, int count, const int32_t *list,
                     uint32_t ids[SHB_CHUNK]) {
    const uint32_t first = (uint32_t)chunk->instance->first_triangle;
    for (int i = 0; i < count; i++)
        ids[i] = first + triangle_of(chunk, (uint32_t)(list ? list[i] : i));
}

/* The corners of a chunk's triangle in its mesh. */
static void list_corners(const shb_chunk *chunk, uint32_t triangle, size_t lane,
                         shb_plane_corners *corners) {
    const shb_seen_cluster *cluster = &chunk->cluster;
    if (chunk->vertices) {
        shb_plane_corners_set(corners, lane, chunk->instance->mesh, triangle_of(chunk, triangle));
        return;
    }
    for (uint32_t k = 0; k < 3; k++) {
        const float *x = cluster->positions + cluster->corners[shb_corner_place(triangle, k)];
        for (uint32_t axis = 0; axis < 3; axis++)
            corners->at[k][axis][lane] = x[axis * cluster->places];
    }
}

/* The bounds of the triangles' own planes. False: all are below 2, so none is infinite. */
static bool bound_planes(int count, const shb_corner_errors *errors,
                         const chunk_corners *restrict corners, const chunk_boxes *restrict boxes,
                         const chunk_planes *restrict planes, double *restrict bounds) {
    const shb_corner_errors off = *errors;
    uint64_t bits = 0;
    for (int t = 0; t < lanes_of(count); t++) {
        const double x0 = corners->x[0][t], y0 = corners->y[0][t];
        const double dx1 = corners->x[1][t] - x0, dx2 = corners->x[2][t] - x0;
        const double dy1 = corners->y[1][t] - y0, dy2 = corners->y[2][t] - y0;
        const double z0 = corners->z[0][t], z1 = corners->z[1][t], z2 = corners->z[2][t];
        bounds[t] = shb_plane_bound(&off, dx1 * dy2 - dx2 * dy1, planes->lo[t],
                                    MAX(z0, MAX(z1, z2)), boxes->width[t], boxes->height[t],
                                    planes->step_x[t], planes->step_y[t]);
        bits |= shb_bits_of_double(bounds[t]);
    }
    return bits >> 62 != 0;
}

/* Takes the planes of kept triangles whose own ones are not good enough. */
static void replace_planes(const shb_chunk *chunk, const shb_plane_finder *finder, int count,
                           const int32_t *list, const chunk_boxes *boxes, chunk_planes *planes,
                           double *bounds) {
    shb_plane_corners corners;
    shb_found_planes found;
    uint8_t lanes[SHB_CHUNK];
    uint32_t doubtful = 0;
    for (int t = 0; t < count; t++)
        if (boxes->kept[t] && bounds[t] == HUGE_VAL) {
            list_corners(chunk, (uint32_t)(list ? list[t] : t), doubtful, &corners);
            lanes[doubtful++] = (uint8_t)t;
        }
    if (doubtful == 0)
        return;
    finder->find(finder, chunk->instance, doubtful, &corners, &found);
    for (uint32_t i = 0; i < doubtful; i++) {
        shb_plane plane;
        const uint8_t t = lanes[i];
        bounds[t] = shb_plane_take(&found, i, boxes->x[t], boxes->y[t], &plane);
        planes->base[t] = plane.z0;
        planes->step_x[t] = plane.gx;
        planes->step_y[t] = plane.gy;
    }
}

/* Makes planes what is drawn, and the slopes what is drawn for ids. */
static void raise_planes(int count, const double *restrict bounds, double slope_scale,
                         const chunk_boxes *restrict boxes, chunk_planes *restrict planes,
                         uint32_t *restrict slopes) {
    for (int t = 0; t < lanes_of(count); t++) {
        shb_plane plane = {.z0 = planes->base[t],
                           .gx = planes->step_x[t],
                           .gy = planes->step_y[t],
                           .lo = planes->lo[t],
                           .hi = planes->hi[t],
                           .is_plain = planes->plain[t] != 0};
        shb_plane_raise(bounds[t], boxes->width[t], boxes->height[t], &plane);
        slopes[t] = shb_slopes_of(plane.gx * slope_scale, plane.gy * slope_scale);
        planes->base[t] = plane.z0;
        planes->hi[t] = plane.hi;
        planes->plain[t] = plane.is_plain;
        planes->anchor[t] = (float)plane.z0;
        planes->depth[t] = (float)(plane.z0 - (double)planes->anchor[t]);
        planes->depth_x[t] = (float)plane.gx;
        planes->depth_y[t] = (float)plane.gy;
    }
}

/* What a map that keeps planes holds of the kept triangles. */
static void take_planes(const shb_chunk *chunk, const shb_plane_finder *finder, int count,
                        const int32_t *list, const chunk_corners *corners, const chunk_boxes *boxes,
                        chunk_planes *planes, uint32_t slopes[SHB_CHUNK]) {
    SHB_ALIGN double bounds[SHB_CHUNK];
    if (bound_planes(count, &chunk->instance->corner_errors, corners, boxes, planes, bounds))
        replace_planes(chunk, finder, count, list, boxes, planes, bounds);
    raise_planes(count, bounds, 1 / finder->slope_unit, boxes, planes, slopes);
}

/* Draws what has been looked at. */
static void draw_corners(const shb_chunk *chunk, const shb_tile *tile, int count,
                         const int32_t *list, const chunk_corners *corners,
                         const chunk_boxes *boxes, chunk_planes *planes) {
    tiny_samples samples;
    uint8_t classes[SHB_CHUNK];
    uint32_t ids[SHB_CHUNK];
    const int layers = (tile->ids ? LAYER_IDS : 0) | (tile->second ? LAYER_SECOND : 0) |
                       (tile->ids && tile->planes ? LAYER_PLANES : 0);
    set_up_depths(count, corners, boxes, planes);
    if (layers & LAYER_PLANES)
        take_planes(chunk, tile->planes, count, list, corners, boxes, planes, ids);
    else if (layers & LAYER_IDS)
        find_ids(chunk, count, list, ids);
    else
        memset(ids, 0, sizeof ids);
    const uint8_t highest = classify(count, layers, tile, boxes, planes, classes);
    if (has_class(classes, CLASS_TINY))
        sample_tiny(count, layers, planes, &samples);
    switch (layers) {
    case 0:
        draw_depths(ids, tile, boxes, planes, &samples, classes, highest);
        break;
    case LAYER_IDS:
        draw_ids(ids, tile, boxes, planes, &samples, classes, highest);
        break;
    case LAYER_SECOND:
        draw_seconds(ids, tile, boxes, planes, &samples, classes, highest);
        break;
    case LAYER_IDS | LAYER_PLANES:
        draw_planes(ids, tile, boxes, planes, &samples, classes, highest);
        break;
    default:
        draw_all(ids, tile, boxes, planes, &samples, classes, highest);
    }
}

/* The part of the cluster's box that lies in the tile. */
static sample_rectangle clip_cluster(const shb_tile *tile, const shb_seen_cluster *cluster) {
    const shb_samples *samples = &cluster->samples;
    return (sample_rectangle){
        MAX(samples->first_column, tile->x0), MAX(samples->first_row, tile->y0),
        MIN(samples->last_column + 1, tile->right), MIN(samples->last_row + 1, tile->y1)};
}

/* A small cluster. False, and nothing is drawn, if one of its triangles is too large. */
static bool draw_pairs(const shb_chunk *chunk, const shb_tile *tile, bool hidden, uint32_t *own) {
    placed_cluster placed;
    kept_pairs kept;
    chunk_corners corners;
    chunk_boxes boxes;
    chunk_planes planes;
    place_cluster(chunk, &placed);
    if (!keep_pairs(chunk, tile, &placed, &kept))
        return false;
    *own = kept.own;
    if (hidden || kept.count == 0)
        return true;
    const sample_rectangle reached = clip_cluster(tile, &chunk->cluster);
    reach(tile, &reached);
    expand_pairs(&chunk->cluster, &kept, &boxes, &planes);
    fetch_kept(chunk->cluster.corners, &kept, placed.vertices, &corners);
    draw_corners(chunk, tile, kept.count, kept.triangle, &corners, &boxes, &planes);
    return true;
}

static uint32_t draw(const shb_chunk *chunk, const shb_tile *tile) {
    const bool hidden = !chunk->vertices && is_cluster_hidden(tile, &chunk->cluster);
    if (hidden && !tile->counts)
        return 0;
    uint32_t own_of_pairs;
    if (!chunk->vertices && chunk->cluster.is_small &&
        draw_pairs(chunk, tile, hidden, &own_of_pairs))
        return own_of_pairs;
    shb_vertex local[SHB_CLUSTER_VERTICES];
    uint32_t listed[3 * SHB_CHUNK];
    chunk_corners corners;
    chunk_boxes boxes;
    chunk_planes planes;
    const corner_list list = {vertices_of(chunk, local), list_indices(chunk, listed),
                              (int)chunk->count};
    sample_rectangle reached = {tile->x0, tile->y0, tile->right, tile->y1};
    fetch_snapped(&list, &boxes);
    if (look_at_corners(chunk->instance, &list, &reached, &boxes) == 0)
        return 0;
    const uint32_t own = count_own(list.count, tile, &boxes);
    if (hidden)
        return own;
    set_up_edges(list.count, &boxes, &planes);
    if (drop_missed(list.count, &planes, &boxes) == 0)
        return own;
    reach(tile, &reached);
    fetch_corners(&list, &corners);
    draw_corners(chunk, tile, list.count, NULL, &corners, &boxes, &planes);
    return own;
}

static void find_tiles(const shb_chunk *chunk, const shb_samples *target, shb_tile_shape shape,
                       shb_chunk_ranges *ranges) {
    const int32_t right = target->last_column, bottom = target->last_row;
    uint32_t listed[3 * SHB_CHUNK];
    chunk_boxes boxes;
    const int count = (int)chunk->count;
    const corner_list list = {chunk->vertices, list_indices(chunk, listed), count};
    sample_rectangle reached = {0, 0, right + 1, bottom + 1};
    fetch_snapped(&list, &boxes);
    look_at_corners(chunk->instance, &list, &reached, &boxes);
    uint32_t kept = 0;
    for (int t = 0; t < count; t++) {
        ranges->triangle[kept] = (uint8_t)t;
        kept += (uint32_t)boxes.kept[t];
    }
    ranges->count = kept;
    for (uint32_t i = 0; i < kept; i++) {
        const int t = ranges->triangle[i];
        const int32_t last_column = boxes.x[t] + boxes.width[t] - 1;
        const int32_t last_row = boxes.y[t] + boxes.height[t] - 1;
        ranges->first_column[i] = (uint16_t)(MAX(boxes.x[t], 0) >> shape.column_bits);
        ranges->first_row[i] = (uint16_t)(MAX(boxes.y[t], 0) >> shape.row_bits);
        ranges->last_column[i] = (uint16_t)(MIN(last_column, right) >> shape.column_bits);
        ranges->last_row[i] = (uint16_t)(MIN(last_row, bottom) >> shape.row_bits);
    }
}
