#include "scratch.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

scratch_path scratch_name(const char *name) {
    const char *folder = getenv("TMPDIR");
    scratch_path path;
    snprintf(path.text, sizeof(path.text), "%s/scratch-%ld-%s", folder ? folder : ".",
             (long)getpid(), name);
    return path;
}

long scratch_read(const char *path, void *bytes, size_t size) {
    FILE *file = fopen(path, "rb");
    if (!file)
        return -1;
    long count = (long)fread(bytes, 1, size, file);
    while (fgetc(file) != EOF)
        count++;
    fclose(file);
    return count;
}

bool scratch_exists(const char *path) {
    return access(path, F_OK) == 0;
}
