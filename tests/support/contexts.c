#include "contexts.h"

#include "test.h"

#include <stdio.h>

shb_context *test_context(uint32_t threads, shb_isa max_isa) {
    const shb_context_desc desc = {.threads = threads, .max_isa = max_isa};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    return context;
}

void test_log_keep(void *user, shb_result result, const char *sentence) {
    test_log *log = user;
    CHECK(result != SHB_OK);
    log->calls++;
    log->result = result;
    snprintf(log->sentence, sizeof log->sentence, "%s", sentence);
}
