#include "lists_sort.h"

#include <string.h>

enum { DIGIT_BITS = 8, DIGITS = 4, BUCKETS = 1 << DIGIT_BITS };

uint32_t shb_list_depth_key(float depth) {
    uint32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static size_t digit(uint32_t depth, int place) {
    return depth >> (DIGIT_BITS * place) & (BUCKETS - 1);
}

/* Radix sort from the lowest digit on; an even number of passes ends where it began. */
void shb_list_sort(shb_list_key *keys, shb_list_key *spare, size_t count) {
    size_t starts[DIGITS][BUCKETS] = {{0}};
    for (size_t i = 0; i < count; i++)
        for (int place = 0; place < DIGITS; place++)
            starts[place][digit(keys[i].depth, place)]++;
    for (int place = 0; place < DIGITS; place++) {
        size_t sum = 0;
        for (size_t bucket = 0; bucket < BUCKETS; bucket++) {
            const size_t in_bucket = starts[place][bucket];
            starts[place][bucket] = sum;
            sum += in_bucket;
        }
        for (size_t i = 0; i < count; i++)
            spare[starts[place][digit(keys[i].depth, place)]++] = keys[i];
        shb_list_key *const sorted = spare;
        spare = keys;
        keys = sorted;
    }
}
