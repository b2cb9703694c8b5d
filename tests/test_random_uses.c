#include "allocator.h"
#include "random_use.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

/* Random uses of the library, sound and absurd ones. Whatever a host hands over, there is an answer
 * or an error with a sentence; scalar code on one thread and kernels on three, with clusters, say
 * the same, to the bit; nothing leaks, also where memory ends at any allocation. SHB_RANDOM_USES
 * sets their number.
 */

enum { USES = 250 };

static const float untouched = -7;
enum { UNTOUCHED = 77 };

/* What comes of it: by which call it ended, how, and the answers. */
typedef struct outcome {
    const char *call;
    shb_result result;
    bool classified, asked;
    shb_draw_stats stats;
    float visibility[USE_POINTS];
    uint8_t certain[USE_POINTS];
    uint8_t pixels[USE_WIDTH * USE_HEIGHT * 3];
} outcome;

static void clear(outcome *out) {
    memset(out, 0, sizeof *out);
    for (int i = 0; i < USE_POINTS; i++)
        out->visibility[i] = untouched;
    memset(out->certain, UNTOUCHED, sizeof out->certain);
    memset(out->pixels, UNTOUCHED, sizeof out->pixels);
}

static bool goes_on(outcome *out, const char *call, shb_result result) {
    out->call = call;
    out->result = result;
    return result == SHB_OK;
}

static shb_result draw_camera(const random_use *use, shb_context *context, uint32_t *ids) {
    const shb_draw_desc desc = {.view = &use->camera,
                                .scene = &use->scene,
                                .width = USE_WIDTH,
                                .height = USE_HEIGHT,
                                .ids = ids};
    return shb_draw(context, &desc, NULL);
}

static shb_result shade(const random_use *use, shb_context *context, const shb_map *map,
                        const uint32_t *ids, uint8_t *pixels) {
    shb_shade_light lights[USE_LIGHTS];
    for (int k = 0; k < USE_LIGHTS; k++)
        lights[k] = (shb_shade_light){map, &use->bias, &use->filter, {0.5f, 0.3f, (float)k}};
    const shb_shade_desc desc = {.frame = {.view = &use->camera,
                                           .scene = &use->scene,
                                           .width = USE_WIDTH,
                                           .height = USE_HEIGHT,
                                           .ids = ids},
                                 .lights = lights,
                                 .light_count = use->light_count,
                                 .shade = shb_shade_lambert,
                                 .smooth_terminator = use->smooth_terminator,
                                 .image = {pixels, USE_WIDTH, USE_HEIGHT, 0}};
    return shb_shade(context, &desc);
}

/* Calls one function after the other until one fails. */
static void use_map(const random_use *use, shb_context *context, shb_map *map, outcome *out) {
    static uint32_t ids[USE_WIDTH * USE_HEIGHT];
    if (!goes_on(out, "draw", shb_map_draw(map, &use->scene, &use->drawn_for, &out->stats)))
        return;
    if (use->map.classifies) {
        out->classified =
            goes_on(out, "classify", shb_map_classify(map, &use->points, out->certain));
        if (!out->classified)
            return;
    }
    if (use->prepares && !goes_on(out, "prepare", shb_map_prepare(map, &use->filter)))
        return;
    out->asked =
        goes_on(out, "ask",
                shb_map_visibility(map, &use->points, &use->bias, &use->filter, out->visibility));
    if (out->asked && goes_on(out, "camera", draw_camera(use, context, ids)))
        goes_on(out, "shade", shade(use, context, map, ids, out->pixels));
}

static void count_sentences(void *user, shb_result result, const char *sentence) {
    *(int *)user += result != SHB_OK && sentence[0] != '\0';
}

/* fail_at: the allocation that fails, or 0. Returns the number of allocations. */
static size_t run(random_use *use, shb_isa isa, size_t fail_at, outcome *out) {
    const bool scalar = isa == SHB_ISA_SCALAR;
    test_allocator allocator = {.fail_at = fail_at};
    int sentences = 0;
    const shb_context_desc desc = {.allocator = test_allocator_hooks(&allocator),
                                   .threads = scalar ? 1 : 3,
                                   .max_isa = isa,
                                   .log = count_sentences,
                                   .log_user = &sentences};
    shb_context *context = NULL;
    shb_clusters *clusters = NULL;
    shb_map *map = NULL;
    clear(out);
    if (goes_on(out, "context", shb_context_create(&desc, &context))) {
        if (!scalar)
            CHECK_INT(shb_clusters_create(context, &use->mesh, &clusters), SHB_OK);
        use->mesh.clusters = clusters;
        if (goes_on(out, "map", shb_map_create(context, &use->map, &map)))
            use_map(use, context, map, out);
        CHECK((out->result != SHB_OK) == (sentences > 0));
    }
    shb_map_destroy(map);
    shb_clusters_destroy(clusters);
    shb_context_destroy(context);
    CHECK_INT(allocator.live, 0);
    return allocator.calls;
}

/* Answers where the map was asked, and nothing written where it was not. */
static bool answers_are_sound(const random_use *use, const outcome *out) {
    const size_t certain = out->classified ? use->points.count : 0;
    const size_t visible = out->asked ? use->points.count : 0;
    for (size_t i = 0; i < USE_POINTS; i++) {
        const float visibility = out->visibility[i];
        if (i < certain ? out->certain[i] > SHB_LIGHT_SHADOWED : out->certain[i] != UNTOUCHED)
            return false;
        if (i < visible ? !(visibility >= 0 && visibility <= 1) : visibility != untouched)
            return false;
    }
    return out->result == SHB_OK || out->pixels[0] == UNTOUCHED;
}

static size_t wanted_uses(void) {
    const char *wanted = getenv("SHB_RANDOM_USES");
    return wanted ? (size_t)strtoull(wanted, NULL, 10) : USES;
}

static bool are_the_same(const outcome *a, const outcome *b) {
    return memcmp(&a->stats, &b->stats, sizeof a->stats) == 0 &&
           memcmp(a->visibility, b->visibility, sizeof a->visibility) == 0 &&
           memcmp(a->certain, b->certain, sizeof a->certain) == 0 &&
           memcmp(a->pixels, b->pixels, sizeof a->pixels) == 0;
}

TEST(random_uses_have_one_answer_or_an_error) {
    static const shb_isa vectors[] = {SHB_ISA_BEST, SHB_ISA_AVX2, SHB_ISA_SSE2};
    static random_use use;
    static outcome scalar, kernels;
    size_t answered = 0;
    for (uint64_t seed = 1; seed <= wanted_uses(); seed++) {
        random_use_make(seed, &use);
        run(&use, SHB_ISA_SCALAR, 0, &scalar);
        run(&use, vectors[seed % 3], 0, &kernels);
        test_check(strcmp(scalar.call, kernels.call) == 0 && scalar.result == kernels.result,
                   __FILE__, __LINE__, "use %llu: %s gives %s by scalar code, %s %s by kernels",
                   (unsigned long long)seed, scalar.call, shb_result_string(scalar.result),
                   kernels.call, shb_result_string(kernels.result));
        test_check(are_the_same(&scalar, &kernels), __FILE__, __LINE__,
                   "use %llu: %s with filter %s answers otherwise by kernels than by scalar code",
                   (unsigned long long)seed, use.bias.name, use.filter.name);
        test_check(answers_are_sound(&use, &kernels), __FILE__, __LINE__,
                   "use %llu: %s with filter %s answers out of range or where it failed",
                   (unsigned long long)seed, use.bias.name, use.filter.name);
        answered += kernels.result == SHB_OK;
    }
    test_check(answered * 4 > wanted_uses(), __FILE__, __LINE__, "%zu uses were answered",
               answered);
}

/* The error of memory, and no other: what else is wrong with the use would be found first. */
TEST(random_uses_fail_cleanly_where_memory_ends) {
    static random_use use;
    static outcome whole, cut;
    for (uint64_t seed = 1; seed <= wanted_uses() / 10; seed++) {
        random_use_make(seed, &use);
        const size_t calls = run(&use, SHB_ISA_SCALAR, 0, &whole);
        for (size_t fail_at = 1; fail_at <= calls; fail_at++) {
            run(&use, SHB_ISA_SCALAR, fail_at, &cut);
            test_check(cut.result == SHB_ERROR_MEMORY && answers_are_sound(&use, &cut), __FILE__,
                       __LINE__, "use %llu: %s where allocation %zu of %zu fails",
                       (unsigned long long)seed, shb_result_string(cut.result), fail_at, calls);
        }
    }
}
