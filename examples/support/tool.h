/* What the command-line programs have in common: exit codes, and failures told on stderr. */
#ifndef EXAMPLES_TOOL_H
#define EXAMPLES_TOOL_H

#include "scenes.h"

#include "shadowbias/context.h"
#include "shadowbias/image.h"

#include <stdio.h>

enum { TOOL_OK = 0, TOOL_FAILED = 1, TOOL_USAGE = 2 };

/* A context whose failures appear on stderr as "program: sentence". NULL, and a line on stderr, if
 * there can be none. program must outlive it. */
shb_context *tool_create_context(const char *program, uint32_t threads, shb_isa max_isa);

/* The scene of this name (scenes.h); NULL, and a line on stderr, if it cannot be opened. */
example_scene *tool_open_scene(const char *program, const char *name);

/* Finds an instruction set by its name, "best" included; false if there is none of that name. */
bool tool_parse_isa(const char *name, shb_isa *isa);

/* True if the result is no error; else a line on stderr tells what failed. */
bool tool_succeeds(const char *program, const char *what, shb_result result);

/* Writes an image; false, and a line on stderr, when that fails. */
bool tool_write_image(const char *program, const shb_image *image, const char *path);

/* The same as name.ppm in a directory. */
bool tool_write_picture(const char *program, const shb_image *image, const char *directory,
                        const char *name);

/* Closes a file of text that was written; false, and a line on stderr, if some of it is lost. */
bool tool_close_text(const char *program, FILE *stream, const char *path);

/* True if the name is one of those, which end with NULL. */
bool tool_is_among(const char *name, const char *const *names);

#endif
