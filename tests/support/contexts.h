/* Contexts of tests, and what they log. */
#ifndef TESTS_SUPPORT_CONTEXTS_H
#define TESTS_SUPPORT_CONTEXTS_H

#include "shadowbias/context.h"

/* With the library's own threads, 0: one a processor; checks that there is one. */
shb_context *test_context(uint32_t threads, shb_isa max_isa);

/* How many failures were logged, and the last of them. */
typedef struct test_log {
    int calls;
    shb_result result;
    char sentence[1024];
} test_log;

/* For shb_context_desc.log; user: a test_log. */
void test_log_keep(void *user, shb_result result, const char *sentence);

#endif
