/* What filters make of a map before it is asked: made once, found again, freed once. */
#include "contexts.h"
#include "probe.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

enum { SIZE = 4 };

typedef struct host {
    shb_context *context;
    shb_map *map;
    float texels[SIZE * SIZE];
} host;

static void open_host(host *h) {
    *h = (host){0};
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = SIZE};
    h->context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_wrap(h->context, &desc, h->texels, 0, NULL, &h->map), SHB_OK);
}

static void close_host(host *h) {
    shb_map_destroy(h->map);
    shb_context_destroy(h->context);
}

/* Counts preparations; its address tells filters apart. */
typedef struct tally {
    int made;
} tally;

/* Keeps its parameter plus one; a negative parameter fails. */
static shb_result make_number(const shb_map *map, const shb_filter *filter, void **prepared,
                              size_t *bytes) {
    (void)map;
    if (filter->params[0] < 0)
        return SHB_ERROR_MEMORY;
    float *number = malloc(sizeof *number);
    *number = filter->params[0] + 1;
    *prepared = number;
    *bytes = 1000;
    ((tally *)filter->user)->made++;
    return SHB_OK;
}

static void release_number(const shb_map *map, void *prepared) {
    (void)map;
    free(prepared);
}

/* The number, or -1 without one. */
static void tell_number(const shb_filter_args *args) {
    const float *number = args->prepared;
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = number ? *number : -1;
}

static float ask(const host *h, const shb_filter *filter) {
    const shb_bias none = shb_bias_none();
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    float visibility = -7;
    CHECK_INT(shb_map_visibility(h->map, &points, &none, filter, &visibility), SHB_OK);
    return visibility;
}

static shb_filter number_filter(tally *count, float param) {
    return (shb_filter){.name = "number",
                        .filter = tell_number,
                        .prepare = make_number,
                        .release = release_number,
                        .params = {param},
                        .user = count};
}

TEST(a_filter_finds_what_it_prepared_with_the_same_parameters) {
    host h;
    open_host(&h);
    const size_t plain = shb_map_get_info(h.map)->memory_bytes;
    tally count = {0};
    const shb_filter four = number_filter(&count, 4), five = number_filter(&count, 5);
    CHECK(ask(&h, &four) == -1);
    CHECK_INT(shb_map_prepare(h.map, &four), SHB_OK);
    CHECK(ask(&h, &four) == 5);
    CHECK(ask(&h, &five) == -1);
    CHECK_INT(shb_map_prepare(h.map, &five), SHB_OK);
    CHECK(ask(&h, &five) == 6);
    CHECK(ask(&h, &four) == -1);
    CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain + 1000);
    CHECK_INT(count.made, 2);
    close_host(&h);
}

/* A filter of its own for each of so many counts, with their places as parameters. */
static void prepare_kinds(const host *h, tally *counts, int kinds) {
    for (int i = 0; i < kinds; i++) {
        const shb_filter filter = number_filter(&counts[i], (float)i);
        CHECK_INT(shb_map_prepare(h->map, &filter), SHB_OK);
    }
}

TEST(filters_of_several_kinds_are_prepared_at_the_same_time) {
    host h;
    open_host(&h);
    const size_t plain = shb_map_get_info(h.map)->memory_bytes;
    tally counts[SHB_PREPARED_MAX + 1] = {0};
    prepare_kinds(&h, counts, SHB_PREPARED_MAX + 1);
    for (int i = 0; i <= SHB_PREPARED_MAX; i++) {
        const shb_filter filter = number_filter(&counts[i], (float)i);
        CHECK(ask(&h, &filter) == (i == 0 ? -1.0f : (float)i + 1));
    }
    CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain + 1000 * SHB_PREPARED_MAX);
    close_host(&h);
}

TEST(a_failed_preparation_keeps_what_there_was) {
    host h;
    open_host(&h);
    tally count = {0};
    const shb_filter good = number_filter(&count, 1), bad = number_filter(&count, -2);
    const shb_filter plain = {.name = "plain", .filter = tell_number};
    CHECK_INT(shb_map_prepare(h.map, &good), SHB_OK);
    CHECK_INT(shb_map_prepare(h.map, &bad), SHB_ERROR_MEMORY);
    CHECK_INT(shb_map_prepare(h.map, &plain), SHB_OK);
    CHECK(ask(&h, &good) == 2);
    CHECK(ask(&h, &plain) == -1);
    CHECK_INT(shb_map_prepare(NULL, &good), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_prepare(h.map, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_map_prepare(h.map, &(shb_filter){.prepare = make_number}), SHB_ERROR_ARGUMENT);
    close_host(&h);
}

TEST(a_filter_that_needs_preparation_is_refused_without_it) {
    host h;
    open_host(&h);
    tally count = {0};
    const shb_bias none = shb_bias_none();
    shb_filter filter = number_filter(&count, 1);
    filter.needs = SHB_NEEDS_PREPARED;
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    float visibility = -7;
    CHECK_INT(shb_map_visibility(h.map, &points, &none, &filter, &visibility),
              SHB_ERROR_UNSUPPORTED);
    CHECK(visibility == -7);
    CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
    CHECK(ask(&h, &filter) == 2);
    filter.needs = 1u << 30;
    CHECK_INT(shb_map_visibility(h.map, &points, &none, &filter, &visibility), SHB_ERROR_ARGUMENT);
    close_host(&h);
}

static void open_drawn_host(host *h) {
    *h = (host){0};
    const shb_map_desc desc = {.view = probe_orthographic(false), .width = SIZE};
    h->context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_map_create(h->context, &desc, &h->map), SHB_OK);
}

/* Its memory waits for the next preparation, which may return another. */
TEST(built_in_filters_that_read_only_what_they_prepared_are_refused_without_it) {
    static const char *const reading[] = {
        "variance",     "exponential-variance",      "moments",        "variance-soft",
        "moments-soft", "exponential-variance-soft", "backprojection", "bitmask"};
    const shb_bias none = shb_bias_none();
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    size_t count, refused = 0;
    const shb_filter_method *methods = shb_filter_methods(&count);
    host h;
    open_host(&h);
    for (size_t i = 0; i < count; i++) {
        const shb_filter filter = methods[i].make();
        bool reads = false;
        for (size_t k = 0; k < sizeof reading / sizeof *reading; k++)
            reads |= strcmp(filter.name, reading[k]) == 0;
        float visibility = -7;
        CHECK_INT(shb_map_visibility(h.map, &points, &none, &filter, &visibility),
                  reads ? SHB_ERROR_UNSUPPORTED : SHB_OK);
        CHECK((visibility == -7) == reads);
        refused += reads;
    }
    CHECK_INT(refused, sizeof reading / sizeof *reading);
    close_host(&h);
}

TEST(drawing_a_map_outdates_what_was_prepared) {
    host h;
    open_drawn_host(&h);
    const size_t plain = shb_map_get_info(h.map)->memory_bytes;
    tally count = {0};
    const shb_filter filter = number_filter(&count, 1);
    CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
    CHECK(ask(&h, &filter) == 2);
    CHECK_INT(shb_map_draw(h.map, &(shb_scene){0}, NULL, NULL), SHB_OK);
    CHECK(ask(&h, &filter) == -1);
    CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
    CHECK(ask(&h, &filter) == 2);
    CHECK_INT(count.made, 2);
    CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain + 1000);
    CHECK_INT(shb_map_draw(h.map, &(shb_scene){0}, NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain + 1000);
    CHECK_INT(shb_map_draw(h.map, &(shb_scene){0}, NULL, NULL), SHB_OK);
    CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain);
    close_host(&h);
}

/* Counts in place how often it was prepared; a parameter of 2 fails the second time. */
static shb_result count_up(const shb_map *map, const shb_filter *filter, void **prepared,
                           size_t *bytes) {
    (void)map;
    float *number = *prepared;
    if (!number) {
        number = calloc(1, sizeof *number);
        ((tally *)filter->user)->made++;
    } else if (filter->params[0] == 2)
        return SHB_ERROR_MEMORY;
    ++*number;
    *prepared = number;
    *bytes = 1000 * (size_t)*number;
    return SHB_OK;
}

static shb_filter counting_filter(tally *count, float param) {
    shb_filter filter = number_filter(count, param);
    filter.prepare = count_up;
    return filter;
}

TEST(what_a_filter_prepared_is_made_over_in_place) {
    host h;
    open_drawn_host(&h);
    const size_t plain = shb_map_get_info(h.map)->memory_bytes;
    tally count = {0};
    const shb_filter filter = counting_filter(&count, 1), failing = counting_filter(&count, 2);
    for (int i = 1; i <= 3; i++) {
        CHECK_INT(shb_map_draw(h.map, &(shb_scene){0}, NULL, NULL), SHB_OK);
        CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
        CHECK(ask(&h, &filter) == (float)i);
        CHECK_INT(shb_map_get_info(h.map)->memory_bytes, plain + 1000 * (size_t)i);
    }
    CHECK_INT(count.made, 1);
    CHECK_INT(shb_map_prepare(h.map, &failing), SHB_OK);
    CHECK_INT(shb_map_prepare(h.map, &failing), SHB_ERROR_MEMORY);
    CHECK(ask(&h, &failing) == 1);
    CHECK_INT(count.made, 2);
    close_host(&h);
}

/* What is up to date stays when there is something else to go. */
TEST(what_is_outdated_makes_room_first) {
    host h;
    open_drawn_host(&h);
    tally counts[SHB_PREPARED_MAX + 1] = {0};
    prepare_kinds(&h, counts, SHB_PREPARED_MAX);
    CHECK_INT(shb_map_draw(h.map, &(shb_scene){0}, NULL, NULL), SHB_OK);
    const int order[] = {0, 2, SHB_PREPARED_MAX};
    for (int k = 0; k < 3; k++) {
        const shb_filter filter = number_filter(&counts[order[k]], (float)order[k]);
        CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
    }
    for (int k = 0; k < 3; k++) {
        const shb_filter filter = number_filter(&counts[order[k]], (float)order[k]);
        CHECK(ask(&h, &filter) == (float)order[k] + 1);
    }
    close_host(&h);
}

/* The first preparation makes something, the second nothing. */
static shb_result make_one_then_none(const shb_map *map, const shb_filter *filter, void **prepared,
                                     size_t *bytes) {
    (void)map;
    tally *count = (tally *)filter->user;
    *prepared = count->made++ == 0 ? malloc(1) : NULL;
    *bytes = 0;
    return SHB_OK;
}

static int releases, releases_of_nothing;

static void count_release(const shb_map *map, void *prepared) {
    (void)map;
    releases++;
    releases_of_nothing += !prepared;
    free(prepared);
}

TEST(a_filter_that_prepares_nothing_has_nothing_to_release) {
    host h;
    open_host(&h);
    tally count = {0};
    shb_filter filter = number_filter(&count, 0);
    filter.prepare = make_one_then_none;
    filter.release = count_release;
    filter.needs = SHB_NEEDS_PREPARED;
    releases = releases_of_nothing = 0;
    for (int i = 0; i < 3; i++)
        CHECK_INT(shb_map_prepare(h.map, &filter), SHB_OK);
    CHECK_INT(releases, 1);
    const shb_bias none = shb_bias_none();
    const shb_points points = {.count = 1, .positions = (float[]){0, 0, 0}};
    float visibility;
    CHECK_INT(shb_map_visibility(h.map, &points, &none, &filter, &visibility),
              SHB_ERROR_UNSUPPORTED);
    close_host(&h);
    CHECK_INT(releases, 1);
    CHECK_INT(releases_of_nothing, 0);
}

/* Every built-in filter that checks a parameter. */
TEST(sentences_name_filters_without_a_name_unnamed) {
    test_log log = {0};
    const shb_context_desc desc = {.threads = 1, .log = test_log_keep, .log_user = &log};
    const shb_map_desc map_desc = {.view = probe_orthographic(false), .width = SIZE};
    shb_context *context = NULL;
    shb_map *map = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    CHECK_INT(shb_map_create(context, &map_desc, &map), SHB_OK);
    size_t count;
    const shb_filter_method *methods = shb_filter_methods(&count);
    int refused = 0;
    for (size_t i = 0; i < count; i++)
        for (int param = 0; param < SHB_PARAMS_MAX; param++) {
            shb_filter filter = methods[i].make();
            filter.name = NULL;
            filter.params[param] = 2;
            if (shb_map_prepare(map, &filter) == SHB_OK)
                continue;
            refused++;
            test_check(strstr(log.sentence, "\"unnamed\"") != NULL, __FILE__, __LINE__, "%s",
                       log.sentence);
        }
    CHECK(refused > 3);
    shb_map_destroy(map);
    shb_context_destroy(context);
}
