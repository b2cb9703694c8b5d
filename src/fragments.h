/* From a visibility buffer to batches of fragments. */
#ifndef SRC_FRAGMENTS_H
#define SRC_FRAGMENTS_H

#include "surface.h"

/* Triangles that a reader keeps prepared: small ones come back on the next rows. A power of two. */
#define SHB_FRAGMENT_CACHE 32

typedef struct shb_fragment_triangle {
    uint32_t id;                  /* SHB_ID_NONE: nothing is kept here */
    bool exists;                  /* false: the scene has no such triangle, or none to be drawn */
    uint32_t facing;              /* bit k: light k stands on the camera's side of it */
    shb_surface_triangle surface; /* its normal points to the camera's side and is never zero */
} shb_fragment_triangle;

/* What one thread needs to read fragments from a frame; the frame has passed its checks. */
typedef struct shb_fragment_reader {
    const shb_frame *frame;
    shb_light_source eye;
    const shb_light_source *lights; /* at most 32 */
    size_t light_count;
    shb_fragment_triangle cache[SHB_FRAGMENT_CACHE];
} shb_fragment_reader;

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_frame *frame,
                              shb_light_source eye, const shb_light_source *lights,
                              size_t light_count);

/* Reads the next batch of a row from pixel *column on and moves *column behind it. Returns the
 * number of fragments, 0 at the end of the row. facing[i] tells which lights fragment i's triangle
 * faces. */
size_t shb_fragments_read(shb_fragment_reader *reader, uint32_t row, uint32_t *column,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]);

#endif
