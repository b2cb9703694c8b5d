/* Asking lists. Where the bounds of rounding leave a triangle in doubt, because the ray passes an
 * edge, the point lies on the triangle or the light sees it edge-on, the reference's own test of
 * the ray decides. */
#include "strict.h"

#include "lists.h"

#include <math.h>

/* Points that are asked in steps, so that the memory of several is on its way at the same time. */
enum { GROUP = 32 };

/* Points in the world and as the light sees them. */
typedef struct group {
    SHB_ALIGN double world[3][GROUP];
    double x[GROUP], y[GROUP], depth[GROUP], inverse_w[GROUP];
    double scale[GROUP]; /* of the triangles' bounds: above 1 where a point is outside the scene */
} group;

/* A point and what its cell holds: nothing outside the view. */
typedef struct point {
    double x, y, depth;
    double world[3];
    double inverse_w;
    double scale;
    double rounding;
    uint32_t own_id;
    const uint32_t *entry, *end;
} point;

static double larger(double a, double b) {
    return a > b ? a : b;
}

static void project(const shb_list_frame *frame, group *restrict g) {
    const double *const x = frame->rows[0], *const y = frame->rows[1];
    const double *const z = frame->rows[2], *const w = frame->rows[3];
    const double reach = frame->reach;
    for (int i = 0; i < GROUP; i++) {
        const double px = g->world[0][i], py = g->world[1][i], pz = g->world[2][i];
        const double at_w = shb_list_row(w, px, py, pz);
        const double inverse_w = at_w > 0 ? 1 / at_w : (double)NAN;
        g->x[i] = shb_list_row(x, px, py, pz) * inverse_w;
        g->y[i] = shb_list_row(y, px, py, pz) * inverse_w;
        g->depth[i] = shb_list_row(z, px, py, pz) * inverse_w;
        g->inverse_w[i] = inverse_w;
        const double size = larger(larger(fabs(px), fabs(py)), fabs(pz));
        g->scale[i] = size > reach ? size / reach : 1;
    }
}

/* The parameter of a ray at which it leaves what lies behind the near plane. */
static double near_limit(const shb_list_frame *frame, const shb_ray *ray) {
    double row[4];
    for (int i = 0; i < 4; i++)
        row[i] = frame->rows[2][i] - frame->near_depth * frame->rows[3][i];
    const double *o = ray->origin;
    const double at_point = shb_list_row(row, o[0], o[1], o[2]);
    const double along =
        row[0] * ray->direction[0] + row[1] * ray->direction[1] + row[2] * ray->direction[2];
    return at_point / -along;
}

/* The change of the distance behind a plane by the point's own rounding. */
static double distance_rounding(const shb_list_frame *frame, const shb_list_triangle *triangle,
                                const point *p) {
    const double *plane = triangle->plane;
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const double change = (frame->rows[2][i] + plane[0] * frame->rows[0][i]) +
                              (plane[1] * frame->rows[1][i] + plane[2] * frame->rows[3][i]);
        sum += fabs(change) * fabs(p->world[i]);
    }
    return sum * (1 + 0x1p-20) * p->inverse_w * p->rounding;
}

static bool is_finite(const shb_triangle *triangle) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (!isfinite(triangle->corners[k][i]))
                return false;
    return true;
}

/* Decides a triangle in doubt for an exact point. */
static bool blocks_ray(const shb_lists *lists, uint32_t id, const point *p, shb_ray *ray) {
    const shb_triangle triangle = shb_lists_triangle(lists, id);
    if (lists->triangles[id].margin == HUGE_VALF)
        ray->limit = near_limit(&lists->frame, ray);
    if (p->own_id >= lists->id_count)
        return shb_ray_is_blocked(ray, &triangle, NULL);
    const shb_triangle own = shb_lists_triangle(lists, p->own_id);
    return shb_ray_is_blocked(ray, &triangle, is_finite(&own) ? &own : NULL);
}

/* Decides a triangle in doubt; behind is how far the point lies behind its plane, inside whether
 * its ray passes no edge. */
static bool blocks_exactly(const shb_lists *lists, uint32_t id, const point *p, double behind,
                           bool inside) {
    const shb_list_triangle *t = &lists->triangles[id];
    if (p->rounding > 0) {
        const double bound = (double)t->bound * p->scale;
        if (!(behind > bound) || !(behind > bound + distance_rounding(&lists->frame, t, p)) ||
            p->depth - behind < lists->frame.near_depth)
            return false;
        if (inside)
            return true;
    }
    shb_ray ray;
    const shb_vec3 at = {p->world[0], p->world[1], p->world[2]};
    if (!shb_ray_to_light(&lists->frame.light, at, &ray))
        return false;
    if (!(p->rounding > 0))
        return blocks_ray(lists, id, p, &ray);
    const shb_triangle triangle = shb_lists_triangle(lists, id);
    return shb_ray_line_meets(&ray, &triangle);
}

static bool is_blocked(const shb_lists *lists, const point *p) {
    const float x = (float)p->x, y = (float)p->y, scale = (float)p->scale;
    for (const uint32_t *entry = p->entry; entry < p->end; entry++) {
        const uint32_t id = *entry;
        if (id == p->own_id)
            continue;
        const shb_list_triangle *t = &lists->triangles[id];
        if (p->depth < (double)t->nearest)
            return false;
        const float u = (t->u[0] * x + t->u[1] * y) + t->u[2];
        const float v = (t->v[0] * x + t->v[1] * y) + t->v[2];
        const float w = (1 - u) - v, margin = t->margin * scale;
        const float lesser = u < v ? u : v, least = lesser < w ? lesser : w;
        const double behind = ((t->plane[0] * p->x + t->plane[1] * p->y) + t->plane[2]) + p->depth;
        if ((least < -margin) | (behind < -(double)t->bound * p->scale))
            continue;
        const bool inside = least > margin;
        if (inside && behind > (double)t->clear * p->scale)
            return true;
        if (blocks_exactly(lists, id, p, behind, inside))
            return true;
    }
    return false;
}

/* True where the cell alone decides that the point is in shadow. */
static bool find_entries(const shb_lists *lists, point *p) {
    const shb_list_frame *frame = &lists->frame;
    p->entry = p->end = NULL;
    const bool is_seen = p->x >= 0 && p->x < frame->width && p->y >= 0 && p->y < frame->height &&
                         fabs(p->depth) < HUGE_VAL;
    if (!is_seen)
        return false;
    const uint32_t column = (uint32_t)p->x, row = (uint32_t)p->y;
    const shb_list_tile *tile =
        &lists->tiles[(size_t)(row / SHB_LIST_TILE) * lists->tile_columns + column / SHB_LIST_TILE];
    if (tile->cell_bits < 0)
        return false;
    const shb_list_cell *cell =
        &lists->cells[shb_list_cell_of(tile, column % SHB_LIST_TILE, row % SHB_LIST_TILE)];
    const uint32_t *entries = lists->entries + tile->first_entry;
    p->entry = entries + cell[0].start;
    p->end = entries + cell[1].start;
    return p->scale == 1 && p->depth > (double)cell->far;
}

/* From one of its own triangle's corners, as the truth has it. */
static void place_on_triangle(const shb_lists *lists, uint32_t id, double weight_1, double weight_2,
                              double place[3]) {
    const uint32_t *corners = lists->corners[id];
    const double *a = lists->vertices[corners[0]], *b = lists->vertices[corners[1]];
    const double *c = lists->vertices[corners[2]];
    for (int i = 0; i < 3; i++)
        place[i] = a[i] + ((b[i] - a[i]) * weight_1 + (c[i] - a[i]) * weight_2);
}

static void load(const shb_lists *lists, const shb_list_points *points, size_t first, size_t count,
                 group *g) {
    for (size_t i = 0; i < GROUP; i++) {
        const size_t k = first + (i < count ? i : count - 1);
        double place[3];
        if (points->weight_1) {
            place_on_triangle(lists, points->own_ids[k], (double)points->weight_1[k],
                              (double)points->weight_2[k], place);
        } else {
            place[0] = points->x[k];
            place[1] = points->y[k];
            place[2] = points->z[k];
        }
        g->world[0][i] = place[0];
        g->world[1][i] = place[1];
        g->world[2][i] = place[2];
    }
}

static point point_of(const group *g, size_t i, const shb_list_points *points, size_t k) {
    return (point){.x = g->x[i],
                   .y = g->y[i],
                   .depth = g->depth[i],
                   .world = {g->world[0][i], g->world[1][i], g->world[2][i]},
                   .inverse_w = g->inverse_w[i],
                   .scale = g->scale[i],
                   .rounding = points->weight_1 ? 0 : points->rounding,
                   .own_id = points->own_ids ? points->own_ids[k] : SHB_ID_NONE};
}

void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility) {
    for (size_t first = 0; first < points->count; first += GROUP) {
        const size_t left = points->count - first, count = left < GROUP ? left : GROUP;
        group g;
        point open[GROUP];
        size_t numbers[GROUP], open_count = 0;
        load(lists, points, first, count, &g);
        project(&lists->frame, &g);
        for (size_t i = 0; i < count; i++) {
            point *p = &open[open_count];
            *p = point_of(&g, i, points, first + i);
            const bool is_hidden = find_entries(lists, p);
            visibility[first + i] = is_hidden ? 0 : 1;
            numbers[open_count] = first + i;
            open_count += !is_hidden && p->entry < p->end;
        }
        for (size_t i = 0; i < open_count; i++)
            __builtin_prefetch(&lists->triangles[*open[i].entry]);
        for (size_t i = 0; i < open_count; i++)
            if (is_blocked(lists, &open[i]))
                visibility[numbers[i]] = 0;
    }
}
