/* The table of filters and their text form. */
#include "shadowbias/filter.h"
#include "test.h"

#include <string.h>

static bool same(const shb_filter *a, const shb_filter *b) {
    return strcmp(a->name, b->name) == 0 && a->filter == b->filter && a->exact == b->exact &&
           a->prepare == b->prepare && a->release == b->release && a->needs == b->needs &&
           a->user == b->user && memcmp(a->params, b->params, sizeof a->params) == 0;
}

TEST(filters_of_the_table_are_what_their_names_read) {
    size_t count = 0;
    const shb_filter_method *methods = shb_filter_methods(&count);
    CHECK(count >= 3);
    for (size_t i = 0; i < count; i++) {
        const shb_filter made = methods[i].make();
        shb_filter read = {0};
        CHECK(strcmp(methods[i].name, made.name) == 0);
        CHECK_INT(shb_filter_parse(methods[i].name, &read), SHB_OK);
        CHECK(same(&made, &read));
        CHECK(methods[i].summary && *methods[i].summary);
    }
}

TEST(a_filter_reads_its_parameters_and_needs_what_they_ask_for) {
    const struct {
        const char *text;
        shb_filter expected;
        uint32_t needs; /* beside the samples that exact taps ask */
    } cases[] = {
        {"pcf", shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_PLANE), 0},
        {"pcf:size=7", shb_filter_pcf(7, SHB_UNIT_TEXEL, SHB_TAPS_PLANE), 0},
        {"pcf:size=0.5,unit=2", shb_filter_pcf(0.5f, SHB_UNIT_WORLD, SHB_TAPS_PLANE),
         SHB_NEEDS_SCALE},
        {"pcf:taps=2", shb_filter_pcf(5, SHB_UNIT_TEXEL, SHB_TAPS_NAIVE), SHB_NEEDS_NORMAL},
        {"pcf:taps=1,unit=0", shb_filter_pcf(5, SHB_UNIT_DEPTH, SHB_TAPS_OWN), 0},
        {"jittered", shb_filter_jittered(4, SHB_UNIT_TEXEL, SHB_TAPS_PLANE), 0},
        {"jittered:size=0.5,unit=2,taps=1", shb_filter_jittered(0.5f, SHB_UNIT_WORLD, SHB_TAPS_OWN),
         SHB_NEEDS_SCALE},
        {"poisson", shb_filter_poisson(16, 3, SHB_UNIT_TEXEL, SHB_TAPS_PLANE), 0},
        {"poisson:count=25,radius=0.125,unit=2,taps=2",
         shb_filter_poisson(25, 0.125f, SHB_UNIT_WORLD, SHB_TAPS_NAIVE),
         SHB_NEEDS_SCALE | SHB_NEEDS_NORMAL},
        {"pcf-smooth", shb_filter_pcf_smooth(2, SHB_UNIT_TEXEL, SHB_TAPS_PLANE), 0},
        {"pcf-smooth:size=4,taps=2,unit=2",
         shb_filter_pcf_smooth(4, SHB_UNIT_WORLD, SHB_TAPS_NAIVE),
         SHB_NEEDS_SCALE | SHB_NEEDS_NORMAL},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        shb_filter read = {0};
        CHECK_INT(shb_filter_parse(cases[i].text, &read), SHB_OK);
        test_check(same(&read, &cases[i].expected) &&
                       read.needs == (cases[i].needs | SHB_NEEDS_SAMPLES),
                   __FILE__, __LINE__, "\"%s\" reads wrongly", cases[i].text);
    }
}

TEST(malformed_text_leaves_the_filter_alone) {
    const char *bad[] = {"",
                         "pc",
                         "pcf:",
                         "pcf:size",
                         "pcf:size=x",
                         "pcf:n=3",
                         "pcf:unit=3",
                         "pcf:unit=1.5",
                         "pcf:taps=3",
                         "pcf:taps=-1",
                         "pcf-smooth:unit=7",
                         "poisson:unit=4",
                         "poisson:taps=4",
                         "jittered:taps=9",
                         "hard:size=3"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        shb_filter filter = {.name = "untouched"};
        CHECK_INT(shb_filter_parse(bad[i], &filter), SHB_ERROR_ARGUMENT);
        CHECK(strcmp(filter.name, "untouched") == 0);
    }
}
