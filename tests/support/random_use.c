#include "random_use.h"

#include "random.h"

#include <math.h>
#include <string.h>

/* One number of so many is absurd. */
typedef struct source {
    test_random random;
    uint32_t rarity;
} source;

static uint32_t below(source *from, uint32_t count) {
    return random_below(&from->random, count);
}

static bool seldom(source *from, uint32_t rarity) {
    return below(from, rarity) == 0;
}

static float absurd(source *from) {
    static const float values[] = {NAN, INFINITY, -INFINITY, 0, 1e30f, -1e38f, 1e-40f, 16777216};
    return values[below(from, sizeof values / sizeof *values)];
}

static float number_of(source *from, uint32_t rarity) {
    return seldom(from, rarity) ? absurd(from) : (float)random_double(&from->random, -2, 2);
}

static float number(source *from) {
    return number_of(from, from->rarity);
}

/* There are few of these, and one that is absurd spoils the whole use. */
static double dear_number(source *from) {
    return (double)number_of(from, 20 * from->rarity);
}

static void fill(source *from, float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        values[i] = number(from);
}

/* Triangles between any vertices. */
static void make_soup(source *from, random_use *use) {
    const uint32_t vertices = 3 + below(from, USE_VERTICES - 2);
    fill(from, use->vertices, USE_VERTICES * 3);
    for (int i = 0; i < USE_TRIANGLES * 3; i++)
        use->wide[i] = below(from, vertices);
    use->mesh.vertex_count = vertices;
    use->mesh.triangle_count = below(from, USE_TRIANGLES + 1);
}

/* Two triangles of a surface's square, split along either diagonal. */
static void split_square(source *from, uint32_t corner, uint32_t *indices) {
    const uint32_t right = corner + 1, down = corner + USE_SIDE, across = down + 1;
    const uint32_t falling[6] = {corner, down, across, corner, across, right};
    const uint32_t rising[6] = {corner, down, right, right, down, across};
    memcpy(indices, below(from, 2) ? falling : rising, sizeof falling);
}

/* A surface with dents, as meshes are: neighbours share edges. */
static void make_surface(source *from, random_use *use) {
    const double roughness = random_double(&from->random, 0, 0.4);
    for (uint32_t i = 0; i < USE_VERTICES; i++) {
        float *vertex = use->vertices + 3 * i;
        for (int axis = 0; axis < 3; axis++)
            vertex[axis] = (float)roughness * number(from);
        vertex[0] += (float)(i % USE_SIDE) * 4.0f / (USE_SIDE - 1) - 2;
        vertex[2] += (float)(i / USE_SIDE) * 4.0f / (USE_SIDE - 1) - 2;
    }
    uint32_t *indices = use->wide;
    for (uint32_t row = 0; row + 1 < USE_SIDE; row++)
        for (uint32_t column = 0; column + 1 < USE_SIDE; column++, indices += 6)
            split_square(from, row * USE_SIDE + column, indices);
    use->mesh.vertex_count = USE_VERTICES;
    use->mesh.triangle_count = USE_TRIANGLES - below(from, 3) * 30;
}

static void make_scene(source *from, random_use *use) {
    if (below(from, 2))
        make_soup(from, use);
    else
        make_surface(from, use);
    for (int i = 0; i < USE_TRIANGLES * 3; i++)
        use->narrow[i] = (uint16_t)use->wide[i];
    fill(from, use->shading_normals, USE_VERTICES * 3);
    const bool narrow = below(from, 2);
    use->mesh.positions = use->vertices;
    use->mesh.normals = below(from, 2) ? use->shading_normals : NULL;
    use->mesh.indices = narrow ? (const void *)use->narrow : use->wide;
    use->mesh.index_size = narrow ? 2 : 4;
    for (int k = 0; k < USE_INSTANCES; k++) {
        use->instances[k] = (shb_instance){.mesh = &use->mesh, .cull = (shb_cull)below(from, 3)};
        double *m = use->instances[k].world_from_mesh.m;
        for (int i = 0; k > 0 && i < 16; i++)
            m[i] = i % 4 == 3 ? i == 15 : dear_number(from);
    }
    use->scene = (shb_scene){use->instances, below(from, USE_INSTANCES + 1)};
}

/* A view that is refused is all zeros. */
static void make_view(source *from, shb_view *view) {
    const bool reversed = below(from, 2);
    const shb_vec3 up = {0, 1, 0}, target = {0, 0, 0};
    const shb_vec3 eye = {dear_number(from), 5, 1};
    const double near_distance = fabs(dear_number(from)) + 0.01;
    switch (below(from, 3)) {
    case 0:
        (void)shb_view_perspective(eye, target, up, 0.8, 1, near_distance, 20, reversed, view);
        break;
    case 1:
        (void)shb_view_orthographic(eye, target, up, 2.5, 2.5, near_distance, 20, reversed, view);
        break;
    default:
        for (int i = 0; i < 16; i++)
            view->clip_from_world.m[i] = dear_number(from);
    }
}

static void make_map(source *from, random_use *use) {
    use->map = (shb_map_desc){.width = 1 + below(from, 200),
                              .height = below(from, 120),
                              .format = (shb_format)below(from, 3),
                              .occluders = (shb_occluders)below(from, 4),
                              .occluder_memory = seldom(from, 4) ? 100000 : 0,
                              .classifies = seldom(from, 3)};
    use->map.exact_only = use->map.occluders == SHB_OCCLUDERS_LISTS && below(from, 2);
    make_view(from, &use->map.view);
}

static shb_bias random_bias(source *from) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    shb_bias bias =
        seldom(from, 3) ? shb_bias_exact() : methods[below(from, (uint32_t)count)].make();
    for (int i = 0; i < SHB_PARAMS_MAX; i++)
        if (seldom(from, from->rarity))
            bias.params[i] = absurd(from);
    return bias;
}

static void make_methods(source *from, random_use *use) {
    size_t count;
    const shb_filter_method *filters = shb_filter_methods(&count);
    use->bias = random_bias(from);
    use->drawn_for = seldom(from, 4) ? random_bias(from) : use->bias;
    use->filter =
        seldom(from, 4) ? shb_filter_hard() : filters[below(from, (uint32_t)count)].make();
    for (int i = 0; i < SHB_PARAMS_MAX; i++)
        if (seldom(from, from->rarity))
            use->filter.params[i] = number_of(from, 2);
    use->prepares = !seldom(from, 8);
}

/* A point of one of the first instance's triangles, which stands where the mesh does. */
static void put_on_triangle(source *from, random_use *use, size_t i) {
    const uint32_t id = below(from, use->mesh.triangle_count);
    const double b = random_double(&from->random, 0, 1), c = (1 - b) * b;
    const float *corners[3];
    for (int k = 0; k < 3; k++)
        corners[k] = use->vertices + 3 * (size_t)use->wide[3 * id + (uint32_t)k];
    use->ids[i] = id;
    use->weight_1[i] = (float)b;
    use->weight_2[i] = (float)c;
    for (int axis = 0; axis < 3; axis++)
        use->positions[3 * i + (size_t)axis] =
            (float)((1 - b - c) * (double)corners[0][axis] + b * (double)corners[1][axis] +
                    c * (double)corners[2][axis]);
}

/* Points on triangles with what is known of these, points that touch vertices, and points anywhere.
 */
static void make_points(source *from, random_use *use) {
    const bool are_own = below(from, 2) && use->scene.instance_count && use->mesh.triangle_count;
    fill(from, use->positions, USE_POINTS * 3);
    fill(from, use->normals, USE_POINTS * 3);
    for (size_t i = 0; i < USE_POINTS; i++) {
        if (are_own)
            put_on_triangle(from, use, i);
        else if (i % 3 == 0)
            memcpy(use->positions + 3 * i, use->vertices + 3 * (i % USE_VERTICES),
                   3 * sizeof(float));
        if (seldom(from, 100 * from->rarity))
            use->ids[i] = below(from, 2) ? SHB_ID_NONE : 1u << 30;
        if (seldom(from, 4 * from->rarity))
            use->weight_1[i] = number_of(from, 2);
    }
    const bool are_weighted = below(from, 2);
    use->points = (shb_points){.count = below(from, USE_POINTS + 1),
                               .positions = use->positions,
                               .normals = seldom(from, 8) ? NULL : use->normals,
                               .own = {are_own ? use->ids : NULL,
                                       are_own && are_weighted ? use->weight_1 : NULL,
                                       are_own && are_weighted ? use->weight_2 : NULL}};
}

void random_use_make(uint64_t seed, random_use *use) {
    source from = {.random = {seed}};
    from.rarity = below(&from, 3) ? 1000 : 12;
    random_bits(&from.random);
    memset(use, 0, sizeof *use);
    make_scene(&from, use);
    make_map(&from, use);
    make_methods(&from, use);
    make_points(&from, use);
    make_view(&from, &use->camera);
    use->light_count = below(&from, USE_LIGHTS + 1);
    use->smooth_terminator = seldom(&from, 3);
}
