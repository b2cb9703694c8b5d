#include "strict.h"

#include "project.h"

#include <float.h>
#include <math.h>

/* Texel coordinates and depths of points far outside the map end here, so that neither a conversion
 * to int nor a filter's walk from there can overflow. */
#define LIMIT (-(double)SHB_TEXEL_NONE)

static double dot3(const double *a, const double *b) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

static void cross3(const double *a, const double *b, double *out) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void matrix_row(const shb_mat4 *matrix, int row, double *out) {
    for (int column = 0; column < 4; column++)
        out[column] = matrix->m[4 * column + row];
}

/* World width of a texel where w is 1: the step along the row's own direction, at constant w, that
 * moves its coordinate by 2 / texels. */
static double texel_width(const double *row, const double *row_w, double texels) {
    const double ww = dot3(row_w, row_w);
    const double along = ww > 0 ? dot3(row, row_w) / ww : 0;
    const double across[3] = {row[0] - along * row_w[0], row[1] - along * row_w[1],
                              row[2] - along * row_w[2]};
    return 2 / texels / sqrt(dot3(across, across));
}

/* Canonical depth per world unit away from the light, times w^2.
 * Central: row z is slope * (row w) + rest, where only the constant part of the rest counts, so
 * that depth = slope + rest / w; w grows by |row w| per unit of distance along the light's axis.
 * Parallel: w is constant and depth changes along the light's direction. */
static double depth_scale(const shb_projection *p) {
    const double ww = dot3(p->row_w, p->row_w);
    if (ww > 0) {
        const double rest = p->row_z[3] - dot3(p->row_z, p->row_w) / ww * p->row_w[3];
        return -p->sign * rest * sqrt(ww);
    }
    return -p->sign * dot3(p->row_z, p->light) * p->row_w[3];
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
    matrix_row(matrix, 0, p.row_x);
    matrix_row(matrix, 1, p.row_y);
    matrix_row(matrix, 2, p.row_z);
    matrix_row(matrix, 3, p.row_w);
    p.affine = p.row_w[0] == 0 && p.row_w[1] == 0 && p.row_w[2] == 0 && p.row_w[3] == 1;

    cross3(p.row_x, p.row_y, p.x_cross_y);
    cross3(p.row_x, p.row_w, p.x_cross_w);
    cross3(p.row_y, p.row_w, p.y_cross_w);
    cross3(p.row_z, p.row_y, p.z_cross_y);
    cross3(p.row_z, p.row_w, p.z_cross_w);
    cross3(p.row_x, p.row_z, p.x_cross_z);

    const double texel_x = texel_width(p.row_x, p.row_w, p.width);
    const double texel_y = texel_width(p.row_y, p.row_w, p.height);
    p.texel_scale = texel_x > texel_y ? texel_x : texel_y;
    p.depth_scale = depth_scale(&p);
    if (!is_positive(texel_x) || !is_positive(texel_y) || !is_positive(p.depth_scale))
        return SHB_ERROR_NUMBER;
    *projection = p;
    return SHB_OK;
}

static inline double row_at(const double *row, double x, double y, double z) {
    return ((row[0] * x + row[1] * y) + row[2] * z) + row[3];
}

static inline int is_finite(double value) {
    return fabs(value) <= DBL_MAX;
}

static void project_affine(const shb_projection *p, size_t count,
                           const shb_receivers *restrict receivers, shb_ndc *restrict ndc) {
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const double px = (double)receivers->x[i];
        const double py = (double)receivers->y[i];
        const double pz = (double)receivers->z[i];
        const double x = row_at(p->row_x, px, py, pz);
        const double y = row_at(p->row_y, px, py, pz);
        const double z = row_at(p->row_z, px, py, pz);
        const int good = is_finite(x) & is_finite(y) & is_finite(z);
        ndc->x[i] = good ? x : (double)NAN;
        ndc->y[i] = good ? y : (double)NAN;
        ndc->z[i] = good ? z : 0;
        ndc->w[i] = 1;
    }
}

static void project_central(const shb_projection *p, size_t count,
                            const shb_receivers *restrict receivers, shb_ndc *restrict ndc) {
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const double px = (double)receivers->x[i];
        const double py = (double)receivers->y[i];
        const double pz = (double)receivers->z[i];
        const double w = row_at(p->row_w, px, py, pz);
        const double scale = 1 / w;
        const double x = row_at(p->row_x, px, py, pz) * scale;
        const double y = row_at(p->row_y, px, py, pz) * scale;
        const double z = row_at(p->row_z, px, py, pz) * scale;
        const int good = is_finite(x) & is_finite(y) & is_finite(z) & (w > 0);
        ndc->x[i] = good ? x : (double)NAN;
        ndc->y[i] = good ? y : (double)NAN;
        ndc->z[i] = good ? z : 0;
        ndc->w[i] = good ? w : 1;
    }
}

void shb_project_points(const shb_projection *projection, size_t count,
                        const shb_receivers *receivers, shb_ndc *ndc) {
    if (projection->affine)
        project_affine(projection, count, receivers, ndc);
    else
        project_central(projection, count, receivers, ndc);
}

static inline float to_float(double value) {
    return (float)(value < (double)FLT_MAX ? value : (double)FLT_MAX);
}

void shb_project_scales(const shb_projection *projection, size_t count, const shb_ndc *restrict ndc,
                        shb_receivers *restrict receivers) {
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const double w = ndc->w[i];
        receivers->texel_size[i] = to_float(projection->texel_scale * w);
        receivers->depth_per_world[i] = to_float(projection->depth_scale / (w * w));
    }
}

/* Cut off at one map depth per texel; 0 if undefined. */
static inline float limited_slope(double slope) {
    const double low = slope < -1 ? -1 : slope;
    const double limited = low > 1 ? 1 : low;
    return (float)(limited == limited ? limited : 0);
}

/* The rows' first three elements act on directions. A step v in the world moves the point by
 * a.v / w, b.v / w, c.v / w in x, y, z, where a = row_x - x row_w, and b and c likewise. Within the
 * plane at constant y the step is b x n, so dz/dx = n.(c x b) / n.(a x b); at constant x it is a x
 * n, so dz/dy = n.(a x c) / n.(a x b). Written out, the cross products are sums of constant
 * vectors. */
void shb_project_slopes(const shb_projection *projection, size_t count, const shb_ndc *restrict ndc,
                        shb_receivers *restrict receivers) {
    const shb_projection p = *projection;
    const double per_column = p.sign * 2 / p.width;
    const double per_row = p.sign * -2 / p.height; /* rows run down, y runs up */
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const double n[3] = {(double)receivers->normal_x[i], (double)receivers->normal_y[i],
                             (double)receivers->normal_z[i]};
        const double x = ndc->x[i], y = ndc->y[i], z = ndc->z[i];
        const double n_xw = dot3(n, p.x_cross_w);
        const double n_yw = dot3(n, p.y_cross_w);
        const double n_zw = dot3(n, p.z_cross_w);
        const double ab = dot3(n, p.x_cross_y) - y * n_xw + x * n_yw;
        const double cb = dot3(n, p.z_cross_y) - y * n_zw + z * n_yw;
        const double ac = dot3(n, p.x_cross_z) - z * n_xw + x * n_zw;
        receivers->slope_x[i] = limited_slope(per_column * cb / ab);
        receivers->slope_y[i] = limited_slope(per_row * ac / ab);
    }
}

void shb_project_normals(const shb_projection *projection, size_t count,
                         shb_receivers *restrict receivers) {
    const shb_projection p = *projection;
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        double to_light[3] = {p.light[0] - p.light_w * (double)receivers->x[i],
                              p.light[1] - p.light_w * (double)receivers->y[i],
                              p.light[2] - p.light_w * (double)receivers->z[i]};
        const double length = sqrt(dot3(to_light, to_light));
        const double scale = 1 / (length > 0 ? length : 1);
        to_light[0] *= scale;
        to_light[1] *= scale;
        to_light[2] *= scale;
        const double n[3] = {(double)receivers->normal_x[i], (double)receivers->normal_y[i],
                             (double)receivers->normal_z[i]};
        const double squared = dot3(n, n);
        const int usable = (squared > 0) & (squared <= DBL_MAX);
        const double cosine = dot3(n, to_light);
        const double side = cosine < 0 ? -1 : 1;
        const double size = cosine * side < 1 ? cosine * side : 1;
        receivers->normal_x[i] = (float)(usable ? side * n[0] : to_light[0]);
        receivers->normal_y[i] = (float)(usable ? side * n[1] : to_light[1]);
        receivers->normal_z[i] = (float)(usable ? side * n[2] : to_light[2]);
        receivers->cosine[i] = (float)(usable ? size : 1);
    }
}

/* NaN becomes the lower end, which is SHB_TEXEL_NONE for a coordinate. */
static inline double limited(double value) {
    const double low = value > -LIMIT ? value : -LIMIT;
    return low < LIMIT ? low : LIMIT;
}

/* The texel that holds a coordinate; conversion to int rounds towards 0, so negative ones may need
 * one less. */
static inline int32_t texel_of(double coordinate) {
    const int32_t truncated = (int32_t)coordinate;
    return truncated - ((double)truncated > coordinate);
}

void shb_project_texels(const shb_projection *projection, size_t count, const shb_ndc *restrict ndc,
                        shb_receivers *restrict receivers) {
    const shb_projection p = *projection;
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const double column = limited((ndc->x[i] * 0.5 + 0.5) * p.width);
        const double row = limited((0.5 - ndc->y[i] * 0.5) * p.height);
        const int32_t texel_x = texel_of(column);
        const int32_t texel_y = texel_of(row);
        receivers->texel_x[i] = texel_x;
        receivers->texel_y[i] = texel_y;
        receivers->to_center_x[i] = (float)((double)texel_x + 0.5 - column);
        receivers->to_center_y[i] = (float)((double)texel_y + 0.5 - row);
        receivers->depth[i] = (float)limited(p.sign * ndc->z[i]);
    }
}
