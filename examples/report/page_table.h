/* The table of all rows. */
#ifndef REPORT_PAGE_TABLE_H
#define REPORT_PAGE_TABLE_H

#include "rows.h"

#include <stdio.h>

/* Every row carries what the page's script looks for. */
void report_page_table(FILE *stream, const report_rows *rows);

/* Whole numbers with commas between thousands; smaller ones with two or three digits. */
void report_format_number(char *text, size_t size, double value);

#endif
