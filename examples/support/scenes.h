/* Scenes by name: the built-in ones and any OBJ file. */
#ifndef EXAMPLES_SCENES_H
#define EXAMPLES_SCENES_H

#include "scene.h"

typedef struct scene_entry {
    const char *name;
    const char *summary;
    const char *parameter; /* what the number after "name:" means; NULL: takes none */
    double standard, lo, hi;
    void (*build)(example_scene *scene, double parameter);
} scene_entry;

const scene_entry *scene_entries(size_t *count);

/* Makes the scene that text names: "name", "name:number" or the path of an OBJ file, "-" for stdin.
 * An OBJ file is drawn without culling; camera and lights are fitted to its bounds.
 * On failure: false and one sentence in error. */
bool scene_open(const char *text, example_scene **scene, char *error, size_t error_size);

/* NULL is ignored. */
void scene_close(example_scene *scene);

#endif
