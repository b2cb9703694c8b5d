/* Drawing a map: the nearest layer straight into it, or two layers combined row by row. */
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L /* clock_gettime in a host's -std=c11 build */
#endif

#include "strict.h"

#include "map.h"

#include <time.h>

#include "draw.h"
#include "format.h"
#include "lists.h"
#include "occluder_planes.h"
#include "occluders.h"
#include "prepare.h"
#include "scene.h"

/* Where the two layers are drawn before they are combined: one row after the other, no gaps. */
typedef struct layers {
    float *nearest;
    float *second;
} layers;

static bool reserve_layers(const shb_map *map, layers *out) {
    shb_context *context = map->context;
    const size_t row_bytes = map->info.width * sizeof(float);
    if (!shb_buffer_reserve(context, &context->map_scratch[0], map->info.height, row_bytes) ||
        !shb_buffer_reserve(context, &context->map_scratch[1], map->info.height, row_bytes))
        return false;
    *out = (layers){context->map_scratch[0].data, context->map_scratch[1].data};
    return true;
}

/* The depths of a reversed view to canonical ones. */
static void change_sign(size_t count, float *depths) {
    for (size_t i = 0; i < count; i++)
        depths[i] = -depths[i];
}

static void replace_nan(size_t count, float value, float *depths) {
    for (size_t i = 0; i < count; i++)
        depths[i] = depths[i] == depths[i] ? depths[i] : value;
}

static void combine_rows(shb_map *map, const shb_bias *bias, const layers *drawn) {
    const size_t width = map->info.width;
    memset(map->marks, 0, shb_map_marks_size(map));
    const bool reversed = map->info.view.reversed;
    for (uint32_t row = 0; row < map->info.height; row++) {
        float *nearest = drawn->nearest + row * width;
        float *second = drawn->second + row * width;
        if (reversed) {
            change_sign(width, nearest);
            change_sign(width, second);
        }
        bias->combine(bias, width, nearest, second, nearest);
        replace_nan(width, shb_far_depth(reversed), nearest);
        shb_format_store(map->info.format, reversed, width, nearest,
                         (char *)map->depth.texels + row * map->depth.stride);
    }
}

static shb_result check_draw(const shb_map *map, const shb_scene *scene) {
    if (!map->owned)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "shb_map_draw: map wraps an array of the host");
    if (!scene)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "shb_map_draw: scene is NULL");
    const char *reason;
    const shb_result result = shb_scene_check(scene, &reason);
    if (result != SHB_OK)
        return shb_fail(map->context, result, "shb_map_draw: %s", reason);
    return SHB_OK;
}

static shb_result measure(const shb_scene *scene, double *scale) {
    shb_box box;
    const shb_result result = shb_scene_bounds(scene, &box);
    if (result == SHB_OK)
        *scale = box.lo.x <= box.hi.x ? shb_vec3_length(shb_vec3_subtract(box.hi, box.lo)) : 0;
    return result;
}

static bool keeps_occluders(const shb_map *map, const shb_bias *bias) {
    return map->info.occluders && (!bias || bias->needs & SHB_NEEDS_OCCLUDERS);
}

/* lists NULL: none. */
static void set_lists(shb_map *map, shb_lists *lists) {
    if (map->lists)
        map->info.memory_bytes -= map->lists->memory_bytes;
    shb_lists_recycle(map->lists);
    map->lists = lists;
    if (lists)
        map->info.memory_bytes += lists->memory_bytes;
}

static shb_result draw_map(shb_map *map, const shb_scene *scene, const shb_bias *bias,
                           shb_draw_stats *stats) {
    shb_result result = check_draw(map, scene);
    if (result != SHB_OK)
        return result;
    double scene_scale = map->info.scene_scale;
    if (map->measures && (result = measure(scene, &scene_scale)) != SHB_OK)
        return shb_fail(map->context, result,
                        "shb_map_draw: an index of scene is not below its mesh.vertex_count");

    shb_draw_desc desc = {.view = &map->info.view,
                          .scene = scene,
                          .width = map->info.width,
                          .height = map->info.height,
                          .depth = map->depth,
                          .clear_marks = map->marks,
                          .clear_marks_size = shb_map_marks_size(map),
                          .flip_culling = bias && (bias->needs & SHB_NEEDS_FLIPPED)};
    const bool combines = bias && bias->combine;
    layers drawn = {0};
    if (combines) {
        if (!reserve_layers(map, &drawn))
            return shb_fail(map->context, SHB_ERROR_MEMORY,
                            "shb_map_draw: no memory for two layers of %u by %u texels",
                            (unsigned)map->info.width, (unsigned)map->info.height);
        desc.depth = (shb_depth_image){.texels = drawn.nearest};
        desc.second = (shb_depth_image){.texels = drawn.second};
        desc.clear_marks = NULL;
    }
    shb_occluder_data occluders = {0};
    const bool keeps = keeps_occluders(map, bias);
    const bool has_lists = map->info.occluders == SHB_OCCLUDERS_LISTS;
    const bool keeps_lists = has_lists && (keeps || map->classifies);
    const bool keeps_texels = keeps && !has_lists;
    shb_lists *lists = NULL;
    if (keeps_lists) {
        result = shb_lists_build(map->context, "shb_map_draw", &map->info.view, map->info.width,
                                 map->info.height, scene, map->lists_cap, map->classifies, &lists);
        if (result != SHB_OK)
            return result;
    }
    const bool prepares = keeps_texels || shb_map_keeps_sheets(map);
    if (prepares && !shb_occluders_prepare(map, scene, keeps_texels, &occluders)) {
        shb_lists_recycle(lists);
        return shb_fail(map->context, SHB_ERROR_MEMORY,
                        "shb_map_draw: no memory for the occluders of %llu triangles",
                        (unsigned long long)shb_scene_triangle_count(scene));
    }
    if (keeps_texels) {
        desc.ids = occluders.texels;
        desc.id_stride = occluders.stride;
    }
    const bool draws_planes = keeps_texels && map->info.occluders == SHB_OCCLUDERS_PLANES;
    const shb_drawn_planes drawn_planes = shb_drawn_planes_of(map);
    result =
        shb_draw_planes(map->context, &desc, draws_planes ? &drawn_planes.finder : NULL, stats);
    if (result != SHB_OK) {
        if (prepares)
            shb_occluders_release(map, &occluders);
        shb_lists_recycle(lists);
        return result;
    }
    if (combines)
        combine_rows(map, bias, &drawn);
    set_lists(map, NULL);
    shb_prepared_outdate(map);
    if (prepares)
        shb_occluders_finish(map, keeps_texels, &occluders);
    set_lists(map, lists);
    map->occluders.held = keeps;
    map->info.scene_scale = scene_scale;
    shb_map_set_method(map, bias);
    return SHB_OK;
}

static double clock_seconds(void) {
    struct timespec now = {0};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

shb_result shb_map_draw(shb_map *map, const shb_scene *scene, const shb_bias *bias,
                        shb_draw_stats *stats) {
    if (!map)
        return SHB_ERROR_ARGUMENT;
    const double start = clock_seconds();
    const shb_result result = draw_map(map, scene, bias, stats);
    if (result == SHB_OK)
        map->info.draw_seconds = clock_seconds() - start;
    return result;
}
