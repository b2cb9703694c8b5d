#include "machine_name.h"

#include <stdio.h>
#include <string.h>

void report_machine_name(char *name, size_t size) {
    char line[256];
    FILE *stream = fopen("/proc/cpuinfo", "r");
    snprintf(name, size, "an unknown processor");
    while (stream && fgets(line, sizeof line, stream)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value)
            continue;
        line[strcspn(line, "\n<>&\"")] = 0;
        snprintf(name, size, "%s", value + 2);
        break;
    }
    if (stream)
        fclose(stream);
}
