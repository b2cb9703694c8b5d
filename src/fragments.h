/* From a visibility buffer to batches of fragments. */
#ifndef SRC_FRAGMENTS_H
#define SRC_FRAGMENTS_H

#include "kernels/shade.h"

/* Instances that a reader keeps at hand. */
enum { SHB_FRAGMENT_INSTANCES = 16 };

/* What one thread needs to read fragments from a frame; the frame has passed its checks. */
typedef struct shb_fragment_reader {
    const shb_shade_kernels *kernels;
    const shb_frame *frame;
    shb_run_view view;
    shb_surface_instance instances[SHB_FRAGMENT_INSTANCES];
    size_t instance_count, next_instance; /* the one to be replaced next */
    const shb_surface_instance *instance; /* of the last triangle, or NULL */
    shb_surface_runs runs;
    int32_t run_of[SHB_BATCH]; /* of the latest batch, filled up to whole vectors */
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

/* A triangle of the frame, its normal as in shb_surface_runs. False: the scene has none such, or
 * none to be drawn. */
bool shb_fragment_triangle(shb_fragment_reader *reader, uint32_t id,
                           shb_surface_triangle *triangle);

#endif
