/* Edges meet in buckets, one for each vertex. They are filled in the order of triangles, so that
 * the result depends on nothing else. */
#include "strict.h"

#include "topology.h"

#include "clusters.h"
#include "hash.h"
#include "scene.h"
#include "weld.h"

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

static void *reserve(shb_context *context, size_t number, size_t count, size_t size) {
    return shb_buffer_reserve(context, &context->topology_scratch[number], count, size);
}

/* Triangles that are linked together, so that memory is waited for once. */
enum { TOGETHER = 32 };

/* An edge and the sides that have it. A side is four times a triangle plus k, for the edge from
 * corner k to the next. */
typedef struct edge_entry {
    uint32_t other;         /* vertex beside the bucket's own */
    uint32_t first, second; /* SHB_ID_NONE: no second */
} edge_entry;

/* The edges of a vertex: each edge is at the one of its vertices that has fewer sides, so that no
 * bucket grows long. */
typedef struct edge_bucket {
    uint32_t degree;        /* sides that the vertex begins */
    uint32_t begin, length; /* of its entries */
} edge_bucket;

typedef struct edge_table {
    shb_topology *topology;
    edge_bucket *buckets; /* of the vertices */
    edge_entry *entries;
} edge_table;

/* The vertex of a side's triangle so many corners beyond the side's first one. */
static uint32_t vertex_at(const shb_topology *t, uint32_t side, uint32_t step) {
    return t->corners[side >> 2][((side & 3) + step) % 3];
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
static void join_side(shb_topology *t, edge_entry *edge, uint32_t side) {
    if (edge->second != SHB_ID_NONE) {
        set_neighbour(t, edge->first, SHB_ID_NONE);
        set_neighbour(t, edge->second, SHB_ID_NONE);
        return;
    }
    const bool is_turned = vertex_at(t, edge->first, 0) == vertex_at(t, side, 0);
    edge->second = side;
    set_neighbour(t, edge->first, neighbour_at(t, side, is_turned));
    set_neighbour(t, side, neighbour_at(t, edge->first, is_turned));
}

/* The bucket that has the edge of a side; other: the edge's vertex beside the bucket's own. */
static edge_bucket *bucket_of(const edge_table *table, uint32_t side, uint32_t *other) {
    const uint32_t a = vertex_at(table->topology, side, 0);
    const uint32_t b = vertex_at(table->topology, side, 1);
    edge_bucket *at_a = &table->buckets[a], *at_b = &table->buckets[b];
    const bool takes_a = at_a->degree < at_b->degree || (at_a->degree == at_b->degree && a < b);
    *other = takes_a ? b : a;
    return takes_a ? at_a : at_b;
}

/* The edge that a bucket has with another vertex; without a side if it is new. */
static edge_entry *find_edge(const edge_table *table, edge_bucket *bucket, uint32_t other) {
    edge_entry *entry = table->entries + bucket->begin, *const end = entry + bucket->length;
    while (entry < end && entry->other != other)
        entry++;
    if (entry == end) {
        bucket->length++;
        *entry = (edge_entry){other, SHB_ID_NONE, SHB_ID_NONE};
    }
    return entry;
}

static void link_side(const edge_table *table, edge_entry *edge, uint32_t side) {
    if (edge->first == SHB_ID_NONE)
        edge->first = side;
    else
        join_side(table->topology, edge, side);
}

/* The triangles of two sides of one edge have the third vertex in common, too. */
static bool are_twins(const shb_topology *t, uint32_t a, uint32_t b) {
    return a != SHB_ID_NONE && vertex_at(t, a, 2) == vertex_at(t, b, 2);
}

static bool is_collapsed(const uint32_t corners[3]) {
    return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

/* Where to look for a triangle's sides. */
typedef struct side_places {
    edge_bucket *buckets[3];
    uint32_t others[3];
} side_places;

static void find_buckets(const edge_table *table, uint32_t triangle, side_places *places) {
    for (uint32_t k = 0; k < 3; k++) {
        places->buckets[k] = bucket_of(table, triangle << 2 | k, &places->others[k]);
        __builtin_prefetch(&table->entries[places->buckets[k]->begin]);
    }
}

/* A triangle whose corners fall together has no neighbours: it lies on an edge of others. Twins are
 * looked for among the first two that have its first edge. */
static void link_triangle(const edge_table *table, uint32_t triangle, const side_places *places) {
    shb_topology *t = table->topology;
    const uint32_t side = triangle << 2;
    if (is_collapsed(t->corners[triangle]))
        return;
    edge_entry *edge = find_edge(table, places->buckets[0], places->others[0]);
    if (are_twins(t, edge->first, side) || are_twins(t, edge->second, side)) {
        for (int k = 0; k < 3; k++)
            t->neighbours[triangle][k] = SHB_TWIN;
        return;
    }
    link_side(table, edge, side);
    for (uint32_t k = 1; k < 3; k++) {
        edge = find_edge(table, places->buckets[k], places->others[k]);
        link_side(table, edge, side | k);
    }
}

static void link_triangles(const edge_table *table) {
    const size_t count = table->topology->triangle_count;
    side_places places[TOGETHER];
    for (size_t begin = 0; begin < count; begin += TOGETHER) {
        const size_t batch = count - begin < TOGETHER ? count - begin : TOGETHER;
        for (size_t i = 0; i < batch; i++)
            find_buckets(table, (uint32_t)(begin + i), &places[i]);
        for (size_t i = 0; i < batch; i++)
            link_triangle(table, (uint32_t)(begin + i), &places[i]);
    }
}

/* Divides the entries among the buckets: as many as there may be edges. */
static void place_buckets(const edge_table *table) {
    const shb_topology *t = table->topology;
    for (size_t i = 0; i < t->triangle_count; i++)
        for (int k = 0; k < 3; k++)
            table->buckets[t->corners[i][k]].degree++;
    for (uint32_t i = 0; i < t->triangle_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t other;
            bucket_of(table, i << 2 | k, &other)->length++;
        }
    uint32_t begin = 0;
    for (size_t i = 0; i < t->vertex_count; i++) {
        edge_bucket *bucket = &table->buckets[i];
        bucket->begin = begin;
        begin += bucket->length;
        bucket->length = 0;
    }
}

/* Writes the neighbours; false: out of memory. */
static bool link_edges(shb_context *context, shb_topology *t) {
    const size_t vertices = t->vertex_count, sides = 3 * t->triangle_count;
    const edge_table table = {
        .topology = t,
        .buckets = reserve(context, SHB_TOPOLOGY_BUCKETS, vertices, sizeof *table.buckets),
        .entries = reserve(context, SHB_TOPOLOGY_ENTRIES, sides, sizeof *table.entries)};
    if (!table.buckets || !table.entries)
        return false;
    memset(table.buckets, 0, vertices * sizeof *table.buckets);
    memset(t->neighbours, 0xff, t->triangle_count * sizeof *t->neighbours);
    place_buckets(&table);
    link_triangles(&table);
    return true;
}

static bool has_corners_of(const shb_topology *t, const shb_topology *other) {
    return other->corners && t->triangle_count == other->triangle_count &&
           memcmp(t->corners, other->corners, t->triangle_count * sizeof *t->corners) == 0;
}

/* Neighbours depend on nothing but corners. */
static bool find_neighbours(shb_context *context, const shb_topology *known, shb_topology *t) {
    if (!has_corners_of(t, known))
        return link_edges(context, t);
    memcpy(t->neighbours, known->neighbours, t->triangle_count * sizeof *t->neighbours);
    return true;
}

bool shb_topology_make(shb_context *context, const shb_scene *scene, uint64_t key,
                       const shb_topology *known, shb_topology *topology) {
    const size_t count = (size_t)shb_scene_triangle_count(scene);
    *topology = (shb_topology){0};
    if (count > TRIANGLES_MAX)
        return false;
    shb_topology made = {
        .triangle_count = count,
        .corners = reserve(context, SHB_TOPOLOGY_CORNERS, count, sizeof *made.corners),
        .neighbours = reserve(context, SHB_TOPOLOGY_NEIGHBOURS, count, sizeof *made.neighbours),
        .key = key};
    if (!made.corners || !made.neighbours || !shb_weld_scene(context, scene, &made) ||
        !find_neighbours(context, known, &made))
        return false;
    shb_buffers_move(SHB_TOPOLOGY_KEPT, context->topology_scratch, made.memory);
    *topology = made;
    return true;
}

void shb_topology_recycle(shb_context *context, shb_topology *topology) {
    shb_buffers_free(context, SHB_TOPOLOGY_KEPT, context->topology_scratch);
    shb_buffers_move(SHB_TOPOLOGY_KEPT, topology->memory, context->topology_scratch);
    *topology = (shb_topology){0};
}

void shb_topology_release(const shb_context *context, shb_topology *topology) {
    shb_buffers_free(context, SHB_TOPOLOGY_KEPT, topology->memory);
    *topology = (shb_topology){0};
}

size_t shb_topology_bytes(const shb_topology *topology) {
    return shb_buffers_bytes(SHB_TOPOLOGY_KEPT, topology->memory);
}
