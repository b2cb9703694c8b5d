/* Contexts of tests. */
#ifndef TESTS_SUPPORT_CONTEXTS_H
#define TESTS_SUPPORT_CONTEXTS_H

#include "shadowbias/context.h"

/* With the library's own threads, 0: one a processor; checks that there is one. */
shb_context *test_context(uint32_t threads, shb_isa max_isa);

#endif
