/* The box around the vertices that triangles use.
 *
 * Clusters know theirs, and only those are looked into that may reach beyond the others. Most other
 * meshes use all of their vertices. So the box of all is found first, vertex by vertex instead of
 * three for each triangle, and it is the answer if triangles use a vertex on each of its sides: in
 * a fifth to two fifths of the time. */
#include "strict.h"

#include "clusters.h"
#include "scene.h"

#include "vector.h"

#include <math.h>

/* Triangles whose vertices are looked at together. */
enum { TRIANGLES = 64, SIDES = 6 };

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

static void add_point(sides *s, const shb_mat4 *transform, float x, float y, float z,
                      uint32_t vertex) {
    const shb_vec3 p = mat4_transform_point(transform, (shb_vec3){(double)x, (double)y, (double)z});
    if (!vec3_is_finite(p))
        return;
    stretch(s, 0, -p.x, vertex);
    stretch(s, 1, -p.y, vertex);
    stretch(s, 2, -p.z, vertex);
    stretch(s, 3, p.x, vertex);
    stretch(s, 4, p.y, vertex);
    stretch(s, 5, p.z, vertex);
}

static void add_vertex(sides *s, const shb_mesh *mesh, const shb_mat4 *transform, uint32_t vertex) {
    const float *at = shb_mesh_position(mesh, vertex);
    add_point(s, transform, at[0], at[1], at[2], vertex);
}

/* Vertices of a run of triangles; returns how many. */
static uint32_t read_run(const shb_mesh *mesh, uint32_t first, uint32_t run[3 * TRIANGLES]) {
    const uint32_t left = mesh->triangle_count - first;
    const uint32_t count = left < TRIANGLES ? left : TRIANGLES;
    for (uint32_t i = 0; i < count; i++)
        shb_mesh_triangle(mesh, first + i, run + 3 * (size_t)i);
    return 3 * count;
}

static bool is_in_range(const shb_mesh *mesh, const uint32_t *run, uint32_t count) {
    uint32_t outside = 0;
    for (uint32_t i = 0; i < count; i++)
        outside |= run[i] >= mesh->vertex_count;
    return !outside;
}

static bool holds(const uint32_t *run, uint32_t count, uint32_t vertex) {
    uint32_t found = 0;
    for (uint32_t i = 0; i < count; i++)
        found |= run[i] == vertex;
    return found;
}

/* The sides whose vertices a run does not hold, one bit each. */
static uint32_t without_held(const sides *s, uint32_t wanted, const uint32_t *run, uint32_t count) {
    uint32_t left = wanted;
    for (uint32_t bits = wanted; bits; bits &= bits - 1)
        if (holds(run, count, s->vertices[__builtin_ctz(bits)]))
            left &= ~(bits & -bits);
    return left;
}

/* False if an index is out of range; *used: triangles use a vertex on each side. */
static bool check_indices(const shb_mesh *mesh, const sides *s, bool *used) {
    uint32_t run[3 * TRIANGLES], wanted = 0;
    for (uint32_t i = 0; i < SIDES; i++)
        wanted |= (uint32_t)(s->reach[i] > -HUGE_VAL) << i;
    for (uint32_t first = 0, count; first < mesh->triangle_count; first += count / 3) {
        count = read_run(mesh, first, run);
        if (!is_in_range(mesh, run, count))
            return false;
        wanted = without_held(s, wanted, run, count);
    }
    *used = wanted == 0;
    return true;
}

static sides sides_of_triangles(const shb_mesh *mesh, const shb_mat4 *transform) {
    uint32_t run[3 * TRIANGLES];
    sides result = no_sides();
    for (uint32_t first = 0, count; first < mesh->triangle_count; first += count / 3) {
        count = read_run(mesh, first, run);
        for (uint32_t i = 0; i < count; i++)
            add_vertex(&result, mesh, transform, run[i]);
    }
    return result;
}

/* The transformed corner of the cluster's box that lies farthest along an axis, forwards or back:
 * rounding keeps the order, so that no vertex lies farther. */
static double farthest(const shb_cluster *cluster, const double *row, bool forwards) {
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = (double)((row[4 * k] > 0) == forwards ? cluster->hi[k] : cluster->lo[k]);
    return row[0] * at[0] + row[4] * at[1] + row[8] * at[2] + row[12];
}

/* True unless all sides lie beyond the cluster; where a number is not finite, too. */
static bool may_stretch(const sides *s, const shb_cluster *cluster, const shb_mat4 *transform) {
    for (int axis = 0; axis < 3; axis++)
        if (!(-farthest(cluster, transform->m + axis, false) <= s->reach[axis]) ||
            !(farthest(cluster, transform->m + axis, true) <= s->reach[3 + axis]))
            return true;
    return false;
}

static sides sides_of_clusters(const shb_clusters *clusters, const shb_mat4 *transform) {
    sides result = no_sides();
    for (size_t i = 0; i < clusters->count; i++) {
        const shb_cluster *cluster = &clusters->clusters[i];
        if (!may_stretch(&result, cluster, transform))
            continue;
        const size_t places = shb_cluster_places(cluster->vertex_count);
        const float *x = clusters->positions + 3 * cluster->first_vertex;
        for (size_t v = 0; v < cluster->vertex_count; v++)
            add_point(&result, transform, x[v], x[places + v], x[2 * places + v], 0);
    }
    return result;
}

/* False if an index is out of range. */
static bool sides_of_mesh(const shb_mesh *mesh, const shb_mat4 *transform, sides *result) {
    const uint64_t corners = 3 * (uint64_t)mesh->triangle_count;
    if (mesh->clusters) {
        *result = sides_of_clusters(mesh->clusters, transform);
        return true;
    }
    *result = no_sides();
    bool used = false;
    if (mesh->vertex_count <= corners)
        for (uint32_t i = 0; i < mesh->vertex_count; i++)
            add_vertex(result, mesh, transform, i);
    if (!check_indices(mesh, result, &used))
        return false;
    if (mesh->vertex_count > corners || !used)
        *result = sides_of_triangles(mesh, transform);
    return true;
}

shb_result shb_scene_bounds(const shb_scene *scene, shb_box *bounds) {
    const char *reason;
    const shb_result result = shb_scene_check(scene, &reason);
    if (result)
        return result;
    if (!bounds)
        return SHB_ERROR_ARGUMENT;
    sides all = no_sides();
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_instance *instance = &scene->instances[i];
        const shb_mat4 transform = shb_instance_transform(instance);
        sides own;
        if (!sides_of_mesh(instance->mesh, &transform, &own))
            return SHB_ERROR_ARGUMENT;
        for (int side = 0; side < SIDES; side++)
            stretch(&all, side, own.reach[side], 0);
    }
    *bounds = (shb_box){{-all.reach[0], -all.reach[1], -all.reach[2]},
                        {all.reach[3], all.reach[4], all.reach[5]}};
    return SHB_OK;
}
