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
    shb_surface_view view;
    shb_surface_instance instances[SHB_FRAGMENT_INSTANCES];
    size_t instance_count, next_instance; /* the one to be replaced next */
    shb_surface_table table;
    uint32_t left; /* the first column of what is read */
    int32_t columns[SHB_SPAN];
    double centers[SHB_SPAN]; /* ndc x of the pixels' centres */
} shb_fragment_reader;

/* Makes a reader of spans that lie in the SHB_SPAN columns from left on. */
void shb_fragment_reader_init(shb_fragment_reader *reader, const shb_shade_kernels *kernels,
                              const shb_frame *frame, const shb_surface_view *view, uint32_t left);

static inline void shb_fragments_clear(shb_fragment_batch *batch) {
    batch->count = 0;
    batch->piece_count = 0;
}

/* Takes a span's pixels into the batch, for which there is room. */
void shb_fragments_take(shb_fragment_reader *reader, const shb_piece *span,
                        shb_fragment_batch *batch);

/* Reads the fragments of all that was taken; their count may become less. */
void shb_fragments_read(shb_fragment_reader *reader, shb_fragment_batch *batch);

/* A triangle of the frame, its normal as in shb_prepared_triangle. False: the scene has none such,
 * or none to be drawn. */
bool shb_fragment_triangle(shb_fragment_reader *reader, uint32_t id,
                           shb_surface_triangle *triangle);

#endif
