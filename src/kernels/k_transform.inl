/* Vertices: mesh units to window space, the formulas of transform.h and setup.h. */

#define VERTEX_BLOCK 64

typedef struct vertex_block {
    SHB_ALIGN double x[VERTEX_BLOCK];
    double y[VERTEX_BLOCK], z[VERTEX_BLOCK];
    uint64_t code[VERTEX_BLOCK];
} vertex_block;

static void load_positions(const shb_transform_job *job, size_t first, size_t count,
                           vertex_block *block) {
    const float *p = job->positions + first * job->stride;
    for (size_t i = 0; i < count; i++, p += job->stride) {
        block->x[i] = (double)p[0];
        block->y[i] = (double)p[1];
        block->z[i] = (double)p[2];
    }
}

static inline __attribute__((always_inline)) double distance(const shb_clip_plane *plane,
                                                             double coordinate, double w) {
    return plane->sign * coordinate + plane->offset * w;
}

static inline __attribute__((always_inline)) void
transform_block(const shb_transform_job *job, size_t count, bool affine, vertex_block *block) {
    const double *m = job->clip_from_mesh;
    const shb_clip_plane *cut = job->volume->cut;
    const double half_width = job->half_width, half_height = job->half_height;
    for (size_t i = 0; i < count; i++) {
        const double px = block->x[i], py = block->y[i], pz = block->z[i];
        const double x = ((m[0] * px + m[4] * py) + m[8] * pz) + m[12];
        const double y = ((m[1] * px + m[5] * py) + m[9] * pz) + m[13];
        const double z = ((m[2] * px + m[6] * py) + m[10] * pz) + m[14];
        const double w = affine ? 1.0 : ((m[3] * px + m[7] * py) + m[11] * pz) + m[15];
        const bool finite = (fabs(x) <= SHB_CLIP_MAX) & (fabs(y) <= SHB_CLIP_MAX) &
                            (fabs(z) <= SHB_CLIP_MAX) & (fabs(w) <= SHB_CLIP_MAX);
        const double near = distance(&cut[0], z, w);
        const double left = distance(&cut[1], x, w), right = distance(&cut[2], x, w);
        const double top = distance(&cut[3], y, w), bottom = distance(&cut[4], y, w);
        const bool usable = finite & (w >= SHB_W_MIN) & (near >= 0) & (left >= 0) & (right >= 0) &
                            (top >= 0) & (bottom >= 0);
        const double inverse_w = affine ? 1.0 : 1.0 / w;
        block->x[i] = usable ? (x * inverse_w) * half_width + half_width : 0.0;
        block->y[i] = usable ? (y * inverse_w) * -half_height + half_height : 0.0;
        block->z[i] = usable ? z * inverse_w : 0.0;
        block->code[i] = (usable ? 0u : SHB_CODE_UNUSABLE) | (finite ? 0u : SHB_CODE_NOT_FINITE) |
                         (x + w < 0 ? 4u : 0u) | (w - x < 0 ? 8u : 0u) | (y + w < 0 ? 16u : 0u) |
                         (w - y < 0 ? 32u : 0u);
    }
}

static bool transform(const shb_transform_job *job) {
    vertex_block block;
    uint64_t codes = 0;
    for (size_t first = 0; first < job->count; first += VERTEX_BLOCK) {
        const size_t left = job->count - first;
        const size_t count = left < VERTEX_BLOCK ? left : VERTEX_BLOCK;
        load_positions(job, first, count, &block);
        if (job->affine)
            transform_block(job, count, true, &block);
        else
            transform_block(job, count, false, &block);
        for (size_t i = 0; i < count; i++) {
            codes |= block.code[i];
            job->vertices[first + i] =
                (shb_vertex){block.x[i], block.y[i], block.z[i], block.code[i]};
        }
    }
    return (codes & SHB_CODE_UNUSABLE) != 0;
}
