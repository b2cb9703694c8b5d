/* Bytes that grow. */
#ifndef EXAMPLES_BYTES_H
#define EXAMPLES_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Zero-initialised is empty. */
typedef struct bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed; /* memory ran out: bytes are missing */
} bytes;

void bytes_append(bytes *buffer, const void *data, size_t size);
void bytes_append_byte(bytes *buffer, uint8_t value);

/* A 32-bit number, the most significant byte first. */
void bytes_append_big_endian(bytes *buffer, uint32_t value);

/* Leaves an empty buffer. */
void bytes_free(bytes *buffer);

#endif
