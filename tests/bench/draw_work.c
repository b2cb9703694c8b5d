#include "draw_work.h"

#include <stdlib.h>

static shb_result run(void *state) {
    draw_work *work = state;
    return shb_draw(work->context, &work->desc, NULL);
}

bench_work draw_work_of(draw_work *work) {
    work->desc.view = &work->view;
    return (bench_work){run, work};
}

double draw_work_pixel_bytes(draw_images images) {
    return images == DRAW_DEPTH || images == DRAW_IDS ? 4 : 8;
}

shb_result draw_work_create(shb_context *context, const shb_scene *scene, const shb_view *view,
                            uint32_t width, uint32_t height, draw_images images, draw_work *work) {
    const size_t stride = ((size_t)width * 4 + 63) / 64 * 64 + 64;
    *work = (draw_work){.context = context,
                        .view = *view,
                        .desc = {.scene = scene, .width = width, .height = height}};
    void *const first = aligned_alloc(64, stride * height);
    void *const other =
        draw_work_pixel_bytes(images) > 4 ? aligned_alloc(64, stride * height) : NULL;
    if (images == DRAW_IDS)
        work->desc.ids = first;
    else
        work->desc.depth = (shb_depth_image){.texels = first, .stride = stride};
    if (images == DRAW_DEPTH_IDS)
        work->desc.ids = other;
    if (images == DRAW_DEPTH_SECOND)
        work->desc.second = (shb_depth_image){.texels = other, .stride = stride};
    work->desc.id_stride = stride;
    work->desc.clear_marks_size = shb_clear_marks_size(width, height);
    work->desc.clear_marks = calloc(1, work->desc.clear_marks_size);
    if (work->desc.clear_marks && first && (other || draw_work_pixel_bytes(images) <= 4))
        return SHB_OK;
    draw_work_destroy(work);
    return SHB_ERROR_MEMORY;
}

void draw_work_destroy(draw_work *work) {
    free(work->desc.depth.texels);
    free(work->desc.second.texels);
    free(work->desc.ids);
    free(work->desc.clear_marks);
    *work = (draw_work){0};
}
