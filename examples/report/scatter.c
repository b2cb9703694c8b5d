#include "scatter.h"

#include <math.h>
#include <stdlib.h>

/* The figure's measures, in its own units. */
enum {
    WIDTH = 620,
    HEIGHT = 430,
    LEFT = 62,
    RIGHT = 14,
    TOP = 34,
    BOTTOM = 48,
    ZERO_BAND = 34, /* height of the band for errors of 0, which no logarithm has */
    POINTS_MAX = 512,
    LETTER = 7, /* width of a letter of a label, about */
    LINE = 14,  /* height of a label */
    TICKS_A_DECADE = 3,
    TICKS_REACH = 10 * TICKS_A_DECADE, /* to both sides of 1 */
    LEGEND_LINE = 20                   /* of the legend, which a page has elsewhere */
};

typedef struct point {
    const report_row *row;
    double ms, error, x, y;
    bool front;
} point;

typedef struct box {
    double left, right, top, bottom;
} box;

typedef struct figure {
    FILE *stream;
    const report_scatter *scatter;
    point points[POINTS_MAX];
    size_t count;
    double ms_lo, ms_hi, error_lo, error_hi; /* ends of the axes */
    bool has_zero;
    box taken[2 * POINTS_MAX]; /* by marks and labels */
    size_t taken_count;
} figure;

static int by_time(const void *a, const void *b) {
    const point *first = a, *second = b;
    if (first->ms != second->ms)
        return first->ms < second->ms ? -1 : 1;
    return (first->error > second->error) - (first->error < second->error);
}

static void collect(figure *f, const report_rows *rows) {
    for (size_t i = 0; i < rows->count && f->count < POINTS_MAX; i++) {
        const report_row *row = &rows->rows[i];
        const double error = f->scatter->error_of(row);
        if (report_share_pair(row, f->scatter->pair) && !isnan(error) && report_row_ms(row) > 0)
            f->points[f->count++] =
                (point){.row = row,
                        .ms = report_row_ms(row),
                        .error = error,
                        .front = report_is_on_front(rows, row, f->scatter->error_of)};
    }
    qsort(f->points, f->count, sizeof *f->points, by_time);
}

/* To 1, 2 or 5 times a power of ten, as a reciprocal is, too. */
static double round_down(double value) {
    const double decade = pow(10, floor(log10(value)));
    return decade * (value >= 5 * decade ? 5 : value >= 2 * decade ? 2 : 1);
}

/* The axes reach from what lies just below the smallest value to just above the largest. */
static void fit_axes(figure *f) {
    f->ms_lo = f->error_lo = (double)INFINITY;
    for (size_t i = 0; i < f->count; i++) {
        const point *p = &f->points[i];
        f->ms_lo = fmin(f->ms_lo, p->ms);
        f->ms_hi = fmax(f->ms_hi, p->ms);
        f->has_zero |= p->error <= 0;
        f->error_hi = fmax(f->error_hi, p->error);
        if (p->error > 0)
            f->error_lo = fmin(f->error_lo, p->error);
    }
    if (!(f->error_hi > 0))
        f->error_lo = f->error_hi = 1;
    f->ms_lo /= 1.25;
    f->ms_hi *= 1.25;
    f->error_lo = round_down(f->error_lo / 1.2);
    f->error_hi = 1 / round_down(1 / (f->error_hi * 1.2));
}

static double plot_bottom(const figure *f) {
    return HEIGHT - BOTTOM - (f->has_zero ? ZERO_BAND : 0);
}

static double x_of(const figure *f, double ms) {
    return LEFT + (WIDTH - LEFT - RIGHT) * log(ms / f->ms_lo) / log(f->ms_hi / f->ms_lo);
}

static double y_of(const figure *f, double error) {
    if (error <= 0)
        return HEIGHT - BOTTOM - ZERO_BAND / 2;
    const double bottom = plot_bottom(f);
    return bottom - (bottom - TOP) * log(error / f->error_lo) / log(f->error_hi / f->error_lo);
}

static double mark_radius(const report_row *row) {
    return row->map_size <= 512 ? 4.0 : row->map_size <= 1024 ? 5.5 : 7.5;
}

static void take(figure *f, box taken) {
    if (f->taken_count < sizeof f->taken / sizeof *f->taken)
        f->taken[f->taken_count++] = taken;
}

static void place(figure *f) {
    for (size_t i = 0; i < f->count; i++) {
        point *p = &f->points[i];
        const double radius = mark_radius(p->row);
        p->x = x_of(f, p->ms);
        p->y = y_of(f, p->error);
        take(f, (box){p->x - radius, p->x + radius, p->y - radius, p->y + radius});
    }
}

static void write_grid_line(figure *f, double x1, double y1, double x2, double y2) {
    fprintf(f->stream, "<line class=\"grid\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n",
            x1, y1, x2, y2);
}

static void write_text(figure *f, const char *class, double x, double y, const char *text) {
    fprintf(f->stream, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", class, x, y, text);
}

/* Numbers of axes, which rounding may have moved a little: 0.01, 0.5, 20, 10,000. */
static void format_tick(char *text, size_t size, double value) {
    value *= 1 + 1e-9;
    if (value >= 1e6)
        snprintf(text, size, "%.0f,000,000", value / 1e6);
    else if (value >= 1000)
        snprintf(text, size, "%.0f,000", value / 1000);
    else
        snprintf(text, size, "%g", value);
}

/* 1, 2, 5, 10 and so on, and down to both sides of 1. */
static double tick_at(int step) {
    static const double ticks[TICKS_A_DECADE] = {1, 2, 5};
    const int shifted = step + TICKS_REACH;
    return pow(10, shifted / TICKS_A_DECADE - TICKS_REACH / TICKS_A_DECADE) *
           ticks[shifted % TICKS_A_DECADE];
}

static void write_time_axis(figure *f) {
    char text[32];
    for (int step = -TICKS_REACH; step <= TICKS_REACH; step++) {
        const double ms = tick_at(step), x = x_of(f, ms);
        if (ms < f->ms_lo || ms > f->ms_hi)
            continue;
        format_tick(text, sizeof text, ms);
        write_grid_line(f, x, TOP, x, HEIGHT - BOTTOM);
        write_text(f, "tick middle", x, HEIGHT - BOTTOM + 16, text);
    }
    write_text(f, "axis middle", (LEFT + WIDTH - RIGHT) / 2.0, HEIGHT - 10,
               "map and shading together, milliseconds");
}

static void write_error_axis(figure *f) {
    char text[32];
    const bool narrow = f->error_hi < 200 * f->error_lo; /* room for more than powers of ten */
    for (int step = -TICKS_REACH; step <= TICKS_REACH; step++) {
        const double error = tick_at(step);
        if (error < f->error_lo * 0.99 || error > f->error_hi * 1.01 ||
            (!narrow && step % TICKS_A_DECADE != 0))
            continue;
        const double y = y_of(f, error);
        format_tick(text, sizeof text, error);
        write_grid_line(f, LEFT, y, WIDTH - RIGHT, y);
        write_text(f, "tick end", LEFT - 6, y + 4, text);
    }
    if (f->has_zero) {
        fprintf(f->stream,
                "<rect class=\"zero\" x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%d\"/>\n", LEFT,
                plot_bottom(f) + 4, WIDTH - LEFT - RIGHT, ZERO_BAND - 4);
        write_text(f, "tick end", LEFT - 6, y_of(f, 0) + 4, "none");
    }
    write_text(f, "axis", LEFT, TOP - 12, f->scatter->axis);
}

/* A staircase: from one method of the front on, nothing is faster until the next. */
static void write_front(figure *f) {
    bool begun = false;
    fprintf(f->stream, "<path class=\"front\" d=\"");
    for (size_t i = 0; i < f->count; i++) {
        const point *p = &f->points[i];
        if (!p->front)
            continue;
        if (begun)
            fprintf(f->stream, "H%.1fV%.1f", p->x, p->y);
        else
            fprintf(f->stream, "M%.1f %dV%.1f", p->x, TOP, p->y);
        begun = true;
    }
    fprintf(f->stream, "%s\"/>\n", begun ? "" : "M0 0");
}

void report_scatter_shape(FILE *stream, report_family family, double x, double y, double r) {
    switch (family) {
    case REPORT_OFFSETS:
        fprintf(stream, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>", x, y, r);
        break;
    case REPORT_PLANES:
        fprintf(stream, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>", x - r * 0.9,
                y - r * 0.9, r * 1.8, r * 1.8);
        break;
    case REPORT_LAYERS:
        fprintf(stream, "<path d=\"M%.1f %.1fl%.1f %.1fl%.1f %.1fl%.1f %.1fz\"/>", x, y - 1.25 * r,
                1.25 * r, 1.25 * r, -1.25 * r, 1.25 * r, -1.25 * r, -1.25 * r);
        break;
    default:
        fprintf(stream, "<path d=\"M%.1f %.1fl%.1f %.1fh%.1fz\"/>", x, y - 1.2 * r, 1.2 * r,
                2.1 * r, -2.4 * r);
        break;
    }
}

/* Two lines of two marks. */
static void write_legend(figure *f) {
    const bool hard = report_is_hard(f->scatter->pair);
    for (int i = 0; i < REPORT_FAMILIES; i++) {
        const report_family family = (report_family)i;
        const double x = LEFT + i % 2 * (WIDTH - LEFT) / 2, y = HEIGHT + 8 + i / 2 * LEGEND_LINE;
        fprintf(f->stream, "<g class=\"family-%d\">", i);
        report_scatter_shape(f->stream, family, x, y, 5.5);
        fprintf(f->stream, "</g>\n");
        write_text(f, "tick", x + 11, y + 4, report_family_name(family, hard));
    }
}

static void write_point(figure *f, const point *p, bool first) {
    const report_family family = report_family_of(p->row);
    const bool hard = report_is_hard(p->row);
    char error[32];
    snprintf(error, sizeof error, p->error >= 100 ? "%.0f" : "%.3g", p->error);
    fprintf(f->stream, "<g class=\"point family-%d%s\"", (int)family, p->front ? " on-front" : "");
    if (!f->scatter->alone)
        fprintf(f->stream,
                " role=\"img\" tabindex=\"%d\" data-method=\"%s\" data-filter=\"%s\" "
                "data-size=\"%u\"",
                first ? 0 : -1, p->row->method, p->row->filter, (unsigned)p->row->map_size);
    fprintf(f->stream, " aria-label=\"%s%s%s, map of %u: %.3g ms, %s %s%s\">",
            hard ? "" : p->row->filter, hard ? "" : " with ", p->row->method,
            (unsigned)p->row->map_size, p->ms, error, f->scatter->axis,
            p->front ? "; on the Pareto front" : "");
    report_scatter_shape(f->stream, family, p->x, p->y, mark_radius(p->row));
    fprintf(f->stream, "</g>\n");
}

static bool is_free(const figure *f, const box *wanted) {
    for (size_t i = 0; i < f->taken_count; i++) {
        const box *taken = &f->taken[i];
        if (taken->left < wanted->right && taken->right > wanted->left &&
            taken->top < wanted->bottom && taken->bottom > wanted->top)
            return false;
    }
    return wanted->left > LEFT && wanted->right < WIDTH - RIGHT && wanted->top > TOP - 8 &&
           wanted->bottom < HEIGHT - BOTTOM + 2;
}

/* Names a method of the front at the first place beside its mark that is free; without one it stays
 * without a name. */
static void write_label(figure *f, const point *p) {
    static const double aside[6][2] = {{1, -0.9}, {1, 0.9}, {-1, 0.9}, {-1, -0.9}, {1, 0}, {-1, 0}};
    char text[160];
    const bool hard = report_is_hard(p->row);
    const int length = snprintf(text, sizeof text, "%s%s%s %u", hard ? "" : p->row->filter,
                                hard ? "" : ", ", p->row->method, (unsigned)p->row->map_size);
    const double gap = mark_radius(p->row) + 4, width = (double)LETTER * length;
    for (size_t i = 0; i < 6; i++) {
        const double x = p->x + aside[i][0] * gap, y = p->y + aside[i][1] * (gap + 2);
        const bool right = aside[i][0] > 0;
        const box wanted = {right ? x : x - width, right ? x + width : x, y - LINE / 2.0,
                            y + LINE / 2.0};
        if (!is_free(f, &wanted))
            continue;
        write_text(f, right ? "label" : "label end", x, y + 4, text);
        take(f, wanted);
        return;
    }
}

static void write_style(FILE *stream) {
    fputs("<style>svg{font:12px system-ui,sans-serif;background:#fff}text{fill:#333}"
          ".middle{text-anchor:middle}.end{text-anchor:end}.grid{stroke:#ddd}.zero{fill:#eee}"
          ".title{font-weight:600;font-size:14px}.front{fill:none;stroke:#666;stroke-width:1.5;"
          "stroke-dasharray:5 3}.point{stroke:#fff;stroke-width:1}.label{font-weight:600}"
          ".family-0{fill:#b45309}.family-1{fill:#1d5fc2}.family-2{fill:#8a3ea8}"
          ".family-3{fill:#0b7a5c}@media(prefers-color-scheme:dark){svg{background:#16181d}"
          "text{fill:#d6d8dd}.grid{stroke:#2e323b}.zero{fill:#23262e}.front{stroke:#9aa0ab}"
          ".point{stroke:#16181d}.family-0{fill:#f0a04b}.family-1{fill:#7ab0ff}"
          ".family-2{fill:#cf9be6}.family-3{fill:#4fd1ab}}</style>\n",
          stream);
}

static void write_frame(figure *f) {
    const int height = HEIGHT + (f->scatter->alone ? 2 * LEGEND_LINE + 8 : 0);
    fprintf(f->stream, "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\"", WIDTH,
            height);
    if (f->scatter->alone) {
        fprintf(f->stream, " width=\"%d\" height=\"%d\" role=\"img\">\n<title>%s</title>\n", WIDTH,
                height, f->scatter->title);
        write_style(f->stream);
    } else
        fprintf(f->stream, " class=\"scatter\" role=\"group\" aria-label=\"%s\">\n",
                f->scatter->title);
}

void report_scatter_write(FILE *stream, const report_rows *rows, const report_scatter *scatter) {
    figure f = {.stream = stream, .scatter = scatter};
    collect(&f, rows);
    if (f.count == 0)
        return;
    fit_axes(&f);
    place(&f);
    write_frame(&f);
    write_time_axis(&f);
    write_error_axis(&f);
    write_front(&f);
    for (size_t i = 0; i < f.count; i++)
        write_point(&f, &f.points[i], i == 0);
    for (size_t i = 0; i < f.count; i++)
        if (f.points[i].front)
            write_label(&f, &f.points[i]);
    if (scatter->alone)
        write_legend(&f);
    fprintf(stream, "</svg>\n");
}
