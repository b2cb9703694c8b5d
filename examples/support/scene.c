#include "scene.h"

#include <math.h>

owned_mesh *scene_add_mesh(example_scene *scene) {
    if (scene->mesh_count < SCENE_MESHES_MAX)
        return &scene->meshes[scene->mesh_count++];
    scene->failed = true;
    return &scene->meshes[0];
}

void scene_add_instance(example_scene *scene, const owned_mesh *mesh, const shb_mat4 *transform,
                        shb_cull cull, const scene_surface *surface) {
    const size_t number = scene->scene.instance_count;
    if (number == SCENE_INSTANCES_MAX) {
        scene->failed = true;
        return;
    }
    scene->instances[number] =
        (shb_instance){.mesh = &scene->views[mesh - scene->meshes],
                       .world_from_mesh = transform ? *transform : (shb_mat4){{0}},
                       .cull = cull};
    scene->surfaces[number] = *surface;
    scene->scene.instance_count++;
}

owned_mesh *scene_add_solid(example_scene *scene, const scene_surface *surface) {
    owned_mesh *mesh = scene_add_mesh(scene);
    scene_add_instance(scene, mesh, NULL, SHB_CULL_BACK, surface);
    return mesh;
}

void scene_set_sun(example_scene *scene, shb_vec3 to_light) {
    scene->lights[SCENE_DIRECTIONAL] =
        (scene_light){.present = true, .source = to_light, .color = {1.10f, 1.02f, 0.88f}};
}

void scene_set_spot(example_scene *scene, shb_vec3 position, shb_vec3 target, double angle,
                    double near_distance, double far_distance) {
    scene->lights[SCENE_SPOT] = (scene_light){.present = true,
                                              .source = position,
                                              .target = target,
                                              .angle = angle,
                                              .near_distance = near_distance,
                                              .far_distance = far_distance,
                                              .color = {1.10f, 1.02f, 0.88f}};
}

shb_result scene_add_clusters(shb_context *context, example_scene *scene) {
    shb_result result = SHB_OK;
    scene_remove_clusters(scene);
    for (size_t i = 0; i < scene->mesh_count && result == SHB_OK; i++) {
        result = shb_clusters_create(context, &scene->views[i], &scene->clusters[i]);
        scene->views[i].clusters = scene->clusters[i];
    }
    if (result != SHB_OK)
        scene_remove_clusters(scene);
    return result;
}

void scene_remove_clusters(example_scene *scene) {
    for (size_t i = 0; i < scene->mesh_count; i++) {
        shb_clusters_destroy(scene->clusters[i]);
        scene->clusters[i] = NULL;
        scene->views[i].clusters = NULL;
    }
}

static scene_contact contact_of_box(shb_box box, shb_vec3 to_light, double length) {
    const shb_vec3 middle = {(box.lo.x + box.hi.x) / 2, box.lo.y, (box.lo.z + box.hi.z) / 2};
    scene_contact contact = {.contact = middle, .normal = {0, 1, 0}, .length = length};
    if (fabs(to_light.x) > fabs(to_light.z)) {
        contact.contact.x = to_light.x > 0 ? box.lo.x : box.hi.x;
        contact.direction.x = to_light.x > 0 ? -1 : 1;
    } else {
        contact.contact.z = to_light.z > 0 ? box.lo.z : box.hi.z;
        contact.direction.z = to_light.z > 0 ? -1 : 1;
    }
    return contact;
}

void scene_set_box_contact(example_scene *scene, shb_box box, double length) {
    const shb_vec3 foot = {(box.lo.x + box.hi.x) / 2, box.lo.y, (box.lo.z + box.hi.z) / 2};
    scene_light *sun = &scene->lights[SCENE_DIRECTIONAL], *spot = &scene->lights[SCENE_SPOT];
    sun->contact = contact_of_box(box, sun->source, length);
    spot->contact = contact_of_box(box, shb_vec3_subtract(spot->source, foot), length);
}

shb_result scene_light_view(const example_scene *scene, scene_light_kind kind, uint32_t map_size,
                            bool reversed, shb_view *view) {
    const scene_light *light = &scene->lights[kind];
    if (kind == SCENE_DIRECTIONAL)
        return shb_view_fit_directional(light->source, scene->bounds, map_size, reversed, view);
    return shb_view_perspective(light->source, light->target, (shb_vec3){0, 1, 0}, light->angle, 1,
                                light->near_distance, light->far_distance, reversed, view);
}

shb_result scene_camera_view(const example_scene *scene, uint32_t width, uint32_t height,
                             shb_view *view) {
    const scene_camera *camera = &scene->camera;
    return shb_view_perspective(camera->eye, camera->target, (shb_vec3){0, 1, 0},
                                camera->vertical_angle, (double)width / height,
                                camera->near_distance, camera->far_distance, false, view);
}

void scene_move_camera(example_scene *scene, shb_vec3 eye, shb_vec3 target) {
    const shb_box box = scene->bounds;
    const shb_vec3 middle = shb_vec3_scale(shb_vec3_add(box.lo, box.hi), 0.5);
    const double radius = shb_vec3_length(shb_vec3_subtract(box.hi, box.lo)) / 2;
    const double distance = shb_vec3_length(shb_vec3_subtract(eye, middle));
    scene->camera.eye = eye;
    scene->camera.target = target;
    scene->camera.near_distance = fmax(0.9 * (distance - radius), 0.001 * radius);
    scene->camera.far_distance = 1.1 * (distance + radius);
}
