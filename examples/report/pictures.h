/* Pictures of the results as PNG files: what the page mixes its views from. A picture of a scene is
 * linear in the visibility of its light, so that one fully lit and one without the light are
 * enough, and each method adds no more than its visibility. */
#ifndef REPORT_PICTURES_H
#define REPORT_PICTURES_H

#include "rows.h"
#include "soft.h"

#define REPORT_PICTURE_PATH 512

/* Kinds of pictures, by what they belong to. */
typedef enum report_picture {
    REPORT_PICTURE_LIT,   /* a scene and light, whatever its extent: everything lit */
    REPORT_PICTURE_DARK,  /* the same: everything in shadow */
    REPORT_PICTURE_TRUTH, /* scene and light, hard also map size: the truth of each pixel */
    REPORT_PICTURE_METHOD /* a row: its visibility */
} report_picture;

/* Makes the directory; pictures that are there already stay if keep, and are removed otherwise. */
void report_pictures_begin(const char *path, bool keep);

/* The name of a picture's file without directory and ending. */
void report_picture_name(char *name, size_t size, report_picture kind, const report_row *row);

shb_result report_picture_extremes(const char *directory, const report_row *row,
                                   const measure_frame *frame, const shb_map *map,
                                   const float light_color[3], const shb_image *image);
shb_result report_picture_truth(const char *directory, const report_row *row,
                                const measure_frame *frame, const uint8_t *truth);

/* Visibility in greys from 1 to 255; what does not count is black. */
shb_result report_picture_soft_truth(const char *directory, const report_row *row,
                                     const measure_frame *frame, const soft_truth *truth);

/* The frame's latest visibility, two colours if the row is of a hard filter, else 17 greys. */
shb_result report_picture_visibility(const char *directory, const report_row *row,
                                     const measure_frame *frame);

#endif
