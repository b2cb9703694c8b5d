#include "strict.h"

#include "format.h"

#include <math.h>

size_t shb_format_size(shb_format format) {
    switch (format) {
    case SHB_FORMAT_FLOAT32:
    case SHB_FORMAT_UNORM24:
        return 4;
    case SHB_FORMAT_UNORM16:
        return 2;
    }
    return 0;
}

/* 0 - z, not -z: the far depth of a reversed map is +0. */
static float stored_depth(float canonical, bool reversed) {
    return reversed ? 0.0f - canonical : canonical;
}

/* Away from the viewer. The product is exact: 24 bits times at most 24 bits. */
static uint32_t quantize(float canonical, bool reversed, float largest) {
    const double max = (double)largest;
    const double scaled = (double)stored_depth(canonical, reversed) * max;
    const double rounded = reversed ? floor(scaled) : ceil(scaled);
    return (uint32_t)(rounded < 0 ? 0 : rounded > max ? max : rounded);
}

void shb_format_store(shb_format format, bool reversed, size_t count, const float *canonical,
                      void *texels) {
    float *floats = texels;
    uint32_t *unorm24 = texels;
    uint16_t *unorm16 = texels;
    switch (format) {
    case SHB_FORMAT_FLOAT32:
        for (size_t i = 0; i < count; i++)
            floats[i] = stored_depth(canonical[i], reversed);
        break;
    case SHB_FORMAT_UNORM24:
        for (size_t i = 0; i < count; i++)
            unorm24[i] = quantize(canonical[i], reversed, UNORM24_MAX);
        break;
    case SHB_FORMAT_UNORM16:
        for (size_t i = 0; i < count; i++)
            unorm16[i] = (uint16_t)quantize(canonical[i], reversed, UNORM16_MAX);
        break;
    }
}

void shb_format_load(shb_format format, bool reversed, size_t count, const void *texels,
                     float *canonical) {
    const float sign = reversed ? -1.0f : 1.0f;
    const float *floats = texels;
    const uint32_t *unorm24 = texels;
    const uint16_t *unorm16 = texels;
    switch (format) {
    case SHB_FORMAT_FLOAT32:
        for (size_t i = 0; i < count; i++)
            canonical[i] = sign * floats[i];
        break;
    case SHB_FORMAT_UNORM24:
        for (size_t i = 0; i < count; i++)
            canonical[i] = sign * ((float)unorm24[i] / UNORM24_MAX);
        break;
    case SHB_FORMAT_UNORM16:
        for (size_t i = 0; i < count; i++)
            canonical[i] = sign * ((float)unorm16[i] / UNORM16_MAX);
        break;
    }
}
