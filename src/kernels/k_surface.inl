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

static inline ALWAYS_INLINE wd3 load_floats3(const float (*from)[SHB_BATCH + SHB_TABLE_MARGIN],
                                             size_t i) {
    return (wd3){wd_load_floats(from[0] + i), wd_load_floats(from[1] + i),
                 wd_load_floats(from[2] + i)};
}

/* A number of each of DOUBLES triangles. */
typedef double wd_lanes[DOUBLES];

/* Where one of DOUBLES triangles lies from the next. */
enum { TRIANGLE_STEP = sizeof(shb_prepared_triangle) / sizeof(double) };

/* Numbers of triangles from a place in the first one on; there are four times quads. */
static inline ALWAYS_INLINE void store_quads(double *to, int quads, const wd *numbers) {
    for (int k = 0; k < 4 * quads; k += 4)
        wd_store_quads(to + k, TRIANGLE_STEP, numbers[k], numbers[k + 1], numbers[k + 2],
                       numbers[k + 3]);
}

static inline ALWAYS_INLINE void list3(wd *to, wd3 v) {
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

/* 0, or NaN where one of them is not finite. */
static inline ALWAYS_INLINE wd infinite3(wd3 v) {
    return v.x * 0.0 + v.y * 0.0 + v.z * 0.0;
}

/* flag where the triangle's side of this normal faces the light, else 0. */
static inline ALWAYS_INLINE wd faces3(wd3 normal, wd3 corner, const shb_light_source *light,
                                      double flag) {
    const double w = light->w;
    const wd3 way = {light->position.x - corner.x * w, light->position.y - corner.y * w,
                     light->position.z - corner.z * w};
    return wd_where_greater(dot3(normal, way), wd_splat(0.0), wd_splat(flag), wd_splat(0.0));
}

static inline ALWAYS_INLINE void list_cofactors(const double *camera, const wd3 corners[3],
                                                wd *to) {
    wd3 clip[3], cofactors[3];
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
        list3(to + 3 * k, scale3(cofactors[k], sign));
}

static inline ALWAYS_INLINE wd size3(wd3 v) {
    return wd_abs(v.x) + wd_abs(v.y) + wd_abs(v.z);
}

/* SHB_SURFACE_ALONG or SHB_SURFACE_AGAINST, or 0. What lies between the corners' normals is then on
 * the same side and has a length, however it is rounded: the sum of sizes bounds all that enters,
 * and is far from where squares overflow or vanish. */
static inline ALWAYS_INLINE wd sides3(wd3 normal, const wd3 shading[3]) {
    const wd zero = wd_splat(0.0), never = wd_splat((double)INFINITY);
    const wd size = size3(shading[0]) + size3(shading[1]) + size3(shading[2]);
    const wd clearly =
        wd_where_greater(size, wd_splat(0x1p-400),
                         wd_where_greater(wd_splat(0x1p400), size, size * 0x1p-40, never), never);
    const wd a = dot3(normal, shading[0]), b = dot3(normal, shading[1]);
    const wd c = dot3(normal, shading[2]);
    const wd along = wd_splat(SHB_SURFACE_ALONG), against = wd_splat(SHB_SURFACE_AGAINST);
    return wd_where_greater(wd_min(wd_min(a, b), c), clearly, along, zero) +
           wd_where_greater(0.0 - clearly, wd_max(wd_max(a, b), c), against, zero);
}

/* Writes the shading normals, and says of them what the word facing holds. */
static inline ALWAYS_INLINE wd prepare_shading(const shb_surface_instance *instance,
                                               const shb_surface_corners *corners, size_t i,
                                               wd3 normal, shb_prepared_triangle *triangles) {
    const shb_vec3 *c = instance->normal_columns;
    wd3 shading[3];
    wd numbers[12];
    for (int k = 0; k < 3; k++) {
        const wd3 n = load_floats3(corners->normals + 3 * k, i);
        shading[k] = (wd3){c[0].x * n.x + c[1].x * n.y + c[2].x * n.z,
                           c[0].y * n.x + c[1].y * n.y + c[2].y * n.z,
                           c[0].z * n.x + c[1].z * n.y + c[2].z * n.z};
    }
    list3(numbers, normal);
    list3(numbers + 3, shading[0]);
    list3(numbers + 6, subtract3(shading[1], shading[0]));
    list3(numbers + 9, subtract3(shading[2], shading[0]));
    store_quads(triangles->shading, 3, numbers);
    return sides3(normal, shading) + wd_splat(SHB_SURFACE_SMOOTH);
}

/* What is not in whole quads. */
static inline ALWAYS_INLINE void prepare_rest(const wd *place, wd3 normal, wd facing,
                                              shb_prepared_triangle *triangles) {
    float normals[3][DOUBLES];
    int32_t words[DOUBLES];
    wd_lanes made[2];
    wd_store(made[0], place[16]);
    wd_store(made[1], place[17]);
    wd_store_floats(normals[0], normal.x);
    wd_store_floats(normals[1], normal.y);
    wd_store_floats(normals[2], normal.z);
    wd_store_ints(words, facing);
    for (int lane = 0; lane < DOUBLES; lane++) {
        for (int k = 0; k < 2; k++)
            triangles[lane].place[16 + k] = made[k][lane];
        for (int k = 0; k < 3; k++)
            triangles[lane].normal[k] = normals[k][lane];
        triangles[lane].facing = (uint32_t)words[lane];
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
        const wd seen = faces3(front, corners[0], &view->eye, 1.0);
        const wd3 normal = scale3(front, wd_where_equal(seen, one, one, wd_splat(-1.0)));

        const wd usable = wd_splat(SHB_SURFACE_USABLE);
        const wd in_range =
            wd_where_greater(squared, wd_splat(0x1p-600),
                             wd_where_greater(wd_splat(0x1p600), squared, usable, zero), zero);
        wd facing = wd_where_equal(infinite, zero, in_range, zero);
        for (size_t k = 0; k < view->light_count; k++)
            facing = facing + faces3(normal, corners[0], &view->lights[k], (double)(1u << k));

        wd place[18];
        list_cofactors(view->camera->clip_from_world.m, corners, place);
        list3(place + 9, corners[0]);
        list3(place + 12, edge_1);
        list3(place + 15, edge_2);
        store_quads(triangles[i].place, 4, place);
        if (smooth)
            facing = facing + prepare_shading(instance, read, i, normal, triangles + i);
        prepare_rest(place, normal, facing, triangles + i);
    }
}
