#include "../src/chunk_whole.h"
#include "../src/cluster_list.h"
#include "../src/clusters.h"
#include "../src/context.h"

#include "contexts.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "target.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

#define SIZE 96

/* Layers are farther from each other than they are wide, so that clusters hold triangles of one
 * alone, and clusters are farthest first, as z rises towards the viewer; the instance brings it to
 * depth. */
#define MESH_DEPTH -4096.0

static shb_mat4 depth_from_mesh(void) {
    shb_mat4 m = shb_mat4_identity();
    m.m[10] = 1 / MESH_DEPTH;
    return m;
}

/* A bumpy patch of quads over the whole target, some of its corners at depth itself. */
static void add_layer(soup *s, test_random *random, int quads, double depth, double height) {
    float z[33][33];
    for (int j = 0; j <= quads; j++)
        for (int i = 0; i <= quads; i++)
            z[j][i] =
                (float)(depth + (random_below(random, 2) ? random_double(random, 0, height) : 0));
    for (int j = 0; j < quads; j++)
        for (int i = 0; i < quads; i++) {
            float p[4][3];
            for (int k = 0; k < 4; k++) {
                const int x = i + (k == 1 || k == 2), y = j + k / 2;
                p[k][0] = (float)x * SIZE / (float)quads;
                p[k][1] = (float)y * SIZE / (float)quads;
                p[k][2] = (float)MESH_DEPTH * z[y][x];
            }
            soup_add_quad(s, p[0], p[1], p[2], p[3]);
        }
}

/* Layers in no order of depth, the second one twice, so that ids decide. */
static void add_layers(soup *s, uint64_t seed, int count) {
    test_random random = {seed}, again;
    for (int i = 0; i < count; i++) {
        const double depth = random_double(&random, 0.1, 0.8);
        again = random;
        add_layer(s, &random, 32, depth, 0.05);
        if (i == 1)
            add_layer(s, &again, 32, depth, 0.05);
    }
}

static void check_same(const shb_draw_stats *a, const shb_draw_stats *b) {
    CHECK_INT(a->triangles, b->triangles);
    CHECK_INT(a->culled, b->culled);
    CHECK_INT(a->drawn, b->drawn);
}

/* As the mesh without clusters by the scalar code: all images, and statistics where they are asked
 * for. */
static void check_drawing(const test_contexts *contexts, const shb_mesh *mesh,
                          const shb_clusters *clusters, uint32_t tile_size, bool second) {
    const shb_view view = test_pixel_view(SIZE, SIZE);
    shb_mesh with = *mesh;
    with.clusters = clusters;
    const shb_instance instances[2] = {{.mesh = mesh, .world_from_mesh = depth_from_mesh()},
                                       {.mesh = &with, .world_from_mesh = depth_from_mesh()}};
    const shb_scene expected_scene = {&instances[0], 1}, scene = {&instances[1], 1};
    test_target expected = test_target_create(SIZE, SIZE), drawn = test_target_create(SIZE, SIZE);
    shb_draw_desc desc = test_target_desc(&expected, &view, &expected_scene);
    shb_draw_desc other = test_target_desc(&drawn, &view, &scene);
    if (!second)
        desc.second = other.second = (shb_depth_image){0};
    other.tile_size = tile_size;
    shb_draw_stats expected_stats, stats;
    CHECK_INT(shb_draw(contexts->scalar, &desc, &expected_stats), SHB_OK);
    CHECK_INT(shb_draw(contexts->best, &other, NULL), SHB_OK);
    CHECK(test_target_equal(&expected, &drawn));
    CHECK_INT(shb_draw(contexts->best, &other, &stats), SHB_OK);
    CHECK(test_target_equal(&expected, &drawn));
    check_same(&stats, &expected_stats);
    test_target_destroy(&expected);
    test_target_destroy(&drawn);
}

TEST(hidden_clusters_change_neither_images_nor_statistics) {
    for (uint32_t threads = 1; threads <= 3; threads += 2) {
        test_contexts *contexts = test_contexts_create(threads);
        for (uint64_t seed = 51; seed < 54; seed++) {
            soup s = {0};
            add_layers(&s, seed, 14);
            const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
            shb_clusters *clusters = NULL;
            CHECK_INT(shb_clusters_create(contexts->best, mesh, &clusters), SHB_OK);
            for (uint32_t tile_size = 0; tile_size <= 32; tile_size += 32)
                for (int second = 0; second < 2; second++)
                    check_drawing(contexts, mesh, clusters, tile_size, second);
            shb_clusters_destroy(clusters);
            soup_free(&s);
        }
        test_contexts_destroy(contexts);
    }
}

/* The clusters of layers as a drawing looks at them. */
typedef struct listed_layers {
    shb_context *context;
    shb_clusters *clusters;
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    shb_view view;
    shb_target target;
    shb_geometry geometry;
    shb_chunk *chunks;
    size_t count;
} listed_layers;

static listed_layers *list_layers(soup *s) {
    listed_layers *l = calloc(1, sizeof *l);
    l->context = test_context(0, SHB_ISA_BEST);
    l->mesh = *soup_scene(s)->instances[0].mesh;
    CHECK_INT(shb_clusters_create(l->context, &l->mesh, &l->clusters), SHB_OK);
    l->mesh.clusters = l->clusters;
    l->instance = (shb_instance){.mesh = &l->mesh, .world_from_mesh = depth_from_mesh()};
    l->scene = (shb_scene){&l->instance, 1};
    l->view = test_pixel_view(SIZE, SIZE);
    l->target = shb_target_of(SIZE, SIZE, false);
    const shb_draw_desc desc = {
        .scene = &l->scene, .view = &l->view, .width = SIZE, .height = SIZE};
    CHECK(shb_geometry_prepare(l->context, &desc, &l->target, &l->geometry));
    l->chunks = calloc(l->clusters->count, sizeof *l->chunks);
    bool doubtful = false;
    CHECK(shb_clusters_list(l->context, &l->geometry, &l->target, l->chunks, &l->count, &doubtful));
    CHECK_INT(l->count, l->clusters->count);
    return l;
}

static void free_listed(listed_layers *l) {
    free(l->chunks);
    shb_clusters_destroy(l->clusters);
    shb_context_destroy(l->context);
    free(l);
}

/* Two layers, each of 2 x 8 x 8 triangles: one cluster. */
TEST(a_cluster_behind_another_one_is_looked_at_only_to_be_counted) {
    test_random random = {55};
    soup s = {0};
    add_layer(&s, &random, 8, 0.25, 0.125);
    add_layer(&s, &random, 8, 0.5, 0.125);
    listed_layers *l = list_layers(&s);
    const shb_kernels *kernels = l->context->kernels;
    float *depth = calloc(SIZE * SIZE, sizeof *depth), *before = calloc(SIZE * SIZE, sizeof *depth);
    float *cells = calloc(shb_cells_count(SIZE, SIZE), sizeof *cells);
    const shb_layers layers = {
        .samples = l->target.samples, .pitch = SIZE, .nearest = depth, .cells = cells};
    const shb_draw_desc desc = {
        .view = &l->view, .width = SIZE, .height = SIZE, .depth = {.texels = depth}};
    shb_tile tile = shb_layers_tile(&layers, &desc, &l->target, false);
    if (kernels) {
        CHECK_INT(l->count, 2);
        const shb_chunk *farther = &l->chunks[0], *nearer = &l->chunks[1];
        CHECK_INT(kernels->draw(nearer, &tile), 128);
        memcpy(before, depth, SIZE * SIZE * sizeof *depth);
        CHECK_INT(kernels->draw(farther, &tile), 0);
        tile.counts = true;
        CHECK_INT(kernels->draw(farther, &tile), 128);
        CHECK(memcmp(before, depth, SIZE * SIZE * sizeof *depth) == 0);
        tile.counts = false;
        CHECK_INT(kernels->draw(nearer, &tile), 128);
    }
    free(cells);
    free(before);
    free(depth);
    free_listed(l);
    soup_free(&s);
}

/* Sixteen layers, the farthest first, come in eight ranges of depth; two stay as they are. */
TEST(clusters_of_many_layers_are_listed_nearest_first) {
    for (int layers = 2; layers <= 16; layers += 14) {
        test_random random = {56};
        soup s = {0};
        for (int i = 0; i < layers; i++)
            add_layer(&s, &random, 8, 0.875 - 0.05 * i, 0);
        listed_layers *l = list_layers(&s);
        const float range = l->chunks[0].cluster.nearest - l->chunks[l->count - 1].cluster.nearest;
        CHECK(layers == 2 ? range > 0 : range < 0);
        for (size_t i = 1; i < l->count; i++) {
            const float step = l->chunks[i].cluster.nearest - l->chunks[i - 1].cluster.nearest;
            CHECK(layers == 2 ? step < 0 : step > range / 8);
        }
        free_listed(l);
        soup_free(&s);
    }
}
