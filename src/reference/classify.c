/* The truth about every pixel of a frame. */
#include "../strict.h"

#include "reference.h"

#include <math.h>

#include "../frame.h"
#include "../surface.h"
#include "edge_grid.h"

typedef struct classifier {
    const shb_reference *reference;
    const shb_classify_desc *desc;
    const shb_map_info *map;
    shb_light_source eye;
    shb_texel_rows texel;
    shb_edge_grid grid;
    uint8_t *truth;
} classifier;

static void to_array(shb_vec3 v, double out[3]) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/* True if light falls on the side of the triangle that the camera sees. The receiver's normal is
 * turned to the light. */
static bool faces_light(const classifier *c, const shb_surface_triangle *triangle, shb_vec3 point,
                        shb_edge_receiver *receiver) {
    const shb_light_source *light = &c->map->light;
    const bool front = shb_surface_faces(triangle, light);
    if (front != shb_surface_faces(triangle, &c->eye))
        return false;
    const shb_vec3 normal = shb_vec3_scale(triangle->normal, front ? 1 : -1);
    const shb_vec3 to_light =
        shb_vec3_normalize(shb_vec3_subtract(light->position, shb_vec3_scale(point, light->w)));
    const double cosine = shb_vec3_dot(normal, to_light);
    to_array(normal, receiver->normal);
    return cosine > 0 && cosine >= c->desc->min_cosine;
}

/* True if the receiver's position lies in the map; its texel coordinates are written. */
static bool lies_in_map(const classifier *c, shb_edge_receiver *receiver) {
    double projected[3];
    shb_texel_project(&c->texel, receiver->position, projected);
    receiver->x = projected[0] / projected[2];
    receiver->y = projected[1] / projected[2];
    return projected[2] > 0 && receiver->x >= 0 && receiver->x < c->map->width &&
           receiver->y >= 0 && receiver->y < c->map->height;
}

static double reach_of(const shb_surface_triangle *triangle) {
    double reach = 0;
    for (int k = 0; k < 3; k++) {
        double corner[3];
        to_array(triangle->corners[k], corner);
        for (int i = 0; i < 3; i++)
            reach = fabs(corner[i]) > reach ? fabs(corner[i]) : reach;
    }
    return reach;
}

static uint8_t classify_point(const classifier *c, const shb_surface_triangle *triangle,
                              shb_vec3 point) {
    shb_edge_receiver receiver = {.reach = reach_of(triangle)};
    to_array(point, receiver.position);
    if (!faces_light(c, triangle, point, &receiver) || !lies_in_map(c, &receiver))
        return SHB_TRUTH_NONE;
    shb_ray ray;
    const bool shadowed = shb_ray_to_light(&c->map->light, point, &ray) &&
                          shb_bvh_occluded(&c->reference->bvh, &ray, triangle->id);
    const bool boundary = shb_edge_grid_is_near(&c->grid, &receiver);
    return (uint8_t)((shadowed ? SHB_TRUTH_SHADOWED : SHB_TRUTH_LIT) |
                     (boundary ? SHB_TRUTH_BOUNDARY : 0));
}

static void classify_row(void *arg, size_t index) {
    const classifier *c = arg;
    const shb_frame *frame = &c->desc->frame;
    const uint32_t row = (uint32_t)index;
    const size_t stride = frame->id_stride ? frame->id_stride : frame->width * sizeof(uint32_t);
    const uint32_t *ids = (const uint32_t *)(const void *)((const char *)frame->ids + row * stride);
    uint8_t *truth = c->truth + (size_t)row * frame->width;
    shb_surface_triangle triangle;
    uint32_t prepared = SHB_ID_NONE;
    for (uint32_t column = 0; column < frame->width; column++) {
        if (ids[column] != prepared &&
            shb_surface_prepare(frame->scene, frame->view, ids[column], &triangle))
            prepared = ids[column];
        truth[column] = SHB_TRUTH_NONE;
        if (ids[column] != prepared || prepared == SHB_ID_NONE)
            continue;
        double weights[3];
        shb_surface_weights(&triangle, frame->width, frame->height, column, row, weights);
        truth[column] = classify_point(c, &triangle, shb_surface_point(&triangle, weights));
    }
}

static shb_result check_frame(const shb_reference *reference, const shb_frame *frame) {
    const shb_context *context = reference->context;
    const shb_result result = shb_frame_check(context, "shb_reference_classify", frame);
    if (result)
        return result;
    const uint64_t count = shb_scene_triangle_count(frame->scene);
    if (count != reference->bvh.id_count)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_reference_classify: desc.frame.scene has %llu triangles, the "
                        "reference %lu",
                        (unsigned long long)count, (unsigned long)reference->bvh.id_count);
    return SHB_OK;
}

static shb_result check_desc(const shb_reference *reference, const shb_classify_desc *desc,
                             const uint8_t *truth) {
    const shb_context *context = reference->context;
    if (!desc || !truth || !desc->map)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_reference_classify: %s is NULL",
                        !desc    ? "desc"
                        : !truth ? "truth"
                                 : "desc.map");
    if (!(desc->min_cosine >= 0 && desc->min_cosine <= 1))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_reference_classify: desc.min_cosine %g is not 0 .. 1",
                        desc->min_cosine);
    return check_frame(reference, &desc->frame);
}

shb_result shb_reference_classify(const shb_reference *reference, const shb_classify_desc *desc,
                                  uint8_t *truth) {
    if (!reference)
        return SHB_ERROR_ARGUMENT;
    const shb_context *context = reference->context;
    shb_result result = check_desc(reference, desc, truth);
    if (result)
        return result;
    classifier c = {.reference = reference, .desc = desc, .truth = truth};
    c.map = shb_map_get_info(desc->map);
    c.texel = shb_texel_rows_of(c.map);
    result = shb_view_light_source(desc->frame.view, &c.eye);
    if (result)
        return shb_fail(context, result,
                        "shb_reference_classify: desc.frame.view cannot be inverted");
    if (!shb_edge_grid_build(context, reference->bvh.triangles, &reference->edges, c.map, &c.grid))
        return shb_fail(context, SHB_ERROR_MEMORY,
                        "shb_reference_classify: no memory for silhouette edges");
    shb_parallel_for(context, classify_row, &c, desc->frame.height);
    shb_edge_grid_free(context, &c.grid);
    return SHB_OK;
}
