#include "strict.h"

#include "fragments.h"

#include "scene.h"
#include "vector.h"

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, shb_light_source eye,
                              const shb_light_source *lights, size_t light_count) {
    reader->kernels = kernels;
    reader->frame = frame;
    reader->view = (shb_run_view){frame->view, eye, lights, light_count};
    reader->instance_count = 0;
    reader->next_instance = 0;
    reader->instance = NULL;
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

static void write_vector(double (*to)[SHB_RUNS], size_t run, shb_vec3 v) {
    to[0][run] = v.x;
    to[1][run] = v.y;
    to[2][run] = v.z;
}

/* A run that the kernels leave alone. */
static void prepare_alone(shb_fragment_reader *reader, size_t run) {
    shb_surface_runs *runs = &reader->runs;
    shb_surface_triangle triangle;
    if (!shb_fragment_triangle(reader, runs->ids[run], &triangle))
        return;
    runs->prepared[run] = 1;
    runs->facing[run] = 0;
    for (size_t k = 0; k < reader->view.light_count; k++)
        runs->facing[run] |= (uint32_t)shb_surface_faces(&triangle, &reader->view.lights[k]) << k;
    write_vector(runs->normal, run, triangle.normal);
    write_vector(runs->corners, run, triangle.corners[0]);
    write_vector(runs->shading, run, triangle.shading[0]);
    for (int k = 1; k < 3; k++) {
        write_vector(runs->corners + 3 * k, run,
                     vec3_subtract(triangle.corners[k], triangle.corners[0]));
        write_vector(runs->shading + 3 * k, run,
                     vec3_subtract(triangle.shading[k], triangle.shading[0]));
    }
    for (int k = 0; k < 3; k++)
        write_vector(runs->cofactors + 3 * k, run, triangle.cofactors[k]);
}

static inline void read_triple(float (*to)[SHB_RUNS], size_t run, const float *from) {
    to[0][run] = from[0];
    to[1][run] = from[1];
    to[2][run] = from[2];
}

/* The vertices of runs; what these hold is asked for before any of it is read, as neighbours on the
 * screen may lie anywhere in memory. */
static void read_vertices(const shb_surface_instance *instance, size_t first, size_t end,
                          const shb_surface_runs *runs, uint32_t (*vertices)[3]) {
    const shb_mesh *mesh = instance->mesh;
    for (size_t run = first; run < end; run++) {
        uint32_t *corners = vertices[run];
        shb_mesh_triangle(mesh, runs->ids[run] - instance->first_id, corners);
        for (int k = 0; k < 3; k++) {
            if (corners[k] >= mesh->vertex_count)
                continue;
            __builtin_prefetch(shb_mesh_position(mesh, corners[k]));
            if (mesh->normals)
                __builtin_prefetch(shb_mesh_normal(mesh, corners[k]));
        }
    }
}

/* Corners whose index is out of range become NaN, so that the run is left out. */
static void read_corners(const shb_surface_instance *instance, size_t first, size_t end,
                         shb_surface_runs *runs) {
    static const float none[3] = {NAN, NAN, NAN}, zero[3] = {0, 0, 0};
    const shb_mesh *mesh = instance->mesh;
    uint32_t vertices[SHB_RUNS][3];
    read_vertices(instance, first, end, runs, vertices);
    for (size_t run = first; run < end; run++)
        for (int k = 0; k < 3; k++) {
            const uint32_t vertex = vertices[run][k];
            const bool exists = vertex < mesh->vertex_count;
            read_triple(runs->positions + 3 * k, run,
                        exists ? shb_mesh_position(mesh, vertex) : none);
            read_triple(runs->normals + 3 * k, run,
                        exists && mesh->normals ? shb_mesh_normal(mesh, vertex) : zero);
        }
}

/* Prepares runs first .. end - 1, all of one instance. */
static void prepare(shb_fragment_reader *reader, size_t first, size_t end) {
    shb_surface_runs *runs = &reader->runs;
    const shb_surface_instance *instance = reader->instance;
    if (first == end)
        return;
    read_corners(instance, first, end, runs);
    reader->kernels->runs(&reader->view, instance, first, end, runs);
    for (size_t run = first; run < end; run++)
        if (!runs->prepared[run])
            prepare_alone(reader, run);
}

/* Appends the pixels first .. end - 1 that differ from the one before; without a branch that no
 * processor could predict. */
static size_t add_starts(const uint32_t *ids, uint32_t first, uint32_t end, uint32_t *starts,
                         size_t found) {
    for (uint32_t i = first; i < end; i++) {
        starts[found] = i;
        found += ids[i] != ids[i - 1];
    }
    return found;
}

/* Where the runs of equal ids begin, and at last the count; returns how many there are. */
static size_t find_starts(const uint32_t *ids, uint32_t count, uint32_t starts[SHB_BATCH + 1]) {
    enum { PIECE = 8 };
    size_t found = 1;
    uint32_t first = 1;
    starts[0] = 0;
    for (; first + PIECE <= count; first += PIECE) {
        uint32_t differs = 0;
        for (uint32_t i = first; i < first + PIECE; i++)
            differs |= ids[i] ^ ids[i - 1];
        if (differs)
            found = add_starts(ids, first, first + PIECE, starts, found);
    }
    found = add_starts(ids, first, count, starts, found);
    starts[found] = count;
    return found;
}

static size_t id_stride(const shb_frame *frame) {
    return frame->id_stride ? frame->id_stride : frame->width * sizeof *frame->ids;
}

/* The ids of count more pixels of a span. Those below, which are asked for next but lie far away in
 * memory, are put in reach. */
static const uint32_t *ids_of(const shb_frame *frame, const shb_fragment_span *span,
                              uint32_t count) {
    enum { LINE = 64 / sizeof(uint32_t) };
    const char *row = (const char *)frame->ids + span->row * id_stride(frame);
    const uint32_t *ids = (const uint32_t *)(const void *)row + span->column;
    if (span->row + 1 < frame->height)
        for (uint32_t i = 0; i < count; i += LINE)
            __builtin_prefetch((const char *)(ids + i) + id_stride(frame));
    return ids;
}

static inline void prefetch_indices(const shb_surface_instance *instance, uint32_t id) {
    const shb_mesh *mesh = instance->mesh;
    if (mesh->indices)
        __builtin_prefetch((const char *)mesh->indices +
                           3 * (size_t)(id - instance->first_id) * (mesh->index_size == 2 ? 2 : 4));
}

/* Runs of the next pixels of the span that see a triangle of the scene; returns how many. Those of
 * one instance are prepared together. */
static size_t find_runs(shb_fragment_reader *reader, shb_fragment_span *span) {
    const uint32_t left = span->end - span->column, pixels = left < SHB_BATCH ? left : SHB_BATCH;
    const uint32_t *ids = ids_of(reader->frame, span, pixels);
    shb_surface_runs *runs = &reader->runs;
    uint32_t starts[SHB_BATCH + 1];
    const size_t all = find_starts(ids, pixels, starts);
    size_t count = 0, first = 0;
    for (size_t k = 0; k < all; k++) {
        const uint32_t id = ids[starts[k]];
        if (id == SHB_ID_NONE)
            continue;
        if (!reader->instance || !holds(reader->instance, id)) {
            prepare(reader, first, count);
            first = count;
            reader->instance = find_instance(reader, id);
            if (!reader->instance)
                continue;
        }
        prefetch_indices(reader->instance, id);
        runs->ids[count] = id;
        runs->begin[count] = span->column + starts[k];
        runs->end[count++] = span->column + starts[k + 1];
    }
    prepare(reader, first, count);
    span->column += pixels;
    return count;
}

/* Writes count pixels of a run from fragment i on: array by array, which compilers make vectors
 * of. */
static inline void list_piece(shb_fragment_reader *reader, size_t run, uint32_t pixel, size_t i,
                              size_t count, shb_fragments *restrict fragments,
                              uint32_t *restrict facing) {
    const uint32_t id = reader->runs.ids[run], faces = reader->runs.facing[run];
    for (size_t k = 0; k < count; k++)
        reader->run_of[i + k] = (int32_t)run;
    for (size_t k = 0; k < count; k++)
        facing[i + k] = faces;
    for (size_t k = 0; k < count; k++)
        fragments->id[i + k] = id;
    for (size_t k = 0; k < count; k++)
        fragments->pixel_x[i + k] = (int32_t)(pixel + k);
}

/* The pixels of one run as fragments from number i on; returns the number of the next. Most runs
 * are short: pieces of one vector, and what is too much the next run overwrites. */
static size_t list_run(shb_fragment_reader *reader, size_t run, size_t i, shb_fragments *fragments,
                       uint32_t facing[SHB_BATCH]) {
    enum { PIECE = 8 };
    const uint32_t begin = reader->runs.begin[run];
    const size_t end = i + (reader->runs.end[run] - begin);
    size_t at = i;
    for (; at < end && at + PIECE <= SHB_BATCH; at += PIECE)
        list_piece(reader, run, begin + (uint32_t)(at - i), at, PIECE, fragments, facing);
    if (at < end)
        list_piece(reader, run, begin + (uint32_t)(at - i), at, end - at, fragments, facing);
    return end;
}

/* The pixels of the runs whose triangles are there. After one that is not, the rest of the span
 * waits for the next batch, as neighbouring fragments must belong to neighbouring runs. */
static size_t list_pixels(shb_fragment_reader *reader, size_t run_count, shb_fragment_span *span,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]) {
    const shb_surface_runs *runs = &reader->runs;
    size_t count = 0;
    for (size_t run = 0; run < run_count; run++) {
        if (runs->prepared[run]) {
            count = list_run(reader, run, count, fragments, facing);
        } else if (count) {
            span->column = runs->end[run];
            break;
        }
    }
    return count;
}

/* Loops run over the count rounded up to whole vectors. */
static void pad(size_t count, int32_t run_of[SHB_BATCH], shb_fragments *fragments,
                uint32_t facing[SHB_BATCH]) {
    for (size_t i = count; i % SHB_LANES; i++) {
        run_of[i] = run_of[count - 1];
        facing[i] = facing[count - 1];
        fragments->id[i] = fragments->id[count - 1];
        fragments->pixel_x[i] = fragments->pixel_x[count - 1];
    }
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

static bool has_nan(size_t count, const float *values) {
    int32_t found = 0;
    for (size_t i = 0; i < count; i++)
        found |= -(values[i] != values[i]);
    return found != 0;
}

size_t shb_fragments_read(shb_fragment_reader *reader, shb_fragment_span *span,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]) {
    SHB_ALIGN float outside[SHB_BATCH];
    size_t count = 0;
    while (count == 0 && span->column < span->end)
        count = list_pixels(reader, find_runs(reader, span), span, fragments, facing);
    if (count == 0)
        return 0;
    pad(count, reader->run_of, fragments, facing);
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++)
        fragments->pixel_y[i] = (int32_t)span->row;
    const shb_pixel_row row = {reader->frame->width, reader->frame->height, span->row};
    reader->kernels->fragments(&row, count, &reader->runs, reader->run_of, fragments, outside);
    if (has_nan(lanes, outside))
        for (size_t i = 0; i < lanes; i++)
            if (isnan(outside[i]))
                read_nearest(reader, i, fragments);
    return count;
}
