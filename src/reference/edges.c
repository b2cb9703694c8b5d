/* Welding and pairing by one hash table with linear probing, used twice: first it holds one corner
 * for each position, then one half-edge for each pair of welded corners. */
#include "../strict.h"

#include "edges.h"

#include "../hash.h"

#include <string.h>

typedef struct welder {
    const shb_triangle *triangles;
    uint32_t corner_count;
    uint32_t *welded; /* by corner: the first corner at the same position */
    uint32_t *table;  /* SHB_ID_NONE: free */
    size_t mask;      /* size of the table - 1; the size is a power of two */
} welder;

static const double *position_of(const welder *w, uint32_t corner) {
    return w->triangles[corner / 3].corners[corner % 3];
}

static uint64_t hash_of_position(const double position[3]) {
    /* -0 becomes 0 */
    return shb_position_key((double[3]){position[0] + 0.0, position[1] + 0.0, position[2] + 0.0});
}

static bool same_position(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static void clear_table(welder *w) {
    memset(w->table, 0xff, (w->mask + 1) * sizeof *w->table);
}

static void weld_corners(welder *w) {
    clear_table(w);
    for (uint32_t corner = 0; corner < w->corner_count; corner++) {
        const double *position = position_of(w, corner);
        size_t place = hash_of_position(position) & w->mask;
        while (w->table[place] != SHB_ID_NONE &&
               !same_position(position_of(w, w->table[place]), position))
            place = (place + 1) & w->mask;
        if (w->table[place] == SHB_ID_NONE)
            w->table[place] = corner;
        w->welded[corner] = w->table[place];
    }
}

static bool has_area(const shb_triangle *triangle) {
    double e[3], f[3];
    for (int i = 0; i < 3; i++) {
        e[i] = triangle->corners[1][i] - triangle->corners[0][i];
        f[i] = triangle->corners[2][i] - triangle->corners[0][i];
    }
    return e[1] * f[2] != e[2] * f[1] || e[2] * f[0] != e[0] * f[2] || e[0] * f[1] != e[1] * f[0];
}

/* The two welded ends of a half-edge, the lower one first. */
typedef struct ends {
    uint32_t low, high;
} ends;

static ends ends_of(const welder *w, uint32_t half_edge) {
    const uint32_t first = half_edge - half_edge % 3;
    const uint32_t a = w->welded[half_edge], b = w->welded[first + (half_edge + 1) % 3];
    return a < b ? (ends){a, b} : (ends){b, a};
}

static void add_half_edge(welder *w, shb_edges *edges, uint32_t half_edge) {
    const ends own = ends_of(w, half_edge);
    size_t place = shb_mix((uint64_t)own.high << 32 | own.low) & w->mask;
    for (; w->table[place] != SHB_ID_NONE; place = (place + 1) & w->mask) {
        const uint32_t head = w->table[place];
        const ends other = ends_of(w, head);
        if (other.low == own.low && other.high == own.high) {
            edges->next[half_edge] = edges->next[head];
            edges->next[head] = half_edge;
            return;
        }
    }
    w->table[place] = half_edge;
    edges->next[half_edge] = SHB_ID_NONE;
    edges->heads[edges->count++] = half_edge;
}

static void pair_half_edges(welder *w, shb_edges *edges) {
    clear_table(w);
    for (uint32_t first = 0; first < w->corner_count; first += 3)
        if (has_area(&w->triangles[first / 3]))
            for (uint32_t k = 0; k < 3; k++)
                add_half_edge(w, edges, first + k);
}

bool shb_edges_build(const shb_context *context, const shb_triangle *triangles, uint32_t count,
                     shb_edges *edges) {
    welder w = {.triangles = triangles, .corner_count = 3 * count, .mask = 15};
    while (w.mask < 2 * (size_t)w.corner_count)
        w.mask = 2 * w.mask + 1;
    shb_edges built = {0};
    w.welded = shb_alloc(context, w.corner_count, sizeof *w.welded);
    w.table = shb_alloc(context, w.mask + 1, sizeof *w.table);
    built.heads = shb_alloc(context, w.corner_count, sizeof *built.heads);
    built.next = shb_alloc(context, w.corner_count, sizeof *built.next);
    const bool complete = w.welded && w.table && built.heads && built.next;
    if (complete) {
        weld_corners(&w);
        pair_half_edges(&w, &built);
        *edges = built;
    } else {
        shb_edges_free(context, &built);
    }
    shb_free(context, w.welded);
    shb_free(context, w.table);
    return complete;
}

void shb_edges_free(const shb_context *context, shb_edges *edges) {
    shb_free(context, edges->heads);
    shb_free(context, edges->next);
}
