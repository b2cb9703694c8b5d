#include "progress.h"

#include "stopwatch.h"

#include <stdio.h>
#include <unistd.h>

void progress_begin(progress_line *progress, size_t total) {
    *progress = (progress_line){
        .total = total, .start = stopwatch_seconds(), .terminal = isatty(STDERR_FILENO) != 0};
}

void progress_step(progress_line *progress, const char *step) {
    progress->done++;
    if (!progress->terminal || stopwatch_seconds() - progress->start < 2)
        return;
    progress->shown = true;
    fprintf(stderr, "\r\033[K%zu/%zu %s", progress->done, progress->total, step);
}

void progress_end(progress_line *progress) {
    if (progress->shown)
        fprintf(stderr, "\r\033[K");
    progress->shown = false;
}
