#include "strict.h"

#include "kernels/sheets.h"

#include <math.h>

#define PER_TASK 4096

typedef struct mesh_job {
    shb_light_mesh *mesh;
    shb_light_box *boxes;
    shb_walk_triangle *triangles;
    const shb_sheet_kernels *kernels;
    shb_list_extent *extents; /* of each task's vertices */
} mesh_job;

/* Of so many elements. */
static size_t tasks_of(size_t count) {
    return (count + PER_TASK - 1) / PER_TASK;
}

/* Where a task's part of them ends. */
static size_t end_of(size_t task, size_t count) {
    const size_t end = (task + 1) * PER_TASK;
    return end < count ? end : count;
}

static shb_list_vertex see_vertex(const shb_list_frame *frame, const double p[3]) {
    const double w = shb_list_row(frame->rows[3], p[0], p[1], p[2]), inverse = 1 / w;
    const shb_list_vertex seen = {shb_list_row(frame->rows[0], p[0], p[1], p[2]) * inverse,
                                  shb_list_row(frame->rows[1], p[0], p[1], p[2]) * inverse,
                                  shb_list_row(frame->rows[2], p[0], p[1], p[2]) * inverse,
                                  inverse};
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
        return (shb_list_vertex){0, 0, 0, (double)NAN};
    const bool usable = w > 0 && seen.z >= frame->near_depth && isfinite(seen.x) &&
                        isfinite(seen.y) && isfinite(seen.z);
    return usable ? seen : (shb_list_vertex){0, 0, 0, 0};
}

static void see_vertices(void *arg, size_t task) {
    const mesh_job *job = arg;
    const shb_topology *t = job->mesh->topology;
    const size_t first = task * PER_TASK, end = end_of(task, t->vertex_count);
    shb_list_extent extent = shb_list_extent_none();
    for (size_t i = first; i < end; i++) {
        const double *p = t->positions[i];
        const shb_list_vertex seen = see_vertex(&job->mesh->frame, p);
        job->mesh->vertices[i] = seen;
        if (!isnan(seen.inverse_w))
            shb_list_extent_add(&extent, p, seen.z, seen.inverse_w > 0);
    }
    job->extents[task] = extent;
}

static void see_all_vertices(const shb_context *context, mesh_job *job) {
    const size_t tasks = tasks_of(job->mesh->topology->vertex_count);
    shb_parallel_for(context, see_vertices, job, tasks);
    shb_list_frame_fit(&job->mesh->frame, tasks, job->extents);
}

void shb_light_mesh_corners(const shb_light_mesh *mesh, uint32_t id, uint32_t lane,
                            shb_list_corners *out) {
    const uint32_t *corners = mesh->topology->corners[id];
    for (int k = 0; k < 3; k++) {
        const shb_list_vertex *vertex = &mesh->vertices[corners[k]];
        out->x[k][lane] = vertex->x;
        out->y[k][lane] = vertex->y;
        out->z[k][lane] = vertex->z;
        out->inverse_w[k][lane] = vertex->inverse_w;
    }
}

/* A triangle that the kernel cannot see: one that is not finite has no box. */
static void see_alone(const shb_light_mesh *mesh, uint32_t id, shb_light_box *box) {
    const shb_topology *t = mesh->topology;
    double corners[3][3];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            corners[k][i] = t->positions[t->corners[id][k]][i];
    shb_list_triangle triangle;
    shb_list_triangle_cut(&mesh->frame, (const double(*)[3])corners, &triangle, &box->box);
    box->nearest = (float)mesh->frame.near_depth;
}

/* False: the kernel cannot see it. */
static bool is_whole(const shb_light_mesh *mesh, uint32_t id, bool *is_finite) {
    const uint32_t *corners = mesh->topology->corners[id];
    const double least = 0x1p-4 / mesh->frame.errors[3];
    bool whole = true;
    *is_finite = true;
    for (int k = 0; k < 3; k++) {
        const double inverse = mesh->vertices[corners[k]].inverse_w;
        whole &= (inverse > 0) & (inverse < least);
        *is_finite &= inverse == inverse;
    }
    return whole;
}

/* As the kernel saw it, unless it cannot. */
static void take_triangle(const mesh_job *job, uint32_t id, int8_t facing, shb_light_box box) {
    const shb_light_mesh *mesh = job->mesh;
    bool is_finite;
    if (!is_whole(mesh, id, &is_finite)) {
        facing = SHB_FACING_CUT;
        box.box = SHB_LIST_BOX_NONE;
        if (is_finite)
            see_alone(mesh, id, &box);
    }
    if (shb_topology_is_twin(mesh->topology, id))
        box.box = SHB_LIST_BOX_NONE;
    mesh->facing[id] = facing;
    if (job->boxes)
        job->boxes[id] = box;
}

static void see_triangles(void *arg, size_t task) {
    enum { LANES = SHB_LIST_LANES };
    const mesh_job *job = arg;
    const shb_light_mesh *mesh = job->mesh;
    const size_t first = task * PER_TASK, end = end_of(task, mesh->topology->triangle_count);
    shb_list_corners corners;
    shb_light_box boxes[LANES];
    int8_t facing[LANES];
    for (size_t id = first; id < end; id += LANES) {
        const uint32_t lanes = (uint32_t)(end - id < LANES ? end - id : LANES);
        for (uint32_t i = 0; i < LANES; i++)
            shb_light_mesh_corners(mesh, (uint32_t)id + (i < lanes ? i : 0), i, &corners);
        job->kernels->look(&mesh->frame, &corners, boxes, facing);
        for (uint32_t i = 0; i < lanes; i++)
            take_triangle(job, (uint32_t)id + i, facing[i], boxes[i]);
    }
}

static void make_walk_triangle(const shb_light_mesh *mesh, uint32_t id, shb_walk_triangle *to) {
    const uint32_t *corners = mesh->topology->corners[id];
    const uint32_t *neighbours = mesh->topology->neighbours[id];
    uint32_t places[3], marks = 0;
    shb_order_corners(corners, places);
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t corner = places[k], edge = places[(k + 2) % 3];
        const shb_list_vertex *vertex = &mesh->vertices[corners[k]];
        to->x[corner] = vertex->x;
        to->y[corner] = vertex->y;
        to->beyond[edge] = neighbours[k];
        if (vertex->inverse_w > 0)
            marks |= SHB_CORNER_SEEN << corner;
        if (shb_light_mesh_beyond(mesh, id, (int)k) != SHB_ID_NONE)
            marks |= SHB_EDGE_JOINED << edge;
    }
    to->marks = marks;
}

static void make_walk_triangles(void *arg, size_t task) {
    const mesh_job *job = arg;
    const size_t first = task * PER_TASK, end = end_of(task, job->mesh->topology->triangle_count);
    for (size_t id = first; id < end; id++)
        make_walk_triangle(job->mesh, (uint32_t)id, &job->triangles[id]);
}

bool shb_light_mesh_make(shb_context *context, const shb_map_info *info,
                         const shb_topology *topology, shb_walk_triangle *triangles,
                         shb_light_box *boxes, shb_light_mesh *mesh) {
    *mesh = (shb_light_mesh){.topology = topology, .triangles = triangles};
    mesh_job job = {mesh, boxes, triangles, shb_sheet_kernels_of(context->isa), NULL};
    const size_t vertices = topology->vertex_count, count = topology->triangle_count;
    shb_buffer *scratch = context->sheet_scratch;
    mesh->vertices =
        shb_buffer_reserve(context, &scratch[SHB_SHEET_VERTICES], vertices, sizeof *mesh->vertices);
    mesh->facing =
        shb_buffer_reserve(context, &scratch[SHB_SHEET_FACING], count, sizeof *mesh->facing);
    job.extents = shb_buffer_reserve(context, &scratch[SHB_SHEET_EXTENTS], tasks_of(vertices),
                                     sizeof *job.extents);
    if (!mesh->vertices || !mesh->facing || !job.extents ||
        shb_list_frame_init(&info->view, info->width, info->height, &mesh->frame) != SHB_OK)
        return false;
    see_all_vertices(context, &job);
    shb_parallel_for(context, see_triangles, &job, tasks_of(count));
    if (triangles)
        shb_parallel_for(context, make_walk_triangles, &job, tasks_of(count));
    return true;
}
