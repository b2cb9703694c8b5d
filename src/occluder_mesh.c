/* Vertices are welded where their world positions are equal, by a hash table over all corners;
 * edges meet by a second one over pairs of welded vertices. Both are filled in the order of
 * triangles, so that the result depends on nothing else. */
#include "strict.h"

#include "occluder_mesh.h"

#include "light_point.h"
#include "scene.h"

#include <string.h>

#define TRIANGLES_MAX ((size_t)1 << 30)

/* A place of the table for up to count entries that is free for less than half of them. */
static size_t table_size(size_t count) {
    size_t size = 16;
    while (size < 2 * count)
        size *= 2;
    return size;
}

/* The finalizer of splitmix64 (Steele, Lea and Flood 2014). */
static uint64_t mix(uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    return bits ^ (bits >> 31);
}

static uint64_t bits_of(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

typedef struct weld_table {
    size_t mask;
    uint32_t *vertices;     /* SHB_ID_NONE: free */
    double (*positions)[3]; /* of the vertices, world */
    uint32_t count;
} weld_table;

/* Adding 0 turns -0 to 0. */
static uint32_t weld(weld_table *table, shb_vec3 point) {
    const double p[3] = {point.x + 0.0, point.y + 0.0, point.z + 0.0};
    size_t slot = mix(mix(mix(bits_of(p[0])) ^ bits_of(p[1])) ^ bits_of(p[2])) & table->mask;
    for (; table->vertices[slot] != SHB_ID_NONE; slot = (slot + 1) & table->mask) {
        const double *other = table->positions[table->vertices[slot]];
        if (memcmp(other, p, sizeof p) == 0)
            return table->vertices[slot];
    }
    table->vertices[slot] = table->count;
    memcpy(table->positions[table->count], p, sizeof p);
    return table->count++;
}

static void weld_instance(weld_table *table, const shb_instance *instance, uint32_t (*corners)[3]) {
    const shb_mesh *mesh = instance->mesh;
    const shb_mat4 transform = shb_instance_transform(instance);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t vertices[3];
        shb_mesh_triangle(mesh, t, vertices);
        for (int k = 0; k < 3; k++) {
            const float *p = shb_mesh_position(mesh, vertices[k]);
            const shb_vec3 local = {(double)p[0], (double)p[1], (double)p[2]};
            corners[t][k] = weld(table, shb_mat4_transform_point(transform, local));
        }
    }
}

/* Vertices behind the light have no place: NaN, which no comparison lets through. */
static void place_vertices(const shb_map *map, const weld_table *table, double (*places)[2]) {
    for (uint32_t i = 0; i < table->count; i++) {
        const shb_light_point point = shb_light_point_at(&map->rows, table->positions[i], 0);
        places[i][0] = point.w > 0 ? point.x : (double)NAN;
        places[i][1] = point.w > 0 ? point.y : (double)NAN;
    }
}

static bool weld_scene(const shb_map *map, const shb_scene *scene, size_t count,
                       shb_occluder_mesh *mesh) {
    const shb_context *context = map->context;
    const size_t size = table_size(3 * count);
    weld_table table = {.mask = size - 1,
                        .vertices = shb_alloc(context, size, sizeof *table.vertices),
                        .positions = shb_alloc(context, 3 * count, sizeof *table.positions)};
    bool done = table.vertices && table.positions;
    if (done) {
        memset(table.vertices, 0xff, size * sizeof *table.vertices);
        uint32_t(*corners)[3] = mesh->corners;
        for (size_t i = 0; i < scene->instance_count; i++) {
            weld_instance(&table, &scene->instances[i], corners);
            corners += scene->instances[i].mesh->triangle_count;
        }
        mesh->place_count = table.count;
        mesh->places = shb_alloc(context, table.count, sizeof *mesh->places);
        done = mesh->places != NULL;
    }
    if (done)
        place_vertices(map, &table, mesh->places);
    shb_free(context, table.vertices);
    shb_free(context, table.positions);
    return done;
}

/* An edge of the table: its vertices, and the sides that have it, a side being 3 * triangle + k for
 * the edge from corner k to the next. */
typedef struct edge_entry {
    uint32_t lo, hi;
    uint32_t first, second; /* SHB_ID_NONE: no such side */
} edge_entry;

static void set_neighbour(shb_occluder_mesh *mesh, uint32_t side, uint32_t neighbour) {
    mesh->neighbours[side / 3][side % 3] = neighbour;
}

/* Two sides make neighbours; a third one undoes them, so that walks end there. */
static void add_side(edge_entry *edge, uint32_t side, shb_occluder_mesh *mesh) {
    if (edge->second != SHB_ID_NONE) {
        set_neighbour(mesh, edge->first, SHB_ID_NONE);
        set_neighbour(mesh, edge->second, SHB_ID_NONE);
        return;
    }
    edge->second = side;
    set_neighbour(mesh, edge->first, side / 3);
    set_neighbour(mesh, side, edge->first / 3);
}

static void link_side(edge_entry *table, size_t mask, uint32_t side, shb_occluder_mesh *mesh) {
    const uint32_t a = mesh->corners[side / 3][side % 3];
    const uint32_t b = mesh->corners[side / 3][(side + 1 - (side % 3 == 2 ? 3 : 0)) % 3];
    const uint32_t lo = a < b ? a : b, hi = a < b ? b : a;
    if (lo == hi)
        return;
    size_t slot = mix((uint64_t)hi << 32 | lo) & mask;
    for (; table[slot].first != SHB_ID_NONE; slot = (slot + 1) & mask)
        if (table[slot].lo == lo && table[slot].hi == hi) {
            add_side(&table[slot], side, mesh);
            return;
        }
    table[slot] = (edge_entry){lo, hi, side, SHB_ID_NONE};
}

static bool link_edges(const shb_context *context, size_t count, shb_occluder_mesh *mesh) {
    const size_t size = table_size(3 * count);
    edge_entry *table = shb_alloc(context, size, sizeof *table);
    if (!table)
        return false;
    memset(table, 0xff, size * sizeof *table);
    memset(mesh->neighbours, 0xff, count * sizeof *mesh->neighbours);
    for (size_t side = 0; side < 3 * count; side++)
        link_side(table, size - 1, (uint32_t)side, mesh);
    shb_free(context, table);
    return true;
}

bool shb_occluder_mesh_make(const shb_map *map, const shb_scene *scene, size_t count,
                            shb_occluder_mesh *mesh) {
    const shb_context *context = map->context;
    *mesh = (shb_occluder_mesh){0};
    if (count > TRIANGLES_MAX)
        return false;
    mesh->corners = shb_alloc(context, count, sizeof *mesh->corners);
    mesh->neighbours = shb_alloc(context, count, sizeof *mesh->neighbours);
    return mesh->corners && mesh->neighbours && weld_scene(map, scene, count, mesh) &&
           link_edges(context, count, mesh);
}

void shb_occluder_mesh_release(const shb_context *context, shb_occluder_mesh *mesh) {
    shb_free(context, mesh->corners);
    shb_free(context, mesh->neighbours);
    shb_free(context, mesh->places);
    *mesh = (shb_occluder_mesh){0};
}
