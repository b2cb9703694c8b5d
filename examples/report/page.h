/* The report as one HTML file that needs nothing else. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "peers.h"
#include "rows.h"

typedef struct report_page {
    const report_rows *rows; /* with their means */
    const char *pictures;    /* directory of the PNG files */
    const char *directory;   /* of the report, where the sections of studies are */
    const char *settings;
    const peer_rows *peers;
} report_page;

/* False: the file cannot be written. Pictures that are not there are left out. */
bool report_page_write(const report_page *page, const char *path);

#endif
