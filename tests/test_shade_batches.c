/* Batches of a large frame: every pixel once, in order, whatever the threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "random.h"
#include "shading.h"
#include "test.h"

/* A large frame of many random triangles with holes, two lights with random maps. */
enum { WIDE = 1000, TALL = 50, TRIANGLES = 100 };

typedef struct crowd {
    float positions[9 * TRIANGLES], normals[9 * TRIANGLES];
    uint32_t *ids;
    float *depths;
    shb_view view, light_views[2];
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    shb_frame frame;
} crowd;

static void crowd_init(crowd *c) {
    test_random random = {3};
    for (int i = 0; i < 9 * TRIANGLES; i++) {
        c->positions[i] = (float)random_double(&random, -6, 6) - (i % 3 == 2 ? 8.0f : 0.0f);
        c->normals[i] = (float)random_double(&random, -1, 1);
    }
    c->ids = malloc(sizeof *c->ids * WIDE * TALL);
    for (int i = 0; i < WIDE * TALL; i++) {
        const uint32_t kind = random_below(&random, 8);
        c->ids[i] = kind == 0   ? SHB_ID_NONE
                    : kind == 1 ? TRIANGLES + random_below(&random, 5)
                                : random_below(&random, TRIANGLES);
    }
    memset(c->ids + 7 * WIDE, 0, sizeof *c->ids * WIDE);    /* a row of a single triangle */
    memset(c->ids + 8 * WIDE, 0xff, sizeof *c->ids * WIDE); /* an empty row */
    c->depths = malloc(sizeof *c->depths * 64 * 64);
    for (int i = 0; i < 64 * 64; i++)
        c->depths[i] = (float)random_double(&random, 0.3, 1);
    c->view = pinhole();
    const shb_box box = {{-6, -6, -14}, {6, 6, -2}};
    CHECK_INT(shb_view_fit_directional((shb_vec3){1, 2, 3}, box, 64, false, &c->light_views[0]), 0);
    CHECK_INT(shb_view_fit_spot((shb_vec3){-9, 20, 5}, box, 64, false, &c->light_views[1]), 0);
    c->mesh = (shb_mesh){.positions = c->positions,
                         .normals = c->normals,
                         .vertex_count = 3 * TRIANGLES,
                         .triangle_count = TRIANGLES};
    c->instance = (shb_instance){.mesh = &c->mesh};
    c->scene = (shb_scene){&c->instance, 1};
    c->frame = (shb_frame){&c->view, &c->scene, WIDE, TALL, c->ids, 0};
}

static void crowd_destroy(crowd *c) {
    free(c->ids);
    free(c->depths);
}

TEST(shade_batches_hold_every_covered_pixel_once) {
    crowd c;
    crowd_init(&c);
    shb_context *context = shading_context(2);
    seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = c.frame});
    unsigned wrong = 0;
    for (int i = 0; i < WIDE * TALL; i++) {
        const bool covered = c.ids[i] < TRIANGLES;
        wrong += pixels[i].times != covered || (covered && pixels[i].id != c.ids[i]);
    }
    CHECK_INT(wrong, 0);
    free(pixels);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

/* Counts the batches by size. */
static void count_sizes(const shb_shade_args *args) {
    unsigned *const *sizes = args->user;
    (*sizes)[args->count]++;
}

TEST(shade_batches_take_rows_as_long_as_the_next_is_sure_to_fit) {
    /* A covered row of 1000 is seven times 128 and 104; 257 are 128 + 128 + 1. Of five rows of 128
     * two and two fit into 256, and of five rows of 60 three, as a fourth may be 128. */
    quad q;
    quad_init(&q, 4, 0);
    uint32_t ids[1000] = {0};
    q.frame.width = 1000;
    q.frame.height = 1;
    q.frame.ids = ids;
    unsigned counts[SHB_BATCH + 1] = {0}, *sizes = counts;
    shb_context *context = shading_context(1);
    shb_shade_desc desc = {.frame = q.frame, .shade = count_sizes, .user = &sizes};
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[128], 7);
    CHECK_INT(counts[104], 1);
    desc.frame.width = 257;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[128], 9);
    CHECK_INT(counts[1], 1);
    desc.frame.width = 128;
    desc.frame.height = 5;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[256], 2);
    CHECK_INT(counts[128], 10);
    desc.frame.width = 60;
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK_INT(counts[180], 1);
    CHECK_INT(counts[120], 1);
    shb_context_destroy(context);
}

TEST(shade_positions_lie_where_drawing_saw_the_triangle) {
    /* Drawn for real: the point projects to within the 1/512 pixel by which corners are snapped,
     * and has the drawn depth. A float position near 10 moves by up to 2^-21 each way. */
    crowd c;
    crowd_init(&c);
    shb_context *context = shading_context(2);
    float *depths = malloc(sizeof *depths * WIDE * TALL);
    const shb_draw_desc draw = {.view = &c.view,
                                .scene = &c.scene,
                                .width = WIDE,
                                .height = TALL,
                                .depth = {depths, 0, SHB_FORMAT_FLOAT32},
                                .ids = c.ids};
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    seen_pixel *pixels = shade_and_record(context, (shb_shade_desc){.frame = c.frame});
    double worst_x = 0, worst_y = 0;
    unsigned covered = 0, wrong_depth = 0;
    for (int i = 0; i < WIDE * TALL; i++) {
        if (c.ids[i] == SHB_ID_NONE)
            continue;
        covered++;
        const float *p = pixels[i].position;
        const double w = -(double)p[2];
        const double off_x = fabs(((double)p[0] / w + 1) * WIDE / 2 - i % WIDE - 0.5);
        const double off_y = fabs((1 - (double)p[1] / w) * TALL / 2 - i / WIDE - 0.5);
        worst_x = off_x > worst_x ? off_x : worst_x;
        worst_y = off_y > worst_y ? off_y : worst_y;
        wrong_depth += fabs((w - 0.125) / w - (double)depths[i]) > 1e-5;
    }
    CHECK(covered > 10000);
    CHECK(worst_x < 0.003 && worst_y < 0.003);
    CHECK(wrong_depth <= covered / 1000);
    free(depths);
    free(pixels);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

TEST(shade_visibility_is_what_the_map_says_of_the_position) {
    crowd c;
    crowd_init(&c);
    shb_context *context = shading_context(2);
    const shb_bias bias = shb_bias_texel_cone();
    shb_shade_light lights[2] = {{.bias = &bias}, {.bias = &bias}};
    for (int k = 0; k < 2; k++)
        lights[k].map = shading_map(context, &c.light_views[k], 64, 64, c.depths);
    seen_pixel *pixels = shade_and_record(
        context, (shb_shade_desc){.frame = c.frame, .lights = lights, .light_count = 2});
    unsigned differing = 0, lit = 0, shadowed = 0, away = 0;
    for (int k = 0; k < 2; k++) {
        float *visibility = malloc(sizeof *visibility * WIDE * TALL);
        const shb_points points = {.count = WIDE * TALL,
                                   .positions = pixels->position,
                                   .position_stride = sizeof *pixels,
                                   .normals = pixels->normal,
                                   .normal_stride = sizeof *pixels};
        CHECK_INT(shb_map_visibility(lights[k].map, &points, &bias, NULL, visibility), SHB_OK);
        const shb_light_source source = shb_map_get_info(lights[k].map)->light;
        for (int i = 0; i < WIDE * TALL; i++) {
            const seen_pixel *p = &pixels[i];
            if (!p->times)
                continue;
            double side = 0;
            const double light[3] = {source.position.x, source.position.y, source.position.z};
            for (int axis = 0; axis < 3; axis++)
                side +=
                    (double)p->normal[axis] * (light[axis] - source.w * (double)p->position[axis]);
            if (fabs(side) < 1e-4)
                continue;
            const float expected = side > 0 ? visibility[i] : 0;
            differing += p->visibility[k] != expected;
            lit += expected == 1;
            shadowed += side > 0 && expected == 0;
            away += side < 0;
        }
        free(visibility);
    }
    CHECK_INT(differing, 0);
    CHECK(lit > 1000 && shadowed > 1000 && away > 1000);
    free(pixels);
    for (int k = 0; k < 2; k++)
        shb_map_destroy((shb_map *)lights[k].map);
    shb_context_destroy(context);
    crowd_destroy(&c);
}

static void backwards(void *user, shb_task_fn *task, void *arg, size_t count) {
    (void)user;
    while (count)
        task(arg, --count);
}

TEST(shade_image_does_not_depend_on_threads_or_order) {
    crowd c;
    crowd_init(&c);
    uint8_t *images = calloc(4, 3 * WIDE * TALL);
    for (uint32_t i = 0; i < 4; i++) {
        const shb_context_desc context_desc = {.threads = i == 2 ? 7 : i + 1,
                                               .parallel_for = i == 3 ? backwards : NULL};
        shb_context *context = NULL;
        CHECK_INT(shb_context_create(&context_desc, &context), SHB_OK);
        const shb_bias bias = shb_bias_receiver_plane(1e-5f);
        shb_shade_light lights[2] = {{.bias = &bias, .color = {0.5f, 0.4f, 0.3f}},
                                     {.bias = &bias, .color = {0.2f, 0.4f, 0.6f}}};
        for (int k = 0; k < 2; k++)
            lights[k].map = shading_map(context, &c.light_views[k], 64, 64, c.depths);
        const shb_shade_desc desc = {
            .frame = c.frame,
            .lights = lights,
            .light_count = 2,
            .shade = shb_shade_lambert,
            .image = {images + (size_t)i * 3 * WIDE * TALL, WIDE, TALL, 0}};
        CHECK_INT(shb_shade(context, &desc), SHB_OK);
        CHECK(memcmp(images, desc.image.pixels, 3 * WIDE * TALL) == 0);
        for (int k = 0; k < 2; k++)
            shb_map_destroy((shb_map *)lights[k].map);
        shb_context_destroy(context);
    }
    free(images);
    crowd_destroy(&c);
}
