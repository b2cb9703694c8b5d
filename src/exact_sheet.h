/* The straight way over one sheet of the mesh of a map's occluders, as the light sees it, to the
 * triangle that covers a place. While the mesh does not turn round, the edge that the line crosses
 * is one that the place lies beyond; where it lies beyond two, it is told by the corner between
 * them ("Walking in a Triangulation", Devillers, Pion and Teillaud 2002). */
#ifndef SRC_EXACT_SHEET_H
#define SRC_EXACT_SHEET_H

#include "light_mesh.h"

/* Corners of the ordered edges, the lower one first. */
static const uint8_t shb_ends_of_edges[2][3] = {{1, 0, 0}, {2, 2, 1}};

/* One bit for each ordered edge that a place lies beyond; all for a triangle without area. Edges
 * are followed from the lower vertex to the higher one, so that the two triangles of an edge always
 * agree: a place lies in exactly one of them, or on both. */
static inline uint32_t shb_edges_before(const shb_walk_triangle *t, const double place[2]) {
    const double x[3] = {t->x[0] - place[0], t->x[1] - place[0], t->x[2] - place[0]};
    const double y[3] = {t->y[0] - place[1], t->y[1] - place[1], t->y[2] - place[1]};
    const double side_0 = x[1] * y[2] - y[1] * x[2], side_1 = x[0] * y[2] - y[0] * x[2];
    const double side_2 = x[0] * y[1] - y[0] * x[1], area = (side_0 - side_1) + side_2;
    const uint32_t right =
        (uint32_t)(side_0 < 0) | (uint32_t)(side_1 > 0) << 1 | (uint32_t)(side_2 < 0) << 2;
    const uint32_t left =
        (uint32_t)(side_0 > 0) | (uint32_t)(side_1 < 0) << 1 | (uint32_t)(side_2 > 0) << 2;
    const uint32_t is_left = -(uint32_t)(area < 0), has_none = -(uint32_t) !(area != 0);
    return (right ^ ((right ^ left) & is_left)) | (7 & has_none);
}

/* How far a corner lies to one side of the way between two places, times its length. */
static inline double shb_corner_across(const shb_walk_triangle *t, uint32_t corner,
                                       const double from[2], const double to[2]) {
    return (to[0] - from[0]) * (t->y[corner] - to[1]) - (to[1] - from[1]) * (t->x[corner] - to[0]);
}

/* Of two edges, by the numbers of the corners opposite of them, the one that the way to a place
 * beyond both crosses: it passes the corner between them on the side that the edge's other end is
 * not on. */
static inline uint32_t shb_edge_crossed(const shb_walk_triangle *t, uint32_t one, uint32_t other,
                                        const double from[2], const double to[2]) {
    const uint32_t between = 3 - one - other;
    const bool passes = shb_corner_across(t, between, from, to) < 0;
    return passes == (shb_corner_across(t, one, from, to) < 0) ? one : other;
}

/* The triangle that follows one on the way; itself if it covers the place or if the sheet ends
 * there, turns round, or is not all of it behind the light's near plane. */
static inline uint32_t shb_sheet_next(const shb_light_mesh *mesh, uint32_t triangle,
                                      const double from[2], const double to[2], bool *covers) {
    static const uint8_t edges[8] = {0, 0, 1, 0, 2, 0, 1, 0}, others[8] = {0, 0, 1, 1, 2, 2, 2, 0};
    const uint32_t whole = 7 * SHB_CORNER_SEEN;
    const shb_walk_triangle *t = &mesh->triangles[triangle];
    const uint32_t before = shb_edges_before(t, to);
    *covers = before == 0 && (t->marks & whole) == whole;
    if (before == 0 || before == 7)
        return triangle;
    uint32_t edge = edges[before];
    if (edge != others[before])
        edge = shb_edge_crossed(t, edge, others[before], from, to);
    return t->marks & SHB_EDGE_JOINED << edge ? shb_neighbour_of(t->beyond[edge]) : triangle;
}

/* Triangles of a way. */
#define SHB_SHEET_MAX 256

/* The triangle of the same sheet that covers a place; SHB_ID_NONE: the way there ends before. */
static inline uint32_t shb_sheet_end(const shb_light_mesh *mesh, uint32_t triangle,
                                     const double from[2], const double to[2]) {
    bool covers = false;
    for (int steps = 0; steps < SHB_SHEET_MAX; steps++) {
        const uint32_t next = shb_sheet_next(mesh, triangle, from, to, &covers);
        if (next == triangle)
            return covers ? triangle : SHB_ID_NONE;
        triangle = next;
    }
    return SHB_ID_NONE;
}

#endif
