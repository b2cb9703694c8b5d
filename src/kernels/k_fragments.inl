/* Fragments of pixels from the triangles that they see: the formulas of surface.c. */

/* first + b * way_1 + c * way_2 for one axis of a first vector and the ways to two others. */
static inline ALWAYS_INLINE wd combine(const wd *from, int axis, wd b, wd c) {
    return from[axis] + (b * from[3 + axis] + c * from[6 + axis]);
}

/* DOUBLES fragments by the fields place of their triangles; returns a bit for each whose centre
 * lies outside. */
static inline ALWAYS_INLINE uint32_t write_points(const wd *place, wd center_x, wd center_y,
                                                  shb_fragments *restrict out, size_t i,
                                                  wd *weights) {
    const wd *corners = place + SHB_PLACE_CORNERS;
    wd raw[3];
    for (int k = 0; k < 3; k++)
        raw[k] = place[3 * k] * center_x + place[3 * k + 1] * center_y + place[3 * k + 2];
    const wd sum = raw[0] + raw[1] + raw[2];
    const wd least = wd_min(wd_min(raw[0], raw[1]), raw[2]);
    const wd b = raw[1] / sum, c = raw[2] / sum;
    wd_store_floats(out->weight_1 + i, b);
    wd_store_floats(out->weight_2 + i, c);
    wd_store_floats(out->x + i, combine(corners, 0, b, c));
    wd_store_floats(out->y + i, combine(corners, 1, b, c));
    wd_store_floats(out->z + i, combine(corners, 2, b, c));
    weights[0] = b;
    weights[1] = c;
    /* A sum that is not finite is not greater than NaN. */
    const uint32_t all = (1u << DOUBLES) - 1;
    return (all ^ wd_greater_bits(sum, sum * 0.0)) | wd_greater_bits(wd_splat(0.0), least);
}

static inline ALWAYS_INLINE void store_shading(wd x, wd y, wd z, shb_fragments *restrict out,
                                               size_t i) {
    wd_store_floats(out->shading_x + i, x);
    wd_store_floats(out->shading_y + i, y);
    wd_store_floats(out->shading_z + i, z);
}

/* Normals of the mesh that are clearly on one side of the triangles' own; side: 1, -1 of the other.
 */
static inline ALWAYS_INLINE void write_sided(const wd *shading, wd side, const wd *weights,
                                             shb_fragments *restrict out, size_t i) {
    const wd *corners = shading + SHB_SHADING_CORNERS, b = weights[0], c = weights[1];
    const wd x = combine(corners, 0, b, c), y = combine(corners, 1, b, c);
    const wd z = combine(corners, 2, b, c);
    const wd scale = side / wd_sqrt(x * x + y * y + z * z);
    store_shading(x * scale, y * scale, z * scale, out, i);
}

/* Any normals of the mesh, on the side of the triangles' own. */
static inline ALWAYS_INLINE void write_turned(const wd *shading, const wd *weights,
                                              shb_fragments *restrict out, size_t i) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0), none = wd_splat((double)NAN);
    const wd *normal = shading, *corners = normal + SHB_SHADING_CORNERS;
    const wd b = weights[0], c = weights[1];
    const wd x = combine(corners, 0, b, c), y = combine(corners, 1, b, c);
    const wd z = combine(corners, 2, b, c);
    const wd length = wd_sqrt(x * x + y * y + z * z);
    const wd good = wd_where_greater(length, zero, length, none) * 0.0; /* 0 or NaN */
    const wd along = normal[0] * x + normal[1] * y + normal[2] * z;
    const wd scale = wd_where_greater(zero, along, wd_splat(-1.0), one) / length;
    store_shading(wd_where_equal(good, zero, x * scale, normal[0]),
                  wd_where_equal(good, zero, y * scale, normal[1]),
                  wd_where_equal(good, zero, z * scale, normal[2]), out, i);
}

/* The side of normals that are clearly on one, or 0. */
static inline ALWAYS_INLINE double side_of(uint32_t facing) {
    return facing & SHB_SURFACE_ALONG ? 1.0 : facing & SHB_SURFACE_AGAINST ? -1.0 : 0.0;
}

/* Triangles without normals keep what the fragments have. */
static inline ALWAYS_INLINE void shade_alike(const shb_prepared_triangle *triangle,
                                             const wd *weights, shb_fragments *restrict out,
                                             size_t i) {
    if (!(triangle->facing & SHB_SURFACE_SMOOTH))
        return;
    wd shading[12];
    for (int k = 0; k < 12; k++)
        shading[k] = wd_splat(triangle->shading[k]);
    const double side = side_of(triangle->facing);
    if (side != 0)
        write_sided(shading, wd_splat(side), weights, out, i);
    else
        write_turned(shading, weights, out, i);
}

static inline ALWAYS_INLINE void shade_any(const shb_surface_table *table, const wd *weights,
                                           shb_fragment_batch *restrict batch, size_t i) {
    static const double flat[12];
    shb_fragments *out = &batch->fragments;
    const double *from[DOUBLES];
    double sides[DOUBLES];
    bool are_sided = true;
    for (size_t k = 0; k < DOUBLES; k++) {
        const shb_prepared_triangle *triangle = &table->triangles[batch->places[i + k]];
        from[k] = triangle->facing & SHB_SURFACE_SMOOTH ? triangle->shading : flat;
        sides[k] = side_of(triangle->facing);
        are_sided &= sides[k] != 0;
    }
    wd shading[12];
    for (int q = 0; q < 12; q += 4) {
        wd_read_quads(from, shading + q);
        for (size_t k = 0; k < DOUBLES; k++)
            from[k] += 4;
    }
    if (are_sided) {
        write_sided(shading, wd_load(sides), weights, out, i);
        return;
    }
    write_turned(shading, weights, out, i);
    for (size_t k = i; k < i + DOUBLES; k++)
        if (!(batch->facing[k] & SHB_SURFACE_SMOOTH)) {
            out->shading_x[k] = out->normal_x[k];
            out->shading_y[k] = out->normal_y[k];
            out->shading_z[k] = out->normal_z[k];
        }
}

/* DOUBLES fragments of one triangle; returns what write_points does. */
static inline ALWAYS_INLINE uint32_t write_alike(const shb_prepared_triangle *triangle, wd center_x,
                                                 wd center_y, shb_fragment_batch *restrict batch,
                                                 size_t i) {
    const float normal[3] = {triangle->normal[0], triangle->normal[1], triangle->normal[2]};
    const uint32_t facing = triangle->facing;
    shb_fragments *out = &batch->fragments;
    for (size_t k = i; k < i + DOUBLES; k++) {
        batch->facing[k] = facing;
        out->normal_x[k] = normal[0];
        out->normal_y[k] = normal[1];
        out->normal_z[k] = normal[2];
        out->shading_x[k] = normal[0];
        out->shading_y[k] = normal[1];
        out->shading_z[k] = normal[2];
    }
    enum { NUMBERS = sizeof triangle->place / sizeof *triangle->place };
    wd place[NUMBERS], weights[2];
    for (int k = 0; k < NUMBERS; k++)
        place[k] = wd_splat(triangle->place[k]);
    const uint32_t outside = write_points(place, center_x, center_y, out, i, weights);
    shade_alike(triangle, weights, out, i);
    return outside;
}

/* The same of any triangles. */
static inline ALWAYS_INLINE uint32_t write_any(const shb_surface_table *table, wd center_x,
                                               wd center_y, shb_fragment_batch *restrict batch,
                                               size_t i) {
    enum { NUMBERS = sizeof table->triangles->quads / sizeof *table->triangles->quads };
    const double *from[DOUBLES];
    for (size_t k = 0; k < DOUBLES; k++)
        from[k] = table->triangles[batch->places[i + k]].quads;
    wd numbers[NUMBERS], weights[2];
    for (int q = 0; q < NUMBERS; q += 4) {
        wd_read_quads(from, numbers + q);
        for (size_t k = 0; k < DOUBLES; k++)
            from[k] += 4;
    }
    shb_fragments *out = &batch->fragments;
    wd_store_pairs(out->normal_x + i, out->normal_y + i, numbers[18]);
    wd_store_pairs(out->shading_x + i, out->shading_y + i, numbers[18]);
    wd_store_pairs(out->normal_z + i, batch->facing + i, numbers[19]);
    memcpy(out->shading_z + i, out->normal_z + i, DOUBLES * sizeof *out->normal_z);
    const uint32_t outside = write_points(numbers, center_x, center_y, out, i, weights);
    if (table->has_smooth)
        shade_any(table, weights, batch, i);
    return outside;
}

static void read_fragments(const shb_surface_table *table, shb_fragment_batch *batch) {
    const size_t lanes = shb_round_to_lanes(batch->count);
    size_t found = 0;
    for (size_t i = 0; i < lanes; i += DOUBLES) {
        const uint32_t *places = batch->places + i;
        const wd x = wd_load(batch->centers_x + i), y = wd_load(batch->centers_y + i);
        uint32_t missed;
        if (memcmp(places, places + 1, (DOUBLES - 1) * sizeof *places) == 0)
            missed = write_alike(&table->triangles[*places], x, y, batch, i);
        else
            missed = write_any(table, x, y, batch, i);
        for (; missed; missed &= missed - 1)
            batch->outside[found++] = (uint16_t)(i + (size_t)__builtin_ctz(missed));
    }
    batch->outside_count = (uint32_t)found;
}

static void keep_within(size_t count, float *restrict weight_1, float *restrict weight_2) {
    for (size_t i = 0; i < count; i += WIDE) {
        const vf b = vf_load(weight_1 + i), c = vf_load(weight_2 + i);
        const vf left_1 = 1.0f - c, left_2 = 1.0f - b;
        vf_store(weight_1 + i, vf_where((b < c) & (b > left_1), left_1, b));
        vf_store(weight_2 + i, vf_where((b >= c) & (c > left_2), left_2, c));
    }
}

/* Cut off at 0 and 1; NaN becomes 0. */
static inline ALWAYS_INLINE vf vf_unit(vf v) {
    return vf_min(vf_max(v, vf_splat(0.0f)), vf_splat(1.0f));
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
    for (size_t i = 0; i < lanes; i += WIDE) {
        const vi faces = (vi)(vu_load(facing + i) << (31 - number)) < 0;
        vf_store(out->cosine + i, vf_keep(faces, vf_unit(vf_load(out->cosine + i))));
        vf_store(out->visibility + i, vf_keep(faces, vf_load(out->visibility + i)));
    }
}

/* The image's square root; + 0.5 rounds to the nearest. */
static inline ALWAYS_INLINE vi display_bytes(const float *linear) {
    return __builtin_convertvector(vf_sqrt(vf_unit(vf_load(linear))) * 255.0f + 0.5f, vi);
}

static void display(size_t count, const float *restrict red, const float *restrict green,
                    const float *restrict blue, uint8_t *restrict bytes) {
    uint32_t pixels[SHB_BATCH];
    for (size_t i = 0; i < count; i += WIDE)
        vi_store((int32_t *)pixels + i, display_bytes(red + i) | display_bytes(green + i) << 8 |
                                            display_bytes(blue + i) << 16);
    store_lower_triples(count, pixels, bytes);
}
