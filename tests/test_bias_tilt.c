/* A lone plane in a drawn map: nothing casts a shadow, so every shadow on it is false. */
#include "contexts.h"
#include "random.h"
#include "shadowbias/map.h"
#include "test.h"

#include <math.h>

enum { SIZE = 512, POINTS = 4000 };

/* A square of 400 by 400 about the origin whose normal is (sin, 0, cos). */
typedef struct plane {
    shb_vec3 normal;
    float corners[12];
} plane;

static plane tilted_plane(double angle) {
    const double s = sin(angle), c = cos(angle);
    plane made = {.normal = {s, 0, c}};
    for (int k = 0; k < 4; k++) {
        const double u = k == 1 || k == 2 ? 200 : -200, v = k >= 2 ? 200 : -200;
        made.corners[3 * k] = (float)(u * c);
        made.corners[3 * k + 1] = (float)v;
        made.corners[3 * k + 2] = (float)(-u * s);
    }
    return made;
}

static void draw_plane(shb_map *map, const plane *drawn) {
    static const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    const shb_mesh mesh = {.positions = drawn->corners,
                           .vertex_count = 4,
                           .indices = indices,
                           .index_size = 2,
                           .triangle_count = 2};
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
}

/* Random points of the plane between the near and the far plane, where rays of the view meet it;
 * the view looks down the z axis from a height, at a half width that grows with the distance or
 * not. */
static size_t sample_plane(const plane *drawn, double height, double half_width, bool central,
                           double near_distance, double far_distance, float *positions) {
    test_random random = {7};
    size_t count = 0;
    for (int tries = 0; tries < 20 * POINTS && count < POINTS; tries++) {
        const double x = random_double(&random, -half_width, half_width);
        const double y = random_double(&random, -half_width, half_width);
        const shb_vec3 start = central ? (shb_vec3){0, 0, height} : (shb_vec3){x, y, height};
        const shb_vec3 along = central ? (shb_vec3){x, y, -1} : (shb_vec3){0, 0, -1};
        const double w = -shb_vec3_dot(drawn->normal, start) / shb_vec3_dot(drawn->normal, along);
        if (!(w > near_distance && w < far_distance))
            continue;
        const shb_vec3 point = shb_vec3_add(start, shb_vec3_scale(along, w));
        positions[3 * count] = (float)point.x;
        positions[3 * count + 1] = (float)point.y;
        positions[3 * count + 2] = (float)point.z;
        count++;
    }
    return count;
}

static size_t count_shadowed(const shb_map *map, const shb_bias *bias, shb_vec3 normal,
                             size_t count, const float *positions) {
    static float normals[3 * POINTS], visibility[POINTS];
    for (size_t i = 0; i < count; i++) {
        normals[3 * i] = (float)normal.x;
        normals[3 * i + 1] = (float)normal.y;
        normals[3 * i + 2] = (float)normal.z;
    }
    const shb_points points = {.count = count, .positions = positions, .normals = normals};
    CHECK_INT(shb_map_visibility(map, &points, bias, NULL, visibility), SHB_OK);
    size_t shadowed = 0;
    for (size_t i = 0; i < count; i++)
        shadowed += visibility[i] < 1;
    return shadowed;
}

/* Tilts by whole degrees. Without a bias about half of the fragments are falsely shadowed as soon
 * as the plane is not parallel to the map. */
static void check_tilts(const shb_map_desc *desc, double height, double half_width, bool central,
                        double near_distance, double far_distance) {
    const shb_bias clean[] = {shb_bias_receiver_plane(1e-5f), shb_bias_adaptive(1e-4f, 20),
                              shb_bias_adaptive_soft(1e-4f, 20, 100)};
    const shb_bias none = shb_bias_none();
    shb_context *context;
    shb_map *map;
    context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(context, desc, &map), SHB_OK);
    for (int degrees = 0; degrees <= 89; degrees++) {
        const plane drawn = tilted_plane(degrees * 3.14159265358979323846 / 180);
        draw_plane(map, &drawn);
        float positions[3 * POINTS];
        const size_t count = sample_plane(&drawn, height, half_width, central, near_distance,
                                          far_distance, positions);
        CHECK(count > POINTS / 4);
        for (int i = 0; i < 3; i++) {
            const size_t shadowed = count_shadowed(map, &clean[i], drawn.normal, count, positions);
            test_check(shadowed == 0, __FILE__, __LINE__, "%s at %d degrees: %zu of %zu shadowed",
                       clean[i].name, degrees, shadowed, count);
        }
        const size_t acne = count_shadowed(map, &none, drawn.normal, count, positions);
        CHECK(degrees == 0 || (acne > count / 4 && acne < count * 3 / 5));
    }
    shb_map_destroy(map);
    shb_context_destroy(context);
}

static const shb_vec3 down = {0, 0, 0}, up = {0, 1, 0};

TEST(a_plane_does_not_shadow_itself_under_a_directional_light) {
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_map_desc desc = {.width = SIZE};
        shb_view_orthographic((shb_vec3){0, 0, 70}, down, up, 1, 1, 1, 139, reversed, &desc.view);
        check_tilts(&desc, 70, 1, false, 1, 139);
    }
}

TEST(a_plane_does_not_shadow_itself_under_a_spot) {
    for (int reversed = 0; reversed < 2; reversed++) {
        shb_map_desc desc = {.width = SIZE};
        shb_view_perspective((shb_vec3){0, 0, 8}, down, up, 2 * atan(0.25), 1, 1, 100, reversed,
                             &desc.view);
        check_tilts(&desc, 8, 0.25, true, 1, 100);
    }
}

TEST(a_plane_does_not_shadow_itself_in_a_unorm_map) {
    shb_map_desc desc = {.width = SIZE, .format = SHB_FORMAT_UNORM24};
    shb_view_orthographic((shb_vec3){0, 0, 70}, down, up, 1, 1, 1, 139, false, &desc.view);
    check_tilts(&desc, 70, 1, false, 1, 139);
}
