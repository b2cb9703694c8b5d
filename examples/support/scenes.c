#include "scenes.h"

#include "obj.h"
#include "scenes_builtin.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const scene_entry entries[] = {
    {"tilted-plane", "a plane tilted against the light, balls on it", "angle in degrees", 75, 0,
     89.9, scene_build_tilted_plane},
    {"box", "boxes and a ball on the ground: contact", NULL, 0, 0, 0, scene_build_box},
    {"l-shape", "an L above a green ground: convex and concave creases", NULL, 0, 0, 0,
     scene_build_l_shape},
    {"thin-wall", "walls thinner than a texel, and one sheet", "thickness in world units", 0.02,
     0.0001, 0.1, scene_build_thin_wall},
    {"staircase", "a flight of stairs along a wall", NULL, 0, 0, 0, scene_build_staircase},
    {"gap", "plates close above the ground", "largest gap in world units", 0.12, 0.0001, 1,
     scene_build_gap},
    {"sphere", "balls of few, some and many faces", NULL, 0, 0, 0, scene_build_sphere},
    {"wedge", "a plate hinged on the ground", "angle in degrees", 15, 0.01, 90, scene_build_wedge},
    {"columns", "a court between arcades with curtains", NULL, 0, 0, 0, scene_build_columns},
    {"island", "a floating rock with trees and a temple", NULL, 0, 0, 0, scene_build_island},
    {"tree", "a tree, a fence and poles: what is thin, high above the ground", NULL, 0, 0, 0,
     scene_build_tree},
};

const scene_entry *scene_entries(size_t *count) {
    *count = sizeof entries / sizeof *entries;
    return entries;
}

static const scene_entry *find_entry(const char *name, size_t length) {
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
        if (strlen(entries[i].name) == length && memcmp(entries[i].name, name, length) == 0)
            return &entries[i];
    return NULL;
}

/* The least distance from the middle at which an eye in this direction sees the whole box, in a
 * picture of the given vertical angle that is at least 4 : 3 wide. */
static double distance_to_see(shb_box box, shb_vec3 to_eye, double angle) {
    const shb_vec3 half = shb_vec3_scale(shb_vec3_subtract(box.hi, box.lo), 0.5);
    const shb_vec3 right = shb_vec3_normalize(shb_vec3_cross((shb_vec3){0, 1, 0}, to_eye));
    const shb_vec3 up = shb_vec3_cross(to_eye, right);
    double distance = 0;
    for (int i = 0; i < 8; i++) {
        const shb_vec3 corner = {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                                 i & 4 ? half.z : -half.z};
        const double aside =
            fmax(fabs(shb_vec3_dot(corner, right)) * 3 / 4, fabs(shb_vec3_dot(corner, up)));
        distance = fmax(distance, shb_vec3_dot(corner, to_eye) + aside / tan(angle / 2));
    }
    return distance;
}

/* Camera and lights outside the bounds, looking at their middle. */
static bool fit_to_bounds(example_scene *scene) {
    const shb_box box = scene->bounds;
    const shb_vec3 middle = shb_vec3_scale(shb_vec3_add(box.lo, box.hi), 0.5);
    const double radius = shb_vec3_length(shb_vec3_subtract(box.hi, box.lo)) / 2;
    if (!(radius > 0) || isinf(radius))
        return false;
    const double angle = 0.6;
    const shb_vec3 to_eye = shb_vec3_normalize((shb_vec3){0.55, 0.7, 1});
    const double distance = 1.02 * distance_to_see(box, to_eye, angle);
    scene->camera.vertical_angle = angle;
    scene_move_camera(scene, shb_vec3_add(middle, shb_vec3_scale(to_eye, distance)), middle);
    const shb_vec3 to_light = shb_vec3_normalize((shb_vec3){-0.5, 0.9, 0.45});
    scene_set_sun(scene, to_light);
    /* A sphere of this radius, seen from two radii away, fills sixty degrees. */
    scene_set_spot(scene, shb_vec3_add(middle, shb_vec3_scale(to_light, 2 * radius)), middle,
                   1.01 * 2 * asin(0.5), 0.95 * radius, 3.05 * radius);
    return true;
}

static bool number_triangles(example_scene *scene) {
    scene->instance_of_triangle = malloc(scene->triangle_count * sizeof(uint16_t));
    if (!scene->instance_of_triangle)
        return false;
    size_t id = 0;
    for (size_t i = 0; i < scene->scene.instance_count; i++)
        for (uint32_t k = 0; k < scene->instances[i].mesh->triangle_count; k++)
            scene->instance_of_triangle[id++] = (uint16_t)i;
    return true;
}

/* What the library draws from, now that the meshes have got their final size. */
static bool finish_scene(example_scene *scene) {
    for (size_t i = 0; i < scene->mesh_count; i++) {
        scene->failed |= scene->meshes[i].failed;
        scene->views[i] = owned_mesh_view(&scene->meshes[i]);
    }
    scene->scene.instances = scene->instances;
    if (scene->failed || shb_scene_validate(&scene->scene) ||
        shb_scene_bounds(&scene->scene, &scene->bounds))
        return false;
    scene->triangle_count = shb_scene_triangle_count(&scene->scene);
    return number_triangles(scene);
}

static bool build_entry(example_scene *scene, const scene_entry *entry, const char *number,
                        char *error, size_t error_size) {
    double parameter = entry->standard;
    if (number) {
        char *end;
        parameter = strtod(number, &end);
        if (!entry->parameter || end == number || *end || !(parameter >= entry->lo) ||
            !(parameter <= entry->hi)) {
            if (entry->parameter)
                snprintf(error, error_size, "scene %s: the %s must be %g to %g, not \"%s\"",
                         entry->name, entry->parameter, entry->lo, entry->hi, number);
            else
                snprintf(error, error_size, "scene %s: takes no parameter", entry->name);
            return false;
        }
    }
    entry->build(scene, parameter);
    if (finish_scene(scene))
        return true;
    snprintf(error, error_size, "scene %s: out of memory", entry->name);
    return false;
}

static bool build_file(example_scene *scene, const char *path, char *error, size_t error_size) {
    owned_mesh *mesh = scene_add_mesh(scene);
    const scene_surface surface = {.color = {0.64f, 0.62f, 0.58f}};
    if (!obj_read_file(path, mesh, error, error_size)) {
        const size_t length = strlen(error);
        if (!strchr(path, '.')) /* a name, more likely than a file */
            snprintf(error + length, error_size - length, ", nor a built-in scene");
        return false;
    }
    scene_add_instance(scene, mesh, NULL, SHB_CULL_NONE, &surface);
    if (finish_scene(scene) && fit_to_bounds(scene))
        return true;
    snprintf(error, error_size, "%s: the mesh has no extent", path);
    return false;
}

bool scene_open(const char *text, example_scene **scene, char *error, size_t error_size) {
    example_scene *opened = calloc(1, sizeof *opened);
    if (!opened) {
        snprintf(error, error_size, "scene %s: out of memory", text);
        return false;
    }
    opened->ambient = 0.25f;
    memcpy(opened->background, (const float[]){0.36f, 0.50f, 0.66f}, sizeof opened->background);
    const char *colon = strchr(text, ':');
    const scene_entry *entry = find_entry(text, colon ? (size_t)(colon - text) : strlen(text));
    const bool done = entry
                          ? build_entry(opened, entry, colon ? colon + 1 : NULL, error, error_size)
                          : build_file(opened, text, error, error_size);
    if (done)
        *scene = opened;
    else
        scene_close(opened);
    return done;
}

void scene_close(example_scene *scene) {
    if (!scene)
        return;
    scene_remove_clusters(scene);
    for (size_t i = 0; i < scene->mesh_count; i++)
        owned_mesh_free(&scene->meshes[i]);
    free(scene->instance_of_triangle);
    free(scene);
}
