#include "shadowbias/image.h"

#include <stdio.h>
#include <sys/stat.h>

static bool write_rows(const shb_image *image, size_t stride, FILE *file) {
    const size_t row_size = 3 * (size_t)image->width;
    if (fprintf(file, "P6\n%lu %lu\n255\n", (unsigned long)image->width,
                (unsigned long)image->height) < 0)
        return false;
    for (size_t row = 0; row < image->height; row++)
        if (fwrite(image->pixels + row * stride, 1, row_size, file) != row_size)
            return false;
    return true;
}

/* A path may name a device or a pipe: those stay. */
static void remove_file(const char *path) {
    struct stat status;
    if (stat(path, &status) == 0 && S_ISREG(status.st_mode))
        remove(path);
}

shb_result shb_image_write_ppm(const shb_image *image, const char *path) {
    if (!image || !image->pixels || !path)
        return SHB_ERROR_ARGUMENT;
    if (image->width == 0 || image->height == 0)
        return SHB_ERROR_SIZE;
    const size_t row_size = 3 * (size_t)image->width;
    const size_t stride = image->stride ? image->stride : row_size;
    if (stride < row_size)
        return SHB_ERROR_ARGUMENT;
    if (stride > PTRDIFF_MAX / image->height)
        return SHB_ERROR_SIZE;
    FILE *file = fopen(path, "wb");
    if (!file)
        return SHB_ERROR_FILE;
    const bool written = write_rows(image, stride, file);
    if (fclose(file) == 0 && written)
        return SHB_OK;
    remove_file(path);
    return SHB_ERROR_FILE;
}
