/* Triangles into the texels of a tile, front to back. A triangle goes into a texel unless it misses
 * the texel for sure or begins there behind a triangle before it that covers the texel for sure.
 * A later one cannot end in front of it: it begins farther away. */
#include "strict.h"

#include "lists_tile.h"

#include <math.h>

enum { SIZE = SHB_LIST_TILE, TEXELS = SIZE * SIZE };

/* Columns are rounded outwards by this for the rounding of a quotient. */
#define COLUMN_MARGIN 0x1p-20

/* An edge flatter than this counts as level, its change across the view as an error. */
#define LEAST_SLOPE 0x1p-30

typedef struct target {
    const shb_list_tile *tile;
    uint32_t *next;
    uint32_t *entries; /* NULL: next only counts */
    double far[TEXELS];
} target;

/* Columns, both ends included; real numbers while they are narrowed. */
typedef struct columns {
    double first, last;
} columns;

/* An edge function for one triangle and all rows. */
typedef struct edge {
    double x, y, one, bound, inverse;
} edge;

static edge make_edge(const shb_list_triangle *triangle, int i, double width) {
    edge e = {triangle->x[i], triangle->y[i], triangle->one[i], (double)triangle->edge_bound, 0};
    if (fabs(e.x) < LEAST_SLOPE) {
        e.bound += fabs(e.x) * width;
        e.x = 0;
    } else {
        e.inverse = 1 / e.x;
    }
    return e;
}

/* Columns whose texels in a row the inner side of the edge may touch. */
static void narrow_touched(const edge *e, double row, columns *c) {
    const double at = e->one + e->y * (e->y > 0 ? row + 1 : row) + e->bound;
    const double border = -at * e->inverse;
    if (e->x > 0)
        c->first = border - 1 - COLUMN_MARGIN > c->first ? border - 1 - COLUMN_MARGIN : c->first;
    else if (e->x < 0)
        c->last = border + COLUMN_MARGIN < c->last ? border + COLUMN_MARGIN : c->last;
    else if (at < 0)
        c->last = -1;
}

/* Columns whose texels in a row lie on the inner side for sure. */
static void narrow_covered(const edge *e, double row, columns *c) {
    const double at = e->one + e->y * (e->y > 0 ? row : row + 1) - e->bound;
    const double border = -at * e->inverse;
    if (e->x > 0)
        c->first = border + COLUMN_MARGIN > c->first ? border + COLUMN_MARGIN : c->first;
    else if (e->x < 0)
        c->last = border - 1 - COLUMN_MARGIN < c->last ? border - 1 - COLUMN_MARGIN : c->last;
    else if (!(at >= 0))
        c->last = -1;
}

static int32_t first_of(const columns *c) {
    const int32_t floor = (int32_t)c->first;
    return (double)floor < c->first ? floor + 1 : floor;
}

/* The plane's depth over the texels of a row: one + x column at a texel's upper left corner; lo and
 * hi are what the rest of the texel and rounding take away or add. */
typedef struct depths {
    double x, one, lo, hi;
} depths;

static depths depths_of(const shb_list_triangle *triangle, double row) {
    const double x = -triangle->x[SHB_LIST_DEPTH], y = -triangle->y[SHB_LIST_DEPTH];
    const double bound = (double)triangle->depth_bound;
    return (depths){.x = x,
                    .one = y * row - triangle->one[SHB_LIST_DEPTH],
                    .lo = (x < 0 ? x : 0) + (y < 0 ? y : 0) - bound,
                    .hi = (x > 0 ? x : 0) + (y > 0 ? y : 0) + bound};
}

static void add_row(target *t, uint32_t number, const depths *d, uint32_t row,
                    const columns *touched, const columns *covered) {
    const double nearest = (double)t->tile->lists->triangles[number].nearest;
    const int32_t first_column = (int32_t)t->tile->first_column;
    const size_t start = (size_t)(row - t->tile->first_row) * SIZE;
    const int32_t last = (int32_t)touched->last;
    for (int32_t column = first_of(touched); column <= last; column++) {
        const size_t texel = start + (size_t)(column - first_column);
        const double depth = d->one + d->x * (double)column;
        const double begin = depth + d->lo > nearest ? depth + d->lo : nearest;
        if (begin > t->far[texel])
            continue;
        if (t->entries)
            t->entries[t->next[texel]] = number;
        t->next[texel]++;
        if ((double)column >= covered->first && (double)column <= covered->last &&
            depth + d->hi < t->far[texel])
            t->far[texel] = depth + d->hi;
    }
}

static uint32_t larger(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static uint32_t smaller(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static void add_triangle(target *t, uint32_t number) {
    const shb_list_tile *tile = t->tile;
    const shb_list_triangle *triangle = &tile->lists->triangles[number];
    const shb_list_box *box = &tile->boxes[number];
    const uint32_t first_column = larger(box->first_column, tile->first_column);
    const uint32_t last_column = smaller(box->last_column, tile->first_column + SIZE - 1);
    const uint32_t first_row = larger(box->first_row, tile->first_row);
    const uint32_t last_row = smaller(box->last_row, tile->first_row + SIZE - 1);
    edge edges[3];
    for (int i = 0; i < 3; i++)
        edges[i] = make_edge(triangle, i, tile->lists->frame.width);
    for (uint32_t row = first_row; row <= last_row; row++) {
        columns touched = {first_column, last_column}, covered = touched;
        for (int i = 0; i < 3; i++) {
            narrow_touched(&edges[i], (double)row, &touched);
            narrow_covered(&edges[i], (double)row, &covered);
        }
        if (triangle->crosses_near)
            covered.last = -1;
        if (!(touched.first <= touched.last))
            continue;
        const depths d = depths_of(triangle, (double)row);
        add_row(t, number, &d, row, &touched, &covered);
    }
}

static void add_triangles(const shb_list_tile *tile, uint32_t *next, uint32_t *entries) {
    target t = {.tile = tile, .next = next, .entries = entries};
    for (size_t i = 0; i < TEXELS; i++)
        t.far[i] = HUGE_VAL;
    for (size_t i = 0; i < tile->count; i++)
        add_triangle(&t, tile->numbers[i]);
}

void shb_list_tile_count(const shb_list_tile *tile, uint32_t *counts) {
    add_triangles(tile, counts, NULL);
}

void shb_list_tile_fill(const shb_list_tile *tile, uint32_t *next, uint32_t *entries) {
    add_triangles(tile, next, entries);
}
