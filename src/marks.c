#include "strict.h"

#include "marks.h"

#include "kernels/raster.h"

#include <string.h>

/* What the images are, before the cells. */
enum { HEAD_WORDS = 11 };

static size_t count_cells(uint32_t width, uint32_t height) {
    return shb_marks_stride(width) * shb_marks_stride(height);
}

size_t shb_marks_stride(uint32_t width) {
    return (width + SHB_CELL - 1) / SHB_CELL;
}

size_t shb_clear_marks_size(uint32_t width, uint32_t height) {
    if (width < 1 || width > SHB_SIZE_MAX || height < 1 || height > SHB_SIZE_MAX)
        return 0;
    return HEAD_WORDS * sizeof(uint64_t) + count_cells(width, height);
}

uint8_t *shb_marks_open(const shb_draw_desc *desc) {
    if (!desc->clear_marks)
        return NULL;
    const uint64_t head[HEAD_WORDS] = {
        desc->width,
        desc->height,
        desc->view->reversed,
        (uintptr_t)desc->depth.texels,
        desc->depth.stride,
        (uint64_t)desc->depth.format,
        (uintptr_t)desc->second.texels,
        desc->second.stride,
        (uint64_t)desc->second.format,
        (uintptr_t)desc->ids,
        desc->id_stride,
    };
    uint8_t *const marks = (uint8_t *)desc->clear_marks + sizeof head;
    if (memcmp(desc->clear_marks, head, sizeof head) != 0)
        shb_marks_forget(marks, desc->width, desc->height);
    memcpy(desc->clear_marks, head, sizeof head);
    return marks;
}

void shb_marks_forget(uint8_t *marks, uint32_t width, uint32_t height) {
    if (marks)
        memset(marks, 0, count_cells(width, height));
}
