/* Weights from homogeneous coordinates (Olano and Greer 1997). The corners' clip vectors c_k = (x,
 * y, w) are the columns of a matrix A; a point with weights b lies at A b, which is (ndc x, ndc y,
 * 1) up to its w. So b is the inverse of A times (ndc x, ndc y, 1) up to a factor, and the rows of
 * the inverse are, up to the determinant, the cross products of the other two corners. Nothing is
 * divided by a corner's w, so corners behind the camera do no harm.
 *
 * c_1 x c_2 is computed as c_1 x (c_2 - c_1) with the edge transformed as a direction: products of
 * the distance to the camera with the length of an edge, not of two distances, and no translation
 * in the edge. The weights are then as good as the position of the camera relative to the triangle.
 */
#include "strict.h"

#include "surface.h"

#include "scene.h"

/* Rows x, y and w of a matrix times (v, v_w). */
static shb_vec3 clip_xyw(const shb_mat4 *a, shb_vec3 v, double v_w) {
    const double *m = a->m;
    return (shb_vec3){m[0] * v.x + m[4] * v.y + m[8] * v.z + m[12] * v_w,
                      m[1] * v.x + m[5] * v.y + m[9] * v.z + m[13] * v_w,
                      m[3] * v.x + m[7] * v.y + m[11] * v.z + m[15] * v_w};
}

static shb_vec3 transform_normal(const shb_vec3 columns[3], shb_vec3 n) {
    return (shb_vec3){columns[0].x * n.x + columns[1].x * n.y + columns[2].x * n.z,
                      columns[0].y * n.x + columns[1].y * n.y + columns[2].y * n.z,
                      columns[0].z * n.x + columns[1].z * n.y + columns[2].z * n.z};
}

static shb_vec3 front_normal(const shb_vec3 corners[3], bool mirrors) {
    const shb_vec3 cross =
        vec3_cross(vec3_subtract(corners[1], corners[0]), vec3_subtract(corners[2], corners[0]));
    const shb_vec3 normal = vec3_normalize(vec3_scale(cross, mirrors ? -1 : 1));
    return vec3_is_finite(normal) ? normal : (shb_vec3){0};
}

static void prepare_weights(const shb_view *camera, shb_surface_triangle *triangle) {
    const shb_mat4 *matrix = &camera->clip_from_world;
    for (int k = 0; k < 3; k++)
        triangle->clip[k] = clip_xyw(matrix, triangle->corners[k], 1);
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const shb_vec3 edge = vec3_subtract(triangle->corners[b], triangle->corners[a]);
        triangle->cofactors[k] = vec3_cross(triangle->clip[a], clip_xyw(matrix, edge, 0));
    }
    /* Points in front of the camera get the sign of the determinant: make it positive. */
    if (vec3_dot(triangle->clip[0], triangle->cofactors[0]) < 0)
        for (int k = 0; k < 3; k++)
            triangle->cofactors[k] = vec3_scale(triangle->cofactors[k], -1);
}

/* Without normals a sum of zeros leads to the triangle's own. */
static void prepare_shading(const shb_surface_instance *instance, const uint32_t vertices[3],
                            shb_surface_triangle *triangle) {
    const shb_mesh *mesh = instance->mesh;
    for (int k = 0; k < 3; k++)
        triangle->shading[k] =
            mesh->normals ? transform_normal(instance->normal_columns,
                                             vec3_from_floats(shb_mesh_normal(mesh, vertices[k])))
                          : (shb_vec3){0};
}

/* Columns of the matrix that takes the outward side of a surface through a transform: its inverse
 * transpose, up to a positive factor, which is its cofactors with the sign of its determinant. */
static void normal_columns(const shb_mat4 *a, bool mirrors, shb_vec3 columns[3]) {
    const double sign = mirrors ? -1 : 1;
    const shb_vec3 x = {a->m[0], a->m[1], a->m[2]};
    const shb_vec3 y = {a->m[4], a->m[5], a->m[6]};
    const shb_vec3 z = {a->m[8], a->m[9], a->m[10]};
    columns[0] = vec3_scale(vec3_cross(y, z), sign);
    columns[1] = vec3_scale(vec3_cross(z, x), sign);
    columns[2] = vec3_scale(vec3_cross(x, y), sign);
}

bool shb_surface_find_instance(const shb_scene *scene, uint32_t id, shb_surface_instance *found) {
    const size_t number = shb_scene_instance_of(scene, id, &found->first_id);
    if (number == scene->instance_count)
        return false;
    const shb_instance *instance = &scene->instances[number];
    found->mesh = instance->mesh;
    found->transform = shb_instance_transform(instance);
    found->mirrors = shb_transform_mirrors(&found->transform);
    normal_columns(&found->transform, found->mirrors, found->normal_columns);
    return true;
}

bool shb_surface_prepare_of(const shb_surface_instance *instance, const shb_view *camera,
                            uint32_t id, shb_surface_triangle *triangle) {
    const shb_mesh *mesh = instance->mesh;
    uint32_t vertices[3];
    shb_vec3 corners[3];
    shb_mesh_triangle(mesh, id - instance->first_id, vertices);
    for (int k = 0; k < 3; k++) {
        if (vertices[k] >= mesh->vertex_count)
            return false;
        corners[k] = mat4_transform_point(&instance->transform, shb_mesh_point(mesh, vertices[k]));
        if (!vec3_is_finite(corners[k]))
            return false;
    }
    triangle->id = id;
    for (int k = 0; k < 3; k++)
        triangle->corners[k] = corners[k];
    triangle->normal = front_normal(triangle->corners, instance->mirrors);
    prepare_weights(camera, triangle);
    prepare_shading(instance, vertices, triangle);
    return true;
}

bool shb_surface_prepare(const shb_scene *scene, const shb_view *camera, uint32_t id,
                         shb_surface_triangle *triangle) {
    shb_surface_instance instance;
    return shb_surface_find_instance(scene, id, &instance) &&
           shb_surface_prepare_of(&instance, camera, id, triangle);
}

/* The nearest of the points seen so far to a pixel's centre, on the screen. */
typedef struct nearest_point {
    shb_vec3 center;      /* ndc x, ndc y, 1 */
    double width, height; /* of the screen in pixels */
    double distance;      /* squared, in half pixels */
    double weights[3];
} nearest_point;

/* The way on the screen from the centre to a clip position, in half pixels times the position's w.
 */
static shb_vec3 from_center(const nearest_point *nearest, shb_vec3 clip) {
    return (shb_vec3){(clip.x - nearest->center.x * clip.z) * nearest->width,
                      (clip.y - nearest->center.y * clip.z) * nearest->height, clip.z};
}

/* Considers the point of the edge a, b with weight t at b. */
static void consider_point(nearest_point *nearest, const shb_vec3 clip[3], int a, int b, double t) {
    const shb_vec3 edge = vec3_subtract(clip[b], clip[a]);
    const shb_vec3 way = from_center(nearest, vec3_add(clip[a], vec3_scale(edge, t)));
    if (!(way.z > 0))
        return;
    const double distance = (way.x * way.x + way.y * way.y) / (way.z * way.z);
    if (!(distance < nearest->distance))
        return;
    nearest->distance = distance;
    nearest->weights[0] = nearest->weights[1] = nearest->weights[2] = 0;
    nearest->weights[a] = 1 - t;
    nearest->weights[b] = t;
}

/* Considers the foot of the centre on the edge a, b: the way to it is at right angles to the edge's
 * line on the screen, which is linear in the weight. */
static void consider_foot(nearest_point *nearest, const shb_surface_triangle *triangle, int a,
                          int b, shb_vec3 line) {
    const shb_vec3 way_a = from_center(nearest, triangle->clip[a]);
    const shb_vec3 way_b = from_center(nearest, triangle->clip[b]);
    const double along_x = -line.y * nearest->width, along_y = line.x * nearest->height;
    const double along_a = way_a.x * along_x + way_a.y * along_y;
    const double along_b = way_b.x * along_x + way_b.y * along_y;
    const double t = along_a / (along_a - along_b);
    if (t > 0 && t < 1)
        consider_point(nearest, triangle->clip, a, b, t);
}

/* Snapping moves corners by up to 1/512 pixel, so a pixel's centre may lie just outside. Clamping
 * the weights instead would move the point far along a sliver. */
static void nearest_weights(const shb_surface_triangle *triangle, shb_vec3 center, uint32_t width,
                            uint32_t height, double weights[3]) {
    nearest_point nearest = {center, width, height, HUGE_VAL, {1, 0, 0}};
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        consider_point(&nearest, triangle->clip, a, b, 0);
        consider_foot(&nearest, triangle, a, b, triangle->cofactors[k]);
    }
    for (int k = 0; k < 3; k++)
        weights[k] = nearest.weights[k];
}

void shb_surface_weights(const shb_surface_triangle *triangle, uint32_t width, uint32_t height,
                         uint32_t column, uint32_t row, double weights[3]) {
    const shb_vec3 center = {(2.0 * column + 1 - width) / width, (height - 2.0 * row - 1) / height,
                             1};
    for (int k = 0; k < 3; k++) {
        const shb_vec3 *line = &triangle->cofactors[k];
        weights[k] = line->x * center.x + line->y * center.y + line->z;
    }
    const double sum = weights[0] + weights[1] + weights[2];
    const bool inside = weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0;
    if (!inside || !(sum > 0) || !isfinite(sum)) {
        nearest_weights(triangle, center, width, height, weights);
        return;
    }
    for (int k = 0; k < 3; k++)
        weights[k] /= sum;
}

/* Differences first: exact where the vectors are large and near to each other. */
static shb_vec3 combine(const shb_vec3 v[3], const double weights[3]) {
    const double b = weights[1], c = weights[2];
    return (shb_vec3){v[0].x + (b * (v[1].x - v[0].x) + c * (v[2].x - v[0].x)),
                      v[0].y + (b * (v[1].y - v[0].y) + c * (v[2].y - v[0].y)),
                      v[0].z + (b * (v[1].z - v[0].z) + c * (v[2].z - v[0].z))};
}

shb_vec3 shb_surface_point(const shb_surface_triangle *triangle, const double weights[3]) {
    return combine(triangle->corners, weights);
}

shb_vec3 shb_surface_shading_normal(const shb_surface_triangle *triangle, const double weights[3]) {
    const shb_vec3 n = triangle->normal;
    const shb_vec3 sum = combine(triangle->shading, weights);
    const double length = sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
    if (!(length > 0 && isfinite(length)))
        return n;
    const double side = n.x * sum.x + n.y * sum.y + n.z * sum.z < 0 ? -1 : 1;
    return vec3_scale(sum, side / length);
}

bool shb_surface_faces(const shb_surface_triangle *triangle, const shb_light_source *eye) {
    const shb_vec3 to_eye = vec3_subtract(eye->position, vec3_scale(triangle->corners[0], eye->w));
    return vec3_dot(triangle->normal, to_eye) > 0;
}
