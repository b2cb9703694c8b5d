/* What classification leaves out, and what it does not depend on. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "allocator.h"
#include "classify_stage.h"
#include "random.h"
#include "test.h"

/* ---- what is not classified ---- */

static int count_truth(const stage *s, uint8_t truth) {
    int count = 0;
    for (int pixel = 0; pixel < PIXEL_COUNT; pixel++)
        count += s->truth[pixel] == truth;
    return count;
}

TEST(surfaces_turned_away_or_below_the_least_cosine_are_not_classified) {
    /* Light along (0.8, 0, 0.6) meets the ground at a cosine of 0.6. */
    soup s = {0};
    add_ground(&s);
    const shb_vec3 origin = {0, 0, 0};
    const int covered = 240 * 240; /* 60 of 64 units */
    for (int k = 0; k < 4; k++) {
        const shb_view light = wide_view((shb_vec3){0.8, 0, k == 3 ? -0.6 : 0.6}, origin);
        stage t = stage_for(soup_scene(&s), view_from_height(60), light, 64);
        shb_classify_desc desc = stage_desc(&t);
        desc.min_cosine = k == 0 ? 0 : k == 1 ? 0.599 : k == 2 ? 0.601 : 0;
        CHECK_INT(shb_reference_classify(t.reference, &desc, t.truth), SHB_OK);
        CHECK_INT(count_truth(&t, SHB_TRUTH_LIT), k < 2 ? covered : 0);
        CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), k < 2 ? PIXEL_COUNT - covered : PIXEL_COUNT);
        stage_end(&t);
    }
    soup_free(&s);
}

TEST(pixels_behind_a_spot_light_are_not_classified) {
    /* The light hangs over the ground and looks up: x / w of the ground lies within the map. */
    soup s = {0};
    add_ground(&s);
    shb_view light;
    CHECK_INT(shb_view_perspective((shb_vec3){0, 0, 20}, (shb_vec3){0, 0, 40}, (shb_vec3){0, 1, 0},
                                   2, 1, 1, 100, false, &light),
              SHB_OK);
    stage t = stage_for(soup_scene(&s), view_from_height(50), light, 64);
    stage_classify(&t);
    CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), PIXEL_COUNT);
    stage_end(&t);
    soup_free(&s);
}

TEST(pixels_outside_the_map_or_without_a_triangle_are_not_classified) {
    /* The map sees x and y from -16 to 16. */
    soup s = {0};
    add_ground(&s);
    shb_view light;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, 60}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 1, 0},
                                    16, 16, 1, 100, true, &light),
              SHB_OK);
    stage t = stage_for(soup_scene(&s), view_from_height(50), light, 64);
    t.ids[128 * PIXELS + 128] = SHB_ID_NONE;
    t.ids[128 * PIXELS + 129] = 2;
    stage_classify(&t);
    CHECK_INT(count_truth(&t, SHB_TRUTH_LIT), 128 * 128 - 2);
    CHECK_INT(count_truth(&t, SHB_TRUTH_NONE), PIXEL_COUNT - 128 * 128 + 2);
    CHECK_INT(t.truth[128 * PIXELS + 128], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[128 * PIXELS + 129], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[128 * PIXELS + 130], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[63 * PIXELS + 64], SHB_TRUTH_NONE);
    CHECK_INT(t.truth[64 * PIXELS + 64], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[191 * PIXELS + 191], SHB_TRUTH_LIT);
    CHECK_INT(t.truth[191 * PIXELS + 192], SHB_TRUTH_NONE);
    stage_end(&t);
    soup_free(&s);
}

/* ---- threads, memory, arguments ---- */

static void add_boxes(soup *s) {
    test_random random = {2};
    add_ground(s);
    for (int i = 0; i < 40; i++) {
        const float x = (float)random_double(&random, -25, 22);
        const float y = (float)random_double(&random, -25, 22);
        const float size = (float)random_double(&random, 0.5, 4);
        soup_add_box(s, (float[3]){x, y, 0}, (float[3]){x + size, y + size, 2 * size});
    }
}

TEST(classification_does_not_depend_on_threads) {
    soup s = {0};
    add_boxes(&s);
    stage t = stage_for(soup_scene(&s), wide_view((shb_vec3){-1, -1, 2}, (shb_vec3){0, 0, 0}),
                        wide_view((shb_vec3){1, -0.4, 1}, (shb_vec3){0, 0, 0}), 128);
    stage_classify(&t);
    const shb_context_desc one_thread = {.threads = 1};
    shb_context *context;
    shb_reference *reference;
    CHECK_INT(shb_context_create(&one_thread, &context), SHB_OK);
    CHECK_INT(shb_reference_create(context, t.scene, &reference), SHB_OK);
    const shb_classify_desc desc = stage_desc(&t);
    uint8_t *truth = malloc(PIXEL_COUNT);
    CHECK_INT(shb_reference_classify(reference, &desc, truth), SHB_OK);
    CHECK(memcmp(truth, t.truth, PIXEL_COUNT) == 0);
    CHECK(count_truth(&t, SHB_TRUTH_SHADOWED) > 1000);
    CHECK(count_truth(&t, SHB_TRUTH_LIT | SHB_TRUTH_BOUNDARY) > 1000);
    free(truth);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    stage_end(&t);
    soup_free(&s);
}

TEST(a_classification_without_memory_fails_and_writes_nothing) {
    soup s = {0};
    add_boxes(&s);
    stage t = stage_for(soup_scene(&s), view_from_height(60), view_from_height(60), 64);
    test_allocator state = {0};
    const shb_context_desc hooks = {.allocator = test_allocator_hooks(&state), .threads = 1};
    shb_context *context;
    shb_reference *reference;
    CHECK_INT(shb_context_create(&hooks, &context), SHB_OK);
    CHECK_INT(shb_reference_create(context, t.scene, &reference), SHB_OK);
    const size_t live = state.live;
    const shb_classify_desc desc = stage_desc(&t);
    memset(t.truth, 99, PIXEL_COUNT);
    shb_result result = SHB_ERROR_MEMORY;
    for (size_t fail_at = 1; result && fail_at < 20; fail_at++) {
        state.calls = 0;
        state.fail_at = fail_at;
        result = shb_reference_classify(reference, &desc, t.truth);
        CHECK_INT(state.live, live);
        CHECK_INT(result, fail_at <= state.calls ? SHB_ERROR_MEMORY : SHB_OK);
        CHECK_INT(count_truth(&t, 99), result ? PIXEL_COUNT : 0);
        CHECK(result || fail_at > 3);
    }
    CHECK_INT(result, SHB_OK);
    shb_reference_destroy(reference);
    shb_context_destroy(context);
    stage_end(&t);
    soup_free(&s);
}

TEST(classification_refuses_bad_arguments) {
    soup s = {0}, other = {0};
    add_ground(&s);
    add_sheet(&other, 0, 0, 1, 1, 1);
    soup_add(&other, (float[3]){0, 0, 0}, (float[3]){0, 1, 0}, (float[3]){1, 0, 0});
    stage t = stage_for(soup_scene(&s), view_from_height(60), view_from_height(60), 64);
    memset(t.truth, 99, PIXEL_COUNT);
    const shb_classify_desc good = stage_desc(&t);
    const shb_view singular = {{{0}}, false};
#define REFUSES(field, value, expected)                                                            \
    do {                                                                                           \
        shb_classify_desc bad = good;                                                              \
        bad.field = value;                                                                         \
        CHECK_INT(shb_reference_classify(t.reference, &bad, t.truth), expected);                   \
    } while (0)
    REFUSES(map, NULL, SHB_ERROR_ARGUMENT);
    REFUSES(min_cosine, -0.1, SHB_ERROR_ARGUMENT);
    REFUSES(min_cosine, 1.1, SHB_ERROR_ARGUMENT);
    REFUSES(min_cosine, (double)NAN, SHB_ERROR_ARGUMENT);
    REFUSES(frame.scene, soup_scene(&other), SHB_ERROR_ARGUMENT);
    REFUSES(frame.view, NULL, SHB_ERROR_ARGUMENT);
    REFUSES(frame.view, &singular, SHB_ERROR_NUMBER);
    REFUSES(frame.scene, NULL, SHB_ERROR_ARGUMENT);
    REFUSES(frame.width, 0, SHB_ERROR_SIZE);
    REFUSES(frame.height, 0, SHB_ERROR_SIZE);
    REFUSES(frame.height, SHB_SIZE_MAX + 1, SHB_ERROR_SIZE);
    REFUSES(frame.ids, NULL, SHB_ERROR_ARGUMENT);
    REFUSES(frame.ids, (uint32_t *)(void *)((char *)t.ids + 2), SHB_ERROR_ARGUMENT);
    REFUSES(frame.id_stride, 4 * PIXELS - 4, SHB_ERROR_ARGUMENT);
    REFUSES(frame.id_stride, 4 * PIXELS + 2, SHB_ERROR_ARGUMENT);
    REFUSES(frame.id_stride, SIZE_MAX - 3, SHB_ERROR_SIZE);
#undef REFUSES
    CHECK_INT(shb_reference_classify(NULL, &good, t.truth), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_classify(t.reference, NULL, t.truth), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_reference_classify(t.reference, &good, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(count_truth(&t, 99), PIXEL_COUNT);
    stage_end(&t);
    soup_free(&s);
    soup_free(&other);
}
