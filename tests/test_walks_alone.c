/* What the exact method answers on maps that keep triangles is what four ways over sheets and four
 * whole walks say, made one after the other and compared by the bounds of light_point.h: whatever
 * is settled without them, in vectors of any width. */
#include "../src/exact_sheet.h"
#include "../src/exact_walk.h"
#include "../src/light_point.h"
#include "../src/occluders.h"
#include "isas.h"
#include "probe.h"
#include "random.h"
#include "soup.h"
#include "test.h"

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
    shb_walk walk;
    shb_walk_begin(mesh, sample, from, to, &walk);
    int count = 0;
    for (uint32_t met; (met = shb_walk_next(&walk)) != SHB_ID_NONE; count++) {
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
    shb_map *map;
    shb_context *context;
    const shb_context_desc desc = {.max_isa = isa};
    const shb_map_desc map_desc = {
        .view = *view, .width = size, .occluders = SHB_OCCLUDERS_TRIANGLES};
    const shb_points asked = {.count = POINTS, .positions = points[0], .normals = normals[0]};
    const shb_bias exact = shb_bias_exact();
    build(&s, &random);
    place_points(&s, &random, points, normals);
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, soup_scene(&s), NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_visibility(map, &asked, &exact, NULL, visibility), SHB_OK);
    for (int i = 0; i < POINTS; i++) {
        const int expected = answer_alone(map, points[i]);
        if (expected < 0)
            continue;
        test_check(visibility[i] == (float)expected, __FILE__, __LINE__,
                   "%s, %u texels, point %d: %g, walks say %d", shb_isa_name(isa), (unsigned)size,
                   i, (double)visibility[i], expected);
        *lit += expected;
        *dark += !expected;
    }
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(whole_walks_say_what_is_settled_without_them) {
    static const uint32_t sizes[] = {16, 61, 256};
    for (shb_isa isa = SHB_ISA_SCALAR; isa < SHB_ISA_COUNT; isa = test_isa_after(isa)) {
        int lit = 0, dark = 0;
        for (int i = 0; i < 3; i++) {
            const shb_view views[] = {probe_orthographic(i == 1), probe_perspective(i == 1)};
            for (int k = 0; k < 2; k++)
                check_light(isa, &views[k], sizes[i], &lit, &dark);
        }
        test_check(lit > 2000 && dark > 2000, __FILE__, __LINE__, "%d lit, %d dark", lit, dark);
    }
}
