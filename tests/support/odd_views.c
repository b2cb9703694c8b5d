#include "odd_views.h"

#include <math.h>

shb_result odd_view(int kind, shb_vec3 center, double size, double far_distance, shb_view *view) {
    const double s = size;
    const shb_vec3 above = {center.x, center.y + 4 * s, center.z};
    const shb_vec3 aside = {center.x + 3 * s, center.y + 2 * s, center.z + s};
    const shb_vec3 amid = {center.x, center.y + s / 2, center.z};
    const shb_vec3 north = {0, 0, -1}, up = {0, 1, 0};
    switch (kind) {
    case 0:
        return shb_view_orthographic(above, center, north, s, s, s, far_distance, false, view);
    case 1:
        return shb_view_orthographic(aside, center, up, 1.5 * s, s, s, far_distance, true, view);
    case 2:
        return shb_view_perspective(above, center, north, 0.5, 1, s, 9 * s, false, view);
    case 3:
        return shb_view_perspective(aside, center, up, 0.8, 1, 0.01 * s, HUGE_VAL, true, view);
    case 4:
        return shb_view_perspective(amid, center, north, 2, 1, 0.1 * s, 9 * s, false, view);
    default:
        return shb_view_orthographic(above, center, north, s, s, s, 1e6 * s, false, view);
    }
}
