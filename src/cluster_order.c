#include "strict.h"

#include "cluster_order.h"

#include "kernels/raster.h"
#include "scene.h"
#include "starts.h"

#include <math.h>

/* The mesh's order stays unless the sum of its boxes is so many times that along the curve. */
#define KEEPING 1.5

/* Digits of 11 bits: six passes sort the keys of 63 bits. */
#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)
#define KEY_BITS 63

typedef struct place {
    uint64_t key;
    uint32_t triangle;
} place;

static void grow_by_triangle(const shb_mesh *mesh, uint32_t triangle, shb_box *box) {
    uint32_t vertices[3];
    shb_mesh_triangle(mesh, triangle, vertices);
    for (int k = 0; k < 3; k++) {
        const shb_vec3 corner = shb_mesh_point(mesh, vertices[k]);
        if (vec3_is_finite(corner))
            box_grow(box, corner);
    }
}

/* Half the surface of a box. */
static double surface(const shb_box *box) {
    if (box->lo.x > box->hi.x)
        return 0;
    const double x = box->hi.x - box->lo.x, y = box->hi.y - box->lo.y, z = box->hi.z - box->lo.z;
    return x * y + y * z + z * x;
}

/* The surfaces of all runs of SHB_CHUNK triangles in the order of the places; NULL: of the mesh. */
static double measure_runs(const shb_mesh *mesh, const place *places) {
    double sum = 0;
    for (uint64_t first = 0; first < mesh->triangle_count; first += SHB_CHUNK) {
        shb_box box = box_empty();
        for (uint64_t i = first; i < first + SHB_CHUNK && i < mesh->triangle_count; i++)
            grow_by_triangle(mesh, places ? places[i].triangle : (uint32_t)i, &box);
        sum += surface(&box);
    }
    return sum;
}

/* 21 bits, two zeros before each. */
static uint64_t spread_bits(uint64_t bits) {
    bits = (bits | bits << 32) & 0x1f00000000ffffu;
    bits = (bits | bits << 16) & 0x1f0000ff0000ffu;
    bits = (bits | bits << 8) & 0x100f00f00f00f00fu;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3u;
    return (bits | bits << 2) & 0x1249249249249249u;
}

static uint64_t quantize(double offset, double scale) {
    const double steps = offset * scale;
    return steps > 0 ? (uint64_t)(steps < 0x1fffff ? steps : 0x1fffff) : 0;
}

/* The place on a Morton curve through a cube of 2^21 cells a side; what is not finite comes first.
 */
static uint64_t key_of(const shb_mesh *mesh, uint32_t triangle, const shb_box *bounds,
                       double scale) {
    shb_box box = box_empty();
    grow_by_triangle(mesh, triangle, &box);
    return spread_bits(quantize((box.lo.x + box.hi.x) / 2 - bounds->lo.x, scale)) |
           spread_bits(quantize((box.lo.y + box.hi.y) / 2 - bounds->lo.y, scale)) << 1 |
           spread_bits(quantize((box.lo.z + box.hi.z) / 2 - bounds->lo.z, scale)) << 2;
}

static void place_triangles(const shb_mesh *mesh, place *places) {
    shb_box bounds = box_empty();
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        grow_by_triangle(mesh, i, &bounds);
    const double size =
        fmax(bounds.hi.x - bounds.lo.x, fmax(bounds.hi.y - bounds.lo.y, bounds.hi.z - bounds.lo.z));
    const double scale = size > 0 ? 0x1p21 / size : 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        places[i] = (place){key_of(mesh, i, &bounds, scale), i};
}

/* One pass: stable, by one digit. */
static void sort_by_digit(size_t count, const place *from, int shift, place *to) {
    size_t starts[DIGITS] = {0};
    for (size_t i = 0; i < count; i++)
        starts[(from[i].key >> shift) % DIGITS]++;
    shb_starts_of_lengths(DIGITS, starts);
    for (size_t i = 0; i < count; i++)
        to[starts[(from[i].key >> shift) % DIGITS]++] = from[i];
}

/* The number of passes is even, so that the result is where it was. */
static void sort(size_t count, place *places, place *others) {
    for (int shift = 0; shift < KEY_BITS; shift += 2 * DIGIT_BITS) {
        sort_by_digit(count, places, shift, others);
        sort_by_digit(count, others, shift + DIGIT_BITS, places);
    }
}

bool shb_cluster_order(const shb_context *context, const shb_mesh *mesh, uint32_t **order) {
    const size_t count = mesh->triangle_count;
    place *places = shb_alloc(context, count, sizeof *places);
    place *others = shb_alloc(context, count, sizeof *others);
    const bool done = places && others;
    *order = NULL;
    if (done) {
        place_triangles(mesh, places);
        sort(count, places, others);
        if (measure_runs(mesh, NULL) > KEEPING * measure_runs(mesh, places)) {
            *order = (uint32_t *)(void *)others;
            for (size_t i = 0; i < count; i++)
                (*order)[i] = places[i].triangle;
        }
    }
    shb_free(context, places);
    if (!*order)
        shb_free(context, others);
    return done;
}
