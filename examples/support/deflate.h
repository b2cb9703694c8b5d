/* Compressed data as PNG takes it: a zlib stream (RFC 1950) around one deflate block (RFC 1951). */
#ifndef EXAMPLES_DEFLATE_H
#define EXAMPLES_DEFLATE_H

#include "bytes.h"

/* Appends the stream: repetitions found through a hash of three bytes, codes of fixed length. */
void deflate_zlib(const uint8_t *data, size_t size, bytes *out);

/* The checksum of a zlib stream. */
uint32_t deflate_adler32(const uint8_t *data, size_t size);

#endif
