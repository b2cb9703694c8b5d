/* The table of all methods, and their text form. */
#include "strict.h"

#include "method_text.h"
#include "shadowbias/bias.h"

static shb_bias make_constant(void) {
    return shb_bias_constant(0.002f, SHB_UNIT_DEPTH);
}

static shb_bias make_slope(void) {
    return shb_bias_slope(1.1f, 4, 0);
}

static shb_bias make_angle(void) {
    return shb_bias_angle(0.001f, 0.01f);
}

static shb_bias make_normal_offset(void) {
    return shb_bias_normal_offset(1.5f, 1e-5f);
}

static shb_bias make_receiver_plane(void) {
    return shb_bias_receiver_plane(1e-5f);
}

static shb_bias make_dual_layer(void) {
    return shb_bias_dual_layer(0.01f);
}

static shb_bias make_adaptive(void) {
    return shb_bias_adaptive(1e-4f, 0);
}

static shb_bias make_adaptive_soft(void) {
    return shb_bias_adaptive_soft(1e-4f, 0, 100);
}

static const shb_bias_method methods[] = {
    {"none", "no bias", shb_bias_none, {NULL}},
    {"constant", "constant bias in a declared unit", make_constant, {"amount", "unit"}},
    {"slope", "slope-scaled bias, as polygon offset", make_slope, {"factor", "units", "clamp"}},
    {"angle", "bias by the angle between normal and light", make_angle, {"base", "limit"}},
    {"normal-offset", "offset along the normal", make_normal_offset, {"texels", "depth"}},
    {"receiver-plane", "plane of the receiver", make_receiver_plane, {"epsilon"}},
    {"texel-cone", "offset by the cone of a texel", shb_bias_texel_cone, {NULL}},
    {"midpoint", "mean of the two nearest layers", shb_bias_midpoint, {NULL}},
    {"dual-layer", "bounded mean of the two nearest layers", make_dual_layer, {"offset"}},
    {"back-face", "map of back faces", shb_bias_back_face, {NULL}},
    {"adaptive", "potential occluder and adaptive epsilon", make_adaptive, {"k", "scale"}},
    {"adaptive-soft",
     "adaptive with epsilon by the angle",
     make_adaptive_soft,
     {"k", "scale", "threshold"}},
    {"exact", "planes, triangles or lists of the occluders", shb_bias_exact, {NULL}},
};

const shb_bias_method *shb_bias_methods(size_t *count) {
    if (count)
        *count = sizeof methods / sizeof *methods;
    return methods;
}

/* What a constant bias needs follows from its unit. False for an unknown one. */
static bool rebuild_constant(shb_bias *bias) {
    const float unit = bias->params[1];
    if (unit != SHB_UNIT_DEPTH && unit != SHB_UNIT_TEXEL && unit != SHB_UNIT_WORLD)
        return false;
    *bias = shb_bias_constant(bias->params[0], (shb_unit)unit);
    return true;
}

shb_result shb_bias_parse(const char *text, shb_bias *bias) {
    if (!text || !bias)
        return SHB_ERROR_ARGUMENT;
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        const shb_bias_method *method = &methods[i];
        if (!shb_text_has_name(text, method->name))
            continue;
        shb_bias read = method->make();
        if (!shb_text_read_params(text, method->param_names, read.params))
            return SHB_ERROR_ARGUMENT;
        if (method->make == make_constant && !rebuild_constant(&read))
            return SHB_ERROR_ARGUMENT;
        *bias = read;
        return SHB_OK;
    }
    return SHB_ERROR_ARGUMENT;
}
