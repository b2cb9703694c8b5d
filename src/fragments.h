/* From a visibility buffer to batches of fragments. */
#ifndef SRC_FRAGMENTS_H
#define SRC_FRAGMENTS_H

#include "kernels/shade.h"

/* Triangles that a reader keeps prepared: small ones come back on the next rows. A triangle may lie
 * in any way of the set that its id belongs to. Powers of two. */
enum { SHB_FRAGMENT_SETS = 64, SHB_FRAGMENT_WAYS = 4 };

typedef struct shb_fragment_triangle {
    shb_surface_triangle surface; /* its normal points to the camera's side and is never zero */
    uint32_t facing;              /* bit k: light k stands on the camera's side of it */
    bool exists;                  /* false: the scene has no such triangle, or none to be drawn */
} shb_fragment_triangle;

typedef struct shb_fragment_set {
    uint32_t ids[SHB_FRAGMENT_WAYS];   /* SHB_ID_NONE: nothing is kept here */
    uint32_t batch[SHB_FRAGMENT_WAYS]; /* the last one that it was used for */
    shb_fragment_triangle triangles[SHB_FRAGMENT_WAYS];
} shb_fragment_set;

/* What one thread needs to read fragments from a frame; the frame has passed its checks. */
typedef struct shb_fragment_reader {
    const shb_shade_kernels *kernels;
    const shb_frame *frame;
    shb_light_source eye;
    const shb_light_source *lights; /* at most 32 */
    size_t light_count;
    uint32_t batch;                 /* number of the current one */
    const void *records[SHB_BATCH]; /* its shb_surface_triangles, filled up to whole vectors */
    shb_surface_instance instance;  /* of the last triangle; first_id SHB_ID_NONE: none */
    shb_fragment_set sets[SHB_FRAGMENT_SETS];
} shb_fragment_reader;

/* Pixels of a row; at most SHB_BATCH of them are read at once. */
typedef struct shb_fragment_span {
    uint32_t row, column, end;
} shb_fragment_span;

void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, shb_light_source eye,
                              const shb_light_source *lights, size_t light_count);

/* Reads the next batch of the span and moves its column behind it. Returns the number of fragments,
 * 0 at the end of the span. facing[i] tells which lights fragment i's triangle faces. */
size_t shb_fragments_read(shb_fragment_reader *reader, shb_fragment_span *span,
                          shb_fragments *fragments, uint32_t facing[SHB_BATCH]);

#endif
