/* The report in brief, as a part of a Markdown file with two figures. */
#ifndef REPORT_README_H
#define REPORT_README_H

#include "rows.h"

/* The lines between which the part stands. */
#define REPORT_README_BEGIN "<!-- report -->\n"
#define REPORT_README_END "<!-- end of report -->\n"

typedef struct report_readme {
    const report_rows *rows; /* with their means */
    const char *settings;
    const char *path;    /* of the Markdown file */
    const char *figures; /* directory for hard.svg and soft.svg, as the file links them */
} report_readme;

/* Replaces the part and writes the figures. False, and a line on stderr, if something fails; the
 * Markdown file is untouched then. */
bool report_readme_write(const report_readme *readme);

#endif
