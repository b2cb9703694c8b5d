/* Stored depth formats. */
#ifndef SRC_FORMAT_H
#define SRC_FORMAT_H

#include "shadowbias/raster.h"

/* The largest stored values; exact in float. */
#define UNORM24_MAX 16777215.0f
#define UNORM16_MAX 65535.0f

/* From one stored depth to the next; 0 for floats. */
static inline float shb_format_step(shb_format format) {
    return format == SHB_FORMAT_UNORM16   ? 1 / UNORM16_MAX
           : format == SHB_FORMAT_UNORM24 ? 1 / UNORM24_MAX
                                          : 0;
}

/* The canonical depth that nothing covers. */
static inline float shb_far_depth(bool reversed) {
    return reversed ? 0.0f : 1.0f;
}

/* Writes count canonical depths as stored texels, which may lie in their place. NaN may become any
 * depth. One for each instruction set. */
typedef void shb_format_store_fn(shb_format format, bool reversed, size_t count,
                                 const float *canonical, void *texels);

/* Reads them again. */
void shb_format_load(shb_format format, bool reversed, size_t count, const void *texels,
                     float *canonical);

#endif
