/* A renderer of one's own that gets its shadows from libshadowbias. It has neither meshes nor a
 * rasterizer, it casts rays at a ball on the ground; the library sees depths and points, no more.
 */
#include "shadowbias/shadowbias.h"

#include <math.h>
#include <stdio.h>

enum { map_size = 512, picture_size = 200, points_max = picture_size * picture_size };
static float depths[map_size][map_size];
static float points[points_max][3], normals[points_max][3], visibility[points_max];

static const shb_vec3 center = {0, 1, 0}; /* of a ball of radius 1 */
static const shb_vec3 to_light = {0.5, 1, 0.4};

/* Where from + t * direction, t from 0 to 1, meets the ball; 1 if it does not. */
static double meet_ball(shb_vec3 from, shb_vec3 direction) {
    const shb_vec3 off = shb_vec3_subtract(from, center);
    const double a = shb_vec3_dot(direction, direction), b = shb_vec3_dot(off, direction);
    const double root = b * b - a * (shb_vec3_dot(off, off) - 1);
    const double t = root > 0 ? (-b - sqrt(root)) / a : 1;
    return t > 1e-9 && t < 1 ? t : 1;
}

/* The same for the ball and the ground at y = 0. */
static double meet_scene(shb_vec3 from, shb_vec3 direction) {
    const double t = direction.y < 0 ? -from.y / direction.y : 1;
    return fmin(meet_ball(from, direction), t);
}

/* The light's depths: along the ray of each texel from the near plane, depth 0, to the far plane,
 * depth 1. */
static void draw_depths(shb_mat4 world_from_clip) {
    for (int j = 0; j < map_size; j++)
        for (int i = 0; i < map_size; i++) {
            const double x = (2 * i + 1.0) / map_size - 1, y = 1 - (2 * j + 1.0) / map_size;
            const shb_vec3 near = shb_mat4_transform_point(world_from_clip, (shb_vec3){x, y, 0});
            const shb_vec3 far = shb_mat4_transform_point(world_from_clip, (shb_vec3){x, y, 1});
            depths[j][i] = (float)meet_scene(near, shb_vec3_subtract(far, near));
        }
}

static void store(shb_vec3 v, float out[3]) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* The points that the camera sees, and their normals; returns how many there are. */
static size_t trace_picture(void) {
    const shb_vec3 eye = {0, 3, 6};
    size_t count = 0;
    for (int pixel = 0; pixel < points_max; pixel++) {
        const double x = pixel % picture_size * 0.1 - 10, y = -pixel / picture_size * 0.06;
        const shb_vec3 direction = {x, y, -12};
        const double t = meet_scene(eye, direction);
        if (t == 1)
            continue;
        const shb_vec3 p = shb_vec3_add(eye, shb_vec3_scale(direction, t));
        store(p, points[count]);
        store(p.y > 1e-9 ? shb_vec3_subtract(p, center) : (shb_vec3){0, 1, 0}, normals[count]);
        count++;
    }
    return count;
}

/* A ray to the light tells what is true where the surface faces it. */
static void print_errors(size_t count) {
    size_t shadowed = 0, wrong = 0;
    for (size_t i = 0; i < count; i++) {
        const shb_vec3 p = {(double)points[i][0], (double)points[i][1], (double)points[i][2]};
        const shb_vec3 n = {(double)normals[i][0], (double)normals[i][1], (double)normals[i][2]};
        const bool faces = shb_vec3_dot(n, to_light) > 0;
        const bool blocked = meet_ball(p, shb_vec3_scale(to_light, 10)) < 1;
        shadowed += faces && blocked;
        wrong += faces && blocked != (visibility[i] < 0.5f);
    }
    printf("%zu points, %zu in shadow, %zu not as the exact ray says\n", count, shadowed, wrong);
}

int main(void) {
    const shb_box bounds = {{-3, 0, -3}, {3, 2, 3}};
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    shb_map_desc desc = {.width = map_size};
    shb_mat4 world_from_clip;
    shb_context *context = NULL;
    shb_map *map = NULL;
    bool done = !shb_view_fit_directional(to_light, bounds, map_size, false, &desc.view) &&
                !shb_mat4_inverse(desc.view.clip_from_world, &world_from_clip) &&
                !shb_context_create(NULL, &context) &&
                !shb_map_wrap(context, &desc, depths, 0, NULL, &map);
    if (done) {
        draw_depths(world_from_clip); /* the map reads them when it is asked */
        const shb_points traced = {
            .count = trace_picture(), .positions = points[0], .normals = normals[0]};
        done = !shb_map_visibility(map, &traced, &bias, NULL, visibility);
        if (done)
            print_errors(traced.count);
    }
    shb_map_destroy(map);
    shb_context_destroy(context);
    if (!done)
        fprintf(stderr, "own_renderer failed\n");
    return done ? 0 : 1;
}
