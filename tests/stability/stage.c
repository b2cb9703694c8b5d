#include "stage.h"

#include "obj.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static const double pi = 3.14159265358979323846;

bool stability_case_exists(const stability_case *c) {
    return !c->file || access(c->file, R_OK) == 0;
}

static shb_mat4 turn_of(const stability_case *c) {
    return c->aligned ? shb_mat4_identity() : shb_mat4_rotation((shb_vec3){1, 2, 3}, 0.7);
}

static shb_mat4 placement_of(const stability_case *c) {
    const double scale = c->scale > 0 ? c->scale : 1, moved = c->moved;
    const shb_mat4 place = shb_mat4_translation(0.6 * moved, 0.48 * moved, 0.64 * moved);
    return shb_mat4_multiply(place,
                             shb_mat4_multiply(shb_mat4_scaling(scale, scale, scale), turn_of(c)));
}

static void place_mesh(owned_mesh *mesh, shb_mat4 placement) {
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        float *p = mesh->positions + 3 * (size_t)i;
        const shb_vec3 built = {(double)p[0], (double)p[1], (double)p[2]};
        const shb_vec3 placed = shb_mat4_transform_point(placement, built);
        p[0] = (float)placed.x;
        p[1] = (float)placed.y;
        p[2] = (float)placed.z;
    }
}

static shb_result build_meshes(const stability_case *c, owned_mesh *seen, owned_mesh *unseen) {
    char error[256];
    if (!c->file)
        c->build(seen, unseen, c->value);
    else if (!obj_read_file(c->file, seen, error, sizeof error))
        return SHB_ERROR_FILE;
    if (seen->failed || unseen->failed)
        return SHB_ERROR_MEMORY;
    place_mesh(seen, placement_of(c));
    place_mesh(unseen, placement_of(c));
    return SHB_OK;
}

static shb_result build_scene(const stability_case *c, example_scene *scene) {
    static const scene_surface surface = {.color = {1, 1, 1}};
    owned_mesh *seen = scene_add_mesh(scene), *unseen = scene_add_mesh(scene);
    const shb_result result = build_meshes(c, seen, unseen);
    if (result)
        return result;
    scene->views[0] = owned_mesh_view(seen);
    scene->views[1] = owned_mesh_view(unseen);
    const shb_cull cull = c->closed ? SHB_CULL_BACK : SHB_CULL_NONE;
    scene_add_instance(scene, seen, NULL, cull, &surface);
    if (unseen->triangle_count)
        scene_add_instance(scene, unseen, NULL, cull, &surface);
    scene->scene.instances = scene->instances;
    scene->triangle_count = shb_scene_triangle_count(&scene->scene);
    return shb_scene_bounds(&scene->scene, &scene->bounds);
}

static shb_vec3 middle_of(shb_box box) {
    return shb_vec3_scale(shb_vec3_add(box.lo, box.hi), 0.5);
}

static double diagonal_of(shb_box box) {
    return shb_vec3_length(shb_vec3_subtract(box.hi, box.lo));
}

/* So close that the corners of the box may be cut off; aside of the light, whose shadows would hide
 * behind their objects otherwise. */
static void place_camera(const stability_case *c, example_scene *scene) {
    const shb_vec3 middle = middle_of(scene->bounds);
    const shb_vec3 to_eye =
        shb_vec3_normalize(shb_mat4_transform_point(turn_of(c), (shb_vec3){-0.7, 0.8, 0.7}));
    scene->camera.vertical_angle = 0.6;
    scene_move_camera(
        scene, shb_vec3_add(middle, shb_vec3_scale(to_eye, 1.3 * diagonal_of(scene->bounds))),
        middle);
}

static shb_vec3 direction_to_light(const stability_case *c) {
    const double height = (c->sun_height > 0 ? c->sun_height : 50) * pi / 180;
    return shb_mat4_transform_point(turn_of(c),
                                    (shb_vec3){0.8 * cos(height), sin(height), 0.6 * cos(height)});
}

/* The far distance lies behind the scene; the near one follows from the ratio. */
static shb_result light_of(const stability_case *c, shb_box bounds, uint32_t map_size,
                           shb_view *view) {
    const shb_vec3 to_light = direction_to_light(c), middle = middle_of(bounds);
    if (!(c->spot_distance > 0))
        return shb_view_fit_directional(to_light, bounds, map_size, c->reversed, view);
    const double diagonal = diagonal_of(bounds), distance = c->spot_distance * diagonal;
    const shb_vec3 position = shb_vec3_add(middle, shb_vec3_scale(to_light, distance));
    if (!(c->far_to_near > 0))
        return shb_view_fit_spot(position, bounds, map_size, c->reversed, view);
    const double angle = 2 * asin(diagonal / 2 / distance);
    const double far_distance = distance + 0.55 * diagonal;
    return shb_view_perspective(position, middle, (shb_vec3){0, 1, 0}, angle, 1,
                                far_distance / c->far_to_near, far_distance, c->reversed, view);
}

/* The frame of what is seen, which then stands for the whole scene: what is seen comes first, so
 * the ids are the same. */
static shb_result open_frame(stability_stage *stage, uint32_t width, uint32_t height) {
    shb_scene *scene = &stage->scene->scene;
    const size_t instance_count = scene->instance_count;
    scene->instance_count = 1;
    const shb_result result =
        measure_frame_create(stage->context, stage->scene, width, height, &stage->frame);
    scene->instance_count = instance_count;
    return result;
}

/* A boundary is near within a texel, so the texels of the map for that are as large as the reach.
 */
static shb_result classify_pixels(stability_stage *stage, const shb_reference *reference,
                                  uint32_t reach, uint8_t *pixels) {
    shb_map *map = NULL;
    shb_map_desc desc = stage->map;
    desc.width = desc.width > reach ? desc.width / reach : 1;
    shb_result result = shb_map_create(stage->context, &desc, &map);
    const shb_classify_desc classify = {
        .frame = stage->frame.frame, .map = map, .min_cosine = STABILITY_MIN_COSINE};
    if (!result)
        result = shb_reference_classify(reference, &classify, pixels);
    shb_map_destroy(map);
    return result;
}

static shb_result find_truth(stability_stage *stage, uint32_t reach) {
    const measure_frame *frame = &stage->frame;
    shb_reference *reference = NULL;
    uint8_t *pixels = malloc((size_t)frame->frame.width * frame->frame.height);
    stage->truth = malloc(frame->fragment_count + 1);
    shb_result result = pixels && stage->truth ? SHB_OK : SHB_ERROR_MEMORY;
    if (!result)
        result = shb_reference_create(stage->context, &stage->scene->scene, &reference);
    if (!result)
        result = classify_pixels(stage, reference, reach, pixels);
    if (!result)
        for (size_t i = 0; i < frame->fragment_count; i++)
            stage->truth[i] = pixels[frame->pixels[i]];
    shb_reference_destroy(reference);
    free(pixels);
    return result;
}

/* Where the library puts a point of a triangle: from its first corner on. */
static shb_vec3 named_point(const owned_mesh *mesh, uint32_t id, float weight_1, float weight_2) {
    const uint32_t *corners = mesh->indices + 3 * (size_t)id;
    double point[3];
    for (size_t i = 0; i < 3; i++) {
        const double a = (double)mesh->positions[3 * (size_t)corners[0] + i];
        const double b = (double)mesh->positions[3 * (size_t)corners[1] + i];
        const double c = (double)mesh->positions[3 * (size_t)corners[2] + i];
        point[i] = a + ((b - a) * (double)weight_1 + (c - a) * (double)weight_2);
    }
    return (shb_vec3){point[0], point[1], point[2]};
}

/* Rays to the light from the named points of all fragments. */
static shb_result cast_rays(const stability_stage *stage, shb_vec3 *points, uint8_t *occluded) {
    const measure_frame *frame = &stage->frame;
    for (size_t i = 0; i < frame->fragment_count; i++)
        points[i] = named_point(&stage->scene->meshes[0], frame->own_ids[i], frame->weights_1[i],
                                frame->weights_2[i]);
    shb_light_source light;
    shb_reference *reference = NULL;
    shb_result result = shb_view_light_source(&stage->map.view, &light);
    if (!result)
        result = shb_reference_create(stage->context, &stage->scene->scene, &reference);
    if (!result)
        result = shb_reference_occluded(reference, &light, frame->fragment_count, points,
                                        frame->own_ids, occluded);
    shb_reference_destroy(reference);
    return result;
}

shb_result stability_name_points(stability_stage *stage) {
    const size_t count = stage->frame.fragment_count;
    shb_vec3 *points = malloc((count + 1) * sizeof *points);
    uint8_t *occluded = malloc(count + 1);
    const shb_result result =
        points && occluded ? cast_rays(stage, points, occluded) : SHB_ERROR_MEMORY;
    for (size_t i = 0; i < count && !result; i++)
        if (stage->truth[i] != SHB_TRUTH_NONE)
            stage->truth[i] = (uint8_t)((stage->truth[i] & SHB_TRUTH_BOUNDARY) |
                                        (occluded[i] ? SHB_TRUTH_SHADOWED : SHB_TRUTH_LIT));
    free(points);
    free(occluded);
    if (!result)
        stage->points = measure_points(&stage->frame);
    return result;
}

shb_result stability_stage_open(shb_context *context, const stability_case *c, uint32_t width,
                                uint32_t height, uint32_t map_size, uint32_t reach,
                                stability_stage *stage) {
    if (c->map_size)
        map_size = c->map_size;
    else if (!map_size)
        map_size = STABILITY_MAP_SIZE;
    *stage = (stability_stage){.context = context,
                               .scene = calloc(1, sizeof *stage->scene),
                               .map = {.width = map_size, .format = c->format}};
    shb_result result = stage->scene ? build_scene(c, stage->scene) : SHB_ERROR_MEMORY;
    if (!result)
        result = light_of(c, stage->scene->bounds, map_size, &stage->map.view);
    if (!result) {
        place_camera(c, stage->scene);
        result = open_frame(stage, width, height);
    }
    if (!result)
        result = find_truth(stage, reach);
    if (result)
        stability_stage_close(stage);
    else
        stage->points = measure_positions(&stage->frame);
    return result;
}

void stability_stage_close(stability_stage *stage) {
    measure_frame_destroy(&stage->frame);
    for (size_t i = 0; stage->scene && i < stage->scene->mesh_count; i++)
        owned_mesh_free(&stage->scene->meshes[i]);
    free(stage->scene);
    free(stage->truth);
    *stage = (stability_stage){0};
}

shb_result stability_draw_map(const stability_stage *stage, const listed_method *method,
                              const shb_bias *bias, shb_map **map) {
    shb_map *drawn = NULL;
    shb_map_desc desc = stage->map;
    desc.occluders = method->occluders;
    shb_result result = shb_map_create(stage->context, &desc, &drawn);
    if (!result)
        result = shb_map_draw(drawn, &stage->scene->scene, bias, NULL);
    if (result)
        shb_map_destroy(drawn);
    else
        *map = drawn;
    return result;
}

static void add_answer(uint8_t truth, uint8_t answer, stability_certain *certain) {
    const bool lit = truth & SHB_TRUTH_LIT, shadowed = truth & SHB_TRUTH_SHADOWED;
    certain->fragments += lit || shadowed;
    certain->unsure += (lit || shadowed) && answer == SHB_LIGHT_UNSURE;
    certain->false_shadow += lit && answer == SHB_LIGHT_SHADOWED;
    certain->false_light += shadowed && answer == SHB_LIGHT_LIT;
}

shb_result stability_ask_certain(const stability_stage *stage, stability_certain *certain) {
    const measure_frame *frame = &stage->frame;
    uint8_t *answers = malloc(frame->fragment_count + 1);
    shb_map *map = NULL;
    shb_map_desc desc = stage->map;
    desc.classifies = true;
    shb_result result = answers ? shb_map_create(stage->context, &desc, &map) : SHB_ERROR_MEMORY;
    if (!result)
        result = shb_map_draw(map, &stage->scene->scene, NULL, NULL);
    if (!result)
        result = shb_map_classify(map, &stage->points, answers);
    if (!result)
        for (size_t i = 0; i < frame->fragment_count; i++)
            add_answer(stage->truth[i], answers[i], certain);
    shb_map_destroy(map);
    free(answers);
    return result;
}
