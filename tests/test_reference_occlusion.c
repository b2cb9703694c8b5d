/* Truth by ray casting: against exact integer arithmetic and a slow independent intersection, and
 * the promises about shared edges, touching surfaces, own triangles and lights. */
#include "shadowbias/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "random.h"
#include "soup.h"
#include "test.h"

typedef struct setup {
    shb_context *context;
    shb_reference *reference;
} setup;

static setup setup_for(const shb_scene *scene) {
    setup s = {0};
    CHECK_INT(shb_context_create(NULL, &s.context), SHB_OK);
    CHECK_INT(shb_reference_create(s.context, scene, &s.reference), SHB_OK);
    return s;
}

static void setup_end(setup *s) {
    shb_reference_destroy(s->reference);
    shb_context_destroy(s->context);
}

static shb_light_source light_at(double x, double y, double z) {
    return (shb_light_source){{x, y, z}, 1};
}

static shb_light_source light_along(double x, double y, double z) {
    return (shb_light_source){{x, y, z}, 0};
}

static int occluded(const shb_reference *reference, shb_light_source light, shb_vec3 point,
                    uint32_t own_id) {
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(reference, &light, 1, &point, &own_id, &result), SHB_OK);
    return result;
}

static shb_vec3 random_point(test_random *random, double half) {
    return (shb_vec3){random_double(random, -half, half), random_double(random, -half, half),
                      random_double(random, -half, half)};
}

/* ---- exact arithmetic on integers ---- */

typedef struct lattice {
    int64_t x, y, z;
} lattice;

static lattice minus(lattice a, lattice b) {
    return (lattice){a.x - b.x, a.y - b.y, a.z - b.z};
}

static lattice cross(lattice a, lattice b) {
    return (lattice){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static int64_t dot(lattice a, lattice b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Coordinates below 2^7 keep every product below 2^30. A ray in the triangle's plane misses it. */
static bool exactly_blocks(const lattice corners[3], lattice origin, lattice direction,
                           bool has_end) {
    const lattice a = minus(corners[0], origin), b = minus(corners[1], origin),
                  c = minus(corners[2], origin);
    const int64_t u = dot(direction, cross(b, c)), v = dot(direction, cross(c, a)),
                  w = dot(direction, cross(a, b));
    const bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    if (!inside || (u == 0 && v == 0 && w == 0))
        return false;
    const lattice normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
    const int64_t slope = dot(normal, direction);
    const int64_t distance = dot(normal, a) * (slope < 0 ? -1 : 1);
    return distance > 0 && (!has_end || distance < llabs(slope));
}

static lattice random_lattice(test_random *random, int size) {
    const uint32_t range = (uint32_t)(2 * size + 1);
    return (lattice){(int)random_below(random, range) - size,
                     (int)random_below(random, range) - size,
                     (int)random_below(random, range) - size};
}

static shb_vec3 to_double(lattice p) {
    return (shb_vec3){(double)p.x, (double)p.y, (double)p.z};
}

static void to_float(lattice p, float out[3]) {
    out[0] = (float)p.x;
    out[1] = (float)p.y;
    out[2] = (float)p.z;
}

/* Directions whose largest component is a power of two shear without rounding, so that rays through
 * edges and corners of this coarse grid must be decided as the integers say. */
static lattice power_of_two_direction(test_random *random) {
    lattice d = random_lattice(random, 4);
    int64_t *parts[3] = {&d.x, &d.y, &d.z};
    *parts[random_below(random, 3)] = random_below(random, 2) ? 4 : -4;
    return d;
}

static void check_grid_scene(test_random *random, int size, uint32_t triangles) {
    soup s = {0};
    lattice(*corners)[3] = malloc(triangles * sizeof *corners);
    for (uint32_t i = 0; i < triangles; i++) {
        float f[3][3];
        for (int k = 0; k < 3; k++) {
            corners[i][k] = random_lattice(random, size);
            to_float(corners[i][k], f[k]);
        }
        soup_add(&s, f[0], f[1], f[2]);
    }
    setup t = setup_for(soup_scene(&s));
    int wrong = 0, hits = 0;
    for (int ray = 0; ray < 4000; ray++) {
        const lattice origin = random_lattice(random, size);
        const lattice direction = power_of_two_direction(random);
        const bool has_end = ray & 1;
        const uint32_t own = random_below(random, triangles);
        bool expected = false;
        for (uint32_t i = 0; i < triangles && !expected; i++)
            expected = i != own && exactly_blocks(corners[i], origin, direction, has_end);
        const shb_vec3 from = to_double(origin), way = to_double(direction);
        const shb_vec3 end = shb_vec3_add(from, way);
        const shb_light_source light =
            has_end ? light_at(end.x, end.y, end.z) : light_along(way.x, way.y, way.z);
        wrong += occluded(t.reference, light, from, own) != expected;
        hits += expected;
    }
    CHECK_INT(wrong, 0);
    CHECK(hits > 40 && hits < 3600);
    setup_end(&t);
    soup_free(&s);
    free(corners);
}

TEST(occlusion_on_a_grid_equals_integer_arithmetic) {
    test_random random = {1};
    for (int scene = 0; scene < 12; scene++) {
        check_grid_scene(&random, 3, 3);
        check_grid_scene(&random, 6, 6);
        check_grid_scene(&random, 20, 40);
    }
}

__extension__ typedef __int128 int128;

/* Corners have 24 bits, the origin has 28 bits more after the point: products of their differences
 * need 104. */
enum { FINE = 28 };

static int128 fine_side(const int32_t a[2], const int32_t b[2], const int64_t origin[2]) {
    const int128 unit = 1 << FINE;
    const int128 ax = a[0] * unit - origin[0], ay = a[1] * unit - origin[1];
    const int128 bx = b[0] * unit - origin[0], by = b[1] * unit - origin[1];
    return ax * by - ay * bx;
}

TEST(rays_beside_an_edge_are_told_apart_to_the_last_bit) {
    /* The origin is the point of the grid next to a point of the triangle's first edge. The ray
     * runs along z, so that nothing is lost by shearing. */
    test_random random = {11};
    int wrong = 0, hits = 0;
    for (int round = 0; round < 3000; round++) {
        int32_t p[3][2];
        float corners[3][3];
        for (int k = 0; k < 3; k++) {
            for (int i = 0; i < 2; i++) {
                p[k][i] = (int32_t)random_below(&random, 1u << 24) - (1 << 23);
                corners[k][i] = (float)p[k][i];
            }
            corners[k][2] = 1;
        }
        const double along = random_double(&random, 0.1, 0.9);
        int64_t origin[2];
        for (int i = 0; i < 2; i++)
            origin[i] = (int64_t)((p[0][i] + along * (p[1][i] - p[0][i])) * (1 << FINE));
        const int128 u = fine_side(p[1], p[2], origin), v = fine_side(p[2], p[0], origin),
                     w = fine_side(p[0], p[1], origin);
        const bool expected = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
        const shb_vec3 point = {(double)origin[0] / (1 << FINE), (double)origin[1] / (1 << FINE),
                                0};
        soup s = {0};
        soup_add(&s, corners[0], corners[1], corners[2]);
        setup t = setup_for(soup_scene(&s));
        wrong += occluded(t.reference, light_along(0, 0, 1), point, SHB_ID_NONE) != expected;
        hits += expected;
        setup_end(&t);
        soup_free(&s);
    }
    CHECK_INT(wrong, 0);
    CHECK(hits > 1000 && hits < 2000);
}

/* ---- a slow intersection with a margin of doubt ---- */

typedef long double wide;

static void wide_cross(const wide a[3], const wide b[3], wide out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static wide wide_dot(const wide a[3], const wide b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Moeller and Trumbore's test. 1: blocked, 0: not, 2: too close to an edge or an end to say. */
static int slowly_blocked(const shb_vec3 corners[3], const double origin[3],
                          const double direction[3], double limit) {
    wide p[3][3], o[3], d[3], e[3], f[3], g[3], h[3], q[3];
    for (int k = 0; k < 3; k++) {
        p[k][0] = (wide)corners[k].x;
        p[k][1] = (wide)corners[k].y;
        p[k][2] = (wide)corners[k].z;
    }
    for (int i = 0; i < 3; i++) {
        o[i] = (wide)origin[i];
        d[i] = (wide)direction[i];
        e[i] = p[1][i] - p[0][i];
        f[i] = p[2][i] - p[0][i];
        g[i] = o[i] - p[0][i];
    }
    wide_cross(d, f, h);
    wide_cross(g, e, q);
    const wide determinant = wide_dot(e, h);
    if (determinant == 0)
        return 2;
    const wide u = wide_dot(g, h) / determinant, v = wide_dot(d, q) / determinant,
               t = wide_dot(f, q) / determinant;
    const wide doubt = 1e-7L, least = u < v ? u : v, inner = least < 1 - u - v ? least : 1 - u - v;
    if (inner < -doubt || t < -doubt || t > (wide)limit + doubt)
        return 0;
    const bool sure = inner > doubt && t > doubt && t < (wide)limit - doubt;
    return sure ? 1 : 2;
}

static int slowly_occluded(const shb_scene *scene, uint32_t count, shb_light_source light,
                           shb_vec3 point, uint32_t own) {
    const double origin[3] = {point.x, point.y, point.z};
    const double target[3] = {light.position.x, light.position.y, light.position.z};
    double direction[3];
    for (int i = 0; i < 3; i++)
        direction[i] = target[i] - light.w * origin[i];
    int found = 0;
    for (uint32_t id = 0; id < count; id++) {
        shb_vec3 corners[3];
        shb_scene_triangle(scene, id, corners);
        const int blocked =
            id == own ? 0 : slowly_blocked(corners, origin, direction, light.w == 0 ? 1e30 : 1);
        if (blocked == 1)
            return 1;
        found |= blocked;
    }
    return found;
}

/* Points random triangles of the given size into the unit cube; some are needles. */
static void add_random_triangles(soup *s, test_random *random, uint32_t count, double size) {
    for (uint32_t i = 0; i < count; i++) {
        const shb_vec3 middle = random_point(random, 1);
        float corners[3][3];
        const double thin = random_below(random, 3) ? size : size * 1e-3;
        const shb_vec3 axis = random_point(random, size);
        for (int k = 0; k < 3; k++) {
            const shb_vec3 jitter = random_point(random, thin);
            const double along = k == 1 ? 1 : 0;
            corners[k][0] = (float)(middle.x + axis.x * along + jitter.x);
            corners[k][1] = (float)(middle.y + axis.y * along + jitter.y);
            corners[k][2] = (float)(middle.z + axis.z * along + jitter.z);
        }
        soup_add(s, corners[0], corners[1], corners[2]);
    }
}

static void check_against_slow(soup *s, test_random *random, double scale, shb_vec3 offset,
                               int rays) {
    s->transform = shb_mat4_multiply(
        shb_mat4_translation(offset.x, offset.y, offset.z),
        shb_mat4_multiply(shb_mat4_scaling(scale, scale, scale),
                          shb_mat4_rotation((shb_vec3){1, 2, 3}, random_double(random, 0, 6))));
    const shb_scene *scene = soup_scene(s);
    setup t = setup_for(scene);
    int wrong = 0, sure = 0, blocked = 0;
    for (int ray = 0; ray < rays; ray++) {
        const shb_vec3 point = shb_vec3_add(offset, random_point(random, 1.5 * scale));
        const shb_vec3 target = shb_vec3_add(offset, random_point(random, 1.5 * scale));
        const shb_vec3 way = shb_vec3_normalize(shb_vec3_subtract(target, point));
        const shb_light_source light =
            ray & 1 ? light_at(target.x, target.y, target.z) : light_along(way.x, way.y, way.z);
        const uint32_t own = random_below(random, s->count);
        const int expected = slowly_occluded(scene, s->count, light, point, own);
        const int actual = occluded(t.reference, light, point, own);
        wrong += expected != 2 && actual != expected;
        sure += expected != 2;
        blocked += expected == 1;
    }
    CHECK_INT(wrong, 0);
    CHECK(sure > rays * 9 / 10);
    CHECK(blocked > rays / 20 && blocked < rays * 19 / 20);
    setup_end(&t);
}

TEST(occlusion_equals_a_slow_intersection_at_every_scale) {
    test_random random = {2};
    for (double scale = 1e-4; scale < 2e6; scale *= 10) {
        soup s = {0};
        add_random_triangles(&s, &random, 150, 0.6);
        check_against_slow(&s, &random, scale, (shb_vec3){0, 0, 0}, 400);
        check_against_slow(&s, &random, scale, (shb_vec3){1e4 * scale, -3e3 * scale, 7 * scale},
                           400);
        soup_free(&s);
    }
}

TEST(occlusion_equals_a_slow_intersection_on_many_small_triangles) {
    test_random random = {3};
    soup s = {0};
    add_random_triangles(&s, &random, 5000, 0.08);
    check_against_slow(&s, &random, 1, (shb_vec3){0, 0, 0}, 500);
    soup_free(&s);
}

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
                leaks += !occluded(reference, light_along(d.x, d.y, d.z), inside, SHB_ID_NONE);
                const shb_vec3 far = shb_vec3_add(inside, shb_vec3_scale(d, 3));
                leaks += !occluded(reference, light_at(far.x, far.y, far.z), inside, SHB_ID_NONE);
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
    setup t = setup_for(soup_scene(&s));
    int leaks = 0;
    for (int x = -3; x <= 3; x++)
        for (int y = -3; y <= 3; y++)
            for (int dx = -4; dx <= 4; dx++)
                for (int dy = -4; dy <= 4; dy++) {
                    const shb_vec3 inside = {x, y, 1};
                    leaks += !occluded(t.reference, light_along(dx, dy, 3), inside, SHB_ID_NONE);
                    leaks += !occluded(t.reference, light_along(dy, 3, dx), inside, SHB_ID_NONE);
                    leaks += !occluded(t.reference, light_along(-4, dx, dy), inside, SHB_ID_NONE);
                }
    CHECK_INT(leaks, 0);
    test_random random = {4};
    CHECK_INT(count_leaks(&s, t.reference, (shb_vec3){0, 0, 0}, &random), 0);
    CHECK_INT(count_leaks(&s, t.reference, (shb_vec3){1, 3, -2}, &random), 0);
    setup_end(&t);
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
        setup t = setup_for(soup_scene(&s));
        CHECK_INT(count_leaks(&s, t.reference, inside, &random), 0);
        setup_end(&t);
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
    setup t = setup_for(soup_scene(&s));
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 0}, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 1}, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){1, 1, 2}, SHB_ID_NONE), 0);
    setup_end(&t);
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
        setup t = setup_for(soup_scene(&s));
        for (int k = 0; k < 40; k++) {
            const uint32_t own = k & 1;
            shb_vec3 corners[3];
            shb_scene_triangle(soup_scene(&s), own, corners);
            const double w = random_double(&random, 0, 1);
            const shb_vec3 point = own ? point_of(corners, w, 0) : point_of(corners, 0, w);
            shadowed += occluded(t.reference, light_above(&random, &s.transform), point, own);
        }
        setup_end(&t);
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
        setup t = setup_for(soup_scene(&s));
        for (int k = 0; k < 40; k++) {
            const uint32_t own = random_below(&random, s.count);
            shb_vec3 corners[3];
            shb_scene_triangle(soup_scene(&s), own, corners);
            const double w = random_double(&random, 0, 1);
            const shb_vec3 point = point_of(corners, w, random_double(&random, 0, 1 - w));
            shadowed += occluded(t.reference, light_above(&random, &s.transform), point, own);
        }
        setup_end(&t);
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
        setup u = setup_for(soup_scene(&s));
        shb_vec3 corners[3];
        shb_scene_triangle(soup_scene(&s), 0, corners);
        for (int k = 0; k < 10; k++) {
            const shb_vec3 point = point_of(corners, random_double(&random, 0, 1), 0);
            shadowed += occluded(u.reference, light_above(&random, &s.transform), point, 0);
        }
        setup_end(&u);
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
        setup t = setup_for(soup_scene(&s));
        shb_vec3 corners[3];
        shb_scene_triangle(soup_scene(&s), 0, corners);
        for (int k = 0; k < 40; k++) {
            /* weights of a point close to 0: solve for them in the plane */
            const double x = random_double(&random, -0.0009, 0.0009) + 1000, y = 900;
            const double area = 2100.0 * 1850 + 100.0 * 920;
            const shb_vec3 point =
                point_of(corners, (x * 1850 - y * 920) / area, (2100 * y + 100 * x) / area);
            shadowed += occluded(t.reference, light_above(&random, &s.transform), point, 0);
        }
        setup_end(&t);
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
        setup t = setup_for(&scene);
        shb_vec3 corners[3];
        shb_scene_triangle(&scene, 0, corners);
        const shb_vec3 point = point_of(corners, 0.375, 0.25);
        const double *m = place.m;
        CHECK_INT(occluded(t.reference, light_along(m[8], m[9], m[10]), point, 0), 1);
        CHECK_INT(occluded(t.reference, light_along(-m[8], -m[9], -m[10]), point, 0), 0);
        setup_end(&t);
        soup_free(&ground);
        soup_free(&sheet);
    }
}

/* ---- own triangles, lights, what is not finite ---- */

TEST(the_own_triangle_is_left_out_by_its_id) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    setup t = setup_for(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    const shb_vec3 point = {0, 0, 0};
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(t.reference, &light, 1, &point, NULL, &result), SHB_OK);
    CHECK_INT(result, 1);
    CHECK_INT(occluded(t.reference, light, point, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light, point, 1), 1);
    CHECK_INT(occluded(t.reference, light, point, 0), 0);
    setup_end(&t);
    soup_free(&s);
}

TEST(only_what_lies_before_a_point_light_shadows) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    setup t = setup_for(soup_scene(&s));
    const shb_vec3 point = {0, 0, 0};
    CHECK_INT(occluded(t.reference, light_at(0, 0, 1.5), point, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_at(0, 0, 1.0001), point, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_at(0, 0, 1), point, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_at(0, 0, 0.9999), point, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_at(0, 0, -1), point, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_at(0, 0, 0), point, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1e-300), point, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_along(0, 0, -1), point, SHB_ID_NONE), 0);
    setup_end(&t);
    soup_free(&s);
}

TEST(triangles_that_are_not_finite_are_left_out_and_ids_stay) {
    soup s = {0};
    soup_add(&s, (float[3]){NAN, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, INFINITY}, (float[3]){0, 1, 1});
    soup_add(&s, (float[3]){-1, -1, 2}, (float[3]){1, -1, 2}, (float[3]){0, 1, 2});
    setup t = setup_for(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){0, 0, 0}, 0), 1);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){0, 0, 0}, 2), 0);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){(double)NAN, 0, 0}, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){0, 0, -HUGE_VAL}, SHB_ID_NONE), 0);
    setup_end(&t);
    soup_free(&s);
}

TEST(coordinates_beyond_float_cast_shadows_and_extremes_do_no_harm) {
    soup s = {0};
    soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    s.transform = shb_mat4_scaling(1e50, 1e50, 1e50);
    setup t = setup_for(soup_scene(&s));
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){0, 0, 0}, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){3e50, 0, 0}, SHB_ID_NONE), 0);
    setup_end(&t);
    s.transform = shb_mat4_scaling(1e300, 1e300, 1e-300);
    t = setup_for(soup_scene(&s));
    CHECK(occluded(t.reference, light_along(1, 1, 1), (shb_vec3){1e308, 0, 0}, SHB_ID_NONE) <= 1);
    CHECK(occluded(t.reference, light_at(-1e308, 1, 1), (shb_vec3){1e308, 0, 0}, SHB_ID_NONE) <= 1);
    setup_end(&t);
    soup_free(&s);
}

/* ---- shapes of the hierarchy ---- */

TEST(equal_and_lopsided_triangles_build_a_hierarchy) {
    soup s = {0};
    for (int i = 0; i < 1000; i++) /* all in one place */
        soup_add(&s, (float[3]){-1, -1, 1}, (float[3]){1, -1, 1}, (float[3]){0, 1, 1});
    for (int i = -120; i < 120; i++) { /* each far smaller than the next */
        const float size = ldexpf(1, i), at = 3 * size;
        soup_add(&s, (float[3]){at, 0, size}, (float[3]){at + size, 0, size},
                 (float[3]){at, size, size});
    }
    setup t = setup_for(soup_scene(&s));
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){0, -0.5, 0}, 3), 1);
    CHECK_INT(occluded(t.reference, light, (shb_vec3){0, -0.5, 1}, 3), 0);
    for (int i = -120; i < 120; i++) {
        const double size = ldexp(1, i);
        const shb_vec3 under = {3.25 * size, 0.25 * size, 0};
        const uint32_t id = (uint32_t)(1000 + 120 + i);
        CHECK_INT(occluded(t.reference, light_at(under.x, under.y, 2 * size), under, SHB_ID_NONE),
                  1);
        CHECK_INT(occluded(t.reference, light_at(under.x, under.y, 1.01 * size), under, id), 0);
    }
    setup_end(&t);
    soup_free(&s);
}

TEST(a_hierarchy_is_never_too_deep_for_its_traversal) {
    /* Triangles of sizes 16^k with their middles at 16^k on each axis: bins tell only the largest
     * apart, so that the heuristic alone would peel off one at a time, 190 levels deep. All boxes
     * hold the origin. In its own axes a triangle of size 1 lies in the plane 3.8 x + 3.8 y + 8 z =
     * 0.4: a ray along (1, 1, 1) meets it at 1 / 39 of the way, one along (-1, -1, -1) never does.
     */
    soup s = {0};
    const float shape[3][3] = {{-1, -1, 1}, {3, -1, -0.9f}, {1, 1, -0.9f}};
    for (int power = -36; power < 28; power++)
        for (int axis = 0; axis < 3; axis++) {
            float p[3][3];
            for (int k = 0; k < 3; k++)
                for (int i = 0; i < 3; i++)
                    p[k][(axis + i) % 3] = ldexpf(shape[k][i], 4 * power);
            soup_add(&s, p[0], p[1], p[2]);
        }
    setup t = setup_for(soup_scene(&s));
    const shb_vec3 origin = {0, 0, 0};
    CHECK_INT(occluded(t.reference, light_along(-1, -1, -1), origin, SHB_ID_NONE), 0);
    CHECK_INT(occluded(t.reference, light_along(1, 1, 1), origin, SHB_ID_NONE), 1);
    CHECK_INT(occluded(t.reference, light_at(1e-50, 1e-50, 1e-50), origin, SHB_ID_NONE), 0);
    setup_end(&t);
    soup_free(&s);
}

TEST(an_empty_scene_shadows_nothing) {
    const shb_scene scene = {NULL, 0};
    setup t = setup_for(&scene);
    CHECK_INT(occluded(t.reference, light_along(0, 0, 1), (shb_vec3){0, 0, 0}, 0), 0);
    const shb_light_source light = light_along(0, 0, 1);
    CHECK_INT(shb_reference_occluded(t.reference, &light, 0, NULL, NULL, NULL), SHB_OK);
    setup_end(&t);
}

/* ---- threads, memory, arguments ---- */

TEST(occlusion_does_not_depend_on_threads) {
    enum { POINTS = 20000 };
    test_random random = {9};
    soup s = {0};
    add_random_triangles(&s, &random, 20000, 0.03);
    shb_vec3 *points = malloc(POINTS * sizeof *points);
    uint32_t *ids = malloc(POINTS * sizeof *ids);
    uint8_t *results[2] = {malloc(POINTS), malloc(POINTS)};
    for (int i = 0; i < POINTS; i++) {
        points[i] = random_point(&random, 1);
        ids[i] = random_below(&random, s.count);
    }
    for (uint32_t k = 0; k < 2; k++) {
        const shb_context_desc desc = {.threads = k ? 5 : 1};
        const shb_light_source light = light_at(0.5, 1, 3);
        setup t;
        CHECK_INT(shb_context_create(&desc, &t.context), SHB_OK);
        CHECK_INT(shb_reference_create(t.context, soup_scene(&s), &t.reference), SHB_OK);
        CHECK_INT(shb_reference_occluded(t.reference, &light, POINTS, points, ids, results[k]),
                  SHB_OK);
        setup_end(&t);
    }
    CHECK(memcmp(results[0], results[1], POINTS) == 0);
    size_t shadowed = 0;
    for (int i = 0; i < POINTS; i++)
        shadowed += results[0][i];
    CHECK(shadowed > POINTS / 20 && shadowed < POINTS * 19 / 20);
    free(points);
    free(ids);
    free(results[0]);
    free(results[1]);
    soup_free(&s);
}

TEST(a_reference_without_memory_fails_and_leaks_nothing) {
    soup s = {0};
    test_random random = {10};
    add_random_triangles(&s, &random, 100, 0.3);
    test_allocator state = {0};
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    const size_t live = state.live;
    shb_reference *const untouched = (shb_reference *)(void *)&state;
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t fail_at = 1; result == SHB_ERROR_MEMORY && fail_at < 100; fail_at++) {
        state.calls = 0;
        state.fail_at = fail_at;
        shb_reference *reference = untouched;
        result = shb_reference_create(context, soup_scene(&s), &reference);
        if (result) {
            CHECK_INT(result, SHB_ERROR_MEMORY);
            CHECK(reference == untouched);
            CHECK_INT(state.live, live);
        } else {
            CHECK(fail_at > 5);
            shb_reference_destroy(reference);
        }
    }
    CHECK_INT(result, SHB_OK);
    CHECK_INT(state.live, live);
    shb_context_destroy(context);
    soup_free(&s);
}

TEST(occlusion_refuses_bad_arguments) {
    soup s = {0};
    add_ground(&s);
    setup t = setup_for(soup_scene(&s));
    shb_reference *other = t.reference;
    CHECK_INT(shb_reference_create(NULL, soup_scene(&s), &other), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_create(t.context, NULL, &other), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_create(t.context, soup_scene(&s), NULL), SHB_ERROR_ARGUMENT);
    const uint32_t bad_index[3] = {0, 1, 6};
    const shb_mesh mesh = {
        .positions = s.positions, .vertex_count = 6, .indices = bad_index, .triangle_count = 1};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene bad_scene = {&instance, 1};
    CHECK_INT(shb_reference_create(t.context, &bad_scene, &other), SHB_ERROR_ARGUMENT);
    CHECK(other == t.reference);

    const shb_light_source good = light_along(0, 0, 1);
    const shb_vec3 point = {0, 0, -1};
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(NULL, &good, 1, &point, NULL, &result), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, NULL, 1, &point, NULL, &result),
              SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, &good, 1, NULL, NULL, &result),
              SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_occluded(t.reference, &good, 1, &point, NULL, NULL),
              SHB_ERROR_ARGUMENT);
    const shb_light_source bad[4] = {light_along(0, 0, 0),
                                     light_along((double)NAN, 0, 1),
                                     light_at(0, HUGE_VAL, 0),
                                     {{1, 1, 1}, 0.5}};
    for (int i = 0; i < 4; i++)
        CHECK_INT(shb_reference_occluded(t.reference, &bad[i], 1, &point, NULL, &result),
                  SHB_ERROR_NUMBER);
    CHECK_INT(result, 99);
    setup_end(&t);
    shb_reference_destroy(NULL);
    soup_free(&s);
}
