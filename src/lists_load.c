#include "strict.h"

#include "lists_load.h"

#include <math.h>
#include <string.h>

#include "clip.h"
#include "scene.h"
#include "vector.h"

/* Vertices of a task. */
enum { VERTICES = 4096 };

static bool is_usable(double value) {
    return fabs(value) <= SHB_CLIP_MAX;
}

/* What drawing would leave out as not finite has no inverse_w. */
static shb_list_vertex project(const shb_list_frame *frame, shb_vec3 p) {
    const double w = shb_list_row(frame->rows[3], p.x, p.y, p.z);
    const double x = shb_list_row(frame->rows[0], p.x, p.y, p.z);
    const double y = shb_list_row(frame->rows[1], p.x, p.y, p.z);
    const double z = shb_list_row(frame->rows[2], p.x, p.y, p.z);
    if (!is_usable(x) || !is_usable(y) || !is_usable(z) || !is_usable(w))
        return (shb_list_vertex){.inverse_w = (double)NAN};
    if (!(z - frame->near_depth * w >= 0 && w >= SHB_W_MIN))
        return (shb_list_vertex){0};
    const double inverse = 1 / w;
    return (shb_list_vertex){x * inverse, y * inverse, z * inverse, inverse};
}

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

static void load_vertex_run(void *arg, size_t run) {
    const shb_list_loading *loading = arg;
    shb_lists *lists = loading->lists;
    size_t vertex = run * VERTICES, first;
    const size_t end =
        loading->vertex_count - vertex < VERTICES ? loading->vertex_count : vertex + VERTICES;
    size_t number = instance_of_vertex(loading->scene, vertex, &first);
    shb_list_extent extent = shb_list_extent_none();
    while (vertex < end) {
        const shb_instance *instance = &loading->scene->instances[number++];
        const shb_mat4 transform = shb_instance_transform(instance);
        const size_t after = first + vertices_of(instance->mesh);
        for (; vertex < end && vertex < after; vertex++) {
            const float *p = shb_mesh_position(instance->mesh, (uint32_t)(vertex - first));
            const shb_vec3 world = mat4_transform_point(
                &transform, (shb_vec3){(double)p[0], (double)p[1], (double)p[2]});
            double *kept = lists->vertices[vertex];
            kept[0] = world.x;
            kept[1] = world.y;
            kept[2] = world.z;
            const shb_list_vertex seen = project(&lists->frame, world);
            loading->vertices[vertex] = seen;
            if (loading->names)
                loading->names[vertex] = name_of(kept);
            if (!isnan(seen.inverse_w))
                shb_list_extent_add(&extent, kept, seen.z, seen.inverse_w > 0);
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

/* One that is not finite has no box; the plane of others is found by itself. */
static void prepare_alone(const shb_lists *lists, const shb_list_vertex *vertices, uint32_t id,
                          shb_list_box *box, shb_list_outline *outline) {
    const uint32_t *corners = lists->corners[id];
    *box = SHB_LIST_BOX_NONE;
    if (outline)
        *outline = (shb_list_outline){.is_known = 0};
    for (int k = 0; k < 3; k++)
        if (isnan(vertices[corners[k]].inverse_w))
            return;
    const shb_triangle triangle = shb_lists_triangle(lists, id);
    shb_list_triangle_cut(&lists->frame, triangle.corners, &lists->triangles[id], box);
}

/* Prepares count triangles from id on whose corners are written. */
static void prepare_lanes(const shb_list_loading *loading, uint32_t id, uint32_t count,
                          shb_list_box *boxes, shb_list_outline *outlines) {
    const shb_lists *lists = loading->lists;
    const shb_list_kernels *kernels = shb_list_kernels_of(lists->context->isa);
    const uint32_t *corners[SHB_LIST_LANES];
    shb_list_triangle made[SHB_LIST_LANES];
    shb_list_box made_boxes[SHB_LIST_LANES];
    shb_list_outline made_outlines[SHB_LIST_LANES];
    const bool whole = count == SHB_LIST_LANES;
    for (uint32_t lane = 0; lane < SHB_LIST_LANES; lane++)
        corners[lane] = lists->corners[id + (lane < count ? lane : count - 1)];
    uint32_t alone =
        kernels->prepare(&lists->frame, loading->vertices, loading->names, corners,
                         whole ? lists->triangles + id : made, whole ? boxes + id : made_boxes,
                         whole && outlines ? outlines + id : made_outlines);
    if (!whole) {
        memcpy(lists->triangles + id, made, count * sizeof *made);
        memcpy(boxes + id, made_boxes, count * sizeof *made_boxes);
        if (outlines)
            memcpy(outlines + id, made_outlines, count * sizeof *made_outlines);
        alone &= (1u << count) - 1;
    }
    for (; alone; alone &= alone - 1) {
        const uint32_t other = id + (uint32_t)__builtin_ctz(alone);
        prepare_alone(lists, loading->vertices, other, &boxes[other],
                      outlines ? &outlines[other] : NULL);
    }
}

void shb_list_load_triangles(const shb_list_loading *loading, uint32_t begin, uint32_t end,
                             shb_list_box *boxes, shb_list_outline *outlines) {
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
        prepare_lanes(loading, id, end - id < SHB_LIST_LANES ? end - id : SHB_LIST_LANES, boxes,
                      outlines);
}
