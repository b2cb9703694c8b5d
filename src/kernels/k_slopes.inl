/* The slopes of planes that maps keep (slopes.h), of WIDE texels. A step's exponent is moved into
 * place in a float, in the middle of their range. Lengths that slopes are multiplied by make up for
 * that, which slope units of at most 2^-27 leave in the range of floats; one that is not gives NaN
 * or infinity, and no shadow. */

#include "../slopes.h"

#define STEP_FIELD 0x20000000u /* 2^-63 for an exponent of 0 */
#define STEP_SCALE 0x1p63

/* What slopes may be off by, of a step: half of one, and what products and sums of them are rounded
 * by, less than 2^-20 of 2^13 steps. */
#define SLOPE_MORE 0x1p-7f
#define SLOPE_ERROR (0.5f + SLOPE_MORE)

static inline ALWAYS_INLINE vf slope_steps(vu texels) {
    return (vf)((texels << 24 & 0x0f000000u) | STEP_FIELD);
}

static inline ALWAYS_INLINE vf x_mantissas(vu texels) {
    return __builtin_convertvector((vi)texels >> 18, vf);
}

static inline ALWAYS_INLINE vf y_mantissas(vu texels) {
    return __builtin_convertvector((vi)(texels << 14) >> 18, vf);
}

static inline ALWAYS_INLINE vi have_slopes(vu texels) {
    return (vi)(texels != SHB_SLOPES_NONE);
}

/* What steps are multiplied by. */
static inline ALWAYS_INLINE float step_unit(const shb_map *map) {
    return (float)(map->occluders.slope_unit * STEP_SCALE);
}

typedef struct texel_slopes {
    vf x, y, error; /* depth per texel */
} texel_slopes;

static inline ALWAYS_INLINE texel_slopes slopes_of_texels(vu texels, float unit) {
    const vf step = slope_steps(texels) * unit;
    return (texel_slopes){x_mantissas(texels) * step, y_mantissas(texels) * step,
                          SLOPE_ERROR * step};
}
