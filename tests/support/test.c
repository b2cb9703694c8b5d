#include "test.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static test_case *first_test;
static test_case **last_link = &first_test;
static unsigned checks, failures;
static const char *skip_reason;

void test_register(test_case *test) {
    *last_link = test;
    last_link = &test->next;
}

bool test_check(bool condition, const char *file, int line, const char *format, ...) {
    checks++;
    if (condition)
        return true;
    /* A loop over many samples should not bury the first failure. */
    if (failures++ < 10) {
        va_list args;
        va_start(args, format);
        printf("  %s:%d: ", file, line);
        vprintf(format, args);
        printf("\n");
        va_end(args);
    }
    return false;
}

void test_skip(const char *reason) {
    skip_reason = reason;
}

static bool is_wanted(const test_case *test, int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (strstr(test->name, argv[i]) || strstr(test->file, argv[i]))
            return true;
    return argc == 1;
}

static double seconds_now(void) {
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef enum test_outcome { TEST_PASSED, TEST_FAILED, TEST_SKIPPED, TEST_OUTCOMES } test_outcome;

/* Says what is wrong or left out; if verbose, that it is right. */
static test_outcome run(const test_case *test, bool verbose) {
    checks = failures = 0;
    skip_reason = NULL;
    const double start = seconds_now();
    test->run();
    if (checks == 0 && !skip_reason)
        test_check(false, test->file, 0, "checks nothing");
    if (failures)
        printf("FAILED %s (%s): %u of %u checks\n", test->name, test->file, failures, checks);
    else if (skip_reason)
        printf("skipped %s: %s\n", test->name, skip_reason);
    else if (verbose)
        printf("ok %s (%.2f s, %u checks)\n", test->name, seconds_now() - start, checks);
    fflush(stdout);
    return failures ? TEST_FAILED : skip_reason ? TEST_SKIPPED : TEST_PASSED;
}

int main(int argc, char **argv) {
    if (argc > 1 && strcmp(argv[1], "--help") == 0) {
        printf("usage: check [-v] [PART ...]\n"
               "Runs the tests whose own or whose file's name has one of the parts in it; all\n"
               "without any. -v prints every test with its time.\n");
        return 0;
    }
    const bool verbose = argc > 1 && strcmp(argv[1], "-v") == 0;
    unsigned counts[TEST_OUTCOMES] = {0};
    for (const test_case *test = first_test; test; test = test->next)
        if (is_wanted(test, argc - verbose, argv + verbose))
            counts[run(test, verbose)]++;
    printf("%u passed, %u failed", counts[TEST_PASSED], counts[TEST_FAILED]);
    if (counts[TEST_SKIPPED])
        printf(", %u skipped", counts[TEST_SKIPPED]);
    printf("\n");
    return counts[TEST_FAILED] != 0 || counts[TEST_PASSED] == 0;
}
