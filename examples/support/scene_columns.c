/* A court between two arcades, partly covered: some 20 thousand triangles, with large flat
 * receivers, curved shafts, deep arches, cloth without thickness and many lines of contact. */
#include "scenes_builtin.h"

#include "architecture.h"
#include "shapes.h"

#include <math.h>

static const double degree = 3.14159265358979323846 / 180;

/* World units are metres; the court runs along x. */
enum { bays = 6 };
static const double bay = 3.2;
static const double row_z = 3.3;  /* the middle of a row of columns */
static const double wall_z = 6.7; /* the outer walls */
static const double column_height = 3.4;
static const double column_radius = 0.31;
static const double gallery_floor = 5.5;
static const double top = 8.6;

static const scene_surface limestone = {.color = {0.66f, 0.58f, 0.45f}};
static const scene_surface sandstone = {.color = {0.58f, 0.44f, 0.30f}};
static const scene_surface plaster = {.color = {0.70f, 0.63f, 0.52f}};
static const scene_surface wood = {.color = {0.30f, 0.19f, 0.11f}};
static const scene_surface terracotta = {.color = {0.55f, 0.22f, 0.11f}};
static const scene_surface marble = {.color = {0.74f, 0.73f, 0.70f}};
static const scene_surface pavement = {.color = {0.58f, 0.53f, 0.45f},
                                       .second = {0.40f, 0.31f, 0.25f},
                                       .pattern = SCENE_TILES,
                                       .tile_size = 0.8f};

/* The middle of a column: number 0 .. bays in its row, side -1 or 1. */
static shb_vec3 column_base(int number, int side) {
    return (shb_vec3){(number - 0.5 * bays) * bay, 0, side * row_z};
}

static void add_columns(example_scene *scene) {
    owned_mesh *column = scene_add_mesh(scene);
    architecture_column(column, (shb_vec3){0, 0, 0}, column_radius, column_height, 20);
    for (int side = -1; side <= 1; side += 2)
        for (int i = 0; i <= bays; i++) {
            const shb_vec3 base = column_base(i, side);
            const shb_mat4 place = shb_mat4_translation(base.x, base.y, base.z);
            scene_add_instance(scene, column, &place, SHB_CULL_BACK, &limestone);
        }
}

/* Ground floor arches, gallery with smaller arches on short pillars, and a cornice. */
static void add_arcades(example_scene *scene) {
    owned_mesh *lower = scene_add_solid(scene, &sandstone),
               *upper = scene_add_solid(scene, &plaster);
    owned_mesh *trim = scene_add_solid(scene, &limestone);
    const double half = 0.5 * bays * bay, sill = gallery_floor + 0.9;
    for (int side = -1; side <= 1; side += 2) {
        const double z = side * row_z;
        architecture_arcade(lower, &(arcade_shape){bays, 20, bay, 0.84, column_height,
                                                   gallery_floor, z - 0.3, z + 0.3});
        architecture_arcade(upper, &(arcade_shape){2 * bays, 10, 0.5 * bay, 0.5, sill + 0.75, top,
                                                   z - 0.22, z + 0.22});
        for (int i = 0; i <= 2 * bays; i++) {
            const double x = (0.5 * i - 0.5 * bays) * bay;
            const double from = i == 0 ? -half : x - 0.25, to = i == 2 * bays ? half : x + 0.25;
            shape_box(upper, (shb_vec3){from, sill, z - 0.22},
                      (shb_vec3){to, sill + 0.75, z + 0.22});
        }
        shape_box(upper, (shb_vec3){-half, gallery_floor, z - 0.22},
                  (shb_vec3){half, sill, z + 0.22});
        shape_box(trim, (shb_vec3){-half, gallery_floor - 0.12, z - 0.40},
                  (shb_vec3){half, gallery_floor + 0.06, z + 0.40});
        shape_box(trim, (shb_vec3){-half, top, z - 0.42}, (shb_vec3){half, top + 0.25, z + 0.42});
    }
}

/* Floor, outer walls, the vaults over the aisles and the roofs over the galleries. */
static void add_shell(example_scene *scene) {
    const double half = 0.5 * bays * bay, end = half + 0.5, aisle = wall_z - row_z - 0.3;
    shape_box(scene_add_solid(scene, &pavement), (shb_vec3){-end, -0.3, -wall_z - 0.5},
              (shb_vec3){end, 0, wall_z + 0.5});
    owned_mesh *walls = scene_add_solid(scene, &plaster), *vaults = scene_add_mesh(scene);
    architecture_arcade(vaults, &(arcade_shape){1, 24, aisle, 0, column_height + 0.35,
                                                gallery_floor - 0.15, -half, half});
    for (int side = -1; side <= 1; side += 2) {
        const double inner = side * wall_z, outer = side * (wall_z + 0.5);
        shape_box(walls, (shb_vec3){-end, 0, fmin(inner, outer)},
                  (shb_vec3){end, top, fmax(inner, outer)});
        const double roof = side * (row_z - 0.1);
        shape_box(walls, (shb_vec3){-end, top + 0.25, fmin(roof, outer)},
                  (shb_vec3){end, top + 0.5, fmax(roof, outer)});
        const shb_mat4 turned =
            shb_mat4_multiply(shb_mat4_translation(0, 0, side * (row_z + 0.3 + aisle / 2)),
                              shb_mat4_rotation((shb_vec3){0, 1, 0}, 90 * degree));
        scene_add_instance(scene, vaults, &turned, SHB_CULL_BACK, &plaster);
    }
}

/* The short sides: a wall with a gate at the far end, beams across the open court. */
static void add_ends(example_scene *scene) {
    const double half = 0.5 * bays * bay;
    owned_mesh *gate = scene_add_mesh(scene);
    architecture_arcade(gate,
                        &(arcade_shape){1, 24, 2 * wall_z, 2 * wall_z - 3.6, 2.6, top, 0, 0.5});
    for (int side = -1; side <= 1; side += 2)
        shape_box(gate, (shb_vec3){side < 0 ? -wall_z : 1.8, 0, 0},
                  (shb_vec3){side < 0 ? -1.8 : wall_z, 2.6, 0.5});
    for (int side = -1; side <= 1; side += 2) {
        const shb_mat4 turned =
            shb_mat4_multiply(shb_mat4_translation(side * half, 0, 0),
                              shb_mat4_rotation((shb_vec3){0, 1, 0}, side * 90 * degree));
        scene_add_instance(scene, gate, &turned, SHB_CULL_BACK, &sandstone);
    }
    owned_mesh *beams = scene_add_solid(scene, &wood);
    for (int i = 0; i <= 2 * bays; i++) {
        const double x = (0.5 * i - 0.5 * bays) * bay;
        shape_box(beams, (shb_vec3){x - 0.10, top - 0.35, -row_z},
                  (shb_vec3){x + 0.10, top - 0.05, row_z});
    }
}

/* A length of cloth between two columns, in folds that widen towards the hem. */
static void add_curtain(example_scene *scene, int number, int side, double shift,
                        const scene_surface *surface) {
    enum { columns = 41, rows = 9 };
    shb_vec3 points[columns * rows];
    const double left = column_base(number, side).x + 0.5, width = bay - 1.0;
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < columns; column++) {
            const double u = (double)column / (columns - 1), v = (double)row / (rows - 1);
            const double depth = 0.05 + 0.10 * (1 - v);
            const double fold = sin(26 * u + shift) + 0.4 * sin(17 * u + 2 * shift);
            points[row * columns + column] =
                (shb_vec3){left + width * (u + shift * 0.02 * (1 - v) * sin(6.28 * u)),
                           0.35 + (column_height - 0.55) * v, side * row_z + depth * fold};
        }
    owned_mesh *cloth = scene_add_mesh(scene);
    shape_grid(cloth, points, columns, rows, false);
    scene_add_instance(scene, cloth, NULL, SHB_CULL_NONE, surface);
    owned_mesh *rod = scene_add_solid(scene, &wood);
    const double y = column_height - 0.2;
    shape_box(rod, (shb_vec3){left - 0.45, y, side * row_z - 0.03},
              (shb_vec3){left + width + 0.45, y + 0.06, side * row_z + 0.03});
}

static void add_curtains(example_scene *scene) {
    const scene_surface crimson = {.color = {0.52f, 0.05f, 0.06f}};
    const scene_surface green = {.color = {0.09f, 0.30f, 0.13f}};
    const scene_surface indigo = {.color = {0.08f, 0.13f, 0.42f}};
    add_curtain(scene, 1, -1, 0.3, &crimson);
    add_curtain(scene, 2, -1, 1.9, &green);
    add_curtain(scene, 4, -1, 1.1, &indigo);
    add_curtain(scene, 2, 1, 0.8, &indigo);
    add_curtain(scene, 4, 1, 2.6, &crimson);
}

/* What stands in the court: a fountain, pots and benches. */
static void add_furniture(example_scene *scene) {
    owned_mesh *basin = scene_add_solid(scene, &marble);
    const shape_point bowl[] = {
        {0, 0},       {1.35, 0},    {1.35, 0.16}, {1.22, 0.2},  {1.22, 0.5}, {1.32, 0.56},
        {1.32, 0.66}, {1.12, 0.66}, {1.08, 0.36}, {0.3, 0.34},  {0.2, 0.5},  {0.15, 0.95},
        {0.2, 1.1},   {0.6, 1.28},  {0.66, 1.36}, {0.58, 1.37}, {0.2, 1.22}, {0, 1.2}};
    shape_lathe(basin, (shb_vec3){1.1, 0, 0}, bowl, sizeof bowl / sizeof *bowl, 32);
    shape_ball(basin, (shb_vec3){1.1, 1.42, 0}, 0.24, 32);
    owned_mesh *pot = scene_add_mesh(scene);
    const shape_point side[] = {{0, 0},       {0.20, 0},    {0.22, 0.05}, {0.20, 0.1},
                                {0.33, 0.38}, {0.36, 0.55}, {0.30, 0.72}, {0.24, 0.78},
                                {0.30, 0.84}, {0.30, 0.88}, {0.25, 0.88}, {0.2, 0.74},
                                {0, 0.7}};
    shape_lathe(pot, (shb_vec3){0, 0, 0}, side, sizeof side / sizeof *side, 16);
    const double pots[][3] = {{-2.9, 2.45, 1},  {-2.2, 2.5, 0.7}, {-1.6, -2.3, 0.95},
                              {4.8, -2.2, 1.1}, {4.6, 2.3, 0.9},  {-8.0, -2.2, 1}};
    for (size_t i = 0; i < sizeof pots / sizeof *pots; i++) {
        const double scale = pots[i][2];
        const shb_mat4 place = shb_mat4_multiply(shb_mat4_translation(pots[i][0], 0, pots[i][1]),
                                                 shb_mat4_scaling(scale, scale, scale));
        scene_add_instance(scene, pot, &place, SHB_CULL_BACK, &terracotta);
    }
    shape_box(scene_add_solid(scene, &marble), (shb_vec3){-4.9, 0, -2.2},
              (shb_vec3){-3.3, 0.44, -1.7});
    owned_mesh *pedestal = scene_add_solid(scene, &limestone);
    shape_box(pedestal, (shb_vec3){-1.6, 0, -1.3}, (shb_vec3){-0.9, 1.15, -0.6});
    shape_ball(pedestal, (shb_vec3){-1.25, 1.45, -0.95}, 0.3, 32);
}

/* A board that leans on a low block: its shadow narrows to nothing where it meets the floor. */
static void add_ramp(example_scene *scene) {
    const double x = -2.1, run = 1.5, rise = 0.38, thickness = 0.01;
    const shape_point outline[] = {
        {x, 0}, {x, thickness}, {x - run, rise + thickness}, {x - run, rise}};
    shape_prism(scene_add_solid(scene, &wood), outline, 4, -0.75, 0.05);
    shape_box(scene_add_solid(scene, &sandstone), (shb_vec3){x - run + 0.05, 0, -0.65},
              (shb_vec3){x - run + 0.25, 0.31, -0.05});
    for (int kind = 0; kind < SCENE_LIGHT_KINDS; kind++)
        scene->lights[kind].contact = (scene_contact){{x, 0, -0.35}, {-1, 0, 0}, {0, 1, 0}, 0.8};
}

void scene_build_columns(example_scene *scene, double unused) {
    (void)unused;
    add_shell(scene);
    add_columns(scene);
    add_arcades(scene);
    add_ends(scene);
    add_curtains(scene);
    add_furniture(scene);
    scene_set_sun(scene, (shb_vec3){-0.34, 0.88, 0.23});
    scene_set_spot(scene, (shb_vec3){-6.5, 7.4, 2.2}, (shb_vec3){0.6, 0.6, -0.9}, 85 * degree, 0.5,
                   22);
    add_ramp(scene);
    scene->camera = (scene_camera){(shb_vec3){-7.0, 1.8, 2.3}, (shb_vec3){0.4, 1.75, -1.9},
                                   56 * degree, 0.1, 60};
    scene->ambient = 0.30f;
}
