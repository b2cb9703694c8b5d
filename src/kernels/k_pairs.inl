/* Clusters that are small in the target: snapped coordinates, counted from the middle of what 16
 * bits reach, are pairs of 16 bits, and products of their differences fit into 32. Triangles that
 * cover no sample are left out before anything of their depth is looked at. The formulas are those
 * of k_transform.inl and k_setup.inl. */

/* A cluster's vertices in window space. */
typedef struct placed_cluster {
    SHB_ALIGN shb_vertex vertices[SHB_CLUSTER_VERTICES]; /* without what is snapped */
    int32_t pairs[SHB_CLUSTER_VERTICES];                 /* snapped x, y, from the origin */
} placed_cluster;

typedef uint64_t wide_bits __attribute__((vector_size(8 * DOUBLES)));
typedef int32_t pair_words __attribute__((vector_size(4 * DOUBLES)));

/* Boxes of kept triangles are at most so many samples wide and high: the differences of their
 * corners stay below 2^15. */
#define PAIRS_SIZE_MAX 126

/* Vectors are stored whole, behind what is kept. */
#define PAIRS_ROOM (SHB_CHUNK + WIDE)

/* The triangles of a cluster that may cover samples. */
typedef struct kept_pairs {
    SHB_ALIGN int32_t triangle[PAIRS_ROOM]; /* number in the cluster */
    int32_t box[PAIRS_ROOM];                /* pairs: first sample + 256 * (size - 1) */
    int32_t edge[3][PAIRS_ROOM];
    int32_t step[2][PAIRS_ROOM]; /* pairs: edge_y, edge_x; all three edges' sum is 0 */
    int count;
    uint32_t own; /* how many have their box in the tile */
} kept_pairs;

/* The lowest 16 bits of each number. */
static inline void store_pairs(int32_t *to, wd x, wd y) {
    const wide_bits bits = ((wide_bits)x & 0xffff) | (wide_bits)y << 16;
    const pair_words words = __builtin_convertvector(bits, pair_words);
    memcpy(to, &words, sizeof words);
}

/* Snapped coordinates are the lowest bits of sums with 1.5 * 2^52, less whole samples. */
static inline __attribute__((always_inline)) void place_vertices(const shb_transform_job *job,
                                                                 const shb_seen_cluster *cluster,
                                                                 bool affine,
                                                                 placed_cluster *restrict placed) {
    wd m[16];
    for (int i = 0; i < 16; i++)
        m[i] = wd_splat(job->clip_from_mesh[i]);
    const wd half_width = wd_splat(job->half_width), half_height = wd_splat(job->half_height);
    const wd down = wd_splat(-job->half_height), one = wd_splat(1.0), subpixels = wd_splat(256);
    const wd from_x = wd_splat(0x1.8p52 - 256.0 * cluster->origin_x);
    const wd from_y = wd_splat(0x1.8p52 - 256.0 * cluster->origin_y);
    for (size_t i = 0; i < cluster->places; i += DOUBLES) {
        const wd px = wd_load_floats(job->positions[0] + i);
        const wd py = wd_load_floats(job->positions[1] + i);
        const wd pz = wd_load_floats(job->positions[2] + i);
        wd x = ((m[0] * px + m[4] * py) + m[8] * pz) + m[12];
        wd y = ((m[1] * px + m[5] * py) + m[9] * pz) + m[13];
        wd z = ((m[2] * px + m[6] * py) + m[10] * pz) + m[14];
        if (!affine) {
            const wd inverse_w = one / (((m[3] * px + m[7] * py) + m[11] * pz) + m[15]);
            x = x * inverse_w;
            y = y * inverse_w;
            z = z * inverse_w;
        }
        x = x * half_width + half_width;
        y = y * down + half_height;
        wd_store_quads((double *)(void *)&placed->vertices[i], sizeof(shb_vertex) / sizeof(double),
                       x, y, z, z);
        store_pairs(placed->pairs + i, x * subpixels + from_x, y * subpixels + from_y);
    }
}

static void place_cluster(const shb_chunk *chunk, placed_cluster *placed) {
    const shb_transform_job job = shb_cluster_job(chunk, NULL);
    prefetch_next(&chunk->cluster);
    if (job.affine)
        place_vertices(&job, &chunk->cluster, true, placed);
    else
        place_vertices(&job, &chunk->cluster, false, placed);
}

/* The rectangle in samples from the origin, as far as pairs reach. */
typedef struct pair_rectangle {
    vs first, last, own; /* own: there is nothing before it in the target */
} pair_rectangle;

static inline int32_t clamp_sample(int32_t sample) {
    return MAX(MIN(sample, 128), -129);
}

static pair_rectangle rectangle_of(const shb_tile *tile, int32_t origin_x, int32_t origin_y) {
    const int32_t left = clamp_sample(tile->x0 - origin_x), top = clamp_sample(tile->y0 - origin_y);
    const int32_t right = clamp_sample(tile->right - 1 - origin_x);
    const int32_t bottom = clamp_sample(tile->y1 - 1 - origin_y);
    return (pair_rectangle){vs_splat(left, top), vs_splat(right, bottom),
                            vs_splat(tile->x0 == 0 ? -129 : left, tile->y0 == 0 ? -129 : top)};
}

/* -1 where x or y is negative. */
static inline vi is_any_negative(vs pairs) {
    return ((vi)pairs & (int32_t)0x80008000u) != 0;
}

/* Edges of WIDE triangles, as set_up_edges finds them; -1 where a box of up to two by two samples
 * holds none that is covered. first: the box's first sample. */
static inline __attribute__((always_inline)) vi
find_pair_edges(const vs corners[3], const vs steps[3], vs first, vs size, vi edges[3]) {
    const vs target = vs_times_256(first) + 128;
    vi upper[2] = {vi_splat(0), vi_splat(0)}, lower[2] = {vi_splat(0), vi_splat(0)};
    for (int k = 0; k < 3; k++) {
        /* The upper half less 1, then the lower half: negative, or 0 and the lower half negative */
        const vi bias = ((vi)steps[k] ^ (int32_t)0xffff0000u) >= INT16_MIN;
        const vi sum = vi_dot(steps[k], vs_swap(vs_minus(target, corners[k])));
        const vi edge = (vi)((vu)sum + (vu)bias) >> 8;
        upper[0] |= edge;
        upper[1] |= edge + ((vi)steps[k] >> 16);
        lower[0] |= edge + vi_dot(steps[k], vs_splat(1, 0));
        lower[1] |= edge + vi_dot(steps[k], vs_splat(1, 1));
        edges[k] = edge;
    }
    const vi tiny = ((vi)size & (int32_t)0xfffefffeu) == 0;
    return (upper[0] & upper[1] & lower[0] & lower[1] & tiny) >> 31;
}

/* Finds the triangles that may cover samples of the tile. False if one of them is too large. */
static bool keep_pairs(const shb_chunk *chunk, const shb_tile *tile,
                       const placed_cluster *restrict placed, kept_pairs *restrict kept) {
    const pair_rectangle within =
        rectangle_of(tile, chunk->cluster.origin_x, chunk->cluster.origin_y);
    const vi keep_positive = vi_splat(chunk->instance->keep_positive ? -1 : 0);
    const vi keep_negative = vi_splat(chunk->instance->keep_negative ? -1 : 0);
    const vi upper_half = vi_splat((int32_t)0xffff0000u);
    const vs lower_half = (vs)vi_splat(0xffff);
    vi own = vi_splat(0), larger = vi_splat(0);
    int count = 0;
    for (int t = 0; t < (int)chunk->count; t += WIDE) {
        vs corners[3];
        vs_look_up(placed->pairs, chunk->cluster.vertex_count,
                   chunk->cluster.corners + shb_corner_place((uint32_t)t, 0), corners);
        const vs ab = vs_minus(corners[1], corners[0]), bc = vs_minus(corners[2], corners[1]);
        const vs ca = vs_minus(corners[0], corners[2]);
        const vs lo = vs_min(vs_min(corners[0], corners[1]), corners[2]);
        const vs hi = vs_max(vs_max(corners[0], corners[1]), corners[2]);
        const vs first = (lo + 127) >> 8, size = ((hi - 129) >> 8) - first;
        const vs common = vs_min(first + size, within.last) - vs_max(first, within.first);
        /* ab.y * ca.x - ab.x * ca.y */
        const vi area = vi_dot(vs_minus(ab ^ lower_half, lower_half), vs_swap(ca));
        const vi faces = ((area > 0) & keep_positive) | ((area < 0) & keep_negative);
        const vi dropped = is_any_negative(common) | ~faces;
        /* dx, -dy for a positive area, else -dx, dy */
        const vs negated = (vs)((area >> 31) ^ upper_half);
        const vs steps[3] = {vs_minus(ab ^ negated, negated), vs_minus(bc ^ negated, negated),
                             vs_minus(ca ^ negated, negated)};
        vi edges[3];
        const vi missed = find_pair_edges(corners, steps, first, size, edges);
        const uint32_t bits = ~vi_bits(dropped | missed) & WIDE_BITS;
        own += dropped | is_any_negative(first - within.own);
        larger |= (vi)(size > PAIRS_SIZE_MAX - 1);
        vi_keep(kept->box, t, count, (vi)((first & 0xff) | vs_times_256(size)), bits);
        for (int k = 0; k < 3; k++)
            vi_keep(kept->edge[k], t, count, edges[k], bits);
        for (int k = 0; k < 2; k++)
            vi_keep(kept->step[k], t, count, (vi)steps[k], bits);
        count = vi_keep_places(kept->triangle, t, count, bits);
    }
    int32_t others = 0;
    for (int i = 0; i < WIDE; i++)
        others += own[i];
    kept->count = count;
    kept->own = (chunk->count + WIDE - 1) / WIDE * WIDE + (uint32_t)others;
    return !vi_any((vi)((vu)larger | (vu)larger << 16));
}

/* All but the triangle's number. */
static void copy_kept(kept_pairs *kept, int from, int to) {
    kept->box[to] = kept->box[from];
    for (int k = 0; k < 3; k++)
        kept->edge[k][to] = kept->edge[k][from];
    for (int k = 0; k < 2; k++)
        kept->step[k][to] = kept->step[k][from];
}

/* Moves what was kept apart to the front. */
static void close_up(kept_pairs *kept) {
    for (int i = 0; i < kept->count; i++)
        copy_kept(kept, kept->triangle[i], i);
}

/* The kept triangles' boxes and edges, for all lanes. */
static void expand_pairs(const shb_seen_cluster *cluster, kept_pairs *restrict kept,
                         chunk_boxes *restrict boxes, chunk_planes *restrict planes) {
    const int count = kept->count, lanes = lanes_of(count);
    if (KEEPS_APART)
        close_up(kept);
    for (int i = count; i < lanes; i++) {
        kept->triangle[i] = kept->triangle[count - 1];
        copy_kept(kept, count - 1, i);
    }
    for (int i = 0; i < lanes; i++) {
        const uint32_t box = (uint32_t)kept->box[i];
        boxes->x[i] = cluster->origin_x + (int8_t)(box & 0xff);
        boxes->y[i] = cluster->origin_y + (int8_t)(box >> 16 & 0xff);
        boxes->width[i] = (int32_t)(box >> 8 & 0xff) + 1;
        boxes->height[i] = (int32_t)(box >> 24) + 1;
        boxes->kept[i] = i < count;
        for (int k = 0; k < 3; k++)
            planes->edge[k][i] = kept->edge[k][i];
        for (int k = 0; k < 2; k++) {
            planes->edge_x[k][i] = kept->step[k][i] >> 16;
            planes->edge_y[k][i] = (int16_t)(kept->step[k][i] & 0xffff);
        }
        planes->edge_x[2][i] = -planes->edge_x[0][i] - planes->edge_x[1][i];
        planes->edge_y[2][i] = -planes->edge_y[0][i] - planes->edge_y[1][i];
    }
}

/* The kept triangles' corners, for all lanes. */
static void fetch_kept(const uint8_t *numbers, const kept_pairs *kept, const shb_vertex *vertices,
                       chunk_corners *restrict corners) {
    for (int i = 0; i < lanes_of(kept->count); i += 4) {
        const uint8_t *at[4];
        for (int j = 0; j < 4; j++)
            at[j] = numbers + shb_corner_place((uint32_t)kept->triangle[i + j], 0);
        for (int k = 0; k < 3; k++) {
            const int place = k * SHB_CORNERS_TOGETHER;
            wide_transpose(&vertices[at[0][place]], &vertices[at[1][place]],
                           &vertices[at[2][place]], &vertices[at[3][place]], &corners->x[k][i],
                           &corners->y[k][i], &corners->z[k][i]);
        }
    }
}
