#include "light_space.h"

shb_result light_space_create(const shb_map_info *info, light_space *space) {
    const shb_mat4 *matrix = &info->view.clip_from_world;
    *space = (light_space){.clip_from_world = *matrix,
                           .width = info->width,
                           .height = info->height,
                           .reversed = info->view.reversed};
    return shb_mat4_inverse(*matrix, &space->world_from_clip);
}

static void transform(const shb_mat4 *matrix, const double in[4], double out[4]) {
    const double *m = matrix->m;
    for (int row = 0; row < 4; row++)
        out[row] = m[row] * in[0] + m[4 + row] * in[1] + m[8 + row] * in[2] + m[12 + row] * in[3];
}

light_point light_space_project(const light_space *space, shb_vec3 point) {
    double clip[4];
    transform(&space->clip_from_world, (const double[4]){point.x, point.y, point.z, 1}, clip);
    const double depth = clip[2] / clip[3];
    return (light_point){(clip[0] / clip[3] + 1) / 2 * space->width,
                         (1 - clip[1] / clip[3]) / 2 * space->height,
                         space->reversed ? -depth : depth};
}

shb_vec3 light_space_unproject(const light_space *space, light_point point) {
    double world[4];
    const double clip[4] = {2 * point.x / space->width - 1, 1 - 2 * point.y / space->height,
                            space->reversed ? -point.depth : point.depth, 1};
    transform(&space->world_from_clip, clip, world);
    return (shb_vec3){world[0] / world[3], world[1] / world[3], world[2] / world[3]};
}

static double determinant(const double a[3], const double b[3], const double c[3]) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* What is normal to three clip positions: their minors with alternating signs. */
static void normal_of(double clip[3][4], double normal[4]) {
    for (int left_out = 0; left_out < 4; left_out++) {
        double rows[3][3];
        for (int i = 0; i < 3; i++)
            for (int k = 0, column = 0; k < 4; k++)
                if (k != left_out)
                    rows[i][column++] = clip[i][k];
        normal[left_out] = (left_out % 2 ? -1 : 1) * determinant(rows[0], rows[1], rows[2]);
    }
}

light_plane light_space_plane(const light_space *space, const shb_vec3 corners[3]) {
    double clip[3][4], n[4];
    for (int i = 0; i < 3; i++)
        transform(&space->clip_from_world,
                  (const double[4]){corners[i].x, corners[i].y, corners[i].z, 1}, clip[i]);
    normal_of(clip, n);
    const double scale = (space->reversed ? 1 : -1) / n[2];
    /* depth = (n.x x + n.y y + n.w) * scale with x and y in clip space */
    return (light_plane){2 * n[0] * scale / space->width, -2 * n[1] * scale / space->height,
                         (n[3] - n[0] + n[1]) * scale};
}

double light_plane_at(const light_plane *plane, double x, double y) {
    return plane->per_x * x + plane->per_y * y + plane->at_origin;
}
