/* The scenes that are measured: the built-in ones, OBJ files, and some made for the purpose. */
#ifndef BENCH_SUBJECTS_H
#define BENCH_SUBJECTS_H

#include "scenes.h"

/* Made for measuring, besides the built-in scenes:
 *
 *   height-field   1000 x 1000 quads over [-1, 1]^2, light straight from above: nine tenths of the
 * map hills          the same shape in 300 x 300 quads, light from the side; for shading huge four
 * triangles: two stacked quads, the lower one first, light from above stack          eight stacked
 * quads, the lowest first, light from the side: each fills two fifths triangle       one triangle
 * that covers the whole map and more culled         the height field, drawn without the side that
 * the light sees
 *
 * The light of OBJ files stands in the direction (0.4, 0.8, 0.45); of the meshes that are known to
 * be closed, back faces are culled, of all others nothing. */

/* Opens a scene by its name or path; scene_close releases it. On failure: false and one sentence.
 */
bool subject_open(const char *name, example_scene **scene, char *error, size_t error_size);

/* Opens a scene made for measuring, or the OBJ file of that name in the folder; folder NULL: there
 * are no files. NULL if the file is not there or cannot be read. */
example_scene *subject_open_if_there(const char *folder, const char *name);

/* A name for tables: a file's without folder and ending. */
void subject_title(const char *name, char *title, size_t size);

/* Leaves in the scene, which has one mesh, the triangles that face away from its directional light,
 * in the order of the mesh. */
void subject_keep_back_faces(example_scene *scene);

/* The names of scenes, each to be released with free. */
typedef struct subject_list {
    char **names;
    size_t count;
} subject_list;

/* All scenes for stages: the built-in ones, height-field and huge, and every OBJ file in the folder
 * if there is one. False when memory ran out; the list must be freed in any case. */
bool subject_list_all(const char *folder, subject_list *list);
bool subject_list_add(subject_list *list, const char *name);
void subject_list_free(subject_list *list);

#endif
