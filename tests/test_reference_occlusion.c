/* Truth by ray casting against exact integer arithmetic and a slow independent intersection. */
#include <stdlib.h>

#include "random.h"
#include "ray_caster.h"
#include "soup.h"
#include "test.h"

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
    ray_caster t = ray_caster_create(soup_scene(&s));
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
        wrong += ray_caster_occluded(t.reference, light, from, own) != expected;
        hits += expected;
    }
    CHECK_INT(wrong, 0);
    CHECK(hits > 40 && hits < 3600);
    ray_caster_destroy(&t);
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
        ray_caster t = ray_caster_create(soup_scene(&s));
        wrong +=
            ray_caster_occluded(t.reference, light_along(0, 0, 1), point, SHB_ID_NONE) != expected;
        hits += expected;
        ray_caster_destroy(&t);
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

static void check_against_slow(soup *s, test_random *random, double scale, shb_vec3 offset,
                               int rays) {
    s->transform = shb_mat4_multiply(
        shb_mat4_translation(offset.x, offset.y, offset.z),
        shb_mat4_multiply(shb_mat4_scaling(scale, scale, scale),
                          shb_mat4_rotation((shb_vec3){1, 2, 3}, random_double(random, 0, 6))));
    const shb_scene *scene = soup_scene(s);
    ray_caster t = ray_caster_create(scene);
    int wrong = 0, sure = 0, blocked = 0;
    for (int ray = 0; ray < rays; ray++) {
        const shb_vec3 point = shb_vec3_add(offset, random_point(random, 1.5 * scale));
        const shb_vec3 target = shb_vec3_add(offset, random_point(random, 1.5 * scale));
        const shb_vec3 way = shb_vec3_normalize(shb_vec3_subtract(target, point));
        const shb_light_source light =
            ray & 1 ? light_at(target.x, target.y, target.z) : light_along(way.x, way.y, way.z);
        const uint32_t own = random_below(random, s->count);
        const int expected = slowly_occluded(scene, s->count, light, point, own);
        const int actual = ray_caster_occluded(t.reference, light, point, own);
        wrong += expected != 2 && actual != expected;
        sure += expected != 2;
        blocked += expected == 1;
    }
    CHECK_INT(wrong, 0);
    CHECK(sure > rays * 9 / 10);
    CHECK(blocked > rays / 20 && blocked < rays * 19 / 20);
    ray_caster_destroy(&t);
}

TEST(occlusion_equals_a_slow_intersection_at_every_scale) {
    test_random random = {2};
    for (double scale = 1e-4; scale < 2e6; scale *= 10) {
        soup s = {0};
        soup_add_needles(&s, &random, 150, 0.6);
        check_against_slow(&s, &random, scale, (shb_vec3){0, 0, 0}, 400);
        check_against_slow(&s, &random, scale, (shb_vec3){1e4 * scale, -3e3 * scale, 7 * scale},
                           400);
        soup_free(&s);
    }
}

TEST(occlusion_equals_a_slow_intersection_on_many_small_triangles) {
    test_random random = {3};
    soup s = {0};
    soup_add_needles(&s, &random, 5000, 0.08);
    check_against_slow(&s, &random, 1, (shb_vec3){0, 0, 0}, 500);
    soup_free(&s);
}
