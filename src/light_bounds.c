#include "strict.h"

#include "light_bounds.h"

#include "light_point.h"

static void scale(const double *row, double factor, double unit[3]) {
    for (int i = 0; i < 3; i++)
        unit[i] = row[i] * factor;
}

static void write_sizes(const double unit[3], float sizes[3]) {
    for (int i = 0; i < 3; i++)
        sizes[i] = (float)fabs(unit[i]);
}

static void write_cross(const double a[3], const double b[3], float product[3]) {
    double cross[3];
    shb_cross(a, b, cross);
    for (int i = 0; i < 3; i++)
        product[i] = (float)cross[i];
}

shb_light_bounds shb_light_bounds_of(const shb_light_rows *rows, double width, double height) {
    double x[3], y[3], z[3], w[3];
    for (int i = 0; i < 3; i++) {
        x[i] = rows->x[i] - width / 2 * rows->w[i];
        y[i] = rows->y[i] - height / 2 * rows->w[i];
    }
    const double size_w = shb_sum_abs(rows->w), by_w = size_w > 0 ? size_w : 1;
    const double scale_x = shb_sum_abs(x) + size_w * width / 2;
    const double scale_y = shb_sum_abs(y) + size_w * height / 2;
    const double scale_z = shb_sum_abs(rows->z) + size_w;
    scale(x, 1 / scale_x, x);
    scale(y, 1 / scale_y, y);
    scale(rows->z, 1 / scale_z, z);
    scale(rows->w, 1 / by_w, w);

    shb_light_bounds bounds = {
        .size_x = (float)shb_sum_abs(x),
        .size_y = (float)shb_sum_abs(y),
        .size_z = (float)shb_sum_abs(z),
        .way = {(float)w[0], (float)w[1], (float)w[2], (float)(rows->w[3] / by_w)},
        .to_xi = (float)(size_w / scale_x),
        .to_eta = (float)(size_w / scale_y),
        .to_zeta = (float)(size_w / scale_z),
        .middle_x = (float)(width / 2),
        .middle_y = (float)(height / 2),
        .unit_x = (float)(scale_x / by_w),
        .unit_y = (float)(scale_y / by_w),
        .unit_z = (float)(scale_z / by_w),
        .slope_x = (float)(scale_z / scale_x),
        .slope_y = (float)(scale_z / scale_y),
        .turns = size_w > 0 ? 1.0f : 0.0f};
    write_sizes(x, bounds.x);
    write_sizes(y, bounds.y);
    write_sizes(z, bounds.z);
    write_sizes(w, bounds.w);
    write_cross(x, y, bounds.x_cross_y);
    write_cross(x, w, bounds.x_cross_w);
    write_cross(y, w, bounds.y_cross_w);
    write_cross(z, y, bounds.z_cross_y);
    write_cross(z, w, bounds.z_cross_w);
    write_cross(x, z, bounds.x_cross_z);
    return bounds;
}
