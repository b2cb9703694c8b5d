#include "bytes.h"

#include <stdlib.h>
#include <string.h>

static bool reserve(bytes *buffer, size_t size) {
    if (buffer->failed || size > SIZE_MAX / 4 - buffer->size) {
        buffer->failed = true;
        return false;
    }
    if (buffer->size + size <= buffer->capacity)
        return true;
    const size_t capacity = 2 * (buffer->size + size);
    uint8_t *grown = realloc(buffer->data, capacity);
    buffer->failed = !grown;
    if (grown) {
        buffer->data = grown;
        buffer->capacity = capacity;
    }
    return grown != NULL;
}

void bytes_append(bytes *buffer, const void *data, size_t size) {
    if (size == 0 || !reserve(buffer, size))
        return;
    memcpy(buffer->data + buffer->size, data, size);
    buffer->size += size;
}

void bytes_append_byte(bytes *buffer, uint8_t value) {
    bytes_append(buffer, &value, 1);
}

void bytes_append_big_endian(bytes *buffer, uint32_t value) {
    const uint8_t parts[4] = {(uint8_t)(value >> 24), (uint8_t)(value >> 16), (uint8_t)(value >> 8),
                              (uint8_t)value};
    bytes_append(buffer, parts, sizeof parts);
}

void bytes_free(bytes *buffer) {
    free(buffer->data);
    *buffer = (bytes){0};
}
