/* A rock that floats in the air, with trees and a small temple: slopes that the light grazes,
 * trunks of few triangles and crowns of leaves without thickness. */
#include "scenes_builtin.h"

#include "architecture.h"
#include "foliage.h"
#include "noise.h"
#include "shapes.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

enum { sectors = 120, top_rings = 44, bottom_rings = 22 };
static const double temple_x = -4.2, temple_z = 2.6, temple_radius = 3.1, temple_level = 2.3;

static const scene_surface rock = {.color = {0.24f, 0.36f, 0.12f},
                                   .second = {0.40f, 0.34f, 0.28f},
                                   .pattern = SCENE_SLOPES,
                                   .lowest = -0.3f};
static const scene_surface bark = {.color = {0.27f, 0.18f, 0.11f}};
static const scene_surface marble = {.color = {0.72f, 0.68f, 0.60f}};
static const scene_surface roof_tiles = {.color = {0.50f, 0.22f, 0.13f}};

static double smooth_step(double from, double to, double value) {
    const double t = fmin(fmax((value - from) / (to - from), 0), 1);
    return t * t * (3 - 2 * t);
}

/* The distance of the shore from the middle. */
static double shore(double angle) {
    return 15.5 + 3.2 * noise_fractal(2.2 * cos(angle) + 7, 2.2 * sin(angle) + 3, 4);
}

/* Height of the land: meadows, a crag in one corner, level ground for the temple. */
static double land_height(double x, double z) {
    const double rim = sqrt(x * x + z * z) / shore(atan2(z, x));
    const double meadow = 2.4 + 1.7 * noise_fractal(0.16 * x, 0.16 * z, 4);
    const double dx = x - 6.5, dz = z + 5.5;
    const double crag = smooth_step(7.5, 1.5, sqrt(dx * dx + dz * dz));
    const double ridges = 1 - 2.2 * fabs(noise_fractal(0.33 * x + 20, 0.33 * z, 5));
    double height = meadow + crag * (4.2 + 3.6 * ridges);
    height *= 1 - smooth_step(0.72, 1.02, rim) * 0.75;
    const double tx = x - temple_x, tz = z - temple_z;
    const double level = smooth_step(1.7, 1.05, sqrt(tx * tx + tz * tz) / temple_radius);
    return height + (temple_level - height) * level;
}

/* Rings from the top's middle to the shore and on to the lowest point. */
static void add_rock(example_scene *scene) {
    static const int rings = top_rings + bottom_rings;
    shb_vec3 points[(top_rings + bottom_rings) * sectors];
    for (int ring = 0; ring < rings; ring++)
        for (int sector = 0; sector < sectors; sector++) {
            const double angle = 2 * pi * sector / sectors, reach = shore(angle);
            shb_vec3 p;
            if (ring < top_rings) {
                const double radius = reach * ring / (top_rings - 1);
                p = (shb_vec3){radius * cos(angle), 0, radius * sin(angle)};
                p.y = land_height(p.x, p.z);
            } else {
                const double depth = (ring - top_rings + 1.0) / bottom_rings;
                const double rough =
                    noise_fractal(3 * cos(angle) + 40, 3 * sin(angle) + 9 * depth, 5);
                const double radius =
                    reach * pow(1 - depth, 0.62) * (1 + 1.6 * rough * depth * (1 - depth));
                p = (shb_vec3){radius * cos(angle), -13 * depth + 2.5 * rough * depth * (1 - depth),
                               radius * sin(angle)};
            }
            points[(rings - 1 - ring) * sectors + (sectors - 1 - sector)] = p;
        }
    for (int sector = 1; sector < sectors; sector++) {
        points[sector] = points[0];
        points[(rings - 1) * sectors + sector] = points[(rings - 1) * sectors];
    }
    shape_grid(scene_add_solid(scene, &rock), points, (uint32_t)sectors, (uint32_t)rings, true);
}

/* A crown of leaves on an ellipsoid's surface, evenly spread by the golden angle. */
static void add_crown(owned_mesh *mesh, shb_vec3 center, double radius, uint32_t leaves,
                      uint32_t seed) {
    for (uint32_t i = 0; i < leaves; i++) {
        const double y = 1 - 2 * (i + 0.5) / leaves, ring = sqrt(1 - y * y);
        const double angle = 2.399963229728653 * i;
        const shb_vec3 out = {ring * cos(angle), y, ring * sin(angle)};
        const double depth = radius * (0.72 + 0.22 * noise_random(7 * (seed + i)));
        const shb_vec3 at = {center.x + depth * out.x, center.y + 0.8 * depth * out.y,
                             center.z + depth * out.z};
        foliage_leaf(mesh, at, out, 0.42 * radius, seed + i);
    }
}

static void add_trunk(owned_mesh *mesh, double radius, double height) {
    const shape_point profile[] = {{0, -0.5},
                                   {1.5 * radius, -0.5},
                                   {1.1 * radius, 0.25},
                                   {0.8 * radius, 0.5 * height},
                                   {0.4 * radius, height},
                                   {0, height}};
    shape_lathe(mesh, (shb_vec3){0, 0, 0}, profile, sizeof profile / sizeof *profile, 10);
}

/* Tiers of branches as cones, each closed. */
static void add_conifer(owned_mesh *mesh, double height) {
    for (int tier = 0; tier < 5; tier++) {
        const double low = height * (0.16 + 0.155 * tier), high = low + height * 0.28;
        const double radius = height * (0.25 - 0.038 * tier);
        const shape_point cone[] = {{0, low + 0.06 * height}, {radius, low}, {0, high}};
        shape_lathe(mesh, (shb_vec3){0, 0, 0}, cone, 3, 14);
    }
}

typedef struct tree_kind {
    const owned_mesh *trunk, *crown;
    shb_cull crown_cull;
    scene_surface surface;
} tree_kind;

static void plant(example_scene *scene, const tree_kind *kind, shb_vec3 at, double scale,
                  double turn) {
    const shb_mat4 place =
        shb_mat4_multiply(shb_mat4_translation(at.x, at.y, at.z),
                          shb_mat4_multiply(shb_mat4_rotation((shb_vec3){0, 1, 0}, turn),
                                            shb_mat4_scaling(scale, scale, scale)));
    scene_add_instance(scene, kind->trunk, &place, SHB_CULL_BACK, &bark);
    scene_add_instance(scene, kind->crown, &place, kind->crown_cull, &kind->surface);
}

/* True where a tree finds room: level, on land, off the temple and the view of it. */
static bool may_grow(double x, double z) {
    const double slope = fabs(land_height(x + 0.4, z) - land_height(x - 0.4, z)) +
                         fabs(land_height(x, z + 0.4) - land_height(x, z - 0.4));
    const double tx = x - temple_x, tz = z - temple_z;
    const double before = 0.91 * tz - 0.42 * tx, beside = fabs(0.91 * tx + 0.42 * tz);
    return slope < 0.62 && !(before > 0 && beside < 3.2) &&
           sqrt(x * x + z * z) < 0.86 * shore(atan2(z, x)) &&
           sqrt(tx * tx + tz * tz) > temple_radius + 1.4;
}

static void add_trees(example_scene *scene) {
    tree_kind kinds[3] = {{.surface = {.color = {0.20f, 0.34f, 0.07f}}},
                          {.surface = {.color = {0.36f, 0.32f, 0.06f}}},
                          {.surface = {.color = {0.07f, 0.20f, 0.10f}}}};
    for (int i = 0; i < 3; i++) {
        owned_mesh *trunk = scene_add_mesh(scene), *crown = scene_add_mesh(scene);
        add_trunk(trunk, i == 2 ? 0.13 : 0.16, i == 2 ? 1.2 : 1.9);
        if (i == 2)
            add_conifer(crown, 3.6);
        else
            add_crown(crown, (shb_vec3){0, 2.2 + 0.2 * i, 0}, 1.15 - 0.1 * i, 260,
                      1000 * (uint32_t)i);
        kinds[i].trunk = trunk;
        kinds[i].crown = crown;
        kinds[i].crown_cull = i == 2 ? SHB_CULL_BACK : SHB_CULL_NONE;
    }
    int planted = 0;
    for (uint32_t i = 0; i < 900 && planted < 64; i++) {
        const double x = 15 * noise_random(9000 + 4 * i), z = 15 * noise_random(9001 + 4 * i);
        if (!may_grow(x, z))
            continue;
        const double pick = noise_random(9002 + 4 * i), size = noise_random(9003 + 4 * i);
        const int kind = land_height(x, z) > 3.4 || pick > 0.55 ? 2 : pick > 0 ? 1 : 0;
        plant(scene, &kinds[kind], (shb_vec3){x, land_height(x, z), z}, 0.85 + 0.25 * size,
              3 * pick);
        planted++;
    }
}

/* A round temple of eight columns on two steps under a shallow roof. */
static void add_temple(example_scene *scene) {
    owned_mesh *steps = scene_add_mesh(scene);
    const double r = temple_radius;
    const shape_point base[] = {{0, -1},          {r, -1},         {r, 0.25},
                                {0.92 * r, 0.25}, {0.92 * r, 0.5}, {0, 0.5}};
    shape_lathe(steps, (shb_vec3){0, 0, 0}, base, 6, 48);
    const shape_point beam[] = {{0, 3.4}, {0.9 * r, 3.4}, {0.9 * r, 3.85}, {0, 3.85}};
    shape_lathe(steps, (shb_vec3){0, 0, 0}, beam, 4, 48);
    owned_mesh *roof = scene_add_mesh(scene);
    const shape_point cone[] = {
        {0, 3.85}, {0.98 * r, 3.85}, {0.98 * r, 3.95}, {0.2, 5.0}, {0, 5.05}};
    shape_lathe(roof, (shb_vec3){0, 0, 0}, cone, 5, 48);
    owned_mesh *column = scene_add_mesh(scene);
    architecture_column(column, (shb_vec3){0, 0, 0}, 0.2, 2.9, 16);
    const shb_mat4 place = shb_mat4_translation(temple_x, temple_level, temple_z);
    scene_add_instance(scene, steps, &place, SHB_CULL_BACK, &marble);
    scene_add_instance(scene, roof, &place, SHB_CULL_BACK, &roof_tiles);
    for (int i = 0; i < 8; i++) {
        const double angle = pi * (i + 0.5) / 4, reach = 0.76 * r;
        const shb_mat4 at = shb_mat4_multiply(
            place, shb_mat4_translation(reach * cos(angle), 0.5, reach * sin(angle)));
        scene_add_instance(scene, column, &at, SHB_CULL_BACK, &marble);
    }
}

void scene_build_island(example_scene *scene, double unused) {
    (void)unused;
    add_rock(scene);
    add_temple(scene);
    add_trees(scene);
    scene_set_sun(scene, (shb_vec3){-0.80, 0.50, 0.10});
    scene_set_spot(scene, (shb_vec3){-22, 18, 12}, (shb_vec3){0, 1, 0}, 62 * pi / 180, 5, 60);
    scene->camera = (scene_camera){(shb_vec3){-14.5, 18.5, 28}, (shb_vec3){0.2, -0.9, 0},
                                   42 * pi / 180, 1, 120};
}
