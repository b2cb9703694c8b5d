/* Vertices: mesh units to window space, the formulas of transform.h and setup.h. */

#define VERTEX_BLOCK 128

typedef double pair __attribute__((vector_size(16)));
typedef uint64_t bits_pair __attribute__((vector_size(16)));

typedef struct vertex_block {
    SHB_ALIGN double x[VERTEX_BLOCK];
    double y[VERTEX_BLOCK], z[VERTEX_BLOCK], w[VERTEX_BLOCK];
    uint64_t code[VERTEX_BLOCK];
    uint64_t snapped[VERTEX_BLOCK]; /* x in the lower half, y in the upper one */
} vertex_block;

static void load_positions(const shb_transform_job *job, size_t first, size_t count,
                           vertex_block *block) {
    const size_t stride = job->stride;
    const float *restrict x = job->positions[0] + first * stride;
    const float *restrict y = job->positions[1] + first * stride;
    const float *restrict z = job->positions[2] + first * stride;
    for (size_t i = 0; i < count && stride == 1; i++) {
        block->x[i] = (double)x[i];
        block->y[i] = (double)y[i];
        block->z[i] = (double)z[i];
    }
    for (size_t i = 0; i < count && stride != 1; i++) {
        block->x[i] = (double)x[i * stride];
        block->y[i] = (double)y[i * stride];
        block->z[i] = (double)z[i * stride];
    }
}

static inline __attribute__((always_inline)) double distance(const shb_clip_plane *plane,
                                                             double coordinate, double w) {
    return plane->sign * coordinate + plane->offset * w;
}

/* To clip space. True if all vertices lie within the target's borders and not behind the near
 * plane: then all are usable and have no code. */
static inline __attribute__((always_inline)) bool
to_clip_space(const shb_transform_job *job, size_t count, bool affine, vertex_block *block) {
    const double *m = job->clip_from_mesh;
    const shb_clip_plane near = job->volume->cut[0];
    uint64_t outside = 0;
    for (size_t i = 0; i < count; i++) {
        const double px = block->x[i], py = block->y[i], pz = block->z[i];
        const double x = ((m[0] * px + m[4] * py) + m[8] * pz) + m[12];
        const double y = ((m[1] * px + m[5] * py) + m[9] * pz) + m[13];
        const double z = ((m[2] * px + m[6] * py) + m[10] * pz) + m[14];
        const double w = affine ? 1.0 : ((m[3] * px + m[7] * py) + m[11] * pz) + m[15];
        const bool inside = (fabs(x) <= w) & (fabs(y) <= w) & (fabs(z) <= SHB_CLIP_MAX) &
                            (distance(&near, z, w) >= 0) & (affine | (w >= SHB_W_MIN)) &
                            (affine | (w <= SHB_CLIP_MAX));
        outside |= inside ? 0u : 1u;
        block->x[i] = x;
        block->y[i] = y;
        block->z[i] = z;
        block->w[i] = w;
    }
    return outside == 0;
}

/* Finds the codes. What is not usable moves to the origin, with a w of 1. */
static void find_codes(const shb_transform_job *job, size_t count, vertex_block *block) {
    const shb_clip_plane *cut = job->volume->cut;
    for (size_t i = 0; i < count; i++) {
        const double x = block->x[i], y = block->y[i], z = block->z[i], w = block->w[i];
        const bool finite = (fabs(x) <= SHB_CLIP_MAX) & (fabs(y) <= SHB_CLIP_MAX) &
                            (fabs(z) <= SHB_CLIP_MAX) & (fabs(w) <= SHB_CLIP_MAX);
        const double near = distance(&cut[0], z, w);
        const double left = distance(&cut[1], x, w), right = distance(&cut[2], x, w);
        const double top = distance(&cut[3], y, w), bottom = distance(&cut[4], y, w);
        const bool usable = finite & (w >= SHB_W_MIN) & (near >= 0) & (left >= 0) & (right >= 0) &
                            (top >= 0) & (bottom >= 0);
        block->code[i] = (usable ? 0u : SHB_CODE_UNUSABLE) | (finite ? 0u : SHB_CODE_NOT_FINITE) |
                         (x + w < 0 ? 4u : 0u) | (w - x < 0 ? 8u : 0u) | (y + w < 0 ? 16u : 0u) |
                         (w - y < 0 ? 32u : 0u);
        block->x[i] = usable ? x : 0.0;
        block->y[i] = usable ? y : 0.0;
        block->z[i] = usable ? z : 0.0;
        block->w[i] = usable ? w : 1.0;
    }
}

static inline __attribute__((always_inline)) void
to_window_space(const shb_transform_job *job, size_t count, bool affine, vertex_block *block) {
    const double half_width = job->half_width, half_height = job->half_height;
    for (size_t i = 0; i < count; i++) {
        const double inverse_w = affine ? 1.0 : 1.0 / block->w[i];
        block->x[i] = (block->x[i] * inverse_w) * half_width + half_width;
        block->y[i] = (block->y[i] * inverse_w) * -half_height + half_height;
        block->z[i] = block->z[i] * inverse_w;
    }
}

/* Adding 1.5 * 2^52 leaves the rounded number in the lower half of the bits. */
static inline uint64_t snap_bits(double pixels) {
    const double rounded = pixels * 256 + 0x1.8p52;
    uint64_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    return bits;
}

static void snap_vertices(size_t count, vertex_block *block) {
    for (size_t i = 0; i < count; i++)
        block->snapped[i] = (snap_bits(block->x[i]) & 0xffffffffu) | snap_bits(block->y[i]) << 32;
}

/* Puts codes in the place of what is not usable. True if there is any. */
static bool mark_unusable(size_t count, vertex_block *block) {
    uint64_t codes = 0;
    for (size_t i = 0; i < count; i++) {
        const uint64_t code = block->code[i];
        block->snapped[i] =
            code & SHB_CODE_UNUSABLE ? SHB_UNUSABLE | code << 32 : block->snapped[i];
        codes |= code;
    }
    return (codes & SHB_CODE_UNUSABLE) != 0;
}

/* True if a vertex is not usable. */
static inline __attribute__((always_inline)) bool
transform_block(const shb_transform_job *job, size_t count, bool affine, vertex_block *block) {
    const bool inside = to_clip_space(job, count, affine, block);
    if (!inside)
        find_codes(job, count, block);
    to_window_space(job, count, affine, block);
    snap_vertices(count, block);
    return !inside && mark_unusable(count, block);
}

/* Two vertices at a time. */
static void store_vertices(size_t count, const vertex_block *block, shb_vertex *vertices) {
    size_t i = 0;
    for (; i + 2 <= count; i += 2) {
        const pair x = *(const pair *)&block->x[i], y = *(const pair *)&block->y[i];
        const pair z = *(const pair *)&block->z[i];
        const pair snapped = (pair)(*(const bits_pair *)&block->snapped[i]);
        pair *halves = (pair *)(void *)&vertices[i];
        halves[0] = (pair){x[0], y[0]};
        halves[1] = (pair){z[0], snapped[0]};
        halves[2] = (pair){x[1], y[1]};
        halves[3] = (pair){z[1], snapped[1]};
    }
    if (i < count)
        vertices[i] = (shb_vertex){block->x[i], block->y[i], block->z[i],
                                   (int32_t)(uint32_t)block->snapped[i],
                                   (int32_t)(uint32_t)(block->snapped[i] >> 32)};
}

static bool transform(const shb_transform_job *job) {
    vertex_block block;
    bool any_coded = false;
    for (size_t first = 0; first < job->count; first += VERTEX_BLOCK) {
        const size_t left = job->count - first;
        const size_t count = left < VERTEX_BLOCK ? left : VERTEX_BLOCK;
        load_positions(job, first, count, &block);
        any_coded |= job->affine ? transform_block(job, count, true, &block)
                                 : transform_block(job, count, false, &block);
        store_vertices(count, &block, job->vertices + first);
    }
    return any_coded;
}

/* Clusters follow each other in memory: the next one is asked for while this one is drawn. (gcc
 * leaves out calls to functions that do no more than that.) */
static inline __attribute__((always_inline)) void prefetch_next(const shb_seen_cluster *cluster) {
    const char *next = (const char *)(cluster->positions + 3 * cluster->places);
    for (size_t line = 0; line < 3 * sizeof(float) * cluster->places; line += 64)
        __builtin_prefetch(next + line);
    for (size_t line = 0; line < 3 * SHB_CHUNK; line += 64)
        __builtin_prefetch(cluster->corners + 3 * SHB_CHUNK + line);
}

/* The chunk's vertices, transformed into local where they are those of a cluster. */
static const shb_vertex *vertices_of(const shb_chunk *chunk,
                                     shb_vertex local[SHB_CLUSTER_VERTICES]) {
    if (chunk->vertices)
        return chunk->vertices;
    const shb_transform_job job = shb_cluster_job(chunk, local);
    prefetch_next(&chunk->cluster);
    transform(&job);
    return local;
}
