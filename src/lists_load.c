#include "strict.h"

#include "lists_load.h"

#include <math.h>
#include <string.h>

#include "scene.h"

/* Vertices of a task. */
enum { VERTICES = 4096 };

/* Meshes without triangles may have no vertices to read. */
static size_t vertices_of(const shb_mesh *mesh) {
    return mesh->triangle_count ? mesh->vertex_count : 0;
}

size_t shb_list_vertex_count(const shb_scene *scene) {
    size_t count = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const size_t added = vertices_of(scene->instances[i].mesh);
        count = added > SIZE_MAX - count ? SIZE_MAX : count + added;
    }
    return count;
}

/* The instance that holds a vertex of the scene, and its first one. */
static size_t instance_of_vertex(const shb_scene *scene, size_t vertex, size_t *first) {
    size_t instance = 0;
    *first = 0;
    while (vertex - *first >= vertices_of(scene->instances[instance].mesh))
        *first += vertices_of(scene->instances[instance++].mesh);
    return instance;
}

/* Sums with 0 make -0 and 0 the same. */
static uint64_t name_of(const double world[3]) {
    const double place[3] = {world[0] + 0.0, world[1] + 0.0, world[2] + 0.0};
    uint64_t bits[3], name = 0;
    memcpy(bits, place, sizeof bits);
    for (int i = 0; i < 3; i++) {
        name = (name + bits[i]) * 0x9e3779b97f4a7c15u;
        name ^= name >> 29;
    }
    return name;
}

/* Loads count vertices of an instance, at most SHB_LIST_GROUP, which become those of the scene from
 * vertex on. What drawing would leave out as not finite has no inverse_w. */
static void load_vertices(const shb_list_loading *loading, const shb_instance *instance,
                          size_t number, size_t vertex, size_t count, shb_list_extent *extent) {
    shb_lists *lists = loading->lists;
    const shb_mat4 transform = shb_instance_transform(instance);
    shb_list_places places;
    shb_list_vertex seen[SHB_LIST_GROUP];
    for (size_t i = 0; i < SHB_LIST_GROUP; i++) {
        const size_t from = number + (i < count ? i : count - 1);
        const float *p = shb_mesh_position(instance->mesh, (uint32_t)from);
        for (int k = 0; k < 3; k++)
            places.mesh[k][i] = p[k];
    }
    const bool whole = count == SHB_LIST_GROUP;
    shb_list_kernels_of(lists->context->isa)
        ->see(&lists->frame, &transform, &places, whole ? loading->vertices + vertex : seen,
              extent);
    if (!whole)
        memcpy(loading->vertices + vertex, seen, count * sizeof *seen);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            lists->vertices[vertex + i][k] = places.world[k][i];
    for (size_t i = 0; loading->names && i < count; i++)
        loading->names[vertex + i] = name_of(lists->vertices[vertex + i]);
}

static void load_vertex_run(void *arg, size_t run) {
    const shb_list_loading *loading = arg;
    size_t vertex = run * VERTICES, first;
    const size_t end =
        loading->vertex_count - vertex < VERTICES ? loading->vertex_count : vertex + VERTICES;
    size_t number = instance_of_vertex(loading->scene, vertex, &first);
    shb_list_extent extent = shb_list_extent_none();
    while (vertex < end) {
        const shb_instance *instance = &loading->scene->instances[number++];
        const size_t after = first + vertices_of(instance->mesh), last = after < end ? after : end;
        while (vertex < last) {
            const size_t left = last - vertex;
            const size_t count = left < SHB_LIST_GROUP ? left : SHB_LIST_GROUP;
            load_vertices(loading, instance, vertex - first, vertex, count, &extent);
            vertex += count;
        }
        first = after;
    }
    loading->extents[run] = extent;
}

size_t shb_list_vertex_runs(size_t vertex_count) {
    return (vertex_count + VERTICES - 1) / VERTICES;
}

void shb_list_load_vertices(const shb_list_loading *loading) {
    const size_t runs = shb_list_vertex_runs(loading->vertex_count);
    shb_parallel_for(loading->lists->context, load_vertex_run, (void *)loading, runs);
    shb_list_frame_fit(&loading->lists->frame, runs, loading->extents);
}

/* All that is known of a triangle is its box. */
static shb_list_outline outline_of_box(const shb_list_box *box) {
    const float left = (float)box->first_column + 0.5f, right = (float)box->last_column + 0.5f;
    const float top = (float)box->first_row + 0.5f, bottom = (float)box->last_row + 0.5f;
    return (shb_list_outline){.x = {left, right, right}, .y = {top, bottom, bottom}};
}

/* One that is not finite has no box; the plane of others is found by itself. */
static void prepare_alone(const shb_lists *lists, const shb_list_vertex *vertices, uint32_t id,
                          const shb_list_shapes *shapes) {
    const uint32_t *corners = lists->corners[id];
    shb_list_box *box = &shapes->boxes[id];
    *box = SHB_LIST_BOX_NONE;
    for (int k = 0; k < 3; k++)
        if (isnan(vertices[corners[k]].inverse_w))
            return;
    const shb_triangle triangle = shb_lists_triangle(lists, id);
    shapes->levels[id] =
        shb_list_triangle_cut(&lists->frame, triangle.corners, &lists->triangles[id], box);
    if (shapes->outlines)
        shapes->outlines[id] = outline_of_box(box);
}

/* Prepares count triangles from id on whose corners are written. */
static void prepare_lanes(const shb_list_loading *loading, uint32_t id, uint32_t count,
                          const shb_list_shapes *shapes) {
    const shb_lists *lists = loading->lists;
    const shb_list_kernels *kernels = shb_list_kernels_of(lists->context->isa);
    const uint32_t *corners[SHB_LIST_LANES];
    shb_list_triangle made[SHB_LIST_LANES];
    shb_list_box boxes[SHB_LIST_LANES];
    uint16_t levels[SHB_LIST_LANES];
    shb_list_outline outlines[SHB_LIST_LANES];
    const bool whole = count == SHB_LIST_LANES;
    for (uint32_t lane = 0; lane < SHB_LIST_LANES; lane++)
        corners[lane] = lists->corners[id + (lane < count ? lane : count - 1)];
    uint32_t alone =
        kernels->prepare(&lists->frame, loading->vertices, loading->names, corners,
                         whole ? lists->triangles + id : made, whole ? shapes->boxes + id : boxes,
                         whole ? shapes->levels + id : levels,
                         whole && shapes->outlines ? shapes->outlines + id : outlines);
    if (!whole) {
        memcpy(lists->triangles + id, made, count * sizeof *made);
        memcpy(shapes->boxes + id, boxes, count * sizeof *boxes);
        memcpy(shapes->levels + id, levels, count * sizeof *levels);
        if (shapes->outlines)
            memcpy(shapes->outlines + id, outlines, count * sizeof *outlines);
        alone &= (1u << count) - 1;
    }
    for (; alone; alone &= alone - 1)
        prepare_alone(lists, loading->vertices, id + (uint32_t)__builtin_ctz(alone), shapes);
}

void shb_list_load_triangles(const shb_list_loading *loading, uint32_t begin, uint32_t end,
                             const shb_list_shapes *shapes) {
    const shb_scene *scene = loading->scene;
    uint32_t id = begin, first = 0;
    size_t number = 0, first_vertex = 0;
    while (id < end) {
        const shb_mesh *mesh = scene->instances[number++].mesh;
        const uint32_t after = first + mesh->triangle_count;
        for (; id < end && id < after; id++) {
            uint32_t *corners = loading->lists->corners[id];
            shb_mesh_triangle(mesh, id - first, corners);
            for (int k = 0; k < 3; k++)
                corners[k] += (uint32_t)first_vertex;
        }
        first = after;
        first_vertex += vertices_of(mesh);
    }
    for (id = begin; id < end; id += SHB_LIST_LANES)
        prepare_lanes(loading, id, end - id < SHB_LIST_LANES ? end - id : SHB_LIST_LANES, shapes);
}
