/* The table of methods and their text form. */
#include "random.h"
#include "shadowbias/filter.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static shb_bias parsed(const char *text) {
    shb_bias bias = {.name = "untouched"};
    test_check(shb_bias_parse(text, &bias) == SHB_OK, __FILE__, __LINE__, "\"%s\" fails", text);
    return bias;
}

static bool same(const shb_bias *a, const shb_bias *b) {
    return strcmp(a->name, b->name) == 0 && a->offset == b->offset && a->depth == b->depth &&
           a->combine == b->combine && a->needs == b->needs && a->user == b->user &&
           memcmp(a->params, b->params, sizeof a->params) == 0;
}

TEST(methods_are_listed_in_order_with_their_defaults) {
    const shb_bias expected[] = {shb_bias_none(),
                                 shb_bias_constant(0.002f, SHB_UNIT_DEPTH),
                                 shb_bias_slope(1.1f, 4, 0),
                                 shb_bias_angle(0.001f, 0.01f),
                                 shb_bias_normal_offset(1.5f, 1e-5f),
                                 shb_bias_receiver_plane(1e-5f),
                                 shb_bias_texel_cone(),
                                 shb_bias_midpoint(),
                                 shb_bias_dual_layer(0.01f),
                                 shb_bias_back_face(),
                                 shb_bias_adaptive(1e-4f, 0),
                                 shb_bias_adaptive_soft(1e-4f, 0, 100),
                                 shb_bias_exact()};
    size_t count = 0;
    const shb_bias_method *methods = shb_bias_methods(&count);
    CHECK_INT(count, sizeof expected / sizeof *expected);
    CHECK(shb_bias_methods(NULL) == methods);
    for (size_t i = 0; i < count; i++) {
        const shb_bias made = methods[i].make();
        CHECK(strcmp(methods[i].name, made.name) == 0);
        CHECK(same(&made, &expected[i]));
        const shb_bias read = parsed(methods[i].name);
        CHECK(same(&read, &expected[i]));
        CHECK(methods[i].summary && *methods[i].summary);
    }
}

TEST(a_method_reads_its_parameters) {
    const struct {
        const char *text;
        shb_bias expected;
    } cases[] = {
        {"constant:amount=0.5", shb_bias_constant(0.5f, SHB_UNIT_DEPTH)},
        {"constant:amount=2,unit=1", shb_bias_constant(2, SHB_UNIT_TEXEL)},
        {"constant:unit=2,amount=-.125", shb_bias_constant(-0.125f, SHB_UNIT_WORLD)},
        {"slope:factor=2,units=1e1,clamp=0.25", shb_bias_slope(2, 10, 0.25f)},
        {"slope:clamp=+3.5E-1", shb_bias_slope(1.1f, 4, 0.35f)},
        {"angle:base=0.25,limit=8.", shb_bias_angle(0.25f, 8)},
        {"normal-offset:texels=3,depth=0", shb_bias_normal_offset(3, 0)},
        {"receiver-plane:epsilon=1e-6", shb_bias_receiver_plane(1e-6f)},
        {"dual-layer:offset=0.125", shb_bias_dual_layer(0.125f)},
        {"adaptive:k=1e-3,scale=20", shb_bias_adaptive(1e-3f, 20)},
        {"adaptive-soft:k=2e-4,scale=3,threshold=50", shb_bias_adaptive_soft(2e-4f, 3, 50)},
        {"adaptive:k=1,k=2", shb_bias_adaptive(2, 0)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const shb_bias read = parsed(cases[i].text);
        test_check(same(&read, &cases[i].expected), __FILE__, __LINE__, "\"%s\" reads wrongly",
                   cases[i].text);
    }
}

TEST(malformed_text_leaves_the_method_alone) {
    const char *bad[] = {"",
                         "nothing",
                         "Constant",
                         "const",
                         "constant ",
                         "constants",
                         "constant:",
                         "constant:amount",
                         "constant:amount=",
                         "constant:amount=1,",
                         "constant:amount=1,,unit=1",
                         "constant:amount=1 ",
                         "constant:amount= 1",
                         "constant:amount=1x",
                         "constant:amount=0x1p3",
                         "constant:amount=1,5",
                         "constant:amount=1.5.5",
                         "constant:amount=.",
                         "constant:amount=-",
                         "constant:amount=1e",
                         "constant:amount=1e+",
                         "constant:amount=nan",
                         "constant:amount=inf",
                         "constant:amount=1e39",
                         "constant:amount=-1e39",
                         "constant:amount=1e99999999999",
                         "constant:unit=3",
                         "constant:unit=0.5",
                         "constant:unit=-1",
                         "constant:factor=1",
                         "constant:=1",
                         "none:amount=1",
                         "none:=1",
                         "constant:amount=1;unit=1",
                         "constant:amount:1"};
    const shb_bias before = {.name = "before"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        shb_bias bias = before;
        test_check(shb_bias_parse(bad[i], &bias) == SHB_ERROR_ARGUMENT, __FILE__, __LINE__,
                   "\"%s\" is accepted", bad[i]);
        CHECK(same(&bias, &before));
    }
    shb_bias bias = before;
    CHECK_INT(shb_bias_parse(NULL, &bias), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_bias_parse("none", NULL), SHB_ERROR_ARGUMENT);
    CHECK(same(&bias, &before));
}

static float read_amount(const char *number) {
    char text[128];
    snprintf(text, sizeof text, "constant:amount=%s", number);
    return parsed(text).params[0];
}

TEST(tiny_numbers_round_to_zero_and_huge_exponents_end) {
    CHECK(read_amount("1e-400") == 0);
    CHECK(read_amount("0e99999999999") == 0);
    CHECK(read_amount("-1e-99999999999") == 0);
    CHECK(read_amount("1e-45") == 0x1p-149f);
    CHECK(read_amount("3.4028234663852886e38") == 0x1.fffffep127f);
}

/* The C library's conversion in the "C" locale is the reference. */
TEST(numbers_read_as_the_c_library_reads_them) {
    test_random random = {3};
    for (int i = 0; i < 20000; i++) {
        const double value =
            ldexp(random_double(&random, -1, 1), (int)random_below(&random, 200) - 100);
        char number[64];
        snprintf(number, sizeof number, i & 1 ? "%.9g" : "%.6f", value);
        CHECK(read_amount(number) == strtof(number, NULL));
    }
}

TEST(a_filter_reads_its_name) {
    const shb_filter hard = shb_filter_hard();
    shb_filter filter = {0};
    CHECK_INT(shb_filter_parse("hard", &filter), SHB_OK);
    CHECK(strcmp(filter.name, "hard") == 0 && filter.filter == hard.filter);
    filter = (shb_filter){.name = "before"};
    const char *bad[] = {"", "hardly", "Hard", "hard:", "hard:x=1", "hard:=1"};
    for (int i = 0; i < 6; i++)
        CHECK_INT(shb_filter_parse(bad[i], &filter), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_filter_parse(NULL, &filter), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_filter_parse("hard", NULL), SHB_ERROR_ARGUMENT);
    CHECK(strcmp(filter.name, "before") == 0 && !filter.filter);
}
