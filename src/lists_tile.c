/* Triangles into the texels of a tile, front to back. A triangle goes into a texel unless it misses
 * the texel for sure or begins there behind a triangle before it that covers the texel for sure.
 * A later one cannot end in front of it: it begins farther away. */
#include "strict.h"

#include "lists_tile.h"

#include <math.h>

enum { SIZE = SHB_LIST_TILE, TEXELS = SIZE * SIZE };

/* Triangles that are fetched before they are used. */
enum { AHEAD = 8 };

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

/* Where edge functions of a triangle let its columns begin or end in a row: at
 * at + slope * row. touched: texels that the inner side may touch; covered: those that lie on it
 * for sure. */
typedef struct border {
    double slope, touched, covered;
} border;

typedef struct borders {
    border left[3], right[3];
    int left_count, right_count;
    double first_touched_row, last_touched_row; /* by level edges */
    double first_covered_row, last_covered_row;
} borders;

static double larger_of(double a, double b) {
    return a > b ? a : b;
}

static double smaller_of(double a, double b) {
    return a < b ? a : b;
}

/* A level edge: y row + one >= 0 at the rows' nearer or farther side; |y| is 1, nearly. */
static void add_level_edge(double y, double one, double bound, borders *all) {
    const double touched = -(one + bound) / y, covered = -(one - bound) / y;
    if (y > 0) {
        all->first_touched_row = larger_of(all->first_touched_row, touched - 1 - 0x1p-20);
        all->first_covered_row = larger_of(all->first_covered_row, covered + 0x1p-20);
    } else {
        all->last_touched_row = smaller_of(all->last_touched_row, touched + 0x1p-20);
        all->last_covered_row = smaller_of(all->last_covered_row, covered - 1 - 0x1p-20);
    }
}

/* The inner side at a texel's best corner: x column + y row + one + max(x, 0) + max(y, 0) + bound
 * >= 0; at its worst one: with min for max and - bound. The margin holds the rounding of at, whose
 * parts are products of numbers up to four sides of the view, and of its sum with slope * row. */
static void add_edge(const shb_list_triangle *triangle, int i, double side, borders *all) {
    const double x = triangle->x[i], y = triangle->y[i], one = triangle->one[i];
    const double bound = (double)triangle->edge_bound;
    if (fabs(x) < LEAST_SLOPE) {
        if (y != 0)
            add_level_edge(y, one, bound + LEAST_SLOPE * side, all);
        return;
    }
    const double inverse = 1 / x;
    const double margin = 0x1p-20 + 0x1p-48 * (side + fabs(one)) * fabs(inverse);
    const double best = one + larger_of(x, 0) + larger_of(y, 0) + bound;
    const double worst = one + smaller_of(x, 0) + smaller_of(y, 0) - bound;
    const double outwards = x > 0 ? -margin : margin;
    const border made = {-y * inverse, outwards - best * inverse, -outwards - worst * inverse};
    if (x > 0)
        all->left[all->left_count++] = made;
    else
        all->right[all->right_count++] = made;
}

static void narrow(const borders *all, double row, columns *touched, columns *covered) {
    for (int i = 0; i < all->left_count; i++) {
        const border *left = &all->left[i];
        const double at = left->slope * row;
        touched->first = larger_of(touched->first, at + left->touched);
        covered->first = larger_of(covered->first, at + left->covered);
    }
    for (int i = 0; i < all->right_count; i++) {
        const border *right = &all->right[i];
        const double at = right->slope * row;
        touched->last = smaller_of(touched->last, at + right->touched);
        covered->last = smaller_of(covered->last, at + right->covered);
    }
    if (!(row >= all->first_covered_row && row <= all->last_covered_row))
        covered->last = -1;
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

static borders borders_of(const target *t, const shb_list_triangle *triangle) {
    const shb_list_frame *frame = &t->tile->lists->frame;
    borders all = {.first_touched_row = 0,
                   .last_touched_row = frame->height,
                   .first_covered_row = 0,
                   .last_covered_row = frame->height};
    for (int i = 0; i < 3; i++)
        add_edge(triangle, i, frame->width + frame->height, &all);
    /* Nothing is known of it, or a part of it does not count: it covers no texel for sure. */
    if (triangle->crosses_near || !(triangle->depth_bound < HUGE_VALF))
        all.last_covered_row = -1;
    return all;
}

static void add_triangle(target *t, uint32_t number) {
    const shb_list_tile *tile = t->tile;
    const shb_list_triangle *triangle = &tile->lists->triangles[number];
    const shb_list_box *box = &tile->boxes[number];
    const columns in_box = {larger_of(box->first_column, tile->first_column),
                            smaller_of(box->last_column, tile->first_column + SIZE - 1)};
    const borders all = borders_of(t, triangle);
    const double first_row =
        larger_of(larger_of(box->first_row, tile->first_row), all.first_touched_row);
    const double last_row =
        smaller_of(smaller_of(box->last_row, tile->first_row + SIZE - 1), all.last_touched_row);
    for (double row = ceil(first_row); row <= last_row; row++) {
        columns touched = in_box, covered = in_box;
        narrow(&all, row, &touched, &covered);
        if (!(touched.first <= touched.last))
            continue;
        const depths d = depths_of(triangle, row);
        add_row(t, number, &d, (uint32_t)row, &touched, &covered);
    }
}

/* In the order of depth a tile's triangles are far apart in memory: waiting for them one by one
 * would take as long as all the rest. */
static void fetch_triangle(const shb_list_tile *tile, uint32_t number) {
    const char *triangle = (const char *)&tile->lists->triangles[number];
    __builtin_prefetch(triangle);
    __builtin_prefetch(triangle + 64);
    __builtin_prefetch(&tile->boxes[number]);
}

static void add_triangles(const shb_list_tile *tile, uint32_t *next, uint32_t *entries) {
    target t = {.tile = tile, .next = next, .entries = entries};
    for (size_t i = 0; i < TEXELS; i++)
        t.far[i] = HUGE_VAL;
    for (size_t i = 0; i < tile->count; i++) {
        if (i + AHEAD < tile->count)
            fetch_triangle(tile, tile->numbers[i + AHEAD]);
        add_triangle(&t, tile->numbers[i]);
    }
}

void shb_list_tile_count(const shb_list_tile *tile, uint32_t *counts) {
    add_triangles(tile, counts, NULL);
}

void shb_list_tile_fill(const shb_list_tile *tile, uint32_t *next, uint32_t *entries) {
    add_triangles(tile, next, entries);
}
