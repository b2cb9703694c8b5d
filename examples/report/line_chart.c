#include "line_chart.h"

#include <math.h>

/* The figure's measures, in its own units. */
enum {
    WIDTH = 620,
    HEIGHT = 330,
    LEFT = 62,
    RIGHT = 150, /* room for names */
    TOP = 30,
    BOTTOM = 46,
    LINE = 14 /* height of a name */
};

typedef struct figure {
    FILE *stream;
    const line_chart *chart;
    double lo, hi; /* of the values' axis */
} figure;

static const char *const dashes[LINE_CHART_LINES_MAX] = {"none",     "7 4",  "2 3",
                                                         "10 3 2 3", "12 6", "4 4"};
static const char *const colors[LINE_CHART_LINES_MAX] = {"var(--ink)",    "var(--offsets)",
                                                         "var(--planes)", "var(--layers)",
                                                         "var(--exact)",  "var(--soft)"};

static figure figure_of(FILE *stream, const line_chart *chart) {
    figure f = {stream, chart, (double)INFINITY, 0};
    for (size_t i = 0; i < chart->line_count; i++)
        for (size_t k = 0; k < chart->step_count; k++) {
            f.lo = fmin(f.lo, chart->lines[i].values[k]);
            f.hi = fmax(f.hi, chart->lines[i].values[k]);
        }
    f.lo /= 1.25;
    f.hi *= 1.25;
    return f;
}

static double x_of(const figure *f, size_t step) {
    return LEFT +
           (double)(WIDTH - LEFT - RIGHT) * (double)step / (double)(f->chart->step_count - 1);
}

static double y_of(const figure *f, double value) {
    return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * log(value / f->lo) / log(f->hi / f->lo);
}

/* Lines at 1, 2 and 5 times the powers of ten. */
static void write_value_axis(const figure *f) {
    static const double parts[] = {1, 2, 5};
    fprintf(f->stream, "<text class=\"label\" x=\"%d\" y=\"16\">%s</text>\n", 4,
            f->chart->value_axis);
    for (int power = -6; power < 7; power++)
        for (size_t i = 0; i < 3; i++) {
            const double value = parts[i] * pow(10, power), y = y_of(f, value);
            if (value < f->lo || value > f->hi)
                continue;
            fprintf(f->stream,
                    "<line class=\"grid\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/>\n"
                    "<text class=\"end\" x=\"%d\" y=\"%.1f\">%g</text>\n",
                    LEFT, y, WIDTH - RIGHT, y, LEFT - 6, y + 4, value * (1 + 1e-12));
        }
}

static void write_step_axis(const figure *f) {
    for (size_t k = 0; k < f->chart->step_count; k++)
        fprintf(f->stream, "<text class=\"middle\" x=\"%.1f\" y=\"%d\">%s</text>\n", x_of(f, k),
                HEIGHT - BOTTOM + 18, f->chart->steps[k]);
    fprintf(f->stream, "<text class=\"middle\" x=\"%d\" y=\"%d\">%s</text>\n",
            (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, f->chart->step_axis);
}

/* The number of lines that end below this one; of equal ones the later is below. */
static size_t rank_of(const line_chart *chart, size_t line) {
    const size_t last = chart->step_count - 1;
    size_t rank = 0;
    for (size_t i = 0; i < chart->line_count; i++) {
        const double other = chart->lines[i].values[last], own = chart->lines[line].values[last];
        rank += other < own || (other <= own && i > line);
    }
    return rank;
}

/* Names keep apart from each other: from the lowest upwards, each at least a line higher. */
static void place_names(const figure *f, double y[LINE_CHART_LINES_MAX]) {
    const line_chart *chart = f->chart;
    double below = HEIGHT;
    for (size_t rank = 0; rank < chart->line_count; rank++)
        for (size_t i = 0; i < chart->line_count; i++)
            if (rank_of(chart, i) == rank) {
                y[i] =
                    fmin(y_of(f, chart->lines[i].values[chart->step_count - 1]) + 4, below - LINE);
                below = y[i];
            }
}

static void write_line(const figure *f, size_t number, double name_y) {
    const line_chart *chart = f->chart;
    const chart_line *line = &chart->lines[number];
    fprintf(f->stream,
            "<polyline fill=\"none\" stroke-width=\"2\" stroke-dasharray=\"%s\" "
            "style=\"stroke:%s\" points=\"",
            dashes[number], colors[number]);
    for (size_t k = 0; k < chart->step_count; k++)
        fprintf(f->stream, "%.1f,%.1f ", x_of(f, k), y_of(f, line->values[k]));
    fprintf(f->stream, "\"/>\n");
    for (size_t k = 0; k < chart->step_count; k++)
        fprintf(f->stream,
                "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" style=\"fill:%s\"><title>%s, %s: "
                "%.3g</title></circle>\n",
                x_of(f, k), y_of(f, line->values[k]), colors[number], line->name, chart->steps[k],
                line->values[k]);
    fprintf(f->stream, "<text class=\"label\" x=\"%d\" y=\"%.1f\">%s</text>\n", WIDTH - RIGHT + 9,
            name_y, line->name);
}

void line_chart_write(FILE *stream, const line_chart *chart) {
    const figure f = figure_of(stream, chart);
    double name_y[LINE_CHART_LINES_MAX];
    place_names(&f, name_y);
    fprintf(stream,
            "<div class=\"chart\">\n<h3>%s</h3>\n<svg class=\"scatter\" viewBox=\"0 0 %d %d\" "
            "role=\"img\" aria-label=\"%s\">\n",
            chart->title, WIDTH, HEIGHT, chart->title);
    write_value_axis(&f);
    write_step_axis(&f);
    for (size_t i = 0; i < chart->line_count; i++)
        write_line(&f, i, name_y[i]);
    fprintf(stream, "</svg>\n</div>\n");
}
