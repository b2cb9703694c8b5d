/* The terminator of smooth surfaces: points moved out to them, and what low-poly balls look like.
 */
#include "../src/terminator.h"
#include "contexts.h"
#include "shapes.h"
#include "test.h"

#include <math.h>

static shb_surface_triangle octant(double nx, double ny, double nz) {
    shb_surface_triangle triangle = {
        .corners = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
        .normal = {sqrt(1.0 / 3), sqrt(1.0 / 3), sqrt(1.0 / 3)},
    };
    for (int k = 0; k < 3; k++)
        triangle.shading[k] = (shb_vec3){nx, ny, nz};
    return triangle;
}

static const double middle[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};

/* The corners of an octant of the unit sphere. Its middle (1, 1, 1) / 3 lies 1 - 1/3 below each of
 * the tangent planes x = 1, y = 1, z = 1, so the mean way is 2/9 on each axis. Turned
 * normals and longer ones say the same. */
TEST(a_point_is_moved_to_the_mean_of_its_feet_on_tangent_planes) {
    shb_surface_triangle triangle = octant(0, 0, 0);
    triangle.shading[0] = (shb_vec3){1, 0, 0};
    triangle.shading[1] = (shb_vec3){0, -3, 0};
    triangle.shading[2] = (shb_vec3){0, 0, 0.5};
    const shb_vec3 way = shb_terminator_way(&triangle, middle);
    CHECK_NEAR(way.x, 2.0 / 9, 1e-15);
    CHECK_NEAR(way.y, 2.0 / 9, 1e-15);
    CHECK_NEAR(way.z, 2.0 / 9, 1e-15);
    const shb_vec3 corner = shb_terminator_way(&triangle, (double[]){0, 1, 0});
    CHECK(corner.x == 0 && corner.y == 0 && corner.z == 0);
}

/* A hollow: the normals lean towards each other and the point lies above all tangent planes. */
TEST(points_of_flat_and_hollow_surfaces_stay_where_they_are) {
    const shb_surface_triangle flat = octant(2, 2, 2), bare = octant(0, 0, 0);
    const shb_surface_triangle broken = octant((double)NAN, 1, 0);
    shb_surface_triangle hollow = octant(0, 0, 0);
    hollow.shading[0] = (shb_vec3){0, 1, 1};
    hollow.shading[1] = (shb_vec3){1, 0, 1};
    hollow.shading[2] = (shb_vec3){1, 1, 0};
    const shb_surface_triangle *all[] = {&flat, &bare, &broken, &hollow};
    for (int i = 0; i < 4; i++) {
        const shb_vec3 way = shb_terminator_way(all[i], middle);
        CHECK_NEAR(way.x, 0, 1e-15);
        CHECK_NEAR(way.y, 0, 1e-15);
        CHECK_NEAR(way.z, 0, 1e-15);
    }
}

enum { FRAME = 128, MAP = 512 };

/* Between the edges of all the balls below. */
static const shb_vec3 to_light = {0.8, 0.36, -0.48};

/* What shading said of the fragments whose shading normals meet the light at more than 0.05. */
typedef struct tally {
    size_t facing, dark;
    uint64_t hash; /* of the light that all fragments get, by their pixels */
} tally;

static void count_dark(const shb_shade_args *args) {
    tally *seen = (tally *)args->user;
    const shb_lighting *lighting = &args->lighting[0];
    for (size_t i = 0; i < args->count; i++) {
        const double cosine = (double)args->fragments->shading_x[i] * to_light.x +
                              (double)args->fragments->shading_y[i] * to_light.y +
                              (double)args->fragments->shading_z[i] * to_light.z;
        const bool faces = cosine > 0.05;
        const float light = lighting->visibility[i] * lighting->cosine[i];
        const uint64_t pixel =
            (uint64_t)(args->fragments->pixel_y[i] * FRAME + args->fragments->pixel_x[i]);
        seen->hash += (pixel + 1) * (uint64_t)(light * 65536);
        seen->facing += faces;
        seen->dark += faces && light == 0;
    }
}

static shb_view view_from(shb_vec3 towards) {
    shb_view view = {{{0}}, false};
    CHECK_INT(shb_view_orthographic(shb_vec3_scale(towards, 4), (shb_vec3){0, 0, 0},
                                    (shb_vec3){0, 1, 0}, 1.2, 1.2, 1, 8, false, &view),
              SHB_OK);
    return view;
}

/* Lit from the right, somewhat from behind, and seen from the front. */
static tally shade_mesh(const shb_mesh *mesh, shb_occluders occluders, const shb_bias *bias,
                        bool smooth) {
    const shb_instance instance = {.mesh = mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view camera = view_from((shb_vec3){0, 0, 1});
    const shb_map_desc map_desc = {
        .view = view_from(to_light), .width = MAP, .occluders = occluders};
    static uint32_t ids[FRAME * FRAME];
    const shb_draw_desc draw = {
        .view = &camera, .scene = &scene, .width = FRAME, .height = FRAME, .ids = ids};
    shb_context *context;
    shb_map *map;
    context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, bias, NULL), SHB_OK);
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    const shb_shade_light light = {.map = map, .bias = bias, .color = {1, 1, 1}};
    tally seen = {0};
    const shb_shade_desc desc = {.frame = {&camera, &scene, FRAME, FRAME, ids, 0},
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = count_dark,
                                 .user = &seen,
                                 .smooth_terminator = smooth};
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return seen;
}

static tally shade_ball(uint32_t segments, shb_occluders occluders, const shb_bias *bias,
                        bool smooth) {
    owned_mesh built = {0};
    shape_ball(&built, (shb_vec3){0, 0, 0}, 1, segments);
    const shb_mesh mesh = owned_mesh_view(&built);
    const tally seen = shade_mesh(&mesh, occluders, bias, smooth);
    owned_mesh_free(&built);
    return seen;
}

/* Every point of a sphere that faces the light is lit: a dark one is the facets' fault. */
TEST(a_smooth_terminator_lights_all_of_a_ball_that_faces_the_light) {
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0), exact = shb_bias_exact();
    const struct {
        const shb_bias *bias;
        shb_occluders occluders;
    } methods[] = {{&adaptive, SHB_OCCLUDERS_NONE},
                   {&exact, SHB_OCCLUDERS_PLANES},
                   {&exact, SHB_OCCLUDERS_LISTS}};
    for (int m = 0; m < 3; m++)
        for (uint32_t segments = 12; segments <= 48; segments *= 2) {
            const tally plain = shade_ball(segments, methods[m].occluders, methods[m].bias, false);
            const tally smooth = shade_ball(segments, methods[m].occluders, methods[m].bias, true);
            CHECK(plain.facing == smooth.facing && plain.facing > 2000);
            CHECK(plain.dark > 0);
            CHECK_INT(smooth.dark, 0);
        }
}

/* A sheet that light and camera see, with a box that throws a shadow on it: their corners have the
 * normals of their triangles. */
TEST(a_smooth_terminator_changes_nothing_on_flat_surfaces) {
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0);
    owned_mesh built = {0};
    shape_quad(&built, (shb_vec3){-0.6, -0.5, 0.8}, (shb_vec3){0.6, -0.5, -0.8},
               (shb_vec3){0.6, 0.5, -0.8}, (shb_vec3){-0.6, 0.5, 0.8});
    shape_box(&built, (shb_vec3){0.3, 0, -0.1}, (shb_vec3){0.5, 0.2, 0.1});
    shb_mesh mesh = owned_mesh_view(&built);
    const tally plain = shade_mesh(&mesh, SHB_OCCLUDERS_NONE, &adaptive, false);
    const tally smooth = shade_mesh(&mesh, SHB_OCCLUDERS_NONE, &adaptive, true);
    mesh.normals = NULL;
    const tally bare = shade_mesh(&mesh, SHB_OCCLUDERS_NONE, &adaptive, true);
    CHECK(plain.hash == smooth.hash && smooth.hash == bare.hash && plain.hash != 0);
    owned_mesh_free(&built);
}

/* Counts fragments left and right of the middle, and those without the normal expected there. */
typedef struct normals_seen {
    int count[2], wrong[2];
} normals_seen;

static const float shading_normals[2][3] = {{-0.48f, 0.6f, 0.64f}, {0.36f, 0.48f, 0.8f}};

static void see_normals(const shb_bias_args *args) {
    normals_seen *seen = (normals_seen *)args->bias->user;
    shb_receivers *r = args->receivers;
    for (size_t i = 0; i < args->count; i++) {
        const int right = r->x[i] > 0;
        const float *n = right ? shading_normals[1] : (const float[]){0, 0, 1};
        const float off = fabsf(r->normal_x[i] - n[0]) + fabsf(r->normal_y[i] - n[1]) +
                          fabsf(r->normal_z[i] - n[2]);
        seen->count[right]++;
        seen->wrong[right] += !(off < 1e-5f);
        r->ref[i] = r->depth[i];
        r->step_x[i] = r->step_y[i] = 0;
    }
}

/* Lit from (2, 0, 1): the left triangle faces the light, the right one, which falls towards -x,
 * does not; there the surface's normal stands for the plane. */
TEST(a_smooth_terminator_asks_by_the_plane_that_faces_the_light) {
    static const float corners[2][3][3] = {
        {{-0.9f, -0.5f, 0}, {-0.1f, -0.5f, 0}, {-0.5f, 0.5f, 0}},
        {{0.2f, -0.5f, 0}, {0.5f, -0.5f, 0.4f}, {0.5f, 0.5f, 0.4f}}};
    owned_mesh built = {0};
    for (int i = 0; i < 6; i++)
        owned_mesh_add_vertex(&built, corners[i / 3][i % 3], shading_normals[i / 3]);
    owned_mesh_add_triangle(&built, 0, 1, 2);
    owned_mesh_add_triangle(&built, 3, 4, 5);
    const shb_mesh mesh = owned_mesh_view(&built);
    const shb_instance instance = {.mesh = &mesh};
    const shb_scene scene = {&instance, 1};
    const shb_view camera = view_from((shb_vec3){0, 0, 1});
    static uint32_t ids[FRAME * FRAME];
    const shb_map_desc map_desc = {.view = view_from((shb_vec3){0.8, 0, 0.4}), .width = 16};
    const shb_draw_desc draw = {
        .view = &camera, .scene = &scene, .width = FRAME, .height = FRAME, .ids = ids};
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_map *map;
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    CHECK_INT(shb_map_draw(map, &scene, NULL, NULL), SHB_OK);
    CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
    normals_seen seen = {{0}, {0}};
    const shb_bias bias = {.name = "normals", .depth = see_normals, .user = &seen};
    const shb_shade_light light = {.map = map, .bias = &bias, .color = {1, 1, 1}};
    tally ignored = {0};
    const shb_shade_desc desc = {.frame = {&camera, &scene, FRAME, FRAME, ids, 0},
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = count_dark,
                                 .user = &ignored,
                                 .smooth_terminator = true};
    CHECK_INT(shb_shade(context, &desc), SHB_OK);
    CHECK(seen.count[0] > 100 && seen.count[1] > 100);
    CHECK_INT(seen.wrong[0] + seen.wrong[1], 0);
    shb_map_destroy(map);
    shb_context_destroy(context);
    owned_mesh_free(&built);
}

/* Fragments of the floor near the middle of its right half. */
static void count_dark_below_the_roof(const shb_shade_args *args) {
    tally *seen = (tally *)args->user;
    for (size_t i = 0; i < args->count; i++) {
        const float x = args->fragments->x[i], y = args->fragments->y[i];
        const bool is_below = x > 0.85f && x < 0.95f && y > -0.4f && y < 0.4f;
        seen->facing += is_below;
        seen->dark += is_below && args->lighting[0].visibility[i] == 0;
    }
}

static shb_view square_from_above(void) {
    shb_view view = {{{0}}, false};
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 4}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    1, 1, 1, 8, false, &view),
              SHB_OK);
    return view;
}

/* A texel, 0.5 < x < 1, that a roof z = 0.8 x covers, from 0.4 on and 0.6 at its centre. The
 * normals of the floor at z = 0.3 lean by (0, 0.28, 0.96) to its ends at y = 1 and -1, so that a
 * point is moved up by 0.2688 (1 - y^2), to between 0.5 and 0.57. What is known of points of the
 * scene that high in the texel, that they are on the roof, is not true of it. */
TEST(a_smooth_terminator_lights_nothing_below_a_roof) {
    const shb_bias exact = shb_bias_exact();
    const float up[] = {0, 0.28f, 0.96f}, down[] = {0, -0.28f, 0.96f};
    const float floor_corners[4][3] = {
        {-1.2f, -1, 0.3f}, {1.2f, -1, 0.3f}, {1.2f, 1, 0.3f}, {-1.2f, 1, 0.3f}};
    owned_mesh ground = {0}, roof = {0};
    for (int k = 0; k < 4; k++)
        owned_mesh_add_vertex(&ground, floor_corners[k], k < 2 ? down : up);
    owned_mesh_add_triangle(&ground, 0, 1, 2);
    owned_mesh_add_triangle(&ground, 0, 2, 3);
    shape_quad(&roof, (shb_vec3){0.25, -1.2, 0.2}, (shb_vec3){1.2, -1.2, 0.96},
               (shb_vec3){1.2, 1.2, 0.96}, (shb_vec3){0.25, 1.2, 0.2});
    const shb_mesh ground_mesh = owned_mesh_view(&ground), roof_mesh = owned_mesh_view(&roof);
    const shb_instance instances[] = {{.mesh = &ground_mesh}, {.mesh = &roof_mesh}};
    const shb_scene both = {instances, 2}, seen_scene = {instances, 1};
    const shb_view view = square_from_above();
    static uint32_t ids[FRAME * FRAME];
    for (int kind = SHB_OCCLUDERS_PLANES; kind <= SHB_OCCLUDERS_LISTS; kind++) {
        const shb_map_desc map_desc = {
            .view = view, .width = 4, .occluders = (shb_occluders)kind, .classifies = true};
        const shb_draw_desc draw = {
            .view = &view, .scene = &seen_scene, .width = FRAME, .height = FRAME, .ids = ids};
        shb_context *context;
        shb_map *map;
        context = test_context(1, SHB_ISA_BEST);
        CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
        CHECK_INT(shb_map_draw(map, &both, &exact, NULL), SHB_OK);
        CHECK_INT(shb_draw(context, &draw, NULL), SHB_OK);
        const shb_shade_light light = {.map = map, .bias = &exact, .color = {1, 1, 1}};
        tally seen = {0};
        const shb_shade_desc desc = {.frame = {&view, &seen_scene, FRAME, FRAME, ids, 0},
                                     .lights = &light,
                                     .light_count = 1,
                                     .shade = count_dark_below_the_roof,
                                     .user = &seen,
                                     .smooth_terminator = true};
        CHECK_INT(shb_shade(context, &desc), SHB_OK);
        CHECK(seen.facing > 100);
        CHECK_INT(seen.dark, seen.facing);
        shb_map_destroy(map);
        shb_context_destroy(context);
    }
    owned_mesh_free(&ground);
    owned_mesh_free(&roof);
}
