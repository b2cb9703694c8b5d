/* Points that come with their triangles and weights: the exact method answers for the points that
 * these name, wherever floats would have moved them. */
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "scenes.h"
#include "soup.h"
#include "test.h"

#include "shadowbias/reference.h"
#include "shadowbias/shade.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COUNT = 4000 };

/* Points of a scene by triangle and weights, their positions in float, and the truth. */
typedef struct named_points {
    uint32_t ids[COUNT];
    float weight_1[COUNT], weight_2[COUNT];
    float positions[3 * COUNT], normals[3 * COUNT];
    uint8_t occluded[COUNT];
    float visibility[COUNT];
} named_points;

static shb_vec3 corner_sum(const shb_vec3 c[3], double w1, double w2) {
    const shb_vec3 along_1 = shb_vec3_scale(shb_vec3_subtract(c[1], c[0]), w1);
    const shb_vec3 along_2 = shb_vec3_scale(shb_vec3_subtract(c[2], c[0]), w2);
    return shb_vec3_add(c[0], shb_vec3_add(along_1, along_2));
}

static void write_floats(float out[3], shb_vec3 v) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static named_points *points_of(const shb_scene *scene, const shb_view *view, uint64_t seed) {
    static shb_vec3 exact[COUNT];
    named_points *p = calloc(1, sizeof *p);
    test_random random = {seed};
    for (int i = 0; i < COUNT; i++) {
        shb_vec3 c[3];
        p->ids[i] = random_below(&random, (uint32_t)shb_scene_triangle_count(scene));
        shb_scene_triangle(scene, p->ids[i], c);
        p->weight_1[i] = (float)random_double(&random, 0, 1);
        p->weight_2[i] = (float)random_double(&random, 0, 1) * (1 - p->weight_1[i]);
        exact[i] = corner_sum(c, (double)p->weight_1[i], (double)p->weight_2[i]);
        write_floats(p->positions + 3 * i, exact[i]);
        const shb_vec3 normal =
            shb_vec3_cross(shb_vec3_subtract(c[1], c[0]), shb_vec3_subtract(c[2], c[0]));
        write_floats(p->normals + 3 * i, shb_vec3_normalize(normal));
    }
    shb_context *context = NULL;
    shb_reference *reference = NULL;
    shb_light_source light;
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    CHECK_INT(shb_view_light_source(view, &light), SHB_OK);
    CHECK_INT(shb_reference_occluded(reference, &light, COUNT, exact, p->ids, p->occluded), SHB_OK);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    return p;
}

static shb_points asked(const named_points *p, bool by_name) {
    shb_points points = {.count = COUNT, .positions = p->positions, .normals = p->normals};
    if (by_name)
        points.own = (shb_own_triangles){p->ids, p->weight_1, p->weight_2};
    return points;
}

typedef struct wrong_answers {
    int shadow, light;
} wrong_answers;

static wrong_answers ask(const shb_map *map, named_points *p, bool by_name) {
    const shb_points points = asked(p, by_name);
    const shb_bias exact = shb_bias_exact();
    wrong_answers wrong = {0, 0};
    CHECK_INT(shb_map_visibility(map, &points, &exact, NULL, p->visibility), SHB_OK);
    for (int i = 0; i < COUNT; i++) {
        wrong.shadow += !p->occluded[i] && p->visibility[i] == 0;
        wrong.light += p->occluded[i] && p->visibility[i] == 1;
    }
    return wrong;
}

static shb_map *map_of(shb_context *context, const shb_map_desc *desc, const shb_scene *scene) {
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, scene, NULL, NULL), SHB_OK);
    return map;
}

/* A ball that hovers over a thick plate, both closed; all of it moved away from the origin. */
static soup far_ball(float away) {
    soup s = {0};
    const float centre[3] = {away, away, away + 1.5f};
    const float lo[3] = {away - 3, away - 3, away - 1}, hi[3] = {away + 3, away + 3, away};
    soup_add_ball(&s, centre, 40, 20, NULL);
    soup_add_box(&s, lo, hi);
    return s;
}

static shb_view sun_over(const shb_scene *scene) {
    shb_box box;
    shb_view view = {0};
    CHECK_INT(shb_scene_bounds(scene, &box), SHB_OK);
    CHECK_INT(shb_view_fit_directional((shb_vec3){0.3, 0.4, 0.8}, box, 256, true, &view), SHB_OK);
    return view;
}

/* The ball this far away, asked by name; floats are 2^-7 apart at 10^5: positions lie below the
 * ball's facets and the plate, or above. */
static wrong_answers ask_far_ball(float away, shb_occluders occluders, bool classifies,
                                  uint64_t seed) {
    soup s = far_ball(away);
    const shb_scene *scene = soup_scene(&s);
    const shb_map_desc desc = {
        .view = sun_over(scene), .width = 256, .occluders = occluders, .classifies = classifies};
    named_points *p = points_of(scene, &desc.view, seed);
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_map *map = map_of(context, &desc, scene);
    const wrong_answers named = ask(map, p, true), plain = ask(map, p, false);
    CHECK(away < 1e5f || plain.shadow + plain.light > 10);
    shb_map_destroy(map);
    shb_context_destroy(context);
    free(p);
    soup_free(&s);
    return named;
}

TEST(named_points_of_lists_answer_as_rays_where_floats_are_coarse) {
    static const float away[] = {0, 1e3f, 1e5f, 3e6f};
    for (int i = 0; i < 8; i++) {
        const wrong_answers named = ask_far_ball(away[i / 2], SHB_OCCLUDERS_LISTS, i % 2, 41);
        CHECK_INT(named.shadow + named.light, 0);
    }
}

/* On closed meshes a walk cannot end in false shadow; what is left is a silhouette inside a texel
 * that no sample sees, a few of COUNT. */
TEST(named_points_of_triangles_get_no_false_shadow_where_floats_are_coarse) {
    static const float away[] = {0, 1e5f, 3e6f};
    for (int i = 0; i < 6; i++) {
        const wrong_answers named = ask_far_ball(away[i / 2], SHB_OCCLUDERS_TRIANGLES, i % 2, 42);
        CHECK_INT(named.shadow, 0);
        CHECK(named.light <= 2);
    }
}

/* Faces that touch others to 3e-9 units, which is less than their floats are rounded by. */
TEST(named_points_of_a_house_answer_as_rays) {
    example_scene *house = NULL;
    char error[512];
    if (!scene_open("../shared/scenes/house.obj", &house, error, sizeof error)) {
        test_skip("no mesh of a house");
        return;
    }
    shb_view view;
    CHECK_INT(scene_light_view(house, SCENE_DIRECTIONAL, 256, false, &view), SHB_OK);
    named_points *p = points_of(&house->scene, &view, 43);
    shb_context *context = test_context(0, SHB_ISA_BEST);
    shb_map *map = map_of(
        context, &(shb_map_desc){.view = view, .width = 256, .occluders = SHB_OCCLUDERS_LISTS},
        &house->scene);
    const wrong_answers named = ask(map, p, true);
    CHECK_INT(named.shadow + named.light, 0);
    shb_map_destroy(map);
    shb_context_destroy(context);
    free(p);
    scene_close(house);
}

/* A floor and a plate over a part of it, with the light straight above. */
typedef struct plate_map {
    soup s;
    shb_context *context;
    shb_map *map;
    int failures;
} plate_map;

static void count_failure(void *user, shb_result result, const char *sentence) {
    plate_map *host = user;
    host->failures++;
    CHECK_INT(result, SHB_ERROR_ARGUMENT);
    CHECK(strncmp(sentence, "shb_map_visibility: ", 20) == 0);
}

static void open_plate(plate_map *host, shb_occluders occluders) {
    *host = (plate_map){0};
    soup_add_quad(&host->s, (float[]){-1, -1, 0}, (float[]){1, -1, 0}, (float[]){1, 1, 0},
                  (float[]){-1, 1, 0});
    soup_add_quad(&host->s, (float[]){-1, -1, 1}, (float[]){0.1f, -1, 1}, (float[]){0.1f, 1, 1},
                  (float[]){-1, 1, 1});
    const shb_context_desc desc = {.log = count_failure, .log_user = host};
    CHECK_INT(shb_context_create(&desc, &host->context), SHB_OK);
    host->map = map_of(
        host->context,
        &(shb_map_desc){.view = probe_orthographic(false), .width = 16, .occluders = occluders},
        soup_scene(&host->s));
}

static void close_plate(plate_map *host) {
    shb_map_destroy(host->map);
    shb_context_destroy(host->context);
    soup_free(&host->s);
}

static const float floor_positions[] = {0.5f, -0.5f, 0, -0.5f, -0.75f, 0};
static const float floor_normals[] = {0, 0, 1, 0, 0, 1};

static shb_result ask_two(const plate_map *host, shb_own_triangles own, float visibility[2]) {
    const shb_points points = {
        .count = 2, .positions = floor_positions, .normals = floor_normals, .own = own};
    const shb_bias exact = shb_bias_exact();
    return shb_map_visibility(host->map, &points, &exact, NULL, visibility);
}

/* Triangle 0 has the corners (-1, -1), (1, -1), (1, 1). */
static const uint32_t floor_ids[] = {0, 0};
static const float floor_weight_1[] = {0.5f, 0.125f}, floor_weight_2[] = {0.25f, 0.125f};

TEST(ids_and_weights_of_a_host_are_checked) {
    static const uint32_t beyond[] = {0, 4}, none[] = {0, SHB_ID_NONE};
    const float *w1 = floor_weight_1, *w2 = floor_weight_2;
    const shb_own_triangles wrong[] = {
        {beyond, NULL, NULL},  {beyond, w1, w2},      {none, w1, w2},  {NULL, w1, w2},
        {floor_ids, w1, NULL}, {floor_ids, NULL, w2}, {NULL, w1, NULL}};
    const shb_own_triangles right[] = {
        {NULL, NULL, NULL}, {floor_ids, NULL, NULL}, {none, NULL, NULL}, {floor_ids, w1, w2}};
    for (int kind = SHB_OCCLUDERS_TRIANGLES; kind <= SHB_OCCLUDERS_LISTS; kind++) {
        plate_map host;
        open_plate(&host, (shb_occluders)kind);
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
            float visibility[2] = {7, 7};
            CHECK_INT(ask_two(&host, wrong[i], visibility), SHB_ERROR_ARGUMENT);
            CHECK_INT(host.failures, i + 1);
            CHECK(visibility[0] == 7 && visibility[1] == 7);
        }
        for (size_t i = 0; i < sizeof right / sizeof *right; i++) {
            float visibility[2] = {7, 7};
            CHECK_INT(ask_two(&host, right[i], visibility), SHB_OK);
            CHECK(visibility[0] == 1 && visibility[1] == 0);
        }
        close_plate(&host);
    }
}

TEST(ids_that_nobody_reads_are_not_checked) {
    static const uint32_t beyond[] = {9, 9};
    plate_map host;
    open_plate(&host, SHB_OCCLUDERS_PLANES);
    float visibility[2] = {7, 7};
    CHECK_INT(ask_two(&host, (shb_own_triangles){beyond, NULL, NULL}, visibility), SHB_OK);
    CHECK(visibility[0] == 1 && visibility[1] == 0);
    close_plate(&host);
}

/* Ids of other triangles, weights of other points or that are no numbers: positions decide. */
TEST(ids_that_do_not_fit_the_positions_are_not_believed) {
    static const uint32_t others[] = {2, 3};
    static const float nowhere[] = {NAN, INFINITY}, beside[] = {0.75f, 0.25f};
    const shb_own_triangles strange[] = {{others, floor_weight_1, floor_weight_2},
                                         {floor_ids, nowhere, nowhere},
                                         {floor_ids, beside, floor_weight_2}};
    for (int kind = SHB_OCCLUDERS_TRIANGLES; kind <= SHB_OCCLUDERS_LISTS; kind++) {
        plate_map host;
        open_plate(&host, (shb_occluders)kind);
        for (size_t i = 0; i < sizeof strange / sizeof *strange; i++) {
            float visibility[2] = {7, 7};
            CHECK_INT(ask_two(&host, strange[i], visibility), SHB_OK);
            CHECK(visibility[0] == 1 && visibility[1] == 0);
        }
        close_plate(&host);
    }
}

/* The plate ends at x = 0.1, the named point 1e-6 before that: dark. A position beyond is taken for
 * the same point up to 2^-18 of the corners' sizes, which are 3 in sum: 1.1e-5. */
TEST(positions_count_where_they_are_farther_off_than_a_host_rounds) {
    static const uint32_t id = 0;
    const float weight_1 = 0.3f - 0x1p-21f, weight_2 = 0.25f;
    const shb_bias exact = shb_bias_exact();
    plate_map host;
    open_plate(&host, SHB_OCCLUDERS_LISTS);
    for (int far = 0; far < 2; far++) {
        const float position[] = {0.1f + (far ? 0x1p-16f : 0x1p-17f), -0.5f, 0};
        const shb_points point = {
            .count = 1, .positions = position, .own = {&id, &weight_1, &weight_2}};
        float visibility = 7;
        CHECK_INT(shb_map_visibility(host.map, &point, &exact, NULL, &visibility), SHB_OK);
        CHECK(visibility == (float)far);
    }
    close_plate(&host);
}

/* The names say light where positions are dark, or the other way round. Triangle 2 is the plate's,
 * from (-1, -1, 1) to x = 0.1. */
TEST(positions_count_on_whatever_side_they_are_off) {
    static const struct {
        uint32_t id;
        float weight_1, position[3], visibility;
    } cases[] = {
        {0, 0.125f, {0.5f, -0.75f, 0}, 1},  {0, 0.5f, {-0.5f, -0.75f, 0}, 0},
        {0, 0.125f, {-0.5f, 1.5f, 0}, 1},   {0, 0.125f, {-0.5f, -1.5f, 0}, 1},
        {0, 0.125f, {-0.5f, -0.75f, 2}, 1}, {2, 0.125f, {-0.725f, -0.75f, 0}, 0},
    };
    static const float normal[] = {0, 0, 1}, weight_2 = 0.125f;
    const shb_bias exact = shb_bias_exact();
    for (int kind = SHB_OCCLUDERS_TRIANGLES; kind <= SHB_OCCLUDERS_LISTS; kind++) {
        plate_map host;
        open_plate(&host, (shb_occluders)kind);
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            const shb_points point = {.count = 1,
                                      .positions = cases[i].position,
                                      .normals = normal,
                                      .own = {&cases[i].id, &cases[i].weight_1, &weight_2}};
            float visibility = 7;
            CHECK_INT(shb_map_visibility(host.map, &point, &exact, NULL, &visibility), SHB_OK);
            CHECK(visibility == cases[i].visibility);
        }
        close_plate(&host);
    }
}

/* What a frame's fragments saw, pixel by pixel. */
enum { FRAME = 96 };
typedef struct seen_frame {
    uint32_t ids[FRAME * FRAME];
    float visibility[FRAME * FRAME], weight_1[FRAME * FRAME], weight_2[FRAME * FRAME];
} seen_frame;

static void keep_fragments(const shb_shade_args *args) {
    seen_frame *seen = (seen_frame *)(uintptr_t)args->user;
    for (size_t i = 0; i < args->count; i++) {
        const int at = args->fragments->pixel_y[i] * FRAME + args->fragments->pixel_x[i];
        seen->visibility[at] = args->lighting[0].visibility[i];
        seen->weight_1[at] = args->fragments->weight_1[i];
        seen->weight_2[at] = args->fragments->weight_2[i];
    }
}

/* Pixels that face the light, and those whose answer is not that of a ray from the point which
 * their id and weights name. */
static int count_wrong(const shb_scene *scene, const shb_view *view, const seen_frame *seen,
                       int *asked_pixels) {
    shb_context *context = NULL;
    shb_reference *reference = NULL;
    shb_light_source light;
    int wrong = 0;
    *asked_pixels = 0;
    context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(context, scene, &reference), SHB_OK);
    CHECK_INT(shb_view_light_source(view, &light), SHB_OK);
    for (int i = 0; i < FRAME * FRAME; i++) {
        shb_vec3 c[3];
        if (seen->ids[i] == SHB_ID_NONE)
            continue;
        shb_scene_triangle(scene, seen->ids[i], c);
        const shb_vec3 normal =
            shb_vec3_cross(shb_vec3_subtract(c[1], c[0]), shb_vec3_subtract(c[2], c[0]));
        if (!(shb_vec3_dot(normal, light.position) > 0))
            continue;
        const shb_vec3 point = corner_sum(c, (double)seen->weight_1[i], (double)seen->weight_2[i]);
        uint8_t occluded;
        CHECK_INT(shb_reference_occluded(reference, &light, 1, &point, &seen->ids[i], &occluded),
                  SHB_OK);
        wrong += (seen->visibility[i] == 0) != (occluded != 0);
        ++*asked_pixels;
    }
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    return wrong;
}

/* Wrong pixels of a picture of frame_scene, shaded with a map of scene. */
static int shade_wrong(const shb_scene *frame_scene, const shb_scene *scene, float away,
                       int *asked_pixels) {
    static seen_frame seen;
    memset(&seen, 0, sizeof seen);
    const shb_view sun = sun_over(scene);
    const shb_vec3 middle = {(double)away, (double)away, (double)away + 0.5};
    const shb_vec3 eye = shb_vec3_add(middle, (shb_vec3){4, -2, 7});
    shb_view camera;
    shb_context *context = NULL;
    CHECK_INT(shb_view_perspective(eye, middle, (shb_vec3){0, 0, 1}, 0.8, 1, 1, 30, false, &camera),
              SHB_OK);
    context = test_context(0, SHB_ISA_BEST);
    shb_map *map =
        map_of(context,
               &(shb_map_desc){.view = sun, .width = 256, .occluders = SHB_OCCLUDERS_LISTS}, scene);
    const shb_draw_desc draw = {
        .view = &camera, .scene = frame_scene, .width = FRAME, .height = FRAME, .ids = seen.ids};
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    const shb_bias exact = shb_bias_exact();
    const shb_shade_light light = {.map = map, .bias = &exact, .color = {1, 1, 1}};
    const shb_shade_desc shade = {.frame = {.view = &camera,
                                            .scene = frame_scene,
                                            .width = FRAME,
                                            .height = FRAME,
                                            .ids = seen.ids},
                                  .lights = &light,
                                  .light_count = 1,
                                  .shade = keep_fragments,
                                  .user = &seen};
    CHECK_INT(shb_shade(context, &shade), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return count_wrong(frame_scene, &sun, &seen, asked_pixels);
}

TEST(shading_asks_for_the_points_that_the_frame_names) {
    static const float away[] = {0, 1e5f};
    for (int i = 0; i < 2; i++) {
        soup s = far_ball(away[i]);
        int asked_pixels;
        CHECK_INT(shade_wrong(soup_scene(&s), soup_scene(&s), away[i], &asked_pixels), 0);
        CHECK(asked_pixels > FRAME * FRAME / 4);
        soup_free(&s);
    }
}

/* A map of the same triangles in another order: the ids of the frame mean others there. */
TEST(shading_goes_by_positions_where_the_map_has_other_ids) {
    soup s = far_ball(0), other = {0};
    const float lo[3] = {-3, -3, -1}, hi[3] = {3, 3, 0}, centre[3] = {0, 0, 1.5f};
    soup_add_box(&other, lo, hi);
    soup_add_ball(&other, centre, 40, 20, NULL);
    int asked_pixels;
    CHECK(shade_wrong(soup_scene(&s), soup_scene(&other), 0, &asked_pixels) <= 2);
    CHECK(asked_pixels > FRAME * FRAME / 4);
    soup_free(&s);
    soup_free(&other);
}
