/* Asking lists. Where the bounds of rounding leave a triangle in doubt, because the ray passes an
 * edge, the point lies on the triangle or the light sees it edge-on, the reference's own test of
 * the ray decides. */
#include "strict.h"

#include "lists.h"

#include <math.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

/* Points that are asked in steps, so that the memory of many is on its way at the same time. */
enum { GROUP = SHB_LIST_GROUP };

/* What a point that its cell does not decide has to ask. */
typedef struct question {
    const uint32_t *entry, *end;
    uint32_t number; /* of the point, in the group */
} question;

/* A group while it is asked. */
typedef struct inquiry {
    const shb_lists *lists;
    const uint32_t *own_ids; /* of the group's points, or NULL */
    double rounding;
    shb_list_group g;
    size_t count;
    const shb_list_cell *cells[GROUP]; /* NULL: nothing is near */
    const uint32_t *entries[GROUP];    /* of the cells' tiles */
    question questions[GROUP];
    double places[3][GROUP]; /* of points that are not where the host has them */
} inquiry;

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
static double distance_rounding(const inquiry *q, const shb_list_plane *plane, uint32_t number) {
    const double(*rows)[4] = q->lists->frame.rows;
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        const double change = (rows[2][i] + plane->x * rows[0][i]) +
                              (plane->y * rows[1][i] + plane->one * rows[3][i]);
        sum += fabs(change) * fabs(q->g.world[i][number]);
    }
    return sum * (1 + 0x1p-20) * q->g.inverse_w[number] * q->rounding;
}

static bool is_finite(const shb_triangle *triangle) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (!isfinite(triangle->corners[k][i]))
                return false;
    return true;
}

static uint32_t own_id_of(const inquiry *q, uint32_t number) {
    return q->own_ids ? q->own_ids[number] : SHB_ID_NONE;
}

/* Decides a triangle in doubt by the ray. */
static bool blocks_ray(const inquiry *q, uint32_t id, uint32_t number) {
    const shb_lists *lists = q->lists;
    const double *const *at = q->g.world;
    shb_ray ray;
    if (!shb_ray_to_light(&lists->frame.light,
                          (shb_vec3){at[0][number], at[1][number], at[2][number]}, &ray))
        return false;
    const shb_triangle triangle = shb_lists_triangle(lists, id);
    if (q->rounding > 0)
        return shb_ray_line_meets(&ray, &triangle);
    if (lists->triangles[id].margin == HUGE_VALF)
        ray.limit = near_limit(&lists->frame, &ray);
    const uint32_t own_id = own_id_of(q, number);
    if (own_id >= lists->id_count)
        return shb_ray_is_blocked(&ray, &triangle, NULL);
    const shb_triangle own = shb_lists_triangle(lists, own_id);
    return shb_ray_is_blocked(&ray, &triangle, is_finite(&own) ? &own : NULL);
}

/* Decides a triangle that the point's ray meets, or nearly so; inside: it passes no edge. */
static bool blocks(const inquiry *q, uint32_t id, uint32_t number, bool inside) {
    const shb_list_triangle *t = &q->lists->triangles[id];
    const shb_list_plane *plane = &q->lists->planes[id];
    const shb_list_group *g = &q->g;
    const double depth = g->depth[number], scale = g->scale[number];
    const double behind = shb_list_behind(plane, g->x[number], g->y[number], depth);
    const double bound = (double)t->bound * scale;
    const bool is_rounded = q->rounding > 0;
    const double least = is_rounded ? bound + distance_rounding(q, plane, number) : -bound;
    if (!(behind > least))
        return false;
    if (inside && (is_rounded || behind > (double)t->clear * scale))
        return true;
    if (is_rounded && depth - behind < q->lists->frame.near_depth)
        return false;
    return blocks_ray(q, id, number);
}

/* The functions of a triangle at a point. */
static inline void evaluate(const shb_list_triangle *t, float x, float y, float depth,
                            float f[SHB_LIST_FUNCTIONS]) {
    for (int i = 0; i < SHB_LIST_FUNCTIONS; i++)
        f[i] = (t->x[i] * x + t->y[i] * y) + t->one[i];
    f[SHB_LIST_DEPTH] += depth;
}

/* One bit for each of the functions that has a minus sign. */
static inline uint32_t signs_of(const shb_list_triangle *t, float x, float y, float depth) {
#if defined(__SSE2__)
    const __m128 x_part = _mm_mul_ps(_mm_load_ps(t->x), _mm_set1_ps(x));
    const __m128 y_part = _mm_mul_ps(_mm_load_ps(t->y), _mm_set1_ps(y));
    const __m128 sum = _mm_add_ps(_mm_add_ps(x_part, y_part), _mm_load_ps(t->one));
    return (uint32_t)_mm_movemask_ps(_mm_add_ps(sum, _mm_setr_ps(-0.0f, -0.0f, -0.0f, depth)));
#else
    float f[SHB_LIST_FUNCTIONS];
    uint32_t signs = 0;
    evaluate(t, x, y, depth, f);
    for (int i = 0; i < SHB_LIST_FUNCTIONS; i++)
        signs |= (uint32_t)(signbit(f[i]) != 0) << i;
    return signs;
#endif
}

/* The ray passes no edge. */
static bool is_inside(const shb_list_triangle *t, float x, float y) {
    float f[SHB_LIST_FUNCTIONS];
    const float margin = 2 * t->margin;
    evaluate(t, x, y, 0, f);
    return (f[0] > margin) & (f[1] > margin) & (f[2] > margin);
}

/* Entries are looked at a few at a time, because what single ones say cannot be foreseen; those
 * behind the last one are other cells', and their answers are not used. */
static bool is_blocked(const inquiry *q, const question *asked) {
    const shb_list_triangle *triangles = q->lists->triangles;
    const uint32_t number = asked->number, own_id = own_id_of(q, number);
    const float x = (float)q->g.x[number], y = (float)q->g.y[number];
    const float depth = (float)q->g.depth[number];
    for (const uint32_t *entry = asked->entry; entry < asked->end; entry += SHB_LIST_STEP) {
        const size_t left = (size_t)(asked->end - entry);
        uint32_t signs = signs_of(&triangles[entry[0]], x, y, depth);
        for (int i = 1; i < SHB_LIST_STEP && left > 1; i++)
            signs |= signs_of(&triangles[entry[i]], x, y, depth) << 4 * i;
        const uint32_t used = left < SHB_LIST_STEP ? (1u << 4 * left) - 1 : 0xffff;
        uint32_t met = ~(signs | signs >> 1 | signs >> 2 | signs >> 3) & used & 0x1111;
        for (; met; met &= met - 1) {
            const uint32_t id = entry[__builtin_ctz(met) / 4];
            if (id != own_id && blocks(q, id, number, is_inside(&triangles[id], x, y)))
                return true;
        }
        if (signs & 0x8888)
            return false;
    }
    return false;
}

/* A point outside the scene is rounded too much for the functions: all triangles are in doubt. */
static bool is_blocked_outside(const inquiry *q, const question *asked) {
    for (const uint32_t *entry = asked->entry; entry < asked->end; entry++)
        if (*entry != own_id_of(q, asked->number) && blocks(q, *entry, asked->number, false))
            return true;
    return false;
}

/* From the first corner, as the truth has it. */
static void place_on_triangles(inquiry *q, const float *weight_1, const float *weight_2) {
    const shb_lists *lists = q->lists;
    for (size_t k = 0; k < GROUP; k++) {
        const size_t point = k < q->count ? k : q->count - 1;
        const uint32_t *corners = lists->corners[q->own_ids[point]];
        const double *a = lists->vertices[corners[0]], *b = lists->vertices[corners[1]];
        const double *c = lists->vertices[corners[2]];
        for (int i = 0; i < 3; i++)
            q->places[i][k] = a[i] + ((b[i] - a[i]) * (double)weight_1[point] +
                                      (c[i] - a[i]) * (double)weight_2[point]);
    }
}

/* Whole groups are read where they are; the last point fills up another. */
static void load(inquiry *q, const shb_list_points *points, size_t first) {
    const size_t rest = points->count - first;
    const double *const from[3] = {points->x, points->y, points->z};
    q->count = rest < GROUP ? rest : GROUP;
    q->own_ids = points->own_ids ? points->own_ids + first : NULL;
    if (points->weight_1)
        place_on_triangles(q, points->weight_1 + first, points->weight_2 + first);
    for (int i = 0; i < 3; i++) {
        q->g.world[i] = q->places[i];
        if (points->weight_1)
            continue;
        if (q->count == GROUP)
            q->g.world[i] = from[i] + first;
        for (size_t k = 0; q->count < GROUP && k < GROUP; k++)
            q->places[i][k] = from[i][first + (k < q->count ? k : q->count - 1)];
    }
}

static void find_cells(inquiry *q) {
    const shb_lists *lists = q->lists;
    for (size_t i = 0; i < q->count; i++) {
        q->cells[i] = NULL;
        if (q->g.column[i] < 0)
            continue;
        const uint32_t column = (uint32_t)q->g.column[i], row = (uint32_t)q->g.row[i];
        const shb_list_tile *tile =
            &lists->tiles[(size_t)(row / SHB_LIST_TILE) * lists->tile_columns +
                          column / SHB_LIST_TILE];
        if (tile->cell_bits < 0)
            continue;
        q->cells[i] =
            &lists->cells[shb_list_cell_of(tile, column % SHB_LIST_TILE, row % SHB_LIST_TILE)];
        q->entries[i] = lists->entries + tile->first_entry;
        __builtin_prefetch(q->cells[i]);
    }
}

/* Answers the points that their cells decide; returns how many questions are left. */
static size_t ask_cells(inquiry *q, float *visibility) {
    size_t left = 0;
    for (size_t i = 0; i < q->count; i++) {
        const shb_list_cell *cell = q->cells[i];
        visibility[i] = 1;
        if (!cell)
            continue;
        if (q->g.depth[i] > (double)cell->far && q->g.scale[i] == 1) {
            visibility[i] = 0;
            continue;
        }
        const uint32_t start = cell[0].start, end = cell[1].start;
        q->questions[left] = (question){q->entries[i] + start, q->entries[i] + end, (uint32_t)i};
        __builtin_prefetch(q->entries[i] + start);
        left += start < end;
    }
    return left;
}

static void fetch_triangles(const inquiry *q, const question *asked) {
    const int count = asked->end - asked->entry > 1 ? SHB_LIST_STEP : 1;
    for (int i = 0; i < count; i++)
        __builtin_prefetch(&q->lists->triangles[asked->entry[i]]);
    __builtin_prefetch(&q->lists->planes[asked->entry[0]]);
}

static void ask_group(inquiry *q, float *visibility) {
    shb_list_kernels_of(q->lists->context->isa)->locate(&q->lists->frame, &q->g);
    find_cells(q);
    const size_t left = ask_cells(q, visibility);
    for (size_t k = 0; k < left; k++)
        fetch_triangles(q, &q->questions[k]);
    for (size_t k = 0; k < left; k++) {
        const question *asked = &q->questions[k];
        const bool is_near = q->g.scale[asked->number] == 1;
        if ((is_near ? is_blocked : is_blocked_outside)(q, asked))
            visibility[asked->number] = 0;
    }
}

void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility) {
    inquiry q;
    q.lists = lists;
    q.rounding = points->weight_1 ? 0 : points->rounding;
    for (size_t first = 0; first < points->count; first += GROUP) {
        load(&q, points, first);
        ask_group(&q, visibility + first);
    }
}
