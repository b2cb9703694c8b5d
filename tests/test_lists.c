/* Lists: the answers of the ray-cast truth for every point, at every size; memory, errors. */
#include "../src/lists.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "oracle.h"
#include "random.h"
#include "scenes.h"
#include "shadowbias/reference.h"
#include "soup.h"
#include "test.h"

static shb_context *make_context(uint32_t threads) {
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&(shb_context_desc){.threads = threads}, &context), SHB_OK);
    return context;
}

/* Points on triangles of a scene, exact but for double rounding. */
typedef struct samples {
    size_t count;
    double *x, *y, *z;
    shb_vec3 *points;
    uint32_t *own_ids;
    uint8_t *occluded;
    float *visibility;
} samples;

static samples samples_create(const shb_scene *scene, size_t count, uint64_t seed) {
    samples s = {.count = count,
                 .x = malloc(count * sizeof *s.x),
                 .y = malloc(count * sizeof *s.y),
                 .z = malloc(count * sizeof *s.z),
                 .points = malloc(count * sizeof *s.points),
                 .own_ids = malloc(count * sizeof *s.own_ids),
                 .occluded = malloc(count),
                 .visibility = malloc(count * sizeof *s.visibility)};
    test_random random = {seed};
    for (size_t i = 0; i < count; i++) {
        shb_vec3 corners[3];
        const uint32_t id = random_below(&random, (uint32_t)shb_scene_triangle_count(scene));
        shb_scene_triangle(scene, id, corners);
        double u = random_double(&random, 0, 1), v = random_double(&random, 0, 1);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const shb_vec3 e = shb_vec3_subtract(corners[1], corners[0]);
        const shb_vec3 f = shb_vec3_subtract(corners[2], corners[0]);
        const shb_vec3 way = shb_vec3_add(shb_vec3_scale(e, u), shb_vec3_scale(f, v));
        const shb_vec3 point = shb_vec3_add(corners[0], way);
        s.points[i] = point;
        s.x[i] = point.x;
        s.y[i] = point.y;
        s.z[i] = point.z;
        s.own_ids[i] = id;
    }
    return s;
}

static void samples_free(samples *s) {
    free(s->x);
    free(s->y);
    free(s->z);
    free(s->points);
    free(s->own_ids);
    free(s->occluded);
    free(s->visibility);
}

/* Coordinates as floats would hold them. */
static void samples_to_float(samples *s) {
    for (size_t i = 0; i < s->count; i++) {
        s->x[i] = (double)(float)s->x[i];
        s->y[i] = (double)(float)s->y[i];
        s->z[i] = (double)(float)s->z[i];
    }
}

static void ask(const shb_lists *lists, samples *s, bool with_ids, double rounding) {
    const shb_list_points points = {.count = s->count,
                                    .x = s->x,
                                    .y = s->y,
                                    .z = s->z,
                                    .own_ids = with_ids ? s->own_ids : NULL,
                                    .rounding = rounding};
    shb_lists_query(lists, &points, s->visibility);
}

static void ask_one(const shb_lists *lists, double x, double y, double z, float *visibility) {
    const shb_list_points point = {.count = 1, .x = &x, .y = &y, .z = &z};
    shb_lists_query(lists, &point, visibility);
}

static shb_lists *build(shb_context *context, const shb_view *view, uint32_t size,
                        const shb_scene *scene) {
    shb_lists *lists = NULL;
    CHECK_INT(shb_lists_build(context, "test", view, size, size, scene, 0, &lists), SHB_OK);
    return lists;
}

static void find_truth(const shb_reference *reference, const shb_view *view, samples *s) {
    shb_light_source light;
    CHECK_INT(shb_view_light_source(view, &light), SHB_OK);
    CHECK_INT(
        shb_reference_occluded(reference, &light, s->count, s->points, s->own_ids, s->occluded),
        SHB_OK);
}

static size_t count_false_shadow(const samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->visibility[i] < 0.5f && !s->occluded[i];
    return count;
}

static size_t count_false_light(const samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->visibility[i] > 0.5f && s->occluded[i];
    return count;
}

static size_t count_occluded(const samples *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++)
        count += s->occluded[i];
    return count;
}

typedef struct light {
    bool is_spot;
    shb_vec3 source; /* direction, or position in units of the box about its centre */
} light;

static shb_view view_of(const light *l, shb_box box, uint32_t size, bool reversed) {
    shb_view view = {0};
    const shb_vec3 centre = shb_vec3_scale(shb_vec3_add(box.lo, box.hi), 0.5);
    const double scale = shb_vec3_length(shb_vec3_subtract(box.hi, box.lo));
    const shb_vec3 position = shb_vec3_add(centre, shb_vec3_scale(l->source, scale));
    const shb_result result = l->is_spot
                                  ? shb_view_fit_spot(position, box, size, reversed, &view)
                                  : shb_view_fit_directional(l->source, box, size, reversed, &view);
    CHECK_INT(result, SHB_OK);
    return view;
}

/* Every point of the scene gets the truth's answer, at all sizes, with exact points and ids; with
 * float points nothing lit is shadowed. */
static void check_against_truth(const shb_scene *scene, size_t count, const light *l,
                                size_t least_shadowed) {
    static const uint32_t sizes[] = {8, 64, 256, 1024};
    shb_context *context = make_context(2);
    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    samples exact = samples_create(scene, count, count),
            rounded = samples_create(scene, count, count);
    samples_to_float(&rounded);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const shb_view view = view_of(l, box, sizes[i], i % 2 == 0);
        shb_lists *lists = build(context, &view, sizes[i], scene);
        find_truth(reference, &view, &exact);
        CHECK(count_occluded(&exact) >= least_shadowed);
        ask(lists, &exact, true, 0);
        CHECK_INT(count_false_shadow(&exact), 0);
        CHECK_INT(count_false_light(&exact), 0);
        ask(lists, &exact, false, 0);
        CHECK_INT(count_false_shadow(&exact), 0);
        CHECK_INT(count_false_light(&exact), 0);
        memcpy(rounded.occluded, exact.occluded, count);
        ask(lists, &rounded, false, 0x1p-24);
        CHECK_INT(count_false_shadow(&rounded), 0);
        shb_lists_destroy(lists);
    }
    samples_free(&exact);
    samples_free(&rounded);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
}

static const light slanted = {false, {0.3, 0.5, 0.9}};
static const light grazing = {false, {0.95, 0.3, 0.02}};
static const light spot = {true, {0.4, -0.3, 0.8}};

static void add_random(soup *s, test_random *random, double size) {
    float c[3][3];
    double centre[3];
    for (int i = 0; i < 3; i++)
        centre[i] = random_double(random, -1, 1);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            c[k][i] = (float)(centre[i] + random_double(random, -size, size));
    soup_add(s, c[0], c[1], c[2]);
}

TEST(lists_answer_as_rays_in_a_soup) {
    soup s = {0};
    test_random random = {1};
    for (int i = 0; i < 400; i++)
        add_random(&s, &random, i % 7 == 0 ? 0.9 : 0.1);
    check_against_truth(soup_scene(&s), 6000, &slanted, 1500);
    check_against_truth(soup_scene(&s), 6000, &spot, 1500);
    soup_free(&s);
}

TEST(lists_answer_as_rays_among_needles) {
    soup s = {0};
    test_random random = {2};
    for (int i = 0; i < 300; i++) {
        float c[3][3];
        for (int k = 0; k < 2; k++)
            for (int j = 0; j < 3; j++)
                c[k][j] = (float)random_double(&random, -1, 1);
        for (int j = 0; j < 3; j++)
            c[2][j] = c[1][j] + (float)random_double(&random, -1e-3, 1e-3);
        soup_add(&s, c[0], c[1], c[2]);
    }
    const float lo[3] = {-1, -1, -1.5f}, hi[3] = {1, 1, -1.2f};
    soup_add_box(&s, lo, hi);
    check_against_truth(soup_scene(&s), 6000, &slanted, 100);
    check_against_truth(soup_scene(&s), 6000, &spot, 100);
    soup_free(&s);
}

TEST(lists_answer_as_rays_on_balls_and_boxes) {
    soup s = {0};
    const float centre[3] = {0, 0, 1.2f};
    soup_add_ball(&s, centre, 40, 40, NULL);
    const float ground_lo[3] = {-3, -3, -1}, ground_hi[3] = {3, 3, 0};
    soup_add_box(&s, ground_lo, ground_hi);
    for (int step = 0; step < 12; step++) { /* stairs that touch each other */
        const float x = 1.5f + 0.1f * (float)step;
        const float lo[3] = {x, -2, 0}, hi[3] = {x + 0.1f, 2, 0.1f * (float)(step + 1)};
        soup_add_box(&s, lo, hi);
    }
    check_against_truth(soup_scene(&s), 6000, &slanted, 1500);
    check_against_truth(soup_scene(&s), 6000, &grazing, 1500);
    check_against_truth(soup_scene(&s), 6000, &spot, 1500);
    soup_free(&s);
}

/* A relief of squares whose neighbours have T-junctions, twice each, cut by a standing plane. */
TEST(lists_answer_as_rays_on_reliefs_duplicates_and_crossings) {
    soup s = {0};
    test_random random = {3};
    float height[25][25];
    for (int i = 0; i < 25; i++)
        for (int j = 0; j < 25; j++)
            height[i][j] = (float)random_double(&random, 0, 0.08);
    for (int i = 0; i < 24; i++)
        for (int j = 0; j < 24; j++) {
            const float x = (float)i / 12 - 1, y = (float)j / 12 - 1, d = 1.0f / 12;
            const float a[3] = {x, y, height[i][j]}, b[3] = {x + d, y, height[i + 1][j]};
            const float c[3] = {x + d, y + d, height[i + 1][j + 1]};
            const float e[3] = {x, y + d, height[i][j + 1]};
            soup_add_quad(&s, a, b, c, e);
            if ((i + j) % 3 == 0)
                soup_add_quad(&s, a, b, c, e);
        }
    const float a[3] = {-1, -0.3f, -0.2f}, b[3] = {1, 0.4f, -0.2f}, c[3] = {1, 0.4f, 0.5f};
    const float e[3] = {-1, -0.3f, 0.5f};
    soup_add_quad(&s, a, b, c, e);
    check_against_truth(soup_scene(&s), 6000, &grazing, 1000);
    check_against_truth(soup_scene(&s), 6000, &slanted, 500);
    check_against_truth(soup_scene(&s), 6000, &spot, 500);
    soup_free(&s);
}

TEST(lists_answer_as_rays_on_known_meshes) {
    static const char *const paths[] = {"../shared/scenes/bunny_69k.obj",
                                        "../shared/scenes/dx_crypt.obj"};
    size_t found = 0;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        example_scene *scene;
        char error[256];
        if (!scene_open(paths[i], &scene, error, sizeof error))
            continue;
        found++;
        shb_context *context = make_context(2);
        shb_reference *reference = NULL;
        CHECK_INT(shb_reference_create(context, &scene->scene, &reference), SHB_OK);
        const shb_view view = view_of(&slanted, scene->bounds, 256, true);
        shb_lists *lists = build(context, &view, 256, &scene->scene);
        samples s = samples_create(&scene->scene, 20000, 5);
        find_truth(reference, &view, &s);
        ask(lists, &s, true, 0);
        CHECK_INT(count_false_shadow(&s), 0);
        CHECK_INT(count_false_light(&s), 0);
        samples_to_float(&s);
        ask(lists, &s, false, 0x1p-24);
        CHECK_INT(count_false_shadow(&s), 0);
        samples_free(&s);
        shb_lists_destroy(lists);
        shb_reference_destroy(reference);
        shb_context_destroy(context);
        scene_close(scene);
    }
    if (!found)
        test_skip("no meshes in ../shared/scenes");
}

/* The truth for a light whose rays begin at the near plane: 113 bits, no hierarchy, plane by plane.
 * True if the triangle meets the segment from the point to the light, behind the near plane. */
static bool blocks_behind_near(const shb_view *view, const shb_light_source *source,
                               const shb_vec3 corners[3], shb_vec3 point) {
    const oracle_real p[3] = {oracle_exact(point.x), oracle_exact(point.y), oracle_exact(point.z)};
    const oracle_real d[3] = {oracle_exact(source->position.x) - p[0],
                              oracle_exact(source->position.y) - p[1],
                              oracle_exact(source->position.z) - p[2]};
    oracle_real a[3][3];
    for (int k = 0; k < 3; k++) {
        a[k][0] = oracle_exact(corners[k].x) - p[0];
        a[k][1] = oracle_exact(corners[k].y) - p[1];
        a[k][2] = oracle_exact(corners[k].z) - p[2];
    }
    oracle_real volume[3], total = 0, at[3] = {0};
    for (int k = 0; k < 3; k++) {
        const oracle_real *u = a[(k + 1) % 3], *v = a[(k + 2) % 3];
        volume[k] = d[0] * (u[1] * v[2] - u[2] * v[1]) + d[1] * (u[2] * v[0] - u[0] * v[2]) +
                    d[2] * (u[0] * v[1] - u[1] * v[0]);
        total += volume[k];
    }
    for (int k = 0; k < 3; k++) {
        if (volume[k] * total < 0 || total == 0)
            return false;
        for (int i = 0; i < 3; i++)
            at[i] += a[k][i] * volume[k] / total;
    }
    const oracle_real along = at[0] * d[0] + at[1] * d[1] + at[2] * d[2];
    const oracle_real length = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double *m = view->clip_from_world.m;
    oracle_real z = oracle_exact(m[14]), w = oracle_exact(m[15]);
    for (int i = 0; i < 3; i++) {
        z += oracle_exact(m[4 * i + 2]) * (at[i] + p[i]);
        w += oracle_exact(m[4 * i + 3]) * (at[i] + p[i]);
    }
    const bool behind = view->reversed ? z <= w : z >= 0;
    return along > 0 && along < length && behind;
}

TEST(triangles_across_the_near_plane_block_behind_it) {
    for (int reversed = 0; reversed < 2; reversed++) {
        soup s = {0};
        test_random random = {4};
        for (int i = 0; i < 150; i++) /* all round the light, many across its plane */
            add_random(&s, &random, i % 3 == 0 ? 1.5 : 0.3);
        const shb_scene *scene = soup_scene(&s);
        shb_view view;
        CHECK_INT(shb_view_perspective((shb_vec3){0.1, 0.2, 0.3}, (shb_vec3){0.3, -0.9, 0.1},
                                       (shb_vec3){0, 0, 1}, 2, 1, 0.25, 10, reversed, &view),
                  SHB_OK);
        shb_light_source source;
        CHECK_INT(shb_view_light_source(&view, &source), SHB_OK);
        shb_context *context = make_context(1);
        shb_lists *lists = build(context, &view, 64, scene);
        samples points = samples_create(scene, 4000, 6);
        size_t wrong = 0, shadowed = 0, crossing = 0;
        for (uint32_t i = 0; i < lists->id_count; i++)
            crossing += lists->triangles[i].margin == HUGE_VALF;
        CHECK(crossing > 20);
        ask(lists, &points, true, 0);
        for (size_t i = 0; i < points.count; i++) {
            const double *m = view.clip_from_world.m;
            double clip[4];
            for (int r = 0; r < 4; r++)
                clip[r] = m[r] * points.x[i] + m[4 + r] * points.y[i] + m[8 + r] * points.z[i] +
                          m[12 + r];
            const bool seen = clip[3] > 0 && fabs(clip[0]) < clip[3] && fabs(clip[1]) < clip[3];
            bool blocked = false;
            for (uint32_t id = 0; seen && id < s.count && !blocked; id++) {
                shb_vec3 corners[3];
                shb_scene_triangle(scene, id, corners);
                blocked = id != points.own_ids[i] &&
                          blocks_behind_near(&view, &source, corners, points.points[i]);
            }
            shadowed += blocked;
            wrong += blocked != (points.visibility[i] < 0.5f);
        }
        CHECK(shadowed > 200);
        CHECK_INT(wrong, 0);
        samples_free(&points);
        shb_lists_destroy(lists);
        shb_context_destroy(context);
        soup_free(&s);
    }
}

/* Two level plates a gap apart, turned so that nothing is exact; ids 0, 1 below and 2, 3 above. */
static void add_plates(soup *s, float gap) {
    for (int plate = 0; plate < 2; plate++) {
        const float z = plate ? gap : 0, half = plate ? 0.4f : 0.35f;
        const float a[3] = {-half, -half, z}, b[3] = {half, -half, z};
        const float c[3] = {half, half, z}, d[3] = {-half, half, z};
        soup_add_quad(s, a, b, c, d);
    }
    s->transform = shb_mat4_rotation((shb_vec3){1, 2, 3}, 1);
}

static size_t shadowed_below(float gap, double rounding, size_t *shadowed_above) {
    soup s = {0};
    add_plates(&s, gap);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = make_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_mat4 turn = s.transform;
    const light above = {false, {turn.m[8] + 0.2, turn.m[9], turn.m[10]}};
    const shb_view view = view_of(&above, box, 64, true);
    shb_lists *lists = build(context, &view, 64, scene);
    samples points = samples_create(scene, 2000, 7);
    if (rounding > 0)
        samples_to_float(&points);
    ask(lists, &points, false, rounding);
    size_t below = 0;
    *shadowed_above = 0;
    for (size_t i = 0; i < points.count; i++) {
        const bool is_below = points.own_ids[i] < 2;
        below += is_below;
        if (points.visibility[i] > 0.5f)
            continue;
        below -= is_below;
        *shadowed_above += !is_below;
    }
    samples_free(&points);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
    return below; /* those that are lit */
}

TEST(a_gap_of_rounding_size_casts_a_shadow) {
    size_t above;
    CHECK_INT(shadowed_below(1e-7f, 0, &above), 0);
    CHECK_INT(above, 0);
    CHECK_INT(shadowed_below(1e-12f, 0, &above), 0);
    CHECK_INT(above, 0);
    CHECK_INT(shadowed_below(5e-7f, 0x1p-24, &above), 0);
    CHECK_INT(above, 0);
}

TEST(coincident_triangles_do_not_shadow_each_other) {
    size_t above;
    CHECK(shadowed_below(0, 0, &above) > 0);
    CHECK_INT(above, 0);
}

/* A plate hinged on the ground at y = 0 and one degree (slope 0.0175): its shadow begins there. */
TEST(a_shadow_begins_at_its_hinge) {
    soup s = {0};
    const float ground[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    soup_add_quad(&s, ground[0], ground[1], ground[2], ground[3]);
    const float plate[4][3] = {{-1, 0, 0}, {1, 0, 0}, {1, 1, 0.0175f}, {-1, 1, 0.0175f}};
    soup_add_quad(&s, plate[0], plate[1], plate[2], plate[3]);
    shb_context *context = make_context(1);
    const shb_view view =
        view_of(&(light){false, {0.1, 0.05, 1}}, (shb_box){{-1, -1, 0}, {1, 1, 0.1}}, 64, true);
    shb_lists *lists = build(context, &view, 64, soup_scene(&s));
    for (double distance = 0.5; distance > 1e-12; distance *= 0.5) {
        const double x = 0.123, z = 0, behind = distance, before = -distance;
        float visibility[2];
        ask_one(lists, x, behind, z, &visibility[0]);
        ask_one(lists, x, before, z, &visibility[1]);
        CHECK(visibility[0] == 0 && visibility[1] == 1);
    }
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

static void make_soup(soup *s, float scale) {
    test_random random = {8};
    for (int i = 0; i < 300; i++)
        add_random(s, &random, 0.2);
    for (size_t i = 0; i < 9 * (size_t)s->count; i++)
        s->positions[i] *= scale;
}

/* The cell that holds a texel: its entries, and how far they reach. */
typedef struct cell_view {
    const uint32_t *entries;
    size_t count;
    float far;
} cell_view;

static cell_view cell_at(const shb_lists *lists, uint32_t column, uint32_t row) {
    const shb_list_tile *tile =
        &lists->tiles[row / SHB_LIST_TILE * lists->tile_columns + column / SHB_LIST_TILE];
    if (tile->cell_bits < 0)
        return (cell_view){.far = HUGE_VALF};
    const shb_list_cell *cell =
        &lists->cells[shb_list_cell_of(tile, column % SHB_LIST_TILE, row % SHB_LIST_TILE)];
    return (cell_view){lists->entries + tile->first_entry + cell[0].start,
                       cell[1].start - cell[0].start, cell[0].far};
}

static size_t count_entries(const shb_lists *lists) {
    size_t count = 0;
    for (uint32_t row = 0; row < lists->height; row++)
        for (uint32_t column = 0; column < lists->width; column++)
            count += cell_at(lists, column, row).count;
    return count;
}

/* The same entries in the same order in every texel. */
static bool lists_equal(const shb_lists *a, const shb_lists *b) {
    if (a->width != b->width || a->height != b->height)
        return false;
    for (uint32_t row = 0; row < a->height; row++)
        for (uint32_t column = 0; column < a->width; column++) {
            const cell_view x = cell_at(a, column, row), y = cell_at(b, column, row);
            if (x.count != y.count)
                return false;
            if (x.count && memcmp(x.entries, y.entries, x.count * sizeof *x.entries) != 0)
                return false;
        }
    return true;
}

TEST(lists_do_not_depend_on_the_unit_of_length) {
    shb_context *context = make_context(1);
    shb_lists *lists[3];
    samples points[3];
    soup s[3] = {{0}, {0}, {0}};
    for (int i = 0; i < 3; i++) {
        const float scale = i == 0 ? 1 : i == 1 ? 0x1p20f : 0x1p-30f;
        make_soup(&s[i], scale);
        shb_box box;
        CHECK_INT(shb_scene_bounds(soup_scene(&s[i]), &box), SHB_OK);
        const shb_view view = view_of(&slanted, box, 128, true);
        lists[i] = build(context, &view, 128, soup_scene(&s[i]));
        points[i] = samples_create(soup_scene(&s[i]), 2000, 9);
        ask(lists[i], &points[i], false, 0);
        CHECK(lists_equal(lists[0], lists[i]));
        CHECK(memcmp(points[0].visibility, points[i].visibility, 2000 * sizeof(float)) == 0);
    }
    for (int i = 0; i < 3; i++) {
        samples_free(&points[i]);
        shb_lists_destroy(lists[i]);
        soup_free(&s[i]);
    }
    shb_context_destroy(context);
}

TEST(lists_do_not_depend_on_threads) {
    soup s = {0};
    test_random random = {10};
    for (int i = 0; i < 5000; i++)
        add_random(&s, &random, i % 50 == 0 ? 0.9 : 0.05);
    const shb_box box = {{-2, -2, -2}, {2, 2, 2}};
    const shb_view view = view_of(&spot, box, 300, true);
    shb_context *one = make_context(1), *four = make_context(4);
    shb_lists *a = build(one, &view, 300, soup_scene(&s));
    shb_lists *b = build(four, &view, 300, soup_scene(&s));
    CHECK(lists_equal(a, b));
    CHECK(memcmp(a->planes, b->planes, a->id_count * sizeof *a->planes) == 0);
    for (uint32_t i = 0; i < a->id_count; i++)
        CHECK(memcmp(&a->triangles[i], &b->triangles[i], 15 * sizeof(float)) == 0);
    CHECK(count_entries(a) > 5000);
    shb_lists_destroy(a);
    shb_lists_destroy(b);
    shb_context_destroy(one);
    shb_context_destroy(four);
    soup_free(&s);
}

TEST(lists_do_not_depend_on_the_instruction_set) {
    soup s = {0};
    test_random random = {13};
    for (int i = 0; i < 3000; i++)
        add_random(&s, &random, i % 50 == 0 ? 0.9 : 0.05);
    const shb_view view = view_of(&spot, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 300, true);
    shb_context *best = make_context(1), *scalar = NULL;
    const shb_context_desc desc = {.threads = 1, .max_isa = SHB_ISA_SCALAR};
    CHECK_INT(shb_context_create(&desc, &scalar), SHB_OK);
    shb_lists *a = build(best, &view, 300, soup_scene(&s));
    shb_lists *b = build(scalar, &view, 300, soup_scene(&s));
    CHECK(lists_equal(a, b));
    CHECK(memcmp(a->planes, b->planes, a->id_count * sizeof *a->planes) == 0);
    for (uint32_t i = 0; i < a->id_count; i++)
        CHECK(memcmp(&a->triangles[i], &b->triangles[i], 15 * sizeof(float)) == 0);
    samples x = samples_create(soup_scene(&s), 3000, 14);
    samples y = samples_create(soup_scene(&s), 3000, 14);
    ask(a, &x, false, 0x1p-24);
    ask(b, &y, false, 0x1p-24);
    CHECK(memcmp(x.visibility, y.visibility, 3000 * sizeof(float)) == 0);
    samples_free(&x);
    samples_free(&y);
    shb_lists_destroy(a);
    shb_lists_destroy(b);
    shb_context_destroy(best);
    shb_context_destroy(scalar);
    soup_free(&s);
}

/* The lists place the points themselves; the truth gets them from the same weights. */
TEST(points_by_their_weights_get_the_answers_of_rays) {
    enum { COUNT = 5000 };
    soup s = {0};
    test_random random = {15};
    for (int i = 0; i < 500; i++)
        add_random(&s, &random, i % 9 == 0 ? 0.8 : 0.1);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = make_context(1);
    const shb_view view = view_of(&slanted, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 200, true);
    shb_lists *lists = build(context, &view, 200, scene);
    samples points = samples_create(scene, COUNT, 16);
    static float weight_1[COUNT], weight_2[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        shb_vec3 c[3];
        CHECK_INT(shb_scene_triangle(scene, points.own_ids[i], c), SHB_OK);
        weight_1[i] = (float)random_double(&random, 0, 0.5);
        weight_2[i] = (float)random_double(&random, 0, 0.5);
        const shb_vec3 along_1 = shb_vec3_scale(shb_vec3_subtract(c[1], c[0]), (double)weight_1[i]);
        const shb_vec3 along_2 = shb_vec3_scale(shb_vec3_subtract(c[2], c[0]), (double)weight_2[i]);
        points.points[i] = shb_vec3_add(c[0], shb_vec3_add(along_1, along_2));
    }
    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    find_truth(reference, &view, &points);
    CHECK(count_occluded(&points) > 1000);
    const shb_list_points asked = {.count = COUNT,
                                   .own_ids = points.own_ids,
                                   .weight_1 = weight_1,
                                   .weight_2 = weight_2,
                                   .rounding = 0x1p-24};
    shb_lists_query(lists, &asked, points.visibility);
    CHECK_INT(count_false_shadow(&points), 0);
    CHECK_INT(count_false_light(&points), 0);
    samples_free(&points);
    shb_reference_destroy(reference);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(what_the_light_does_not_see_is_lit) {
    soup s = {0};
    const float corners[3][3] = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    soup_add(&s, corners[0], corners[1], corners[2]);
    shb_view view;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0}, 1,
                                   1, 1, 8, false, &view),
              SHB_OK);
    shb_context *context = make_context(1);
    shb_lists *lists = build(context, &view, 16, soup_scene(&s));
    /* behind the triangle, also beyond the far plane; before it; outside; behind the light; none */
    const double x[] = {0, 0, 0, 3, 0, (double)NAN, 0}, y[7] = {0};
    const double z[] = {-1, -90, 1, -1, 9, -1, -HUGE_VAL};
    const float expected[] = {0, 0, 1, 1, 1, 1, 1};
    float visibility[7];
    shb_lists_query(lists, &(shb_list_points){.count = 7, .x = x, .y = y, .z = z}, visibility);
    for (int i = 0; i < 7; i++)
        CHECK(visibility[i] == expected[i]);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(lists_of_nothing_light_everything) {
    const shb_scene scene = {0};
    const shb_view view = view_of(&slanted, (shb_box){{-1, -1, -1}, {1, 1, 1}}, 8, false);
    shb_context *context = make_context(1);
    shb_lists *lists = build(context, &view, 8, &scene);
    const double x = 0, y = 0, z = 0;
    float visibility = 0;
    ask_one(lists, x, y, z, &visibility);
    CHECK(visibility == 1);
    shb_lists_destroy(lists);
    shb_context_destroy(context);
}

TEST(lists_under_a_memory_cap_are_smaller_and_say_the_same) {
    soup s = {0};
    make_soup(&s, 1);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = make_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_view view = view_of(&slanted, box, 512, true);
    shb_lists *all = build(context, &view, 512, scene), *least = build(context, &view, 1, scene);
    const size_t cap = (all->memory_bytes + 3 * least->memory_bytes) / 4;
    shb_lists *capped = NULL;
    CHECK_INT(shb_lists_build(context, "test", &view, 512, 512, scene, cap, &capped), SHB_OK);
    CHECK(capped->memory_bytes <= cap && capped->width < 512);
    samples a = samples_create(scene, 3000, 11), b = samples_create(scene, 3000, 11);
    ask(all, &a, true, 0);
    ask(capped, &b, true, 0);
    CHECK(memcmp(a.visibility, b.visibility, 3000 * sizeof(float)) == 0);
    shb_lists *none = NULL;
    CHECK_INT(
        shb_lists_build(context, "test", &view, 512, 512, scene, least->memory_bytes - 1, &none),
        SHB_ERROR_MEMORY);
    CHECK(none == NULL);
    samples_free(&a);
    samples_free(&b);
    shb_lists_destroy(all);
    shb_lists_destroy(least);
    shb_lists_destroy(capped);
    shb_context_destroy(context);
    soup_free(&s);
}

static void keep_sentence(void *user, shb_result result, const char *sentence) {
    (void)result;
    char *kept = user;
    snprintf(kept, 256, "%s", sentence);
}

static shb_map *make_map(shb_context *context, const shb_view *view, size_t occluder_memory) {
    const shb_map_desc desc = {.view = *view,
                               .width = 256,
                               .occluders = SHB_OCCLUDERS_LISTS,
                               .occluder_memory = occluder_memory};
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    return map;
}

TEST(a_map_keeps_to_the_memory_for_its_occluders_and_says_the_same) {
    enum { COUNT = 2000 };
    soup s = {0};
    make_soup(&s, 1);
    const shb_scene *scene = soup_scene(&s);
    char sentence[256] = "";
    shb_context *context = NULL;
    const shb_context_desc desc = {.threads = 1, .log = keep_sentence, .log_user = sentence};
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_view view = view_of(&slanted, box, 256, true);
    shb_map *free_map = make_map(context, &view, 0);
    const size_t texels = shb_map_get_info(free_map)->memory_bytes;
    CHECK_INT(shb_map_draw(free_map, scene, NULL, NULL), SHB_OK);
    const size_t all = shb_map_get_info(free_map)->memory_bytes - texels;
    shb_lists *least = build(context, &view, 1, scene);
    const size_t cap = (all + 3 * least->memory_bytes) / 4;
    shb_map *capped = make_map(context, &view, cap);
    CHECK_INT(shb_map_draw(capped, scene, NULL, NULL), SHB_OK);
    CHECK(shb_map_get_info(capped)->memory_bytes - texels <= cap && cap < all);

    samples points = samples_create(scene, COUNT, 17);
    static float positions[3 * COUNT], a[COUNT], b[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        positions[3 * i] = (float)points.x[i];
        positions[3 * i + 1] = (float)points.y[i];
        positions[3 * i + 2] = (float)points.z[i];
    }
    const shb_points asked = {.count = COUNT, .positions = positions};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_map_visibility(free_map, &asked, &exact, NULL, a), SHB_OK);
    CHECK_INT(shb_map_visibility(capped, &asked, &exact, NULL, b), SHB_OK);
    CHECK(memcmp(a, b, sizeof a) == 0);

    shb_map *tight = make_map(context, &view, least->memory_bytes - 1);
    CHECK_INT(shb_map_draw(tight, scene, NULL, NULL), SHB_ERROR_MEMORY);
    CHECK(strstr(sentence, "shb_map_draw") && strstr(sentence, "desc.occluder_memory"));
    CHECK_INT(shb_map_get_info(tight)->memory_bytes, texels);
    shb_lists_destroy(least);
    shb_map_destroy(free_map);
    shb_map_destroy(capped);
    shb_map_destroy(tight);
    samples_free(&points);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(lists_without_memory_fail_and_leak_nothing) {
    soup s = {0};
    make_soup(&s, 1);
    const shb_view view = view_of(&slanted, (shb_box){{-2, -2, -2}, {2, 2, 2}}, 64, true);
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t step = 1; result != SHB_OK; step++) {
        test_allocator allocator = {0};
        shb_context *context;
        const shb_context_desc desc = {.allocator = test_allocator_hooks(&allocator), .threads = 1};
        CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
        allocator.calls = 0;
        allocator.fail_at = step;
        shb_lists *lists = NULL;
        result = shb_lists_build(context, "test", &view, 64, 64, soup_scene(&s), 0, &lists);
        CHECK(result == SHB_OK ? step > 10 : result == SHB_ERROR_MEMORY && !lists);
        shb_lists_destroy(lists);
        shb_context_destroy(context);
        CHECK_INT(allocator.live, 0);
    }
    soup_free(&s);
}

TEST(a_map_with_lists_answers_as_rays_without_normals) {
    soup s = {0};
    const float ground_lo[3] = {-2, -2, -1}, ground_hi[3] = {2, 2, 0};
    soup_add_box(&s, ground_lo, ground_hi);
    const float lo[3] = {-0.4f, -0.3f, 0}, hi[3] = {0.5f, 0.4f, 1};
    soup_add_box(&s, lo, hi);
    const shb_scene *scene = soup_scene(&s);
    shb_context *context = make_context(1);
    shb_box box;
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    const shb_map_desc desc = {
        .view = view_of(&slanted, box, 16, true), .width = 16, .occluders = SHB_OCCLUDERS_LISTS};
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
    const size_t before = shb_map_get_info(map)->memory_bytes;
    for (int draw = 0; draw < 2; draw++)
        CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    CHECK(shb_map_get_info(map)->memory_bytes > before);

    shb_reference *reference = NULL;
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    samples points = samples_create(scene, 3000, 12);
    find_truth(reference, &desc.view, &points);
    float *positions = malloc(points.count * 3 * sizeof *positions);
    for (size_t i = 0; i < points.count; i++) {
        positions[3 * i] = (float)points.x[i];
        positions[3 * i + 1] = (float)points.y[i];
        positions[3 * i + 2] = (float)points.z[i];
    }
    const shb_points asked = {.count = points.count, .positions = positions};
    const shb_bias exact = shb_bias_exact();
    CHECK_INT(shb_map_visibility(map, &asked, &exact, NULL, points.visibility), SHB_OK);
    CHECK(count_occluded(&points) > 300);
    CHECK_INT(count_false_shadow(&points), 0);
    CHECK(count_false_light(&points) <= 4); /* the ground under the box: contact */
    free(positions);
    samples_free(&points);
    shb_reference_destroy(reference);
    shb_map_destroy(map);
    shb_context_destroy(context);
    soup_free(&s);
}
