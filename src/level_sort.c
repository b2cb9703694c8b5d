#include "strict.h"

#include "level_sort.h"

#include "starts.h"

/* Up to so many are put in their places one by one. */
enum { FEW = 32 };

/* By the byte of the key that begins at bit shift; equal ones keep their order. */
static void sort_by_byte(size_t count, const uint64_t *from, int shift, uint64_t *to) {
    size_t starts[256] = {0};
    for (size_t i = 0; i < count; i++)
        starts[from[i] >> shift & 255]++;
    shb_starts_of_lengths(256, starts);
    for (size_t i = 0; i < count; i++)
        to[starts[from[i] >> shift & 255]++] = from[i];
}

static void sort_few(size_t count, uint64_t *keys) {
    for (size_t i = 1; i < count; i++) {
        const uint64_t key = keys[i];
        size_t at = i;
        for (; at > 0 && keys[at - 1] > key; at--)
            keys[at] = keys[at - 1];
        keys[at] = key;
    }
}

void shb_sort_by_level(size_t count, uint64_t *keys, uint64_t *spare) {
    if (count <= FEW) {
        sort_few(count, keys);
        return;
    }
    sort_by_byte(count, keys, 32, spare);
    sort_by_byte(count, spare, 40, keys);
}
