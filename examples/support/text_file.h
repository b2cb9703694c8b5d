/* A whole file in memory. */
#ifndef EXAMPLES_TEXT_FILE_H
#define EXAMPLES_TEXT_FILE_H

#include <stdbool.h>
#include <stddef.h>

/* Reads a file, or stdin for "-": *length bytes and a NUL byte, to be released with free. On
 * failure: NULL and one sentence in error. */
char *text_file_read(const char *path, size_t *length, char *error, size_t error_size);

#endif
