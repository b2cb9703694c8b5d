/* A tree on a lawn with a fence, poles and a wire: thin things at all heights above their shadows,
 * for lights with an extent. */
#include "scenes_builtin.h"

#include "foliage.h"
#include "noise.h"
#include "shapes.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

static const scene_surface lawn = {.color = {0.42f, 0.47f, 0.30f}};
static const scene_surface bark = {.color = {0.30f, 0.21f, 0.14f}};
static const scene_surface leaf = {.color = {0.24f, 0.40f, 0.10f}};
static const scene_surface paint = {.color = {0.72f, 0.70f, 0.66f}};
static const scene_surface iron = {.color = {0.30f, 0.32f, 0.36f}};

enum { forks = 3, generations = 4, leaves_per_twig = 14 };

typedef struct tree {
    example_scene *scene;
    const owned_mesh *limb; /* of length 1 along y and radius 1 at its foot */
    owned_mesh *crown;
    uint32_t count; /* of limbs so far */
} tree;

typedef struct limb_shape {
    shb_vec3 foot, direction;
    double length, radius;
} limb_shape;

/* Two unit vectors at right angles to a direction and to each other. */
static void sides_of(shb_vec3 direction, shb_vec3 *side, shb_vec3 *front) {
    *side = shb_vec3_normalize(shb_vec3_cross(direction, (shb_vec3){0.3, 0.1, 1}));
    *front = shb_vec3_cross(*side, direction);
}

static void add_limb(tree *t, const limb_shape *shape) {
    shb_vec3 side, front;
    sides_of(shape->direction, &side, &front);
    const shb_vec3 columns[4] = {shb_vec3_scale(side, shape->radius),
                                 shb_vec3_scale(shape->direction, shape->length),
                                 shb_vec3_scale(front, shape->radius), shape->foot};
    shb_mat4 place = shb_mat4_identity();
    for (int i = 0; i < 4; i++) {
        place.m[4 * i] = columns[i].x;
        place.m[4 * i + 1] = columns[i].y;
        place.m[4 * i + 2] = columns[i].z;
    }
    scene_add_instance(t->scene, t->limb, &place, SHB_CULL_BACK, &bark);
    t->count++;
}

static shb_vec3 point_along(const limb_shape *shape, double share) {
    return shb_vec3_add(shape->foot, shb_vec3_scale(shape->direction, share * shape->length));
}

static void add_leaves(tree *t, const limb_shape *twig) {
    for (uint32_t i = 0; i < leaves_per_twig; i++) {
        const uint32_t number = leaves_per_twig * t->count + i;
        foliage_leaf(t->crown, point_along(twig, 0.3 + 0.7 * i / (leaves_per_twig - 1)),
                     twig->direction, 0.26 + 0.06 * noise_random(11 * number), number);
    }
}

/* A limb and what grows from its end: more limbs that turn away from it, at last leaves. */
static void grow(tree *t, const limb_shape *shape, int generation) {
    add_limb(t, shape);
    if (generation == generations) {
        add_leaves(t, shape);
        return;
    }
    shb_vec3 side, front;
    sides_of(shape->direction, &side, &front);
    const uint32_t seed = 40 * t->count;
    for (int i = 0; i < forks; i++) {
        const double angle =
            120 * degree * (i + 0.35 * noise_random(seed + (uint32_t)i)) + 70 * degree * generation;
        const shb_vec3 aside =
            shb_vec3_add(shb_vec3_scale(side, cos(angle)), shb_vec3_scale(front, sin(angle)));
        const double spread = 0.75 + 0.2 * noise_random(seed + 10 + (uint32_t)i);
        const shb_vec3 direction = shb_vec3_add(shape->direction, shb_vec3_scale(aside, spread));
        const limb_shape next = {point_along(shape, 0.96 - 0.12 * i), shb_vec3_normalize(direction),
                                 0.7 * shape->length, 0.58 * shape->radius};
        grow(t, &next, generation + 1);
    }
}

static void add_tree(example_scene *scene) {
    owned_mesh *limb = scene_add_mesh(scene), *crown = scene_add_mesh(scene);
    const shape_point profile[] = {{0, -0.02}, {1, -0.02}, {0.62, 1}, {0, 1.02}};
    shape_lathe(limb, (shb_vec3){0, 0, 0}, profile, sizeof profile / sizeof *profile, 12);
    tree t = {scene, limb, crown, 0};
    const limb_shape trunk = {{0, 0, 0}, shb_vec3_normalize((shb_vec3){0.06, 1, 0.04}), 1.5, 0.17};
    grow(&t, &trunk, 1);
    scene_add_instance(scene, crown, NULL, SHB_CULL_NONE, &leaf);
}

static void add_fence(example_scene *scene) {
    owned_mesh *fence = scene_add_solid(scene, &paint);
    const double z = 2.4;
    for (int i = -9; i <= 9; i++) {
        const double x = 0.36 * i;
        shape_box(fence, (shb_vec3){x - 0.05, 0, z - 0.02}, (shb_vec3){x + 0.05, 0.9, z + 0.02});
    }
    for (int i = 0; i < 2; i++) {
        const double y = 0.3 + 0.35 * i;
        shape_box(fence, (shb_vec3){-3.4, y, z - 0.05}, (shb_vec3){3.4, y + 0.07, z - 0.02});
    }
}

/* Two poles with a wire between their tops, and discs on one of them. */
static void add_poles(example_scene *scene) {
    owned_mesh *poles = scene_add_solid(scene, &iron);
    for (int i = -1; i <= 1; i += 2) {
        const shape_point pole[] = {{0, 0}, {0.045, 0}, {0.045, 3.1}, {0, 3.1}};
        shape_lathe(poles, (shb_vec3){3.2 * i, 0, -1.6}, pole, 4, 16);
    }
    shape_box(poles, (shb_vec3){-3.2, 2.95, -1.615}, (shb_vec3){3.2, 2.98, -1.585});
    for (int i = 0; i < 3; i++) {
        const double y = 0.45 + 0.8 * i;
        const shape_point disc[] = {{0, y}, {0.35, y}, {0.35, y + 0.03}, {0, y + 0.03}};
        shape_lathe(poles, (shb_vec3){3.2, 0, -1.6}, disc, 4, 32);
    }
}

void scene_build_tree(example_scene *scene, double unused) {
    (void)unused;
    owned_mesh *ground = scene_add_solid(scene, &lawn);
    shape_box(ground, (shb_vec3){-7, -0.25, -7}, (shb_vec3){7, 0, 7});
    /* the top of a ball: a mound that catches shadows on its slopes */
    shape_ball(ground, (shb_vec3){2.2, -1.6, 0.5}, 2.05, 64);
    add_tree(scene);
    add_fence(scene);
    add_poles(scene);
    scene_set_sun(scene, (shb_vec3){-0.45, 0.82, 0.35});
    scene_set_spot(scene, (shb_vec3){-5, 9, 4}, (shb_vec3){0.2, 0.6, 0}, 66 * degree, 3, 20);
    scene->camera = (scene_camera){(shb_vec3){2.0, 4.0, 8.2}, (shb_vec3){0.8, 0.95, -0.2},
                                   36 * degree, 0.5, 40};
    scene->ambient = 0.30f;
}
