/* The planes of triangles. */

static inline ALWAYS_INLINE wd difference(wd a, wd b) {
    return wd_abs(a - b);
}

/* How far the map's texels near a triangle can lie from its anchor, on an axis. */
static inline ALWAYS_INLINE wd plane_reach(wd anchor, const wd places[3], double size,
                                           wd in_front) {
    wd reach = difference(places[0], anchor);
    for (int k = 1; k < 3; k++) {
        const wd other = difference(places[k], anchor);
        reach = wd_where_greater(other, reach, other, reach);
    }
    const wd whole = wd_abs(anchor) + size;
    reach = wd_where_greater(whole, reach, reach, whole);
    return wd_where_greater(in_front, wd_splat(0.0), reach, whole) + 1.0;
}

/* The normal by winding and what its elements may be off by: differences and products are rounded,
 * and so are corners that a transform has moved. */
static inline ALWAYS_INLINE void normal_of(const wd corners[3][3], wd normal[3], wd error[3]) {
    const double e = SHB_DOUBLE_ROUNDING;
    wd first[3], second[3];
    for (int i = 0; i < 3; i++) {
        first[i] = corners[1][i] - corners[0][i];
        second[i] = corners[2][i] - corners[0][i];
    }
    wide_cross(first, second, normal);
    const wd size =
        (wide_sum_abs(corners[0]) + wide_sum_abs(corners[1])) + wide_sum_abs(corners[2]);
    const wd moved = 4 * e * size * (wide_sum_abs(first) + wide_sum_abs(second));
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        error[i] = 8 * e * (wd_abs(first[j] * second[k]) + wd_abs(first[k] * second[j])) + moved;
    }
}

typedef struct wide_plane {
    wd z, slope_x, slope_y, error;
    wd normal[3], normal_error[3];
    wd away; /* positive: the normal points away from the light */
} wide_plane;

/* Anchored at the corner farthest from the light, which lies in front of it if anything does. */
static inline ALWAYS_INLINE wide_plane plane_of(const shb_map *map, const shb_light_rows *rows,
                                                bool affine, const wd corners[3][3]) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    wd in_front = one, w = zero, x[3], y[3], anchor[3];
    for (int k = 0; k < 3; k++) {
        const wd *p = corners[k];
        wd corner_w = one, inverse_w = one;
        if (!affine) {
            corner_w = row_at(rows->w, p[0], p[1], p[2]);
            inverse_w = 1.0 / corner_w;
        }
        x[k] = row_at(rows->x, p[0], p[1], p[2]) * inverse_w;
        y[k] = row_at(rows->y, p[0], p[1], p[2]) * inverse_w;
        in_front = wd_where_greater(corner_w, zero, in_front, zero);
        for (int i = 0; i < 3; i++)
            anchor[i] = k == 0 ? p[i] : wd_where_greater(corner_w, w, p[i], anchor[i]);
        w = k == 0 ? corner_w : wd_where_greater(corner_w, w, corner_w, w);
    }
    const wide_light_point point = affine ? wide_light_point_with(rows, anchor, 0, one, one)
                                          : wide_light_point_at(rows, anchor, 0);
    wd normal[3], normal_error[3];
    normal_of(corners, normal, normal_error);
    const wide_light_slopes slopes = wide_light_slopes_of(rows, &point, normal, normal_error);
    const double width = map->info.width, height = map->info.height;
    const wd to_origin = wd_abs(point.z) + wd_abs(slopes.x) * (wd_abs(point.x) + width) +
                         wd_abs(slopes.y) * (wd_abs(point.y) + height);
    const wd error = (2.0 * wide_light_point_error(&point, slopes.x, slopes.y) +
                      (slopes.error_x * plane_reach(point.x, x, width, in_front) +
                       slopes.error_y * plane_reach(point.y, y, height, in_front))) +
                     8 * SHB_DOUBLE_ROUNDING * to_origin;
    const wd usable = wd_where_greater(one, error, wd_where_greater(w, zero, one, zero), zero);
    const wd z = (point.z - slopes.x * point.x) - slopes.y * point.y;
    wd ray[3];
    wide_cross(point.a, point.b, ray);
    return (wide_plane){wd_where_greater(usable, zero, z, zero),
                        wd_where_greater(usable, zero, slopes.x, zero),
                        wd_where_greater(usable, zero, slopes.y, zero),
                        wd_where_greater(usable, zero, error, wd_splat((double)INFINITY)),
                        {normal[0], normal[1], normal[2]},
                        {normal_error[0], normal_error[1], normal_error[2]},
                        SHB_DOT(normal, ray) * SHB_DOT(point.c, ray)};
}

/* What the plane's numbers are off by near the triangle: the normal's error times how far points
 * there lie from the first corner, and what rounding makes of corners and of the sum. Errors of the
 * normal farther along the light's ray do not matter: a plane is only used if they are less than
 * half of what the ray rises over it. */
static inline ALWAYS_INLINE void store_world_plane(const wide_plane *plane, const wd corners[3][3],
                                                   size_t i, shb_found_world_planes *to) {
    const wd zero = wd_splat(0.0), one = wd_splat(1.0);
    const wd size =
        (wide_sum_abs(corners[0]) + wide_sum_abs(corners[1])) + wide_sum_abs(corners[2]);
    wd error = 16 * SHB_DOUBLE_ROUNDING * wide_sum_abs(plane->normal) * size;
    for (int k = 0; k < 3; k++)
        error += 2.0 * plane->normal_error[k] *
                 wd_max(difference(corners[1][k], corners[0][k]),
                        difference(corners[2][k], corners[0][k]));
    const wd unit = wd_where_greater(plane->away, zero, one, -one) / error;
    for (int k = 0; k < 3; k++)
        wd_store(to->normal[k] + i, plane->normal[k] * unit);
    wd_store(to->offset + i,
             wd_where_greater(wd_splat((double)INFINITY), plane->error,
                              -SHB_DOT(plane->normal, corners[0]) * unit, wd_splat((double)NAN)));
}

/* Corner number k of triangles from lane i on, in the world. */
static inline ALWAYS_INLINE void world_corner(const shb_plane_corners *corners,
                                              const shb_mat4 *transform, int k, size_t i,
                                              wd corner[3]) {
    const wd x = wd_load_floats(corners->at[k][0] + i), y = wd_load_floats(corners->at[k][1] + i);
    const wd z = wd_load_floats(corners->at[k][2] + i);
    corner[0] = x;
    corner[1] = y;
    corner[2] = z;
    for (int row = 0; transform && row < 3; row++) {
        const double *m = transform->m + row;
        corner[row] = m[0] * x + m[4] * y + m[8] * z + m[12];
    }
}

static inline ALWAYS_INLINE void find_planes_as(const shb_map *map, bool affine,
                                                const shb_mat4 *transform, size_t count,
                                                const shb_plane_corners *restrict corners,
                                                shb_found_planes *restrict planes,
                                                shb_found_world_planes *restrict world_planes) {
    const shb_light_rows rows = map->rows;
    for (size_t i = 0; i < count; i += DOUBLES) {
        wd at[3][3];
        for (int k = 0; k < 3; k++)
            world_corner(corners, transform, k, i, at[k]);
        const wide_plane found = plane_of(map, &rows, affine, (const wd(*)[3])at);
        wd_store(planes->z + i, found.z);
        wd_store(planes->slope_x + i, found.slope_x);
        wd_store(planes->slope_y + i, found.slope_y);
        wd_store(planes->error + i, found.error);
        if (world_planes)
            store_world_plane(&found, (const wd(*)[3])at, i, world_planes);
    }
}

static void find_planes(const shb_map *map, const shb_mat4 *transform, size_t count,
                        const shb_plane_corners *corners, shb_found_planes *planes) {
    if (map->projection.affine)
        find_planes_as(map, true, transform, count, corners, planes, NULL);
    else
        find_planes_as(map, false, transform, count, corners, planes, NULL);
}

static void find_world_planes(const shb_map *map, const shb_mat4 *transform, size_t count,
                              const shb_plane_corners *corners, shb_found_planes *planes,
                              shb_found_world_planes *world_planes) {
    if (map->projection.affine)
        find_planes_as(map, true, transform, count, corners, planes, world_planes);
    else
        find_planes_as(map, false, transform, count, corners, planes, world_planes);
}
