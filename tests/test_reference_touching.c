/* Truth by ray casting where triangles touch: no ray leaves a closed mesh through an edge, no
 * surface shadows one that it touches. */
#include <math.h>

#include "random.h"
#include "ray_caster.h"
#include "soup.h"
#include "test.h"

/* ---- shared edges ---- */

/* Rays from inside a closed mesh towards each corner, a point of each edge and of each face. */
static int count_leaks(soup *s, const shb_reference *reference, shb_vec3 inside,
                       test_random *random) {
    int leaks = 0;
    for (uint32_t id = 0; id < s->count; id++) {
        shb_vec3 c[3];
        shb_scene_triangle(soup_scene(s), id, c);
        for (int k = 0; k < 3; k++) {
            const double t = random_double(random, 0, 1);
            const shb_vec3 edge = shb_vec3_subtract(c[(k + 1) % 3], c[k]);
            const shb_vec3 targets[3] = {
                c[k], shb_vec3_add(c[k], shb_vec3_scale(edge, t)),
                shb_vec3_add(c[k], shb_vec3_scale(shb_vec3_subtract(c[(k + 2) % 3], c[k]), t / 2))};
            for (int j = 0; j < 3; j++) {
                const shb_vec3 d = shb_vec3_subtract(targets[j], inside);
                leaks += !ray_caster_occluded(reference, light_along(d.x, d.y, d.z), inside,
                                              SHB_ID_NONE);
                const shb_vec3 far = shb_vec3_add(inside, shb_vec3_scale(d, 3));
                leaks += !ray_caster_occluded(reference, light_at(far.x, far.y, far.z), inside,
                                              SHB_ID_NONE);
            }
        }
    }
    return leaks;
}

TEST(no_ray_leaves_a_closed_integer_box) {
    /* Six faces of 8 x 8 squares of integer corners: most rays run through corners and edges. */
    soup s = {0};
    for (int face = 0; face < 6; face++)
        for (int i = -4; i < 4; i++)
            for (int j = -4; j < 4; j++) {
                float q[4][3];
                for (int k = 0; k < 4; k++) {
                    q[k][face % 3] = face < 3 ? -4 : 4;
                    q[k][(face + 1) % 3] = (float)(i + (k == 1 || k == 2));
                    q[k][(face + 2) % 3] = (float)(j + (k >= 2));
                }
                soup_add_quad(&s, q[0], q[1], q[2], q[3]);
            }
    ray_caster t = ray_caster_create(soup_scene(&s));
    int leaks = 0;
    for (int x = -3; x <= 3; x++)
        for (int y = -3; y <= 3; y++)
            for (int dx = -4; dx <= 4; dx++)
                for (int dy = -4; dy <= 4; dy++) {
                    const shb_vec3 inside = {x, y, 1};
                    leaks += !ray_caster_occluded(t.reference, light_along(dx, dy, 3), inside,
                                                  SHB_ID_NONE);
                    leaks += !ray_caster_occluded(t.reference, light_along(dy, 3, dx), inside,
                                                  SHB_ID_NONE);
                    leaks += !ray_caster_occluded(t.reference, light_along(-4, dx, dy), inside,
                                                  SHB_ID_NONE);
                }
    CHECK_INT(leaks, 0);
    test_random random = {4};
    CHECK_INT(count_leaks(&s, t.reference, (shb_vec3){0, 0, 0}, &random), 0);
    CHECK_INT(count_leaks(&s, t.reference, (shb_vec3){1, 3, -2}, &random), 0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

TEST(no_ray_leaves_a_closed_ball_of_spikes_and_needles) {
    /* Radii from 0.01 to 100 make a star-shaped ball of needles; its centre is inside. */
    test_random random = {5};
    for (int round = 0; round < 6; round++) {
        enum { COLUMNS = 24, ROWS = 12, VERTICES = COLUMNS * (ROWS - 1) + 2 };
        double radii[VERTICES];
        for (int i = 0; i < VERTICES; i++)
            radii[i] = round ? pow(10, random_double(&random, -2, 2)) : 1;
        soup s = {0};
        soup_add_ball(&s, (float[3]){0, 0, 0}, COLUMNS, ROWS, radii);
        s.transform = shb_mat4_multiply(
            shb_mat4_translation(random_double(&random, -1e3, 1e3), round * 1e5, 7),
            shb_mat4_rotation((shb_vec3){1, 1, 2}, random_double(&random, 0, 6)));
        const shb_vec3 inside = shb_mat4_transform_point(s.transform, (shb_vec3){0, 0, 0});
        ray_caster t = ray_caster_create(soup_scene(&s));
        CHECK_INT(count_leaks(&s, t.reference, inside, &random), 0);
        ray_caster_destroy(&t);
        soup_free(&s);
    }
}

TEST(a_ray_hits_the_corner_of_a_needle_whose_plane_is_lost_in_rounding) {
    /* The corners become (0, 0, 1), (1, 1, 1) and (2, 2 + 2^-50, 1): the normal, 2^-50, is less
     * than the rounding of its two products of size 2, yet everything lies 1 above the origin. */
    soup s = {0};
    soup_add(&s, (float[3]){0, 0, 1}, (float[3]){1, 0, 1}, (float[3]){2, 1, 1});
    s.transform = shb_mat4_identity();
    s.transform.m[1] = 1;
    s.transform.m[5] = 0x1p-50;
    ray_caster t = ray_caster_create(soup_scene(&s));
    CHECK_INT(
        ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 0}, SHB_ID_NONE),
        1);
    CHECK_INT(
        ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 1}, SHB_ID_NONE),
        0);
    CHECK_INT(
        ray_caster_occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 2}, SHB_ID_NONE),
        0);
    ray_caster_destroy(&t);
    soup_free(&s);
}

/* ---- touching surfaces ---- */

/* The ground is the square -1 .. 1 in a plane, cut along its diagonal. */
static void add_ground(soup *s) {
    soup_add_quad(s, (float[3]){-1, -1, 0}, (float[3]){1, -1, 0}, (float[3]){1, 1, 0},
                  (float[3]){-1, 1, 0});
}

static shb_mat4 random_place(test_random *random, double scale, double offset) {
    const shb_vec3 move = random_point(random, offset);
    return shb_mat4_multiply(
        shb_mat4_translation(move.x, move.y, move.z),
        shb_mat4_multiply(shb_mat4_scaling(scale, scale, scale),
                          shb_mat4_rotation(random_point(random, 1), random_double(random, 0, 6))));
}

/* A direction that meets the transformed plane z = 0 from above at a random cosine. */
static shb_light_source light_above(test_random *random, const shb_mat4 *place) {
    const double angle = random_double(random, 0, 6.3);
    const double height = pow(10, random_double(random, -2.5, 0.5));
    const double *m = place->m;
    const double x = cos(angle), y = sin(angle);
    return light_along(m[0] * x + m[4] * y + m[8] * height, m[1] * x + m[5] * y + m[9] * height,
                       m[2] * x + m[6] * y + m[10] * height);
}

/* A point of a triangle, computed as drawing computes it. */
static shb_vec3 point_of(const shb_vec3 c[3], double w1, double w2) {
    const shb_vec3 e = shb_vec3_subtract(c[1], c[0]), f = shb_vec3_subtract(c[2], c[0]);
    return shb_vec3_add(c[0], shb_vec3_add(shb_vec3_scale(e, w1), shb_vec3_scale(f, w2)));
}

TEST(a_coplanar_neighbour_does_not_shadow_the_shared_edge) {
    test_random random = {6};
    int shadowed = 0;
    for (int round = 0; round < 300; round++) {
        soup s = {0};
        add_ground(&s);
        const double scale = pow(10, random_double(&random, -4, 6));
        s.transform = random_place(&random, scale, round % 3 ? scale * 1e4 * (round % 3 - 1) : 0);
        ray_caster t = ray_caster_create(soup_scene(&s));
        for (int k = 0; k < 40; k++) {
            const uint32_t own = k & 1;
            shb_vec3 corners[3];
            shb_scene_triangle(soup_scene(&s), own, corners);
            const double w = random_double(&random, 0, 1);
            const shb_vec3 point = own ? point_of(corners, w, 0) : point_of(corners, 0, w);
            shadowed +=
                ray_caster_occluded(t.reference, light_above(&random, &s.transform), point, own);
        }
        ray_caster_destroy(&t);
        soup_free(&s);
    }
    CHECK_INT(shadowed, 0);
}

TEST(a_coplanar_sheet_or_duplicate_does_not_shadow) {
    /* A small sheet lies in the plane of a large square, and everything is there twice. */
    test_random random = {7};
    int shadowed = 0;
    for (int round = 0; round < 200; round++) {
        soup s = {0};
        add_ground(&s);
        for (int i = 0; i < 2; i++)
            soup_add_quad(&s, (float[3]){0.125f, 0.25f, 0}, (float[3]){0.25f, 0.25f, 0},
                          (float[3]){0.25f, 0.375f, 0}, (float[3]){0.125f, 0.375f, 0});
        add_ground(&s);
        s.transform = random_place(&random, pow(10, random_double(&random, -4, 6)), 0);
        ray_caster t = ray_caster_create(soup_scene(&s));
        for (int k = 0; k < 40; k++) {
            const uint32_t own = random_below(&random, s.count);
            shb_vec3 corners[3];
            shb_scene_triangle(soup_scene(&s), own, corners);
            const double w = random_double(&random, 0, 1);
            const shb_vec3 point = point_of(corners, w, random_double(&random, 0, 1 - w));
            shadowed +=
                ray_caster_occluded(t.reference, light_above(&random, &s.transform), point, own);
        }
        ray_caster_destroy(&t);
        soup_free(&s);
    }
    CHECK_INT(shadowed, 0);
}

TEST(a_coplanar_needle_does_not_shadow_the_shared_edge) {
    /* The normals of needles are mostly rounding. */
    test_random random = {12};
    int shadowed = 0;
    for (int round = 0; round < 1000; round++) {
        float p[4][3] = {{0}};
        for (int i = 0; i < 2; i++) {
            p[0][i] = (float)random_double(&random, -1, 1);
            p[1][i] = (float)random_double(&random, -1, 1);
            p[2][i] = (float)random_double(&random, -1, 1);
        }
        const float t = (float)random_double(&random, -1, 2);
        for (int i = 0; i < 2; i++)
            p[3][i] = p[0][i] + t * (p[1][i] - p[0][i]);
        soup s = {0};
        soup_add(&s, p[0], p[1], p[2]);
        soup_add(&s, p[0], p[1], p[3]);
        s.transform = random_place(&random, 1, 0);
        ray_caster u = ray_caster_create(soup_scene(&s));
        shb_vec3 corners[3];
        shb_scene_triangle(soup_scene(&s), 0, corners);
        for (int k = 0; k < 10; k++) {
            const shb_vec3 point = point_of(corners, random_double(&random, 0, 1), 0);
            shadowed +=
                ray_caster_occluded(u.reference, light_above(&random, &s.transform), point, 0);
        }
        ray_caster_destroy(&u);
        soup_free(&s);
    }
    CHECK_INT(shadowed, 0);
}

TEST(a_tiny_coplanar_sheet_does_not_shadow_a_large_triangle) {
    /* The rounding of the points is that of the large triangle's corners. */
    test_random random = {13};
    int shadowed = 0;
    for (int round = 0; round < 200; round++) {
        soup s = {0};
        soup_add(&s, (float[3]){-1000, -900, 0}, (float[3]){1100, -1000, 0},
                 (float[3]){-80, 950, 0});
        soup_add_quad(&s, (float[3]){-0.001f, -0.001f, 0}, (float[3]){0.001f, -0.001f, 0},
                      (float[3]){0.001f, 0.001f, 0}, (float[3]){-0.001f, 0.001f, 0});
        s.transform = random_place(&random, 1, 0);
        ray_caster t = ray_caster_create(soup_scene(&s));
        shb_vec3 corners[3];
        shb_scene_triangle(soup_scene(&s), 0, corners);
        for (int k = 0; k < 40; k++) {
            /* weights of a point close to 0: solve for them in the plane */
            const double x = random_double(&random, -0.0009, 0.0009) + 1000, y = 900;
            const double area = 2100.0 * 1850 + 100.0 * 920;
            const shb_vec3 point =
                point_of(corners, (x * 1850 - y * 920) / area, (2100 * y + 100 * x) / area);
            shadowed +=
                ray_caster_occluded(t.reference, light_above(&random, &s.transform), point, 0);
        }
        ray_caster_destroy(&t);
        soup_free(&s);
    }
    CHECK_INT(shadowed, 0);
}

TEST(a_gap_of_a_trillionth_still_shadows) {
    test_random random = {8};
    for (int round = 0; round < 100; round++) {
        soup ground = {0}, sheet = {0};
        add_ground(&ground);
        soup_add(&sheet, (float[3]){-3, -3, 0}, (float[3]){3, -3, 0}, (float[3]){0, 6, 0});
        const double scale = pow(10, random_double(&random, -4, 6));
        const shb_mat4 place = random_place(&random, scale, 0);
        soup_scene(&ground);
        soup_scene(&sheet);
        const shb_instance instances[2] = {
            {.mesh = &ground.mesh, .world_from_mesh = place},
            {.mesh = &sheet.mesh,
             .world_from_mesh = shb_mat4_multiply(place, shb_mat4_translation(0, 0, 1e-12))}};
        const shb_scene scene = {instances, 2};
        ray_caster t = ray_caster_create(&scene);
        shb_vec3 corners[3];
        shb_scene_triangle(&scene, 0, corners);
        const shb_vec3 point = point_of(corners, 0.375, 0.25);
        const double *m = place.m;
        CHECK_INT(ray_caster_occluded(t.reference, light_along(m[8], m[9], m[10]), point, 0), 1);
        CHECK_INT(ray_caster_occluded(t.reference, light_along(-m[8], -m[9], -m[10]), point, 0), 0);
        ray_caster_destroy(&t);
        soup_free(&ground);
        soup_free(&sheet);
    }
}
