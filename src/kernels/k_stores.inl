/* Canonical depths to texels. */

typedef uint16_t vh __attribute__((vector_size(2 * WIDE)));

/* Away from the viewer: the depth z becomes z * largest rounded up, or down in a reversed map. That
 * is whole + (rest - z), where whole + rest is z * (largest + 1) and everything is exact in float;
 * rest - z lies between -1 and 1, and is -1 only for z = 1. */
static inline ALWAYS_INLINE vi quantize(vf stored, bool reversed, float largest) {
    const vf z = vf_min(vf_max(stored, vf_splat(0)), vf_splat(1));
    const vf scaled = z * (largest + 1);
    const vi whole = __builtin_convertvector(scaled, vi);
    const vf rest = scaled - __builtin_convertvector(whole, vf);
    const vi rounded = reversed ? whole + (rest < z) : whole - (rest > z);
    return rounded + (rounded > (int32_t)largest);
}

static inline ALWAYS_INLINE void store_lanes(shb_format format, bool reversed, vf canonical,
                                             void *texels) {
    /* 0 - z, not -z: the far depth of a reversed map is +0. */
    const vf stored = reversed ? 0.0f - canonical : canonical;
    if (format == SHB_FORMAT_FLOAT32)
        memcpy(texels, &stored, sizeof stored);
    if (format == SHB_FORMAT_UNORM24) {
        const vi unorm = quantize(stored, reversed, UNORM24_MAX);
        memcpy(texels, &unorm, sizeof unorm);
    }
    if (format == SHB_FORMAT_UNORM16) {
        const vh unorm = __builtin_convertvector(quantize(stored, reversed, UNORM16_MAX), vh);
        memcpy(texels, &unorm, sizeof unorm);
    }
}

static inline ALWAYS_INLINE void store_as(shb_format format, size_t texel_size, bool reversed,
                                          size_t count, const float *canonical, char *texels) {
    size_t i = 0;
    for (; i + WIDE <= count; i += WIDE)
        store_lanes(format, reversed, vf_load(canonical + i), texels + i * texel_size);
    if (i < count) {
        float last[WIDE] = {0};
        char stored[sizeof last];
        memcpy(last, canonical + i, (count - i) * sizeof *last);
        store_lanes(format, reversed, vf_load(last), stored);
        memcpy(texels + i * texel_size, stored, (count - i) * texel_size);
    }
}

static void store_texels(shb_format format, bool reversed, size_t count, const float *canonical,
                         void *texels) {
    switch (format) {
    case SHB_FORMAT_FLOAT32:
        store_as(SHB_FORMAT_FLOAT32, 4, reversed, count, canonical, texels);
        break;
    case SHB_FORMAT_UNORM24:
        store_as(SHB_FORMAT_UNORM24, 4, reversed, count, canonical, texels);
        break;
    case SHB_FORMAT_UNORM16:
        store_as(SHB_FORMAT_UNORM16, 2, reversed, count, canonical, texels);
        break;
    }
}
