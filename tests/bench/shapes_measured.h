/* The builders of scenes that are made for measuring; subjects.h describes them. */
#ifndef BENCH_SHAPES_MEASURED_H
#define BENCH_SHAPES_MEASURED_H

#include "scene.h"

void measured_height_field(example_scene *scene);
void measured_hills(example_scene *scene);
void measured_huge(example_scene *scene);
void measured_stack(example_scene *scene);
void measured_triangle(example_scene *scene);
void measured_culled(example_scene *scene);

/* Connects the scene with its meshes, which have their final size now, and counts; sets failed when
 * memory ran out. */
void measured_finish(example_scene *scene);

#endif
