#include "strict.h"

#include "cluster_bounds.h"

#include <math.h>

/* Triangles lower than this, or than this part of their longest edge, leave their cluster without
 * normals: theirs are known too badly. */
#define HEIGHT_MIN 0x1p-120
#define HEIGHT_PART_MIN 0x1p-30

/* The height is that of exact arithmetic at least. */
#define HEIGHT_SLACK (1 - 0x1p-16)

typedef struct facet {
    shb_vec3 normal; /* of length 1 */
    double height;   /* over the longest edge */
} facet;

static shb_vec3 position_of(const float *positions, size_t places, uint32_t vertex) {
    return (shb_vec3){(double)positions[vertex], (double)positions[places + vertex],
                      (double)positions[2 * places + vertex]};
}

static bool are_equal(shb_vec3 a, shb_vec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Edges are rounded by 2^-53 of their size, each product of two in the normal by 2^-51 |edge|^2:
 * with a height of at least 2^-30 of the longest edge the normal turns by less than 2^-19. */
static bool find_facet(const shb_vec3 corners[3], facet *found) {
    const shb_vec3 b = shb_vec3_subtract(corners[1], corners[0]);
    const shb_vec3 c = shb_vec3_subtract(corners[2], corners[0]);
    const shb_vec3 a = shb_vec3_subtract(corners[2], corners[1]);
    const shb_vec3 normal = shb_vec3_cross(b, c);
    const double area = shb_vec3_length(normal);
    const double longest = fmax(shb_vec3_length(a), fmax(shb_vec3_length(b), shb_vec3_length(c)));
    const double height = area / longest;
    if (!(height >= HEIGHT_MIN && height >= HEIGHT_PART_MIN * longest))
        return false;
    *found = (facet){shb_vec3_scale(normal, 1 / area), height * HEIGHT_SLACK};
    return true;
}

static void bound_box(const float *positions, shb_cluster *cluster) {
    const size_t places = shb_cluster_places(cluster->vertex_count);
    bool finite = true;
    for (int axis = 0; axis < 3; axis++) {
        const float *p = positions + (size_t)axis * places;
        cluster->lo[axis] = cluster->hi[axis] = p[0];
        for (uint32_t i = 0; i < cluster->vertex_count; i++) {
            finite &= isfinite(p[i]) != 0;
            cluster->lo[axis] = p[i] < cluster->lo[axis] ? p[i] : cluster->lo[axis];
            cluster->hi[axis] = p[i] > cluster->hi[axis] ? p[i] : cluster->hi[axis];
        }
    }
    if (!finite)
        cluster->lo[0] = NAN;
}

/* The facets of all triangles without two equal corners; false if the normal of one is not known.
 */
static bool find_facets(const float *positions, const uint8_t *corners, const shb_cluster *cluster,
                        facet facets[SHB_CHUNK], uint32_t *count) {
    const size_t places = shb_cluster_places(cluster->vertex_count);
    *count = 0;
    for (uint32_t t = 0; t < cluster->triangle_count; t++) {
        shb_vec3 p[3];
        for (uint32_t k = 0; k < 3; k++)
            p[k] = position_of(positions, places, corners[shb_corner_place(t, k)]);
        if (are_equal(p[0], p[1]) || are_equal(p[1], p[2]) || are_equal(p[2], p[0]))
            continue;
        if (!find_facet(p, &facets[(*count)++]))
            return false;
    }
    return true;
}

/* A normal's product with a direction is off by less than 2^-18. */
#define PRODUCT_DOUBT 0x1p-17

static int8_t largest_product(const facet *facets, uint32_t count, shb_vec3 direction) {
    double largest = -2;
    for (uint32_t i = 0; i < count; i++)
        largest = fmax(largest, shb_vec3_dot(facets[i].normal, direction));
    return (int8_t)ceil(SHB_NORMAL_UNIT * (largest + PRODUCT_DOUBT));
}

static void bound_normals(const float *positions, const uint8_t *corners, shb_cluster *cluster) {
    facet facets[SHB_CHUNK];
    uint32_t count;
    cluster->height = 0;
    if (!find_facets(positions, corners, cluster, facets, &count) || count == 0)
        return;
    double height = 0x1p100;
    for (uint32_t i = 0; i < count; i++)
        height = fmin(height, facets[i].height);
    cluster->height = (float)height;
    for (int x = -1; x <= 1; x++)
        for (int y = -1; y <= 1; y++)
            for (int z = -1; z <= 1; z++)
                cluster->largest[shb_direction(x, y, z)] =
                    largest_product(facets, count, (shb_vec3){x, y, z});
}

void shb_cluster_bound(const float *positions, const uint8_t *corners, shb_cluster *cluster) {
    bound_box(positions, cluster);
    bound_normals(positions, corners, cluster);
}
