#include "strict.h"

#include "fragments.h"

#include "scene.h"
#include "vector.h"

#include <string.h>

static void clear_table(shb_surface_table *table) {
    table->count = 0;
    table->lacks = false;
}

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, const shb_surface_view *view, uint32_t left) {
    reader->kernels = kernels;
    reader->frame = frame;
    reader->view = *view;
    reader->instance_count = 0;
    reader->next_instance = 0;
    reader->instance = NULL;
    memset(reader->table.places, 0, sizeof reader->table.places);
    clear_table(&reader->table);
    reader->left = left;
    for (uint32_t i = 0; i < SHB_SPAN; i++)
        reader->centers[i] = (2.0 * (left + i) + 1.0 - frame->width) / frame->width;
    memset(reader->centers + SHB_SPAN, 0, SHB_TABLE_MARGIN * sizeof *reader->centers);
}

static bool holds(const shb_surface_instance *instance, uint32_t id) {
    return id - instance->first_id < instance->mesh->triangle_count;
}

/* NULL when the scene has no such triangle. */
static const shb_surface_instance *find_instance(shb_fragment_reader *reader, uint32_t id) {
    for (size_t i = 0; i < reader->instance_count; i++)
        if (holds(&reader->instances[i], id))
            return &reader->instances[i];
    shb_surface_instance *found = &reader->instances[reader->next_instance];
    if (!shb_surface_find_instance(reader->frame->scene, id, found))
        return NULL;
    reader->next_instance = (reader->next_instance + 1) % SHB_FRAGMENT_INSTANCES;
    if (reader->instance_count < SHB_FRAGMENT_INSTANCES)
        reader->instance_count++;
    return found;
}

/* A triangle without area that snapping has made visible counts as facing the camera. */
static shb_vec3 normal_to_eye(const shb_surface_triangle *surface, const shb_light_source *eye) {
    if (shb_surface_faces(surface, eye))
        return surface->normal;
    if (vec3_dot(surface->normal, surface->normal) > 0)
        return vec3_scale(surface->normal, -1);
    const shb_vec3 corner = vec3_scale(surface->corners[0], eye->w);
    return shb_vec3_normalize(vec3_subtract(eye->position, corner));
}

bool shb_fragment_triangle(shb_fragment_reader *reader, uint32_t id,
                           shb_surface_triangle *triangle) {
    const shb_surface_instance *instance = find_instance(reader, id);
    if (!instance || !shb_surface_prepare_of(instance, reader->frame->view, id, triangle))
        return false;
    triangle->normal = normal_to_eye(triangle, &reader->view.eye);
    return true;
}

static void write_vector(double *to, shb_vec3 v) {
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

/* A triangle that the kernels leave alone. */
static void prepare_alone(shb_fragment_reader *reader, uint32_t place) {
    shb_prepared_triangle *to = &reader->table.triangles[place];
    shb_surface_triangle triangle;
    if (!shb_fragment_triangle(reader, reader->table.ids[place], &triangle)) {
        reader->table.lacks = true;
        return;
    }
    to->facing = SHB_SURFACE_USABLE | (to->facing & SHB_SURFACE_SMOOTH);
    for (size_t k = 0; k < reader->view.light_count; k++)
        to->facing |= (uint32_t)shb_surface_faces(&triangle, &reader->view.lights[k]) << k;
    double *corners = to->place + SHB_PLACE_CORNERS, *shading = to->shading + SHB_SHADING_CORNERS;
    write_vector(to->shading, triangle.normal);
    for (int k = 0; k < 3; k++)
        to->normal[k] = (float)to->shading[k];
    for (int k = 0; k < 3; k++)
        write_vector(to->place + 3 * k, triangle.cofactors[k]);
    write_vector(corners, triangle.corners[0]);
    write_vector(shading, triangle.shading[0]);
    for (int k = 1; k < 3; k++) {
        write_vector(corners + 3 * k, vec3_subtract(triangle.corners[k], triangle.corners[0]));
        write_vector(shading + 3 * k, vec3_subtract(triangle.shading[k], triangle.shading[0]));
    }
}

static inline void read_triple(float (*to)[SHB_SPAN + SHB_TABLE_MARGIN], size_t i,
                               const float *from) {
    to[0][i] = from[0];
    to[1][i] = from[1];
    to[2][i] = from[2];
}

/* The vertices of triangles; what these hold is asked for before any of it is read, as neighbours
 * on the screen may lie anywhere in memory. */
static void read_vertices(const shb_surface_instance *instance, size_t count, const uint32_t *ids,
                          uint32_t (*vertices)[3]) {
    const shb_mesh mesh = *instance->mesh;
    const uint32_t first_id = instance->first_id;
    const size_t size = 3 * (mesh.index_size == 2 ? 2 : 4);
    for (size_t i = 0; mesh.indices && i < count; i++)
        __builtin_prefetch((const char *)mesh.indices + size * (ids[i] - first_id));
    for (size_t i = 0; i < count; i++) {
        shb_mesh_triangle(&mesh, ids[i] - first_id, vertices[i]);
        for (int k = 0; k < 3; k++) {
            if (vertices[i][k] >= mesh.vertex_count)
                continue;
            __builtin_prefetch(shb_mesh_position(&mesh, vertices[i][k]));
            if (mesh.normals)
                __builtin_prefetch(shb_mesh_normal(&mesh, vertices[i][k]));
        }
    }
}

/* Corners whose index is out of range become NaN, so that the triangle is left out. */
static void read_corners(const shb_surface_instance *instance, size_t count, const uint32_t *ids,
                         shb_surface_corners *corners) {
    static const float none[3] = {NAN, NAN, NAN};
    const shb_mesh mesh = *instance->mesh;
    uint32_t vertices[SHB_SPAN][3];
    read_vertices(instance, count, ids, vertices);
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            const uint32_t vertex = vertices[i][k];
            const bool exists = vertex < mesh.vertex_count;
            read_triple(corners->positions + 3 * k, i,
                        exists ? shb_mesh_position(&mesh, vertex) : none);
            if (mesh.normals)
                read_triple(corners->normals + 3 * k, i,
                            exists ? shb_mesh_normal(&mesh, vertex) : none);
        }
}

/* Prepares the triangles up to place end that are not yet, all of one instance. */
static void prepare(shb_fragment_reader *reader, const shb_surface_instance *instance,
                    uint32_t end) {
    shb_surface_table *table = &reader->table;
    const uint32_t first = table->count;
    if (first == end)
        return;
    shb_surface_corners corners;
    read_corners(instance, end - first, table->ids + first, &corners);
    reader->kernels->triangles(&reader->view, instance, end - first, &corners,
                               table->triangles + first);
    table->count = end;
    for (uint32_t place = first; place < end; place++)
        if (!(table->triangles[place].facing & SHB_SURFACE_USABLE))
            prepare_alone(reader, place);
}

static size_t id_stride(const shb_frame *frame) {
    return frame->id_stride ? frame->id_stride : frame->width * sizeof *frame->ids;
}

static const uint32_t *row_of_ids(const shb_frame *frame, uint32_t row) {
    return (const uint32_t *)(const void *)((const char *)frame->ids + row * id_stride(frame));
}

/* Puts the ids below a span in reach, which are asked for next but lie far away in memory. */
static void prefetch_next(const shb_frame *frame, const shb_fragment_span *span) {
    enum { LINE = 64 / sizeof(uint32_t) };
    if (span->row + 1 == frame->height)
        return;
    const uint32_t *ids = row_of_ids(frame, span->row + 1);
    for (uint32_t i = span->column; i < span->end; i += LINE)
        __builtin_prefetch(ids + i);
}

/* The place of a triangle in the table of *count ones, where it is or to be prepared. Without a
 * branch for whether it is, which no processor could predict. */
static inline uint32_t find_place(shb_surface_table *table, uint32_t id, uint32_t *count) {
    uint16_t *known = &table->places[id % SHB_TABLE];
    const bool is_there = (*known < *count) & (table->ids[*known] == id);
    const uint32_t place = is_there ? *known : *count;
    *known = (uint16_t)place;
    table->ids[*count] = id;
    *count += !is_there;
    return place;
}

/* Leaves out the runs whose triangles are not there. */
static size_t keep_usable(const shb_surface_table *table, size_t count, shb_surface_run *runs) {
    size_t kept = 0;
    if (!table->lacks)
        return count;
    for (size_t i = 0; i < count; i++) {
        runs[kept] = runs[i];
        kept += (table->triangles[runs[i].place].facing & SHB_SURFACE_USABLE) != 0;
    }
    return kept;
}

/* Runs of the span that see a triangle of the scene; returns how many. Triangles of one instance
 * are prepared together. */
static size_t find_runs(shb_fragment_reader *reader, const shb_fragment_span *span,
                        shb_surface_run *runs) {
    shb_surface_table *table = &reader->table;
    const uint32_t pixels = span->end - span->column;
    const uint32_t *ids = row_of_ids(reader->frame, span->row) + span->column;
    uint16_t starts[SHB_STARTS];
    prefetch_next(reader->frame, span);
    const size_t all = reader->kernels->starts(ids, pixels, starts);
    if (table->count + all > SHB_TABLE)
        clear_table(table);
    const shb_surface_instance *instance = reader->instance;
    uint32_t first_id = instance ? instance->first_id : 0;
    uint32_t held = instance ? instance->mesh->triangle_count : 0;
    uint32_t triangles = table->count;
    size_t found = 0;
    for (size_t k = 0; k < all; k++) {
        const uint32_t id = ids[starts[k]];
        if (id - first_id >= held) {
            if (id == SHB_ID_NONE)
                continue;
            prepare(reader, instance, triangles);
            instance = find_instance(reader, id);
            first_id = instance ? instance->first_id : 0;
            held = instance ? instance->mesh->triangle_count : 0;
            if (!instance)
                continue;
        }
        runs[found++] = (shb_surface_run){find_place(table, id, &triangles),
                                          span->column + starts[k], span->column + starts[k + 1]};
    }
    prepare(reader, instance, triangles);
    reader->instance = instance;
    return keep_usable(table, found, runs);
}

/* A fragment whose pixel's centre lies outside of its triangle. */
static void read_nearest(shb_fragment_reader *reader, size_t i, shb_fragments *out) {
    const shb_frame *frame = reader->frame;
    shb_surface_triangle surface;
    double weights[3];
    shb_fragment_triangle(reader, out->id[i], &surface);
    shb_surface_weights(&surface, frame->width, frame->height, (uint32_t)out->pixel_x[i],
                        (uint32_t)out->pixel_y[i], weights);
    const shb_vec3 point = shb_surface_point(&surface, weights);
    const shb_vec3 shading = shb_surface_shading_normal(&surface, weights);
    out->x[i] = (float)point.x;
    out->y[i] = (float)point.y;
    out->z[i] = (float)point.z;
    out->shading_x[i] = (float)shading.x;
    out->shading_y[i] = (float)shading.y;
    out->shading_z[i] = (float)shading.z;
    out->weight_1[i] = (float)weights[1];
    out->weight_2[i] = (float)weights[2];
}

/* Rounding may leave a point just beyond an edge, in the shadow of a neighbour that rises there:
 * the smaller weight becomes what the larger one leaves, which is exact from 1/2 on. */
static void keep_within(size_t count, float *restrict weight_1, float *restrict weight_2) {
    for (size_t i = 0; i < count; i++) {
        const float b = weight_1[i], c = weight_2[i];
        weight_1[i] = b < c && b > 1 - c ? 1 - c : b;
        weight_2[i] = b >= c && c > 1 - b ? 1 - b : c;
    }
}

/* Loops run over the count rounded up to whole vectors. */
static void pad(size_t count, shb_fragment_batch *batch) {
    shb_fragments *f = &batch->fragments;
    float *const arrays[] = {f->x,         f->y,        f->z,         f->normal_x,
                             f->normal_y,  f->normal_z, f->shading_x, f->shading_y,
                             f->shading_z, f->weight_1, f->weight_2};
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        for (size_t i = count; i < lanes; i++)
            arrays[k][i] = arrays[k][count - 1];
    for (size_t i = count; i < lanes; i++) {
        f->id[i] = f->id[count - 1];
        f->pixel_x[i] = f->pixel_x[count - 1];
        batch->facing[i] = batch->facing[count - 1];
    }
}

/* Ids and pixels of the runs' fragments; returns how many these are. */
static size_t name_pixels(const shb_fragment_reader *reader, const shb_fragment_span *span,
                          size_t run_count, const shb_surface_run *runs, shb_fragments *out) {
    const uint32_t *ids = row_of_ids(reader->frame, span->row);
    size_t count = 0;
    for (size_t r = 0; r < run_count;) {
        const uint32_t begin = runs[r].begin;
        uint32_t end = begin;
        for (; r < run_count && runs[r].begin == end; r++)
            end = runs[r].end;
        memcpy(out->id + count, ids + begin, (end - begin) * sizeof *ids);
        for (uint32_t column = begin; column < end; column++)
            out->pixel_x[count + column - begin] = (int32_t)column;
        count += end - begin;
    }
    for (size_t i = 0; i < shb_round_to_lanes(count); i++)
        out->pixel_y[i] = (int32_t)span->row;
    return count;
}

size_t shb_fragments_read(shb_fragment_reader *reader, const shb_fragment_span *span,
                          shb_fragment_batch *batch) {
    const shb_frame *frame = reader->frame;
    shb_surface_run runs[SHB_SPAN];
    const size_t run_count = find_runs(reader, span, runs);
    if (run_count == 0)
        return 0;
    const size_t count = name_pixels(reader, span, run_count, runs, &batch->fragments);
    const shb_pixel_row row = {(frame->height - 2.0 * span->row - 1) / frame->height,
                               reader->centers, reader->left};
    reader->kernels->fragments(&row, run_count, runs, &reader->table, batch);
    for (size_t i = 0; i < batch->outside_count; i++)
        read_nearest(reader, batch->outside[i], &batch->fragments);
    keep_within(count, batch->fragments.weight_1, batch->fragments.weight_2);
    pad(count, batch);
    return count;
}
