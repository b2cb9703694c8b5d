/* The loops of building lists and asking them, one implementation for each instruction set; all
 * give the same bits. */
#ifndef SRC_KERNELS_LISTS_H
#define SRC_KERNELS_LISTS_H

#include "../context.h"
#include "list_cover.h"
#include "list_points.h"

typedef struct shb_list_kernels {
    /* Finds where a group's vertices lie in the world and where the light sees them; adds them to
     * the extent. */
    void (*see)(const shb_list_frame *frame, const shb_mat4 *transform, shb_list_places *places,
                shb_list_vertex vertices[SHB_LIST_GROUP], shb_list_extent *extent);

    /* Prepares triangles, whose corners are at these vertices; names tell vertices apart by their
     * places in the world, NULL: outlines are not wanted. Returns those, one bit each, that have a
     * corner in front of the near plane or too near to the light's own: what is written of them is
     * of no use. */
    uint32_t (*prepare)(const shb_list_frame *frame, const shb_list_vertex *vertices,
                        const uint64_t *names, const uint32_t *const corners[SHB_LIST_LANES],
                        shb_list_triangle triangles[SHB_LIST_LANES],
                        shb_list_box boxes[SHB_LIST_LANES], uint16_t levels[SHB_LIST_LANES],
                        shb_list_outline outlines[SHB_LIST_LANES]);

    /* Puts a tile's triangles into its cells. A triangle goes into a cell unless it misses the cell
     * for sure or begins there behind a triangle before it that covers the cell for sure. False if
     * there is no room for all the entries. */
    bool (*cover)(shb_list_cover *cover);

    /* Finds where the light sees the points, and their cells. Writes the numbers of those that do
     * not lie in the same cell as the one before; returns how many. */
    size_t (*locate)(const shb_list_frame *frame, const shb_list_grid *grid, shb_list_group *group,
                     int32_t changes[SHB_LIST_POINTS + SHB_LIST_LANES]);

    /* Makes runs of spans, behind which is one more for their end, and fetches their entries.
     * Points that their cells put into shadow have visibility 0 and are in no run. Returns how many
     * runs there are. */
    size_t (*start)(const shb_list_group *group, const shb_list_span *spans, size_t count,
                    shb_list_run runs[SHB_LIST_POINTS], float *visibility);

    /* Makes questions of the next SHB_LIST_STEP entries of each run, or as many as are left if
     * these are fewer: one for each that begins at the run's depth or before. There is room for
     * SHB_LIST_STEP of each. Returns how many. */
    size_t (*take)(shb_list_run *runs, size_t count, shb_list_question *questions);

    /* Answers questions by the bounds of rounding; rounding as in shb_list_points, of points whose
     * scale is 1. Nothing is asked of a point about its own triangle. Those that say something are
     * moved to the front; returns how many they are. */
    size_t (*answer)(const shb_list_frame *frame, const shb_list_triangle *triangles,
                     const shb_list_group *group, double rounding, shb_list_question *questions,
                     size_t count);
} shb_list_kernels;

/* Never NULL. */
const shb_list_kernels *shb_list_kernels_of(shb_isa isa);

extern const shb_list_kernels shb_list_kernels_scalar, shb_list_kernels_sse2, shb_list_kernels_avx2,
    shb_list_kernels_avx512, shb_list_kernels_neon;

#endif
