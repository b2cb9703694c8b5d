/* Other renderers beside the library, as the programs of make peers print them. */
#ifndef REPORT_PEERS_H
#define REPORT_PEERS_H

#include "rows.h"

#include <stdio.h>

/* One line of theirs. Times are medians of one thread, milliseconds; 0: there is no such work. */
typedef struct peer_row {
    char peer[32], scene[64], task[64], own_method[64];
    uint32_t map_size;
    uint64_t triangles, fragments;
    double build_ms, ask_ms, own_build_ms, own_ask_ms;
    double times_faster;                  /* the library, all work together */
    double peer_wrong_ppm, own_wrong_ppm; /* of the fragments; negative: not measured */
} peer_row;

/* Zero-initialised is empty. To be released with free. */
typedef struct peer_rows {
    peer_row *rows;
    size_t count;
} peer_rows;

/* Lines that are no rows, as headings and the names of peers that are not installed, are passed
 * over. False: the file cannot be read, or out of memory. */
bool report_peers_read(peer_rows *peers, const char *path);

/* Adds two rows for each, the peer's and the library's, to the file of a report. Their settings
 * keep them apart from its own rows. False: the file cannot be written. */
bool report_peers_append(const peer_rows *peers, const char *path);

/* A section of the page; nothing without rows. */
void report_peers_write(FILE *stream, const peer_rows *peers);

#endif
