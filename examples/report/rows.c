#include "rows.h"

#include "text_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum column_kind { COLUMN_TEXT, COLUMN_SIZE, COLUMN_COUNT, COLUMN_NUMBER } column_kind;

typedef struct column {
    const char *name;
    column_kind kind;
    size_t offset, size;
} column;

#define COLUMN(name, kind)                                                                         \
    { #name, kind, offsetof(report_row, name), sizeof(((report_row *)0)->name) }

static const column columns[] = {
    COLUMN(scene, COLUMN_TEXT),
    COLUMN(light, COLUMN_TEXT),
    COLUMN(map_size, COLUMN_SIZE),
    COLUMN(filter, COLUMN_TEXT),
    COLUMN(method, COLUMN_TEXT),
    COLUMN(triangles, COLUMN_COUNT),
    COLUMN(fragments, COLUMN_COUNT),
    COLUMN(map_ms, COLUMN_NUMBER),
    COLUMN(shading_ms, COLUMN_NUMBER),
    COLUMN(ns_per_fragment, COLUMN_NUMBER),
    COLUMN(memory_bytes, COLUMN_COUNT),
    COLUMN(false_shadow_ppm, COLUMN_NUMBER),
    COLUMN(false_light_ppm, COLUMN_NUMBER),
    COLUMN(boundary_ppm, COLUMN_NUMBER),
    COLUMN(wrong_ppm, COLUMN_NUMBER),
    COLUMN(rms, COLUMN_NUMBER),
    COLUMN(ssim, COLUMN_NUMBER),
    COLUMN(detachment_texels, COLUMN_NUMBER),
    COLUMN(settings, COLUMN_TEXT),
};
enum { COLUMNS = sizeof columns / sizeof *columns, LINE_MAX_LENGTH = 1024 };

bool report_rows_add(report_rows *rows, const report_row *row) {
    if (rows->count == rows->capacity) {
        const size_t capacity = rows->capacity ? 2 * rows->capacity : 256;
        report_row *grown = realloc(rows->rows, capacity * sizeof *grown);
        if (!grown)
            return false;
        rows->rows = grown;
        rows->capacity = capacity;
    }
    rows->rows[rows->count++] = *row;
    return true;
}

void report_rows_free(report_rows *rows) {
    free(rows->rows);
    *rows = (report_rows){0};
}

const report_row *report_rows_find(const report_rows *rows, const report_row *key) {
    for (size_t i = 0; i < rows->count; i++) {
        const report_row *row = &rows->rows[i];
        if (row->map_size == key->map_size && strcmp(row->scene, key->scene) == 0 &&
            strcmp(row->light, key->light) == 0 && strcmp(row->filter, key->filter) == 0 &&
            strcmp(row->method, key->method) == 0)
            return row;
    }
    return NULL;
}

static void print_number(FILE *stream, double number) {
    if (isnan(number))
        fputc('-', stream);
    else
        fprintf(stream, "%.6g", number);
}

static void print_value(FILE *stream, const column *c, const report_row *row) {
    const void *value = (const char *)row + c->offset;
    switch (c->kind) {
    case COLUMN_TEXT:
        fputs(value, stream);
        break;
    case COLUMN_SIZE:
        fprintf(stream, "%u", (unsigned)*(const uint32_t *)value);
        break;
    case COLUMN_COUNT:
        fprintf(stream, "%llu", (unsigned long long)*(const uint64_t *)value);
        break;
    case COLUMN_NUMBER:
        print_number(stream, *(const double *)value);
        break;
    }
}

bool report_rows_append(const report_row *rows, size_t count, const char *path) {
    FILE *stream = fopen(path, "a");
    if (!stream)
        return false;
    fseek(stream, 0, SEEK_END);
    if (ftell(stream) == 0)
        for (size_t k = 0; k < COLUMNS; k++)
            fprintf(stream, "%s%c", columns[k].name, k + 1 < COLUMNS ? '\t' : '\n');
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < COLUMNS; k++) {
            print_value(stream, &columns[k], &rows[i]);
            fputc(k + 1 < COLUMNS ? '\t' : '\n', stream);
        }
    return text_file_close(stream);
}

bool report_rows_replace(const report_rows *rows, const char *path) {
    char whole[1024];
    if (snprintf(whole, sizeof whole, "%s.new", path) >= (int)sizeof whole)
        return false;
    remove(whole);
    return report_rows_append(rows->rows, rows->count, whole) && rename(whole, path) == 0;
}

static bool read_value(const column *c, const char *text, report_row *row) {
    void *value = (char *)row + c->offset;
    char *end = NULL;
    switch (c->kind) {
    case COLUMN_TEXT:
        return snprintf(value, c->size, "%s", text) < (int)c->size;
    case COLUMN_SIZE:
        *(uint32_t *)value = (uint32_t)strtoul(text, &end, 10);
        break;
    case COLUMN_COUNT:
        *(uint64_t *)value = strtoull(text, &end, 10);
        break;
    case COLUMN_NUMBER:
        *(double *)value = strcmp(text, "-") == 0 ? (double)NAN : strtod(text, &end);
        return !end || (end != text && !*end);
    }
    return end != text && !*end;
}

/* A line with its end, cut up in place. False: it is not a whole row. */
static bool read_row(char *line, report_row *row) {
    char *end = strchr(line, '\n');
    if (!end)
        return false;
    *end = 0;
    *row = (report_row){0};
    for (size_t k = 0; k < COLUMNS; k++) {
        char *tab = strchr(line, '\t');
        if (!tab != (k + 1 == COLUMNS))
            return false;
        if (tab)
            *tab = 0;
        if (!read_value(&columns[k], line, row))
            return false;
        line = tab ? tab + 1 : line;
    }
    return true;
}

bool report_rows_read(report_rows *rows, const char *settings, const char *path) {
    FILE *stream = fopen(path, "r");
    if (!stream)
        return true;
    char line[LINE_MAX_LENGTH];
    bool room = true;
    while (room && fgets(line, sizeof line, stream)) {
        report_row row;
        if (read_row(line, &row) && strcmp(row.settings, settings) == 0)
            room = report_rows_add(rows, &row);
    }
    fclose(stream);
    return room;
}

double report_row_ms(const report_row *row) {
    return row->map_ms + row->shading_ms;
}
