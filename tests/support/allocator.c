#include "allocator.h"

#include <stdlib.h>

static void *counted_alloc(void *user, size_t size, size_t alignment) {
    test_allocator *state = user;
    state->calls++;
    if (state->fail_at && state->calls >= state->fail_at)
        return NULL;
    void *memory = NULL;
    if (posix_memalign(&memory, alignment, size))
        return NULL;
    state->live++;
    state->bytes += size;
    return memory;
}

static void counted_free(void *user, void *memory) {
    test_allocator *state = user;
    state->live--;
    free(memory);
}

shb_allocator test_allocator_hooks(test_allocator *state) {
    return (shb_allocator){counted_alloc, counted_free, state};
}
