/* Fragments of a row of pixels from the triangles that they see: the formulas of surface.c. */

/* Appends the numbers of the bits that are set, of four from number first on. */
static inline ALWAYS_INLINE size_t add_bits(uint32_t bits, uint32_t first, uint16_t *numbers,
                                            size_t found) {
    static const uint16_t set[16][4] = {
        {0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
        {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
    static const uint8_t counts[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};
    uint64_t four;
    memcpy(&four, set[bits], sizeof four);
    four += first * 0x0001000100010001u;
    memcpy(numbers + found, &four, sizeof four);
    return found + counts[bits];
}

static size_t find_starts(const uint32_t *ids, size_t count, uint16_t *starts) {
    size_t found = 1, i = 1;
    starts[0] = 0;
    for (; i + WIDE <= count; i += WIDE) {
        const uint32_t bits =
            vi_bits(vi_load((const int32_t *)ids + i) != vi_load((const int32_t *)ids + i - 1));
        for (uint32_t k = 0; bits && k < WIDE; k += 4)
            found = add_bits(bits >> k & 15, (uint32_t)i + k, starts, found);
    }
    for (; i < count; i++) {
        starts[found] = (uint16_t)i;
        found += ids[i] != ids[i - 1];
    }
    starts[found] = (uint16_t)count;
    return found;
}

/* first + b * way_1 + c * way_2 for one axis of a first vector and the ways to two others. */
static inline ALWAYS_INLINE wd combine(const double *from, int axis, wd b, wd c) {
    return wd_splat(from[axis]) + (b * from[3 + axis] + c * from[6 + axis]);
}

static inline ALWAYS_INLINE wd weight_of(const double *line, wd center_x, double center_y) {
    return line[0] * center_x + wd_splat(line[1] * center_y) + line[2];
}

/* The mesh's normal, on the side of the triangle's own. */
static inline ALWAYS_INLINE void write_smooth(const shb_prepared_triangle *triangle, wd b, wd c,
                                              shb_fragments *restrict out, size_t i) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const wd x = combine(triangle->shading, 0, b, c), y = combine(triangle->shading, 1, b, c);
    const wd z = combine(triangle->shading, 2, b, c);
    const double *normal = triangle->exact_normal;
    const wd length = wd_sqrt(x * x + y * y + z * z);
    const wd good = wd_where_greater(length, zero, length, none) * 0.0; /* 0 or NaN */
    const wd along = normal[0] * x + normal[1] * y + normal[2] * z;
    const wd scale = wd_where_greater(zero, along, wd_splat(-1.0), one) / length;
    wd_store_floats(out->shading_x + i, wd_where_equal(good, zero, x * scale, wd_splat(normal[0])));
    wd_store_floats(out->shading_y + i, wd_where_equal(good, zero, y * scale, wd_splat(normal[1])));
    wd_store_floats(out->shading_z + i, wd_where_equal(good, zero, z * scale, wd_splat(normal[2])));
}

/* DOUBLES fragments of one triangle; NaN in outside[i] where a centre lies outside of it. */
static inline ALWAYS_INLINE void write_fragments(const shb_prepared_triangle *triangle, wd center_x,
                                                 double center_y, shb_fragments *restrict out,
                                                 float *restrict outside, size_t i) {
    const wd zero = wd_splat(0.0), none = wd_splat((double)NAN);
    const double *lines = triangle->cofactors;
    const wd weight_0 = weight_of(lines, center_x, center_y);
    const wd weight_1 = weight_of(lines + 3, center_x, center_y);
    const wd weight_2 = weight_of(lines + 6, center_x, center_y);
    const wd sum = weight_0 + weight_1 + weight_2;
    const wd least = wd_min(wd_min(weight_0, weight_1), weight_2);
    const wd usable = wd_where_greater(sum, zero, sum, none) * 0.0; /* 0 or NaN */
    wd_store_floats(outside + i, wd_where_greater(zero, least, none, usable));

    const wd b = weight_1 / sum, c = weight_2 / sum;
    wd_store_floats(out->weight_1 + i, b);
    wd_store_floats(out->weight_2 + i, c);
    wd_store_floats(out->x + i, combine(triangle->corners, 0, b, c));
    wd_store_floats(out->y + i, combine(triangle->corners, 1, b, c));
    wd_store_floats(out->z + i, combine(triangle->corners, 2, b, c));
    for (size_t k = 0; k < DOUBLES; k++) {
        out->normal_x[i + k] = triangle->normal[0];
        out->normal_y[i + k] = triangle->normal[1];
        out->normal_z[i + k] = triangle->normal[2];
    }
    if (triangle->smooth) {
        write_smooth(triangle, b, c, out, i);
        return;
    }
    for (size_t k = 0; k < DOUBLES; k++) {
        out->shading_x[i + k] = triangle->normal[0];
        out->shading_y[i + k] = triangle->normal[1];
        out->shading_z[i + k] = triangle->normal[2];
    }
}

/* What is too much behind a run the next one overwrites. */
static void read_fragments(const shb_pixel_row *row, size_t run_count, const shb_surface_run *runs,
                           const shb_surface_table *table, shb_fragments *restrict out,
                           uint32_t *restrict facing, float *restrict outside) {
    size_t first = 0;
    for (size_t r = 0; r < run_count; r++) {
        const shb_surface_run run = runs[r];
        const shb_prepared_triangle *triangle = &table->triangles[run.place];
        const double *centers = row->centers + (run.begin - row->first);
        const size_t count = run.end - run.begin;
        for (size_t k = 0; k < count; k += DOUBLES)
            write_fragments(triangle, wd_load(centers + k), row->center_y, out, outside, first + k);
        for (size_t k = 0; k < count; k += WIDE) {
            vi_store(out->pixel_x + first + k, (int32_t)(run.begin + k) + vi_lanes());
            vi_store((int32_t *)out->id + first + k, vi_splat((int32_t)table->ids[run.place]));
            vi_store((int32_t *)facing + first + k, vi_splat(triangle->facing));
        }
        first += count;
    }
}

/* Cosines between shading normals and directions to the light, in double: distances may be large.
 * A directional light has one direction everywhere. */
static inline ALWAYS_INLINE void write_cosines(const shb_light_source *light, bool directional,
                                               size_t lanes,
                                               const shb_fragments *restrict fragments,
                                               float *restrict cosine) {
    const double light_w = light->w;
    wd x = wd_splat(light->position.x), y = wd_splat(light->position.y);
    wd z = wd_splat(light->position.z), length = wd_sqrt(x * x + y * y + z * z);
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        if (!directional) {
            x = light->position.x - light_w * wd_load_floats(fragments->x + i);
            y = light->position.y - light_w * wd_load_floats(fragments->y + i);
            z = light->position.z - light_w * wd_load_floats(fragments->z + i);
            length = wd_sqrt(x * x + y * y + z * z);
        }
        const wd along = x * wd_load_floats(fragments->shading_x + i) +
                         y * wd_load_floats(fragments->shading_y + i) +
                         z * wd_load_floats(fragments->shading_z + i);
        wd_store_floats(cosine + i, along / length);
    }
}

/* A light that a triangle does not face has no visibility and no cosine. */
static void light_fragments(const shb_light_source *light, uint32_t number, size_t count,
                            const shb_fragments *restrict fragments,
                            const uint32_t *restrict facing, shb_lighting *restrict out) {
    const size_t lanes = shb_round_to_lanes(count);
    if (light->w == 0)
        write_cosines(light, true, lanes, fragments, out->cosine);
    else
        write_cosines(light, false, lanes, fragments, out->cosine);
    for (size_t i = 0; i < lanes; i++) {
        const bool faces = (facing[i] >> number & 1) != 0;
        const float positive = out->cosine[i] > 0 ? out->cosine[i] : 0.0f;
        const float cosine = positive < 1 ? positive : 1.0f;
        out->cosine[i] = faces ? cosine : 0.0f;
        out->visibility[i] = faces ? out->visibility[i] : 0.0f;
    }
}

/* The image's square root; + 0.5 rounds to the nearest. NaN becomes 0. */
static inline ALWAYS_INLINE uint32_t display_byte(float linear) {
    const float positive = linear > 0 ? linear : 0.0f;
    const float unit = positive < 1 ? positive : 1.0f;
    return (uint32_t)(int32_t)(sqrtf(unit) * 255.0f + 0.5f);
}

static void display(size_t count, const float *restrict red, const float *restrict green,
                    const float *restrict blue, uint32_t *restrict pixels) {
    for (size_t i = 0; i < count; i++)
        pixels[i] =
            display_byte(red[i]) | display_byte(green[i]) << 8 | display_byte(blue[i]) << 16;
}
