#include "foliage.h"

#include "noise.h"
#include "shapes.h"

void foliage_leaf(owned_mesh *mesh, shb_vec3 at, shb_vec3 out, double size, uint32_t number) {
    const shb_vec3 spread = {noise_random(3 * number), noise_random(3 * number + 1),
                             noise_random(3 * number + 2)};
    const shb_vec3 axis = shb_vec3_normalize(shb_vec3_add(out, shb_vec3_scale(spread, 0.9)));
    const shb_vec3 side =
        shb_vec3_normalize(shb_vec3_cross(axis, (shb_vec3){spread.z, 0.5, spread.x}));
    const shb_vec3 tip = shb_vec3_add(at, shb_vec3_scale(axis, size));
    const shb_vec3 middle = shb_vec3_add(at, shb_vec3_scale(axis, 0.45 * size));
    shape_quad(mesh, at, shb_vec3_add(middle, shb_vec3_scale(side, 0.32 * size)), tip,
               shb_vec3_add(middle, shb_vec3_scale(side, -0.32 * size)));
}
