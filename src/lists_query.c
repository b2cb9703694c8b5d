/* Asking lists. Where the bounds of rounding leave a triangle in doubt, because the ray passes an
 * edge, the point lies on the triangle or the light sees it edge-on, the reference's own test of
 * the ray decides. */
#include "strict.h"

#include "lists.h"

#include <math.h>

enum { GROUP = SHB_LIST_GROUP };

/* One point of a group. */
typedef struct point {
    double x, y, depth;
    double world[3];
    double inverse_w;
    double scale;
    double rounding;
    uint32_t own_id;
} point;

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

static bool is_blocked(const shb_lists *lists, const point *p, const uint32_t *entry,
                       const uint32_t *end) {
    const float x = (float)p->x, y = (float)p->y, scale = (float)p->scale;
    for (; entry < end; entry++) {
        const uint32_t id = *entry;
        if (entry + 1 < end)
            __builtin_prefetch(&lists->triangles[entry[1]]);
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

/* From one of its own triangle's corners, as the truth has it. */
static void place_on_triangle(const shb_lists *lists, uint32_t id, double weight_1, double weight_2,
                              double place[3]) {
    const uint32_t *corners = lists->corners[id];
    const double *a = lists->vertices[corners[0]], *b = lists->vertices[corners[1]];
    const double *c = lists->vertices[corners[2]];
    for (int i = 0; i < 3; i++)
        place[i] = a[i] + ((b[i] - a[i]) * weight_1 + (c[i] - a[i]) * weight_2);
}

/* The last point fills up the group. */
static void load(const shb_lists *lists, const shb_list_points *points, size_t first, size_t count,
                 shb_list_group *g) {
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
        for (int axis = 0; axis < 3; axis++)
            g->world[axis][i] = place[axis];
    }
}

static point point_of(const shb_list_group *g, size_t i, const shb_list_points *points, size_t k) {
    return (point){.x = g->x[i],
                   .y = g->y[i],
                   .depth = g->depth[i],
                   .world = {g->world[0][i], g->world[1][i], g->world[2][i]},
                   .inverse_w = g->inverse_w[i],
                   .scale = g->scale[i],
                   .rounding = points->weight_1 ? 0 : points->rounding,
                   .own_id = points->own_ids ? points->own_ids[k] : SHB_ID_NONE};
}

/* What a point that its cell does not decide has to ask. */
typedef struct question {
    const uint32_t *entry, *end;
    uint32_t number; /* in the group */
} question;

/* Where the entries of the points' cells are; NULL where there are none. */
static void find_cells(const shb_lists *lists, const shb_list_group *g, size_t count,
                       const shb_list_cell *cells[GROUP], const uint32_t *entries[GROUP]) {
    for (size_t i = 0; i < count; i++) {
        cells[i] = NULL;
        if (g->column[i] < 0)
            continue;
        const uint32_t column = (uint32_t)g->column[i], row = (uint32_t)g->row[i];
        const shb_list_tile *tile =
            &lists->tiles[(size_t)(row / SHB_LIST_TILE) * lists->tile_columns +
                          column / SHB_LIST_TILE];
        if (tile->cell_bits < 0)
            continue;
        cells[i] =
            &lists->cells[shb_list_cell_of(tile, column % SHB_LIST_TILE, row % SHB_LIST_TILE)];
        entries[i] = lists->entries + tile->first_entry;
        __builtin_prefetch(cells[i]);
    }
}

/* Answers the points that their cells decide; returns how many questions are left. */
static size_t ask_cells(const shb_list_group *g, size_t count, const shb_list_cell *const *cells,
                        const uint32_t *const *entries, question *questions, float *visibility) {
    size_t left = 0;
    for (size_t i = 0; i < count; i++) {
        visibility[i] = 1;
        if (!cells[i])
            continue;
        if (g->depth[i] > (double)cells[i]->far && g->scale[i] == 1) {
            visibility[i] = 0;
            continue;
        }
        const uint32_t start = cells[i][0].start, end = cells[i][1].start;
        questions[left] = (question){entries[i] + start, entries[i] + end, (uint32_t)i};
        left += start < end;
        __builtin_prefetch(entries[i] + start);
    }
    return left;
}

/* In steps, so that the memory of many points is on its way at the same time. */
void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility) {
    const shb_list_kernels *kernels = shb_list_kernels_of(lists->context->isa);
    for (size_t first = 0; first < points->count; first += GROUP) {
        const size_t rest = points->count - first, count = rest < GROUP ? rest : GROUP;
        shb_list_group g;
        const shb_list_cell *cells[GROUP];
        const uint32_t *entries[GROUP];
        question questions[GROUP];
        load(lists, points, first, count, &g);
        kernels->locate(&lists->frame, &g);
        find_cells(lists, &g, count, cells, entries);
        const size_t left = ask_cells(&g, count, cells, entries, questions, visibility + first);
        for (size_t i = 0; i < left; i++)
            __builtin_prefetch(&lists->triangles[*questions[i].entry]);
        for (size_t i = 0; i < left; i++) {
            const size_t number = questions[i].number;
            const point p = point_of(&g, number, points, first + number);
            if (is_blocked(lists, &p, questions[i].entry, questions[i].end))
                visibility[first + number] = 0;
        }
    }
}
