/* By a hash table, which is filled in the order of triangles, so that the result depends on nothing
 * else. */
#include "strict.h"

#include "weld.h"

#include "hash.h"
#include "scene.h"

#include <string.h>

/* Slots of a hash table of count entries: a power of two, of which at least half stay free. */
static size_t table_size(size_t count) {
    size_t size = 16;
    while (size < 2 * count)
        size *= 2;
    return size;
}

typedef struct weld_table {
    size_t mask;
    uint32_t *slots;        /* SHB_ID_NONE: free */
    uint32_t *welded;       /* of a mesh's vertices; SHB_ID_NONE: not yet */
    double (*positions)[3]; /* of those that are left */
    uint32_t count;         /* of these */
} weld_table;

/* Triangles whose vertices are welded together, so that the table's memory is waited for once. */
enum { TOGETHER = 32 };

typedef struct weld_batch {
    size_t count;
    uint32_t vertices[3 * TOGETHER]; /* of the mesh */
    double points[3 * TOGETHER][3];  /* world */
    size_t slots[3 * TOGETHER];      /* where to look for them first */
} weld_batch;

/* Vertices of the mesh's triangles that are new, in the order of their first use. */
static void find_new_vertices(const weld_table *table, const shb_mesh *mesh, uint32_t begin,
                              uint32_t end, weld_batch *batch) {
    batch->count = 0;
    for (uint32_t t = begin; t < end; t++) {
        uint32_t vertices[3];
        shb_mesh_triangle(mesh, t, vertices);
        for (int k = 0; k < 3; k++)
            if (table->welded[vertices[k]] == SHB_ID_NONE) {
                table->welded[vertices[k]] = 0; /* until the batch is welded */
                batch->vertices[batch->count++] = vertices[k];
            }
    }
}

/* Adding 0 turns -0 to 0. */
static void place_vertices(const weld_table *table, const shb_mesh *mesh, const shb_mat4 *transform,
                           weld_batch *batch) {
    for (size_t i = 0; i < batch->count; i++) {
        const shb_vec3 point =
            mat4_transform_point(transform, shb_mesh_point(mesh, batch->vertices[i]));
        double *p = batch->points[i];
        p[0] = point.x + 0.0;
        p[1] = point.y + 0.0;
        p[2] = point.z + 0.0;
        batch->slots[i] = shb_position_key(p) & table->mask;
        __builtin_prefetch(&table->slots[batch->slots[i]]);
    }
}

static uint32_t weld(weld_table *table, const double point[3], size_t slot) {
    const size_t size = sizeof table->positions[0];
    for (; table->slots[slot] != SHB_ID_NONE; slot = (slot + 1) & table->mask)
        if (memcmp(table->positions[table->slots[slot]], point, size) == 0)
            return table->slots[slot];
    table->slots[slot] = table->count;
    memcpy(table->positions[table->count], point, size);
    return table->count++;
}

static void weld_instance(weld_table *table, const shb_instance *instance, uint32_t (*corners)[3]) {
    const shb_mesh *mesh = instance->mesh;
    const shb_mat4 transform = shb_instance_transform(instance);
    weld_batch batch;
    if (mesh->triangle_count == 0)
        return;
    memset(table->welded, 0xff, mesh->vertex_count * sizeof *table->welded);
    for (uint32_t begin = 0, end; begin < mesh->triangle_count; begin = end) {
        end = mesh->triangle_count - begin < TOGETHER ? mesh->triangle_count : begin + TOGETHER;
        find_new_vertices(table, mesh, begin, end, &batch);
        place_vertices(table, mesh, &transform, &batch);
        for (size_t i = 0; i < batch.count; i++)
            table->welded[batch.vertices[i]] = weld(table, batch.points[i], batch.slots[i]);
        for (uint32_t t = begin; t < end; t++) {
            shb_mesh_triangle(mesh, t, corners[t]);
            for (int k = 0; k < 3; k++)
                corners[t][k] = table->welded[corners[t][k]];
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

bool shb_weld_scene(shb_context *context, const shb_scene *scene, shb_topology *t) {
    size_t largest;
    const size_t vertices = count_vertices(scene, &largest), size = table_size(vertices);
    shb_buffer *scratch = context->topology_scratch;
    weld_table table = {.mask = size - 1,
                        .slots = shb_buffer_reserve(context, &scratch[SHB_TOPOLOGY_SLOTS], size,
                                                    sizeof *table.slots),
                        .welded = shb_buffer_reserve(context, &scratch[SHB_TOPOLOGY_WELDED],
                                                     largest, sizeof *table.welded),
                        .positions = shb_buffer_reserve(context, &scratch[SHB_TOPOLOGY_WORLD],
                                                        vertices, sizeof *table.positions)};
    if (!table.slots || !table.welded || !table.positions)
        return false;
    memset(table.slots, 0xff, size * sizeof *table.slots);
    uint32_t(*corners)[3] = t->corners;
    for (size_t i = 0; i < scene->instance_count; i++) {
        weld_instance(&table, &scene->instances[i], corners);
        corners += scene->instances[i].mesh->triangle_count;
    }
    t->vertex_count = table.count;
    /* Vectors read four numbers of a position. */
    t->positions = shb_buffer_reserve(context, &scratch[SHB_TOPOLOGY_POSITIONS],
                                      (size_t)table.count + 1, sizeof *t->positions);
    if (t->positions)
        memcpy(t->positions, table.positions, table.count * sizeof *t->positions);
    return t->positions != NULL;
}
