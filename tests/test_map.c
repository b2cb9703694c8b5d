/* Making, wrapping and drawing maps, and what is left behind when that fails. */
#include "allocator.h"
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <string.h>

typedef struct setting {
    test_allocator memory;
    shb_context *context;
    test_log log;
} setting;

static void open_context(setting *host) {
    *host = (setting){0};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&host->memory),
                                   .threads = 1,
                                   .log = test_log_keep,
                                   .log_user = &host->log};
    CHECK_INT(shb_context_create(&desc, &host->context), SHB_OK);
}

static void close_context(setting *host) {
    shb_context_destroy(host->context);
    CHECK_INT(host->memory.live, 0);
}

static shb_map_desc plain_desc(void) {
    return (shb_map_desc){.view = probe_orthographic(false), .width = 20, .height = 10};
}

TEST(a_new_map_tells_what_it_is) {
    setting host;
    open_context(&host);
    shb_map_desc desc = plain_desc();
    desc.format = SHB_FORMAT_UNORM16;
    desc.scene_scale = 12;
    shb_map *map;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    const shb_map_info *info = shb_map_get_info(map);
    CHECK_INT(info->width, 20);
    CHECK_INT(info->height, 10);
    CHECK_INT(info->format, SHB_FORMAT_UNORM16);
    CHECK_NEAR(info->scene_scale, 12, 0);
    CHECK(memcmp(&info->view, &desc.view, sizeof desc.view) == 0);
    CHECK_NEAR(info->light.w, 0, 0); /* straight up */
    CHECK_NEAR(info->light.position.z, 1, 1e-15);
    const shb_depth_image depth = shb_map_get_depth(map);
    CHECK_INT(depth.format, SHB_FORMAT_UNORM16);
    CHECK_INT(depth.stride, 128); /* 40 bytes, rounded up to 64, and 64 more */
    CHECK_INT((uintptr_t)depth.texels % 64, 0);
    CHECK_INT(info->memory_bytes, 128 * 10 + shb_clear_marks_size(20, 10));
    CHECK_NEAR(info->draw_seconds, 0, 0);
    shb_map_destroy(map);

    desc = plain_desc();
    desc.height = 0;
    desc.width = 16;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_get_info(map)->height, 16);
    CHECK_INT(shb_map_get_depth(map).stride, 128); /* 64 bytes and 64 more */
    CHECK_NEAR(shb_map_get_info(map)->scene_scale, 0, 0);
    shb_map_destroy(map);
    close_context(&host);
    shb_map_destroy(NULL);
    CHECK(!shb_map_get_info(NULL));
    CHECK(!shb_map_get_depth(NULL).texels);
}

TEST(an_empty_map_lights_everything_by_any_method) {
    setting host;
    open_context(&host);
    test_random random = {6};
    float positions[300], normals[300];
    for (int i = 0; i < 300; i++) {
        positions[i] = (float)random_double(&random, -1.5, 1.5);
        normals[i] = (float)random_double(&random, -1, 1);
    }
    positions[2] = -50; /* beyond the far plane */
    const shb_points points = {.count = 100, .positions = positions, .normals = normals};
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    for (int format = 0; format < 3; format++)
        for (int reversed = 0; reversed < 2; reversed++) {
            shb_map_desc desc = plain_desc();
            desc.width = 700; /* rows longer than one batch */
            desc.format = (shb_format)format;
            desc.view = probe_orthographic(reversed);
            shb_map *map;
            CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
            for (size_t m = 0; m < count; m++) {
                const shb_bias bias = methods[m].make();
                float visibility[100];
                CHECK_INT(shb_map_visibility(map, &points, &bias, NULL, visibility), SHB_OK);
                for (int i = 0; i < 100; i++)
                    CHECK(visibility[i] == 1);
            }
            int32_t x[700], y[700];
            float depth[700];
            for (int i = 0; i < 700; i++) {
                x[i] = i;
                y[i] = 9;
            }
            shb_map_fetch(map, 700, x, y, depth);
            for (int i = 0; i < 700; i++)
                CHECK(depth[i] == (reversed ? 0.0f : 1.0f));
            shb_map_destroy(map);
        }
    close_context(&host);
}

static const float nowhere[200];

/* Both ways to make a map refuse the description with the result and a sentence that names field.
 */
static void refuse(setting *host, const shb_map_desc *desc, shb_result expected,
                   const char *field) {
    shb_map *const untouched = (shb_map *)(void *)host;
    shb_map *map = untouched;
    host->log.sentence[0] = 0;
    CHECK_INT(shb_map_create(host->context, desc, &map), expected);
    CHECK(strncmp(host->log.sentence, "shb_map_create: ", 16) == 0 &&
          strstr(host->log.sentence, field));
    CHECK(map == untouched);
    host->log.sentence[0] = 0;
    CHECK_INT(shb_map_wrap(host->context, desc, nowhere, 0, NULL, &map), expected);
    CHECK(strncmp(host->log.sentence, "shb_map_wrap: ", 14) == 0 &&
          strstr(host->log.sentence, field));
    CHECK(map == untouched);
}

TEST(maps_refuse_bad_descriptions) {
    setting host;
    open_context(&host);
    refuse(&host, NULL, SHB_ERROR_ARGUMENT, "desc");
    shb_map_desc desc = plain_desc();
    desc.width = 0;
    refuse(&host, &desc, SHB_ERROR_SIZE, "desc.width 0");
    desc.width = SHB_SIZE_MAX + 1;
    refuse(&host, &desc, SHB_ERROR_SIZE, "desc.width 16385");
    desc = plain_desc();
    desc.height = 0xffffffff;
    refuse(&host, &desc, SHB_ERROR_SIZE, "desc.height 4294967295");
    desc = plain_desc();
    desc.format = (shb_format)3;
    refuse(&host, &desc, SHB_ERROR_ARGUMENT, "desc.format 3");
    desc = plain_desc();
    desc.occluders = (shb_occluders)4;
    refuse(&host, &desc, SHB_ERROR_ARGUMENT, "desc.occluders 4");
    const double scales[] = {-1, nan(""), HUGE_VAL};
    for (int i = 0; i < 3; i++) {
        desc = plain_desc();
        desc.scene_scale = scales[i];
        refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.scene_scale");
    }
    desc = plain_desc();
    desc.view.clip_from_world.m[5] = nan("");
    refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view");
    desc.view.clip_from_world.m[5] = HUGE_VAL;
    refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view");
    desc.view.clip_from_world.m[5] = 0;
    refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view");
    desc.view = (shb_view){0};
    refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view");
    for (int reversed = 0; reversed < 2; reversed++) {
        desc.view = probe_perspective(reversed);
        desc.view.reversed = !reversed;
        refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view.reversed");
        /* The light at (3, 0, 4), the near plane askew: depth less x / w. */
        double *m = desc.view.clip_from_world.m;
        m[2] -= reversed ? -1 : 1;
        m[12] -= 3 * m[0];
        m[14] -= 3 * m[2];
        refuse(&host, &desc, SHB_ERROR_NUMBER, "desc.view.reversed");
    }
    CHECK_INT(shb_map_create(host.context, &desc, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_wrap(host.context, &desc, nowhere, 0, NULL, NULL), SHB_ERROR_ARGUMENT);
    shb_map *map = NULL;
    CHECK_INT(shb_map_create(NULL, &desc, &map), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_wrap(NULL, &desc, nowhere, 0, NULL, &map), SHB_ERROR_ARGUMENT);
    CHECK(!map);
    close_context(&host);
}

TEST(wrapping_refuses_bad_arrays) {
    setting host;
    open_context(&host);
    shb_map_desc desc = plain_desc();
    const char *bytes = (const char *)nowhere;
    const struct {
        shb_format format;
        const void *texels;
        size_t stride;
        shb_result expected;
        const char *field;
    } cases[] = {
        {SHB_FORMAT_FLOAT32, NULL, 0, SHB_ERROR_ARGUMENT, "texels is NULL"},
        {SHB_FORMAT_FLOAT32, bytes + 2, 0, SHB_ERROR_ARGUMENT, "texels"},
        {SHB_FORMAT_UNORM16, bytes + 1, 0, SHB_ERROR_ARGUMENT, "texels"},
        {SHB_FORMAT_UNORM24, bytes, 82, SHB_ERROR_ARGUMENT, "stride 82"},
        {SHB_FORMAT_UNORM16, bytes, 43, SHB_ERROR_ARGUMENT, "stride 43"},
        {SHB_FORMAT_FLOAT32, bytes, 76, SHB_ERROR_ARGUMENT, "stride 76"},
        {SHB_FORMAT_UNORM16, bytes, 38, SHB_ERROR_ARGUMENT, "stride 38"},
        {SHB_FORMAT_FLOAT32, bytes, SIZE_MAX - 3, SHB_ERROR_SIZE, "stride"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shb_map *map = NULL;
        desc.format = cases[i].format;
        CHECK_INT(shb_map_wrap(host.context, &desc, cases[i].texels, cases[i].stride, NULL, &map),
                  cases[i].expected);
        CHECK(!map);
        CHECK(strstr(host.log.sentence, cases[i].field));
    }
    close_context(&host);
}

TEST(a_wrapped_map_borrows_the_hosts_array) {
    setting host;
    open_context(&host);
    const shb_map_desc desc = plain_desc();
    float texels[10 * 21] = {0};
    shb_map *map;
    CHECK_INT(shb_map_wrap(host.context, &desc, texels, 84, NULL, &map), SHB_OK);
    const shb_depth_image depth = shb_map_get_depth(map);
    CHECK(depth.texels == texels && depth.stride == 84);
    CHECK_INT(shb_map_get_info(map)->memory_bytes, 840);
    const int32_t x = 19, y = 9;
    float seen;
    texels[9 * 21 + 19] = 0.375f;
    shb_map_fetch(map, 1, &x, &y, &seen);
    CHECK(seen == 0.375f);
    const shb_scene scene = {0};
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_ERROR_UNSUPPORTED);
    CHECK(texels[9 * 21 + 19] == 0.375f);
    shb_map_destroy(map);
    CHECK_INT(shb_map_wrap(host.context, &desc, texels, 0, NULL, &map), SHB_OK);
    CHECK_INT(shb_map_get_depth(map).stride, 80);
    shb_map_destroy(map);
    close_context(&host);
}

/* A plate over the upper rows of a map, which are the lower ones of an array from the bottom up. */
TEST(an_array_from_the_bottom_up_fits_a_view_whose_y_is_negated) {
    setting host;
    open_context(&host);
    shb_map_desc desc = plain_desc();
    float texels[10 * 20], upside_down[10 * 20], visibility[2][4];
    for (int i = 0; i < 10 * 20; i++) {
        texels[i] = i < 4 * 20 ? 0.25f : 1;
        upside_down[(9 - i / 20) * 20 + i % 20] = texels[i];
    }
    const float positions[] = {0, 0.9f, 0, 0, 0.3f, 0, 0, 0.1f, 0, 0, -0.9f, 0};
    const float normals[] = {0.6f, 0, 0.8f, 0.6f, 0, 0.8f, 0, 0.6f, 0.8f, 0, -0.6f, 0.8f};
    const shb_points points = {.count = 4, .positions = positions, .normals = normals};
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    for (int k = 0; k < 2; k++) {
        shb_map *map;
        CHECK_INT(shb_map_wrap(host.context, &desc, k ? upside_down : texels, 0, NULL, &map),
                  SHB_OK);
        CHECK(shb_map_get_info(map)->light.position.z == 1);
        CHECK_INT(shb_map_visibility(map, &points, &bias, NULL, visibility[k]), SHB_OK);
        shb_map_destroy(map);
        for (int column = 0; column < 4; column++)
            desc.view.clip_from_world.m[4 * column + 1] *= -1;
    }
    const float expected[4] = {0, 0, 1, 1};
    CHECK(memcmp(visibility[0], expected, sizeof expected) == 0);
    CHECK(memcmp(visibility[1], expected, sizeof expected) == 0);
    close_context(&host);
}

static double wrapped_scale(setting *host, shb_view view, double given) {
    const shb_map_desc desc = {.view = view, .width = 4, .scene_scale = given};
    shb_map *map;
    CHECK_INT(shb_map_wrap(host->context, &desc, nowhere, 0, NULL, &map), SHB_OK);
    const double scale = shb_map_get_info(map)->scene_scale;
    shb_map_destroy(map);
    return scale;
}

/* Orthographic: 2 by 2 by 8. Spot: the far end, 6 by 6, and 2 from near to far. At infinity: near
 * 0.25 and half depth at twice that, so 1 by 1 by 0.25. */
TEST(a_wrapped_map_has_the_scale_of_its_frustum) {
    setting host;
    open_context(&host);
    for (int reversed = 0; reversed < 2; reversed++) {
        CHECK_NEAR(wrapped_scale(&host, probe_orthographic(reversed), 0), sqrt(72), 1e-12);
        CHECK_NEAR(wrapped_scale(&host, probe_perspective(reversed), 0), sqrt(76), 1e-12);
        shb_view view;
        shb_view_perspective((shb_vec3){0, 0, 8}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                             1.5707963267948966, 1, 0.25, HUGE_VAL, reversed, &view);
        CHECK_NEAR(wrapped_scale(&host, view, 0), sqrt(2.0625), 1e-12);
        CHECK_NEAR(wrapped_scale(&host, view, 3), 3, 0);
    }
    close_context(&host);
}

static const float triangle[] = {-0.8f, -0.7f, 1, 0.9f, -0.5f, -1, 0.1f, 0.8f, 0.5f};
static const shb_mesh mesh = {.positions = triangle, .vertex_count = 3, .triangle_count = 1};
static const shb_instance instance = {.mesh = &mesh};
static const shb_scene scene = {&instance, 1};

TEST(drawing_without_a_combine_stage_stores_the_nearest_depth) {
    setting host;
    open_context(&host);
    for (int i = 0; i < 6; i++) {
        shb_map_desc desc = plain_desc();
        desc.format = (shb_format)(i / 2);
        desc.view = probe_orthographic(i & 1);
        shb_map *map;
        CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
        const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
        shb_draw_stats stats = {0};
        CHECK_INT(shb_map_draw(map, &scene, &bias, &stats), SHB_OK);
        CHECK_INT(stats.drawn, 1);
        uint32_t expected[200];
        const shb_draw_desc draw = {.view = &desc.view,
                                    .scene = &scene,
                                    .width = 20,
                                    .height = 10,
                                    .depth = {.texels = expected, .format = desc.format}};
        CHECK_INT(shb_draw(host.context, &draw, NULL), SHB_OK);
        const shb_depth_image depth = shb_map_get_depth(map);
        const size_t row_bytes = 20 * shb_format_size(desc.format);
        for (size_t row = 0; row < 10; row++)
            CHECK(memcmp((const char *)depth.texels + row * depth.stride,
                         (const char *)expected + row * row_bytes, row_bytes) == 0);
        shb_map_destroy(map);
    }
    close_context(&host);
}

/* The triangle's box is 1.7 by 1.5 by 2. */
TEST(a_drawn_map_has_the_scale_of_its_scene_unless_given) {
    setting host;
    open_context(&host);
    shb_map_desc desc = plain_desc();
    shb_map *map;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    CHECK_NEAR(shb_map_get_info(map)->scene_scale, sqrt(1.7 * 1.7 + 1.5 * 1.5 + 4), 1e-6);
    const shb_scene nothing = {0};
    CHECK_INT(shb_map_draw(map, &nothing, NULL, NULL), SHB_OK);
    CHECK_NEAR(shb_map_get_info(map)->scene_scale, 0, 0);
    shb_map_destroy(map);
    desc.scene_scale = 5;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    CHECK_NEAR(shb_map_get_info(map)->scene_scale, 5, 0);
    shb_map_destroy(map);
    close_context(&host);
}

/* The middle of the triangle is at z 0.17, so depth 0.48; the fragment below it at 0.75. */
static shb_result ask_below(const shb_map *map, const shb_bias *bias, float *visibility) {
    const float position[] = {0.07f, -0.1f, -2};
    const shb_points points = {.count = 1, .positions = position};
    return shb_map_visibility(map, &points, bias, NULL, visibility);
}

TEST(drawing_again_replaces_what_the_map_holds) {
    setting host;
    open_context(&host);
    const shb_map_desc desc = plain_desc();
    const shb_bias none = shb_bias_none(), dual = shb_bias_dual_layer(0.01f);
    const shb_bias wider = shb_bias_dual_layer(0.02f), midpoint = shb_bias_midpoint();
    shb_map *map;
    float visibility = -1;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, &dual, NULL), SHB_OK);
    CHECK_INT(ask_below(map, &dual, &visibility), SHB_OK);
    CHECK(visibility == 0);
    CHECK_INT(ask_below(map, &none, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(ask_below(map, &wider, &visibility), SHB_ERROR_UNSUPPORTED);
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    CHECK_INT(ask_below(map, &none, &visibility), SHB_OK);
    CHECK(visibility == 0);
    CHECK_INT(ask_below(map, &dual, &visibility), SHB_ERROR_UNSUPPORTED);
    /* nothing behind the triangle: half way to the far plane is 0.74 */
    CHECK_INT(shb_map_draw(map, &scene, &midpoint, NULL), SHB_OK);
    CHECK_INT(ask_below(map, &midpoint, &visibility), SHB_OK);
    CHECK(visibility == 0);
    const shb_scene nothing = {0};
    CHECK_INT(shb_map_draw(map, &nothing, NULL, NULL), SHB_OK);
    CHECK_INT(ask_below(map, &none, &visibility), SHB_OK);
    CHECK(visibility == 1);
    shb_map_destroy(map);
    close_context(&host);
}

TEST(a_failed_drawing_leaves_the_map_alone) {
    setting host;
    open_context(&host);
    const shb_map_desc desc = plain_desc();
    const shb_bias none = shb_bias_none(), midpoint = shb_bias_midpoint();
    shb_map *map;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    const double scale = shb_map_get_info(map)->scene_scale;

    shb_instance broken = instance;
    broken.world_from_mesh = shb_mat4_translation(nan(""), 0, 0);
    shb_mesh headless = mesh;
    headless.positions = NULL;
    const shb_instance second_broken[] = {instance, broken};
    const shb_instance third_broken[] = {instance, instance, {.mesh = &headless}};
    const struct {
        shb_scene scene;
        shb_result expected;
        const char *named;
    } bad[] = {{{second_broken, 2}, SHB_ERROR_NUMBER, "scene.instances[1]: world_from_mesh"},
               {{third_broken, 3}, SHB_ERROR_ARGUMENT, "scene.instances[2]: mesh.positions"},
               {{NULL, 1}, SHB_ERROR_ARGUMENT, "scene.instances is NULL"}};
    for (int i = 0; i < 3; i++) {
        CHECK_INT(shb_map_draw(map, &bad[i].scene, &midpoint, NULL), bad[i].expected);
        CHECK(strncmp(host.log.sentence, "shb_map_draw: ", 14) == 0);
        CHECK(strstr(host.log.sentence, bad[i].named));
    }
    const uint32_t wrong[] = {0, 1, 1000};
    shb_mesh astray = mesh; /* read where the scene's box is measured */
    astray.indices = wrong;
    astray.index_size = 4;
    astray.triangle_count = 1;
    const shb_instance no_vertex[] = {instance, {.mesh = &astray}};
    CHECK_INT(shb_map_draw(map, &(shb_scene){no_vertex, 2}, NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK(strstr(host.log.sentence, "scene.instances[1]: an index"));
    CHECK_INT(shb_map_draw(map, NULL, NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_draw(NULL, &scene, NULL, NULL), SHB_ERROR_ARGUMENT);

    CHECK_NEAR(shb_map_get_info(map)->scene_scale, scale, 0);
    float visibility = -1;
    CHECK_INT(ask_below(map, &none, &visibility), SHB_OK);
    CHECK(visibility == 0);
    shb_map_destroy(map);
    close_context(&host);
}

/* Fails the first, second, ... allocation until everything goes through. */
TEST(no_allocation_that_fails_is_fatal) {
    const shb_map_desc desc = plain_desc();
    const shb_bias none = shb_bias_none(), midpoint = shb_bias_midpoint();
    setting host;
    open_context(&host);
    int tries = 0;
    shb_map *map = NULL;
    shb_result result = SHB_ERROR_MEMORY;
    for (; result == SHB_ERROR_MEMORY && tries < 10; tries++) {
        const size_t live = host.memory.live;
        host.memory.fail_at = host.memory.calls + (size_t)tries + 1;
        result = shb_map_create(host.context, &desc, &map);
        CHECK(result == SHB_OK || (!map && host.memory.live == live));
    }
    CHECK_INT(result, SHB_OK);
    CHECK_INT(tries, 4); /* the map, its texels and what is known of them */
    host.memory.fail_at = 0;
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    result = SHB_ERROR_MEMORY;
    for (tries = 0; result == SHB_ERROR_MEMORY && tries < 100; tries++) {
        float visibility = -1;
        CHECK_INT(ask_below(map, &none, &visibility), SHB_OK);
        CHECK(visibility == 0);
        host.memory.fail_at = host.memory.calls + (size_t)tries + 1;
        result = shb_map_draw(map, &scene, &midpoint, NULL);
    }
    CHECK_INT(result, SHB_OK);
    CHECK(tries > 1); /* the second layer at least */
    const size_t calls = host.memory.calls;
    CHECK_INT(shb_map_draw(map, &scene, &midpoint, NULL), SHB_OK);
    CHECK_INT(host.memory.calls, calls); /* warm: nothing more is allocated */
    shb_map_destroy(map);

    host.memory.fail_at = host.memory.calls + 1;
    map = NULL;
    CHECK_INT(shb_map_wrap(host.context, &desc, nowhere, 0, NULL, &map), SHB_ERROR_MEMORY);
    CHECK(!map);
    close_context(&host);
}

TEST(asking_allocates_nothing) {
    setting host;
    open_context(&host);
    const shb_map_desc desc = plain_desc();
    shb_map *map;
    CHECK_INT(shb_map_create(host.context, &desc, &map), SHB_OK);
    const size_t calls = host.memory.calls;
    static float positions[3000], visibility[1000];
    const shb_points points = {.count = 1000, .positions = positions, .normals = positions};
    const shb_bias bias = shb_bias_adaptive(1e-4f, 1);
    CHECK_INT(shb_map_visibility(map, &points, &bias, NULL, visibility), SHB_OK);
    CHECK_INT(host.memory.calls, calls);
    shb_map_destroy(map);
    close_context(&host);
}
