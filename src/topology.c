/* Vertices are welded by a hash table over those of the meshes; edges meet in buckets, one for each
 * vertex. Both are filled in the order of triangles, so that the result depends on nothing else. */
#include "strict.h"

#include "topology.h"

#include "clusters.h"
#include "hash.h"
#include "scene.h"

#include <string.h>

#define TRIANGLES_MAX (((size_t)1 << 29) - 1)

/* Four sums in turn, so that the multiplications need not wait for each other. */
typedef struct key_sums {
    uint64_t sums[4];
} key_sums;

/* The factor spreads the last word, for it is the next first one that it must not undo. */
static void add_words(key_sums *key, size_t number, const uint32_t words[3]) {
    uint64_t *sum = &key->sums[number % 4];
    *sum = shb_mix((*sum ^ words[0]) + ((uint64_t)words[1] << 32)) + words[2] * 0x9e3779b97f4a7c15u;
}

static uint64_t key_of(const key_sums *key) {
    return shb_mix(shb_mix(shb_mix(shb_mix(key->sums[0]) ^ key->sums[1]) ^ key->sums[2]) ^
                   key->sums[3]);
}

uint64_t shb_mesh_key(const shb_mesh *mesh) {
    key_sums key = {{1, 2, 3, 4}};
    const uint32_t counts[3] = {mesh->vertex_count, mesh->triangle_count, 0};
    uint32_t words[3];
    add_words(&key, 0, counts);
    /* a mesh without triangles may have no vertices to read */
    for (uint32_t i = 0; mesh->triangle_count && i < mesh->vertex_count; i++) {
        memcpy(words, shb_mesh_position(mesh, i), sizeof words);
        add_words(&key, i, words);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        shb_mesh_triangle(mesh, t, words);
        add_words(&key, t, words);
    }
    return key_of(&key);
}

uint64_t shb_topology_key(const shb_scene *scene) {
    key_sums key = {{1, 2, 3, 4}};
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_mat4 transform = shb_instance_transform(&scene->instances[i]);
        const shb_mesh *mesh = scene->instances[i].mesh;
        const uint64_t mesh_key = mesh->clusters ? mesh->clusters->key : shb_mesh_key(mesh);
        uint32_t words[36] = {(uint32_t)mesh_key, (uint32_t)(mesh_key >> 32), mesh->triangle_count};
        memcpy(words + 4, transform.m, sizeof transform.m);
        for (size_t k = 0; k < 36; k += 3)
            add_words(&key, k, words + k);
    }
    return key_of(&key);
}

/* Slots of a hash table of count entries: a power of two, of which at least half stay free. */
static size_t table_size(size_t count) {
    size_t size = 16;
    while (size < 2 * count)
        size *= 2;
    return size;
}

typedef struct weld_table {
    size_t mask;
    uint32_t *slots;  /* SHB_ID_NONE: free */
    uint32_t *welded; /* of a mesh's vertices; SHB_ID_NONE: not yet */
    shb_topology *topology;
} weld_table;

/* Adding 0 turns -0 to 0. */
static uint32_t weld(weld_table *table, shb_vec3 point) {
    shb_topology *t = table->topology;
    const double p[3] = {point.x + 0.0, point.y + 0.0, point.z + 0.0};
    size_t slot = shb_position_key(p) & table->mask;
    for (; table->slots[slot] != SHB_ID_NONE; slot = (slot + 1) & table->mask)
        if (memcmp(t->positions[table->slots[slot]], p, sizeof p) == 0)
            return table->slots[slot];
    table->slots[slot] = (uint32_t)t->vertex_count;
    memcpy(t->positions[t->vertex_count], p, sizeof p);
    return (uint32_t)t->vertex_count++;
}

static void weld_instance(weld_table *table, const shb_instance *instance, uint32_t (*corners)[3]) {
    const shb_mesh *mesh = instance->mesh;
    const shb_mat4 transform = shb_instance_transform(instance);
    if (mesh->triangle_count == 0)
        return;
    memset(table->welded, 0xff, mesh->vertex_count * sizeof *table->welded);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t vertices[3];
        shb_mesh_triangle(mesh, t, vertices);
        for (int k = 0; k < 3; k++) {
            uint32_t *welded = &table->welded[vertices[k]];
            if (*welded == SHB_ID_NONE) {
                const shb_vec3 point = shb_mesh_point(mesh, vertices[k]);
                *welded = weld(table, mat4_transform_point(&transform, point));
            }
            corners[t][k] = *welded;
        }
    }
}

/* The most vertices that can be left, and the most of one instance. */
static size_t count_vertices(const shb_scene *scene, size_t *largest) {
    size_t all = 0;
    *largest = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const shb_mesh *mesh = scene->instances[i].mesh;
        const size_t corners = 3 * (size_t)mesh->triangle_count;
        all += corners < mesh->vertex_count ? corners : mesh->vertex_count;
        if (corners && mesh->vertex_count > *largest)
            *largest = mesh->vertex_count;
    }
    return all;
}

/* Gives back what welded vertices took; false: out of memory. */
static bool fit_positions(const shb_context *context, shb_topology *t) {
    double(*const kept)[3] = shb_alloc(context, t->vertex_count + 1, sizeof *kept);
    if (!kept)
        return false;
    memcpy(kept, t->positions, t->vertex_count * sizeof *kept);
    shb_free(context, t->positions);
    t->positions = kept;
    return true;
}

static bool weld_scene(const shb_context *context, const shb_scene *scene, shb_topology *t) {
    size_t largest;
    const size_t vertices = count_vertices(scene, &largest), size = table_size(vertices);
    weld_table table = {.mask = size - 1,
                        .slots = shb_alloc(context, size, sizeof *table.slots),
                        .welded = shb_alloc(context, largest, sizeof *table.welded),
                        .topology = t};
    t->positions = shb_alloc(context, vertices + 1, sizeof *t->positions);
    bool done = table.slots && table.welded && t->positions;
    if (done) {
        memset(table.slots, 0xff, size * sizeof *table.slots);
        uint32_t(*corners)[3] = t->corners;
        for (size_t i = 0; i < scene->instance_count; i++) {
            weld_instance(&table, &scene->instances[i], corners);
            corners += scene->instances[i].mesh->triangle_count;
        }
    }
    shb_free(context, table.slots);
    shb_free(context, table.welded);
    if (done && t->vertex_count < vertices)
        done = fit_positions(context, t);
    return done;
}

/* An edge and the sides that have it. A side is four times a triangle plus k, for the edge from
 * corner k to the next. */
typedef struct edge_entry {
    uint32_t other;         /* vertex beside the bucket's own */
    uint32_t first, second; /* SHB_ID_NONE: no second */
} edge_entry;

/* Edges by the one of their vertices that has fewer sides, so that no bucket grows long. */
typedef struct edge_buckets {
    uint32_t *degrees; /* sides of each vertex */
    uint32_t *lengths; /* entries of each bucket */
    size_t *begins;    /* of the buckets */
    edge_entry *entries;
} edge_buckets;

static uint32_t first_vertex(const shb_topology *t, uint32_t side) {
    return t->corners[side >> 2][side & 3];
}

static uint32_t second_vertex(const shb_topology *t, uint32_t side) {
    return t->corners[side >> 2][((side & 3) + 1) % 3];
}

static void set_neighbour(shb_topology *t, uint32_t side, uint32_t neighbour) {
    t->neighbours[side >> 2][side & 3] = neighbour;
}

/* The neighbour that has a side, as seen from the other one of its edge. */
static uint32_t neighbour_at(const shb_topology *t, uint32_t side, bool is_turned) {
    uint32_t places[3];
    shb_order_corners(t->corners[side >> 2], places);
    return side >> 2 << 3 | (uint32_t)is_turned << 2 | places[((side & 3) + 2) % 3];
}

/* Two sides make neighbours; a third one undoes them, so that the mesh ends there. */
static void add_side(shb_topology *t, edge_entry *edge, uint32_t side) {
    if (edge->second != SHB_ID_NONE) {
        set_neighbour(t, edge->first, SHB_ID_NONE);
        set_neighbour(t, edge->second, SHB_ID_NONE);
        return;
    }
    const bool is_turned = first_vertex(t, edge->first) == first_vertex(t, side);
    edge->second = side;
    set_neighbour(t, edge->first, neighbour_at(t, side, is_turned));
    set_neighbour(t, side, neighbour_at(t, edge->first, is_turned));
}

/* The vertex whose bucket has the edge of a side, and the other one. */
static uint32_t bucket_of(const edge_buckets *buckets, const shb_topology *t, uint32_t side,
                          uint32_t *other) {
    const uint32_t a = first_vertex(t, side), b = second_vertex(t, side);
    const uint32_t at_a = buckets->degrees[a], at_b = buckets->degrees[b];
    const bool takes_a = at_a < at_b || (at_a == at_b && a < b);
    *other = takes_a ? b : a;
    return takes_a ? a : b;
}

static bool has_vertex(const uint32_t corners[3], uint32_t vertex) {
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
}

static bool are_twins(const shb_topology *t, uint32_t a, uint32_t b) {
    const uint32_t *x = t->corners[a], *y = t->corners[b];
    return has_vertex(y, x[0]) && has_vertex(y, x[1]) && has_vertex(y, x[2]) &&
           has_vertex(x, y[0]) && has_vertex(x, y[1]) && has_vertex(x, y[2]);
}

/* Among the first two that have its first edge. */
static bool is_twin(const edge_buckets *buckets, const shb_topology *t, uint32_t triangle) {
    uint32_t other;
    const uint32_t vertex = bucket_of(buckets, t, triangle << 2, &other);
    const edge_entry *entries = buckets->entries + buckets->begins[vertex];
    for (uint32_t i = 0; i < buckets->lengths[vertex]; i++)
        if (entries[i].other == other)
            return are_twins(t, entries[i].first >> 2, triangle) ||
                   (entries[i].second != SHB_ID_NONE &&
                    are_twins(t, entries[i].second >> 2, triangle));
    return false;
}

static void link_side(edge_buckets *buckets, shb_topology *t, uint32_t side) {
    uint32_t other;
    const uint32_t vertex = bucket_of(buckets, t, side, &other);
    edge_entry *entries = buckets->entries + buckets->begins[vertex];
    const uint32_t length = buckets->lengths[vertex];
    for (uint32_t i = 0; i < length; i++)
        if (entries[i].other == other) {
            add_side(t, &entries[i], side);
            return;
        }
    entries[length] = (edge_entry){other, side, SHB_ID_NONE};
    buckets->lengths[vertex]++;
}

static bool is_collapsed(const uint32_t corners[3]) {
    return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

/* A triangle whose corners fall together has no neighbours: it lies on an edge of others. */
static void link_triangle(edge_buckets *buckets, shb_topology *t, uint32_t triangle) {
    if (is_collapsed(t->corners[triangle]))
        return;
    const bool twin = is_twin(buckets, t, triangle);
    for (uint32_t k = 0; k < 3; k++)
        if (twin)
            t->neighbours[triangle][k] = SHB_TWIN;
        else
            link_side(buckets, t, triangle << 2 | k);
}

static void count_sides(edge_buckets *buckets, const shb_topology *t) {
    for (size_t i = 0; i < t->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            buckets->degrees[t->corners[i][k]]++;
    for (uint32_t i = 0; i < t->triangle_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t other;
            buckets->lengths[bucket_of(buckets, t, i << 2 | k, &other)]++;
        }
    size_t begin = 0;
    for (size_t i = 0; i < t->vertex_count; i++) {
        buckets->begins[i] = begin;
        begin += buckets->lengths[i];
        buckets->lengths[i] = 0;
    }
}

static bool link_edges(const shb_context *context, shb_topology *t) {
    const size_t vertices = t->vertex_count, sides = 3 * t->triangle_count;
    edge_buckets buckets = {shb_alloc(context, vertices, sizeof *buckets.degrees),
                            shb_alloc(context, vertices, sizeof *buckets.lengths),
                            shb_alloc(context, vertices, sizeof *buckets.begins),
                            shb_alloc(context, sides, sizeof *buckets.entries)};
    const bool done = buckets.degrees && buckets.lengths && buckets.begins && buckets.entries;
    if (done) {
        memset(buckets.degrees, 0, vertices * sizeof *buckets.degrees);
        memset(buckets.lengths, 0, vertices * sizeof *buckets.lengths);
        memset(t->neighbours, 0xff, t->triangle_count * sizeof *t->neighbours);
        count_sides(&buckets, t);
        for (uint32_t i = 0; i < t->triangle_count; i++)
            link_triangle(&buckets, t, i);
    }
    shb_free(context, buckets.degrees);
    shb_free(context, buckets.lengths);
    shb_free(context, buckets.begins);
    shb_free(context, buckets.entries);
    return done;
}

bool shb_topology_make(const shb_context *context, const shb_scene *scene, uint64_t key,
                       shb_topology *topology) {
    const size_t count = (size_t)shb_scene_triangle_count(scene);
    *topology = (shb_topology){0};
    if (count > TRIANGLES_MAX)
        return false;
    topology->key = key;
    topology->triangle_count = count;
    topology->corners = shb_alloc(context, count, sizeof *topology->corners);
    topology->neighbours = shb_alloc(context, count, sizeof *topology->neighbours);
    if (topology->corners && topology->neighbours && weld_scene(context, scene, topology) &&
        link_edges(context, topology))
        return true;
    shb_topology_release(context, topology);
    return false;
}

void shb_topology_release(const shb_context *context, shb_topology *topology) {
    shb_free(context, topology->corners);
    shb_free(context, topology->neighbours);
    shb_free(context, topology->positions);
    *topology = (shb_topology){0};
}

size_t shb_topology_bytes(const shb_topology *t) {
    return t->triangle_count * (sizeof *t->corners + sizeof *t->neighbours) +
           t->vertex_count * sizeof *t->positions;
}
