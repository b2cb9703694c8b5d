/* Command lines: "--name value", "--name=value", flags and operands. */
#ifndef EXAMPLES_ARGUMENTS_H
#define EXAMPLES_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum argument_kind {
    ARGUMENT_FLAG,  /* target: bool */
    ARGUMENT_TEXT,  /* const char * */
    ARGUMENT_COUNT, /* uint32_t, lo .. hi */
    ARGUMENT_SIZE,  /* uint32_t[2], "WxH", each lo .. hi */
    ARGUMENT_POINT, /* double[3], "X,Y,Z" */
    ARGUMENT_TEXTS  /* const char **, room for hi texts: of operands, that may be several */
} argument_kind;

typedef struct argument_spec {
    const char *name;  /* with its dashes; NULL: the operand */
    const char *value; /* what the help calls its value; NULL for a flag */
    const char *help;
    argument_kind kind;
    void *target; /* left alone when the argument is absent */
    uint32_t lo, hi;
} argument_spec;

/* False, and one sentence that names the argument in error, if the command line is not right. */
bool arguments_parse(int argc, char **argv, const argument_spec *arguments, size_t count,
                     char *error, size_t error_size);

/* The beginning of a main: parses, and prints what is wrong or, if the flag "--help" was given, the
 * help: usage, which begins with the program's name, a line for each argument, and notes unless
 * they are NULL. False: the program is to end with *exit_code. */
bool arguments_read(int argc, char **argv, const char *usage, const argument_spec *arguments,
                    size_t count, const char *notes, int *exit_code);

#endif
