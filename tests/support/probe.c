#include "probe.h"

#include "contexts.h"
#include "test.h"

static double first(const float *array) {
    return (double)array[0];
}

static void keep_receivers(const shb_filter_args *args) {
    const shb_receivers *r = args->receivers;
    probe *const *place = args->filter->user;
    **place = (probe){.x = first(r->x),
                      .y = first(r->y),
                      .z = first(r->z),
                      .normal_x = first(r->normal_x),
                      .normal_y = first(r->normal_y),
                      .normal_z = first(r->normal_z),
                      .cosine = first(r->cosine),
                      .texel_size = first(r->texel_size),
                      .depth_per_world = first(r->depth_per_world),
                      .texel_x = r->texel_x[0],
                      .texel_y = r->texel_y[0],
                      .to_center_x = first(r->to_center_x),
                      .to_center_y = first(r->to_center_y),
                      .depth = first(r->depth),
                      .slope_x = first(r->slope_x),
                      .slope_y = first(r->slope_y),
                      .ref = first(r->ref),
                      .step_x = first(r->step_x),
                      .step_y = first(r->step_y)};
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = 1;
}

probe probe_fragment(const probe_light *light, const shb_bias *bias, shb_vec3 point,
                     shb_vec3 normal) {
    static const float texels[64 * 64];
    const float position[3] = {(float)point.x, (float)point.y, (float)point.z};
    const float direction[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    const shb_points points = {.count = 1, .positions = position, .normals = direction};
    const shb_map_desc desc = {.view = light->view,
                               .width = light->width,
                               .height = light->height,
                               .scene_scale = light->scene_scale};
    shb_bias curious = *bias;
    curious.needs |= SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE;
    probe kept = {0};
    probe *const place = &kept;
    const shb_filter keep = {.name = "keep", .filter = keep_receivers, .user = &place};
    float visibility;
    shb_context *context = NULL;
    shb_map *map = NULL;
    context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_wrap(context, &desc, texels, 0, bias, &map), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &points, &curious, &keep, &visibility), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return kept;
}

shb_view probe_view(const double rows[4][4], bool reversed) {
    shb_view view = {.reversed = reversed};
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++)
            view.clip_from_world.m[4 * column + row] = rows[row][column];
    return view;
}

shb_view probe_orthographic(bool reversed) {
    const double sign = reversed ? -1 : 1;
    const double rows[4][4] = {
        {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -0.125 * sign, 0.5}, {0, 0, 0, 1}};
    return probe_view(rows, reversed);
}

shb_view probe_perspective(bool reversed) {
    /* clip z = 1.5 w - 1.5 = 4.5 - 1.5 z; reversed: w less that = 1.5 - 0.5 w = -0.5 + 0.5 z */
    const double rows[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1.5, 4.5}, {0, 0, -1, 4}};
    const double reversed_rows[4][4] = {
        {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0.5, -0.5}, {0, 0, -1, 4}};
    return probe_view(reversed ? reversed_rows : rows, reversed);
}
