#include "text_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* Doubles the buffer as it goes: works for pipes too, whose length nobody knows. */
static char *read_stream(FILE *stream, size_t *length) {
    size_t capacity = 1 << 16, used = 0;
    char *text = malloc(capacity);
    while (text) {
        used += fread(text + used, 1, capacity - 1 - used, stream);
        if (used < capacity - 1)
            break;
        char *grown = realloc(text, 2 * capacity);
        if (!grown)
            free(text);
        text = grown;
        capacity *= 2;
    }
    if (!text) {
        errno = ENOMEM;
        return NULL;
    }
    if (ferror(stream)) {
        free(text);
        return NULL;
    }
    text[used] = 0;
    *length = used;
    return text;
}

char *text_file_read(const char *path, size_t *length, char *error, size_t error_size) {
    const bool is_stdin = strcmp(path, "-") == 0;
    FILE *stream = is_stdin ? stdin : fopen(path, "rb");
    char *text = stream ? read_stream(stream, length) : NULL;
    if (!text)
        snprintf(error, error_size, "%s: %s", path, strerror(errno));
    if (stream && !is_stdin)
        fclose(stream);
    return text;
}

bool text_file_close(FILE *stream) {
    const bool written = !ferror(stream);
    return fclose(stream) == 0 && written;
}
