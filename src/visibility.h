/* The path from a batch of fragments to visibility, shared by everything that asks a map. */
#ifndef SRC_VISIBILITY_H
#define SRC_VISIBILITY_H

#include "map.h"
#include "next_batch.h"
#include "quick_test.h"

/* Checks that the map can answer the method and the filter; has_normals: the fragments come with
 * normals. Failures are logged in the name of caller. */
shb_result shb_visibility_check(const shb_map *map, const char *caller, const shb_bias *bias,
                                const shb_filter *filter, bool has_normals);

/* Checks positions and strides of a host's points, in the name of caller. */
shb_result shb_points_check(const shb_context *context, const char *caller,
                            const shb_points *points);

bool shb_visibility_needs_normals(const shb_map *map, const shb_bias *bias,
                                  const shb_filter *filter);

/* True if the quick test may answer the method by the filter, NULL: hard; quick receives how. */
bool shb_is_asked_quickly(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                          shb_quick_bias *quick);

typedef struct shb_asked_batch {
    size_t count;
    bool lifted;                  /* the positions were moved off their surface */
    const shb_own_triangles *own; /* of the batch, or NULL */
    const shb_next_batch *next;   /* what is asked for meanwhile, or NULL */
} shb_asked_batch;

/* One batch that passed the check. points: arrays of positions and, if the method needs them,
 * normals of either side, up to the count rounded up to whole vectors. receivers: room to work in,
 * which may hold these arrays. test: of the batch before, by the same map and method, or not known.
 */
void shb_visibility_batch(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                          const shb_asked_batch *batch, const shb_quick_points *points,
                          shb_quick_test *test, shb_receivers *receivers, float *visibility);

/* The same without the quick test, of points that the receivers hold. */
void shb_visibility_in_full(const shb_map *map, const shb_bias *bias, const shb_filter *filter,
                            const shb_asked_batch *batch, shb_receivers *receivers,
                            float *visibility);

#endif
