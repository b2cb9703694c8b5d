/* An allocator that counts, fails on demand and knows what leaked. */
#ifndef TESTS_SUPPORT_ALLOCATOR_H
#define TESTS_SUPPORT_ALLOCATOR_H

#include "shadowbias/context.h"

typedef struct test_allocator {
    size_t calls;   /* allocations asked for */
    size_t bytes;   /* of all that were granted */
    size_t live;    /* allocations not freed yet */
    size_t fail_at; /* the call (from 1) that returns NULL, and every later one; 0: none */
} test_allocator;

/* The hooks for a context; the state must outlive it. */
shb_allocator test_allocator_hooks(test_allocator *state);

#endif
