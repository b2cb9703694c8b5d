/* Fragments of a row of pixels from the runs that they belong to: the formulas of surface.c. */

#define SPREAD(field) wd_spread(runs->field, run_of + i)

/* first + b * way_1 + c * way_2 for one axis of a first vector and the ways to two others. */
#define COMBINE(field, axis)                                                                       \
    combine(SPREAD(field[axis]), SPREAD(field[3 + axis]), SPREAD(field[6 + axis]), b, c)

static inline ALWAYS_INLINE wd combine(wd first, wd way_1, wd way_2, wd b, wd c) {
    return first + (b * way_1 + c * way_2);
}

static inline ALWAYS_INLINE wd weight_of(const shb_surface_runs *runs, const int32_t *run_of,
                                         size_t i, int corner, wd center_x, double center_y) {
    return SPREAD(cofactors[3 * corner]) * center_x + SPREAD(cofactors[3 * corner + 1]) * center_y +
           SPREAD(cofactors[3 * corner + 2]);
}

/* NaN in outside[i]: the pixel's centre lies outside of its triangle, and the fragment is not
 * right. */
static void read_fragments(const shb_pixel_row *row, size_t count, const shb_surface_runs *runs,
                           const int32_t *run_of, shb_fragments *restrict out,
                           float *restrict outside) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const double width = row->width, height = row->height;
    const double center_y = (height - 2.0 * row->row - 1) / height;
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const wd center_x = (2.0 * wd_load_ints(out->pixel_x + i) + 1.0 - width) / width;
        const wd weight_0 = weight_of(runs, run_of, i, 0, center_x, center_y);
        const wd weight_1 = weight_of(runs, run_of, i, 1, center_x, center_y);
        const wd weight_2 = weight_of(runs, run_of, i, 2, center_x, center_y);
        const wd sum = weight_0 + weight_1 + weight_2;
        const wd least = wd_min(wd_min(weight_0, weight_1), weight_2);
        const wd usable = wd_where_greater(sum, zero, sum, none) * 0.0; /* 0 or NaN */
        wd_store_floats(outside + i, wd_where_greater(zero, least, none, usable));

        const wd b = weight_1 / sum, c = weight_2 / sum;
        wd_store_floats(out->weight_1 + i, b);
        wd_store_floats(out->weight_2 + i, c);
        wd_store_floats(out->x + i, COMBINE(corners, 0));
        wd_store_floats(out->y + i, COMBINE(corners, 1));
        wd_store_floats(out->z + i, COMBINE(corners, 2));

        const wd normal_x = SPREAD(normal[0]), normal_y = SPREAD(normal[1]);
        const wd normal_z = SPREAD(normal[2]);
        wd_store_floats(out->normal_x + i, normal_x);
        wd_store_floats(out->normal_y + i, normal_y);
        wd_store_floats(out->normal_z + i, normal_z);

        const wd x = COMBINE(shading, 0), y = COMBINE(shading, 1), z = COMBINE(shading, 2);
        const wd length = wd_sqrt(x * x + y * y + z * z);
        const wd good = wd_where_greater(length, zero, length, none) * 0.0; /* 0 or NaN */
        const wd along = normal_x * x + normal_y * y + normal_z * z;
        const wd scale = wd_where_greater(zero, along, wd_splat(-1.0), one) / length;
        wd_store_floats(out->shading_x + i, wd_where_equal(good, zero, x * scale, normal_x));
        wd_store_floats(out->shading_y + i, wd_where_equal(good, zero, y * scale, normal_y));
        wd_store_floats(out->shading_z + i, wd_where_equal(good, zero, z * scale, normal_z));
    }
}

/* Cosines between shading normals and directions to the light, in double: distances may be large. A
 * light that a triangle does not face has no visibility and no cosine. */
static void light_fragments(const shb_light_source *light, uint32_t number, size_t count,
                            const shb_fragments *restrict fragments,
                            const uint32_t *restrict facing, shb_lighting *restrict out) {
    const size_t lanes = shb_round_to_lanes(count);
    const shb_vec3 position = light->position;
    const double light_w = light->w;
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const wd x = position.x - light_w * wd_load_floats(fragments->x + i);
        const wd y = position.y - light_w * wd_load_floats(fragments->y + i);
        const wd z = position.z - light_w * wd_load_floats(fragments->z + i);
        const wd along = x * wd_load_floats(fragments->shading_x + i) +
                         y * wd_load_floats(fragments->shading_y + i) +
                         z * wd_load_floats(fragments->shading_z + i);
        wd_store_floats(out->cosine + i, along / wd_sqrt(x * x + y * y + z * z));
    }
    for (size_t i = 0; i < lanes; i++) {
        const bool faces = (facing[i] >> number & 1) != 0;
        const float positive = out->cosine[i] > 0 ? out->cosine[i] : 0.0f;
        const float cosine = positive < 1 ? positive : 1.0f;
        out->cosine[i] = faces ? cosine : 0.0f;
        out->visibility[i] = faces ? out->visibility[i] : 0.0f;
    }
}

/* The image's square root; + 0.5 rounds to the nearest. NaN becomes 0. */
static void display_bytes(size_t count, const float *restrict linear, uint8_t *restrict bytes) {
    SHB_ALIGN int32_t wide[SHB_BATCH];
    for (size_t i = 0; i < count; i++) {
        const float positive = linear[i] > 0 ? linear[i] : 0.0f;
        const float unit = positive < 1 ? positive : 1.0f;
        wide[i] = (int32_t)(sqrtf(unit) * 255.0f + 0.5f);
    }
    for (size_t i = 0; i < count; i++)
        bytes[i] = (uint8_t)wide[i];
}
