/* A ray to a sample of the light is a sum, with weights of at least 0, of the rays to the light's
 * corners. So it lies on the inner side of a plane through the point and two neighbouring corners,
 * within the box of point and corners, and on that side of any other plane through the point on
 * which all four of these are.
 *
 * Rounding: with e_i the largest coordinate of light and point along axis i, corners and samples
 * are off by at most 3 u e_i (u = 2^-53), an element i of a plane's normal by 20 u e_j e_k, and a
 * corner of a triangle, as the ray test sees it, by 8 u of its distance d_i. A margin of
 * 2^-44 sum e_j e_k d_i is some ten times what all of it moves the product of plane and corner. The
 * plane of an edge from a to b, both of size s at most along any axis, carries 6 u s s in each
 * element and as much again for the ray test's corners; its product with a direction of size e has
 * three of them: 2^-44 s s e is more than ten times as much. */
#include "../strict.h"

#include "shaft.h"

#include <math.h>

#include "../area_light.h"
#include "../larger.h"

#define SLACK 0x1p-44

static double smaller(double a, double b) {
    return a < b ? a : b;
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

/* The plane through two neighbouring corners, its inner side that of `middle`; where rounding hides
 * which side that is, it cuts nothing off. */
static void set_plane(shb_shaft *shaft, int k, const double middle[3], const double extent[3],
                      const double reach[3]) {
    const double *a = shaft->directions[k], *b = shaft->directions[(k + 1) % 4];
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
    double corners[4][3], middle[3], extent[3], reach[3];
    find_reach(bvh, shaft.origin, reach);
    for (int k = 0; k < 4; k++) {
        const shb_vec3 corner = shb_area_corner(area, k).position;
        corners[k][0] = corner.x;
        corners[k][1] = corner.y;
        corners[k][2] = corner.z;
    }
    for (int i = 0; i < 3; i++) {
        const double origin = directional ? 0 : shaft.origin[i];
        extent[i] = fabs(origin);
        for (int k = 0; k < 4; k++) {
            shaft.directions[k][i] = corners[k][i] - origin;
            extent[i] = larger(extent[i], fabs(corners[k][i]));
        }
        middle[i] = 0.5 * (shaft.directions[0][i] + shaft.directions[2][i]);
        shaft.extent = larger(shaft.extent, extent[i]);
    }
    set_box(&shaft, directional, corners, reach);
    for (int k = 0; k < 4; k++)
        set_plane(&shaft, k, middle, extent, reach);
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

static double dot(const double a[3], const double b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* ---- triangles ---- */

static shb_shaft_blocker blocker_of(const shb_shaft *shaft, const shb_triangle *triangle) {
    shb_shaft_blocker blocker = {.triangle = triangle};
    double corners[3][3], size = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            corners[k][i] = triangle->corners[k][i] - shaft->origin[i];
            size = larger(size, fabs(corners[k][i]));
        }
    for (int k = 0; k < 3; k++) {
        const double *a = corners[k], *b = corners[(k + 1) % 3];
        for (int i = 0; i < 3; i++) {
            const int j = (i + 1) % 3, l = (i + 2) % 3;
            blocker.planes[k][i] = a[j] * b[l] - a[l] * b[j];
        }
    }
    blocker.margin = SLACK * size * size * shaft->extent;
    return blocker;
}

/* 1 or -1 if all of the shaft lies on that side of a plane through the point, else 0. */
static int side_of_shaft(const shb_shaft *shaft, const double plane[3], double margin) {
    bool above = true, below = true;
    for (int k = 0; k < 4; k++) {
        const double product = dot(plane, shaft->directions[k]);
        above &= product > margin;
        below &= product < -margin;
    }
    return above ? 1 : below ? -1 : 0;
}

static bool misses_edges(const shb_shaft *shaft, const shb_shaft_blocker *blocker) {
    bool above = false, below = false;
    for (int k = 0; k < 3; k++) {
        const int side = side_of_shaft(shaft, blocker->planes[k], blocker->margin);
        above |= side > 0;
        below |= side < 0;
    }
    return above && below;
}

static bool misses_corners(const shb_shaft *shaft, const shb_triangle *triangle) {
    for (int k = 0; k < 4; k++) {
        double inmost = -HUGE_VAL;
        for (int corner = 0; corner < 3; corner++) {
            double way[3];
            for (int i = 0; i < 3; i++)
                way[i] = triangle->corners[corner][i] - shaft->origin[i];
            inmost = larger(inmost, dot(shaft->planes[k], way));
        }
        if (inmost < -shaft->margins[k])
            return true;
    }
    return false;
}

bool shb_shaft_blocker_is_missed(const shb_shaft_blocker *blocker, const double direction[3]) {
    const double a = dot(blocker->planes[0], direction), b = dot(blocker->planes[1], direction);
    const double c = dot(blocker->planes[2], direction), margin = blocker->margin;
    return (a > margin || b > margin || c > margin) && (a < -margin || b < -margin || c < -margin);
}

bool shb_shaft_is_covered(const shb_shaft *shaft, const shb_shaft_blocker *blocker) {
    const int side = side_of_shaft(shaft, blocker->planes[0], blocker->margin);
    return side && side_of_shaft(shaft, blocker->planes[1], blocker->margin) == side &&
           side_of_shaft(shaft, blocker->planes[2], blocker->margin) == side;
}

bool shb_shaft_is_before(const shb_shaft *shaft, shb_vec3 normal) {
    const double plane[3] = {normal.x, normal.y, normal.z};
    const double size = larger(larger(fabs(normal.x), fabs(normal.y)), fabs(normal.z));
    return side_of_shaft(shaft, plane, SLACK * size * shaft->extent) > 0;
}

/* ---- gathering ---- */

/* Appends what the shaft may meet of a leaf; false: there are too many. */
static bool gather_leaf(const shb_bvh *bvh, const shb_bvh_child *leaf, const shb_shaft *shaft,
                        uint32_t own_id, uint32_t most, shb_shaft_blocker *blockers,
                        uint32_t *count) {
    for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
        const shb_triangle *triangle = &bvh->triangles[i];
        if (triangle->id == own_id || misses_corners(shaft, triangle))
            continue;
        const shb_shaft_blocker blocker = blocker_of(shaft, triangle);
        if (misses_edges(shaft, &blocker))
            continue;
        if (*count == most)
            return false;
        blockers[(*count)++] = blocker;
    }
    return true;
}

bool shb_shaft_gather(const shb_bvh *bvh, const shb_shaft *shaft, uint32_t own_id, uint32_t most,
                      shb_shaft_blocker *blockers, uint32_t *count) {
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
            if (!gather_leaf(bvh, child, shaft, own_id, most, blockers, count))
                return false;
        } else {
            waiting[waiting_count++] = &bvh->nodes[child->first].children[0];
            waiting[waiting_count++] = &bvh->nodes[child->first].children[1];
        }
    }
    return true;
}
