#include "strict.h"

#include "cluster_order.h"

#include "kernels/raster.h"
#include "scene.h"

#include <math.h>

/* Steps along a side of the cube that triangles are placed in. */
#define STEPS (1 << 21)

/* The middle of a triangle's box. */
typedef struct place {
    uint32_t at[3]; /* steps */
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

static uint32_t quantize(double offset, double scale) {
    const double steps = offset * scale;
    return steps > 0 ? (uint32_t)(steps < STEPS - 1 ? steps : STEPS - 1) : 0;
}

/* What is not finite comes first. */
static place place_of(const shb_mesh *mesh, uint32_t triangle, shb_vec3 origin, double scale) {
    shb_box box = box_empty();
    grow_by_triangle(mesh, triangle, &box);
    return (place){{quantize((box.lo.x + box.hi.x) / 2 - origin.x, scale),
                    quantize((box.lo.y + box.hi.y) / 2 - origin.y, scale),
                    quantize((box.lo.z + box.hi.z) / 2 - origin.z, scale)},
                   triangle};
}

static void place_triangles(const shb_mesh *mesh, place *places) {
    shb_box bounds = box_empty();
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        grow_by_triangle(mesh, i, &bounds);
    const double size =
        fmax(bounds.hi.x - bounds.lo.x, fmax(bounds.hi.y - bounds.lo.y, bounds.hi.z - bounds.lo.z));
    const double scale = size > 0 ? STEPS / size : 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        places[i] = place_of(mesh, i, bounds.lo, scale);
}

/* Moves those up to a limit along the axis to the front, without a branch; returns how many. */
static size_t divide(size_t count, int axis, uint32_t limit, place *places) {
    size_t lower = 0;
    for (size_t i = 0; i < count; i++) {
        const place moved = places[i];
        places[i] = places[lower];
        places[lower] = moved;
        lower += moved.at[axis] <= limit;
    }
    return lower;
}

/* None of the first so many is farther along the axis than the others; all are lo .. hi. */
static void select_first(size_t first, size_t count, int axis, uint32_t lo, uint32_t hi,
                         place *places) {
    while (lo < hi) {
        const uint32_t middle = lo + (hi - lo) / 2;
        const size_t lower = divide(count, axis, middle, places);
        if (lower == first)
            return;
        if (lower > first) {
            count = lower;
            hi = middle;
        } else {
            first -= lower;
            count -= lower;
            places += lower;
            lo = middle + 1;
        }
    }
}

/* Halves, of whole runs, along the longest side of the places' box, and so on down to runs. */
static void split(size_t count, place *places) {
    uint32_t lo[3] = {STEPS, STEPS, STEPS}, hi[3] = {0, 0, 0};
    if (count <= SHB_CHUNK)
        return;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = places[i].at[k] < lo[k] ? places[i].at[k] : lo[k];
            hi[k] = places[i].at[k] > hi[k] ? places[i].at[k] : hi[k];
        }
    int axis = hi[1] - lo[1] > hi[0] - lo[0] ? 1 : 0;
    axis = hi[2] - lo[2] > hi[axis] - lo[axis] ? 2 : axis;
    const size_t half = (count + SHB_CHUNK - 1) / SHB_CHUNK / 2 * SHB_CHUNK;
    select_first(half, count, axis, lo[axis], hi[axis], places);
    split(half, places);
    split(count - half, places + half);
}

uint32_t *shb_cluster_order(const shb_context *context, const shb_mesh *mesh) {
    const size_t count = mesh->triangle_count;
    place *places = shb_alloc(context, count, sizeof *places);
    if (!places)
        return NULL;
    place_triangles(mesh, places);
    split(count, places);
    uint32_t *order = (uint32_t *)(void *)places;
    for (size_t i = 0; i < count; i++)
        order[i] = places[i].triangle;
    return order;
}
