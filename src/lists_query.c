/* Asking lists. Where the bounds of rounding leave a triangle in doubt, because the ray passes an
 * edge, the point lies on the triangle or the light sees it edge-on, the reference's own test of
 * the ray decides. */
#include "strict.h"

#include "lists.h"

#include <math.h>

/* A point as the light sees it, and the entries of its texel: none outside the view. */
typedef struct point {
    double x, y, depth;
    double world[3];
    double inverse_w;
    double scale; /* of the triangles' bounds: above 1 where the point lies outside the scene */
    double rounding;
    uint32_t own_id;
    const uint32_t *entry, *end;
} point;

static double larger(double a, double b) {
    return a > b ? a : b;
}

static void project(const shb_lists *lists, point *p) {
    const shb_list_frame *frame = &lists->frame;
    const double *at = p->world;
    const double w = shb_list_row(frame->rows[3], at[0], at[1], at[2]);
    p->inverse_w = 1 / w;
    p->x = shb_list_row(frame->rows[0], at[0], at[1], at[2]) * p->inverse_w;
    p->y = shb_list_row(frame->rows[1], at[0], at[1], at[2]) * p->inverse_w;
    p->depth = shb_list_row(frame->rows[2], at[0], at[1], at[2]) * p->inverse_w;
    const double reach = larger(larger(fabs(at[0]), fabs(at[1])), fabs(at[2]));
    p->scale = reach > frame->reach ? reach / frame->reach : 1;
    p->entry = p->end = NULL;
    const bool is_seen = w > 0 && p->x >= 0 && p->x < frame->width && p->y >= 0 &&
                         p->y < frame->height && fabs(p->depth) < HUGE_VAL;
    if (is_seen)
        shb_lists_entries(lists, (uint32_t)p->x, (uint32_t)p->y, &p->entry, &p->end);
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

/* The change of the depth function by the point's own rounding. */
static double depth_rounding(const shb_list_triangle *triangle, const point *p) {
    const float *n = triangle->normal;
    return ((double)n[0] * fabs(p->world[0]) + (double)n[1] * fabs(p->world[1]) +
            (double)n[2] * fabs(p->world[2])) *
           p->inverse_w * p->rounding;
}

/* Decides a triangle in doubt; depth is how far the point lies behind its plane. */
static bool blocks_exactly(const shb_lists *lists, uint32_t number, const point *p, double depth) {
    const shb_list_frame *frame = &lists->frame;
    const shb_list_triangle *triangle = &lists->triangles[number];
    const shb_triangle *source = &lists->source[triangle->id];
    const shb_vec3 at = {p->world[0], p->world[1], p->world[2]};
    const bool is_rounded = p->rounding > 0;
    if (is_rounded) {
        const double bound = (double)triangle->depth_bound * p->scale + depth_rounding(triangle, p);
        if (!(depth > bound) || p->depth - depth < frame->near_depth)
            return false;
    }
    shb_ray ray;
    if (!shb_ray_to_light(&frame->light, at, &ray))
        return false;
    if (is_rounded)
        return shb_ray_line_meets(&ray, source);
    if (triangle->crosses_near)
        ray.limit = near_limit(frame, &ray);
    const bool has_own = p->own_id < lists->id_count && lists->source[p->own_id].id == p->own_id;
    return shb_ray_is_blocked(&ray, source, has_own ? &lists->source[p->own_id] : NULL);
}

static bool is_blocked(const shb_lists *lists, const point *p) {
    for (const uint32_t *entry = p->entry; entry < p->end; entry++) {
        const shb_list_triangle *t = &lists->triangles[*entry];
        if (p->depth < (double)t->nearest)
            return false;
        const double edge_bound = (double)t->edge_bound * p->scale;
        const double depth_bound = (double)t->depth_bound * p->scale;
        double f[SHB_LIST_FUNCTIONS];
        for (int i = 0; i < SHB_LIST_FUNCTIONS; i++)
            f[i] = (t->x[i] * p->x + t->y[i] * p->y) + t->one[i];
        const double depth = f[SHB_LIST_DEPTH] + p->depth;
        if (f[0] < -edge_bound || f[1] < -edge_bound || f[2] < -edge_bound ||
            depth < -depth_bound || t->id == p->own_id)
            continue;
        const bool is_clear = f[0] > edge_bound && f[1] > edge_bound && f[2] > edge_bound &&
                              depth > depth_bound + depth_rounding(t, p) && !t->crosses_near;
        if (is_clear || blocks_exactly(lists, *entry, p, depth))
            return true;
    }
    return false;
}

static void fetch_first(const shb_lists *lists, const point *p) {
    if (p->entry == p->end)
        return;
    const char *triangle = (const char *)&lists->triangles[*p->entry];
    __builtin_prefetch(triangle);
    __builtin_prefetch(triangle + 64);
}

/* In steps, so that the memory of several points is on its way at the same time. */
void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility) {
    enum { GROUP = 16 };
    point group[GROUP];
    for (size_t first = 0; first < points->count; first += GROUP) {
        const size_t left = points->count - first, count = left < GROUP ? left : GROUP;
        for (size_t i = 0; i < count; i++) {
            const size_t k = first + i;
            point *p = &group[i];
            *p = (point){.world = {points->x[k], points->y[k], points->z[k]},
                         .rounding = points->rounding,
                         .own_id = points->own_ids ? points->own_ids[k] : SHB_ID_NONE};
            project(lists, p);
        }
        for (size_t i = 0; i < count; i++)
            fetch_first(lists, &group[i]);
        for (size_t i = 0; i < count; i++)
            visibility[first + i] = is_blocked(lists, &group[i]) ? 0 : 1;
    }
}
