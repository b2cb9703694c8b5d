#include "text_scanner.h"

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

static bool is_line_end(char c) {
    return c == '\n' || c == '\r';
}

static bool continues_line(const char *at) {
    return at[0] == '\\' && is_line_end(at[1]);
}

/* A line ends with LF, CR LF or CR. */
static void take_line_end(text_scanner *scanner) {
    scanner->at += scanner->at[0] == '\r' && scanner->at[1] == '\n' ? 2 : 1;
    scanner->line++;
}

static void take_continuation(text_scanner *scanner) {
    scanner->at++;
    take_line_end(scanner);
}

void text_skip_blanks(text_scanner *scanner) {
    for (;;) {
        while (is_blank(*scanner->at))
            scanner->at++;
        if (!continues_line(scanner->at))
            return;
        take_continuation(scanner);
    }
}

bool text_at_statement_end(const text_scanner *scanner) {
    return scanner->at == scanner->end || is_line_end(*scanner->at) || *scanner->at == '#';
}

void text_skip_statement(text_scanner *scanner) {
    bool comment = false;
    while (scanner->at < scanner->end && !is_line_end(*scanner->at)) {
        comment |= *scanner->at == '#';
        if (!comment && continues_line(scanner->at))
            take_continuation(scanner);
        else
            scanner->at++;
    }
    if (scanner->at < scanner->end)
        take_line_end(scanner);
}

bool text_take_keyword(text_scanner *scanner, const char *keyword) {
    const char *at = scanner->at;
    for (; *keyword; keyword++, at++)
        if (*at != *keyword)
            return false;
    if (!is_blank(*at) && !is_line_end(*at) && *at != '\\' && at != scanner->end)
        return false;
    scanner->at = at;
    return true;
}

int text_token_length(const text_scanner *scanner, const char *start) {
    int length = 0;
    while (start + length < scanner->end && !is_blank(start[length]) &&
           !is_line_end(start[length]) && length < 40)
        length++;
    return length;
}
