/* Statements of line-based text files: lines, blanks, comments, continuation, tokens. */
#ifndef EXAMPLES_TEXT_SCANNER_H
#define EXAMPLES_TEXT_SCANNER_H

#include <stdbool.h>
#include <stdint.h>

typedef struct text_scanner {
    const char *at, *end; /* *end is a NUL byte */
    uint32_t line;        /* from 1 */
} text_scanner;

/* Skips spaces, tabs and backslashes at the end of a line, which continue the statement. */
void text_skip_blanks(text_scanner *scanner);

/* True where no token is left in the statement; blanks must have been skipped. */
bool text_at_statement_end(const text_scanner *scanner);

/* Moves to the start of the next statement. */
void text_skip_statement(text_scanner *scanner);

/* Skips the keyword if it is the next token. */
bool text_take_keyword(text_scanner *scanner, const char *keyword);

/* Length of the token that starts at a place. */
int text_token_length(const text_scanner *scanner, const char *start);

#endif
