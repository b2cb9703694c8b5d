/* A renderer of one's own that gets its shadows from libshadowbias. It has neither meshes nor a
 * rasterizer, it casts rays at a ball on the ground; the library sees depths and points, no more.
 */
#include "shadowbias/shadowbias.h"

#include <math.h>
#include <stdio.h>

enum { map_size = 512, picture_size = 200, points_max = picture_size * picture_size };
static float depths[map_size][map_size], points[points_max][3], normals[points_max][3];
static float visibility[points_max];
static const shb_vec3 center = {0, 1, 0}; /* of a ball of radius 1 */

/* Where, from 0 to 1, the way meets the ball or the ground; 1 if it does not. */
static double cast_ray(shb_vec3 from, shb_vec3 way, bool ball_only) {
    const shb_vec3 out = shb_vec3_subtract(from, center);
    const double a = shb_vec3_dot(way, way), b = shb_vec3_dot(out, way);
    const double root = b * b - a * (shb_vec3_dot(out, out) - 1);
    const double ball = root > 0 ? (-b - sqrt(root)) / a : 1;
    const double ground = !ball_only && way.y < 0 ? -from.y / way.y : 1;
    return fmin(ball > 1e-9 ? ball : 1, ground > 0 ? ground : 1);
}

/* The point whose clip coordinates are x, y and depth. */
static shb_vec3 from_clip(const shb_mat4 *world_from_clip, double x, double y, double depth) {
    return shb_mat4_transform_point(*world_from_clip, (shb_vec3){x, y, depth});
}

static void draw_depths(const shb_mat4 *world_from_clip) {
    for (int j = 0; j < map_size; j++)
        for (int i = 0; i < map_size; i++) {
            const double x = (2 * i + 1.0) / map_size - 1, y = 1 - (2 * j + 1.0) / map_size;
            const shb_vec3 near = from_clip(world_from_clip, x, y, 0);
            const shb_vec3 far = from_clip(world_from_clip, x, y, 1);
            depths[j][i] = (float)cast_ray(near, shb_vec3_subtract(far, near), false);
        }
}

static size_t trace_picture(void) {
    size_t count = 0;
    for (int pixel = 0; pixel < points_max; pixel++) {
        const shb_vec3 eye = {0, 3, 6};
        const shb_vec3 way = {pixel % picture_size * 0.1 - 10, -pixel / picture_size * 0.06, -12};
        const double t = cast_ray(eye, way, false);
        const shb_vec3 p = shb_vec3_add(eye, shb_vec3_scale(way, t));
        const shb_vec3 n = p.y > 1e-9 ? shb_vec3_subtract(p, center) : (shb_vec3){0, 1, 0};
        if (t == 1)
            continue;
        for (int k = 0; k < 3; k++) {
            points[count][k] = (float)(k == 0 ? p.x : k == 1 ? p.y : p.z);
            normals[count][k] = (float)(k == 0 ? n.x : k == 1 ? n.y : n.z);
        }
        count++;
    }
    return count;
}

int main(void) {
    const shb_vec3 to_light = {0.5, 1, 0.4};
    const shb_box bounds = {{-3, 0, -3}, {3, 2, 3}};
    const shb_bias bias = shb_bias_adaptive(1e-4f, 0);
    shb_map_desc desc = {.width = map_size};
    shb_mat4 world_from_clip;
    shb_context *context = NULL;
    shb_map *map = NULL;
    if (shb_view_fit_directional(to_light, bounds, map_size, false, &desc.view) ||
        shb_mat4_inverse(desc.view.clip_from_world, &world_from_clip) ||
        shb_context_create(NULL, &context) || shb_map_wrap(context, &desc, depths, 0, NULL, &map))
        return 1;
    draw_depths(&world_from_clip);
    const shb_points traced = {
        .count = trace_picture(), .positions = points[0], .normals = normals[0]};
    if (shb_map_visibility(map, &traced, &bias, NULL, visibility)) {
        fprintf(stderr, "own_renderer: no visibility\n");
        return 1;
    }
    size_t shadowed = 0, wrong = 0;
    for (size_t i = 0; i < traced.count; i++) {
        const shb_vec3 p = {(double)points[i][0], (double)points[i][1], (double)points[i][2]};
        const bool faces = p.y < 1e-6 || shb_vec3_dot(shb_vec3_subtract(p, center), to_light) > 0;
        const bool blocked = cast_ray(p, shb_vec3_scale(to_light, 10), true) < 1;
        shadowed += faces && blocked;
        wrong += faces && blocked != (visibility[i] < 0.5f);
    }
    printf("%zu points, %zu in shadow, %zu not as the exact ray says\n", traced.count, shadowed,
           wrong);
    shb_map_destroy(map);
    shb_context_destroy(context);
    return 0;
}
