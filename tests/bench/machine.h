/* What the machine can do at best, measured in the same run as everything else. */
#ifndef BENCH_MACHINE_H
#define BENCH_MACHINE_H

#include <stdbool.h>
#include <stddef.h>

/* Bytes a second of one thread over a buffer of this size; the best of several runs. */
typedef struct machine_bandwidth {
    size_t bytes;
    double set;   /* memset */
    double store; /* a plain loop of 64-byte stores */
    double copy;  /* memcpy of one half onto the other: bytes read and written */
} machine_bandwidth;

enum { MACHINE_BANDWIDTHS_MAX = 5 };

typedef struct bench_machine {
    double cycles_per_second; /* by a chain of additions that take a cycle each */
    machine_bandwidth bandwidths[MACHINE_BANDWIDTHS_MAX]; /* by growing size */
    size_t bandwidth_count;
} bench_machine;

/* Buffers of 1, 4, 16, ... MB, as many as `sizes`. False if there is no memory for them. */
bool machine_measure(size_t sizes, bench_machine *machine);

/* The least seconds to store, or to copy, so many bytes. */
double machine_store_seconds(const bench_machine *machine, double bytes);
double machine_copy_seconds(const bench_machine *machine, double bytes);

/* Writes the buffer by a loop of 64-byte stores; size is a multiple of 64, buffer aligned to it. */
void machine_store_lines(void *buffer, size_t size);

/* Keeps the calling thread on the processor that it runs on; false where that cannot be done. */
bool machine_pin_thread(void);

#endif
