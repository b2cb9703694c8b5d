/* The value of the exact method: the work is done by the map, see exact.c. */
#include "shadowbias/bias.h"

shb_bias shb_bias_exact(void) {
    return (shb_bias){.name = "exact", .needs = SHB_NEEDS_OCCLUDERS};
}
