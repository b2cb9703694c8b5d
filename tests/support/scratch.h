/* Files that a test writes and removes again. */
#ifndef TESTS_SUPPORT_SCRATCH_H
#define TESTS_SUPPORT_SCRATCH_H

#include <stdbool.h>
#include <stddef.h>

typedef struct scratch_path {
    char text[512];
} scratch_path;

/* A path that is this process's own, in $TMPDIR or else the working directory. */
scratch_path scratch_name(const char *name);

/* Reads at most size bytes; returns how many the file has, or -1 if it cannot be read. */
long scratch_read(const char *path, void *bytes, size_t size);

bool scratch_exists(const char *path);

#endif
