#include "strict.h"

#include "map.h"

#include "format.h"
#include "kernels/shade.h"
#include "lists.h"
#include "occluders.h"
#include "padded_rows.h"
#include "prepare.h"
#include "project.h"
#include "vector.h"

#include <float.h>
#include <string.h>

static double length_of_diagonal(const shb_box *box) {
    return shb_vec3_length(shb_vec3_subtract(box->hi, box->lo));
}

/* The homogeneous world point of normalised coordinates. */
static double unproject(const shb_mat4 *world_from_clip, double x, double y, double z,
                        shb_vec3 *point) {
    const double *m = world_from_clip->m;
    *point =
        (shb_vec3){m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13],
                   m[2] * x + m[6] * y + m[10] * z + m[14]};
    return m[3] * x + m[7] * y + m[11] * z + m[15];
}

/* The diagonal of the box of the view's frustum. Its far end is at half depth when the far plane
 * lies at infinity, where the homogeneous coordinate vanishes. */
static double frustum_scale(const shb_view *view, const shb_mat4 *world_from_clip) {
    const double near_depth = view->reversed ? 1 : 0;
    shb_vec3 point;
    const double near_w = unproject(world_from_clip, 0, 0, near_depth, &point);
    const double far_w = unproject(world_from_clip, 0, 0, 1 - near_depth, &point);
    const double far_depth = far_w > near_w * 0x1p-40 ? 1 - near_depth : 0.5;
    shb_box box = box_empty();
    for (int corner = 0; corner < 8; corner++) {
        const double w = unproject(world_from_clip, corner & 1 ? 1 : -1, corner & 2 ? 1 : -1,
                                   corner & 4 ? far_depth : near_depth, &point);
        box_grow(&box, shb_vec3_scale(point, 1 / w));
    }
    return length_of_diagonal(&box);
}

static shb_result check_desc(const shb_context *context, const char *caller,
                             const shb_map_desc *desc) {
    const uint32_t height = desc->height ? desc->height : desc->width;
    if (!desc->width || desc->width > SHB_SIZE_MAX || height > SHB_SIZE_MAX)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: desc.width %u or desc.height %u is not in 1 .. %d", caller,
                        (unsigned)desc->width, (unsigned)height, SHB_SIZE_MAX);
    if (!shb_format_size(desc->format))
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: desc.format %d is unknown", caller,
                        (int)desc->format);
    if (!(desc->scene_scale >= 0 && desc->scene_scale <= DBL_MAX))
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "%s: desc.scene_scale %g is negative or not finite", caller,
                        desc->scene_scale);
    if (desc->occluders > SHB_OCCLUDERS_LISTS)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: desc.occluders %d is unknown", caller,
                        (int)desc->occluders);
    if (desc->exact_only && desc->occluders != SHB_OCCLUDERS_LISTS)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: desc.exact_only goes with lists, and desc.occluders is %d", caller,
                        (int)desc->occluders);
    return SHB_OK;
}

/* A map of a checked description, without texels; world_from_clip receives the inverse of its view.
 */
static shb_result make_map(shb_context *context, const char *caller, const shb_map_desc *desc,
                           shb_map **map, shb_mat4 *world_from_clip) {
    shb_map made = {.context = context,
                    .info = {.view = desc->view,
                             .width = desc->width,
                             .height = desc->height ? desc->height : desc->width,
                             .format = desc->format,
                             .scene_scale = desc->scene_scale,
                             .occluders = desc->occluders},
                    .lists_cap = desc->occluder_memory,
                    .classifies = desc->classifies,
                    .exact_only = desc->exact_only,
                    .depth = {.format = desc->format}};
    if (shb_mat4_inverse(desc->view.clip_from_world, world_from_clip) != SHB_OK ||
        shb_view_light_source(&desc->view, &made.info.light) != SHB_OK)
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "%s: desc.view.clip_from_world has no inverse or is not finite", caller);
    if (shb_projection_init(&made.info, &made.projection) != SHB_OK)
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "%s: the depth of desc.view does not grow away from the light with "
                        "desc.view.reversed %d, or the view is degenerate",
                        caller, desc->view.reversed);
    made.rows = shb_light_rows_of(&desc->view, made.info.width, made.info.height);
    made.bounds = shb_light_bounds_of(&made.rows, made.info.width, made.info.height);
    *map = shb_alloc(context, 1, sizeof **map);
    if (!*map)
        return shb_fail(context, SHB_ERROR_MEMORY, "%s: no memory for the map", caller);
    **map = made;
    return SHB_OK;
}

static void fill_far(const shb_map *map) {
    enum { CHUNK = 256 };
    const bool reversed = map->info.view.reversed;
    const uint32_t width = map->info.width;
    const size_t texel_size = shb_format_size(map->info.format);
    shb_format_store_fn *const store = map->context->shade_kernels->store;
    float depths[CHUNK];
    for (int i = 0; i < CHUNK; i++)
        depths[i] = shb_far_depth(reversed);
    for (uint32_t row = 0; row < map->info.height; row++)
        for (uint32_t column = 0; column < width; column += CHUNK)
            store(map->info.format, reversed, width - column < CHUNK ? width - column : CHUNK,
                  depths,
                  (char *)map->depth.texels + row * map->depth.stride + column * texel_size);
}

/* False: out of memory. */
static bool make_depths(shb_map *map) {
    if (map->exact_only)
        return true;
    map->depth.stride = shb_padded_stride(map->info.width, shb_format_size(map->info.format));
    map->info.memory_bytes = shb_map_depth_bytes(map);
    map->depth.texels = shb_alloc(map->context, map->info.height, map->depth.stride);
    map->marks = shb_alloc(map->context, shb_map_marks_size(map), 1);
    if (!map->depth.texels || !map->marks)
        return false;
    fill_far(map);
    memset(map->marks, 0, shb_map_marks_size(map));
    return true;
}

shb_result shb_map_create(shb_context *context, const shb_map_desc *desc, shb_map **map) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    if (!desc || !map)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_map_create: %s is NULL",
                        desc ? "map" : "desc");
    shb_map *made;
    shb_mat4 world_from_clip;
    shb_result result = check_desc(context, "shb_map_create", desc);
    if (result == SHB_OK)
        result = make_map(context, "shb_map_create", desc, &made, &world_from_clip);
    if (result != SHB_OK)
        return result;
    made->owned = true;
    made->empty = true;
    made->measures = desc->scene_scale == 0;
    if (!make_depths(made) || !shb_occluders_create(made)) {
        shb_map_destroy(made);
        return shb_fail(context, SHB_ERROR_MEMORY,
                        "shb_map_create: no memory for desc.width %u by desc.height %u texels",
                        (unsigned)desc->width, (unsigned)desc->height);
    }
    *map = made;
    return SHB_OK;
}

static shb_result check_texels(const shb_context *context, const shb_map_desc *desc,
                               const void *texels, size_t stride) {
    const size_t texel_size = shb_format_size(desc->format);
    const size_t height = desc->height ? desc->height : desc->width;
    if (!texels)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_map_wrap: texels is NULL");
    if ((uintptr_t)texels % texel_size || stride % texel_size)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_map_wrap: texels or stride %zu is not a multiple of the texel's %zu "
                        "bytes",
                        stride, texel_size);
    if (stride && stride < desc->width * texel_size)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_map_wrap: stride %zu is below a row of %u texels", stride,
                        (unsigned)desc->width);
    if (stride > PTRDIFF_MAX / height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_map_wrap: stride %zu times %zu rows overflows", stride, height);
    return SHB_OK;
}

shb_result shb_map_wrap(shb_context *context, const shb_map_desc *desc, const void *texels,
                        size_t stride, const shb_bias *holds, shb_map **map) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    if (!desc || !map)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_map_wrap: %s is NULL",
                        desc ? "map" : "desc");
    shb_result result = check_desc(context, "shb_map_wrap", desc);
    if (result == SHB_OK)
        result = check_texels(context, desc, texels, stride);
    if (result == SHB_OK && desc->occluders)
        result = shb_fail(context, SHB_ERROR_UNSUPPORTED,
                          "shb_map_wrap: desc.occluders %d cannot be known of a host's depths",
                          (int)desc->occluders);
    if (result == SHB_OK && desc->classifies)
        result = shb_fail(context, SHB_ERROR_UNSUPPORTED,
                          "shb_map_wrap: desc.classifies needs more than a host's depths");
    shb_map *made;
    shb_mat4 world_from_clip;
    if (result == SHB_OK)
        result = make_map(context, "shb_map_wrap", desc, &made, &world_from_clip);
    if (result != SHB_OK)
        return result;
    made->depth.texels = (void *)texels; /* never written: the map is not owned */
    made->depth.stride = stride ? stride : desc->width * shb_format_size(desc->format);
    made->info.memory_bytes = made->depth.stride * made->info.height;
    if (desc->scene_scale == 0)
        made->info.scene_scale = frustum_scale(&desc->view, &world_from_clip);
    shb_map_set_method(made, holds);
    *map = made;
    return SHB_OK;
}

void shb_map_set_method(shb_map *map, const shb_bias *bias) {
    static const shb_bias nearest = {0};
    const shb_bias *held = bias ? bias : &nearest;
    map->combine = held->combine;
    map->combine_user = held->user;
    memcpy(map->combine_params, held->params, sizeof map->combine_params);
    map->flipped = (held->needs & SHB_NEEDS_FLIPPED) != 0;
    map->empty = false;
}

void shb_map_destroy(shb_map *map) {
    if (!map)
        return;
    shb_prepared_release(map);
    if (map->owned)
        shb_free(map->context, map->depth.texels);
    shb_free(map->context, map->marks);
    shb_occluders_destroy(map);
    shb_lists_destroy(map->lists);
    shb_free(map->context, map);
}

size_t shb_map_marks_size(const shb_map *map) {
    return shb_clear_marks_size(map->info.width, map->info.height);
}

size_t shb_map_depth_bytes(const shb_map *map) {
    return map->depth.stride * map->info.height + shb_map_marks_size(map);
}

const shb_sheets *shb_map_sheets(const shb_map *map) {
    return map->lists ? &map->lists->sheets : &map->occluders.sheets;
}

const shb_map_info *shb_map_get_info(const shb_map *map) {
    return map ? &map->info : NULL;
}

shb_depth_image shb_map_get_depth(const shb_map *map) {
    return map ? map->depth : (shb_depth_image){0};
}
