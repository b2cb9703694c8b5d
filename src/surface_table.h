/* The triangles that a block of pixels sees, each prepared once: what surface.h prepares for one
 * triangle, as the loops over fragments read it. */
#ifndef SRC_SURFACE_TABLE_H
#define SRC_SURFACE_TABLE_H

#include "surface.h"

/* Pixels of a row that are read at once. Vectors may write as far behind them. */
#define SHB_SPAN 128

/* Triangles of a table; those of a batch always fit. */
#define SHB_TABLE 1024

/* A table finds its triangles by so many of the lowest values of their ids. */
#define SHB_TABLE_MET 2048

/* Vectors may be written as far behind the last element that is wanted. */
#define SHB_TABLE_MARGIN 16

/* Places of triangles are written so many at once. */
#define SHB_PLACES_MARGIN 8

/* What the word facing of a prepared triangle says beside which lights face it. */
enum {
    SHB_SURFACE_USABLE = 1 << 16, /* not there: the kernels leave it to surface.h, triangles without
                                     area, far out of range or not finite; and then it is missing */
    SHB_SURFACE_SMOOTH = 1 << 17, /* the mesh has normals, and shading is there */
    SHB_SURFACE_ALONG = 1 << 18,  /* all shading normals are clearly on the normal's side */
    SHB_SURFACE_AGAINST = 1 << 19 /* all of them are clearly on the other side */
};

/* Where corners begin in place, and vectors in shading. */
enum { SHB_PLACE_CORNERS = 9, SHB_SHADING_CORNERS = 3 };

/* The fields of shb_surface_triangle; corners and shading normals as the first one and the ways
 * from it to the other two. The normal points to the camera's side and is never zero. A triangle is
 * four cache lines, of which flat ones need three. */
typedef struct shb_prepared_triangle {
    union {
        SHB_ALIGN double quads[20]; /* all that flat triangles have, to be read four at a time */
        struct {
            double place[18]; /* cofactors, corners */
            float normal[3];
            uint32_t facing; /* bit k: light k stands on the camera's side; and SHB_SURFACE_ */
        };
    };
    double shading[12]; /* the normal, shading normals */
} shb_prepared_triangle;

typedef struct shb_surface_table {
    shb_prepared_triangle triangles[SHB_TABLE + SHB_TABLE_MARGIN];
    uint32_t ids[SHB_TABLE + 1];
    uint32_t count, prepared; /* the first ones are prepared already */
    bool lacks;               /* some of them are not there */
    bool has_smooth;          /* some of them are smooth */
    /* By the lowest value of ids: the triangle that was met last, and its place. */
    uint32_t met_ids[SHB_TABLE_MET];
    uint16_t met_places[SHB_TABLE_MET];
} shb_surface_table;

/* Corners of triangles as a mesh holds them: x, y, z of each. */
typedef struct shb_surface_corners {
    SHB_ALIGN float positions[9][SHB_BATCH + SHB_TABLE_MARGIN];
    float normals[9][SHB_BATCH + SHB_TABLE_MARGIN];
} shb_surface_corners;

/* Words of a bit for each pixel of a span. */
#define SHB_SPAN_WORDS (SHB_SPAN / 64)

/* Neighbouring pixels of a row. */
typedef struct shb_piece {
    uint32_t row, column, count;
} shb_piece;

/* What is read of a few spans. From the count up to the next multiple of SHB_LANES all repeat the
 * last fragment. */
typedef struct shb_fragment_batch {
    size_t count;
    shb_fragments fragments;
    SHB_ALIGN double centers_x[SHB_BATCH], centers_y[SHB_BATCH]; /* of the pixels, ndc */
    uint32_t places[SHB_BATCH + SHB_PLACES_MARGIN];              /* of triangles in the table */
    uint32_t facing[SHB_BATCH];                                  /* as in shb_prepared_triangle */
    /* Fragments whose pixel's centre lies outside of their triangle. */
    uint16_t outside[SHB_BATCH];
    uint32_t outside_count;
    shb_piece pieces[SHB_BATCH]; /* where the fragments lie, in their order */
    size_t piece_count;
} shb_fragment_batch;

/* Appends pixels of a row to the batch's pieces. */
static inline void shb_pieces_add(shb_fragment_batch *batch, uint32_t row, uint32_t column,
                                  uint32_t count) {
    const size_t pieces = batch->piece_count;
    shb_piece *last = &batch->pieces[pieces ? pieces - 1 : 0];
    if (pieces && last->row == row && last->column + last->count == column)
        last->count += count;
    else
        batch->pieces[batch->piece_count++] = (shb_piece){row, column, count};
}

/* What triangles are prepared for: a camera, and at most 16 lights. */
typedef struct shb_surface_view {
    const shb_view *camera;
    shb_light_source eye;
    const shb_light_source *lights;
    size_t light_count;
} shb_surface_view;

#endif
