#include "assets.h"

#include <stddef.h>

/* The Makefile turns the files page.* into lists of quoted lines. */
const char *const report_page_html[] = {
#include "page.html.inc"
    NULL};

const char *const report_page_css[] = {
#include "page.css.inc"
    NULL};

const char *const report_page_js[] = {
#include "page.js.inc"
    NULL};
