/* The scene as lists need it: vertices once each in the world and as the light sees them, triangles
 * by id. */
#ifndef SRC_LISTS_LOAD_H
#define SRC_LISTS_LOAD_H

#include "lists.h"

typedef struct shb_list_loading {
    shb_lists *lists;
    const shb_scene *scene;
    shb_list_vertex *vertices; /* of the scene, as the light sees them */
    uint64_t
        *names; /* hashes of the vertices' places in the world; NULL: outlines are not wanted */
    size_t vertex_count;
    shb_list_extent *extents; /* one for each run of vertices */
} shb_list_loading;

/* Vertices of the meshes that have triangles; at most SIZE_MAX. */
size_t shb_list_vertex_count(const shb_scene *scene);

size_t shb_list_vertex_runs(size_t vertex_count);

/* Vertices to the world and to the light; fits the frame to them. */
void shb_list_load_vertices(const shb_list_loading *loading);

/* What is known of triangles while lists are built, by id. */
typedef struct shb_list_shapes {
    shb_list_box *boxes;
    uint16_t *levels;           /* of their nearest depths */
    shb_list_outline *outlines; /* NULL: none are wanted */
} shb_list_shapes;

/* Writes corners, triangles and shapes of the ids from begin to end. */
void shb_list_load_triangles(const shb_list_loading *loading, uint32_t begin, uint32_t end,
                             const shb_list_shapes *shapes);

#endif
