/* From meshes to a picture: a box on the ground under a lamp, with soft shadows, in picture.ppm or
 * the file that is named. */
#include "shadowbias/shadowbias.h"

#include <stdio.h>

enum { width = 640, height = 400 };
static uint32_t ids[height][width];
static uint8_t pixels[height][width][3];

static const float ground_corners[4][3] = {{-20, 0, 20}, {20, 0, 20}, {20, 0, -20}, {-20, 0, -20}};
static const uint16_t ground_indices[2][3] = {{0, 1, 2}, {0, 2, 3}};

static const float box_corners[8][3] = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1},
                                        {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
static const uint16_t box_indices[12][3] = {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6},
                                            {0, 5, 1}, {0, 4, 5}, {1, 6, 2}, {1, 5, 6},
                                            {2, 7, 3}, {2, 6, 7}, {3, 4, 0}, {3, 7, 4}};

static const shb_mesh ground = {.positions = ground_corners[0],
                                .vertex_count = 4,
                                .indices = ground_indices,
                                .index_size = 2,
                                .triangle_count = 2};
static const shb_mesh box = {.positions = box_corners[0],
                             .vertex_count = 8,
                             .indices = box_indices,
                             .index_size = 2,
                             .triangle_count = 12};

/* What the library has to say of a call that fails. */
static void print_failure(void *user, shb_result result, const char *sentence) {
    (void)user;
    (void)result;
    fprintf(stderr, "%s\n", sentence);
}

/* The lamp's map, and what the filter wants to know of it. */
static shb_result draw_map(shb_map *map, const shb_scene *scene, const shb_filter *filter) {
    const shb_result result = shb_map_draw(map, scene, NULL, NULL);
    return result ? result : shb_map_prepare(map, filter);
}

/* What the camera sees, triangle by triangle, and then its colours. */
static shb_result draw_picture(shb_context *context, const shb_view *camera, const shb_scene *scene,
                               const shb_shade_light *lamp) {
    const shb_draw_desc draw = {
        .view = camera, .scene = scene, .width = width, .height = height, .ids = ids[0]};
    const shb_shade_desc shade = {.frame = {camera, scene, width, height, ids[0], 0},
                                  .lights = lamp,
                                  .light_count = 1,
                                  .shade = shb_shade_lambert,
                                  .background = {0.02f, 0.03f, 0.05f},
                                  .image = {pixels[0][0], width, height, 0}};
    const shb_result result = shb_draw(context, &draw, NULL);
    return result ? result : shb_shade(context, &shade);
}

static bool write_picture(const char *path) {
    const shb_image image = {pixels[0][0], width, height, 0};
    const shb_result result = shb_image_write_ppm(&image, path);
    if (result)
        fprintf(stderr, "%s: %s\n", path, shb_result_string(result));
    return !result;
}

int main(int argc, char **argv) {
    if (argc > 2 || (argc == 2 && argv[1][0] == '-')) {
        fprintf(stderr, "usage: picture [FILE.ppm]\n");
        return 2;
    }
    const shb_instance instances[] = {
        {.mesh = &ground},
        {.mesh = &box, .world_from_mesh = shb_mat4_rotation((shb_vec3){0, 1, 0}, 0.5)}};
    const shb_scene scene = {instances, 2};
    const shb_vec3 up = {0, 1, 0}, eye = {3, 4, 7}, lamp_at = {-4, 6, 3}, middle = {0.5, 0.7, 0};
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    const shb_filter filter = shb_filter_pcss(1, 25, 49, SHB_TAPS_PLANE);
    const shb_context_desc context_desc = {.log = print_failure};
    shb_map_desc map_desc = {.width = 1024};
    shb_view camera;
    shb_context *context = NULL;
    shb_map *map = NULL;
    bool done = !shb_view_perspective(eye, middle, up, 0.8, (double)width / height, 0.1, 100, false,
                                      &camera) &&
                !shb_view_perspective(lamp_at, middle, up, 1.6, 1, 1, 20, false, &map_desc.view) &&
                !shb_context_create(&context_desc, &context) &&
                !shb_map_create(context, &map_desc, &map) && !draw_map(map, &scene, &filter);
    const shb_shade_light lamp = {map, &bias, &filter, {1, 0.95f, 0.85f}};
    done = done && !draw_picture(context, &camera, &scene, &lamp);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return done && write_picture(argc > 1 ? argv[1] : "picture.ppm") ? 0 : 1;
}
