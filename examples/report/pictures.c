#include "pictures.h"

#include "png.h"
#include "summary.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint8_t report_truth_grey(uint8_t truth) {
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
    switch (kind) {
    case REPORT_PICTURE_LIT:
        snprintf(name, size, "%s-%s-lit", row->scene, row->light);
        break;
    case REPORT_PICTURE_DARK:
        snprintf(name, size, "%s-%s-dark", row->scene, row->light);
        break;
    case REPORT_PICTURE_TRUTH:
        snprintf(name, size, "%s-%s-%u-truth", row->scene, row->light, (unsigned)row->map_size);
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

static void make_lit(const shb_filter_args *args) {
    for (size_t i = 0; i < SHB_BATCH; i++)
        args->visibility[i] = 1;
}

static void make_dark(const shb_filter_args *args) {
    for (size_t i = 0; i < SHB_BATCH; i++)
        args->visibility[i] = 0;
}

shb_result report_picture_extremes(const char *directory, const report_row *row,
                                   const measure_frame *frame, const shb_map *map,
                                   const float light_color[3], const shb_image *image) {
    const shb_bias none = shb_bias_none();
    const shb_filter filters[2] = {{.name = "lit", .filter = make_lit},
                                   {.name = "dark", .filter = make_dark}};
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

shb_result report_picture_truth(const char *directory, const report_row *row,
                                const measure_frame *frame, const uint8_t *truth) {
    const uint32_t width = frame->frame.width, height = frame->frame.height;
    uint8_t *greys = malloc((size_t)width * height);
    if (!greys)
        return SHB_ERROR_MEMORY;
    for (size_t i = 0; i < (size_t)width * height; i++)
        greys[i] = report_truth_grey(truth[i]);
    const png_image picture = {greys, width, height, 0, PNG_GREY};
    const shb_result result = write_picture(directory, REPORT_PICTURE_TRUTH, row, &picture);
    free(greys);
    return result;
}

shb_result report_picture_visibility(const char *directory, const report_row *row,
                                     const measure_frame *frame) {
    const bool soft = !report_is_hard(row);
    const uint32_t width = frame->frame.width, height = frame->frame.height;
    uint8_t *greys = calloc((size_t)width * height, 1);
    if (!greys)
        return SHB_ERROR_MEMORY;
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const float visibility = frame->visibility[i];
        greys[frame->pixels[i]] = soft ? (uint8_t)(255 * visibility + 0.5f) : visibility >= 0.5f;
    }
    const png_image picture = {greys, width, height, 0, soft ? PNG_GREY : PNG_BITS};
    const shb_result result = write_picture(directory, REPORT_PICTURE_METHOD, row, &picture);
    free(greys);
    return result;
}
