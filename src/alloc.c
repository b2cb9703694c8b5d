#include "context.h"

enum { ALIGNMENT = 64 };

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

bool shb_buffer_reserve(const shb_context *context, shb_buffer *buffer, size_t count, size_t size) {
    if (size && count > SIZE_MAX / size) {
        shb_free(context, buffer->data);
        *buffer = (shb_buffer){NULL, 0};
        return false;
    }
    if (buffer->data && count * size <= buffer->size)
        return true;
    shb_free(context, buffer->data);
    buffer->data = shb_alloc(context, count, size);
    buffer->size = buffer->data ? count * size : 0;
    return buffer->data != NULL;
}
