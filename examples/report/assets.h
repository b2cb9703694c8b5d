/* The parts of the page that are written in the browser's languages, line by line; NULL ends each.
 */
#ifndef REPORT_ASSETS_H
#define REPORT_ASSETS_H

extern const char *const report_page_html[];
extern const char *const report_page_css[];
extern const char *const report_page_js[];

#endif
