/* Stored depth formats. */
#ifndef SRC_FORMAT_H
#define SRC_FORMAT_H

#include "shadowbias/raster.h"

/* The canonical depth that nothing covers. */
static inline float shb_far_depth(bool reversed) {
    return reversed ? 0.0f : 1.0f;
}

/* Writes a row of canonical depths as stored texels. */
void shb_format_store(shb_format format, bool reversed, size_t count, const float *canonical,
                      void *texels);

/* Reads such a row again. */
void shb_format_load(shb_format format, bool reversed, size_t count, const void *texels,
                     float *canonical);

#endif
