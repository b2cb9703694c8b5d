/* What hosts may hand over to the library, sound or absurd, made of a number. */
#ifndef TESTS_SUPPORT_RANDOM_USE_H
#define TESTS_SUPPORT_RANDOM_USE_H

#include "shadowbias/shadowbias.h"

enum {
    USE_SIDE = 18, /* vertices along a surface's side */
    USE_VERTICES = USE_SIDE * USE_SIDE,
    USE_TRIANGLES = 2 * (USE_SIDE - 1) * (USE_SIDE - 1),
    USE_POINTS = 400,
    USE_INSTANCES = 3,
    USE_LIGHTS = 2,
    USE_WIDTH = 48, /* pixels of the camera's picture */
    USE_HEIGHT = 40
};

typedef struct random_use {
    float vertices[USE_VERTICES * 3], shading_normals[USE_VERTICES * 3];
    uint32_t wide[USE_TRIANGLES * 3];
    uint16_t narrow[USE_TRIANGLES * 3];
    shb_mesh mesh;
    shb_instance instances[USE_INSTANCES];
    shb_scene scene;

    shb_map_desc map;
    shb_bias drawn_for, bias;
    shb_filter filter;
    bool prepares;

    float positions[USE_POINTS * 3], normals[USE_POINTS * 3];
    uint32_t ids[USE_POINTS];
    float weight_1[USE_POINTS], weight_2[USE_POINTS];
    shb_points points;

    shb_view camera;
    size_t light_count;
    bool smooth_terminator;
} random_use;

/* The same use for the same number, on every machine. The use refers to itself: it must not move.
 */
void random_use_make(uint64_t seed, random_use *use);

#endif
