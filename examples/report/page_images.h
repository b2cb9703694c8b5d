/* The PNG files of a report inside its page. */
#ifndef REPORT_PAGE_IMAGES_H
#define REPORT_PAGE_IMAGES_H

#include "rows.h"

#include <stdio.h>

/* A JSON object: names of pictures, and the files in base64. */
void report_page_images(FILE *stream, const report_rows *rows, const char *directory);

/* Base64 of RFC 4648. */
void report_write_base64(FILE *stream, const uint8_t *data, size_t size);

#endif
