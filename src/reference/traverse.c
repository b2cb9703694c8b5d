/* Following a ray through the hierarchy until something blocks it.
 *
 * The box test may not lose a triangle that ray.c would hit. There a corner moves by rounding when
 * it is sheared, by at most 8 * 2^-53 of its distance from the origin along the axes; so boxes are
 * taken for larger by 16 * 2^-53 of the distance to the farthest one (the rest covers the rounding
 * of the margin itself). Parameters of slabs carry three roundings each: the far ones are raised by
 * more than twice that (Ize 2013). */
#include "../strict.h"

#include <math.h>

#include "bvh.h"

#define ROUNDING 0x1p-53

/* The ray as boxes need it. */
typedef struct slabs {
    double near_origin[3], far_origin[3]; /* the origin, moved by the margin */
    double inverse[3];                    /* of the direction */
    int near_side[3];                     /* the side of a box that the ray meets first */
    double limit;
} slabs;

static double reach_of(const shb_bvh_child *root, const shb_ray *ray) {
    double reach = 0;
    for (int i = 0; i < 3; i++) {
        const double lo = fabs((double)root->box[0][i] - ray->origin[i]);
        const double hi = fabs((double)root->box[1][i] - ray->origin[i]);
        reach = lo > reach ? lo : reach;
        reach = hi > reach ? hi : reach;
        reach = fabs(ray->origin[i]) > reach ? fabs(ray->origin[i]) : reach;
    }
    return reach;
}

static slabs make_slabs(const shb_bvh_child *root, const shb_ray *ray) {
    slabs result = {.limit = ray->limit};
    const double margin = 16 * ROUNDING * reach_of(root, ray);
    for (int i = 0; i < 3; i++) {
        /* A direction so small moves the ray by nothing, and its inverse stays finite. */
        const double least = 0x1p-500;
        const double direction = ray->direction[i];
        result.inverse[i] = fabs(direction) > least ? 1 / direction : 1 / least;
        const bool forwards = result.inverse[i] > 0;
        result.near_side[i] = forwards ? 0 : 1;
        result.near_origin[i] = forwards ? ray->origin[i] + margin : ray->origin[i] - margin;
        result.far_origin[i] = forwards ? ray->origin[i] - margin : ray->origin[i] + margin;
    }
    return result;
}

/* Where the ray enters the box, or HUGE_VAL if it misses it. */
static double enter_box(const slabs *s, const shb_bvh_child *child) {
    double enter = 0, leave = s->limit;
    for (int i = 0; i < 3; i++) {
        const int side = s->near_side[i];
        const double from = ((double)child->box[side][i] - s->near_origin[i]) * s->inverse[i];
        const double to = ((double)child->box[1 - side][i] - s->far_origin[i]) * s->inverse[i];
        enter = from > enter ? from : enter;
        leave = to < leave ? to : leave;
    }
    return enter <= leave * (1 + 8 * ROUNDING) ? enter : HUGE_VAL;
}

static bool leaf_blocks(const shb_bvh *bvh, const shb_bvh_child *leaf, const shb_ray *ray,
                        const shb_triangle *own) {
    for (uint32_t i = leaf->first; i < leaf->first + leaf->count; i++) {
        const shb_triangle *triangle = &bvh->triangles[i];
        if (triangle != own && shb_ray_is_blocked(ray, triangle, own))
            return true;
    }
    return false;
}

bool shb_bvh_occluded(const shb_bvh *bvh, const shb_ray *ray, uint32_t own_id) {
    if (bvh->count == 0)
        return false;
    const slabs s = make_slabs(&bvh->root, ray);
    if (enter_box(&s, &bvh->root) == HUGE_VAL)
        return false;
    const shb_triangle *own = shb_bvh_find(bvh, own_id);
    const shb_bvh_child *waiting[SHB_BVH_DEPTH];
    size_t waiting_count = 0;
    const shb_bvh_child *child = &bvh->root;
    for (;;) {
        if (child->count) {
            if (leaf_blocks(bvh, child, ray, own))
                return true;
        } else {
            const shb_bvh_child *children = bvh->nodes[child->first].children;
            const double enter[2] = {enter_box(&s, &children[0]), enter_box(&s, &children[1])};
            const int nearer = enter[1] < enter[0];
            if (enter[nearer] < HUGE_VAL) {
                if (enter[1 - nearer] < HUGE_VAL)
                    waiting[waiting_count++] = &children[1 - nearer];
                child = &children[nearer];
                continue;
            }
        }
        if (waiting_count == 0)
            return false;
        child = waiting[--waiting_count];
    }
}
