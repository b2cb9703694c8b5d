#include "strict.h"

#include "clusters.h"

#include "cluster_bounds.h"
#include "cluster_order.h"
#include "scene.h"
#include "topology.h"

#include <string.h>

/* Slots of the table that finds vertices by position: at most a quarter is taken. */
#define SLOT_BITS 10

/* The cluster that is being gathered. Vertices with the same position are one. */
typedef struct gathering {
    const shb_mesh *mesh;
    const uint32_t *order; /* of the mesh's triangles */
    uint32_t next;         /* triangle in the order */
    uint32_t triangle_count, vertex_count;
    uint32_t triangles[SHB_CHUNK];
    uint8_t corners[3 * SHB_CHUNK];
    const float *vertices[SHB_CLUSTER_VERTICES + 3];
    uint16_t slots[1 << SLOT_BITS]; /* number of the vertex + 1 */
} gathering;

static uint32_t slot_of(const float *position) {
    uint32_t bits[3];
    memcpy(bits, position, sizeof bits);
    const uint32_t mixed = (bits[0] * 0x9e3779b1u ^ bits[1]) * 0x85ebca6bu ^ bits[2];
    return mixed * 0xc2b2ae35u >> (32 - SLOT_BITS);
}

/* The number in the cluster of the vertex at this position, which is added if it is new. */
static uint32_t find_vertex(gathering *g, const float *position) {
    for (uint32_t slot = slot_of(position);; slot = (slot + 1) % (1 << SLOT_BITS)) {
        const uint32_t number = g->slots[slot];
        if (number && memcmp(g->vertices[number - 1], position, 3 * sizeof *position) == 0)
            return number - 1;
        if (number)
            continue;
        g->vertices[g->vertex_count++] = position;
        g->slots[slot] = (uint16_t)g->vertex_count;
        return g->vertex_count - 1;
    }
}

/* Adds the next triangle; false if it does not fit any more. */
static bool add_triangle(gathering *g) {
    const uint32_t before = g->vertex_count;
    const uint32_t triangle = g->order[g->next];
    uint32_t vertices[3], numbers[3];
    shb_mesh_triangle(g->mesh, triangle, vertices);
    for (int k = 0; k < 3; k++)
        numbers[k] = find_vertex(g, shb_mesh_position(g->mesh, vertices[k]));
    if (g->vertex_count > SHB_CLUSTER_VERTICES) {
        g->vertex_count = before;
        return false;
    }
    for (uint32_t k = 0; k < 3; k++)
        g->corners[shb_corner_place(g->triangle_count, k)] = (uint8_t)numbers[k];
    g->triangles[g->triangle_count++] = triangle;
    g->next++;
    return true;
}

/* Gathers the next cluster; false if there are no triangles left. */
static bool gather(gathering *g) {
    g->triangle_count = g->vertex_count = 0;
    memset(g->slots, 0, sizeof g->slots);
    memset(g->corners, 0, sizeof g->corners);
    while (g->triangle_count < SHB_CHUNK && g->next < g->mesh->triangle_count && add_triangle(g))
        continue;
    return g->triangle_count > 0;
}

/* Clusters of a mesh, places for their vertices and for their corners. */
typedef struct cluster_room {
    size_t count, places, corners;
} cluster_room;

static cluster_room count_clusters(const shb_mesh *mesh, const uint32_t *order) {
    gathering g = {.mesh = mesh, .order = order};
    cluster_room room = {0};
    for (; gather(&g); room.count++) {
        room.places += shb_cluster_places(g.vertex_count);
        room.corners += shb_corner_places(g.triangle_count);
    }
    return room;
}

/* What is left of the places repeats the first vertex. */
static void store_positions(const gathering *g, float *positions) {
    const size_t places = shb_cluster_places(g->vertex_count);
    for (size_t i = 0; i < places; i++)
        for (size_t axis = 0; axis < 3; axis++)
            positions[axis * places + i] = g->vertices[i < g->vertex_count ? i : 0][axis];
}

static void fill(const shb_mesh *mesh, const uint32_t *order, shb_clusters *clusters) {
    gathering g = {.mesh = mesh, .order = order};
    uint32_t triangle = 0;
    uint64_t place = 0, corner = 0;
    for (shb_cluster *cluster = clusters->clusters; gather(&g); cluster++) {
        *cluster = (shb_cluster){.first_triangle = triangle,
                                 .first_vertex = place,
                                 .first_corner = corner,
                                 .triangle_count = (uint16_t)g.triangle_count,
                                 .vertex_count = (uint16_t)g.vertex_count};
        float *positions = clusters->positions + 3 * place;
        store_positions(&g, positions);
        memcpy(clusters->corners + corner, g.corners, shb_corner_places(g.triangle_count));
        memcpy(clusters->triangles + triangle, g.triangles, g.triangle_count * sizeof *g.triangles);
        shb_cluster_bound(positions, clusters->corners + corner, cluster);
        triangle += g.triangle_count;
        place += shb_cluster_places(g.vertex_count);
        corner += shb_corner_places(g.triangle_count);
    }
}

/* Room for all clusters of the mesh; NULL: out of memory. */
static shb_clusters *reserve(const shb_context *context, const shb_mesh *mesh,
                             const cluster_room *room) {
    shb_clusters *clusters = shb_alloc(context, 1, sizeof *clusters);
    if (!clusters)
        return NULL;
    const size_t triangles = mesh->triangle_count;
    *clusters = (shb_clusters){
        .context = context,
        .vertex_count = mesh->vertex_count,
        .triangle_count = mesh->triangle_count,
        .key = shb_mesh_key(mesh),
        .count = room->count,
        .clusters = shb_alloc(context, room->count, sizeof *clusters->clusters),
        .positions = shb_alloc(context, room->places, 3 * sizeof *clusters->positions),
        .corners = shb_alloc(context, room->corners, sizeof *clusters->corners),
        .triangles = shb_alloc(context, triangles, sizeof *clusters->triangles),
    };
    if (clusters->clusters && clusters->positions && clusters->corners && clusters->triangles)
        return clusters;
    shb_clusters_destroy(clusters);
    return NULL;
}

static shb_result check(const shb_context *context, const shb_mesh *mesh,
                        shb_clusters *const *clusters) {
    const char *reason = NULL;
    if (!mesh || !clusters)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_clusters_create: %s is NULL",
                        mesh ? "clusters" : "mesh");
    const shb_result result = shb_mesh_check(mesh, &reason);
    if (result)
        return shb_fail(context, result, "shb_clusters_create: %s", reason);
    if (mesh->triangle_count > SHB_TRIANGLES_MAX)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_clusters_create: mesh.triangle_count %u exceeds %u",
                        (unsigned)mesh->triangle_count, (unsigned)SHB_TRIANGLES_MAX);
    if (!shb_mesh_has_valid_indices(mesh))
        return shb_fail(
            context, SHB_ERROR_ARGUMENT,
            "shb_clusters_create: an index of the mesh is not below its vertex_count %u",
            (unsigned)mesh->vertex_count);
    return SHB_OK;
}

shb_result shb_clusters_create(shb_context *context, const shb_mesh *mesh,
                               shb_clusters **clusters) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    const shb_result result = check(context, mesh, clusters);
    if (result)
        return result;
    uint32_t *order = shb_cluster_order(context, mesh);
    shb_clusters *made = NULL;
    if (order) {
        const cluster_room room = count_clusters(mesh, order);
        made = reserve(context, mesh, &room);
        if (made)
            fill(mesh, order, made);
        shb_free(context, order);
    }
    if (!made)
        return shb_fail(context, SHB_ERROR_MEMORY,
                        "shb_clusters_create: no memory for mesh.triangle_count %u",
                        (unsigned)mesh->triangle_count);
    *clusters = made;
    return SHB_OK;
}

void shb_clusters_destroy(shb_clusters *clusters) {
    if (!clusters)
        return;
    shb_free(clusters->context, clusters->clusters);
    shb_free(clusters->context, clusters->positions);
    shb_free(clusters->context, clusters->corners);
    shb_free(clusters->context, clusters->triangles);
    shb_free(clusters->context, clusters);
}

bool shb_clusters_fit(const shb_clusters *clusters, const shb_mesh *mesh) {
    return clusters->vertex_count == mesh->vertex_count &&
           clusters->triangle_count == mesh->triangle_count;
}
