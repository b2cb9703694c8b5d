/* Wavefront OBJ files: positions, normals and faces; all other statements are skipped. */
#ifndef EXAMPLES_OBJ_H
#define EXAMPLES_OBJ_H

#include "owned_mesh.h"

/* Reads a file, or stdin for "-". Faces of any number of corners become fans around their first
 * corner, which is right for convex faces. When every corner of every face names a normal, a vertex
 * is made of each (position, normal) pair in use; otherwise the mesh has the file's positions, no
 * normals. Indices may be negative (relative) and may name vertices further down.
 * On failure: false, *mesh untouched and one sentence with file and line in error. */
bool obj_read_file(const char *path, owned_mesh *mesh, char *error, size_t error_size);

/* The same from length bytes of text followed by a NUL byte; name takes the file's place in errors.
 */
bool obj_read_text(const char *text, size_t length, const char *name, owned_mesh *mesh, char *error,
                   size_t error_size);

#endif
