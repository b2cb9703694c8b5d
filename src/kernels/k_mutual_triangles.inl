/* The exact method in taps of maps that keep triangles. All that is small is a difference of
 * numbers in double, relative to the fragment's plane; each triangle is asked once for a fragment.
 */

static inline ALWAYS_INLINE void find_points(bool affine, size_t count, mutual_batch *batch) {
    const shb_light_rows rows = batch->map->rows;
    const shb_receivers *r = &batch->receivers;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += DOUBLES) {
        const wd x = wd_load_floats(r->x + i), y = wd_load_floats(r->y + i);
        const wd z = wd_load_floats(r->z + i);
        wd inverse = wd_splat(1.0);
        if (!affine)
            inverse = 1.0 / row_at(rows.w, x, y, z);
        wd_store(batch->x + i, row_at(rows.x, x, y, z) * inverse);
        wd_store(batch->y + i, row_at(rows.y, x, y, z) * inverse);
        wd_store(batch->z + i, row_at(rows.z, x, y, z) * inverse);
    }
}

/* How far fragment i lies behind the plane at its own place, and what that may be off by. */
static double depth_behind(const mutual_batch *batch, size_t i, const shb_occluder_plane *plane,
                           double *error) {
    *error = ((double)batch->moved_z[i] + fabs(plane->slope_x) * (double)batch->moved_x[i]) +
             fabs(plane->slope_y) * (double)batch->moved_y[i];
    return batch->z[i] - (shb_occluder_depth(plane, batch->x[i], batch->y[i]) + plane->error);
}

/* A triangle whose sheet goes on to the fragment's own place, and is the fragment's surface there:
 * the light sees the sheet at both places, whatever their planes say of each other. The way starts
 * in the triangle's middle, so that all taps of the triangle get the same answer. */
static bool is_of_own_sheet(const mutual_batch *batch, size_t i, uint32_t triangle) {
    const shb_light_mesh *mesh = &batch->map->occluders.mesh;
    const shb_walk_triangle *t = &mesh->triangles[triangle];
    const double middle[2] = {((t->x[0] + t->x[1]) + t->x[2]) / 3,
                              ((t->y[0] + t->y[1]) + t->y[2]) / 3};
    const double at[2] = {batch->x[i], batch->y[i]};
    const uint32_t arrived = shb_sheet_end(mesh, triangle, middle, at);
    if (arrived == SHB_ID_NONE)
        return false;
    const shb_occluder_plane *plane = &batch->map->occluders.planes[arrived];
    double error;
    const double behind = depth_behind(batch, i, plane, &error) + plane->error;
    return fabs(behind) <= error + plane->error;
}

static NEVER_INLINE mutual_triangle ask_triangle(const mutual_batch *batch, size_t i,
                                                 uint32_t triangle) {
    const shb_receivers *r = &batch->receivers;
    const shb_occluder_plane *plane = &batch->map->occluders.planes[triangle];
    double error;
    const double behind = depth_behind(batch, i, plane, &error);
    mutual_triangle made = {.shadows = behind > error && !is_of_own_sheet(batch, i, triangle),
                            .front = (float)behind,
                            .rise_x = (float)((double)r->step_x[i] - plane->slope_x),
                            .rise_y = (float)((double)r->step_y[i] - plane->slope_y)};
    const float rise = (fabsf(made.rise_x) + fabsf(made.rise_y)) * batch->reach[i];
    made.error = (batch->error[i] + batch->slope_error[i] * batch->reach[i]) +
                 8 * (float)SHB_FLOAT_ROUNDING * (fabsf(made.front) + rise);
    return made;
}

static const mutual_triangle *find_triangle(mutual_batch *batch, size_t i, uint32_t triangle) {
    mutual_memo *memo = &batch->memo;
    const uint64_t key = (uint64_t)i << 32 | triangle;
    const size_t slot = (triangle + 4 * i) % MEMO_SIZE;
    if (memo->keys[slot] != key) {
        memo->keys[slot] = key;
        memo->triangles[slot] = ask_triangle(batch, i, triangle);
    }
    return &memo->triangles[slot];
}

/* Most lit fragments lie on the triangle of their own texel, which need not be asked for each tap.
 */
static void find_plain_triangles(mutual_batch *batch, size_t count) {
    const shb_map *map = batch->map;
    const shb_receivers *r = &batch->receivers;
    for (size_t i = 0; i < shb_round_to_lanes(count); i++) {
        const int32_t x = r->texel_x[i], y = r->texel_y[i];
        batch->plain[i] = SHB_ID_NONE;
        if ((uint32_t)x >= map->info.width || (uint32_t)y >= map->info.height)
            continue;
        const uint32_t triangle = shb_occluder_row(map, y)[x];
        if (triangle != SHB_ID_NONE && !find_triangle(batch, i, triangle)->shadows)
            batch->plain[i] = triangle;
    }
}

/* Of WIDE taps that hold these triangles in front of the planes of fragments first, first + step,
 * ..., those that are to be asked. */
static inline ALWAYS_INLINE vi open_to_triangles(const mutual_batch *batch, size_t first,
                                                 size_t step, vi hits, vu triangles) {
    const vi plain = step ? vi_load((const int32_t *)batch->plain + first)
                          : vi_splat((int32_t)batch->plain[first]);
    return hits & ((vi)triangles != plain) & ((vi)triangles != (int32_t)SHB_ID_NONE);
}

/* Of these taps those that are shadowed; to_x and to_y lead from the fragment to the tap's centre.
 */
static NEVER_INLINE vi shadowed_by_triangles(mutual_batch *batch, size_t first, size_t step,
                                             vi open, vu triangles, vf to_x, vf to_y) {
    vi shadowed = {0};
    for (uint32_t bits = vi_bits(open); bits; bits = vi_bits(open)) {
        const int lane = __builtin_ctz(bits);
        const size_t i = first + step * (size_t)lane;
        const mutual_triangle *triangle = find_triangle(batch, i, triangles[lane]);
        const vi same = step ? (vi)(vi_numbers() == lane) : (vi)(triangles == triangles[lane]);
        const vf front = (triangle->front + triangle->rise_x * to_x) + triangle->rise_y * to_y;
        if (triangle->shadows)
            shadowed |= open & same & (front > triangle->error);
        open &= ~same;
    }
    return shadowed;
}
