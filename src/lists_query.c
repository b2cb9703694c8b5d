/* Asking lists. Points are asked in groups, step by step, so that the memory of many is on its way
 * at the same time: where the light sees them, their cells, the entries of these that begin in
 * front of them, the triangles of those. Where the bounds of rounding leave a triangle in doubt,
 * because the ray passes an edge, the point lies on the triangle or the light sees it edge-on, the
 * reference's own test of the ray decides.
 *
 * Before, each point went through its cell's entries by itself, front to back up to the first that
 * begins behind it. Runs, steps without branches and depths by cell instead of by triangle took the
 * time to 0.6 to 0.7 of that among large triangles, to 0.8 or as much among small ones, and to 1.1
 * where two million records leave every cache. Groups of 256 in place of 64, texels in place of
 * points and later entries fetched took it to 0.65 to 0.75 once more. */
#include "strict.h"

#include "lists.h"

#include <math.h>

enum { GROUP = SHB_LIST_POINTS };

/* Of points near which nothing is. */
static const shb_list_cell NO_CELL[2] = {{0, HUGE_VALF}, {0, HUGE_VALF}};

/* A group while it is asked. */
typedef struct inquiry {
    const shb_lists *lists;
    double rounding;
    shb_list_group g;
    int32_t changes[GROUP + SHB_LIST_LANES]; /* first points of cells */
    size_t span_count;
    shb_list_span spans[GROUP + 1]; /* and one for the end */
    size_t run_count;
    shb_list_run runs[GROUP];
    shb_list_question questions[GROUP * SHB_LIST_STEP];
    double places[3][GROUP]; /* of a group that is not whole */
} inquiry;

/* The parameter of a ray at which it leaves what lies behind the near plane; 0: it never was there.
 */
static double near_limit(const shb_list_frame *frame, const shb_ray *ray) {
    double row[4];
    for (int i = 0; i < 4; i++)
        row[i] = frame->rows[2][i] - frame->near_depth * frame->rows[3][i];
    const double *o = ray->origin;
    const double at_point = shb_list_row(row, o[0], o[1], o[2]);
    const double along =
        row[0] * ray->direction[0] + row[1] * ray->direction[1] + row[2] * ray->direction[2];
    return at_point > 0 ? at_point / -along : 0;
}

/* The change of the distance behind a plane by the point's own rounding; most: if all coordinates
 * were as large as the largest. */
static double distance_rounding(const inquiry *q, const shb_list_triangle *t, size_t number,
                                double *most) {
    double changes[3], sum = 0, all = 0, size = 0;
    shb_list_changes(&q->lists->frame, t, changes);
    for (int i = 0; i < 3; i++) {
        const double coordinate = fabs(q->g.world[i][number]);
        sum += changes[i] * coordinate;
        all += changes[i];
        size = coordinate > size ? coordinate : size;
    }
    const double unit = (1 + 0x1p-20) * q->g.inverse_w[number] * q->rounding;
    *most = all * size * unit;
    return sum * unit;
}

static bool is_finite(const shb_triangle *triangle) {
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (!isfinite(triangle->corners[k][i]))
                return false;
    return true;
}

static uint32_t own_id_of(const inquiry *q, size_t number) {
    return q->g.has_own ? q->g.own[number] : SHB_ID_NONE;
}

/* Where a point lies by a triangle's plane. */
typedef enum side { SIDE_BEFORE, SIDE_IN_DOUBT, SIDE_BEHIND } side;

/* Rounded points that do not lie behind a plane for sure are taken to lie on it, unless the bound
 * of this arithmetic is wider than their own rounding: in views so wide, or scenes with so large a
 * part, that little or nothing is known of the plane. */
static side side_of(const inquiry *q, const shb_list_triangle *t, size_t number) {
    const shb_list_group *g = &q->g;
    double most;
    const double rounded = distance_rounding(q, t, number, &most);
    const double bound = (double)t->bound * g->scale[number];
    const double behind = shb_list_behind(t, g->x[number], g->y[number], g->depth[number]);
    const bool is_rounded = q->rounding > 0;
    if (!(behind > rounded + (is_rounded && bound <= most ? bound : -bound)))
        return SIDE_BEFORE;
    return is_rounded && t->margin < HUGE_VALF && behind > rounded + bound ? SIDE_BEHIND
                                                                           : SIDE_IN_DOUBT;
}

/* Decides a triangle in doubt by the ray. */
static bool blocks_in_doubt(const inquiry *q, const shb_list_triangle *t, size_t number) {
    const shb_lists *lists = q->lists;
    const double *const *at = q->g.world;
    shb_ray ray;
    const side lies = side_of(q, t, number);
    if (lies == SIDE_BEFORE ||
        !shb_ray_to_light(&lists->frame.light,
                          (shb_vec3){at[0][number], at[1][number], at[2][number]}, &ray))
        return false;
    const shb_triangle triangle = shb_lists_triangle(lists, (uint32_t)(t - lists->triangles));
    if (lies == SIDE_BEHIND)
        return shb_ray_line_meets(&ray, &triangle);
    ray.rounding = q->rounding;
    if (t->margin == HUGE_VALF)
        ray.limit = near_limit(&lists->frame, &ray);
    const uint32_t own_id = own_id_of(q, number);
    if (own_id >= lists->id_count)
        return shb_ray_is_blocked(&ray, &triangle, NULL);
    const shb_triangle own = shb_lists_triangle(lists, own_id);
    return shb_ray_is_blocked(&ray, &triangle, is_finite(&own) ? &own : NULL);
}

/* The cell that holds a point, and its tile's entries. */
static shb_list_span span_of(const shb_lists *lists, const shb_list_group *g, size_t number) {
    const int32_t cell = g->cell[number];
    if (cell < 0)
        return (shb_list_span){NO_CELL, lists->entries, number};
    const uint32_t column = (uint32_t)g->texel[number] & 0xffff;
    const uint32_t row = (uint32_t)g->texel[number] >> 16;
    const shb_list_tile *tile =
        &lists->tiles[(size_t)(row / SHB_LIST_TILE) * lists->tile_columns + column / SHB_LIST_TILE];
    return (shb_list_span){lists->cells + cell, lists->entries + tile->first_entry, number};
}

/* A point outside the scene is rounded too much for the weights: all triangles are in doubt. */
static bool is_blocked_outside(const inquiry *q, size_t number) {
    const shb_list_group *g = &q->g;
    const shb_list_span span = span_of(q->lists, g, number);
    const uint32_t own_id = own_id_of(q, number);
    for (uint32_t i = span.cell[0].start; i < span.cell[1].start; i++) {
        const uint32_t id = span.entries[i].triangle;
        const shb_list_triangle *t = &q->lists->triangles[id];
        if (id != own_id && blocks_in_doubt(q, t, number))
            return true;
    }
    return false;
}

static size_t lanes_of(const inquiry *q) {
    return (q->g.count + SHB_LIST_LANES - 1) / SHB_LIST_LANES * SHB_LIST_LANES;
}

/* Whole groups are read where they are; the last point fills up another. */
static void load(inquiry *q, const shb_list_points *points, size_t first) {
    const size_t rest = points->count - first;
    const double *const from[3] = {points->x, points->y, points->z};
    q->g.count = rest < GROUP ? rest : GROUP;
    q->g.has_own = points->own_ids != NULL;
    for (size_t k = 0; q->g.has_own && k < lanes_of(q); k++)
        q->g.own[k] = points->own_ids[first + (k < q->g.count ? k : q->g.count - 1)];
    for (int i = 0; i < 3; i++) {
        q->g.world[i] = q->places[i];
        if (q->g.count == GROUP)
            q->g.world[i] = from[i] + first;
        for (size_t k = 0; q->g.count < GROUP && k < lanes_of(q); k++)
            q->places[i][k] = from[i][first + (k < q->g.count ? k : q->g.count - 1)];
    }
}

/* A span for each change of the cell. */
static void find_spans(inquiry *q, size_t count) {
    for (size_t i = 0; i < count; i++) {
        q->spans[i] = span_of(q->lists, &q->g, (size_t)q->changes[i]);
        __builtin_prefetch(q->spans[i].cell);
    }
    q->spans[count].first = q->g.count;
    q->span_count = count;
}

/* The points of a run that a triangle blocks. */
static uint32_t blocked_of(const inquiry *q, const shb_list_question *answered) {
    const uint32_t open = q->runs[shb_list_byte(answered, SHB_LIST_ASKER)].open;
    const size_t first = shb_list_byte(answered, SHB_LIST_FIRST);
    uint32_t blocked = shb_list_byte(answered, SHB_LIST_ASKED) & open;
    const shb_list_triangle *t = &q->lists->triangles[answered->triangle];
    uint32_t doubt = shb_list_byte(answered, SHB_LIST_DOUBT) & open;
    for (; doubt; doubt &= doubt - 1)
        if (blocks_in_doubt(q, t, first + (size_t)__builtin_ctz(doubt)))
            blocked |= doubt & -doubt;
    return blocked;
}

static void settle(inquiry *q, const shb_list_question *answered, float *visibility) {
    const uint32_t blocked = blocked_of(q, answered);
    q->runs[shb_list_byte(answered, SHB_LIST_ASKER)].open &= (uint8_t)~blocked;
    for (uint32_t bits = blocked; bits; bits &= bits - 1)
        visibility[shb_list_byte(answered, SHB_LIST_FIRST) + (size_t)__builtin_ctz(bits)] = 0;
}

/* Drops runs that have nothing left to ask or to be asked. */
static void keep_open_runs(inquiry *q) {
    size_t kept = 0;
    for (size_t i = 0; i < q->run_count; i++) {
        const shb_list_run r = q->runs[i];
        q->runs[kept] = r;
        kept += (r.open != 0) & (r.entry < r.end);
    }
    q->run_count = kept;
}

static void ask_group(inquiry *q, float *visibility) {
    const shb_lists *lists = q->lists;
    const shb_list_kernels *kernels = shb_list_kernels_of(lists->context->isa);
    for (size_t i = 0; i < q->g.count; i++)
        visibility[i] = 1;
    const shb_list_grid grid = {lists->tiles, lists->tile_columns};
    find_spans(q, kernels->locate(&lists->frame, &grid, &q->g, q->changes));
    q->run_count = kernels->start(&q->g, q->spans, q->span_count, q->runs, visibility);
    for (; q->run_count; keep_open_runs(q)) {
        const size_t asked = kernels->take(q->runs, q->run_count, q->questions);
        const size_t answered = kernels->answer(&lists->frame, lists->triangles, &q->g, q->rounding,
                                                q->questions, asked);
        for (size_t i = 0; i < answered; i++)
            settle(q, &q->questions[i], visibility);
    }
    for (size_t i = 0; q->g.has_outside && i < q->g.count; i++)
        if (q->g.scale[i] > 1)
            visibility[i] = is_blocked_outside(q, i) ? 0.0f : 1.0f;
}

void shb_lists_query(const shb_lists *lists, const shb_list_points *points, float *visibility) {
    inquiry q;
    q.lists = lists;
    q.rounding = points->rounding;
    for (size_t first = 0; first < points->count; first += GROUP) {
        load(&q, points, first);
        ask_group(&q, visibility + first);
    }
}
