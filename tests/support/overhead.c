#include "overhead.h"

#include <stdlib.h>

#include "contexts.h"
#include "test.h"

enum { WIDTH = 160, HEIGHT = 120 };

static void take_mesh(example_scene *scene, owned_mesh *mesh) {
    const scene_surface white = {.color = {1, 1, 1}};
    owned_mesh *kept = scene_add_mesh(scene);
    *kept = *mesh;
    *mesh = (owned_mesh){0};
    scene->views[kept - scene->meshes] = owned_mesh_view(kept);
    scene_add_instance(scene, kept, NULL, SHB_CULL_NONE, &white);
    scene->scene.instances = scene->instances;
}

void overhead_open(overhead *o, owned_mesh *seen, owned_mesh *unseen, uint32_t map_size) {
    *o = (overhead){.scene = calloc(1, sizeof *o->scene), .map = {.width = map_size}};
    o->context = test_context(2, SHB_ISA_BEST);
    take_mesh(o->scene, seen);
    CHECK_INT(shb_scene_bounds(&o->scene->scene, &o->scene->bounds), SHB_OK);
    o->scene->camera.vertical_angle = 0.27;
    scene_move_camera(o->scene, (shb_vec3){0.31, 7, 0.17}, (shb_vec3){0.013, 0, 0.007});
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 4, 0}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 0, -1},
                                    1, 1, 2, 2 + OVERHEAD_RANGE, false, &o->map.view),
              SHB_OK);
    CHECK_INT(measure_frame_create(o->context, o->scene, WIDTH, HEIGHT, &o->frame), SHB_OK);
    if (unseen)
        take_mesh(o->scene, unseen);
    o->scene->triangle_count = shb_scene_triangle_count(&o->scene->scene);
}

void overhead_close(overhead *o) {
    measure_frame_destroy(&o->frame);
    for (size_t i = 0; i < o->scene->mesh_count; i++)
        owned_mesh_free(&o->scene->meshes[i]);
    free(o->scene);
    shb_context_destroy(o->context);
}

double overhead_texel(const overhead *o) {
    return 2.0 / o->map.width;
}
