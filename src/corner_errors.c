/* Let e = 2^-53, V clip_from_world, T world_from_mesh and R the largest sizes of a mesh's
 * coordinates. An element of the product is off by less than 4 e |V| |T|, a row's product with a
 * vertex by as much again, and 2 e more than the rows of a map (shb_light_rows) are rounded: all of
 * a row by less than 12 e S with S = |V| |T| (R, 1).
 *
 * With w at least W and the size of x / w up to N, w moves the quotient by 12 e N S_w / W, and the
 * division, two products and the sum that make it a window coordinate cost less than 7 e (N + 1).
 * Where w is 1, it moves nothing. The guard band bounds N. W follows from the near plane: the rows
 * z and w of lights are parallel but for what is left of z, which counts as an error. */
#include "strict.h"

#include "corner_errors.h"

#include "clusters.h"
#include "scene.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define ROUNDING 0x1p-53

/* Without signs, bits of floats are in the numbers' order, and what is not finite comes last. */
static void stretch(const float *point, uint32_t largest[3]) {
    uint32_t bits[3];
    memcpy(bits, point, sizeof bits);
    for (int axis = 0; axis < 3; axis++) {
        const uint32_t size = bits[axis] & 0x7fffffff;
        largest[axis] = size > largest[axis] ? size : largest[axis];
    }
}

/* The largest size on each axis; false if some coordinate is not finite. */
static bool reach_of(const shb_mesh *mesh, double reach[3]) {
    uint32_t largest[3] = {0, 0, 0};
    for (size_t i = 0; mesh->clusters && i < mesh->clusters->count; i++) {
        stretch(mesh->clusters->clusters[i].lo, largest);
        stretch(mesh->clusters->clusters[i].hi, largest);
    }
    for (uint32_t i = 0; !mesh->clusters && i < mesh->vertex_count; i++)
        stretch(shb_mesh_position(mesh, i), largest);
    bool finite = true;
    for (int axis = 0; axis < 3; axis++) {
        float size;
        memcpy(&size, &largest[axis], sizeof size);
        finite &= size <= FLT_MAX;
        reach[axis] = (double)size;
    }
    return finite;
}

/* What a row of clip space is summed up from at most. */
static double size_of_row(const shb_view *view, const shb_draw_instance *instance,
                          const double reach[3], int row) {
    double size = 0;
    for (int column = 0; column < 4; column++)
        for (int k = 0; k < 4; k++)
            size += fabs(view->clip_from_world.m[4 * k + row]) *
                    fabs(instance->world_from_mesh.m[4 * column + k]) *
                    (column < 3 ? reach[column] : 1);
    return size;
}

/* A bound of w where the near plane's distance, slope * w + constant but for what is left of row z,
 * is not negative; negative or NaN: none is known. */
static double least_w(const shb_target *target, const shb_draw_instance *instance,
                      const double reach[3], double rounding) {
    const double *m = instance->clip_from_mesh.m;
    const shb_clip_plane *near = &target->volume.cut[0];
    const double ww = (m[3] * m[3] + m[7] * m[7]) + m[11] * m[11];
    const double zw = (m[2] * m[3] + m[6] * m[7]) + m[10] * m[11];
    const double part = zw / ww, slope = near->sign * part + near->offset;
    double left = rounding;
    for (int axis = 0; axis < 3; axis++)
        left += fabs(m[4 * axis + 2] - part * m[4 * axis + 3]) * reach[axis];
    const double constant = near->sign * (m[14] - part * m[15]);
    return slope > 0 ? -(constant + left) / slope * (1 - 0x1p-10) : -1;
}

shb_corner_errors shb_corner_errors_of(const shb_target *target, const shb_view *view,
                                       const shb_draw_instance *instance) {
    double reach[3], off[4];
    const bool finite = reach_of(instance->mesh, reach);
    for (int row = 0; row < 4; row++)
        off[row] = 12 * ROUNDING * size_of_row(view, instance, reach, row);
    double inverse = 1;
    if (instance->affine)
        off[3] = 0;
    else
        inverse = 1 / least_w(target, instance, reach, 4 * (off[2] + off[3]));
    if (!(finite && inverse > 0))
        return (shb_corner_errors){HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};
    const double width = target->half_width, height = target->half_height;
    const double right = (SHB_GUARD_PIXELS + width) / width;
    const double top = (SHB_GUARD_PIXELS + height) / height;
    return (shb_corner_errors){
        .x = width * ((off[0] + right * off[3]) * inverse + 7 * ROUNDING * (right + 1)),
        .y = height * ((off[1] + top * off[3]) * inverse + 7 * ROUNDING * (top + 1)),
        .z = off[2] * inverse,
        .z_part = off[3] * inverse + 4 * ROUNDING,
    };
}
