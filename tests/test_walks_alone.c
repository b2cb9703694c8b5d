/* What the exact method answers on maps that keep triangles is what four ways over sheets and four
 * whole walks say, made one after the other and compared by the bounds of light_point.h: whatever
 * is settled without them, in vectors of any width. */
#include "../src/exact_sheet.h"
#include "../src/kernels/shade.h"
#include "../src/light_point.h"
#include "../src/occluders.h"
#include "asked_map.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "slow_walk.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <string.h>

enum { POINTS = 3000 };

typedef enum alone_hit { ALONE_BEHIND, ALONE_OWN, ALONE_IN_FRONT, ALONE_UNSURE } alone_hit;

static alone_hit compare(const shb_map *map, const shb_light_point *point, uint32_t triangle) {
    const shb_occluder_plane *plane = &map->occluders.planes[triangle];
    const double behind = point->z - shb_occluder_depth(plane, point->x, point->y);
    const double error =
        plane->error + shb_light_point_error(point, plane->slope_x, plane->slope_y);
    if (!(error < HUGE_VAL) || (fabs(behind) > 0.9 * error && fabs(behind) < 8 * error))
        return ALONE_UNSURE;
    return behind > error ? ALONE_IN_FRONT : behind < -error ? ALONE_BEHIND : ALONE_OWN;
}

/* What one sample's sheet and walk meet. */
typedef struct told {
    bool is_own, is_in_front; /* the point's own surface, where the sheet leads to, or before it */
    bool walk_is_in_front;    /* something that the walk meets */
    bool is_cut;              /* the walk, before it met anything */
    bool is_uncertain;        /* not to be told here */
} told;

static told ask_sample(const shb_map *map, const shb_light_point *at, uint32_t sample,
                       const double from[2]) {
    const shb_light_mesh *mesh = &map->occluders.mesh;
    const double to[2] = {at->x, at->y};
    told t = {false};
    const uint32_t end = shb_sheet_end(mesh, sample, from, to);
    if (end != SHB_ID_NONE) {
        const alone_hit hit = compare(map, at, end);
        t.is_own = hit == ALONE_OWN;
        t.is_in_front = hit == ALONE_IN_FRONT;
        t.is_uncertain = hit == ALONE_UNSURE;
    }
    slow_walk walk;
    slow_walk_begin(mesh, sample, from, to, &walk);
    int count = 0;
    for (uint32_t met; (met = slow_walk_next(&walk)) != SHB_ID_NONE; count++) {
        const alone_hit hit = compare(map, at, met);
        t.walk_is_in_front |= hit == ALONE_IN_FRONT;
        t.is_uncertain |= hit == ALONE_UNSURE;
    }
    t.is_cut = end == SHB_ID_NONE && count == 0 && walk.cut;
    return t;
}

/* 1 lit, 0 shadowed; -1: not to be told here. */
static int answer_alone(const shb_map *map, const float p[3]) {
    const double position[3] = {(double)p[0], (double)p[1], (double)p[2]};
    const shb_light_point at = shb_light_point_at(&map->rows, position, SHB_FLOAT_ROUNDING);
    const int32_t left = (int32_t)floor(at.x - 0.5), top = (int32_t)floor(at.y - 0.5);
    bool is_plain = true, are_cut = true, is_in_front = false, walk_is_in_front = false;
    for (int k = 0; k < 4; k++) {
        const int32_t column = left + (k & 1), row = top + (k >> 1);
        const bool inside = column >= 0 && row >= 0 && (uint32_t)column < map->info.width &&
                            (uint32_t)row < map->info.height;
        const uint32_t sample = inside ? shb_occluder_row(map, row)[column] : SHB_ID_NONE;
        told t = {false};
        if (sample != SHB_ID_NONE)
            t = ask_sample(map, &at, sample, (double[]){column + 0.5, row + 0.5});
        if (t.is_uncertain)
            return -1;
        is_plain &= t.is_own;
        are_cut &= t.is_cut;
        is_in_front |= t.is_in_front;
        walk_is_in_front |= t.walk_is_in_front;
    }
    return are_cut ? -1 : is_in_front || (walk_is_in_front && !is_plain) ? 0 : 1;
}

/* Balls whose vertices lie in and out over a floor, and needles between them. */
static void build(soup *s, test_random *random) {
    const float lo[3] = {-0.95f, -0.95f, -0.5f}, hi[3] = {0.95f, 0.95f, -0.4f};
    double radii[12 * 9 + 2];
    soup_add_box(s, lo, hi);
    for (int ball = 0; ball < 3; ball++) {
        const float center[3] = {-0.5f + 0.45f * (float)ball, 0.3f - 0.25f * (float)ball,
                                 0.1f * (float)ball};
        for (int i = 0; i < 12 * 9 + 2; i++)
            radii[i] = random_double(random, 0.2, 0.3);
        soup_add_ball(s, center, 12, 10, radii);
    }
    for (int i = 0; i < 40; i++) {
        float corners[3][3];
        for (int k = 0; k < 9; k++)
            corners[k / 3][k % 3] = (float)random_double(random, -0.9, 0.9);
        for (int k = 0; k < 3; k++)
            corners[1][k] = corners[0][k] + 0.02f * corners[1][k];
        soup_add(s, corners[0], corners[1], corners[2]);
    }
}

/* All of the scene lies between its near and its far plane. */
static shb_view spot(bool reversed) {
    const shb_vec3 eye = {0.5, 0.3, 3}, target = {0, 0, 0}, up = {0, 1, 0};
    shb_view view;
    CHECK_INT(shb_view_perspective(eye, target, up, 0.8, 1, 1, 6, reversed, &view), SHB_OK);
    return view;
}

static void place_points(const soup *s, test_random *random, float (*points)[3],
                         float (*normals)[3]) {
    for (int i = 0; i < POINTS; i++) {
        const float *t = s->positions + 9 * (size_t)random_below(random, s->count);
        const double u = random_double(random, 0, 1), v = random_double(random, 0, 1 - u);
        for (int k = 0; k < 3; k++) {
            const double a = (double)t[k], b = (double)t[3 + k], c = (double)t[6 + k];
            points[i][k] = (float)(a + (u * (b - a) + v * (c - a)));
            normals[i][k] = k == 2;
        }
    }
}

static void check_light(shb_isa isa, const shb_view *view, uint32_t size, int *lit, int *dark) {
    static float points[POINTS][3], normals[POINTS][3], visibility[POINTS];
    test_random random = {size};
    soup s = {0};
    const shb_map_desc desc = {.view = *view, .width = size, .occluders = SHB_OCCLUDERS_TRIANGLES};
    const shb_points asked = {.count = POINTS, .positions = points[0], .normals = normals[0]};
    const shb_bias exact = shb_bias_exact();
    build(&s, &random);
    place_points(&s, &random, points, normals);
    asked_map made = asked_map_draw(isa, &desc, &s);
    CHECK_INT(shb_map_visibility(made.map, &asked, &exact, NULL, visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++) {
        const int expected = answer_alone(made.map, points[i]);
        if (expected < 0)
            continue;
        test_check(visibility[i] == (float)expected, __FILE__, __LINE__,
                   "%s, %u texels, point %d: %g, walks say %d", shb_isa_name(isa), (unsigned)size,
                   i, (double)visibility[i], expected);
        *lit += expected;
        *dark += !expected;
    }
    asked_map_close(&made);
    soup_free(&s);
}

TEST(whole_walks_say_what_is_settled_without_them) {
    static const uint32_t sizes[] = {16, 61, 256};
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
        int lit = 0, dark = 0;
        for (int i = 0; i < 3; i++) {
            const shb_view views[] = {probe_orthographic(i == 1), spot(i == 1)};
            for (int k = 0; k < 2; k++)
                check_light(isa, &views[k], sizes[i], &lit, &dark);
        }
        test_check(lit > 2000 && dark > 2000, __FILE__, __LINE__, "%d lit, %d dark", lit, dark);
    }
}

/* Points with gaps between them, and the triangles that they lie on. */
typedef struct named_point {
    float position[3], normal[3], gap;
} named_point;

typedef struct named_points {
    named_point at[POINTS];
    uint32_t ids[POINTS];
    float weight_1[POINTS], weight_2[POINTS];
} named_points;

static void name_points(const soup *s, test_random *random, named_points *named) {
    for (int i = 0; i < POINTS; i++) {
        named->ids[i] = random_below(random, s->count);
        const float *t = s->positions + 9 * (size_t)named->ids[i];
        const double u = random_double(random, 0, 1), v = random_double(random, 0, 1 - u);
        named->weight_1[i] = (float)u;
        named->weight_2[i] = (float)v;
        for (int k = 0; k < 3; k++) {
            const double a = (double)t[k], b = (double)t[3 + k], c = (double)t[6 + k];
            named->at[i].position[k] = (float)(a + (u * (b - a) + v * (c - a)));
            named->at[i].normal[k] = (float)random_double(random, -1, 1);
        }
    }
}

static void ask_named(const asked_map *made, const named_points *named, bool by_names,
                      const shb_filter *filter, float visibility[POINTS]) {
    const shb_bias exact = shb_bias_exact();
    shb_points points = {.count = POINTS,
                         .positions = named->at[0].position,
                         .position_stride = sizeof *named->at,
                         .normals = named->at[0].normal,
                         .normal_stride = sizeof *named->at,
                         .own = {named->ids, named->weight_1, named->weight_2}};
    if (!by_names)
        points.own = (shb_own_triangles){0};
    CHECK_INT(shb_map_visibility(made->map, &points, &exact, filter, visibility), SHB_OK);
}

/* Slanted plates that no edge joins: walks over them are cut. */
static void add_plates(soup *s, test_random *random) {
    for (int i = 0; i < 30 * 30; i++) {
        const float x = 0.03f * (float)(i % 30) - 0.4f, y = 0.03f * (float)(i / 30) - 0.4f;
        float corners[4][3];
        for (int k = 0; k < 4; k++) {
            corners[k][0] = x + (k == 1 || k == 2 ? 0.029f : 0);
            corners[k][1] = y + (k >= 2 ? 0.029f : 0);
            corners[k][2] = (float)random_double(random, 0.6, 0.63);
        }
        soup_add_quad(s, corners[0], corners[1], corners[2], corners[3]);
    }
}

/* A filter that the library does not know is asked batch by batch. */
static void ask_apart(const shb_filter_args *args) {
    shb_exact_visibility(args);
}

static void check_together(const shb_map_desc *desc, soup *s, const named_points *named,
                           bool by_names) {
    static float together[POINTS], apart[POINTS];
    shb_filter batch_by_batch = shb_filter_hard();
    batch_by_batch.exact = ask_apart;
    asked_map made = asked_map_draw(SHB_ISA_BEST, desc, s);
    ask_named(&made, named, by_names, NULL, together);
    ask_named(&made, named, by_names, &batch_by_batch, apart);
    size_t different = 0;
    for (size_t i = 0; i < POINTS; i++)
        different += together[i] != apart[i];
    CHECK_INT(different, 0);
    asked_map_close(&made);
}

/* In every other batch one name is wrong, so that floats count there. */
TEST(points_that_wait_for_later_batches_are_answered_as_without_these) {
    static named_points named;
    test_random random = {5};
    soup s = {0};
    shb_map_desc desc = {.view = spot(false), .width = 61, .occluders = SHB_OCCLUDERS_TRIANGLES};
    build(&s, &random);
    add_plates(&s, &random);
    name_points(&s, &random, &named);
    for (size_t i = 0; i < POINTS; i += 2 * SHB_BATCH)
        named.weight_1[i] += 0.5f;
    check_together(&desc, &s, &named, true);
    desc.width = 300; /* few are unsure, so that batches wait together */
    desc.occluders = SHB_OCCLUDERS_LISTS;
    desc.classifies = true;
    check_together(&desc, &s, &named, false);
    soup_free(&s);
}

/* Where a triangle's plane lies for a point in the world, unless rounding might tell it otherwise.
 */
static alone_hit compare_world(const shb_map *map, const double p[3], uint32_t triangle) {
    const shb_world_plane *plane = &map->occluders.world_planes[triangle];
    double behind = plane->offset, error = 1;
    for (int k = 0; k < 3; k++) {
        behind += plane->normal[k] * p[k];
        error += SHB_FLOAT_ROUNDING * fabs(plane->normal[k] * p[k]);
    }
    if (!(error < HUGE_VAL) || fabs(fabs(behind) - error) < 1e-3 * error)
        return ALONE_UNSURE;
    return behind > error ? ALONE_IN_FRONT : behind < -error ? ALONE_BEHIND : ALONE_OWN;
}

/* What the walks of a crowd find for their points. */
typedef struct crowd_finds {
    bool are_shadowed[SHB_BATCH], are_known[SHB_BATCH], are_uncertain[SHB_BATCH];
} crowd_finds;

static void walk_alone(const shb_map *map, const shb_exact_points *points,
                       const shb_walk_crowd *crowd, crowd_finds *found) {
    for (size_t i = 0; i < crowd->count; i++) {
        const double from[2] = {crowd->from_x[i], crowd->from_y[i]};
        const double to[2] = {crowd->to_x[i], crowd->to_y[i]};
        const uint32_t n = crowd->points[i];
        const double world[3] = {points->x[n], points->y[n], points->z[n]};
        slow_walk walk;
        slow_walk_begin(&map->occluders.mesh, crowd->triangles[i], from, to, &walk);
        for (uint32_t met; (met = slow_walk_next(&walk)) != SHB_ID_NONE;) {
            const alone_hit hit =
                met == points->own_ids[n] ? ALONE_OWN : compare_world(map, world, met);
            found->are_shadowed[n] |= hit == ALONE_IN_FRONT;
            found->are_uncertain[n] |= hit == ALONE_UNSURE;
            found->are_known[n] = true;
        }
        found->are_known[n] |= !walk.cut;
    }
}

/* Places are anywhere, some on a corner or on each other; triangles are any, whether the line
 * crosses them or not. */
static void place_crowd(const shb_map *map, test_random *random, shb_exact_points *points,
                        shb_walk_crowd *crowd) {
    const uint32_t triangles = (uint32_t)map->occluders.plane_count;
    const shb_walk_triangle *mesh = map->occluders.mesh.triangles;
    points->count = SHB_BATCH;
    for (size_t i = 0; i < SHB_BATCH; i++) {
        points->x[i] = random_double(random, -1, 1);
        points->y[i] = random_double(random, -1, 1);
        points->z[i] = random_double(random, -1, 1);
        points->own_ids[i] =
            random_below(random, 4) ? SHB_ID_NONE : random_below(random, triangles);
    }
    crowd->count = 1 + random_below(random, SHB_WALK_CROWD);
    for (size_t i = 0; i < crowd->count; i++) {
        const uint32_t triangle = random_below(random, triangles);
        const shb_walk_triangle *t = &mesh[random_below(random, 2) ? triangle : 0];
        const double step = random_below(random, 2) ? 1 : 40;
        crowd->triangles[i] = triangle;
        crowd->points[i] = random_below(random, SHB_BATCH);
        crowd->to_x[i] = t->x[0] + (random_below(random, 8) ? random_double(random, -1, 1) : 0);
        crowd->to_y[i] = t->y[0] + (random_below(random, 8) ? random_double(random, -1, 1) : 0);
        crowd->from_x[i] = crowd->to_x[i] + step * random_double(random, -1, 1);
        crowd->from_y[i] = crowd->to_y[i] + step * random_double(random, -1, 1);
        if (random_below(random, 16) == 0) {
            crowd->from_x[i] = crowd->to_x[i];
            crowd->from_y[i] = crowd->to_y[i];
        }
    }
}

/* What kernels find on the stack where they have not written. */
static __attribute__((noinline)) void leave_garbage(void) {
    volatile unsigned char garbage[1 << 15];
    for (size_t i = 0; i < sizeof garbage; i++)
        garbage[i] = 0x55;
}

/* The same triangle, or one that its sheet goes on with. */
static bool is_beside(const shb_light_mesh *mesh, uint32_t triangle, uint32_t other) {
    const shb_walk_triangle *t = &mesh->triangles[triangle];
    bool is = other == triangle;
    for (int k = 0; k < 3; k++)
        is |= t->marks & SHB_EDGE_JOINED << k && shb_neighbour_of(t->beyond[k]) == other;
    return is;
}

static bool is_repeated(const shb_way_points *p, size_t i, int k) {
    bool is = false;
    for (int before = 0; before < k; before++)
        is |= p->samples[before][i] == p->samples[k][i];
    return is;
}

/* How many ways ended beside the point's surface, in front of the point and behind it, and how many
 * had made two steps or more. */
typedef struct way_counts {
    int beside, in_front, behind, long_ways;
} way_counts;

/* The way from sample k; surface: of the point, or SHB_ID_NONE. Returns what it finds. */
static uint32_t go_alone(const shb_map *map, const shb_way_points *p, size_t i, int k,
                         uint32_t *surface, uint32_t *end, way_counts *counts) {
    const shb_light_mesh *mesh = &map->occluders.mesh;
    const double to[2] = {p->x[i], p->y[i]};
    const double position[3] = {p->points.x[i], p->points.y[i], p->points.z[i]};
    const shb_light_point point = shb_light_point_at(&map->rows, position, SHB_FLOAT_ROUNDING);
    double from[2];
    for (int axis = 0; axis < 2; axis++) {
        const double own = floor(to[axis]), other = to[axis] - own < 0.5 ? -1 : 1;
        from[axis] = own + (k & 1 << axis ? other : 0) + 0.5;
    }
    uint32_t triangle = p->samples[k][i];
    bool covers = false;
    for (int steps = 0; steps < 64; steps++) {
        if (*surface != SHB_ID_NONE && is_beside(mesh, *surface, triangle)) {
            *end = triangle;
            counts->beside++;
            return SHB_WAY_OWN << k;
        }
        const uint32_t next = shb_sheet_next(mesh, triangle, from, to, &covers);
        if (next == triangle)
            break;
        triangle = next;
        counts->long_ways += steps == 1;
    }
    *end = triangle;
    if (!covers)
        return 0;
    const alone_hit hit =
        triangle == p->points.own_ids[i] ? ALONE_OWN : compare(map, &point, triangle);
    if (hit == ALONE_OWN)
        *surface = triangle;
    counts->in_front += hit == ALONE_IN_FRONT;
    counts->behind += hit == ALONE_BEHIND;
    return hit == ALONE_OWN        ? SHB_WAY_OWN << k
           : hit == ALONE_IN_FRONT ? SHB_WAY_IN_FRONT
           : hit == ALONE_BEHIND   ? SHB_WAY_BEHIND
                                   : UINT32_MAX;
}

static void check_ways(const shb_map *map, const shb_way_points *p, size_t i, way_counts *counts) {
    uint32_t found = 0, surface = SHB_ID_NONE;
    for (int k = 0; k < 4; k++) {
        uint32_t end;
        if (p->samples[k][i] == SHB_ID_NONE)
            found |= SHB_WAY_EMPTY;
        if (p->samples[k][i] == SHB_ID_NONE || is_repeated(p, i, k) || found & SHB_WAY_IN_FRONT)
            continue;
        const uint32_t more = go_alone(map, p, i, k, &surface, &end, counts);
        if (more == UINT32_MAX) /* not to be told here */
            return;
        found |= SHB_WAY_GONE << k | more;
        CHECK_INT(p->ends[k][i], end);
    }
    CHECK_INT(p->found[i], found);
}

/* Reads the samples around points; some of these are known to lie on their first one's triangle. */
static void place_ways(shb_isa isa, const shb_map *map, float (*at)[3], size_t count,
                       shb_way_points *p) {
    static shb_walk_group g;
    double *const world[3] = {p->points.x, p->points.y, p->points.z};
    p->points.count = count;
    for (size_t i = 0; i < SHB_BATCH; i++) {
        for (int k = 0; k < 3; k++)
            world[k][i] = (double)at[i][k];
        p->points.own_ids[i] = SHB_ID_NONE;
    }
    for (size_t first = 0; first < SHB_BATCH; first += SHB_LIST_GROUP) {
        g.count = SHB_LIST_GROUP;
        g.own_ids = p->points.own_ids + first;
        for (int k = 0; k < 3; k++)
            g.world[k] = world[k] + first;
        shb_shade_kernels_of(isa)->nearest(map, SHB_FLOAT_ROUNDING, &g);
        memcpy(p->x + first, g.x, sizeof g.x);
        memcpy(p->y + first, g.y, sizeof g.y);
        for (int k = 0; k < 4; k++)
            memcpy(p->samples[k] + first, g.samples[k], sizeof g.samples[k]);
    }
    for (size_t i = 0; i < SHB_BATCH; i += 4)
        p->points.own_ids[i] = p->samples[0][i];
}

TEST(ways_go_side_by_side_as_each_goes_alone) {
    static float points[POINTS][3], normals[POINTS][3];
    static shb_way_points p;
    const shb_view views[] = {probe_orthographic(false), spot(true)};
    for (int v = 0; v < 2; v++) {
        test_random random = {7};
        soup s = {0};
        const shb_map_desc desc = {
            .view = views[v], .width = 48, .occluders = SHB_OCCLUDERS_TRIANGLES};
        build(&s, &random);
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
            way_counts counts = {0};
            place_points(&s, &random, points, normals);
            for (size_t first = 0; first + SHB_BATCH <= POINTS; first += SHB_BATCH) {
                place_ways(isa, made.map, points + first, SHB_BATCH - random_below(&random, 40),
                           &p);
                leave_garbage();
                shb_shade_kernels_of(isa)->ways(made.map, SHB_FLOAT_ROUNDING, &p);
                for (size_t i = 0; i < p.points.count; i++)
                    check_ways(made.map, &p, i, &counts);
            }
            test_check(counts.beside > 500 && counts.in_front > 200 && counts.behind > 200 &&
                           counts.long_ways > 200,
                       __FILE__, __LINE__, "%d beside, %d in front, %d behind, %d long",
                       counts.beside, counts.in_front, counts.behind, counts.long_ways);
        }
        asked_map_close(&made);
        soup_free(&s);
    }
}

static void check_crowd(shb_isa isa, const shb_map *map, test_random *random, int counts[2]) {
    static shb_exact_points points;
    static shb_walk_crowd crowd;
    crowd_finds alone = {{false}, {false}, {false}};
    memset(&crowd, 0, sizeof crowd);
    place_crowd(map, random, &points, &crowd);
    walk_alone(map, &points, &crowd, &alone);
    leave_garbage();
    shb_shade_kernels_of(isa)->walk(map, SHB_FLOAT_ROUNDING, &points, &crowd);
    CHECK_INT(crowd.count, 0);
    for (int i = 0; i < SHB_BATCH; i++) {
        CHECK_INT(crowd.are_known[i], alone.are_known[i]);
        if (!alone.are_uncertain[i])
            CHECK_INT(crowd.are_shadowed[i], alone.are_shadowed[i]);
        counts[0] += alone.are_known[i];
        counts[1] += alone.are_shadowed[i];
    }
}

TEST(walks_side_by_side_meet_what_each_meets_alone) {
    const shb_view views[] = {probe_orthographic(false), spot(true)};
    for (int v = 0; v < 2; v++) {
        test_random random = {5};
        soup s = {0};
        const shb_map_desc desc = {
            .view = views[v], .width = 64, .occluders = SHB_OCCLUDERS_TRIANGLES};
        int counts[2] = {0, 0};
        build(&s, &random);
        asked_map made = asked_map_draw(SHB_ISA_BEST, &desc, &s);
        for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa))
            for (int i = 0; i < 200; i++)
                check_crowd(isa, made.map, &random, counts);
        test_check(counts[0] > 20000 && counts[1] > 2000, __FILE__, __LINE__, "%d met, %d shadowed",
                   counts[0], counts[1]);
        asked_map_close(&made);
        soup_free(&s);
    }
}
