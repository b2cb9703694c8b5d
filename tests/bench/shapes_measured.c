#include "shapes_measured.h"

#include <math.h>

static void set_light_and_camera(example_scene *scene, shb_vec3 to_light) {
    scene_set_sun(scene, to_light);
    scene->camera = (scene_camera){
        .eye = {0.3, 1.1, 1.6}, .vertical_angle = 0.8, .near_distance = 0.2, .far_distance = 6};
    scene->bounds = (shb_box){{-1, -0.12, -1}, {1, 0.12, 1}};
}

static double hill_height(double u, double v) {
    return 0.08 * sin(9 * u) * cos(7 * v) + 0.03 * sin(31 * u + 3) * sin(37 * v) +
           0.01 * sin(101 * u) * cos(89 * v);
}

static void build_hills(example_scene *scene, uint32_t quads, shb_vec3 to_light, shb_cull cull) {
    owned_mesh *mesh = scene_add_mesh(scene);
    for (uint32_t row = 0; row <= quads; row++)
        for (uint32_t column = 0; column <= quads; column++) {
            const double u = 2.0 * column / quads - 1, v = 2.0 * row / quads - 1;
            const float position[3] = {(float)u, (float)hill_height(u, v), (float)v};
            owned_mesh_add_vertex(mesh, position, NULL);
        }
    for (uint32_t row = 0; row < quads; row++)
        for (uint32_t column = 0; column < quads; column++) {
            const uint32_t a = row * (quads + 1) + column, b = a + 1;
            const uint32_t c = a + quads + 1, d = c + 1;
            owned_mesh_add_triangle(mesh, a, c, b);
            owned_mesh_add_triangle(mesh, b, c, d);
        }
    scene_add_instance(scene, mesh, NULL, cull, &(scene_surface){0});
    set_light_and_camera(scene, to_light);
}

void measured_height_field(example_scene *scene) {
    build_hills(scene, 1000, (shb_vec3){0, 1, 0}, SHB_CULL_NONE);
}

void measured_hills(example_scene *scene) {
    build_hills(scene, 300, (shb_vec3){0.5, 0.45, 0.35}, SHB_CULL_NONE);
}

void measured_culled(example_scene *scene) {
    build_hills(scene, 1000, (shb_vec3){0, 1, 0}, SHB_CULL_FRONT);
}

static void add_level_triangle(owned_mesh *mesh, double height, const double corners[3][2]) {
    uint32_t vertices[3];
    for (int i = 0; i < 3; i++) {
        const float position[3] = {(float)corners[i][0], (float)height, (float)corners[i][1]};
        vertices[i] = owned_mesh_add_vertex(mesh, position, NULL);
    }
    owned_mesh_add_triangle(mesh, vertices[0], vertices[1], vertices[2]);
}

/* From one stacked quad to the next. */
#define QUAD_DISTANCE 0.2

static void build_quads(example_scene *scene, uint32_t quads, shb_vec3 to_light) {
    owned_mesh *mesh = scene_add_mesh(scene);
    for (uint32_t i = 0; i < quads; i++) {
        const double height = QUAD_DISTANCE * i;
        add_level_triangle(mesh, height, (const double[3][2]){{-1, -1}, {-1, 1}, {1, -1}});
        add_level_triangle(mesh, height, (const double[3][2]){{1, -1}, {-1, 1}, {1, 1}});
    }
    scene_add_instance(scene, mesh, NULL, SHB_CULL_NONE, &(scene_surface){0});
    set_light_and_camera(scene, to_light);
    scene->bounds = (shb_box){{-1, 0, -1}, {1, QUAD_DISTANCE * (quads - 1), 1}};
}

void measured_huge(example_scene *scene) {
    build_quads(scene, 2, (shb_vec3){0, 1, 0});
}

void measured_stack(example_scene *scene) {
    build_quads(scene, 8, (shb_vec3){0.4, 0.8, 0.45});
}

void measured_triangle(example_scene *scene) {
    owned_mesh *mesh = scene_add_mesh(scene);
    add_level_triangle(mesh, 0, (const double[3][2]){{-1.5, -1.5}, {-1.5, 4}, {4, -1.5}});
    scene_add_instance(scene, mesh, NULL, SHB_CULL_NONE, &(scene_surface){0});
    set_light_and_camera(scene, (shb_vec3){0, 1, 0});
}

void measured_finish(example_scene *scene) {
    for (size_t i = 0; i < scene->mesh_count; i++) {
        scene->failed |= scene->meshes[i].failed;
        scene->views[i] = owned_mesh_view(&scene->meshes[i]);
    }
    scene->scene.instances = scene->instances;
    scene->triangle_count = shb_scene_triangle_count(&scene->scene);
}
