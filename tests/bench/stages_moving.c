/* Maps of a scene whose vertices have moved since the drawing before: what they keep of the scene
 * is made anew each time. */
#include "stages.h"

#include "shadowbias/map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAP_SIZE 2048

/* Vertices move by up to so much of the diagonal of the scene's box. */
#define AMPLITUDE 0.002

typedef struct moving_kind {
    const char *name;
    shb_occluders occluders;
} moving_kind;

static const moving_kind kinds[] = {{"moving, depth", SHB_OCCLUDERS_NONE},
                                    {"moving, planes", SHB_OCCLUDERS_PLANES},
                                    {"moving, triangles", SHB_OCCLUDERS_TRIANGLES},
                                    {"moving, lists", SHB_OCCLUDERS_LISTS}};

/* A scene as it is and with all its vertices moved. */
typedef struct moving_scene {
    size_t instance_count, mesh_count;
    shb_mesh meshes[2][SCENE_MESHES_MAX];
    shb_instance instances[2][SCENE_INSTANCES_MAX];
    float *moved[SCENE_MESHES_MAX]; /* positions */
} moving_scene;

static void destroy_scene(moving_scene *moving) {
    for (size_t i = 0; moving && i < moving->mesh_count; i++)
        free(moving->moved[i]);
    free(moving);
}

/* Up and down, as waves. NULL: out of memory. */
static float *move_vertices(const shb_mesh *mesh, double diagonal) {
    const size_t stride = mesh->position_stride ? mesh->position_stride : 3 * sizeof(float);
    float *moved = malloc((mesh->vertex_count + (size_t)1) * 3 * sizeof *moved);
    for (size_t i = 0; moved && i < mesh->vertex_count; i++) {
        float *p = moved + 3 * i;
        memcpy(p, (const char *)mesh->positions + i * stride, 3 * sizeof *p);
        const double x = (double)p[0], z = (double)p[2], phase = (2 * x + 3 * z) * 5 / diagonal;
        p[1] += (float)(AMPLITUDE * diagonal * sin(phase));
    }
    return moved;
}

/* Without clusters, which would have to be made anew. NULL: out of memory. */
static moving_scene *create_scene(const example_scene *scene) {
    const double diagonal = shb_vec3_length(shb_vec3_subtract(scene->bounds.hi, scene->bounds.lo));
    moving_scene *moving = calloc(1, sizeof *moving);
    if (!moving)
        return NULL;
    moving->mesh_count = scene->mesh_count;
    moving->instance_count = scene->scene.instance_count;
    for (size_t i = 0; i < scene->mesh_count; i++) {
        shb_mesh *as_is = &moving->meshes[0][i], *moved = &moving->meshes[1][i];
        *as_is = scene->views[i];
        as_is->clusters = NULL;
        *moved = *as_is;
        moving->moved[i] = move_vertices(as_is, diagonal);
        if (!moving->moved[i]) {
            destroy_scene(moving);
            return NULL;
        }
        moved->positions = moving->moved[i];
        moved->position_stride = 0;
    }
    for (int pose = 0; pose < 2; pose++)
        for (size_t i = 0; i < moving->instance_count; i++) {
            shb_instance *instance = &moving->instances[pose][i];
            *instance = scene->scene.instances[i];
            instance->mesh = &moving->meshes[pose][instance->mesh - scene->views];
        }
    return moving;
}

typedef struct moving_work {
    const moving_scene *scene;
    shb_map *map;
    int pose; /* drawn last */
} moving_work;

static shb_result draw_other_pose(void *state) {
    moving_work *work = state;
    work->pose = 1 - work->pose;
    const shb_scene scene = {work->scene->instances[work->pose], work->scene->instance_count};
    return shb_map_draw(work->map, &scene, NULL, NULL);
}

static bool time_kind(bench_session *session, const moving_kind *kind, const example_scene *scene,
                      const moving_scene *moving, uint32_t size, const char *title) {
    shb_map_desc desc = {.width = size,
                         .occluders = kind->occluders,
                         .exact_only = kind->occluders == SHB_OCCLUDERS_LISTS};
    moving_work work = {.scene = moving};
    bench_row row = {.triangles = scene->triangle_count,
                     .size = size,
                     .items = (double)scene->triangle_count,
                     .texels = (double)size * size};
    row.bytes = row.texels * sizeof(float);
    row.limit_seconds = machine_store_seconds(&session->machine, row.bytes);
    snprintf(row.stage, sizeof row.stage, "%s", kind->name);
    snprintf(row.scene, sizeof row.scene, "%s", title);
    if (!session_succeeds(title,
                          scene_light_view(scene, SCENE_DIRECTIONAL, size, false, &desc.view)) ||
        !session_succeeds(title, shb_map_create(session->context, &desc, &work.map)))
        return false;
    const bool done =
        stages_measure(session, (bench_work){draw_other_pose, &work}, (bench_work){0}, &row);
    shb_map_destroy(work.map);
    return done;
}

bool stages_moving(bench_session *session, const example_scene *scene, const char *title) {
    const uint32_t size = session->options.size ? session->options.size : MAP_SIZE;
    if (!options_want(&session->options, "moving", NULL))
        return true;
    moving_scene *moving = create_scene(scene);
    bool done = session_succeeds(title, moving ? SHB_OK : SHB_ERROR_MEMORY);
    progress_step(&session->progress, title);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds && done; i++)
        done = time_kind(session, &kinds[i], scene, moving, size, title);
    destroy_scene(moving);
    return done;
}
