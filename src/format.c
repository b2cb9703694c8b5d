#include "strict.h"

#include "format.h"

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
