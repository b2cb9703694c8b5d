/* PNG files, for images that a browser shows. */
#ifndef EXAMPLES_PNG_H
#define EXAMPLES_PNG_H

#include "bytes.h"

typedef enum png_format {
    PNG_BITS, /* one byte a pixel: black if 0, else white; one bit a pixel in the file */
    PNG_GREY, /* one byte a pixel */
    PNG_RGB   /* three bytes a pixel */
} png_format;

/* Top row first. stride in bytes; 0: rows without gaps. */
typedef struct png_image {
    const uint8_t *pixels;
    uint32_t width, height;
    size_t stride;
    png_format format;
} png_image;

/* Appends a whole file; false: out of memory, or an image without pixels. */
bool png_encode(const png_image *image, bytes *out);

/* Writes a file; false: as above, or the file cannot be written, and is removed then. */
bool png_write(const png_image *image, const char *path);

/* The checksum of a chunk: of its type and data. */
uint32_t png_crc32(const uint8_t *data, size_t size);

#endif
