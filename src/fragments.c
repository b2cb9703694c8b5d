#include "strict.h"

#include "fragments.h"

#include "kernels/shade.h"

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_frame *frame,
                              shb_light_source eye, const shb_light_source *lights,
                              size_t light_count) {
    reader->frame = frame;
    reader->eye = eye;
    reader->lights = lights;
    reader->light_count = light_count;
    for (size_t i = 0; i < SHB_FRAGMENT_CACHE; i++)
        reader->cache[i].id = SHB_ID_NONE;
}

/* A triangle without area that snapping has made visible counts as facing the camera. */
static shb_vec3 normal_to_eye(const shb_surface_triangle *surface, const shb_light_source *eye) {
    if (shb_surface_faces(surface, eye))
        return surface->normal;
    if (shb_vec3_length(surface->normal) > 0)
        return shb_vec3_scale(surface->normal, -1);
    const shb_vec3 corner = shb_vec3_scale(surface->corners[0], eye->w);
    return shb_vec3_normalize(shb_vec3_subtract(eye->position, corner));
}

static void prepare(const shb_fragment_reader *reader, uint32_t id,
                    shb_fragment_triangle *triangle) {
    shb_surface_triangle *surface = &triangle->surface;
    triangle->id = id;
    triangle->exists = shb_surface_prepare(reader->frame->scene, reader->frame->view, id, surface);
    if (!triangle->exists)
        return;
    surface->normal = normal_to_eye(surface, &reader->eye);
    triangle->facing = 0;
    for (size_t k = 0; k < reader->light_count; k++)
        triangle->facing |= (uint32_t)shb_surface_faces(surface, &reader->lights[k]) << k;
}

static const shb_fragment_triangle *find_triangle(shb_fragment_reader *reader, uint32_t id) {
    shb_fragment_triangle *triangle = &reader->cache[id % SHB_FRAGMENT_CACHE];
    if (triangle->id != id)
        prepare(reader, id, triangle);
    return triangle;
}

static void write_fragment(const shb_frame *frame, const shb_surface_triangle *surface,
                           uint32_t column, uint32_t row, shb_fragments *out, size_t i) {
    double weights[3];
    shb_surface_weights(surface, frame->width, frame->height, column, row, weights);
    const shb_vec3 point = shb_surface_point(surface, weights);
    const shb_vec3 shading = shb_surface_shading_normal(surface, weights);
    out->x[i] = (float)point.x;
    out->y[i] = (float)point.y;
    out->z[i] = (float)point.z;
    out->normal_x[i] = (float)surface->normal.x;
    out->normal_y[i] = (float)surface->normal.y;
    out->normal_z[i] = (float)surface->normal.z;
    out->shading_x[i] = (float)shading.x;
    out->shading_y[i] = (float)shading.y;
    out->shading_z[i] = (float)shading.z;
    out->weight_1[i] = (float)weights[1];
    out->weight_2[i] = (float)weights[2];
    out->id[i] = surface->id;
    out->pixel_x[i] = (int32_t)column;
    out->pixel_y[i] = (int32_t)row;
}

static void copy_fragment(shb_fragments *fragments, size_t from, size_t to) {
    float *const arrays[] = {fragments->x,         fragments->y,         fragments->z,
                             fragments->normal_x,  fragments->normal_y,  fragments->normal_z,
                             fragments->shading_x, fragments->shading_y, fragments->shading_z,
                             fragments->weight_1,  fragments->weight_2};
    for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
        arrays[k][to] = arrays[k][from];
    fragments->id[to] = fragments->id[from];
    fragments->pixel_x[to] = fragments->pixel_x[from];
    fragments->pixel_y[to] = fragments->pixel_y[from];
}

/* Loops may run over the count rounded up to whole vectors. */
static void pad(shb_fragments *fragments, uint32_t *facing, size_t count) {
    for (size_t i = count; i % SHB_LANES; i++) {
        copy_fragment(fragments, count - 1, i);
        facing[i] = facing[count - 1];
    }
}

size_t shb_fragments_read(shb_fragment_reader *reader, uint32_t row, uint32_t *column,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]) {
    const shb_frame *frame = reader->frame;
    const size_t stride = frame->id_stride ? frame->id_stride : frame->width * sizeof *frame->ids;
    const char *bytes = (const char *)frame->ids + row * stride;
    const uint32_t *ids = (const uint32_t *)(const void *)bytes;
    size_t count = 0;
    uint32_t x = *column;
    for (; x < frame->width && count < SHB_BATCH; x++) {
        if (ids[x] == SHB_ID_NONE)
            continue;
        const shb_fragment_triangle *triangle = find_triangle(reader, ids[x]);
        if (!triangle->exists)
            continue;
        write_fragment(frame, &triangle->surface, x, row, fragments, count);
        facing[count++] = triangle->facing;
    }
    *column = x;
    if (count)
        pad(fragments, facing, count);
    return count;
}
