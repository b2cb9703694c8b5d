/* A ray to a sample of the light is a sum, with weights of at least 0, of the rays to the light's
 * corners. So it lies on the inner side of a plane through the point and two neighbouring corners,
 * and within the box of point and corners.
 *
 * Rounding: with e_i the largest coordinate of light and point along axis i, corners and samples
 * are off by at most 3 u e_i (u = 2^-53), an element i of a plane's normal by 20 u e_j e_k, and a
 * corner of a triangle, as the ray test sees it, by 8 u of its distance d_i. A margin of
 * 2^-44 sum e_j e_k d_i is some ten times what all of it moves the product of plane and corner. */
#include "../strict.h"

#include "shaft.h"

#include <math.h>

#define SLACK 0x1p-44

static double larger(double a, double b) {
    return a > b ? a : b;
}

static double smaller(double a, double b) {
    return a < b ? a : b;
}

/* Corner k of the light, 0 .. 3 around it, seen from the middle. */
static void light_corner(const shb_area_light *area, int k, double corner[3]) {
    const double a = k == 1 || k == 2 ? 1 : -1, b = k >= 2 ? 1 : -1;
    corner[0] = area->light.position.x + a * area->u.x + b * area->v.x;
    corner[1] = area->light.position.y + a * area->u.y + b * area->v.y;
    corner[2] = area->light.position.z + a * area->u.z + b * area->v.z;
}

/* Element i is how far the hierarchy reaches from the point along axis i, or the point from 0. */
static void find_reach(const shb_bvh *bvh, const double origin[3], double reach[3]) {
    for (int i = 0; i < 3; i++) {
        reach[i] = larger(fabs(origin[i]), fabs((double)bvh->root.box[0][i] - origin[i]));
        reach[i] = larger(reach[i], fabs((double)bvh->root.box[1][i] - origin[i]));
    }
}

static void set_box(shb_shaft *shaft, bool directional, double corners[4][3],
                    const double reach[3]) {
    for (int i = 0; i < 3; i++) {
        const double origin = shaft->origin[i];
        double lo = origin, hi = origin, margin = reach[i];
        for (int k = 0; k < 4; k++) {
            const double far = corners[k][i];
            lo = directional ? (far < 0 ? -HUGE_VAL : lo) : smaller(lo, far);
            hi = directional ? (far > 0 ? HUGE_VAL : hi) : larger(hi, far);
            margin = larger(margin, fabs(far));
        }
        shaft->box[0][i] = lo - SLACK * margin;
        shaft->box[1][i] = hi + SLACK * margin;
    }
}

/* The plane through the directions a and b, its inner side that of `middle`. Without a margin it
 * tells from rounding it cuts nothing off. */
static void set_plane(shb_shaft *shaft, int k, const double a[3], const double b[3],
                      const double middle[3], const double extent[3], const double reach[3]) {
    double side = 0, margin = 0, side_margin = 0;
    double *plane = shaft->planes[k];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        plane[i] = a[j] * b[l] - a[l] * b[j];
        side += plane[i] * middle[i];
        margin += SLACK * extent[j] * extent[l] * reach[i];
        side_margin += SLACK * extent[j] * extent[l] * extent[i];
    }
    const double sign = side < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        plane[i] *= sign;
    shaft->margins[k] = fabs(side) > side_margin ? margin : HUGE_VAL;
}

shb_shaft shb_shaft_of(const shb_bvh *bvh, const shb_area_light *area, shb_vec3 point) {
    shb_shaft shaft = {.origin = {point.x, point.y, point.z}};
    const bool directional = area->light.w == 0;
    double corners[4][3], directions[4][3], middle[3], extent[3], reach[3];
    find_reach(bvh, shaft.origin, reach);
    for (int k = 0; k < 4; k++)
        light_corner(area, k, corners[k]);
    for (int i = 0; i < 3; i++) {
        const double origin = directional ? 0 : shaft.origin[i];
        extent[i] = fabs(origin);
        for (int k = 0; k < 4; k++) {
            directions[k][i] = corners[k][i] - origin;
            extent[i] = larger(extent[i], fabs(corners[k][i]));
        }
        middle[i] = 0.5 * (directions[0][i] + directions[2][i]);
    }
    set_box(&shaft, directional, corners, reach);
    for (int k = 0; k < 4; k++)
        set_plane(&shaft, k, directions[k], directions[(k + 1) % 4], middle, extent, reach);
    return shaft;
}

static bool misses_box(const shb_shaft *shaft, const float box[2][3]) {
    for (int i = 0; i < 3; i++)
        if ((double)box[0][i] > shaft->box[1][i] || (double)box[1][i] < shaft->box[0][i])
            return true;
    for (int k = 0; k < 4; k++) {
        const double *plane = shaft->planes[k];
        double inmost = 0;
        for (int i = 0; i < 3; i++)
            inmost += plane[i] * ((double)box[plane[i] > 0][i] - shaft->origin[i]);
        if (inmost < -shaft->margins[k])
            return true;
    }
    return false;
}

static bool misses_triangle(const shb_shaft *shaft, const shb_triangle *triangle) {
    for (int k = 0; k < 4; k++) {
        const double *plane = shaft->planes[k];
        double inmost = -HUGE_VAL;
        for (int corner = 0; corner < 3; corner++) {
            double product = 0;
            for (int i = 0; i < 3; i++)
                product += plane[i] * (triangle->corners[corner][i] - shaft->origin[i]);
            inmost = larger(inmost, product);
        }
        if (inmost < -shaft->margins[k])
            return true;
    }
    return false;
}

/* Appends what the shaft may meet of a leaf; false: there are too many. */
static bool gather_leaf(const shb_bvh *bvh, const shb_bvh_child *leaf, const shb_shaft *shaft,
                        uint32_t own_id, uint32_t most, const shb_triangle **triangles,
                        uint32_t *count) {
    for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
        const shb_triangle *triangle = &bvh->triangles[i];
        if (triangle->id == own_id || misses_triangle(shaft, triangle))
            continue;
        if (*count == most)
            return false;
        triangles[(*count)++] = triangle;
    }
    return true;
}

bool shb_shaft_gather(const shb_bvh *bvh, const shb_shaft *shaft, uint32_t own_id, uint32_t most,
                      const shb_triangle **triangles, uint32_t *count) {
    *count = 0;
    if (bvh->count == 0)
        return true;
    const shb_bvh_child *waiting[SHB_BVH_DEPTH + 1] = {&bvh->root};
    size_t waiting_count = 1;
    while (waiting_count) {
        const shb_bvh_child *child = waiting[--waiting_count];
        if (misses_box(shaft, child->box))
            continue;
        if (child->count) {
            if (!gather_leaf(bvh, child, shaft, own_id, most, triangles, count))
                return false;
        } else {
            waiting[waiting_count++] = &bvh->nodes[child->first].children[0];
            waiting[waiting_count++] = &bvh->nodes[child->first].children[1];
        }
    }
    return true;
}
