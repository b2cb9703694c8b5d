#include "contexts.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

/* One hash for every compiler, level of optimisation, processor and number of threads. The numbers
 * say nothing about what is right: other tests do; these say that nothing changes. A change of
 * meaning changes them on purpose. */

enum { SIZE = 320, POINTS = 3000, TRIANGLES = 3000 };

/* FNV-1a. */
static uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count) {
    const uint8_t *byte = bytes;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ byte[i]) * 0x100000001b3u;
    return hash;
}

static const uint64_t hash_start = 0xcbf29ce484222325u;

/* Triangles from some hundredths of a texel to half of the view. */
static void make_soup(float *positions) {
    test_random random = {20};
    for (int t = 0; t < TRIANGLES; t++) {
        const double size = t % 100 == 0 ? 1.0 : t % 10 == 0 ? 0.1 : 0.01;
        double centre[3];
        for (int axis = 0; axis < 3; axis++)
            centre[axis] = random_double(&random, -1, 1);
        for (int i = 0; i < 9; i++)
            positions[9 * t + i] = (float)(centre[i % 3] + random_double(&random, -size, size));
    }
}

static uint64_t hash_drawing(shb_context *context, const shb_scene *scene, const shb_view *view) {
    float *depth = malloc(SIZE * SIZE * 4), *second = malloc(SIZE * SIZE * 4);
    uint32_t *ids = malloc(SIZE * SIZE * 4);
    const shb_draw_desc desc = {.view = view,
                                .scene = scene,
                                .width = SIZE,
                                .height = SIZE,
                                .depth = {.texels = depth},
                                .second = {.texels = second},
                                .ids = ids};
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    uint64_t hash = hash_bytes(hash_start, depth, SIZE * SIZE * 4);
    hash = hash_bytes(hash, second, SIZE * SIZE * 4);
    hash = hash_bytes(hash, ids, SIZE * SIZE * 4);
    free(depth);
    free(second);
    free(ids);
    return hash;
}

/* Every built-in method that needs no more than a map of nearest or combined depths. */
static uint64_t hash_visibility(shb_context *context, const shb_scene *scene,
                                const shb_view *view) {
    static float positions[POINTS * 3], normals[POINTS * 3], visibility[POINTS];
    test_random random = {21};
    for (int i = 0; i < POINTS * 3; i++) {
        positions[i] = (float)random_double(&random, -1, 1);
        normals[i] = (float)random_double(&random, -0.57, 0.57);
    }
    const char *names[] = {"none",           "constant",   "slope",    "angle",
                           "normal-offset",  "texel-cone", "midpoint", "dual-layer",
                           "receiver-plane", "back-face",  "adaptive", "adaptive-soft"};
    const shb_points points = {.count = POINTS, .positions = positions, .normals = normals};
    const shb_map_desc desc = {.view = *view, .width = SIZE};
    uint64_t hash = hash_start;
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        shb_map *map = NULL;
        shb_bias bias;
        CHECK_INT(shb_bias_parse(names[k], &bias), SHB_OK);
        CHECK_INT(shb_map_create(context, &desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, scene, &bias, NULL), SHB_OK);
        CHECK_INT(shb_map_visibility(map, &points, &bias, NULL, visibility), SHB_OK);
        hash = hash_bytes(hash, visibility, sizeof visibility);
        shb_map_destroy(map);
    }
    return hash;
}

static void check_hashes(shb_view view, uint64_t drawing, uint64_t visibility) {
    static float positions[TRIANGLES * 9];
    make_soup(positions);
    const shb_mesh mesh = {
        .positions = positions, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    const shb_instance instances[2] = {
        {.mesh = &mesh},
        {.mesh = &mesh,
         .cull = SHB_CULL_BACK,
         .world_from_mesh = shb_mat4_rotation((shb_vec3){1, 2, 3}, 0.7)}};
    const shb_scene scene = {instances, 2};
    const shb_isa sets[] = {SHB_ISA_BEST, SHB_ISA_SCALAR, SHB_ISA_SSE2};
    for (uint32_t i = 0; i < 3; i++) {
        shb_context *context = test_context(i + 1, sets[i]);
        const uint64_t drawn = hash_drawing(context, &scene, &view);
        const uint64_t seen = hash_visibility(context, &scene, &view);
        test_check(drawn == drawing, __FILE__, __LINE__, "drawing hashes to 0x%llx",
                   (unsigned long long)drawn);
        test_check(seen == visibility, __FILE__, __LINE__, "visibility hashes to 0x%llx",
                   (unsigned long long)seen);
        shb_context_destroy(context);
    }
}

TEST(an_orthographic_light_gives_the_same_bits_everywhere) {
    shb_view view = {0};
    CHECK_INT(shb_view_orthographic((shb_vec3){2, 3, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    1.5, 1.5, 0.5, 9, false, &view),
              SHB_OK);
    check_hashes(view, 0x38e0cd6b657d9b33u, 0x76008d3e4bc8b9d5u);
}

TEST(a_reversed_perspective_light_gives_the_same_bits_everywhere) {
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){1.5, 0.9, 0.2}, (shb_vec3){0, 0, 0},
                                   (shb_vec3){0, 1, 0}, 1.2, 1, 0.01, HUGE_VAL, true, &view),
              SHB_OK);
    check_hashes(view, 0x6415e7b84909216bu, 0x9914397a6ca3a7f5u);
}
