/* Vertices: mesh units to window space, the formulas of transform.h and setup.h. */

#define VERTEX_BLOCK 64

typedef struct vertex_block {
    SHB_ALIGN double x[VERTEX_BLOCK];
    double y[VERTEX_BLOCK], z[VERTEX_BLOCK], code[VERTEX_BLOCK];
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

/* Whether the vertex is finite, in front of the near plane and inside the guard band. */
static inline bool is_usable(const shb_transform_job *job, const double v[4]) {
    bool usable = (fabs(v[0]) <= SHB_CLIP_MAX) & (fabs(v[1]) <= SHB_CLIP_MAX) &
                  (fabs(v[2]) <= SHB_CLIP_MAX) & (fabs(v[3]) <= SHB_CLIP_MAX) &
                  (v[3] >= SHB_W_MIN);
    usable &= job->plane_sign[0] * v[2] + job->plane_offset[0] * v[3] >= 0;
    usable &= job->plane_sign[1] * v[0] + job->plane_offset[1] * v[3] >= 0;
    usable &= job->plane_sign[2] * v[0] + job->plane_offset[2] * v[3] >= 0;
    usable &= job->plane_sign[3] * v[1] + job->plane_offset[3] * v[3] >= 0;
    usable &= job->plane_sign[4] * v[1] + job->plane_offset[4] * v[3] >= 0;
    return usable;
}

static inline __attribute__((always_inline)) void
transform_block(const shb_transform_job *job, size_t count, bool affine, vertex_block *block) {
    const double *m = job->clip_from_mesh;
    for (size_t i = 0; i < count; i++) {
        const double x = block->x[i], y = block->y[i], z = block->z[i];
        double v[4];
        v[0] = ((m[0] * x + m[4] * y) + m[8] * z) + m[12];
        v[1] = ((m[1] * x + m[5] * y) + m[9] * z) + m[13];
        v[2] = ((m[2] * x + m[6] * y) + m[10] * z) + m[14];
        v[3] = affine ? 1.0 : ((m[3] * x + m[7] * y) + m[11] * z) + m[15];
        const bool usable = is_usable(job, v);
        const double scale = affine ? 1.0 : 1.0 / v[3];
        block->x[i] = usable ? (v[0] * scale) * job->half_width + job->half_width : 0.0;
        block->y[i] = usable ? (v[1] * scale) * -job->half_height + job->half_height : 0.0;
        block->z[i] = usable ? v[2] * scale : 0.0;
        block->code[i] = usable ? 0.0 : 1.0;
    }
}

static void transform(const shb_transform_job *job) {
    vertex_block block;
    for (size_t first = 0; first < job->count; first += VERTEX_BLOCK) {
        const size_t left = job->count - first;
        const size_t count = left < VERTEX_BLOCK ? left : VERTEX_BLOCK;
        load_positions(job, first, count, &block);
        if (job->affine)
            transform_block(job, count, true, &block);
        else
            transform_block(job, count, false, &block);
        for (size_t i = 0; i < count; i++)
            job->vertices[first + i] =
                (shb_vertex){block.x[i], block.y[i], block.z[i], block.code[i]};
    }
}
