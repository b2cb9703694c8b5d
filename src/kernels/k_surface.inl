/* Preparing triangles for a block of pixels: the formulas of surface.c, in the same order. */

typedef struct wd3 {
    wd x, y, z;
} wd3;

static inline ALWAYS_INLINE wd3 subtract3(wd3 a, wd3 b) {
    return (wd3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline ALWAYS_INLINE wd3 scale3(wd3 a, wd s) {
    return (wd3){a.x * s, a.y * s, a.z * s};
}

static inline ALWAYS_INLINE wd dot3(wd3 a, wd3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline ALWAYS_INLINE wd3 cross3(wd3 a, wd3 b) {
    return (wd3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* Rows x, y and row of a matrix times (v, v_w). */
static inline ALWAYS_INLINE wd3 transform3(const double *m, int row, wd3 v, double v_w) {
    const double *n = m + row;
    return (wd3){m[0] * v.x + m[4] * v.y + m[8] * v.z + m[12] * v_w,
                 m[1] * v.x + m[5] * v.y + m[9] * v.z + m[13] * v_w,
                 n[0] * v.x + n[4] * v.y + n[8] * v.z + n[12] * v_w};
}

static inline ALWAYS_INLINE wd3 load_floats3(const float (*from)[SHB_SPAN + SHB_TABLE_MARGIN],
                                             size_t i) {
    return (wd3){wd_load_floats(from[0] + i), wd_load_floats(from[1] + i),
                 wd_load_floats(from[2] + i)};
}

/* Vectors to be spread over DOUBLES triangles, one element each. */
typedef double wd_lanes[DOUBLES];

static inline ALWAYS_INLINE void store3(wd_lanes *to, wd3 v) {
    wd_store(to[0], v.x);
    wd_store(to[1], v.y);
    wd_store(to[2], v.z);
}

/* 0, or NaN where one of them is not finite. */
static inline ALWAYS_INLINE wd infinite3(wd3 v) {
    return v.x * 0.0 + v.y * 0.0 + v.z * 0.0;
}

/* 1 where the triangle's side of this normal faces the light, else 0. */
static inline ALWAYS_INLINE wd faces3(wd3 normal, wd3 corner, const shb_light_source *light) {
    const double w = light->w;
    const wd3 way = {light->position.x - corner.x * w, light->position.y - corner.y * w,
                     light->position.z - corner.z * w};
    return wd_where_greater(dot3(normal, way), wd_splat(0.0), wd_splat(1.0), wd_splat(0.0));
}

/* One bit a light. */
static inline ALWAYS_INLINE void prepare_facing(const shb_surface_view *view, wd3 normal,
                                                wd3 corner, shb_prepared_triangle *triangles) {
    for (size_t lane = 0; lane < DOUBLES; lane++)
        triangles[lane].facing = 0;
    for (size_t k = 0; k < view->light_count; k++) {
        int32_t faces[DOUBLES];
        wd_store_ints(faces, faces3(normal, corner, &view->lights[k]));
        for (size_t lane = 0; lane < DOUBLES; lane++)
            triangles[lane].facing |= (uint16_t)(faces[lane] << k);
    }
}

static inline ALWAYS_INLINE void prepare_cofactors(const double *camera, const wd3 corners[3],
                                                   shb_prepared_triangle *triangles) {
    wd3 clip[3], cofactors[3];
    wd_lanes made[9];
    for (int k = 0; k < 3; k++)
        clip[k] = transform3(camera, 3, corners[k], 1);
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const wd3 edge = subtract3(corners[b], corners[a]);
        cofactors[k] = cross3(clip[a], transform3(camera, 3, edge, 0));
    }
    const wd sign =
        wd_where_greater(wd_splat(0.0), dot3(clip[0], cofactors[0]), wd_splat(-1.0), wd_splat(1.0));
    for (int k = 0; k < 3; k++)
        store3(made + 3 * k, scale3(cofactors[k], sign));
    for (int lane = 0; lane < DOUBLES; lane++)
        for (int k = 0; k < 9; k++)
            triangles[lane].cofactors[k] = made[k][lane];
}

static inline ALWAYS_INLINE void prepare_shading(const shb_surface_instance *instance,
                                                 const shb_surface_corners *corners, size_t i,
                                                 shb_prepared_triangle *triangles) {
    const shb_vec3 *c = instance->normal_columns;
    wd3 shading[3];
    wd_lanes made[9];
    for (int k = 0; k < 3; k++) {
        const wd3 n = load_floats3(corners->normals + 3 * k, i);
        shading[k] = (wd3){c[0].x * n.x + c[1].x * n.y + c[2].x * n.z,
                           c[0].y * n.x + c[1].y * n.y + c[2].y * n.z,
                           c[0].z * n.x + c[1].z * n.y + c[2].z * n.z};
    }
    store3(made, shading[0]);
    store3(made + 3, subtract3(shading[1], shading[0]));
    store3(made + 6, subtract3(shading[2], shading[0]));
    for (int lane = 0; lane < DOUBLES; lane++)
        for (int k = 0; k < 9; k++)
            triangles[lane].shading[k] = made[k][lane];
}

/* Corners and ways from the first one, and the normal. */
static inline ALWAYS_INLINE void prepare_place(const wd3 place[3], wd3 normal,
                                               shb_prepared_triangle *triangles) {
    wd_lanes made[12];
    for (int k = 0; k < 3; k++)
        store3(made + 3 * k, place[k]);
    store3(made + 9, normal);
    for (int lane = 0; lane < DOUBLES; lane++) {
        for (int k = 0; k < 9; k++)
            triangles[lane].corners[k] = made[k][lane];
        for (int k = 0; k < 3; k++) {
            triangles[lane].normal[k] = (float)made[9 + k][lane];
            triangles[lane].exact_normal[k] = made[9 + k][lane];
        }
    }
}

static void prepare_surfaces(const shb_surface_view *view, const shb_surface_instance *instance,
                             size_t count, const shb_surface_corners *read,
                             shb_prepared_triangle *triangles) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    const double *world = instance->transform.m;
    const bool smooth = instance->mesh->normals != NULL;
    for (size_t i = 0; i < count; i += DOUBLES) {
        wd3 corners[3];
        wd infinite = zero;
        for (int k = 0; k < 3; k++) {
            corners[k] = transform3(world, 2, load_floats3(read->positions + 3 * k, i), 1);
            infinite = infinite + infinite3(corners[k]);
        }
        const wd3 edge_1 = subtract3(corners[1], corners[0]);
        const wd3 edge_2 = subtract3(corners[2], corners[0]);
        const wd3 across = scale3(cross3(edge_1, edge_2), wd_splat(instance->mirrors ? -1.0 : 1.0));
        const wd squared = dot3(across, across), length = wd_sqrt(squared);
        const wd3 front = {across.x / length, across.y / length, across.z / length};
        const wd seen = faces3(front, corners[0], &view->eye);
        const wd3 normal = scale3(front, wd_where_equal(seen, one, one, wd_splat(-1.0)));
        const wd in_range =
            wd_where_greater(squared, wd_splat(0x1p-600),
                             wd_where_greater(wd_splat(0x1p600), squared, one, zero), zero);
        int32_t usable[DOUBLES];
        wd_store_ints(usable, wd_where_equal(infinite, zero, in_range, zero));

        shb_prepared_triangle *to = triangles + i;
        for (int lane = 0; lane < DOUBLES; lane++) {
            to[lane].usable = (uint8_t)usable[lane];
            to[lane].smooth = smooth;
        }
        prepare_place((wd3[3]){corners[0], edge_1, edge_2}, normal, to);
        prepare_facing(view, normal, corners[0], to);
        prepare_cofactors(view->camera->clip_from_world.m, corners, to);
        if (smooth)
            prepare_shading(instance, read, i, to);
    }
}
