/* One tap: Williams, Casting curved shadows on curved surfaces, 1978. */
#include "strict.h"

#include "format.h"
#include "project.h"

/* A NaN on either side compares as lit. */
static void compare(size_t lanes, float far_depth, const float *restrict stored,
                    const float *restrict ref, float *restrict visibility) {
    for (size_t i = 0; i < lanes; i++) {
        const int shadowed = (stored[i] < ref[i]) & (stored[i] < far_depth);
        visibility[i] = shadowed ? 0.0f : 1.0f;
    }
}

static void hard(const shb_filter_args *args) {
    const shb_receivers *receivers = args->receivers;
    const size_t lanes = shb_round_to_lanes(args->count);
    SHB_ALIGN float stored[SHB_BATCH];
    shb_map_fetch(args->map, lanes, receivers->texel_x, receivers->texel_y, stored);
    compare(lanes, shb_far_depth(args->info->view.reversed), stored, receivers->ref,
            args->visibility);
}

shb_filter shb_filter_hard(void) {
    return (shb_filter){.name = "hard", .filter = hard};
}
