/* Fragments of a row of pixels from their prepared triangles: the formulas of surface.c. */

#define GATHER(field) wd_gather(records + i, offsetof(shb_surface_triangle, field))

/* v[0] + b * (v[1] - v[0]) + c * (v[2] - v[0]) for one axis of three vectors. */
#define COMBINE(field, axis)                                                                       \
    combine(GATHER(field[0].axis), GATHER(field[1].axis), GATHER(field[2].axis), b, c)

static inline ALWAYS_INLINE wd combine(wd v0, wd v1, wd v2, wd b, wd c) {
    return v0 + (b * (v1 - v0) + c * (v2 - v0));
}

/* NaN in outside[i]: the pixel's centre lies outside of its triangle, and the fragment is not
 * right. */
static void read_fragments(const shb_pixel_row *row, size_t count, const void *const *records,
                           shb_fragments *restrict out, float *restrict outside) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const double width = row->width, height = row->height;
    const double center_y = (height - 2.0 * row->row - 1) / height;
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const wd center_x = (2.0 * wd_load_ints(out->pixel_x + i) + 1.0 - width) / width;
        const wd weight_0 = GATHER(cofactors[0].x) * center_x + GATHER(cofactors[0].y) * center_y +
                            GATHER(cofactors[0].z);
        const wd weight_1 = GATHER(cofactors[1].x) * center_x + GATHER(cofactors[1].y) * center_y +
                            GATHER(cofactors[1].z);
        const wd weight_2 = GATHER(cofactors[2].x) * center_x + GATHER(cofactors[2].y) * center_y +
                            GATHER(cofactors[2].z);
        const wd sum = weight_0 + weight_1 + weight_2;
        const wd least = wd_min(wd_min(weight_0, weight_1), weight_2);
        const wd usable = wd_where_greater(sum, zero, sum, none) * 0.0; /* 0 or NaN */
        wd_store_floats(outside + i, wd_where_greater(zero, least, none, usable));

        const wd b = weight_1 / sum, c = weight_2 / sum;
        wd_store_floats(out->weight_1 + i, b);
        wd_store_floats(out->weight_2 + i, c);
        wd_store_floats(out->x + i, COMBINE(corners, x));
        wd_store_floats(out->y + i, COMBINE(corners, y));
        wd_store_floats(out->z + i, COMBINE(corners, z));

        const wd normal_x = GATHER(normal.x), normal_y = GATHER(normal.y);
        const wd normal_z = GATHER(normal.z);
        wd_store_floats(out->normal_x + i, normal_x);
        wd_store_floats(out->normal_y + i, normal_y);
        wd_store_floats(out->normal_z + i, normal_z);

        const wd x = COMBINE(shading, x), y = COMBINE(shading, y), z = COMBINE(shading, z);
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
