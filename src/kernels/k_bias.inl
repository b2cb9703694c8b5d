/* The stages of the built-in bias methods. */

/* ref = depth - epsilon and no steps. */
static inline ALWAYS_INLINE void write_flat(shb_receivers *restrict r, size_t i, float epsilon) {
    r->ref[i] = r->depth[i] - epsilon;
    r->step_x[i] = 0;
    r->step_y[i] = 0;
}

/* The plane through the fragment: run to the texel's centre, less epsilon. */
static inline ALWAYS_INLINE void write_plane(shb_receivers *restrict r, size_t i, float epsilon) {
    const float slope_x = r->slope_x[i], slope_y = r->slope_y[i];
    const float run = slope_x * r->to_center_x[i] + slope_y * r->to_center_y[i];
    r->ref[i] = (r->depth[i] + run) - epsilon;
    r->step_x[i] = slope_x;
    r->step_y[i] = slope_y;
}

/* Moves the point along its normal, world units. */
static inline ALWAYS_INLINE void move_along_normal(shb_receivers *restrict r, size_t i,
                                                   float distance) {
    r->x[i] += distance * r->normal_x[i];
    r->y[i] += distance * r->normal_y[i];
    r->z[i] += distance * r->normal_z[i];
}

#define FOR_LANES(count) for (size_t i = 0, lanes_ = shb_round_to_lanes(count); i < lanes_; i++)

static void own_depth(size_t count, shb_receivers *restrict r) {
    FOR_LANES (count) {
        r->ref[i] = r->depth[i];
        r->step_x[i] = 0;
        r->step_y[i] = 0;
    }
}

static void constant_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float amount = args->bias->params[0];
    const float unit = args->bias->params[1];
    if (unit == SHB_UNIT_TEXEL)
        FOR_LANES (args->count)
            write_flat(r, i, amount * r->texel_size[i] * r->depth_per_world[i]);
    else if (unit == SHB_UNIT_WORLD)
        FOR_LANES (args->count)
            write_flat(r, i, amount * r->depth_per_world[i]);
    else
        FOR_LANES (args->count)
            write_flat(r, i, amount);
}

static void slope_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float factor = args->bias->params[0];
    const float constant = args->bias->params[1] * 0x1p-24f;
    const float clamp = args->bias->params[2] == 0 ? FLT_MAX : args->bias->params[2];
    FOR_LANES (args->count) {
        const float x = fabsf(r->slope_x[i]), y = fabsf(r->slope_y[i]);
        const float offset = factor * (x > y ? x : y) + constant;
        write_flat(r, i, offset < clamp ? offset : clamp);
    }
}

static void angle_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float scene_scale = (float)args->map->scene_scale;
    const float base = args->bias->params[0] * scene_scale;
    const float limit = args->bias->params[1] * scene_scale;
    FOR_LANES (args->count) {
        const float distance = base / r->cosine[i];
        write_flat(r, i, (distance < limit ? distance : limit) * r->depth_per_world[i]);
    }
}

static void receiver_plane_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float epsilon = args->bias->params[0];
    FOR_LANES (args->count)
        write_plane(r, i, epsilon);
}

static void adaptive_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float epsilon = shb_world_epsilon(args->map, args->bias);
    FOR_LANES (args->count)
        write_plane(r, i, r->depth_per_world[i] * epsilon);
}

static void adaptive_soft_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float epsilon = shb_world_epsilon(args->map, args->bias);
    const float threshold = args->bias->params[2];
    FOR_LANES (args->count) {
        const float steep = 1 / (r->cosine[i] * r->cosine[i]);
        const float factor = steep < threshold ? steep : threshold;
        write_plane(r, i, r->depth_per_world[i] * epsilon * factor);
    }
}

static void normal_offset(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float texels = args->bias->params[0];
    FOR_LANES (args->count) {
        const float sine = sqrtf(1 - r->cosine[i] * r->cosine[i]);
        move_along_normal(r, i, texels * r->texel_size[i] * sine);
    }
}

static void normal_offset_depth(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float depth = args->bias->params[1];
    FOR_LANES (args->count)
        write_flat(r, i, depth);
}

static void texel_cone(const shb_bias_args *args) {
    shb_receivers *restrict r = args->receivers;
    const float half_diagonal = 0.70710678f; /* of a texel of width 1 */
    FOR_LANES (args->count) {
        const float sine = sqrtf(1 - r->cosine[i] * r->cosine[i]);
        const float radius = half_diagonal * r->texel_size[i];
        move_along_normal(r, i, radius * (1.16f * sine + 0.195f));
    }
}
