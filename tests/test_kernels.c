#include "contexts.h"
#include "isas.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Every instruction set has to give the very bits of the scalar code. */

typedef struct picture {
    float *depth, *second;
    uint32_t *ids;
    uint16_t *unorm16;
    shb_draw_stats stats;
} picture;

typedef struct scene_case {
    shb_scene scene;
    shb_view view;
    uint32_t width, height;
} scene_case;

static picture draw_picture(const scene_case *drawn, shb_isa isa, uint32_t threads,
                            uint32_t tile_size) {
    shb_context *context = test_context(threads, isa);
    const size_t count = (size_t)drawn->width * drawn->height;
    picture made = {
        malloc(count * 4), malloc(count * 4), malloc(count * 4), malloc(count * 2), {0}};
    shb_draw_desc desc = {.view = &drawn->view,
                          .scene = &drawn->scene,
                          .width = drawn->width,
                          .height = drawn->height,
                          .depth = {.texels = made.depth},
                          .tile_size = tile_size};
    CHECK_INT(shb_draw(context, &desc, &made.stats), SHB_OK);
    float *depth_alone = malloc(count * 4);
    memcpy(depth_alone, made.depth, count * 4);
    desc.second.texels = made.second;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(memcmp(depth_alone, made.depth, count * 4) == 0);
    desc.ids = made.ids;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(memcmp(depth_alone, made.depth, count * 4) == 0);
    desc.second.texels = NULL;
    uint32_t *ids_alone = malloc(count * 4);
    desc.ids = ids_alone;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(memcmp(ids_alone, made.ids, count * 4) == 0);
    memset(ids_alone, 0, count * 4);
    desc.depth.texels = NULL;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(memcmp(ids_alone, made.ids, count * 4) == 0);
    desc.ids = NULL;
    desc.second.texels = depth_alone;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(memcmp(depth_alone, made.second, count * 4) == 0);
    desc.second.texels = NULL;
    desc.depth = (shb_depth_image){made.unorm16, 0, SHB_FORMAT_UNORM16};
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    free(depth_alone);
    free(ids_alone);
    shb_context_destroy(context);
    return made;
}

static void free_picture(picture *freed) {
    free(freed->depth);
    free(freed->second);
    free(freed->ids);
    free(freed->unorm16);
}

static void check_same(const scene_case *drawn, const picture *a, const picture *b) {
    const size_t count = (size_t)drawn->width * drawn->height;
    CHECK(memcmp(a->depth, b->depth, count * 4) == 0);
    CHECK(memcmp(a->second, b->second, count * 4) == 0);
    CHECK(memcmp(a->ids, b->ids, count * 4) == 0);
    CHECK(memcmp(a->unorm16, b->unorm16, count * 2) == 0);
    CHECK(memcmp(&a->stats, &b->stats, sizeof a->stats) == 0);
}

/* The same scene of meshes with clusters. */
typedef struct clustered_case {
    scene_case drawn;
    shb_context *context;
    shb_mesh meshes[2];
    shb_instance instances[2];
    shb_clusters *clusters[2];
} clustered_case;

static void add_clusters(const scene_case *drawn, clustered_case *made) {
    *made = (clustered_case){.drawn = *drawn};
    made->context = test_context(0, SHB_ISA_BEST);
    for (size_t i = 0; i < drawn->scene.instance_count; i++) {
        made->instances[i] = drawn->scene.instances[i];
        made->meshes[i] = *made->instances[i].mesh;
        CHECK_INT(shb_clusters_create(made->context, &made->meshes[i], &made->clusters[i]), SHB_OK);
        made->meshes[i].clusters = made->clusters[i];
        made->instances[i].mesh = &made->meshes[i];
    }
    made->drawn.scene.instances = made->instances;
}

static void free_clusters(clustered_case *made) {
    for (size_t i = 0; i < 2; i++)
        shb_clusters_destroy(made->clusters[i]);
    shb_context_destroy(made->context);
}

static void check_all_agree(const scene_case *drawn) {
    clustered_case clustered;
    add_clusters(drawn, &clustered);
    picture reference = draw_picture(drawn, SHB_ISA_SCALAR, 2, 64);
    const struct { uint32_t threads, tile_size; } ways[] = {{1, 0}, {2, 0}, {3, 64}, {1, 16}};
    for (shb_isa isa = test_isa_after(SHB_ISA_SCALAR); isa < SHB_ISA_COUNT;
         isa = test_isa_after(isa))
        for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
            picture other = draw_picture(drawn, isa, ways[k].threads, ways[k].tile_size);
            check_same(drawn, &reference, &other);
            free_picture(&other);
            other = draw_picture(&clustered.drawn, isa, ways[k].threads, ways[k].tile_size);
            check_same(drawn, &reference, &other);
            free_picture(&other);
        }
    free_picture(&reference);
    free_clusters(&clustered);
}

/* A soup of triangles around the origin: each corner lies within size of the triangle's centre. */
static shb_mesh random_soup(test_random *random, uint32_t triangles, double spread, double size) {
    float *positions = malloc(triangles * 9 * sizeof *positions);
    for (uint32_t t = 0; t < triangles; t++) {
        double centre[3];
        for (int axis = 0; axis < 3; axis++)
            centre[axis] = random_double(random, -spread, spread);
        for (int i = 0; i < 9; i++)
            positions[9 * t + (uint32_t)i] =
                (float)(centre[i % 3] + random_double(random, -size, size));
    }
    return (shb_mesh){
        .positions = positions, .vertex_count = 3 * triangles, .triangle_count = triangles};
}

static void check_soup(shb_view view, uint32_t width, uint32_t height, double size,
                       uint32_t triangles, uint64_t seed) {
    test_random random = {seed};
    const shb_mesh mesh = random_soup(&random, triangles, 1.0, size);
    const shb_instance instances[2] = {
        {.mesh = &mesh},
        {.mesh = &mesh,
         .cull = SHB_CULL_BACK,
         .world_from_mesh = shb_mat4_rotation((shb_vec3){1, 2, 3}, 0.7)},
    };
    check_all_agree(&(scene_case){{instances, 2}, view, width, height});
    free((void *)(uintptr_t)mesh.positions);
}

static shb_view orthographic(bool reversed) {
    shb_view view = {0};
    CHECK_INT(shb_view_orthographic((shb_vec3){2, 3, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    1.5, 1.5, 0.5, 9, reversed, &view),
              SHB_OK);
    return view;
}

static shb_view perspective(double distance, double far_distance, bool reversed) {
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){distance, 0.1, 0.2}, (shb_vec3){0, 0, 0},
                                   (shb_vec3){0, 1, 0}, 1.2, 1.25, 0.01, far_distance, reversed,
                                   &view),
              SHB_OK);
    return view;
}

TEST(kernels_draw_tiny_triangles_like_the_scalar_code) {
    check_soup(orthographic(false), 192, 192, 0.012, 6000, 1);
    check_soup(orthographic(true), 250, 131, 0.012, 2000, 2);
}

TEST(kernels_draw_triangles_of_some_texels_like_the_scalar_code) {
    check_soup(orthographic(false), 192, 192, 0.1, 1500, 3);
    check_soup(perspective(3, 100, true), 320, 200, 0.1, 1500, 4);
}

TEST(kernels_draw_large_triangles_like_the_scalar_code) {
    check_soup(orthographic(false), 512, 512, 1.5, 30, 5);
    check_soup(perspective(3, HUGE_VAL, false), 333, 257, 1.0, 60, 6);
}

TEST(kernels_draw_around_the_eye_like_the_scalar_code) {
    check_soup(perspective(0.2, HUGE_VAL, true), 256, 192, 0.5, 500, 7);
    check_soup(perspective(0.3, 10, false), 176, 144, 3.0, 200, 8);
}

/* Needles, points, duplicates, far vertices, NaN: what meshes should not hold. */
TEST(kernels_draw_nasty_triangles_like_the_scalar_code) {
    test_random random = {9};
    shb_mesh mesh = random_soup(&random, 600, 1.0, 0.2);
    float *p = (float *)(uintptr_t)mesh.positions;
    for (uint32_t t = 0; t < 600; t++, p += 9)
        switch (t % 10) {
        case 0: /* almost a line */
            for (int i = 0; i < 3; i++)
                p[6 + i] = p[i] + (p[3 + i] - p[i]) * 0.37f + 1e-7f * (float)i;
            break;
        case 1: /* a line */
            memcpy(p + 6, p, 3 * sizeof *p);
            break;
        case 2: /* a duplicate of the triangle before, turned round */
            memcpy(p, p - 6, 3 * sizeof *p);
            memcpy(p + 3, p - 9, 3 * sizeof *p);
            memcpy(p + 6, p - 3, 3 * sizeof *p);
            break;
        case 3:
            p[random_below(&random, 9)] = NAN;
            break;
        case 4:
            p[random_below(&random, 9)] = (float)HUGE_VAL;
            break;
        case 5:
            p[random_below(&random, 9)] = 1e30f;
            break;
        case 6:
            p[random_below(&random, 9)] = -40000.0f;
            break;
        default:
            break;
        }
    const shb_instance instance = {.mesh = &mesh};
    check_all_agree(&(scene_case){{&instance, 1}, orthographic(false), 192, 192});
    check_all_agree(&(scene_case){{&instance, 1}, perspective(2, 50, true), 192, 160});
    free((void *)(uintptr_t)mesh.positions);
}

TEST(kernels_read_16_bit_indices_and_strides_like_the_scalar_code) {
    test_random random = {11};
    enum { VERTICES = 500, TRIANGLES = 777 };
    float positions[VERTICES * 5];
    uint16_t indices[TRIANGLES * 3];
    for (int i = 0; i < VERTICES * 5; i++)
        positions[i] = (float)random_double(&random, -1, 1);
    for (int i = 0; i < TRIANGLES * 3; i++)
        indices[i] = (uint16_t)random_below(&random, VERTICES);
    const shb_mesh mesh = {.positions = positions,
                           .position_stride = 20,
                           .vertex_count = VERTICES,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = TRIANGLES};
    const shb_instance instance = {.mesh = &mesh, .cull = SHB_CULL_FRONT};
    check_all_agree(&(scene_case){{&instance, 1}, orthographic(false), 128, 128});
}

/* A triangle with its corners on the plane of that height, seen from above by `down`. */
static void set_level(float *p, float height, const float corners[6]) {
    for (int i = 0; i < 3; i++) {
        p[3 * i] = corners[2 * i];
        p[3 * i + 1] = corners[2 * i + 1];
        p[3 * i + 2] = height;
    }
}

/* Two units are the target's width and height. */
static shb_view looking_down(bool reversed) {
    shb_view view = {0};
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 5}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    1, 1, 1, 9, reversed, &view),
              SHB_OK);
    return view;
}

/* Triangles over most of the target, one behind or before the other, some at equal heights: what
 * hides whole cells of those that come later, in any order. */
TEST(kernels_leave_out_what_lies_behind_like_the_scalar_code) {
    enum { TRIANGLES = 60 };
    float positions[TRIANGLES * 9];
    test_random random = {12};
    for (int order = 0; order < 3; order++)
        for (int reversed = 0; reversed < 2; reversed++) {
            for (int t = 0; t < TRIANGLES; t++) {
                const float heights[3] = {(float)t * 0.05f, (float)-t * 0.05f,
                                          (float)random_below(&random, 4) * 0.5f};
                float corners[6];
                for (int i = 0; i < 6; i++)
                    corners[i] = (float)random_double(&random, -3, 3);
                set_level(positions + 9 * t, heights[order], corners);
                if (t % 3 == 0)
                    positions[9 * t + 2] += 0.3f;
            }
            const shb_mesh mesh = {
                .positions = positions, .vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
            const shb_instance instance = {.mesh = &mesh};
            check_all_agree(&(scene_case){{&instance, 1}, looking_down(reversed), 208, 176});
            check_all_agree(&(scene_case){{&instance, 1}, looking_down(reversed), 75, 330});
            if (order == 2)
                check_all_agree(&(scene_case){{&instance, 1}, looking_down(reversed), 576, 528});
        }
}

/* Triangle 0 is a strip across the target that ends 75 targets away: so thin for its box that its
 * depth is evaluated in double, which the kernels do after the triangles in float. Triangle 1
 * covers the target at the same height. Where both lie the lower id is to be seen. */
TEST(kernels_keep_the_lower_id_where_a_bound_of_depth_is_met) {
    float positions[2 * 9];
    set_level(positions, 0, (const float[6]){-75, -75, 75, 74.5f, 74.5f, 75});
    set_level(positions + 9, 0, (const float[6]){-3, -3, 9, -3, -3, 9});
    const shb_mesh mesh = {.positions = positions, .vertex_count = 6, .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const scene_case drawn = {{&instance, 1}, looking_down(false), 208, 208};
    check_all_agree(&drawn);
    picture made = draw_picture(&drawn, SHB_ISA_BEST, 1, 0);
    for (int i = 0; i < 208; i++)
        CHECK_INT(made.ids[i * 208 + (207 - i)], 0);
    CHECK_INT(made.ids[0], 1);
    free_picture(&made);
}
