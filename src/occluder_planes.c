/* The plane of a triangle, from its corners in world units and the slope formula of light_point.h:
 * differences of corners lose nothing far from the origin, and triangles that reach behind the
 * light need no clipping. */
#include "strict.h"

#include "occluder_planes.h"

#include "light_point.h"
#include "scene.h"

#define TRIANGLES_PER_TASK 4096

typedef struct plane_job {
    const shb_map *map;
    const shb_scene *scene;
    size_t count;
    shb_occluder_plane *planes;
} plane_job;

static const shb_occluder_plane unusable = {0, 0, 0, HUGE_VAL};

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++)
        out[i] = a[i] - b[i];
}

/* The normal by winding and what its elements may be off by: differences and products are rounded,
 * and so are corners that a transform has moved. */
static void normal_of(const double corners[3][3], double normal[3], double error[3]) {
    double first[3], second[3];
    subtract(corners[1], corners[0], first);
    subtract(corners[2], corners[0], second);
    shb_cross(first, second, normal);
    const double e = SHB_DOUBLE_ROUNDING;
    const double size =
        (shb_sum_abs(corners[0]) + shb_sum_abs(corners[1])) + shb_sum_abs(corners[2]);
    const double moved = 4 * e * size * (shb_sum_abs(first) + shb_sum_abs(second));
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        error[i] = 8 * e * (fabs(first[j] * second[k]) + fabs(first[k] * second[j])) + moved;
    }
}

/* How far the map's texels near the triangle can lie from the anchor, on an axis. */
static double reach_of(double anchor, double a, double b, double c, double size, bool behind) {
    double reach = fabs(a - anchor);
    reach = fabs(b - anchor) > reach ? fabs(b - anchor) : reach;
    reach = fabs(c - anchor) > reach ? fabs(c - anchor) : reach;
    const double whole = fabs(anchor) + size;
    return (behind || !(reach < whole) ? whole : reach) + 1;
}

/* Anchored at the corner farthest from the light, which lies in front of it if anything does. */
static shb_occluder_plane plane_of(const shb_map *map, const double corners[3][3]) {
    shb_light_point points[3];
    int anchor = 0;
    bool behind = false;
    for (int k = 0; k < 3; k++) {
        points[k] = shb_light_point_at(&map->rows, corners[k], 0);
        behind |= !(points[k].w > 0);
        anchor = points[k].w > points[anchor].w ? k : anchor;
    }
    const shb_light_point *point = &points[anchor];
    double normal[3], normal_error[3];
    normal_of(corners, normal, normal_error);
    const shb_light_slopes slopes = shb_light_slopes_of(&map->rows, point, normal, normal_error);
    const double width = map->info.width, height = map->info.height;
    const double reach_x = reach_of(point->x, points[0].x, points[1].x, points[2].x, width, behind);
    const double reach_y =
        reach_of(point->y, points[0].y, points[1].y, points[2].y, height, behind);
    const double to_origin = fabs(point->z) + fabs(slopes.x) * (fabs(point->x) + width) +
                             fabs(slopes.y) * (fabs(point->y) + height);
    const double error = (2 * shb_light_point_error(point, slopes.x, slopes.y) +
                          (slopes.error_x * reach_x + slopes.error_y * reach_y)) +
                         8 * SHB_DOUBLE_ROUNDING * to_origin;
    if (!(point->w > 0 && error <= 1))
        return unusable;
    return (shb_occluder_plane){(point->z - slopes.x * point->x) - slopes.y * point->y, slopes.x,
                                slopes.y, error};
}

static void read_corners(const shb_mesh *mesh, const shb_mat4 *transform, uint32_t triangle,
                         double corners[3][3]) {
    uint32_t vertices[3];
    shb_mesh_triangle(mesh, triangle, vertices);
    for (int k = 0; k < 3; k++) {
        const float *p = shb_mesh_position(mesh, vertices[k]);
        const shb_vec3 corner = shb_mat4_transform_point(
            *transform, (shb_vec3){(double)p[0], (double)p[1], (double)p[2]});
        corners[k][0] = corner.x;
        corners[k][1] = corner.y;
        corners[k][2] = corner.z;
    }
}

static void make_block(void *arg, size_t index) {
    const plane_job *job = arg;
    size_t id = index * TRIANGLES_PER_TASK;
    const size_t end = job->count - id < TRIANGLES_PER_TASK ? job->count : id + TRIANGLES_PER_TASK;
    while (id < end) {
        uint32_t first;
        const shb_instance *instance =
            &job->scene->instances[shb_scene_instance_of(job->scene, (uint32_t)id, &first)];
        const shb_mat4 transform = shb_instance_transform(instance);
        const size_t instance_end = (size_t)first + instance->mesh->triangle_count;
        for (; id < end && id < instance_end; id++) {
            double corners[3][3];
            read_corners(instance->mesh, &transform, (uint32_t)id - first, corners);
            job->planes[id] = plane_of(job->map, (const double(*)[3])corners);
        }
    }
}

void shb_occluder_planes_make(const shb_map *map, const shb_scene *scene, size_t count,
                              shb_occluder_plane *planes) {
    plane_job job = {map, scene, count, planes};
    shb_parallel_for(map->context, make_block, &job,
                     (count + TRIANGLES_PER_TASK - 1) / TRIANGLES_PER_TASK);
}
