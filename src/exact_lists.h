/* The exact method where the map keeps lists. Where it has sheets, too, these answer most points,
 * and those that they leave unsure wait until there is a batch of them. */
#ifndef SRC_EXACT_LISTS_H
#define SRC_EXACT_LISTS_H

#include "exact_points.h"

void shb_exact_ask_lists(const shb_map *map, const shb_exact_points *points, float *visibility);

/* Writes the answers that sheets are certain of, and the numbers of the other points; returns how
 * many these are. */
size_t shb_exact_settle(const shb_map *map, const shb_exact_points *points, float *visibility,
                        uint16_t unsure[SHB_BATCH]);

/* Points that wait for the lists of a map with sheets; on which triangles they lie is not known. */
typedef struct shb_unsure_points {
    const shb_map *map;
    float *visibility; /* of all points */
    size_t numbers[SHB_BATCH];
    shb_exact_points points;
} shb_unsure_points;

void shb_unsure_points_begin(const shb_map *map, float *visibility, shb_unsure_points *unsure);

/* A batch, whose numbers are first and the following ones. */
void shb_unsure_points_ask(shb_unsure_points *unsure, const shb_exact_points *points, size_t first);

/* Asks for what still waits. */
void shb_unsure_points_end(shb_unsure_points *unsure);

#endif
