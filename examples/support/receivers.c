#include "receivers.h"

static void keep_batch(const shb_filter_args *args) {
    shb_receivers *const *kept = args->filter->user;
    **kept = *args->receivers;
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = 1;
}

shb_result receivers_look(const shb_map *map, const shb_points *points, const shb_bias *bias,
                          shb_receivers *receivers) {
    SHB_ALIGN float visibility[SHB_BATCH];
    const shb_filter keep = {.name = "keep", .filter = keep_batch, .user = &receivers};
    shb_bias curious = *bias;
    if (points->count > SHB_BATCH)
        return SHB_ERROR_SIZE;
    curious.needs |= SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE;
    return shb_map_visibility(map, points, &curious, &keep, visibility);
}
