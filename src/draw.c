#include "strict.h"

#include "draw.h"

#include "chunk_tile.h"
#include "context.h"
#include "marks.h"
#include "matrix.h"
#include "scene.h"
#include "tile.h"

/* 0.25 MB of depths: half of a usual second-level cache with a second layer. */
#define TILE_SIZE 256

static shb_result check_depth_image(const shb_context *context, const shb_draw_desc *desc,
                                    const char *field, const shb_depth_image *image) {
    const size_t size = shb_format_size(image->format);
    if (!image->texels)
        return SHB_OK;
    if (size == 0)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_draw: desc.%s.format %d is unknown",
                        field, (int)image->format);
    if ((uintptr_t)image->texels % size)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_draw: desc.%s.texels is not aligned to its texels of %zu bytes", field,
                        size);
    if (image->stride % size || (image->stride && image->stride < desc->width * size))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_draw: desc.%s.stride %zu is no multiple of %zu or below a row of %zu",
                        field, image->stride, size, desc->width * size);
    if (image->stride > PTRDIFF_MAX / desc->height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_draw: desc.%s.stride %zu times %u rows overflows", field,
                        image->stride, desc->height);
    return SHB_OK;
}

/* Ids are checked like an image of 4-byte texels, under their own name. */
static shb_result check_ids(const shb_context *context, const shb_draw_desc *desc) {
    const size_t row = desc->width * sizeof(uint32_t);
    if (!desc->ids)
        return SHB_OK;
    if ((uintptr_t)desc->ids % sizeof(uint32_t))
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_draw: desc.ids is not aligned");
    if (desc->id_stride % sizeof(uint32_t) || (desc->id_stride && desc->id_stride < row))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_draw: desc.id_stride %zu is no multiple of 4 or below a row of %zu",
                        desc->id_stride, row);
    if (desc->id_stride > PTRDIFF_MAX / desc->height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_draw: desc.id_stride %zu times %u rows overflows", desc->id_stride,
                        desc->height);
    return SHB_OK;
}

static shb_result check_size(const shb_context *context, const char *field, uint32_t size) {
    if (size >= 1 && size <= SHB_SIZE_MAX)
        return SHB_OK;
    return shb_fail(context, SHB_ERROR_SIZE, "shb_draw: desc.%s %u is not 1 .. %d", field, size,
                    SHB_SIZE_MAX);
}

static shb_result check_tile_size(const shb_context *context, uint32_t size) {
    if (size == 0 || (size >= 16 && size <= 512 && (size & (size - 1)) == 0))
        return SHB_OK;
    return shb_fail(context, SHB_ERROR_ARGUMENT,
                    "shb_draw: desc.tile_size %u is not 0 or a power of two from 16 to 512", size);
}

static shb_result check_marks(const shb_context *context, const shb_draw_desc *desc) {
    const size_t size = shb_clear_marks_size(desc->width, desc->height);
    if (!desc->clear_marks || desc->clear_marks_size == size)
        return SHB_OK;
    return shb_fail(context, SHB_ERROR_SIZE, "shb_draw: desc.clear_marks_size %zu is not %zu",
                    desc->clear_marks_size, size);
}

static shb_result check_desc(const shb_context *context, const shb_draw_desc *desc) {
    if (!desc || !desc->view || !desc->scene)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_draw: %s is NULL",
                        !desc         ? "desc"
                        : !desc->view ? "desc.view"
                                      : "desc.scene");
    shb_result result = check_size(context, "width", desc->width);
    if (!result)
        result = check_size(context, "height", desc->height);
    if (!result)
        result = check_depth_image(context, desc, "depth", &desc->depth);
    if (!result)
        result = check_depth_image(context, desc, "second", &desc->second);
    if (!result)
        result = check_ids(context, desc);
    if (!result)
        result = check_tile_size(context, desc->tile_size);
    if (!result)
        result = check_marks(context, desc);
    if (!result && !shb_mat4_is_finite(&desc->view->clip_from_world))
        result = shb_fail(context, SHB_ERROR_NUMBER, "shb_draw: desc.view is not finite");
    return result ? result : shb_scene_check(context, "shb_draw", "desc.scene", desc->scene);
}

static bool draw_chunks(shb_context *context, const shb_draw_desc *desc,
                        const shb_geometry *geometry, const shb_target *target,
                        shb_draw_stats *stats) {
    shb_chunks chunks;
    return shb_chunks_prepare(context, geometry, target, &chunks) &&
           shb_chunk_tiles_draw(context, desc, geometry, target, &chunks, stats);
}

static bool draw_scalar(shb_context *context, const shb_draw_desc *desc,
                        const shb_geometry *geometry, const shb_target *target,
                        shb_draw_stats *stats) {
    const uint32_t tile_size = desc->tile_size ? desc->tile_size : TILE_SIZE;
    shb_bins bins;
    shb_draw_stats unwanted;
    return shb_bin_triangles(context, geometry, target, tile_size, &bins,
                             stats ? stats : &unwanted) &&
           shb_tiles_draw(context, desc, geometry, target, &bins);
}

shb_result shb_draw_for_map(shb_context *context, const shb_draw_desc *desc,
                            const shb_plane_finder *planes, const shb_bias *combines,
                            shb_draw_stats *stats) {
    if (!context)
        return SHB_ERROR_ARGUMENT;
    const shb_result result = check_desc(context, desc);
    if (result)
        return result;
    shb_target target = shb_target_of(desc->width, desc->height, desc->view->reversed);
    target.planes = planes;
    target.combines = combines;
    target.marks = shb_marks_open(desc);
    if (!context->kernels)
        shb_marks_forget(target.marks, desc->width, desc->height);
    shb_geometry geometry = {0};
    shb_draw_stats counted;
    if (!shb_geometry_prepare(context, desc, &target, &geometry) ||
        !(context->kernels ? draw_chunks : draw_scalar)(context, desc, &geometry, &target,
                                                        stats ? &counted : NULL))
        return shb_fail(
            context, SHB_ERROR_MEMORY, "shb_draw: no memory for %llu triangles and %llu vertices",
            (unsigned long long)geometry.triangle_count, (unsigned long long)geometry.vertex_count);
    if (stats)
        *stats = counted;
    return SHB_OK;
}

shb_result shb_draw(shb_context *context, const shb_draw_desc *desc, shb_draw_stats *stats) {
    return shb_draw_for_map(context, desc, NULL, NULL, stats);
}
