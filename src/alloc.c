#ifndef _DEFAULT_SOURCE
#define _DEFAULT_SOURCE /* madvise in a host's -std=c11 build */
#endif

#include "context.h"

#include <stdlib.h>
#include <sys/mman.h>

enum { ALIGNMENT = 64 };

/* What is larger than such a page is asked for in them: then memory that is new takes a fault for
 * each 2 MB instead of each 4 KB, which was most of the time of a first drawing. */
#define LARGE_PAGE ((size_t)1 << 21)

static void *default_alloc(void *user, size_t size, size_t alignment) {
    (void)user;
    const size_t unit = size < LARGE_PAGE ? alignment : LARGE_PAGE;
    if (size > SIZE_MAX - unit)
        return NULL;
    /* aligned_alloc of C11 wants whole multiples. */
    const size_t bytes = (size + unit - 1) & ~(unit - 1);
    void *memory = aligned_alloc(unit, bytes);
#ifdef MADV_HUGEPAGE
    if (memory && unit == LARGE_PAGE)
        madvise(memory, bytes, MADV_HUGEPAGE);
#endif
    return memory;
}

static void default_free(void *user, void *memory) {
    (void)user;
    free(memory);
}

const shb_allocator shb_default_allocator = {default_alloc, default_free, NULL};

void *shb_alloc(const shb_context *context, size_t count, size_t size) {
    if (size && count > SIZE_MAX / size)
        return NULL;
    const size_t bytes = count * size;
    return context->allocator.alloc(context->allocator.user, bytes > 0 ? bytes : 1, ALIGNMENT);
}

void shb_free(const shb_context *context, void *memory) {
    if (memory)
        context->allocator.free(context->allocator.user, memory);
}

void *shb_buffer_reserve(const shb_context *context, shb_buffer *buffer, size_t count,
                         size_t size) {
    const bool overflows = size && count > SIZE_MAX / size;
    if (buffer->data && !overflows && count * size <= buffer->size)
        return buffer->data;
    shb_free(context, buffer->data);
    buffer->data = shb_alloc(context, count, size);
    buffer->size = buffer->data ? count * size : 0;
    return buffer->data;
}

void shb_buffers_move(size_t count, shb_buffer *from, shb_buffer *to) {
    for (size_t i = 0; i < count; i++) {
        to[i] = from[i];
        from[i] = (shb_buffer){NULL, 0};
    }
}

void shb_buffers_free(const shb_context *context, size_t count, shb_buffer *buffers) {
    for (size_t i = 0; i < count; i++) {
        shb_free(context, buffers[i].data);
        buffers[i] = (shb_buffer){NULL, 0};
    }
}

size_t shb_buffers_bytes(size_t count, const shb_buffer *buffers) {
    size_t bytes = 0;
    for (size_t i = 0; i < count; i++)
        bytes += buffers[i].size;
    return bytes;
}
