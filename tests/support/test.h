/* A tiny test harness. A test registers itself; one that checks nothing fails.
 *
 *     TEST(equal_depth_keeps_the_lower_id) { CHECK(id == 3); }
 */
#ifndef TESTS_SUPPORT_TEST_H
#define TESTS_SUPPORT_TEST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct test_case {
    const char *name;
    const char *file;
    void (*run)(void);
    struct test_case *next;
} test_case;

void test_register(test_case *test);

/* Counts a check; prints file, line and text when it fails. Returns the condition. */
bool test_check(bool condition, const char *file, int line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Ends up as "skipped" instead of "passed" unless a check fails. */
void test_skip(const char *reason);

#define TEST(test_name)                                                                            \
    static void test_run_##test_name(void);                                                        \
    __attribute__((constructor)) static void test_add_##test_name(void) {                          \
        static test_case test = {#test_name, __FILE__, test_run_##test_name, NULL};                \
        test_register(&test);                                                                      \
    }                                                                                              \
    static void test_run_##test_name(void)

#define CHECK(condition) test_check((condition), __FILE__, __LINE__, "%s", #condition)

#define CHECK_INT(actual, expected)                                                                \
    do {                                                                                           \
        const long long test_a = (long long)(actual), test_e = (long long)(expected);              \
        test_check(test_a == test_e, __FILE__, __LINE__, "%s is %lld, expected %lld", #actual,     \
                   test_a, test_e);                                                                \
    } while (0)

/* |actual - expected| <= tolerance; a NaN fails. */
#define CHECK_NEAR(actual, expected, tolerance)                                                    \
    do {                                                                                           \
        const double test_a = (double)(actual), test_e = (double)(expected);                       \
        const double test_d = test_a > test_e ? test_a - test_e : test_e - test_a;                 \
        test_check(test_d <= (double)(tolerance), __FILE__, __LINE__,                              \
                   "%s is %.17g, expected %.17g +- %.3g", #actual, test_a, test_e,                 \
                   (double)(tolerance));                                                           \
    } while (0)

#endif
