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

/* The mesh's normal where it is clearly on one side of the triangle's own. */
static inline ALWAYS_INLINE void write_smooth(const shb_prepared_triangle *triangle, wd b, wd c,
                                              shb_fragments *restrict out, size_t i) {
    const double *corners = triangle->shading + SHB_SHADING_CORNERS;
    const wd x = combine(corners, 0, b, c), y = combine(corners, 1, b, c);
    const wd z = combine(corners, 2, b, c);
    const double side = triangle->facing & SHB_SURFACE_ALONG ? 1.0 : -1.0;
    const wd scale = side / wd_sqrt(x * x + y * y + z * z);
    wd_store_floats(out->shading_x + i, x * scale);
    wd_store_floats(out->shading_y + i, y * scale);
    wd_store_floats(out->shading_z + i, z * scale);
}

/* Any normal of the mesh, on the side of the triangle's own. */
static inline ALWAYS_INLINE void write_turned(const shb_prepared_triangle *triangle, wd b, wd c,
                                              shb_fragments *restrict out, size_t i) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const double *normal = triangle->shading, *corners = normal + SHB_SHADING_CORNERS;
    const wd x = combine(corners, 0, b, c), y = combine(corners, 1, b, c);
    const wd z = combine(corners, 2, b, c);
    const wd length = wd_sqrt(x * x + y * y + z * z);
    const wd good = wd_where_greater(length, zero, length, none) * 0.0; /* 0 or NaN */
    const wd along = normal[0] * x + normal[1] * y + normal[2] * z;
    const wd scale = wd_where_greater(zero, along, wd_splat(-1.0), one) / length;
    wd_store_floats(out->shading_x + i, wd_where_equal(good, zero, x * scale, wd_splat(normal[0])));
    wd_store_floats(out->shading_y + i, wd_where_equal(good, zero, y * scale, wd_splat(normal[1])));
    wd_store_floats(out->shading_z + i, wd_where_equal(good, zero, z * scale, wd_splat(normal[2])));
}

/* DOUBLES fragments of one triangle; returns a bit for each whose centre lies inside of it. down:
 * the parts of the weights that a row has in common. */
static inline ALWAYS_INLINE uint32_t write_fragments(const shb_prepared_triangle *triangle,
                                                     wd center_x, const wd *down,
                                                     shb_fragment_batch *batch, size_t i) {
    const double *lines = triangle->place, *corners = lines + SHB_PLACE_CORNERS;
    const wd weight_0 = lines[0] * center_x + down[0] + lines[2];
    const wd weight_1 = lines[3] * center_x + down[1] + lines[5];
    const wd weight_2 = lines[6] * center_x + down[2] + lines[8];
    const wd sum = weight_0 + weight_1 + weight_2;
    const wd least = wd_min(wd_min(weight_0, weight_1), weight_2);

    shb_fragments *out = &batch->fragments;
    const wd b = weight_1 / sum, c = weight_2 / sum;
    wd_store_floats(out->weight_1 + i, b);
    wd_store_floats(out->weight_2 + i, c);
    wd_store_floats(out->x + i, combine(corners, 0, b, c));
    wd_store_floats(out->y + i, combine(corners, 1, b, c));
    wd_store_floats(out->z + i, combine(corners, 2, b, c));

    const float normal[3] = {triangle->normal[0], triangle->normal[1], triangle->normal[2]};
    const uint32_t facing = triangle->facing;
    for (size_t k = 0; k < DOUBLES; k++)
        batch->facing[i + k] = facing;
    for (size_t k = 0; k < DOUBLES; k++) {
        out->normal_x[i + k] = normal[0];
        out->normal_y[i + k] = normal[1];
        out->normal_z[i + k] = normal[2];
    }
    if (!(facing & SHB_SURFACE_SMOOTH))
        for (size_t k = 0; k < DOUBLES; k++) {
            out->shading_x[i + k] = normal[0];
            out->shading_y[i + k] = normal[1];
            out->shading_z[i + k] = normal[2];
        }
    else if (facing & (SHB_SURFACE_ALONG | SHB_SURFACE_AGAINST))
        write_smooth(triangle, b, c, out, i);
    else
        write_turned(triangle, b, c, out, i);
    /* A sum that is not finite is not greater than NaN. */
    return wd_greater_bits(sum, sum * 0.0) & ~wd_greater_bits(wd_splat(0.0), least);
}

/* What is too much behind a run the next one overwrites. */
static void read_fragments(const shb_pixel_row *row, size_t run_count, const shb_surface_run *runs,
                           const shb_surface_table *table, shb_fragment_batch *batch) {
    static const uint8_t first_bits[] = {0, 1, 3, 7, 15, 31, 63, 127, 255};
    const double center_y = row->center_y;
    size_t first = 0, found = 0;
    for (size_t r = 0; r < run_count; r++) {
        const shb_prepared_triangle *triangle = &table->triangles[runs[r].place];
        const double *lines = triangle->place;
        const wd down[3] = {wd_splat(lines[1] * center_y), wd_splat(lines[4] * center_y),
                            wd_splat(lines[7] * center_y)};
        const double *centers = row->centers + (runs[r].begin - row->first);
        const size_t end = first + runs[r].end - runs[r].begin;
        for (size_t i = first; i < end; i += DOUBLES, centers += DOUBLES) {
            const uint32_t inside = write_fragments(triangle, wd_load(centers), down, batch, i);
            uint32_t missed = first_bits[end - i < DOUBLES ? end - i : DOUBLES] & ~inside;
            for (; missed; missed &= missed - 1)
                batch->outside[found++] = (uint16_t)(i + (size_t)__builtin_ctz(missed));
        }
        first = end;
    }
    batch->outside_count = (uint32_t)found;
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
