#include "../src/cluster_cull.h"
#include "../src/cover.h"
#include "../src/plane.h"

#include "contexts.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>

/* What is dropped with its cluster has to be what the scalar code culls triangle by triangle. */

typedef enum surface_kind {
    SURFACE_BALL,    /* closed: half of its clusters face away */
    SURFACE_FINE,    /* triangles far below a snapped coordinate */
    SURFACE_NEEDLES, /* a patch with thin triangles in it */
    SURFACE_FLAT,    /* a patch with triangles that have no area, and some twice the same corner */
    SURFACE_TURNING, /* a strip that winds round */
    SURFACE_RANDOM,
    SURFACE_KINDS
} surface_kind;

/* A patch of bumps of the height over [-1, 1]^2. */
static void add_patch(soup *s, test_random *random, int quads, double height) {
    float z[33][33];
    for (int j = 0; j <= quads; j++)
        for (int i = 0; i <= quads; i++)
            z[j][i] = (float)random_double(random, -height, height);
    for (int j = 0; j < quads; j++)
        for (int i = 0; i < quads; i++) {
            float p[4][3];
            for (int k = 0; k < 4; k++) {
                const int x = i + (k == 1 || k == 2), y = j + k / 2;
                p[k][0] = (float)(2.0 * x / quads - 1);
                p[k][1] = (float)(2.0 * y / quads - 1);
                p[k][2] = z[y][x];
            }
            soup_add_quad(s, p[0], p[1], p[2], p[3]);
        }
}

static void spoil_triangles(soup *s, test_random *random, bool flat) {
    for (uint32_t t = 0; t < s->count; t += 1 + random_below(random, 200)) {
        float *p = s->positions + 9 * (size_t)t;
        const double at = random_double(random, 0, 1);
        for (int i = 0; i < 3; i++)
            p[6 + i] = flat && t % 2 ? p[i] : (float)(p[i] + (p[3 + i] - p[i]) * (float)at);
        if (!flat)
            p[6 + random_below(random, 3)] += (float)random_double(random, -1e-4, 1e-4);
    }
}

static void add_strip(soup *s, test_random *random) {
    const double turn = random_double(random, 0.001, 0.2);
    for (int i = 0; i < 256; i++) {
        float p[4][3];
        for (int k = 0; k < 4; k++) {
            const double angle = turn * (i + (k == 1 || k == 2));
            p[k][0] = (float)cos(angle);
            p[k][1] = (float)sin(angle);
            p[k][2] = k / 2 ? 0.1f : 0.0f;
        }
        soup_add_quad(s, p[0], p[1], p[2], p[3]);
    }
}

static void make_surface(surface_kind kind, test_random *random, soup *s) {
    switch (kind) {
    case SURFACE_BALL:
        soup_add_ball(s, (const float[3]){0, 0, 0}, 32, 24, NULL);
        break;
    case SURFACE_FINE: {
        const float size = (float)pow(10, random_double(random, -3, -1.5));
        add_patch(s, random, 32, 0.01);
        for (uint32_t i = 0; i < 9 * s->count; i++)
            s->positions[i] *= size;
        break;
    }
    case SURFACE_NEEDLES:
    case SURFACE_FLAT:
        add_patch(s, random, 32, random_double(random, 0, 0.05));
        spoil_triangles(s, random, kind == SURFACE_FLAT);
        break;
    case SURFACE_TURNING:
        add_strip(s, random);
        break;
    default:
        for (int t = 0; t < 300; t++) {
            float p[9];
            for (int i = 0; i < 9; i++)
                p[i] = (float)random_double(random, -1, 1);
            soup_add(s, p, p + 3, p + 6);
        }
    }
}

static shb_view random_view(test_random *random) {
    const shb_vec3 eye = {random_double(random, -4, 4), random_double(random, -4, 4),
                          random_double(random, -4, 4)};
    const shb_vec3 target = {random_double(random, -1, 1), random_double(random, -1, 1),
                             random_double(random, -1, 1)};
    const shb_vec3 up = {0.1, 0.2, 1};
    shb_view view = {0};
    const bool reversed = random_below(random, 2);
    if (random_below(random, 2)) {
        const double size = pow(10, random_double(random, -2, 2));
        CHECK_INT(shb_view_orthographic(eye, target, up, size, size, -9, 9, reversed, &view),
                  SHB_OK);
    } else {
        const double angle = random_double(random, 0.05, 2.5);
        CHECK_INT(shb_view_perspective(eye, target, up, angle, 1, 0.01, HUGE_VAL, reversed, &view),
                  SHB_OK);
    }
    return view;
}

/* Turned, stretched, mirrored; now and then far from the origin, so that rounding is felt. */
static shb_mat4 random_transform(test_random *random) {
    const shb_vec3 axis = {random_double(random, -1, 1), random_double(random, -1, 1),
                           random_double(random, -1, 1)};
    shb_mat4 m = shb_mat4_rotation(axis, random_double(random, -3, 3));
    const double stretch[3] = {random_below(random, 2) ? -1 : 1, random_double(random, 0.2, 2), 1};
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++)
            m.m[4 * column + row] *= stretch[column];
    if (random_below(random, 4) == 0)
        m.m[12 + random_below(random, 3)] = pow(10, random_double(random, -1, 9));
    return m;
}

/* The way of shb_draw: canonical depth, which faces are kept. */
static shb_draw_instance instance_of(const shb_mesh *mesh, const shb_clusters *clusters,
                                     const shb_view *view, shb_mat4 world_from_mesh, int kept) {
    shb_mat4 m = shb_mat4_multiply(view->clip_from_world, world_from_mesh);
    for (int column = 0; view->reversed && column < 4; column++)
        m.m[4 * column + 2] = -m.m[4 * column + 2];
    return (shb_draw_instance){.mesh = mesh,
                               .clusters = clusters,
                               .clip_from_mesh = m,
                               .affine = m.m[3] == 0 && m.m[7] == 0 && m.m[11] == 0 && m.m[15] == 1,
                               .keep_positive = kept != 1,
                               .keep_negative = kept != 2};
}

static bool is_usable(const shb_target *target, const shb_clip_position corners[3]) {
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 3; k++) {
            const shb_clip_plane *plane = &target->volume.cut[i];
            if (!(plane->sign * corners[k].v[plane->axis] + plane->offset * corners[k].v[3] >= 0))
                return false;
        }
    return true;
}

/* The nearest depth of what is drawn; rows of small targets alone, which take less time. */
static float nearest_drawn(const shb_target *target, const shb_shape *shape) {
    const shb_samples box = shb_samples_intersect(shape->samples, target->samples);
    const shb_plane plane = shb_plane_of(target, shape);
    const shb_cover cover = shb_cover_of(shape, box);
    float nearest = HUGE_VALF;
    for (int32_t row = box.first_row; target->samples.last_row < 64 && row <= box.last_row; row++) {
        shb_run runs[SHB_RUNS_MAX];
        const size_t count = shb_cover_row(&cover, row, runs);
        for (size_t i = 0; i < count; i++) {
            const int32_t ends[2] = {runs[i].first, runs[i].end - 1};
            for (int k = 0; k < 2; k++) {
                float depth;
                shb_plane_depths(&plane, ends[k] - shape->samples.first_column,
                                 row - shape->samples.first_row, 1, &depth);
                nearest = depth < nearest ? depth : nearest;
            }
        }
    }
    return nearest;
}

typedef struct tally {
    size_t dropped, plain, doubtful;
} tally;

/* True if the triangle's snapped corners are near enough to the cluster's origin. */
static bool is_within_reach(const shb_seen_cluster *seen, const shb_shape *shape) {
    bool within = true;
    for (int k = 0; k < 3; k++)
        within &= abs(shape->snapped_x[k] - 256 * seen->origin_x) <= SHB_PAIR_REACH &&
                  abs(shape->snapped_y[k] - 256 * seen->origin_y) <= SHB_PAIR_REACH;
    return within;
}

/* False if something is wrong with what is said about the cluster. */
static bool check_cluster(const shb_target *target, const shb_draw_instance *instance,
                          const shb_cluster *cluster, tally *counts) {
    const shb_cluster_view view = shb_cluster_view_of(instance, target);
    shb_seen_cluster seen;
    const shb_cluster_fate fate = shb_cluster_look(&view, cluster, &seen);
    counts->dropped += fate == SHB_CLUSTER_DROPPED;
    counts->plain += fate == SHB_CLUSTER_PLAIN;
    counts->doubtful += fate == SHB_CLUSTER_DOUBTFUL;
    bool right = true;
    for (uint32_t t = 0; t < cluster->triangle_count; t++) {
        shb_clip_position corners[3];
        shb_shape shape;
        shb_geometry_corners(instance, instance->clusters->triangles[cluster->first_triangle + t],
                             corners);
        const shb_outcome outcome = shb_shape_prepare(target, instance, corners, &shape);
        if (fate == SHB_CLUSTER_DROPPED)
            right &= outcome == SHB_OUTCOME_CULLED;
        if (fate == SHB_CLUSTER_PLAIN)
            right &= outcome != SHB_OUTCOME_NOT_FINITE && is_usable(target, corners);
        if (fate != SHB_CLUSTER_PLAIN || outcome != SHB_OUTCOME_DRAWN)
            continue;
        right &= !seen.is_small || is_within_reach(&seen, &shape);
        const shb_samples part = shb_samples_intersect(shape.samples, target->samples);
        const shb_samples both = shb_samples_intersect(part, seen.samples);
        right &= both.first_column == part.first_column && both.first_row == part.first_row &&
                 both.last_column == part.last_column && both.last_row == part.last_row &&
                 nearest_drawn(target, &shape) >= seen.nearest;
    }
    return right;
}

static void check_clusters(const shb_target *target, const shb_draw_instance *instance,
                           tally *counts) {
    const shb_clusters *clusters = instance->clusters;
    for (size_t i = 0; i < clusters->count; i++)
        CHECK(check_cluster(target, instance, &clusters->clusters[i], counts));
}

static shb_clusters *make_clusters(shb_context *context, soup *s) {
    shb_clusters *clusters = NULL;
    CHECK_INT(shb_clusters_create(context, soup_scene(s)->instances[0].mesh, &clusters), SHB_OK);
    return clusters;
}

static void check_surface(shb_context *context, surface_kind kind, test_random *random,
                          tally *counts) {
    soup s = {0};
    make_surface(kind, random, &s);
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_clusters *clusters = make_clusters(context, &s);
    for (int trial = 0; trial < 12; trial++) {
        const shb_view view = random_view(random);
        const shb_target target = shb_target_of(16u << random_below(random, 8),
                                                16u << random_below(random, 8), view.reversed);
        const shb_draw_instance instance = instance_of(
            mesh, clusters, &view, random_transform(random), (int)random_below(random, 3));
        check_clusters(&target, &instance, counts);
    }
    shb_clusters_destroy(clusters);
    soup_free(&s);
}

TEST(clusters_are_dropped_only_with_all_of_their_triangles) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    test_random random = {41};
    size_t doubtful = 0;
    for (surface_kind kind = 0; kind < SURFACE_KINDS; kind++) {
        tally counts = {0};
        for (int i = 0; i < 20; i++)
            check_surface(context, kind, &random, &counts);
        CHECK(counts.dropped > 100 && counts.plain > 10);
        doubtful += counts.doubtful;
    }
    CHECK(doubtful > 50);
    shb_context_destroy(context);
}

/* A ball before the eye: about half of its triangles face away, most of them in clusters that do so
 * as a whole. */
TEST(clusters_of_a_ball_that_face_away_are_dropped) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    soup s = {0};
    soup_add_ball(&s, (const float[3]){0, 0, 0}, 128, 64, NULL);
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_clusters *clusters = make_clusters(context, &s);
    for (int way = 0; way < 4; way++) {
        shb_view view = {0};
        const shb_vec3 eye = {9, 1, 2}, middle = {0, 0, 0}, up = {0, 0, 1};
        if (way % 2)
            CHECK_INT(shb_view_orthographic(eye, middle, up, 2, 2, 1, 20, false, &view), SHB_OK);
        else
            CHECK_INT(shb_view_perspective(eye, middle, up, 0.5, 1, 1, 20, false, &view), SHB_OK);
        const shb_target target = shb_target_of(512, 512, false);
        const shb_draw_instance instance =
            instance_of(mesh, clusters, &view, shb_mat4_identity(), way < 2 ? 1 : 2);
        tally counts = {0};
        check_clusters(&target, &instance, &counts);
        const double dropped = (double)counts.dropped / (double)clusters->count;
        CHECK(dropped > 0.15 && dropped < 0.5);
        CHECK_INT(counts.doubtful, 0);
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}

/* Clusters beside, above, below and behind the eye. */
TEST(clusters_outside_of_the_view_are_dropped) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    test_random random = {42};
    soup s = {0};
    add_patch(&s, &random, 8, 0.01);
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_clusters *clusters = make_clusters(context, &s);
    shb_view view = {0};
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 5}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                   0.6, 1, 1, 20, false, &view),
              SHB_OK);
    const double places[6][3] = {{9, 0, 0},  {-9, 0, 0}, {0, 9, 0},
                                 {0, -9, 0}, {0, 0, 9},  {0, 0, 0}};
    const shb_target target = shb_target_of(64, 64, false);
    for (int i = 0; i < 6; i++) {
        const shb_draw_instance instance =
            instance_of(mesh, clusters, &view,
                        shb_mat4_translation(places[i][0], places[i][1], places[i][2]), 0);
        tally counts = {0};
        check_clusters(&target, &instance, &counts);
        CHECK_INT(counts.dropped, i < 5 ? clusters->count : 0);
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}

/* So far to a side or so large that drawing reports their triangles as not finite. */
TEST(clusters_that_are_not_finite_are_left_to_drawing) {
    shb_context *context = test_context(0, SHB_ISA_BEST);
    test_random random = {43};
    soup s = {0};
    add_patch(&s, &random, 8, 0.01);
    const shb_mesh *mesh = soup_scene(&s)->instances[0].mesh;
    shb_clusters *clusters = make_clusters(context, &s);
    const shb_target target = shb_target_of(64, 64, false);
    for (int way = 0; way < 6; way++) {
        const shb_vec3 eye = {0, 0, 5}, middle = {0, 0, 0}, up = {0, 1, 0};
        shb_view view = {0};
        if (way % 2)
            CHECK_INT(shb_view_orthographic(eye, middle, up, 4, 4, 1, 20, false, &view), SHB_OK);
        else
            CHECK_INT(shb_view_perspective(eye, middle, up, 0.6, 1, 1, 20, false, &view), SHB_OK);
        double place[3] = {0};
        place[way / 2] = 1e100;
        const shb_draw_instance instance = instance_of(
            mesh, clusters, &view, shb_mat4_translation(place[0], place[1], place[2]), 0);
        tally counts = {0};
        check_clusters(&target, &instance, &counts);
        CHECK_INT(counts.doubtful, clusters->count);
    }
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    soup_free(&s);
}
