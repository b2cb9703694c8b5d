#include "scenes.h"

#include "shadowbias/reference.h"

#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char error[256];

static const char *const contact_scenes[] = {"box", "thin-wall", "staircase", "wedge", "columns"};

static example_scene *open_scene(const char *name) {
    example_scene *scene = NULL;
    error[0] = 0;
    test_check(scene_open(name, &scene, error, sizeof error), __FILE__, __LINE__, "%s: %s", name,
               error);
    return scene;
}

typedef struct edge {
    float from[3], to[3];
} edge;

static int compare_floats(const float *a, const float *b, int count) {
    for (int i = 0; i < count; i++)
        if (a[i] != b[i])
            return a[i] < b[i] ? -1 : 1;
    return 0;
}

static int compare_edges(const void *a, const void *b) {
    const edge *first = a, *second = b;
    const int order = compare_floats(first->from, second->from, 3);
    return order ? order : compare_floats(first->to, second->to, 3);
}

static const float *corner_position(const owned_mesh *mesh, size_t corner) {
    return mesh->positions + 3 * (size_t)mesh->indices[corner];
}

static edge edge_of(const owned_mesh *mesh, size_t corner) {
    edge result;
    const size_t next = corner % 3 == 2 ? corner - 2 : corner + 1;
    memcpy(result.from, corner_position(mesh, corner), sizeof result.from);
    memcpy(result.to, corner_position(mesh, next), sizeof result.to);
    return result;
}

/* A closed surface runs along each edge as often in one direction as in the other. */
static size_t count_open_edges(const owned_mesh *mesh) {
    const size_t count = 3 * (size_t)mesh->triangle_count;
    edge *forward = malloc(count * sizeof *forward), *backward = malloc(count * sizeof *backward);
    for (size_t i = 0; i < count; i++) {
        forward[i] = edge_of(mesh, i);
        memcpy(backward[i].from, forward[i].to, sizeof backward[i].from);
        memcpy(backward[i].to, forward[i].from, sizeof backward[i].to);
    }
    qsort(forward, count, sizeof *forward, compare_edges);
    qsort(backward, count, sizeof *backward, compare_edges);
    size_t open = 0;
    for (size_t i = 0; i < count; i++)
        open += compare_edges(&forward[i], &backward[i]) != 0;
    free(forward);
    free(backward);
    return open;
}

static shb_vec3 corner_point(const owned_mesh *mesh, size_t corner) {
    const float *p = corner_position(mesh, corner);
    return (shb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static shb_vec3 triangle_normal(const owned_mesh *mesh, size_t triangle) {
    const shb_vec3 a = corner_point(mesh, 3 * triangle);
    return shb_vec3_cross(shb_vec3_subtract(corner_point(mesh, 3 * triangle + 1), a),
                          shb_vec3_subtract(corner_point(mesh, 3 * triangle + 2), a));
}

/* By the divergence theorem: positive if front faces look outwards. */
static double six_volumes(const owned_mesh *mesh) {
    double sum = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++)
        sum += shb_vec3_dot(corner_point(mesh, 3 * i), triangle_normal(mesh, i));
    return sum;
}

static const owned_mesh *mesh_of(const example_scene *scene, size_t instance) {
    return &scene->meshes[scene->instances[instance].mesh - scene->views];
}

TEST(scenes_open_and_pass_the_library_s_checks) {
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    CHECK(count >= 10);
    for (size_t i = 0; i < count; i++) {
        example_scene *scene = open_scene(entries[i].name);
        if (!scene)
            continue;
        CHECK(shb_scene_validate(&scene->scene) == SHB_OK);
        CHECK(scene->triangle_count == shb_scene_triangle_count(&scene->scene));
        CHECK(scene->triangle_count > 0);
        CHECK(scene->lights[SCENE_DIRECTIONAL].present && scene->lights[SCENE_SPOT].present);
        for (scene_light_kind kind = SCENE_DIRECTIONAL; kind < SCENE_LIGHT_KINDS; kind++) {
            shb_view view;
            CHECK(scene_light_view(scene, kind, 512, false, &view) == SHB_OK);
        }
        shb_view camera;
        CHECK(scene_camera_view(scene, 320, 200, &camera) == SHB_OK);
        scene_close(scene);
    }
}

TEST(scene_solids_are_closed_and_face_outwards) {
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    for (size_t i = 0; i < count; i++) {
        example_scene *scene = open_scene(entries[i].name);
        const owned_mesh *previous = NULL;
        for (size_t k = 0; scene && k < scene->scene.instance_count; k++) {
            const owned_mesh *mesh = mesh_of(scene, k);
            if (scene->instances[k].cull == SHB_CULL_NONE || mesh == previous)
                continue;
            test_check(count_open_edges(mesh) == 0, __FILE__, __LINE__,
                       "%s: instance %zu has %zu open edges", entries[i].name, k,
                       count_open_edges(mesh));
            test_check(six_volumes(mesh) > 0, __FILE__, __LINE__, "%s: instance %zu is inside out",
                       entries[i].name, k);
            previous = mesh;
        }
        scene_close(scene);
    }
}

/* A smooth normal may lean behind its face, but only at the few sharpest bends. */
TEST(scene_normals_are_unit_vectors_on_the_front) {
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    for (size_t i = 0; i < count; i++) {
        example_scene *scene = open_scene(entries[i].name);
        for (size_t m = 0; scene && m < scene->mesh_count; m++) {
            const owned_mesh *mesh = &scene->meshes[m];
            size_t unit = 0, front = 0;
            const size_t corners = 3 * (size_t)mesh->triangle_count;
            for (size_t c = 0; c < corners; c++) {
                const float *n = mesh->normals + 3 * (size_t)mesh->indices[c];
                const shb_vec3 normal = {(double)n[0], (double)n[1], (double)n[2]};
                unit += fabs(shb_vec3_length(normal) - 1) < 1e-5;
                front += shb_vec3_dot(normal, triangle_normal(mesh, c / 3)) > 0;
            }
            test_check(unit == corners && front >= corners - corners / 50, __FILE__, __LINE__,
                       "%s: mesh %zu: %zu unit, %zu front of %zu", entries[i].name, m, unit, front,
                       corners);
        }
        scene_close(scene);
    }
}

TEST(scene_columns_has_about_twenty_thousand_triangles) {
    example_scene *scene = open_scene("columns");
    CHECK(scene && scene->triangle_count > 15000 && scene->triangle_count < 25000);
    scene_close(scene);
}

TEST(scene_contact_runs_along_a_lit_side_of_its_receiver) {
    for (size_t i = 0; i < sizeof contact_scenes / sizeof *contact_scenes; i++) {
        example_scene *scene = open_scene(contact_scenes[i]);
        for (scene_light_kind kind = SCENE_DIRECTIONAL; scene && kind < SCENE_LIGHT_KINDS; kind++) {
            const scene_light *light = &scene->lights[kind];
            const scene_contact *contact = &light->contact;
            const shb_vec3 to_light = kind == SCENE_SPOT
                                          ? shb_vec3_subtract(light->source, contact->contact)
                                          : light->source;
            CHECK(contact->length > 0);
            CHECK_NEAR(shb_vec3_length(contact->direction), 1, 0);
            CHECK_NEAR(shb_vec3_dot(contact->direction, contact->normal), 0, 0);
            CHECK(shb_vec3_dot(contact->normal, to_light) > 0);
        }
        scene_close(scene);
    }
}

/* Along a contact line's probe the occluder that stands there makes the shadow, and nothing else:
 * light that starts a little above is blocked, light that starts far above is not. */
static void check_probe(const shb_reference *reference, const scene_light *light, bool spot,
                        double share) {
    const scene_contact *contact = &light->contact;
    const shb_vec3 point =
        shb_vec3_add(contact->contact, shb_vec3_scale(contact->direction, share * contact->length));
    const shb_vec3 way = spot ? shb_vec3_subtract(light->source, point) : light->source;
    const shb_vec3 to_light = shb_vec3_normalize(way);
    const double reach = 8 * contact->length;
    const double high = spot ? fmin(reach, 0.9 * shb_vec3_length(way)) : reach;
    const shb_vec3 above = shb_vec3_add(point, shb_vec3_scale(to_light, high));
    const shb_light_source source =
        spot ? (shb_light_source){light->source, 1} : (shb_light_source){to_light, 0};
    const shb_light_source near_source = {shb_vec3_add(point, shb_vec3_scale(to_light, 4)), 1};
    uint8_t below = 0, free = 1;
    CHECK(!shb_reference_occluded(reference, &near_source, 1, &point, NULL, &below) && below);
    CHECK(!shb_reference_occluded(reference, &source, 1, &above, NULL, &free) && !free);
}

TEST(scene_contact_probe_lies_in_the_shadow_of_its_own_occluder) {
    shb_context *context = NULL;
    CHECK(shb_context_create(NULL, &context) == SHB_OK);
    for (size_t i = 0; i < sizeof contact_scenes / sizeof *contact_scenes; i++) {
        example_scene *scene = open_scene(contact_scenes[i]);
        shb_reference *reference = NULL;
        CHECK(shb_reference_create(context, &scene->scene, &reference) == SHB_OK);
        for (scene_light_kind kind = SCENE_DIRECTIONAL; kind < SCENE_LIGHT_KINDS; kind++)
            for (int k = 1; k < 20; k++)
                check_probe(reference, &scene->lights[kind], kind == SCENE_SPOT, 0.05 * k);
        shb_reference_destroy(reference);
        scene_close(scene);
    }
    shb_context_destroy(context);
}

TEST(scene_parameter_changes_the_scene) {
    example_scene *scene = open_scene("tilted-plane:30");
    /* The first instance is turned by 30 degrees about x: row 2 of column 1 is the sine. */
    CHECK(scene && fabs(scene->instances[0].world_from_mesh.m[6] - 0.5) < 1e-12);
    scene_close(scene);
}

static void check_refused(const char *name, const char *sentence) {
    example_scene *scene = NULL;
    CHECK(!scene_open(name, &scene, error, sizeof error));
    CHECK(!scene);
    test_check(strcmp(error, sentence) == 0, __FILE__, __LINE__, "\"%s\", expected \"%s\"", error,
               sentence);
}

TEST(scene_error_names_the_scene_and_the_value) {
    check_refused("box:3", "scene box: takes no parameter");
    check_refused("tilted-plane:90",
                  "scene tilted-plane: the angle in degrees must be 0 to 89.9, not \"90\"");
    check_refused("tilted-plane:nan",
                  "scene tilted-plane: the angle in degrees must be 0 to 89.9, not \"nan\"");
    check_refused("gap:1x",
                  "scene gap: the largest gap in world units must be 0.0001 to 1, not \"1x\"");
    check_refused("gap:",
                  "scene gap: the largest gap in world units must be 0.0001 to 1, not \"\"");
    check_refused("no such scene",
                  "no such scene: No such file or directory, nor a built-in scene");
}

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    CHECK(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* True if every corner of the box lies inside the view, by the definition of clip space. */
static bool sees_box(const shb_view *view, shb_box box) {
    bool inside = true;
    for (int i = 0; i < 8; i++) {
        const double p[4] = {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                             i & 4 ? box.hi.z : box.lo.z, 1};
        double clip[4] = {0, 0, 0, 0};
        for (int row = 0; row < 4; row++)
            for (int column = 0; column < 4; column++)
                clip[row] += view->clip_from_world.m[4 * column + row] * p[column];
        inside &= fabs(clip[0]) <= clip[3] && fabs(clip[1]) <= clip[3] && clip[2] >= 0 &&
                  clip[2] <= clip[3];
    }
    return inside;
}

TEST(scene_of_an_obj_file_is_in_view_of_camera_and_lights) {
    static const char path[] = "test_scenes_temporary.obj";
    static const char *const texts[] = {
        "v -1 0 0\nv 5 0 0\nv 0 0 4\nf 1 2 3\n",
        "v 1000 2000 -1000\nv 1000.5 2000 -1000\nv 1000 2003 -1000.25\nf 1 2 3\n",
        "v 0 0 0\nv 1e-3 0 0\nv 0 2e-3 1e-3\nf 1 2 3\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        write_text(path, texts[i]);
        example_scene *scene = open_scene(path);
        shb_view view;
        if (!scene)
            continue;
        CHECK(scene->instances[0].cull == SHB_CULL_NONE);
        CHECK(scene_camera_view(scene, 400, 300, &view) == SHB_OK &&
              sees_box(&view, scene->bounds));
        for (scene_light_kind kind = SCENE_DIRECTIONAL; kind < SCENE_LIGHT_KINDS; kind++) {
            CHECK(scene_light_view(scene, kind, 256, false, &view) == SHB_OK);
            CHECK(sees_box(&view, scene->bounds));
        }
        scene_close(scene);
    }
    write_text(path, "v 1 1 1\nf 1 1 1\n");
    check_refused(path, "test_scenes_temporary.obj: the mesh has no extent");
    remove(path);
}
