/* No bias and the constant bias: Williams, Casting curved shadows on curved surfaces, 1978. */
#include "strict.h"

#include "bias_stages.h"

shb_bias shb_bias_none(void) {
    return (shb_bias){.name = "none"};
}

static void depth_units(size_t lanes, float amount, shb_receivers *restrict r) {
    for (size_t i = 0; i < lanes; i++)
        shb_write_flat(r, i, amount);
}

static void texel_units(size_t lanes, float amount, shb_receivers *restrict r) {
    for (size_t i = 0; i < lanes; i++)
        shb_write_flat(r, i, amount * r->texel_size[i] * r->depth_per_world[i]);
}

static void world_units(size_t lanes, float amount, shb_receivers *restrict r) {
    for (size_t i = 0; i < lanes; i++)
        shb_write_flat(r, i, amount * r->depth_per_world[i]);
}

static void constant_depth(const shb_bias_args *args) {
    const size_t lanes = shb_round_to_lanes(args->count);
    const float amount = args->bias->params[0];
    const float unit = args->bias->params[1];
    if (unit == SHB_UNIT_TEXEL)
        texel_units(lanes, amount, args->receivers);
    else if (unit == SHB_UNIT_WORLD)
        world_units(lanes, amount, args->receivers);
    else
        depth_units(lanes, amount, args->receivers);
}

shb_bias shb_bias_constant(float amount, shb_unit unit) {
    const bool scaled = unit == SHB_UNIT_TEXEL || unit == SHB_UNIT_WORLD;
    return (shb_bias){.name = "constant",
                      .depth = constant_depth,
                      .needs = scaled ? SHB_NEEDS_SCALE : 0,
                      .params = {amount, (float)unit}};
}
