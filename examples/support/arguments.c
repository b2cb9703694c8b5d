#include "arguments.h"

#include "tool.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The argument whose name is the first length characters of text; length 0: the operand. */
static const argument_spec *find_argument(const argument_spec *arguments, size_t count,
                                          const char *text, size_t length) {
    for (size_t i = 0; i < count; i++) {
        const char *name = arguments[i].name ? arguments[i].name : "";
        if (strlen(name) == length && memcmp(name, text, length) == 0)
            return &arguments[i];
    }
    return NULL;
}

/* Reads a whole number within the bounds and moves *text behind it. */
static bool read_count(const argument_spec *argument, const char **text, uint32_t *value) {
    if (**text < '0' || **text > '9')
        return false;
    char *end;
    errno = 0;
    const unsigned long long number = strtoull(*text, &end, 10);
    if (errno || number < argument->lo || number > argument->hi)
        return false;
    *text = end;
    *value = (uint32_t)number;
    return true;
}

static bool read_size(const argument_spec *argument, const char *text, uint32_t size[2]) {
    uint32_t read[2];
    if (!read_count(argument, &text, &read[0]) || *text++ != 'x' ||
        !read_count(argument, &text, &read[1]) || *text)
        return false;
    memcpy(size, read, sizeof read);
    return true;
}

static bool read_point(const char *text, double point[3]) {
    double read[3];
    for (int i = 0; i < 3; i++) {
        char *end;
        read[i] = strtod(text, &end);
        if (end == text || !isfinite(read[i]) || *end != (i < 2 ? ',' : 0))
            return false;
        text = end + 1;
    }
    memcpy(point, read, sizeof read);
    return true;
}

static bool read_value(const argument_spec *argument, const char *text, char *error,
                       size_t error_size) {
    uint32_t value;
    const char *end = text;
    switch (argument->kind) {
    case ARGUMENT_FLAG:
    case ARGUMENT_TEXTS:
        break;
    case ARGUMENT_TEXT:
        *(const char **)argument->target = text;
        return true;
    case ARGUMENT_COUNT:
        if (read_count(argument, &end, &value) && !*end) {
            *(uint32_t *)argument->target = value;
            return true;
        }
        snprintf(error, error_size, "%s: \"%s\" is not a number of %u to %u", argument->name, text,
                 argument->lo, argument->hi);
        return false;
    case ARGUMENT_SIZE:
        if (read_size(argument, text, argument->target))
            return true;
        snprintf(error, error_size, "%s: \"%s\" is not WxH with both %u to %u", argument->name,
                 text, argument->lo, argument->hi);
        return false;
    case ARGUMENT_POINT:
        if (read_point(text, argument->target))
            return true;
        snprintf(error, error_size, "%s: \"%s\" is not three numbers X,Y,Z", argument->name, text);
        return false;
    }
    snprintf(error, error_size, "%s: takes no value", argument->name);
    return false;
}

static uint32_t most_operands(const argument_spec *argument) {
    return argument->kind == ARGUMENT_TEXTS ? argument->hi : 1;
}

bool arguments_parse(int argc, char **argv, const argument_spec *arguments, size_t count,
                     char *error, size_t error_size) {
    uint32_t operands = 0;
    for (int i = 1; i < argc; i++) {
        const char *text = argv[i];
        const bool is_option = text[0] == '-' && text[1];
        const char *equals = is_option ? strchr(text, '=') : NULL;
        const size_t length = !is_option ? 0 : equals ? (size_t)(equals - text) : strlen(text);
        const argument_spec *argument = find_argument(arguments, count, text, length);
        if (!argument || (!is_option && operands == most_operands(argument))) {
            snprintf(error, error_size, "%s: unknown argument", text);
            return false;
        }
        if (argument->kind == ARGUMENT_TEXTS) {
            ((const char **)argument->target)[operands++] = text;
            continue;
        }
        operands += !is_option;
        if (argument->kind == ARGUMENT_FLAG && !equals) {
            *(bool *)argument->target = true;
            continue;
        }
        const char *value = !is_option ? text : equals ? equals + 1 : argv[++i];
        if (!value) {
            snprintf(error, error_size, "%s: a value %s is missing", text, argument->value);
            return false;
        }
        if (!read_value(argument, value, error, error_size))
            return false;
    }
    return true;
}

static void print_help(const char *usage, const argument_spec *arguments, size_t count,
                       const char *notes) {
    printf("usage: %s\n", usage);
    for (size_t i = 0; i < count; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s%s%s", arguments[i].name ? arguments[i].name : "",
                 arguments[i].name && arguments[i].value ? " " : "",
                 arguments[i].value ? arguments[i].value : "");
        printf("  %-26s %s\n", left, arguments[i].help);
    }
    printf("%s", notes ? notes : "");
}

bool arguments_read(int argc, char **argv, const char *usage, const argument_spec *arguments,
                    size_t count, const char *notes, int *exit_code) {
    const argument_spec *help = find_argument(arguments, count, "--help", strlen("--help"));
    char error[512];
    *exit_code = TOOL_USAGE;
    if (!arguments_parse(argc, argv, arguments, count, error, sizeof error)) {
        fprintf(stderr, "%.*s: %s\n", (int)strcspn(usage, " "), usage, error);
        return false;
    }
    if (!*(const bool *)help->target)
        return true;
    print_help(usage, arguments, count, notes);
    *exit_code = TOOL_OK;
    return false;
}
