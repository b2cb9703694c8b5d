/* The scenes of a survey: those that the user names, or built-in ones and meshes of a directory. */
#ifndef REPORT_SCENE_LIST_H
#define REPORT_SCENE_LIST_H

#include "survey.h"

typedef struct report_scene {
    char text[512]; /* as scene_open takes it */
    char name[64];  /* for rows and files: letters, digits, '-', '_' and '.'; no two are equal */
    bool both_lights, soft; /* soft: lights with an extent, too */
} report_scene;

typedef struct report_scene_list {
    report_scene *scenes;
    size_t count, capacity;
    bool failed; /* out of memory */
} report_scene_list;

/* Scenes in the order in which the report shows them. */
report_scene_list report_list_scenes(const report_options *options);

/* The few that studies look at more closely. */
report_scene_list report_list_main_scenes(const report_options *options);

/* A name for rows and files: without directory and ending, letters, digits, '-', '_' and '.'. */
void report_name_scene(const char *text, char *name, size_t size);

void report_scene_list_free(report_scene_list *list);

#endif
