#include "page_images.h"

#include "pictures.h"
#include "text_file.h"

#include <stdlib.h>
#include <string.h>

void report_write_base64(FILE *stream, const uint8_t *data, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        const size_t rest = size - i;
        const uint32_t three = (uint32_t)data[i] << 16 |
                               (uint32_t)(rest > 1 ? data[i + 1] : 0) << 8 |
                               (rest > 2 ? data[i + 2] : 0);
        fputc(digits[three >> 18], stream);
        fputc(digits[three >> 12 & 63], stream);
        fputc(rest > 1 ? digits[three >> 6 & 63] : '=', stream);
        fputc(rest > 2 ? digits[three & 63] : '=', stream);
    }
}

static void write_image(FILE *stream, const char *directory, report_picture kind,
                        const report_row *row, bool *first) {
    char name[320], path[REPORT_PICTURE_PATH], error[256];
    size_t size;
    report_picture_name(name, sizeof name, kind, row);
    if (snprintf(path, sizeof path, "%s/%s.png", directory, name) >= (int)sizeof path)
        return;
    char *data = text_file_read(path, &size, error, sizeof error);
    if (!data)
        return;
    fprintf(stream, "%s\"%s\":\"", *first ? "" : ",\n", name);
    report_write_base64(stream, (const uint8_t *)data, size);
    fputc('"', stream);
    free(data);
    *first = false;
}

/* True if an earlier row shares scene and light, and the map size unless any. */
static bool is_repeated(const report_rows *rows, size_t number, bool any_size) {
    const report_row *row = &rows->rows[number];
    for (size_t i = 0; i < number; i++) {
        const report_row *other = &rows->rows[i];
        if (strcmp(other->scene, row->scene) == 0 && strcmp(other->light, row->light) == 0 &&
            (any_size || other->map_size == row->map_size))
            return true;
    }
    return false;
}

void report_page_images(FILE *stream, const report_rows *rows, const char *directory) {
    bool first = true;
    fputs("{", stream);
    for (size_t i = 0; i < rows->count; i++) {
        const report_row *row = &rows->rows[i];
        if (!is_repeated(rows, i, true)) {
            write_image(stream, directory, REPORT_PICTURE_LIT, row, &first);
            write_image(stream, directory, REPORT_PICTURE_DARK, row, &first);
        }
        if (!is_repeated(rows, i, false))
            write_image(stream, directory, REPORT_PICTURE_TRUTH, row, &first);
        write_image(stream, directory, REPORT_PICTURE_METHOD, row, &first);
    }
    fputs("}\n", stream);
}
