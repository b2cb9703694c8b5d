/* 8-bit RGB images and PPM files. */
#ifndef SHADOWBIAS_IMAGE_H
#define SHADOWBIAS_IMAGE_H

#include "shadowbias/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Top row first, 3 bytes a pixel: red, green, blue. stride in bytes; 0: 3 * width. */
typedef struct shb_image {
    uint8_t *pixels;
    uint32_t width, height;
    size_t stride;
} shb_image;

/* Writes a binary PPM (P6). SHB_ERROR_ARGUMENT for NULL or a stride below 3 * width, SHB_ERROR_SIZE
 * for a width or height of 0 or a stride that overflows, SHB_ERROR_FILE if the file cannot be
 * opened or written; a file that was written in part is removed. */
shb_result shb_image_write_ppm(const shb_image *image, const char *path);

#ifdef __cplusplus
}
#endif

#endif
