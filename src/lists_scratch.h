/* What the buffers of a context's list_scratch hold. */
#ifndef SRC_LISTS_SCRATCH_H
#define SRC_LISTS_SCRATCH_H

enum {
    /* memory of the next lists */
    SHB_LIST_TILES,
    SHB_LIST_CELLS,
    SHB_LIST_ENTRIES,
    SHB_LIST_TRIANGLES,
    SHB_LIST_CORNERS,
    SHB_LIST_WORLD,  /* vertices */
    SHB_LIST_BOUNDS, /* of sheets */
    SHB_LIST_KEPT,   /* how many these are */
    /* while lists are built */
    SHB_LIST_VERTICES = SHB_LIST_KEPT, /* as the light sees them */
    SHB_LIST_NAMES,
    SHB_LIST_EXTENTS,
    SHB_LIST_BOXES,
    SHB_LIST_TRIANGLE_LEVELS,
    SHB_LIST_OUTLINES,
    SHB_LIST_ENDS,
    SHB_LIST_KEYS,
    SHB_LIST_COVERS,   /* a tile for each lane */
    SHB_LIST_SPARE,    /* keys while a tile's are sorted */
    SHB_LIST_UNSORTED, /* entries before they are sorted by cell */
    SHB_LIST_BUFFERS
};

#endif
