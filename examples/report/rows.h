/* The results: one row for each scene, light, map size, method and filter. */
#ifndef REPORT_ROWS_H
#define REPORT_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct report_row {
    char scene[64], light[24], filter[64], method[64];
    uint32_t map_size; /* texels */
    uint64_t triangles, fragments;
    double map_ms;          /* drawing the map, and what the filter makes of it; all threads */
    double shading_ms;      /* the whole picture, shadows included; all threads */
    double ns_per_fragment; /* visibility alone, one thread */
    uint64_t memory_bytes;  /* of the map */
    /* Hard: wrong fragments per million. Away from boundaries, of the lit and of the shadowed; at
     * boundaries and in all, of all. Soft: the same of light instead of fragments; boundaries are
     * penumbras. */
    double false_shadow_ppm, false_light_ppm, boundary_ppm, wrong_ppm;
    double rms, ssim;         /* of visibility, structural similarity; NaN: hard */
    double detachment_texels; /* NaN: the scene has no place to measure it */
    char settings[192];       /* rows with other settings are not comparable */
} report_row;

/* Zero-initialised is empty. */
typedef struct report_rows {
    report_row *rows;
    size_t count, capacity;
} report_rows;

/* False: out of memory. */
bool report_rows_add(report_rows *rows, const report_row *row);
void report_rows_free(report_rows *rows);

/* The row of a scene, light, size, filter and method; NULL: none. */
const report_row *report_rows_find(const report_rows *rows, const report_row *key);

/* The file: tab-separated below a line of names. Appending writes that line if the file is new or
 * empty. Replacing leaves the old file as it is until the new one is whole. Reading skips lines
 * that are not complete, as a run that was stopped may leave one, and rows of other settings; a
 * file that is not there has no rows. False: out of memory, or the file cannot be written. */
bool report_rows_append(const report_row *rows, size_t count, const char *path);
bool report_rows_replace(const report_rows *rows, const char *path);
bool report_rows_read(report_rows *rows, const char *settings, const char *path);

/* What a picture takes: drawing the map and shading with it. */
double report_row_ms(const report_row *row);

#endif
