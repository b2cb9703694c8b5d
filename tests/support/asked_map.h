/* A scene, points on it, and maps that are asked about them by the exact method. */
#ifndef TESTS_SUPPORT_ASKED_MAP_H
#define TESTS_SUPPORT_ASKED_MAP_H

#include "../../src/exact.h"

#include "shadowbias/shadowbias.h"
#include "soup.h"

typedef struct asked_map {
    shb_context *context;
    shb_map *map;
} asked_map;

asked_map asked_map_draw(shb_isa isa, const shb_map_desc *map, soup *s);
void asked_map_close(asked_map *made);

enum { ASKED_POINTS = 1200 };

typedef struct asked_points {
    float positions[3 * ASKED_POINTS], normals[3 * ASKED_POINTS];
} asked_points;

/* On random triangles, half of them on the first two, and some that are no numbers, far away, or
 * without a normal. */
void asked_points_fill(const soup *s, uint64_t seed, asked_points *made);

/* False: nothing of the map's shadows it. */
bool asked_point_fragment(const shb_map *map, const asked_points *given, int i,
                          shb_exact_fragment *fragment);

shb_result asked_map_answer(const asked_map *made, const asked_points *given,
                            const shb_filter *filter, float *visibility);

/* The same, and that it succeeds; for one thread. */
void asked_map_ask(const asked_map *made, const asked_points *given, const shb_filter *filter,
                   float *visibility);

/* A ball over a tilted floor, and a wall that stands on it. */
void asked_scene_add(soup *s);

/* A rough sheet, up to the edge of the map. */
void asked_scene_add_relief(soup *s);

/* A plane of 88.5 degrees, and many that are too steep for their slopes to be kept. */
void asked_scene_add_steep(soup *s);

/* The probe's spot sees heights of 1 to 3. */
void asked_scene_lift(soup *s);

#endif
