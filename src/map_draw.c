/* Drawing a map. */
#ifndef _POSIX_C_SOURCE
#define _POSIX_C_SOURCE 200809L /* clock_gettime in a host's -std=c11 build */
#endif

#include "strict.h"

#include "map.h"

#include <time.h>

#include "draw.h"
#include "lists.h"
#include "occluder_planes.h"
#include "occluders.h"
#include "prepare.h"
#include "scene.h"

static shb_result check_draw(const shb_map *map, const shb_scene *scene, const shb_bias *bias) {
    if (!map->owned)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "shb_map_draw: map wraps an array of the host");
    if (map->exact_only && bias && !(bias->needs & SHB_NEEDS_OCCLUDERS))
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "shb_map_draw: map keeps no depths, as desc.exact_only says");
    return shb_scene_check(map->context, "shb_map_draw", "scene", scene);
}

/* What a drawing makes before the map takes it. */
typedef struct drawing {
    bool keeps;        /* occluders of any kind */
    bool keeps_texels; /* the map's own array of them */
    bool keeps_lists;
    bool prepares; /* occluders, for texels or sheets */
    double scene_scale;
    shb_occluder_data occluders;
    shb_lists *lists; /* or NULL */
} drawing;

static drawing plan_drawing(const shb_map *map, const shb_bias *bias) {
    const bool keeps = map->info.occluders && (!bias || bias->needs & SHB_NEEDS_OCCLUDERS);
    const bool has_lists = map->info.occluders == SHB_OCCLUDERS_LISTS;
    const bool keeps_texels = keeps && !has_lists;
    return (drawing){.keeps = keeps,
                     .keeps_texels = keeps_texels,
                     .keeps_lists = has_lists && (keeps || map->classifies),
                     .prepares = keeps_texels || shb_map_keeps_sheets(map),
                     .scene_scale = map->info.scene_scale};
}

static shb_result measure_scene(const shb_map *map, const shb_scene *scene, double *scale) {
    shb_box box;
    if (!map->measures)
        return SHB_OK;
    if (shb_scene_bounds(scene, &box) != SHB_OK)
        return shb_scene_check_indices(map->context, "shb_map_draw", scene);
    *scale = box.lo.x <= box.hi.x ? shb_vec3_length(shb_vec3_subtract(box.hi, box.lo)) : 0;
    return SHB_OK;
}

static shb_result prepare_lists(const shb_map *map, const shb_scene *scene, drawing *made) {
    if (!made->keeps_lists)
        return SHB_OK;
    const shb_lists_desc desc = {.caller = "shb_map_draw",
                                 .scene = scene,
                                 .view = &map->info.view,
                                 .width = map->info.width,
                                 .height = map->info.height,
                                 .memory_cap = map->lists_cap,
                                 .with_sheets = map->classifies};
    return shb_lists_build(map->context, &desc, &made->lists);
}

static shb_result prepare_occluders(const shb_map *map, const shb_scene *scene, drawing *made) {
    if (!made->prepares || shb_occluders_prepare(map, scene, made->keeps_texels, &made->occluders))
        return SHB_OK;
    shb_lists_recycle(made->lists);
    return shb_fail(map->context, SHB_ERROR_MEMORY,
                    "shb_map_draw: no memory for the occluders of %llu triangles",
                    (unsigned long long)shb_scene_triangle_count(scene));
}

/* If it fails, nothing is left to release. */
static shb_result prepare_drawing(const shb_map *map, const shb_scene *scene, drawing *made) {
    shb_result result = measure_scene(map, scene, &made->scene_scale);
    if (result == SHB_OK)
        result = prepare_lists(map, scene, made);
    if (result == SHB_OK)
        result = prepare_occluders(map, scene, made);
    return result;
}

static shb_result draw_images(const shb_map *map, const shb_scene *scene, const shb_bias *bias,
                              const drawing *made, shb_draw_stats *stats) {
    if (map->exact_only) {
        if (stats)
            *stats = (shb_draw_stats){.triangles = shb_scene_triangle_count(scene)};
        return SHB_OK;
    }
    shb_draw_desc desc = {.view = &map->info.view,
                          .scene = scene,
                          .width = map->info.width,
                          .height = map->info.height,
                          .depth = map->depth,
                          .clear_marks = map->marks,
                          .clear_marks_size = shb_map_marks_size(map),
                          .flip_culling = bias && (bias->needs & SHB_NEEDS_FLIPPED)};
    if (made->keeps_texels) {
        desc.ids = made->occluders.texels;
        desc.id_stride = made->occluders.stride;
    }
    const bool draws_planes = made->keeps_texels && map->info.occluders == SHB_OCCLUDERS_PLANES;
    const shb_drawn_planes planes = shb_drawn_planes_of(map);
    return shb_draw_for_map(map->context, &desc, draws_planes ? &planes.finder : NULL,
                            bias && bias->combine ? bias : NULL, stats);
}

static void release_drawing(const shb_map *map, drawing *made) {
    if (made->prepares)
        shb_occluders_release(map, &made->occluders);
    shb_lists_recycle(made->lists);
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

static void take_drawing(shb_map *map, const shb_bias *bias, const drawing *made) {
    set_lists(map, NULL);
    shb_prepared_outdate(map);
    if (made->prepares)
        shb_occluders_finish(map, made->keeps_texels, &made->occluders);
    set_lists(map, made->lists);
    map->occluders.held = made->keeps;
    map->info.scene_scale = made->scene_scale;
    shb_map_set_method(map, bias);
}

static shb_result draw_map(shb_map *map, const shb_scene *scene, const shb_bias *bias,
                           shb_draw_stats *stats) {
    shb_result result = check_draw(map, scene, bias);
    if (result != SHB_OK)
        return result;
    drawing made = plan_drawing(map, bias);
    result = prepare_drawing(map, scene, &made);
    if (result != SHB_OK)
        return result;
    result = draw_images(map, scene, bias, &made, stats);
    if (result == SHB_OK)
        take_drawing(map, bias, &made);
    else
        release_drawing(map, &made);
    return result;
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
