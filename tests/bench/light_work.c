#include "light_work.h"

#include <stdlib.h>

const light_exact light_exact_kinds[LIGHT_EXACT_KINDS] = {
    {"exact-triangles", SHB_OCCLUDERS_TRIANGLES, false},
    {"exact-triangles-named", SHB_OCCLUDERS_TRIANGLES, true},
    {"exact-lists", SHB_OCCLUDERS_LISTS, false},
    {"exact-lists-named", SHB_OCCLUDERS_LISTS, true},
};

static bool keeps_nearest(const shb_bias *bias) {
    return !bias->combine && !(bias->needs & (SHB_NEEDS_FLIPPED | SHB_NEEDS_OCCLUDERS));
}

static shb_result run_visibility(void *state) {
    light_work *work = state;
    const shb_points points =
        work->names_triangles ? measure_points(work->frame) : measure_positions(work->frame);
    return shb_map_visibility(work->map, &points, &work->bias, NULL, work->frame->visibility);
}

static shb_result shade(light_work *work, const uint32_t *ids, size_t id_stride) {
    const shb_shade_light light = {.map = work->map, .bias = &work->bias, .color = {1, 1, 1}};
    shb_shade_desc desc = {.frame = work->frame->frame,
                           .lights = &light,
                           .light_count = 1,
                           .shade = shb_shade_lambert,
                           .image = work->image};
    desc.frame.ids = ids;
    desc.frame.id_stride = id_stride;
    return shb_shade(work->context, &desc);
}

static shb_result run_shade(void *state) {
    light_work *work = state;
    return shade(work, work->frame->ids, 0);
}

static shb_result run_frame(void *state) {
    light_work *work = state;
    shb_result result = shb_map_draw(work->map, &work->frame->scene->scene, &work->bias, NULL);
    if (!result) {
        const bench_work camera = draw_work_of(&work->camera);
        result = camera.run(camera.state);
    }
    return result ? result : shade(work, work->camera.desc.ids, work->camera.desc.id_stride);
}

bench_work light_work_visibility(light_work *work) {
    return (bench_work){run_visibility, work};
}

bench_work light_work_shade(light_work *work) {
    return (bench_work){run_shade, work};
}

bench_work light_work_frame(light_work *work) {
    return (bench_work){run_frame, work};
}

static shb_result create_image(light_work *work) {
    const uint32_t width = work->frame->frame.width, height = work->frame->frame.height;
    work->image = (shb_image){malloc((size_t)width * height * 3), width, height, 0};
    return work->image.pixels ? SHB_OK : SHB_ERROR_MEMORY;
}

static shb_result create_map(light_work *work, uint32_t map_size) {
    const example_scene *scene = work->frame->scene;
    shb_map_desc desc = {.width = map_size,
                         .occluders = work->occluders,
                         .exact_only = work->occluders == SHB_OCCLUDERS_LISTS};
    shb_result result = scene_light_view(scene, SCENE_DIRECTIONAL, map_size, false, &desc.view);
    if (!result)
        result = shb_map_create(work->context, &desc, &work->map);
    return result ? result : shb_map_draw(work->map, &scene->scene, &work->bias, NULL);
}

/* Makes all that is missing; releases the rest if that fails. */
static shb_result complete(light_work *work, uint32_t map_size) {
    const measure_frame *frame = work->frame;
    shb_result result = create_image(work);
    if (!result)
        result = draw_work_create(work->context, &frame->scene->scene, &frame->view,
                                  frame->frame.width, frame->frame.height, DRAW_IDS, &work->camera);
    if (!result)
        result = create_map(work, map_size);
    if (result)
        light_work_destroy(work);
    return result;
}

shb_result light_work_create(shb_context *context, const measure_frame *frame, uint32_t map_size,
                             const shb_bias *bias, light_work *work) {
    *work = (light_work){.context = context,
                         .frame = frame,
                         .bias = *bias,
                         .name = bias->name,
                         .occluders = SHB_OCCLUDERS_PLANES};
    return complete(work, map_size);
}

shb_result light_work_create_exact(shb_context *context, const measure_frame *frame,
                                   uint32_t map_size, const light_exact *exact, light_work *work) {
    *work = (light_work){.context = context,
                         .frame = frame,
                         .bias = shb_bias_exact(),
                         .name = exact->name,
                         .occluders = exact->occluders,
                         .names_triangles = exact->names_triangles};
    return complete(work, map_size);
}

shb_result light_work_share(shb_context *context, const light_work *original, light_work *work) {
    *work = (light_work){.context = context,
                         .frame = original->frame,
                         .bias = original->bias,
                         .name = original->name,
                         .occluders = original->occluders,
                         .names_triangles = original->names_triangles};
    const shb_map_info *info = shb_map_get_info(original->map);
    const shb_depth_image depth = shb_map_get_depth(original->map);
    const shb_map_desc desc = {.view = info->view,
                               .width = info->width,
                               .height = info->height,
                               .scene_scale = info->scene_scale};
    shb_result result = create_image(work);
    if (!result && work->bias.needs & SHB_NEEDS_OCCLUDERS)
        result = create_map(work, info->width);
    else if (!result)
        result = shb_map_wrap(context, &desc, depth.texels, depth.stride, &work->bias, &work->map);
    if (result)
        light_work_destroy(work);
    return result;
}

void light_work_destroy(light_work *work) {
    shb_map_destroy(work->map);
    draw_work_destroy(&work->camera);
    free(work->image.pixels);
    *work = (light_work){0};
}

shb_result light_work_set_bias(light_work *work, const shb_bias *bias) {
    const bool serves_both = keeps_nearest(&work->bias) && keeps_nearest(bias);
    work->bias = *bias;
    work->name = bias->name;
    return serves_both ? SHB_OK : shb_map_draw(work->map, &work->frame->scene->scene, bias, NULL);
}
