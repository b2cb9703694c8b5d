#include "pictures.h"

#include "png.h"
#include "summary.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void report_pictures_begin(const char *path, bool keep) {
    mkdir(path, 0777);
    DIR *directory = keep ? NULL : opendir(path);
    if (!directory)
        return;
    for (const struct dirent *entry; (entry = readdir(directory));) {
        char picture[REPORT_PICTURE_PATH];
        const char *ending = strrchr(entry->d_name, '.');
        if (ending && strcmp(ending, ".png") == 0 &&
            snprintf(picture, sizeof picture, "%s/%s", path, entry->d_name) < (int)sizeof picture)
            remove(picture);
    }
    closedir(directory);
}

/* The grey of a pixel's truth, SHB_TRUTH_*: what does not count is black, what is lit is brighter
 * than 150, and what lies at a boundary is 200 or 48. */
static uint8_t truth_grey(uint8_t truth) {
    switch (truth) {
    case SHB_TRUTH_LIT:
        return 255;
    case SHB_TRUTH_SHADOWED:
        return 96;
    case SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY:
        return 200;
    case SHB_TRUTH_SHADOWED | SHB_TRUTH_BOUNDARY:
        return 48;
    default:
        return 0;
    }
}

void report_picture_name(char *name, size_t size, report_picture kind, const report_row *row) {
    const int kind_length = (int)strcspn(row->light, "-");
    switch (kind) {
    case REPORT_PICTURE_LIT:
        snprintf(name, size, "%s-%.*s-lit", row->scene, kind_length, row->light);
        break;
    case REPORT_PICTURE_DARK:
        snprintf(name, size, "%s-%.*s-dark", row->scene, kind_length, row->light);
        break;
    case REPORT_PICTURE_TRUTH:
        if (report_is_hard(row))
            snprintf(name, size, "%s-%s-%u-truth", row->scene, row->light, (unsigned)row->map_size);
        else
            snprintf(name, size, "%s-%s-truth", row->scene, row->light);
        break;
    case REPORT_PICTURE_METHOD:
        snprintf(name, size, "%s-%s-%u-%s-%s", row->scene, row->light, (unsigned)row->map_size,
                 row->filter, row->method);
        break;
    }
}

static shb_result write_picture(const char *directory, report_picture kind, const report_row *row,
                                const png_image *image) {
    char name[320], path[REPORT_PICTURE_PATH];
    report_picture_name(name, sizeof name, kind, row);
    if (snprintf(path, sizeof path, "%s/%s.png", directory, name) >= (int)sizeof path)
        return SHB_ERROR_FILE;
    return png_write(image, path) ? SHB_OK : SHB_ERROR_FILE;
}

shb_result report_picture_extremes(const char *directory, const report_row *row,
                                   const measure_frame *frame, const shb_map *map,
                                   const float light_color[3], const shb_image *image) {
    const shb_bias none = shb_bias_none();
    const shb_filter filters[2] = {measure_even_filter(1), measure_even_filter(0)};
    const png_image picture = {image->pixels, image->width, image->height, image->stride, PNG_RGB};
    shb_result result = SHB_OK;
    for (int i = 0; !result && i < 2; i++) {
        result = measure_paint(frame, map, &none, &filters[i], light_color, image);
        if (!result)
            result = write_picture(directory, i == 0 ? REPORT_PICTURE_LIT : REPORT_PICTURE_DARK,
                                   row, &picture);
    }
    return result;
}

/* Writes greys, one a pixel, and releases them. */
static shb_result write_greys(const char *directory, report_picture kind, const report_row *row,
                              const measure_frame *frame, uint8_t *greys, png_format format) {
    const png_image picture = {greys, frame->frame.width, frame->frame.height, 0, format};
    const shb_result result = write_picture(directory, kind, row, &picture);
    free(greys);
    return result;
}

static uint8_t *black(const measure_frame *frame) {
    return calloc((size_t)frame->frame.width * frame->frame.height, 1);
}

shb_result report_picture_truth(const char *directory, const report_row *row,
                                const measure_frame *frame, const uint8_t *truth) {
    uint8_t *greys = black(frame);
    if (!greys)
        return SHB_ERROR_MEMORY;
    for (size_t i = 0; i < frame->fragment_count; i++)
        greys[frame->pixels[i]] = truth_grey(truth[frame->pixels[i]]);
    return write_greys(directory, REPORT_PICTURE_TRUTH, row, frame, greys, PNG_GREY);
}

shb_result report_picture_soft_truth(const char *directory, const report_row *row,
                                     const measure_frame *frame, const soft_truth *truth) {
    uint8_t *greys = black(frame);
    if (!greys)
        return SHB_ERROR_MEMORY;
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const size_t pixel = frame->pixels[i];
        if (truth->mask[pixel])
            greys[pixel] = (uint8_t)(1.5f + 254 * truth->visibility[pixel]);
    }
    return write_greys(directory, REPORT_PICTURE_TRUTH, row, frame, greys, PNG_GREY);
}

/* 17 greys: files stay small. */
static uint8_t soft_grey(float visibility) {
    return (uint8_t)(255 * floorf(16 * visibility + 0.5f) / 16 + 0.5f);
}

shb_result report_picture_visibility(const char *directory, const report_row *row,
                                     const measure_frame *frame) {
    const bool hard = report_is_hard(row);
    uint8_t *greys = black(frame);
    if (!greys)
        return SHB_ERROR_MEMORY;
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const float visibility = frame->visibility[i];
        greys[frame->pixels[i]] = hard ? visibility >= 0.5f : soft_grey(visibility);
    }
    return write_greys(directory, REPORT_PICTURE_METHOD, row, frame, greys,
                       hard ? PNG_BITS : PNG_GREY);
}
