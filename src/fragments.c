#include "strict.h"

#include "fragments.h"

#include "scene.h"
#include "vector.h"

#include <string.h>

static void clear_table(shb_surface_table *table) {
    memset(table->met_ids, 0xff, sizeof table->met_ids); /* of no triangle */
    table->count = 0;
    table->prepared = 0;
    table->lacks = false;
    table->has_smooth = false;
}

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, const shb_surface_view *view, uint32_t left) {
    reader->kernels = kernels;
    reader->frame = frame;
    reader->view = *view;
    reader->instance_count = 0;
    reader->next_instance = 0;
    memset(reader->table.met_places, 0, sizeof reader->table.met_places);
    clear_table(&reader->table);
    reader->left = left;
    for (uint32_t i = 0; i < SHB_SPAN; i++) {
        reader->columns[i] = (int32_t)(left + i);
        reader->centers[i] = (2.0 * (left + i) + 1.0 - frame->width) / frame->width;
    }
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

static inline void read_triple(float (*to)[SHB_BATCH + SHB_TABLE_MARGIN], size_t i,
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
    uint32_t vertices[SHB_BATCH][3];
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

/* Prepares the triangles first .. end - 1 of the table, all of this instance. */
static void prepare(shb_fragment_reader *reader, const shb_surface_instance *instance,
                    uint32_t first, uint32_t end) {
    shb_surface_table *table = &reader->table;
    table->has_smooth |= instance->mesh->normals != NULL;
    shb_surface_corners corners;
    read_corners(instance, end - first, table->ids + first, &corners);
    reader->kernels->triangles(&reader->view, instance, end - first, &corners,
                               table->triangles + first);
    for (uint32_t place = first; place < end; place++)
        if (!(table->triangles[place].facing & SHB_SURFACE_USABLE))
            prepare_alone(reader, place);
}

/* Prepares the triangles that are not yet, those of one instance together. */
static void prepare_new(shb_fragment_reader *reader) {
    shb_surface_table *table = &reader->table;
    while (table->prepared < table->count) {
        const uint32_t first = table->prepared++;
        const shb_surface_instance *instance = find_instance(reader, table->ids[first]);
        if (!instance) {
            table->triangles[first].facing = 0;
            table->lacks = true;
            continue;
        }
        while (table->prepared < table->count && holds(instance, table->ids[table->prepared]))
            table->prepared++;
        prepare(reader, instance, first, table->prepared);
    }
}

static size_t id_stride(const shb_frame *frame) {
    return frame->id_stride ? frame->id_stride : frame->width * sizeof *frame->ids;
}

static const uint32_t *row_of_ids(const shb_frame *frame, uint32_t row) {
    return (const uint32_t *)(const void *)((const char *)frame->ids + row * id_stride(frame));
}

/* Ids some rows below a span are read soon, but lie far away in memory. */
static void prefetch_below(const shb_frame *frame, const shb_piece *span) {
    enum { LINE = 64 / sizeof(uint32_t), ROWS = 8 };
    if (span->row + ROWS >= frame->height)
        return;
    const uint32_t *ids = row_of_ids(frame, span->row + ROWS) + span->column;
    for (uint32_t i = 0; i < span->count; i += LINE)
        __builtin_prefetch(ids + i);
}

void shb_fragments_take(shb_fragment_reader *reader, const shb_piece *span,
                        shb_fragment_batch *batch) {
    const shb_frame *frame = reader->frame;
    prefetch_below(frame, span);
    if (batch->count == 0 && reader->table.count + SHB_BATCH > SHB_TABLE)
        clear_table(&reader->table);
    reader->kernels->take(row_of_ids(frame, span->row) + span->column, span, &reader->table, batch);
}

/* Writes where the pixels of the batch lie. */
static void write_pixels(const shb_fragment_reader *reader, shb_fragment_batch *batch) {
    const uint32_t height = reader->frame->height;
    shb_fragments *fragments = &batch->fragments;
    size_t first = 0;
    for (size_t k = 0; k < batch->piece_count; k++) {
        const shb_piece *piece = &batch->pieces[k];
        const size_t from = piece->column - reader->left, end = first + piece->count;
        const double center_y = (height - 2.0 * piece->row - 1) / height;
        memcpy(fragments->pixel_x + first, reader->columns + from,
               piece->count * sizeof *reader->columns);
        memcpy(batch->centers_x + first, reader->centers + from,
               piece->count * sizeof *reader->centers);
        for (; first < end; first++) {
            fragments->pixel_y[first] = (int32_t)piece->row;
            batch->centers_y[first] = center_y;
        }
    }
}

static void copy_pixel(shb_fragment_batch *batch, size_t from, size_t to) {
    shb_fragments *fragments = &batch->fragments;
    fragments->id[to] = fragments->id[from];
    fragments->pixel_x[to] = fragments->pixel_x[from];
    fragments->pixel_y[to] = fragments->pixel_y[from];
    batch->places[to] = batch->places[from];
    batch->centers_x[to] = batch->centers_x[from];
    batch->centers_y[to] = batch->centers_y[from];
}

/* Leaves out the pixels whose triangles are not there. */
static void keep_usable(const shb_surface_table *table, shb_fragment_batch *batch) {
    const shb_fragments *fragments = &batch->fragments;
    size_t kept = 0;
    batch->piece_count = 0;
    for (size_t i = 0; i < batch->count; i++) {
        if (!(table->triangles[batch->places[i]].facing & SHB_SURFACE_USABLE))
            continue;
        copy_pixel(batch, i, kept);
        shb_pieces_add(batch, (uint32_t)fragments->pixel_y[i], (uint32_t)fragments->pixel_x[i], 1);
        kept++;
    }
    batch->count = kept;
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

void shb_fragments_read(shb_fragment_reader *reader, shb_fragment_batch *batch) {
    write_pixels(reader, batch);
    prepare_new(reader);
    if (reader->table.lacks)
        keep_usable(&reader->table, batch);
    if (batch->count == 0)
        return;
    const size_t lanes = shb_round_to_lanes(batch->count);
    for (size_t i = batch->count; i < lanes; i++)
        copy_pixel(batch, batch->count - 1, i);
    reader->kernels->fragments(&reader->table, batch);
    for (size_t i = 0; i < batch->outside_count; i++)
        read_nearest(reader, batch->outside[i], &batch->fragments);
    reader->kernels->keep_within(lanes, batch->fragments.weight_1, batch->fragments.weight_2);
}
