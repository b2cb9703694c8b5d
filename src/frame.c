#include "frame.h"

#include "context.h"
#include "scene.h"

static shb_result check_ids(const shb_context *context, const char *caller,
                            const shb_frame *frame) {
    const size_t row_size = frame->width * sizeof *frame->ids;
    if ((uintptr_t)frame->ids % sizeof *frame->ids)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: desc.frame.ids is not aligned", caller);
    if (frame->id_stride % sizeof *frame->ids || (frame->id_stride && frame->id_stride < row_size))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: desc.frame.id_stride %zu is not a multiple of 4 or below %zu", caller,
                        frame->id_stride, row_size);
    if (frame->id_stride > PTRDIFF_MAX / frame->height)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: desc.frame.id_stride %zu times desc.frame.height %u overflows", caller,
                        frame->id_stride, (unsigned)frame->height);
    return SHB_OK;
}

shb_result shb_frame_check(const shb_context *context, const char *caller, const shb_frame *frame) {
    if (!frame->view || !frame->scene || !frame->ids)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: desc.frame.%s is NULL", caller,
                        !frame->view    ? "view"
                        : !frame->scene ? "scene"
                                        : "ids");
    if (frame->width == 0 || frame->width > SHB_SIZE_MAX || frame->height == 0 ||
        frame->height > SHB_SIZE_MAX)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: desc.frame.width %u or height %u is not in 1 .. %d", caller,
                        (unsigned)frame->width, (unsigned)frame->height, SHB_SIZE_MAX);
    const shb_result result = check_ids(context, caller, frame);
    if (result != SHB_OK)
        return result;
    return shb_scene_check(context, caller, "desc.frame.scene", frame->scene);
}
