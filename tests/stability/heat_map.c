#include "heat_map.h"

#include "font.h"
#include "text_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { cell = 14, left = 190, top = 240, margin = 4 };

/* The rows as a grid: each change of the case starts a line. */
typedef struct heat_grid {
    const stability_rows *rows;
    uint32_t columns, lines;
} heat_grid;

int heat_map_digits(double rate) {
    int digits = rate > 0;
    for (double limit = 10; rate >= limit && digits < 7; limit *= 10)
        digits++;
    return digits;
}

static heat_grid grid_of(const stability_rows *rows) {
    heat_grid grid = {.rows = rows};
    while (grid.columns < rows->count && rows->rows[grid.columns].subject == rows->rows[0].subject)
        grid.columns++;
    grid.lines = grid.columns ? (uint32_t)(rows->count / grid.columns) : 0;
    return grid;
}

static const stability_row *row_at(const heat_grid *grid, uint32_t column, uint32_t line) {
    return &grid->rows->rows[(size_t)line * grid->columns + column];
}

/* 255 for no digits .. 45 for seven. */
static uint8_t lightness(int digits) {
    return (uint8_t)(255 - 30 * digits);
}

static bool is_dark(int digits) {
    return lightness(digits) < 140;
}

static void column_name(const heat_grid *grid, uint32_t column, char text[32]) {
    const stability_row *row = row_at(grid, column, 0);
    snprintf(text, 32, "%s%s", row->method, row->setting == STABILITY_TUNED ? " tuned" : "");
}

static void fill_cell(shb_image *image, size_t x, size_t y, uint8_t level) {
    for (size_t row = y; row + 1 < y + cell; row++)
        memset(image->pixels + 3 * (row * image->width + x), level, 3 * (cell - 1));
}

/* From top to bottom, as letters of the font do not turn. */
static void draw_down(shb_image *image, int64_t x, int64_t bottom, const uint8_t color[3],
                      const char *text) {
    int64_t y = bottom - (int64_t)strlen(text) * (FONT_HEIGHT + 1);
    for (; *text; text++, y += FONT_HEIGHT + 1)
        font_draw(image, x, y, 1, color, (const char[]){*text, 0});
}

static void paint_line(const heat_grid *grid, shb_image *image, uint32_t line) {
    static const uint8_t black[3] = {0, 0, 0}, white[3] = {255, 255, 255};
    const uint32_t y = top + line * cell;
    font_draw(image, margin, y + 3, 1, black, row_at(grid, 0, line)->subject->name);
    for (uint32_t column = 0; column < grid->columns; column++) {
        const uint32_t x = left + column * cell;
        const int digits = heat_map_digits(row_at(grid, column, line)->rates.wrong);
        fill_cell(image, x, y, lightness(digits));
        font_draw(image, x + 4, y + 3, 1, is_dark(digits) ? white : black,
                  (const char[]){(char)('0' + digits), 0});
    }
}

static shb_result write_ppm(const heat_grid *grid, const char *path) {
    static const uint8_t black[3] = {0, 0, 0};
    shb_image image = {.width = left + grid->columns * cell + margin,
                       .height = top + grid->lines * cell + margin};
    image.pixels = malloc(3 * (size_t)image.width * image.height);
    if (!image.pixels)
        return SHB_ERROR_MEMORY;
    memset(image.pixels, 235, 3 * (size_t)image.width * image.height);
    for (uint32_t column = 0; column < grid->columns; column++) {
        char name[32];
        column_name(grid, column, name);
        draw_down(&image, left + column * cell + 4, top - margin, black, name);
    }
    for (uint32_t line = 0; line < grid->lines; line++)
        paint_line(grid, &image, line);
    const shb_result result = shb_image_write_ppm(&image, path);
    free(image.pixels);
    return result;
}

static void print_line(const heat_grid *grid, FILE *file, uint32_t line) {
    const uint32_t y = top + line * cell;
    fprintf(file, "<text x=\"%d\" y=\"%u\">%s</text>\n", margin, y + 10,
            row_at(grid, 0, line)->subject->name);
    for (uint32_t column = 0; column < grid->columns; column++) {
        const uint32_t x = left + column * cell;
        const double wrong = row_at(grid, column, line)->rates.wrong;
        const int digits = heat_map_digits(wrong), level = lightness(digits);
        fprintf(file,
                "<rect x=\"%u\" y=\"%u\" width=\"%d\" height=\"%d\" fill=\"rgb(%d,%d,%d)\">"
                "<title>%.3f ppm</title></rect><text x=\"%u\" y=\"%u\" fill=\"%s\">%d</text>\n",
                x, y, cell - 1, cell - 1, level, level, level, wrong, x + 4, y + 10,
                is_dark(digits) ? "white" : "black", digits);
    }
}

static shb_result write_svg(const heat_grid *grid, const char *path) {
    FILE *file = fopen(path, "w");
    if (!file)
        return SHB_ERROR_FILE;
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" "
            "font-family=\"monospace\" font-size=\"10\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"rgb(235,235,235)\"/>\n",
            left + grid->columns * cell + margin, top + grid->lines * cell + margin);
    for (uint32_t column = 0; column < grid->columns; column++) {
        char name[32];
        column_name(grid, column, name);
        fprintf(file, "<text transform=\"translate(%u,%d) rotate(-90)\">%s</text>\n",
                left + column * cell + 10, top - margin, name);
    }
    for (uint32_t line = 0; line < grid->lines; line++)
        print_line(grid, file, line);
    fprintf(file, "</svg>\n");
    return text_file_close(file) ? SHB_OK : SHB_ERROR_FILE;
}

shb_result heat_map_write(const stability_rows *rows, const char *directory) {
    const heat_grid grid = grid_of(rows);
    char ppm[1100], svg[1100];
    snprintf(ppm, sizeof ppm, "%s/heat.ppm", directory);
    snprintf(svg, sizeof svg, "%s/heat.svg", directory);
    const shb_result result = write_ppm(&grid, ppm);
    return result ? result : write_svg(&grid, svg);
}
