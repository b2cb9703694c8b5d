/* Small scenes, each made to show one kind of error. */
#include "scenes_builtin.h"

#include "shapes.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

static const scene_surface stone = {.color = {0.62f, 0.58f, 0.52f}};
static const scene_surface red = {.color = {0.62f, 0.20f, 0.13f}};
static const scene_surface blue = {.color = {0.16f, 0.28f, 0.50f}};
static const scene_surface ochre = {.color = {0.70f, 0.47f, 0.18f}};
static const scene_surface floor_tiles = {.color = {0.60f, 0.57f, 0.52f},
                                          .second = {0.46f, 0.43f, 0.40f},
                                          .pattern = SCENE_TILES,
                                          .tile_size = 1};

/* A slab with its upper side at height 0. */
static void add_ground(example_scene *scene, double half_x, double half_z,
                       const scene_surface *surface) {
    shape_box(scene_add_solid(scene, surface), (shb_vec3){-half_x, -0.25, -half_z},
              (shb_vec3){half_x, 0, half_z});
}

static shb_box add_box(example_scene *scene, shb_vec3 lo, shb_vec3 hi,
                       const scene_surface *surface) {
    shape_box(scene_add_solid(scene, surface), lo, hi);
    return (shb_box){lo, hi};
}

static void add_ball(example_scene *scene, shb_vec3 center, double radius, uint32_t segments,
                     const scene_surface *surface) {
    shape_ball(scene_add_solid(scene, surface), center, radius, segments);
}

static void look(example_scene *scene, shb_vec3 eye, shb_vec3 target, double vertical_degrees) {
    scene->camera = (scene_camera){eye, target, vertical_degrees * degree, 0.1, 200};
}

void scene_build_tilted_plane(example_scene *scene, double angle) {
    owned_mesh *plane = scene_add_mesh(scene);
    shape_box(plane, (shb_vec3){-4, -0.2, -4}, (shb_vec3){4, 0, 4});
    const shb_mat4 tilt = shb_mat4_rotation((shb_vec3){1, 0, 0}, angle * degree);
    scene_add_instance(scene, plane, &tilt, SHB_CULL_BACK, &stone);
    /* Balls that touch the plane near its upper edge. */
    const scene_surface *const surfaces[] = {&red, &ochre, &blue};
    for (int i = 0; i < 3; i++) {
        const double radius = 0.4 + 0.15 * i;
        const shb_vec3 above = {2.2 * (i - 1), radius, -2.4};
        add_ball(scene, shb_mat4_transform_point(tilt, above), radius, 48, surfaces[i]);
    }
    scene_set_sun(scene, (shb_vec3){0, 1, 0});
    scene_set_spot(scene, (shb_vec3){0, 9, 0}, (shb_vec3){0, 0, 0}, 70 * degree, 2, 16);
    look(scene, (shb_vec3){3.4, 3.2, 10.5}, (shb_vec3){0, -0.1, 0}, 48);
}

void scene_build_box(example_scene *scene, double unused) {
    (void)unused;
    add_ground(scene, 6, 6, &floor_tiles);
    const shb_box box = add_box(scene, (shb_vec3){-1, 0, -1}, (shb_vec3){1, 2, 1}, &red);
    add_box(scene, (shb_vec3){1.6, 0, 0.2}, (shb_vec3){2.5, 0.9, 1.1}, &ochre);
    add_ball(scene, (shb_vec3){-2.3, 0.7, 1.3}, 0.7, 64, &blue);
    scene_set_sun(scene, (shb_vec3){-0.75, 0.8, -0.42});
    scene_set_spot(scene, (shb_vec3){-5, 6, -3.5}, (shb_vec3){0, 0, 0}, 75 * degree, 1, 20);
    scene_set_box_contact(scene, box, 1);
    look(scene, (shb_vec3){4.6, 4.4, 6.4}, (shb_vec3){0.25, 0.35, 0.1}, 40);
}

void scene_build_l_shape(example_scene *scene, double unused) {
    (void)unused;
    const scene_surface green = {.color = {0.36f, 0.52f, 0.30f}};
    add_ground(scene, 5, 5, &green);
    owned_mesh *mesh = scene_add_mesh(scene);
    /* The inner corner comes first: it sees the whole outline. */
    const shape_point outline[] = {{0, 0.8},  {0, 2.6}, {-0.8, 2.6},
                                   {-0.8, 0}, {2.2, 0}, {2.2, 0.8}};
    shape_prism(mesh, outline, 6, -1.2, 1.2);
    const shb_mat4 lifted = shb_mat4_translation(-0.4, 0.7, 0);
    scene_add_instance(scene, mesh, &lifted, SHB_CULL_BACK, &ochre);
    scene_set_sun(scene, (shb_vec3){0.6, 0.9, 0.25});
    scene_set_spot(scene, (shb_vec3){4, 6, 2}, (shb_vec3){0, 0.5, 0}, 75 * degree, 1, 20);
    look(scene, (shb_vec3){4.4, 4.6, 6.6}, (shb_vec3){0.1, 1.1, 0}, 40);
}

void scene_build_thin_wall(example_scene *scene, double thickness) {
    add_ground(scene, 6, 6, &floor_tiles);
    shb_box contact = {{0, 0, 0}, {0, 0, 0}};
    const scene_surface *const surfaces[] = {&red, &ochre, &stone};
    for (int i = 0; i < 3; i++) {
        const double z = 1.9 * (i - 1), width = thickness * (1 << (2 * i));
        const shb_box wall =
            add_box(scene, (shb_vec3){-2.5, 0, z}, (shb_vec3){2.5, 1.5, z + width}, surfaces[i]);
        if (i == 0)
            contact = wall;
    }
    owned_mesh *sheet = scene_add_mesh(scene);
    shape_quad(sheet, (shb_vec3){-2.5, 0, 3.8}, (shb_vec3){2.5, 0, 3.8}, (shb_vec3){2.5, 1.5, 3.8},
               (shb_vec3){-2.5, 1.5, 3.8});
    scene_add_instance(scene, sheet, NULL, SHB_CULL_NONE, &blue);
    scene_set_sun(scene, (shb_vec3){-0.35, 0.9, -0.75});
    scene_set_spot(scene, (shb_vec3){-3, 7, -6}, (shb_vec3){0, 0, 0.6}, 75 * degree, 1, 22);
    scene_set_box_contact(scene, contact, 0.8);
    look(scene, (shb_vec3){7.6, 5.2, 6.8}, (shb_vec3){0.2, 0.3, 0.7}, 38);
}

void scene_build_staircase(example_scene *scene, double unused) {
    (void)unused;
    add_ground(scene, 6, 5, &floor_tiles);
    enum { steps = 12 };
    shape_point outline[2 * steps + 2] = {{0, 0}};
    size_t count = 1;
    const double run = 0.36, rise = 0.24;
    outline[count++] = (shape_point){steps * run, 0};
    for (int i = steps; i > 0; i--) {
        outline[count++] = (shape_point){i * run, (steps - i + 1) * rise};
        if (i > 1)
            outline[count++] = (shape_point){(i - 1) * run, (steps - i + 1) * rise};
    }
    outline[count++] = (shape_point){0, steps * rise};
    owned_mesh *mesh = scene_add_mesh(scene);
    shape_prism(mesh, outline, count, -1.4, 1.4);
    const shb_mat4 moved = shb_mat4_translation(-2.4, 0, 0);
    scene_add_instance(scene, mesh, &moved, SHB_CULL_BACK, &stone);
    add_box(scene, (shb_vec3){-2.4, 0, -1.9}, (shb_vec3){2.4, 2.0, -1.4}, &red);
    const shb_box pillar =
        add_box(scene, (shb_vec3){2.2, 0, 1.4}, (shb_vec3){2.9, 1.5, 2.0}, &ochre);
    scene_set_sun(scene, (shb_vec3){0.55, 0.62, -0.8});
    scene_set_spot(scene, (shb_vec3){4.5, 6, -5}, (shb_vec3){0, 0.8, 0}, 75 * degree, 1, 20);
    scene_set_box_contact(scene, pillar, 0.4);
    look(scene, (shb_vec3){6.2, 4.4, 6.6}, (shb_vec3){-0.1, 0.9, 0}, 40);
}

void scene_build_gap(example_scene *scene, double gap) {
    add_ground(scene, 6, 5, &floor_tiles);
    const scene_surface *const surfaces[] = {&red, &ochre, &blue};
    for (int i = 0; i < 3; i++) {
        const double height = gap / (1 << (2 * i)), x = 3 * (i - 1);
        add_box(scene, (shb_vec3){x - 1.1, height, -1.4}, (shb_vec3){x + 1.1, height + 0.06, 1},
                surfaces[i]);
    }
    scene_set_sun(scene, (shb_vec3){0.2, 0.22, -1});
    scene_set_spot(scene, (shb_vec3){1.5, 2.2, -8}, (shb_vec3){0, 0, 0}, 70 * degree, 1, 18);
    look(scene, (shb_vec3){0.8, 2.2, 8.4}, (shb_vec3){0, -0.1, 0.4}, 42);
}

void scene_build_sphere(example_scene *scene, double unused) {
    (void)unused;
    add_ground(scene, 7, 5, &floor_tiles);
    const uint32_t segments[] = {12, 32, 128};
    const scene_surface *const surfaces[] = {&ochre, &red, &blue};
    for (int i = 0; i < 3; i++)
        add_ball(scene, (shb_vec3){2.7 * (i - 1), 1.1, 0.4 * (1 - i)}, 1.1, segments[i],
                 surfaces[i]);
    scene_set_sun(scene, (shb_vec3){-0.6, 0.75, 0.35});
    scene_set_spot(scene, (shb_vec3){-5, 6, 3}, (shb_vec3){0, 0.5, 0}, 80 * degree, 1, 22);
    look(scene, (shb_vec3){1.8, 3.6, 9}, (shb_vec3){0.4, 0.7, 0}, 40);
}

void scene_build_wedge(example_scene *scene, double angle) {
    add_ground(scene, 5, 5, &floor_tiles);
    const double x = 3 * cos(angle * degree), y = 3 * sin(angle * degree);
    /* The plate is hinged at the line x = 0 and as thin there as the angle lets it be. */
    const shape_point outline[] = {{0, 0}, {x, y}, {x - 0.08 * y, y + 0.08 * x}};
    shape_prism(scene_add_solid(scene, &red), outline, 3, -2, 2);
    scene_set_sun(scene, (shb_vec3){-0.6, 1, 0.2});
    scene_set_spot(scene, (shb_vec3){-4, 7, 1.5}, (shb_vec3){0.5, 0, 0}, 75 * degree, 1, 20);
    const scene_contact contact = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1};
    for (scene_light_kind kind = SCENE_DIRECTIONAL; kind < SCENE_LIGHT_KINDS; kind++)
        scene->lights[kind].contact = contact;
    look(scene, (shb_vec3){5.4, 2.4, 5.6}, (shb_vec3){0.6, 0.5, 0}, 40);
}
