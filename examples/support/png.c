#include "png.h"

#include "deflate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Filters of rows: what is taken off a byte. */
typedef enum png_filter {
    FILTER_NONE,
    FILTER_LEFT,
    FILTER_UP,
    FILTER_MEAN,
    FILTER_PAETH
} png_filter;

typedef struct png_row {
    const uint8_t *bytes, *above; /* above: the row before, zeros for the first */
    size_t size, step;            /* step: bytes from a pixel to the next */
} png_row;

uint32_t png_crc32(const uint8_t *data, size_t size) {
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    return ~crc;
}

static void append_chunk(bytes *out, const char *type, const uint8_t *data, size_t size) {
    bytes_append_big_endian(out, (uint32_t)size);
    const size_t begin = out->size;
    bytes_append(out, type, 4);
    bytes_append(out, data, size);
    if (!out->failed)
        bytes_append_big_endian(out, png_crc32(out->data + begin, out->size - begin));
}

static void append_header(bytes *out, const png_image *image) {
    bytes header = {0};
    const uint8_t kind[5] = {image->format == PNG_BITS ? 1 : 8, image->format == PNG_RGB ? 2 : 0};
    bytes_append_big_endian(&header, image->width);
    bytes_append_big_endian(&header, image->height);
    bytes_append(&header, kind, sizeof kind); /* no other compression, filter or interlacing */
    out->failed |= header.failed;
    append_chunk(out, "IHDR", header.data, header.size);
    bytes_free(&header);
}

/* Of left, up and corner the one that is nearest to left + up - corner. */
static int paeth(int left, int up, int corner) {
    const int estimate = left + up - corner;
    const int to_left = abs(estimate - left), to_up = abs(estimate - up);
    const int to_corner = abs(estimate - corner);
    if (to_left <= to_up && to_left <= to_corner)
        return left;
    return to_up <= to_corner ? up : corner;
}

static uint8_t filtered(const png_row *row, png_filter filter, size_t i) {
    const int left = i >= row->step ? row->bytes[i - row->step] : 0;
    const int corner = i >= row->step ? row->above[i - row->step] : 0;
    const int up = row->above[i];
    switch (filter) {
    case FILTER_LEFT:
        return (uint8_t)(row->bytes[i] - left);
    case FILTER_UP:
        return (uint8_t)(row->bytes[i] - up);
    case FILTER_PAETH:
        return (uint8_t)(row->bytes[i] - paeth(left, up, corner));
    case FILTER_MEAN:
    case FILTER_NONE:
        break;
    }
    return row->bytes[i];
}

/* How large a row is after a filter, as signed bytes: the usual guess at its compressed size. */
static uint64_t weight_of(const png_row *row, png_filter filter) {
    uint64_t weight = 0;
    for (size_t i = 0; i < row->size; i++)
        weight += (uint64_t)abs((int8_t)filtered(row, filter, i));
    return weight;
}

static void append_row(bytes *out, const png_row *row, bool filters) {
    static const png_filter choices[] = {FILTER_NONE, FILTER_LEFT, FILTER_UP, FILTER_PAETH};
    png_filter best = FILTER_NONE;
    for (size_t i = 1; filters && i < sizeof choices / sizeof *choices; i++)
        if (weight_of(row, choices[i]) < weight_of(row, best))
            best = choices[i];
    bytes_append_byte(out, (uint8_t)best);
    for (size_t i = 0; i < row->size; i++)
        bytes_append_byte(out, filtered(row, best, i));
}

/* A row as the file holds it, before filters. */
static void pack_row(const png_image *image, const uint8_t *pixels, uint8_t *row, size_t size) {
    if (image->format != PNG_BITS) {
        memcpy(row, pixels, size);
        return;
    }
    memset(row, 0, size);
    for (uint32_t x = 0; x < image->width; x++)
        if (pixels[x])
            row[x / 8] |= (uint8_t)(0x80 >> x % 8);
}

/* All rows, each behind the number of its filter. */
static void append_rows(bytes *out, const png_image *image) {
    const size_t step = image->format == PNG_RGB ? 3 : 1;
    const size_t size =
        image->format == PNG_BITS ? ((size_t)image->width + 7) / 8 : step * image->width;
    const size_t stride = image->stride ? image->stride : step * image->width;
    uint8_t *rows[2] = {calloc(size, 1), calloc(size, 1)};
    out->failed |= !rows[0] || !rows[1];
    for (uint32_t y = 0; !out->failed && y < image->height; y++) {
        pack_row(image, image->pixels + y * stride, rows[y % 2], size);
        const png_row row = {rows[y % 2], rows[(y + 1) % 2], size, step};
        append_row(out, &row, image->format != PNG_BITS);
    }
    free(rows[0]);
    free(rows[1]);
}

bool png_encode(const png_image *image, bytes *out) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    if (!image->pixels || image->width == 0 || image->height == 0)
        return false;
    bytes rows = {0}, compressed = {0};
    append_rows(&rows, image);
    if (!rows.failed)
        deflate_zlib(rows.data, rows.size, &compressed);
    out->failed |= rows.failed || compressed.failed;
    bytes_append(out, signature, sizeof signature);
    append_header(out, image);
    append_chunk(out, "IDAT", compressed.data, compressed.size);
    append_chunk(out, "IEND", NULL, 0);
    bytes_free(&rows);
    bytes_free(&compressed);
    return !out->failed;
}

bool png_write(const png_image *image, const char *path) {
    bytes file = {0};
    FILE *stream = png_encode(image, &file) ? fopen(path, "wb") : NULL;
    bool done = false;
    if (stream) {
        done = fwrite(file.data, 1, file.size, stream) == file.size;
        done &= fclose(stream) == 0;
        if (!done)
            remove(path);
    }
    bytes_free(&file);
    return done;
}
