#include "strict.h"

#include "project.h"

#include "light_point.h"
#include "matrix.h"

#include <float.h>
#include <math.h>

/* World width of a texel where w is 1: the step along the row's own direction, at constant w, that
 * moves its coordinate by 2 / texels. */
static double texel_width(const double *row, const double *row_w, double texels) {
    const double ww = shb_dot(row_w, row_w);
    const double along = ww > 0 ? shb_dot(row, row_w) / ww : 0;
    const double across[3] = {row[0] - along * row_w[0], row[1] - along * row_w[1],
                              row[2] - along * row_w[2]};
    return 2 / texels / sqrt(shb_dot(across, across));
}

/* Depth along a light's ray is a constant plus this over w. It is what row z makes of the light's
 * own position, which a row that is slope * (row w) + rest tells without rounding of that position:
 * rest. Where the near plane is not parallel to the map, row z holds other rows as well. */
static double depth_at_light(const shb_projection *p, double ww) {
    const double slope = shb_dot(p->row_z, p->row_w) / ww;
    const double rest = p->row_z[3] - slope * p->row_w[3];
    double others = 0, size = fabs(rest);
    for (int i = 0; i < 3; i++) {
        others += (p->row_z[i] - slope * p->row_w[i]) * p->light[i];
        size += (fabs(p->row_z[i]) + fabs(slope * p->row_w[i])) * fabs(p->light[i]);
    }
    return fabs(others) > 0x1p-30 * size ? rest + others : rest;
}

double shb_projection_w(const shb_projection *p) {
    const double ww = shb_dot(p->row_w, p->row_w);
    return ww > 0 ? sqrt(ww) : p->row_w[3];
}

/* Canonical depth per world unit away from the light, times w^2. Under parallel rays it changes
 * along the light's direction. */
static double depth_scale(const shb_projection *p) {
    const double ww = shb_dot(p->row_w, p->row_w);
    const double depth = ww > 0 ? depth_at_light(p, ww) : shb_dot(p->row_z, p->light);
    return -p->sign * depth * shb_projection_w(p);
}

static bool is_positive(double value) {
    return value > 0 && value <= DBL_MAX;
}

shb_result shb_projection_init(const shb_map_info *info, shb_projection *projection) {
    shb_projection p = {
        .width = info->width,
        .height = info->height,
        .sign = info->view.reversed ? -1 : 1,
        .light = {info->light.position.x, info->light.position.y, info->light.position.z},
        .light_w = info->light.w};
    const shb_mat4 *matrix = &info->view.clip_from_world;
    shb_mat4_row(matrix, 0, p.row_x);
    shb_mat4_row(matrix, 1, p.row_y);
    shb_mat4_row(matrix, 2, p.row_z);
    shb_mat4_row(matrix, 3, p.row_w);
    p.affine = p.row_w[0] == 0 && p.row_w[1] == 0 && p.row_w[2] == 0 && p.row_w[3] == 1;

    const shb_light_rows rows = shb_light_rows_of(&info->view, p.width, p.height);
    shb_cross(rows.x, rows.y, p.x_cross_y);
    shb_cross(rows.x, rows.w, p.x_cross_w);
    shb_cross(rows.y, rows.w, p.y_cross_w);
    shb_cross(rows.z, rows.y, p.z_cross_y);
    shb_cross(rows.z, rows.w, p.z_cross_w);
    shb_cross(rows.x, rows.z, p.x_cross_z);

    p.texel_width = texel_width(p.row_x, p.row_w, p.width);
    p.texel_height = texel_width(p.row_y, p.row_w, p.height);
    p.texel_scale = p.texel_width > p.texel_height ? p.texel_width : p.texel_height;
    p.depth_scale = depth_scale(&p);
    if (!is_positive(p.texel_width) || !is_positive(p.texel_height) || !is_positive(p.depth_scale))
        return SHB_ERROR_NUMBER;
    *projection = p;
    return SHB_OK;
}

shb_light_rows shb_light_rows_of(const shb_view *view, double width, double height) {
    shb_light_rows rows;
    shb_mat4_row(&view->clip_from_world, 0, rows.x);
    shb_mat4_row(&view->clip_from_world, 1, rows.y);
    shb_mat4_row(&view->clip_from_world, 2, rows.z);
    shb_mat4_row(&view->clip_from_world, 3, rows.w);
    for (int i = 0; i < 4; i++) {
        rows.x[i] = width / 2 * (rows.w[i] + rows.x[i]);
        rows.y[i] = height / 2 * (rows.w[i] - rows.y[i]);
        rows.z[i] = view->reversed ? -rows.z[i] : rows.z[i];
    }
    return rows;
}

void shb_receivers_pick(const shb_quick_points *from, const uint16_t *numbers, size_t count,
                        bool with_normals, shb_receivers *to) {
    for (size_t k = 0; k < shb_round_to_lanes(count); k++) {
        const size_t i = numbers[k < count ? k : count - 1];
        to->x[k] = from->position[0][i];
        to->y[k] = from->position[1][i];
        to->z[k] = from->position[2][i];
        if (with_normals) {
            to->normal_x[k] = from->normal[0][i];
            to->normal_y[k] = from->normal[1][i];
            to->normal_z[k] = from->normal[2][i];
        }
    }
}
