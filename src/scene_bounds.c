/* The box around the vertices that triangles use.
 *
 * Vertices are looked at in runs, and one by one only where the box of a run may reach beyond what
 * is known: clusters know theirs, that of other runs is found first. One vertex of each run goes
 * before all, so that most boxes reach no farther from the start.
 *
 * Most meshes without clusters use all of their vertices. So the box of all is found, not that of
 * three for each triangle, and it is the answer if triangles use a vertex on each side that the
 * mesh stretches. */
#include "strict.h"

#include "clusters.h"
#include "floats4.h"
#include "scene.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* Triangles and vertices of a run. */
enum { TRIANGLES = 32, VERTICES = 3 * TRIANGLES, SIDES = 6 };

/* How far a box reaches to each side, and a vertex that lies there. */
typedef struct sides {
    double reach[SIDES];
    uint32_t vertices[SIDES];
} sides;

static sides no_sides(void) {
    sides result = {.vertices = {0}};
    for (int i = 0; i < SIDES; i++)
        result.reach[i] = -HUGE_VAL;
    return result;
}

static void stretch(sides *s, int side, double reach, uint32_t vertex) {
    if (reach > s->reach[side]) {
        s->reach[side] = reach;
        s->vertices[side] = vertex;
    }
}

static void add_point(sides *s, const shb_mat4 *transform, const float position[3],
                      uint32_t vertex) {
    const shb_vec3 p = mat4_transform_point(transform, vec3_from_floats(position));
    if (!vec3_is_finite(p))
        return;
    stretch(s, 0, -p.x, vertex);
    stretch(s, 1, -p.y, vertex);
    stretch(s, 2, -p.z, vertex);
    stretch(s, 3, p.x, vertex);
    stretch(s, 4, p.y, vertex);
    stretch(s, 5, p.z, vertex);
}

/* How far the corners of a box of mesh positions reach. Rounding keeps the order, so that no vertex
 * in it reaches farther; NaN: none of them is finite. */
static void find_reach(const float lo[3], const float hi[3], const shb_mat4 *transform,
                       double reach[SIDES]) {
    for (int axis = 0; axis < 3; axis++) {
        const double *row = transform->m + axis;
        double least[3], greatest[3];
        for (int k = 0; k < 3; k++) {
            const double a = row[4 * k] * (double)lo[k], b = row[4 * k] * (double)hi[k];
            least[k] = a < b ? a : b;
            greatest[k] = a > b ? a : b;
        }
        reach[axis] = -(least[0] + least[1] + least[2] + row[12]);
        reach[3 + axis] = greatest[0] + greatest[1] + greatest[2] + row[12];
    }
}

/* True unless all sides lie beyond the box; also where lo[0] is NaN. */
static inline bool may_stretch(const sides *s, const float lo[3], const float hi[3],
                               const shb_mat4 *transform) {
    double reach[SIDES];
    find_reach(lo, hi, transform, reach);
    bool is_beyond = isnan(lo[0]);
    for (int i = 0; i < SIDES; i++)
        is_beyond |= reach[i] > s->reach[i];
    return is_beyond;
}

/* x, y or z of a vertex in vectors of x, y, z, x, y, z, ... */
static inline float part_of(const floats4 v[3], int vertex, int axis) {
    return v[(3 * vertex + axis) / 4][(3 * vertex + axis) % 4];
}

/* A multiple of four vertices, which three vectors hold. */
static uint32_t pad(uint32_t count) {
    return (count + 3) & ~3u;
}

/* The box of a run's positions, which follow each other and are padded by some of them; lo[0] is
 * NaN if one of them is not finite. */
static void bound_run(const float *positions, uint32_t count, float lo[3], float hi[3]) {
    floats4 least[3], greatest[3], sums[3] = {splat4(0), splat4(0), splat4(0)};
    for (int k = 0; k < 3; k++)
        least[k] = greatest[k] = load4(positions + 4 * k);
    for (uint32_t i = 0; i < 3 * pad(count); i += 12)
        for (uint32_t k = 0; k < 3; k++) {
            const floats4 p = load4(positions + i + 4 * k);
            least[k] = min4(least[k], p);
            greatest[k] = max4(greatest[k], p);
            sums[k] += p;
        }
    for (int k = 0; k < 3; k++) {
        lo[k] = min_of(min_of(part_of(least, 0, k), part_of(least, 1, k)),
                       min_of(part_of(least, 2, k), part_of(least, 3, k)));
        hi[k] = max_of(max_of(part_of(greatest, 0, k), part_of(greatest, 1, k)),
                       max_of(part_of(greatest, 2, k), part_of(greatest, 3, k)));
    }
    const float sum = sum4(sums[0] + sums[1] + sums[2]);
    lo[0] += sum - sum;
}

static void add_run(sides *s, const shb_mat4 *transform, const float *positions, uint32_t count,
                    uint32_t first) {
    float lo[3], hi[3];
    bound_run(positions, count, lo, hi);
    if (!may_stretch(s, lo, hi, transform))
        return;
    for (uint32_t i = 0; i < count; i++)
        add_point(s, transform, positions + 3 * (size_t)i, first + i);
}

/* Copies positions of the mesh's vertices, padded. vertices NULL: from first on. */
static void copy_run(const shb_mesh *mesh, const uint32_t *vertices, uint32_t first, uint32_t count,
                     float *positions) {
    for (uint32_t i = 0; i < pad(count); i++) {
        const uint32_t number = i < count ? i : 0;
        const float *at = shb_mesh_position(mesh, vertices ? vertices[number] : first + number);
        memcpy(positions + 3 * (size_t)i, at, 3 * sizeof *at);
    }
}

static void add_vertices(sides *s, const shb_mesh *mesh, const shb_mat4 *transform) {
    const bool is_packed = shb_triple_stride(mesh->position_stride) == 3 * sizeof(float);
    for (size_t i = 0; i < mesh->vertex_count; i += VERTICES)
        add_point(s, transform, shb_mesh_position(mesh, (uint32_t)i), (uint32_t)i);
    for (uint32_t first = 0, count; first < mesh->vertex_count; first += count) {
        const uint32_t left = mesh->vertex_count - first;
        count = left < VERTICES ? left : VERTICES;
        if (is_packed && count == pad(count)) {
            add_run(s, transform, shb_mesh_position(mesh, first), count, first);
        } else {
            float copy[3 * VERTICES];
            copy_run(mesh, NULL, first, count, copy);
            add_run(s, transform, copy, count, first);
        }
    }
}

static uint32_t count_runs(const shb_mesh *mesh) {
    return mesh->triangle_count / TRIANGLES + (mesh->triangle_count % TRIANGLES != 0);
}

/* Vertices of a run of triangles; returns how many. */
static uint32_t read_run(const shb_mesh *mesh, uint32_t number, uint32_t run[VERTICES]) {
    const uint32_t first = number * TRIANGLES, left = mesh->triangle_count - first;
    const uint32_t count = left < TRIANGLES ? left : TRIANGLES;
    for (uint32_t i = 0; i < count; i++)
        shb_mesh_triangle(mesh, first + i, run + 3 * (size_t)i);
    return 3 * count;
}

static void add_triangles(sides *s, const shb_mesh *mesh, const shb_mat4 *transform) {
    const uint32_t runs = count_runs(mesh);
    uint32_t run[VERTICES];
    for (uint32_t i = 0; i < runs; i++) {
        shb_mesh_triangle(mesh, i * TRIANGLES, run);
        add_point(s, transform, shb_mesh_position(mesh, run[0]), 0);
    }
    for (uint32_t i = 0; i < runs; i++) {
        float positions[3 * VERTICES];
        const uint32_t count = read_run(mesh, i, run);
        copy_run(mesh, run, 0, count, positions);
        add_run(s, transform, positions, count, 0);
    }
}

static bool holds(const shb_mesh *mesh, uint32_t number, uint32_t vertex) {
    uint32_t run[VERTICES], found = 0;
    const uint32_t count = read_run(mesh, number, run);
    for (uint32_t i = 0; i < count; i++)
        found |= run[i] == vertex;
    return found;
}

/* Looks first where the vertex is if triangles use all of them in order. */
static bool is_used(const shb_mesh *mesh, uint32_t vertex) {
    const uint32_t runs = count_runs(mesh);
    const uint32_t guess = (uint32_t)((uint64_t)vertex * runs / mesh->vertex_count);
    for (uint32_t step = 0; step <= guess || step < runs - guess; step++)
        if ((step <= guess && holds(mesh, guess - step, vertex)) ||
            (step < runs - guess && holds(mesh, guess + step, vertex)))
            return true;
    return false;
}

/* True if triangles use the vertices on all sides that lie beyond those before. */
static bool are_used(const shb_mesh *mesh, const sides *before, const sides *s) {
    for (int i = 0; i < SIDES; i++)
        if (s->reach[i] > before->reach[i] && !is_used(mesh, s->vertices[i]))
            return false;
    return true;
}

static void add_cluster_vertex(sides *s, const shb_clusters *clusters, const shb_cluster *cluster,
                               size_t vertex, const shb_mat4 *transform) {
    const size_t places = shb_cluster_places(cluster->vertex_count);
    const float *x = clusters->positions + 3 * cluster->first_vertex + vertex;
    add_point(s, transform, (const float[3]){x[0], x[places], x[2 * places]}, 0);
}

static void add_clusters(sides *s, const shb_clusters *clusters, const shb_mat4 *transform) {
    for (size_t i = 0; i < clusters->count; i++)
        add_cluster_vertex(s, clusters, &clusters->clusters[i], 0, transform);
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        if (may_stretch(s, cluster->lo, cluster->hi, transform))
            for (size_t v = 1; v < cluster->vertex_count; v++)
                add_cluster_vertex(s, clusters, cluster, v, transform);
    }
}

/* False if an index is out of range. */
static bool add_mesh(sides *s, const shb_mesh *mesh, const shb_mat4 *transform) {
    if (mesh->clusters) {
        add_clusters(s, mesh->clusters, transform);
        return true;
    }
    if (!shb_mesh_has_valid_indices(mesh))
        return false;
    const bool tries_all = mesh->vertex_count <= 3 * (uint64_t)mesh->triangle_count;
    sides tried = *s;
    if (tries_all)
        add_vertices(&tried, mesh, transform);
    if (tries_all && are_used(mesh, s, &tried))
        *s = tried;
    else
        add_triangles(s, mesh, transform);
    return true;
}

shb_result shb_scene_bounds(const shb_scene *scene, shb_box *bounds) {
    const shb_result result = shb_scene_check(NULL, "", "", scene);
    if (result)
        return result;
    if (!bounds)
        return SHB_ERROR_ARGUMENT;
    sides all = no_sides();
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_instance *instance = &scene->instances[i];
        const shb_mat4 transform = shb_instance_transform(instance);
        if (!add_mesh(&all, instance->mesh, &transform))
            return SHB_ERROR_ARGUMENT;
    }
    /* Adding 0 turns -0 to 0: which of them came first says nothing. */
    *bounds = (shb_box){{0 - all.reach[0], 0 - all.reach[1], 0 - all.reach[2]},
                        {all.reach[3] + 0, all.reach[4] + 0, all.reach[5] + 0}};
    return SHB_OK;
}
