/* One line on the terminal about work that takes long; silent when stderr is not a terminal. */
#ifndef EXAMPLES_PROGRESS_H
#define EXAMPLES_PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

typedef struct progress_line {
    size_t done, total;
    double start;
    bool terminal, shown;
} progress_line;

/* Starts a piece of work of total steps. */
void progress_begin(progress_line *progress, size_t total);

/* Tells which step begins. Shows nothing in the first two seconds. */
void progress_step(progress_line *progress, const char *step);

/* Clears the line. */
void progress_end(progress_line *progress);

#endif
