#include "progress.h"

#include "timing.h"

#include <stdio.h>
#include <unistd.h>

void progress_begin(progress_line *progress, size_t total) {
    *progress = (progress_line){.total = total,
                                .start = bench_seconds(BENCH_CLOCK_WALL),
                                .terminal = isatty(STDERR_FILENO) != 0};
}

void progress_step(progress_line *progress, const char *step) {
    progress->done++;
    if (!progress->terminal || bench_seconds(BENCH_CLOCK_WALL) - progress->start < 2)
        return;
    progress->shown = true;
    fprintf(stderr, "\r\033[K%zu/%zu %s", progress->done, progress->total, step);
}

void progress_end(progress_line *progress) {
    if (progress->shown)
        fprintf(stderr, "\r\033[K");
    progress->shown = false;
}
