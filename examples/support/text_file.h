/* Files of text: read as a whole, and written with no loss unseen. */
#ifndef EXAMPLES_TEXT_FILE_H
#define EXAMPLES_TEXT_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Reads a file, or stdin for "-": *length bytes and a NUL byte, to be released with free. On
 * failure: NULL and one sentence in error. */
char *text_file_read(const char *path, size_t *length, char *error, size_t error_size);

/* Closes a file that was written; false if some of it is lost. */
bool text_file_close(FILE *stream);

#endif
