#include "allocator.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Random uses of the library, sound and absurd ones. Whatever a host hands over, there is an answer
 * or an error with a sentence; scalar code on one thread and kernels on three, with clusters, say
 * the same, to the bit; nothing leaks, also where memory ends at any allocation. SHB_RANDOM_USES
 * sets their number.
 */

enum { VERTICES = 300, TRIANGLES = 600, POINTS = 400, INSTANCES = 3, USES = 250 };

/* What a host hands over. */
typedef struct usage {
    float vertices[VERTICES * 3], positions[POINTS * 3], normals[POINTS * 3];
    uint32_t wide[TRIANGLES * 3];
    uint16_t narrow[TRIANGLES * 3];
    shb_mesh mesh;
    shb_instance instances[INSTANCES];
    shb_scene scene;
    shb_map_desc map;
    shb_bias drawn_for, bias;
    shb_filter filter;
    shb_points points;
    bool prepares;
} usage;

/* What comes of it: by which call it ended, how, and the answers. */
typedef struct outcome {
    int call;
    shb_result result;
    shb_draw_stats stats;
    float visibility[POINTS];
} outcome;

static const float untouched = -7;

static float absurd(test_random *random) {
    static const float values[] = {NAN, INFINITY, -INFINITY, 0, 1e30f, -1e38f, 1e-40f, 16777216};
    return values[random_below(random, sizeof values / sizeof *values)];
}

/* One number of rarity is absurd. */
static float number(test_random *random, uint32_t rarity) {
    return random_below(random, rarity) ? (float)random_double(random, -2, 2) : absurd(random);
}

static void fill(test_random *random, uint32_t rarity, float *values, size_t count) {
    for (size_t i = 0; i < count; i++)
        values[i] = number(random, rarity);
}

static void make_scene(test_random *random, uint32_t rarity, usage *use) {
    const uint32_t vertices = 3 + random_below(random, VERTICES - 2);
    const bool narrow = random_below(random, 2);
    fill(random, rarity, use->vertices, VERTICES * 3);
    for (int i = 0; i < TRIANGLES * 3; i++) {
        use->wide[i] = random_below(random, vertices);
        use->narrow[i] = (uint16_t)use->wide[i];
    }
    use->mesh = (shb_mesh){.positions = use->vertices,
                           .vertex_count = vertices,
                           .indices = narrow ? (const void *)use->narrow : use->wide,
                           .index_size = narrow ? 2 : 4,
                           .triangle_count = random_below(random, TRIANGLES + 1)};
    for (int k = 0; k < INSTANCES; k++) {
        use->instances[k] =
            (shb_instance){.mesh = &use->mesh, .cull = (shb_cull)random_below(random, 3)};
        double *m = use->instances[k].world_from_mesh.m;
        for (int i = 0; k > 0 && i < 16; i++)
            m[i] = i % 4 == 3 ? i == 15 : (double)number(random, 40 * rarity);
    }
    use->scene = (shb_scene){use->instances, random_below(random, INSTANCES + 1)};
}

static void make_map(test_random *random, uint32_t rarity, usage *use) {
    use->map = (shb_map_desc){.width = 1 + random_below(random, 200),
                              .height = random_below(random, 120),
                              .format = (shb_format)random_below(random, 3),
                              .occluders = (shb_occluders)random_below(random, 4),
                              .occluder_memory = random_below(random, 4) ? 0 : 100000};
    const bool reversed = random_below(random, 2);
    const shb_vec3 up = {0, 1, 0}, target = {0, 0, 0};
    const shb_vec3 eye = {(double)number(random, 20 * rarity), 5, 1};
    const double near_distance = (double)fabsf(number(random, 20 * rarity)) + 0.01;
    shb_view *view = &use->map.view;
    shb_result result = SHB_OK;
    switch (random_below(random, 3)) {
    case 0:
        result = shb_view_perspective(eye, target, up, 0.8, 1, near_distance, 20, reversed, view);
        break;
    case 1:
        result =
            shb_view_orthographic(eye, target, up, 2.5, 2.5, near_distance, 20, reversed, view);
        break;
    default:
        for (int i = 0; i < 16; i++)
            view->clip_from_world.m[i] = (double)number(random, 20 * rarity);
    }
    (void)result; /* a view that was refused is all zeros */
}

static shb_bias random_bias(test_random *random, uint32_t rarity) {
    size_t count;
    const shb_bias_method *methods = shb_bias_methods(&count);
    shb_bias bias = random_below(random, 3) ? methods[random_below(random, (uint32_t)count)].make()
                                            : shb_bias_exact();
    for (int i = 0; i < SHB_PARAMS_MAX; i++)
        bias.params[i] = random_below(random, rarity) ? bias.params[i] : absurd(random);
    return bias;
}

static void make_question(test_random *random, uint32_t rarity, usage *use) {
    size_t count;
    const shb_filter_method *filters = shb_filter_methods(&count);
    use->bias = random_bias(random, rarity);
    use->drawn_for = random_below(random, 4) ? use->bias : random_bias(random, rarity);
    use->filter = filters[random_below(random, (uint32_t)count)].make();
    for (int i = 0; i < SHB_PARAMS_MAX; i++)
        if (!random_below(random, rarity))
            use->filter.params[i] = number(random, 2);
    use->prepares = random_below(random, 8) != 0;
    fill(random, rarity, use->positions, POINTS * 3);
    fill(random, rarity, use->normals, POINTS * 3);
    for (int i = 0; i < POINTS; i += 3) /* contacts */
        memcpy(use->positions + 3 * i, use->vertices + 3 * (i % VERTICES), 3 * sizeof(float));
    use->points = (shb_points){.count = random_below(random, POINTS + 1),
                               .positions = use->positions,
                               .normals = random_below(random, 8) ? use->normals : NULL};
}

static void make_usage(uint64_t seed, usage *use) {
    test_random random = {seed};
    const uint32_t rarity = random_below(&random, 3) ? 1000 : 12;
    random_bits(&random);
    make_scene(&random, rarity, use);
    make_map(&random, rarity, use);
    make_question(&random, rarity, use);
}

/* Calls one function after the other until one fails. */
static void use_map(const usage *use, shb_map *map, outcome *out) {
    out->call = 2;
    out->result = shb_map_draw(map, &use->scene, &use->drawn_for, &out->stats);
    if (!out->result && use->prepares) {
        out->call = 3;
        out->result = shb_map_prepare(map, &use->filter);
    }
    if (!out->result) {
        out->call = 4;
        out->result =
            shb_map_visibility(map, &use->points, &use->bias, &use->filter, out->visibility);
    }
}

static void count_sentences(void *user, shb_result result, const char *sentence) {
    *(int *)user += result != SHB_OK && sentence[0] != '\0';
}

/* fail_at: the allocation that fails, or 0. Returns the number of allocations. */
static size_t run(usage *use, bool scalar, size_t fail_at, outcome *out) {
    test_allocator allocator = {.fail_at = fail_at};
    int sentences = 0;
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&allocator),
                                   .threads = scalar ? 1 : 3,
                                   .max_isa = scalar ? SHB_ISA_SCALAR : SHB_ISA_BEST,
                                   .log = count_sentences,
                                   .log_user = &sentences};
    shb_context *context = NULL;
    shb_clusters *clusters = NULL;
    shb_map *map = NULL;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < POINTS; i++)
        out->visibility[i] = untouched;
    out->result = shb_context_create(&desc, &context);
    if (!out->result && !scalar)
        CHECK_INT(shb_clusters_create(context, &use->mesh, &clusters), SHB_OK);
    use->mesh.clusters = clusters;
    if (!out->result) {
        out->call = 1;
        out->result = shb_map_create(context, &use->map, &map);
        if (!out->result)
            use_map(use, map, out);
        CHECK((out->result != SHB_OK) == (sentences > 0));
    }
    shb_map_destroy(map);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    CHECK_INT(allocator.live, 0);
    return allocator.calls;
}

static bool answers_are_sound(const usage *use, const outcome *out) {
    for (size_t i = 0; i < POINTS; i++) {
        const float visibility = out->visibility[i];
        const bool answered = out->result == SHB_OK && i < use->points.count;
        if (answered ? !(visibility >= 0 && visibility <= 1) : visibility != untouched)
            return false;
    }
    return true;
}

static size_t wanted_uses(void) {
    const char *wanted = getenv("SHB_RANDOM_USES");
    return wanted ? (size_t)strtoull(wanted, NULL, 10) : USES;
}

TEST(random_uses_have_one_answer_or_an_error) {
    static usage use;
    static outcome scalar, kernels;
    size_t answered = 0;
    for (uint64_t seed = 1; seed <= wanted_uses(); seed++) {
        make_usage(seed, &use);
        run(&use, true, 0, &scalar);
        run(&use, false, 0, &kernels);
        test_check(scalar.call == kernels.call && scalar.result == kernels.result, __FILE__,
                   __LINE__, "use %llu: call %d gives %s by scalar code, call %d %s by kernels",
                   (unsigned long long)seed, scalar.call, shb_result_string(scalar.result),
                   kernels.call, shb_result_string(kernels.result));
        test_check(memcmp(scalar.visibility, kernels.visibility, sizeof scalar.visibility) == 0 &&
                       memcmp(&scalar.stats, &kernels.stats, sizeof scalar.stats) == 0,
                   __FILE__, __LINE__, "use %llu: kernels answer otherwise than scalar code",
                   (unsigned long long)seed);
        test_check(answers_are_sound(&use, &kernels), __FILE__, __LINE__,
                   "use %llu: %s with filter %s answers beyond 0 .. 1 or where it failed",
                   (unsigned long long)seed, use.bias.name, use.filter.name);
        answered += kernels.result == SHB_OK;
    }
    test_check(answered * 4 > wanted_uses(), __FILE__, __LINE__, "%zu uses were answered",
               answered);
}

/* The error of memory, and no other: what else is wrong with the use would be found first. */
TEST(random_uses_fail_cleanly_where_memory_ends) {
    static usage use;
    static outcome whole, cut;
    for (uint64_t seed = 1; seed <= wanted_uses() / 10; seed++) {
        make_usage(seed, &use);
        const size_t calls = run(&use, true, 0, &whole);
        for (size_t fail_at = 1; fail_at <= calls; fail_at++) {
            run(&use, true, fail_at, &cut);
            test_check(cut.result == SHB_ERROR_MEMORY && answers_are_sound(&use, &cut), __FILE__,
                       __LINE__, "use %llu: %s where allocation %zu of %zu fails",
                       (unsigned long long)seed, shb_result_string(cut.result), fail_at, calls);
        }
    }
}
