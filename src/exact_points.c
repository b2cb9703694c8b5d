#include "strict.h"

#include "exact_points.h"

#include "lists.h"

#include <math.h>

/* Of the sizes of a triangle's corners: what a host may have rounded away from a position. */
#define AGREEMENT 0x1p-18

/* The scene that a map was drawn from. */
typedef struct drawn_mesh {
    size_t triangle_count;
    const uint32_t (*corners)[3];
    const double (*vertices)[3];
} drawn_mesh;

/* Without triangles where the map has no use for them. */
static drawn_mesh mesh_of(const shb_map *map) {
    const shb_topology *t = &map->occluders.topology;
    if (map->lists)
        return (drawn_mesh){map->lists->id_count, (const uint32_t(*)[3])map->lists->corners,
                            (const double(*)[3])map->lists->vertices};
    if (map->info.occluders == SHB_OCCLUDERS_TRIANGLES && map->occluders.held)
        return (drawn_mesh){t->triangle_count, (const uint32_t(*)[3])t->corners,
                            (const double(*)[3])t->positions};
    return (drawn_mesh){0};
}

/* A triangle from its first corner on, as the truth has it, and how far positions may be off. */
typedef struct placed_triangle {
    double corner[3], way_1[3], way_2[3], slack[3];
} placed_triangle;

static placed_triangle triangle_of(const drawn_mesh *mesh, uint32_t id) {
    const uint32_t *corners = mesh->corners[id];
    const double *a = mesh->vertices[corners[0]], *b = mesh->vertices[corners[1]];
    const double *c = mesh->vertices[corners[2]];
    placed_triangle t;
    for (int k = 0; k < 3; k++) {
        t.corner[k] = a[k];
        t.way_1[k] = b[k] - a[k];
        t.way_2[k] = c[k] - a[k];
        t.slack[k] = AGREEMENT * (fabs(a[k]) + fabs(b[k]) + fabs(c[k]));
    }
    return t;
}

static double place(const placed_triangle *t, int k, double weight_1, double weight_2) {
    return t->corner[k] + (t->way_1[k] * weight_1 + t->way_2[k] * weight_2);
}

/* Neighbours often share their triangle: the first point of each run, and the end. */
static size_t find_runs(const uint32_t *ids, size_t count, uint16_t starts[SHB_BATCH + 1]) {
    size_t runs = 0;
    for (size_t i = 0; i < count; i++) {
        starts[runs] = (uint16_t)i;
        runs += i == 0 || ids[i] != ids[i - 1];
    }
    starts[runs] = (uint16_t)count;
    return runs;
}

/* Corners and vertices come from all over the memory: they are asked for before any is read. False:
 * there is no such triangle. */
static bool fetch_triangles(const drawn_mesh *mesh, const uint32_t *ids, size_t runs,
                            const uint16_t *starts) {
    for (size_t n = 0; n < runs; n++) {
        if (ids[starts[n]] >= mesh->triangle_count)
            return false;
        __builtin_prefetch(mesh->corners[ids[starts[n]]]);
    }
    for (size_t n = 0; n < runs; n++)
        for (int k = 0; k < 3; k++)
            __builtin_prefetch(mesh->vertices[mesh->corners[ids[starts[n]]][k]]);
    return true;
}

/* False: a point is far from where it should be. */
static bool place_all(const shb_map *map, const shb_own_triangles *own, const shb_receivers *r,
                      shb_exact_points *points) {
    const drawn_mesh mesh = mesh_of(map);
    uint16_t starts[SHB_BATCH + 1];
    const size_t runs = find_runs(own->ids, points->count, starts);
    bool agrees = fetch_triangles(&mesh, own->ids, runs, starts);
    for (size_t n = 0; n < runs && agrees; n++) {
        const placed_triangle t = triangle_of(&mesh, own->ids[starts[n]]);
        for (size_t i = starts[n]; i < starts[n + 1]; i++) {
            const double weight_1 = (double)own->weight_1[i], weight_2 = (double)own->weight_2[i];
            points->x[i] = place(&t, 0, weight_1, weight_2);
            points->y[i] = place(&t, 1, weight_1, weight_2);
            points->z[i] = place(&t, 2, weight_1, weight_2);
            agrees &= (fabs(points->x[i] - (double)r->x[i]) <= t.slack[0]) &
                      (fabs(points->y[i] - (double)r->y[i]) <= t.slack[1]) &
                      (fabs(points->z[i] - (double)r->z[i]) <= t.slack[2]);
        }
    }
    return agrees;
}

static void fill_group(shb_exact_points *points) {
    const size_t last = points->count - 1;
    for (size_t i = points->count; i % SHB_LIST_GROUP; i++) {
        points->x[i] = points->x[last];
        points->y[i] = points->y[last];
        points->z[i] = points->z[last];
        points->own_ids[i] = points->own_ids[last];
    }
}

void shb_exact_points_of(const shb_map *map, size_t count, const shb_own_triangles *own,
                         const shb_receivers *r, shb_exact_points *points) {
    points->count = count;
    points->are_exact = own && own->ids && own->weight_1 && place_all(map, own, r, points);
    points->has_ids = own && own->ids && (points->are_exact || !own->weight_1);
    if (!points->are_exact)
        for (size_t i = 0; i < count; i++) {
            points->x[i] = (double)r->x[i];
            points->y[i] = (double)r->y[i];
            points->z[i] = (double)r->z[i];
        }
    for (size_t i = 0; i < count; i++)
        points->own_ids[i] = points->has_ids ? own->ids[i] : SHB_ID_NONE;
    fill_group(points);
}

void shb_exact_points_pick(const shb_exact_points *from, const uint16_t *numbers, size_t count,
                           shb_exact_points *to) {
    to->count = count;
    to->has_ids = from->has_ids;
    to->are_exact = from->are_exact;
    for (size_t k = 0; k < count; k++) {
        const size_t i = numbers[k];
        to->x[k] = from->x[i];
        to->y[k] = from->y[i];
        to->z[k] = from->z[i];
        to->own_ids[k] = from->own_ids[i];
    }
    fill_group(to);
}

shb_result shb_own_triangles_check(const shb_map *map, const char *caller,
                                   const shb_points *points) {
    const shb_own_triangles *own = &points->own;
    const size_t triangles = mesh_of(map).triangle_count;
    if (!own->ids || !map->occluders.held ||
        (map->info.occluders != SHB_OCCLUDERS_TRIANGLES &&
         map->info.occluders != SHB_OCCLUDERS_LISTS))
        return SHB_OK;
    for (size_t i = 0; i < points->count; i++)
        if (own->ids[i] >= triangles && (own->weight_1 || own->ids[i] != SHB_ID_NONE))
            return shb_fail(map->context, SHB_ERROR_ARGUMENT,
                            "%s: points.own.ids[%zu] is %u and the map's scene has %zu triangles",
                            caller, i, (unsigned)own->ids[i], triangles);
    return SHB_OK;
}
