#include "strict.h"

#include "fragments.h"

#include "vector.h"

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, shb_light_source eye,
                              const shb_light_source *lights, size_t light_count) {
    reader->kernels = kernels;
    reader->frame = frame;
    reader->eye = eye;
    reader->lights = lights;
    reader->light_count = light_count;
    reader->batch = 0;
    reader->instance.mesh = NULL;
    for (size_t set = 0; set < SHB_FRAGMENT_SETS; set++)
        for (size_t way = 0; way < SHB_FRAGMENT_WAYS; way++) {
            reader->sets[set].ids[way] = SHB_ID_NONE;
            reader->sets[set].batch[way] = 0;
        }
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

static bool find_instance(shb_fragment_reader *reader, uint32_t id) {
    shb_surface_instance *instance = &reader->instance;
    if (instance->mesh && id - instance->first_id < instance->mesh->triangle_count)
        return true;
    return shb_surface_find_instance(reader->frame->scene, id, instance);
}

static void prepare(shb_fragment_reader *reader, uint32_t id, shb_fragment_triangle *triangle) {
    shb_surface_triangle *surface = &triangle->surface;
    triangle->exists = find_instance(reader, id) &&
                       shb_surface_prepare_of(&reader->instance, reader->frame->view, id, surface);
    if (!triangle->exists)
        return;
    surface->normal = normal_to_eye(surface, &reader->eye);
    triangle->facing = 0;
    for (size_t k = 0; k < reader->light_count; k++)
        triangle->facing |= (uint32_t)shb_surface_faces(surface, &reader->lights[k]) << k;
}

/* Prepares a triangle in the place of the one that was not used for longest; NULL if all of its set
 * are used by the current batch. */
static const shb_fragment_triangle *prepare_in_set(shb_fragment_reader *reader, uint32_t id,
                                                   shb_fragment_set *set) {
    size_t oldest = 0;
    for (size_t way = 1; way < SHB_FRAGMENT_WAYS; way++)
        oldest = set->batch[way] < set->batch[oldest] ? way : oldest;
    if (set->batch[oldest] == reader->batch)
        return NULL;
    set->ids[oldest] = id;
    set->batch[oldest] = reader->batch;
    prepare(reader, id, &set->triangles[oldest]);
    return &set->triangles[oldest];
}

static inline const shb_fragment_triangle *find_triangle(shb_fragment_reader *reader, uint32_t id) {
    shb_fragment_set *set = &reader->sets[id % SHB_FRAGMENT_SETS];
    for (size_t way = 0; way < SHB_FRAGMENT_WAYS; way++)
        if (set->ids[way] == id) {
            set->batch[way] = reader->batch;
            return &set->triangles[way];
        }
    return prepare_in_set(reader, id, set);
}

/* A fragment whose pixel's centre lies outside of its triangle. */
static void read_nearest(const shb_frame *frame, const shb_surface_triangle *surface, size_t i,
                         shb_fragments *out) {
    double weights[3];
    shb_surface_weights(surface, frame->width, frame->height, (uint32_t)out->pixel_x[i],
                        (uint32_t)out->pixel_y[i], weights);
    const shb_vec3 point = shb_surface_point(surface, weights);
    const shb_vec3 shading = shb_surface_shading_normal(surface, weights);
    out->x[i] = (float)point.x;
    out->y[i] = (float)point.y;
    out->z[i] = (float)point.z;
    out->shading_x[i] = (float)shading.x;
    out->shading_y[i] = (float)shading.y;
    out->shading_z[i] = (float)shading.z;
    out->weight_1[i] = (float)weights[1];
    out->weight_2[i] = (float)weights[2];
}

/* Finds the triangles of the next covered pixels of the span. */
static size_t collect(shb_fragment_reader *reader, shb_fragment_span *span,
                      shb_fragments *fragments, uint32_t facing[SHB_BATCH]) {
    const shb_frame *frame = reader->frame;
    const size_t stride = frame->id_stride ? frame->id_stride : frame->width * sizeof *frame->ids;
    const char *bytes = (const char *)frame->ids + span->row * stride;
    const uint32_t *ids = (const uint32_t *)(const void *)bytes;
    const shb_fragment_triangle *triangle = NULL;
    size_t count = 0;
    uint32_t x = span->column, last = SHB_ID_NONE;
    reader->batch++;
    for (; x < span->end && count < SHB_BATCH; x++) {
        if (ids[x] == SHB_ID_NONE)
            continue;
        if (ids[x] != last && !(triangle = find_triangle(reader, ids[x])))
            break;
        last = ids[x];
        if (!triangle->exists)
            continue;
        reader->records[count] = &triangle->surface;
        facing[count] = triangle->facing;
        fragments->id[count] = ids[x];
        fragments->pixel_x[count++] = (int32_t)x;
    }
    span->column = x;
    return count;
}

/* Loops run over the count rounded up to whole vectors. */
static void pad(size_t count, const void *records[SHB_BATCH], shb_fragments *fragments,
                uint32_t facing[SHB_BATCH]) {
    for (size_t i = count; i % SHB_LANES; i++) {
        records[i] = records[count - 1];
        facing[i] = facing[count - 1];
        fragments->id[i] = fragments->id[count - 1];
        fragments->pixel_x[i] = fragments->pixel_x[count - 1];
    }
}

size_t shb_fragments_read(shb_fragment_reader *reader, shb_fragment_span *span,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]) {
    const void **records = reader->records;
    SHB_ALIGN float outside[SHB_BATCH];
    size_t count;
    do
        count = collect(reader, span, fragments, facing);
    while (count == 0 && span->column < span->end);
    if (count == 0)
        return 0;
    pad(count, records, fragments, facing);
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++)
        fragments->pixel_y[i] = (int32_t)span->row;
    const shb_pixel_row row = {reader->frame->width, reader->frame->height, span->row};
    reader->kernels->fragments(&row, count, records, fragments, outside);
    for (size_t i = 0; i < lanes; i++)
        if (isnan(outside[i]))
            read_nearest(reader->frame, records[i], i, fragments);
    return count;
}
