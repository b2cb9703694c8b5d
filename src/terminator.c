#include "strict.h"

#include "terminator.h"

#include "vector.h"

/* Unit, on the side of the triangle's own; zero if there is none. */
static shb_vec3 corner_normal(const shb_surface_triangle *triangle, int corner) {
    const shb_vec3 normal = vec3_normalize(triangle->shading[corner]);
    if (!vec3_is_finite(normal))
        return (shb_vec3){0};
    return vec3_dot(normal, triangle->normal) < 0 ? vec3_scale(normal, -1) : normal;
}

shb_vec3 shb_terminator_way(const shb_surface_triangle *triangle, const double weights[3]) {
    const shb_vec3 point = shb_surface_point(triangle, weights);
    shb_vec3 moved = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        const shb_vec3 normal = corner_normal(triangle, k);
        const double height = vec3_dot(vec3_subtract(point, triangle->corners[k]), normal);
        if (height < 0)
            moved = vec3_subtract(moved, vec3_scale(normal, weights[k] * height));
    }
    return moved;
}

void shb_terminator_lift_batch(shb_fragment_reader *reader, size_t count,
                               const shb_fragments *fragments, shb_lifted_points *lifted) {
    shb_surface_triangle triangle;
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        if (i == 0 || fragments->id[i] != triangle.id)
            shb_fragment_triangle(reader, fragments->id[i], &triangle);
        const double b = (double)fragments->weight_1[i], c = (double)fragments->weight_2[i];
        const double weights[3] = {1 - b - c, b, c};
        const shb_vec3 way = shb_terminator_way(&triangle, weights);
        lifted->x[i] = (float)((double)fragments->x[i] + way.x);
        lifted->y[i] = (float)((double)fragments->y[i] + way.y);
        lifted->z[i] = (float)((double)fragments->z[i] + way.z);
    }
}
