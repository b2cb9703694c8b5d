/* What filters of taps need, which follows from their parameters. */
#ifndef SRC_FILTER_NEEDS_H
#define SRC_FILTER_NEEDS_H

#include "shadowbias/filter.h"

static inline uint32_t shb_filter_needs_of(shb_unit unit, shb_taps taps) {
    return (unit == SHB_UNIT_WORLD ? SHB_NEEDS_SCALE : 0u) |
           (taps == SHB_TAPS_NAIVE ? SHB_NEEDS_NORMAL : 0u);
}

#endif
