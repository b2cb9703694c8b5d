/* The stages of drawing and shading, scene by scene. */
#ifndef BENCH_STAGES_H
#define BENCH_STAGES_H

#include "report.h"
#include "scene.h"

/* Measures work and reference (run NULL: none), fills in the times and reports the row. */
bool stages_measure(bench_session *session, bench_work work, bench_work scalar, bench_row *row);

/* All drawing stages that the options want: depth, camera, dual, cull; then prepare, which leaves
 * the scene with clusters, and the others once more with them. */
bool stages_draw(bench_session *session, example_scene *scene, const char *title);

/* Maps of the scene with vertices that move, for each kind of occluders. */
bool stages_moving(bench_session *session, const example_scene *scene, const char *title);

/* All stages with light and shadow: visibility, shade, frame. */
bool stages_light(bench_session *session, const example_scene *scene, const char *title);

#endif
