/* The triangles that a block of pixels sees, each prepared once: what surface.h prepares for one
 * triangle, as the loops over fragments read it. */
#ifndef SRC_SURFACE_TABLE_H
#define SRC_SURFACE_TABLE_H

#include "surface.h"

/* Pixels of a row that are read at once. Vectors may write as far behind them. */
#define SHB_SPAN 128

/* Triangles of a table; those of a row always fit. */
#define SHB_TABLE 1024

/* Vectors may be written as far behind the last element that is wanted. */
#define SHB_TABLE_MARGIN 16

/* The fields of shb_surface_triangle; corners and shading normals as the first one and the ways
 * from it to the other two. The normal points to the camera's side and is never zero. */
typedef struct shb_prepared_triangle {
    SHB_ALIGN double
        cofactors[9]; /* a triangle is four cache lines, of which flat ones need three */
    double corners[9];
    float normal[3];
    uint16_t facing; /* bit k: light k stands on the camera's side */
    uint8_t usable;  /* 1, or 0 where the kernels leave it to surface.h: triangles without area, far
                        out of range or not finite; and then where it is not there */
    uint8_t smooth;  /* 1: the mesh has normals, and what follows is there */
    double exact_normal[3];
    double shading[9];
} shb_prepared_triangle;

typedef struct shb_surface_table {
    shb_prepared_triangle triangles[SHB_TABLE + SHB_TABLE_MARGIN];
    uint32_t ids[SHB_TABLE + 1];
    uint32_t count;
    bool lacks;                 /* some of them are not there */
    uint16_t places[SHB_TABLE]; /* where a triangle may be, by its id */
} shb_surface_table;

/* Corners of triangles as a mesh holds them: x, y, z of each. */
typedef struct shb_surface_corners {
    SHB_ALIGN float positions[9][SHB_SPAN + SHB_TABLE_MARGIN];
    float normals[9][SHB_SPAN + SHB_TABLE_MARGIN];
} shb_surface_corners;

/* What triangles are prepared for: a camera, and at most 16 lights. */
typedef struct shb_surface_view {
    const shb_view *camera;
    shb_light_source eye;
    const shb_light_source *lights;
    size_t light_count;
} shb_surface_view;

/* Room for the pixels of a span where runs begin, and for what vectors write behind them. */
#define SHB_STARTS (SHB_SPAN + SHB_TABLE_MARGIN)

/* Neighbouring pixels of a row, begin .. end - 1, that see the same triangle. */
typedef struct shb_surface_run {
    uint32_t place; /* in the table */
    uint32_t begin, end;
} shb_surface_run;

#endif
