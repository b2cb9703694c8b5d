/* The builders of the built-in scenes: each fills an empty scene. The number is the scene's own
 * parameter, as the table in scenes.c describes it. */
#ifndef EXAMPLES_SCENES_BUILTIN_H
#define EXAMPLES_SCENES_BUILTIN_H

#include "scene.h"

void scene_build_tilted_plane(example_scene *scene, double angle);
void scene_build_box(example_scene *scene, double unused);
void scene_build_l_shape(example_scene *scene, double unused);
void scene_build_thin_wall(example_scene *scene, double thickness);
void scene_build_staircase(example_scene *scene, double unused);
void scene_build_gap(example_scene *scene, double gap);
void scene_build_sphere(example_scene *scene, double unused);
void scene_build_wedge(example_scene *scene, double angle);
void scene_build_columns(example_scene *scene, double unused);
void scene_build_island(example_scene *scene, double unused);
void scene_build_tree(example_scene *scene, double unused);

#endif
