/* IEEE half floats: 10 bits of mantissa, exponents -14 .. 15, subnormals, infinity. */
#ifndef SRC_HALF_H
#define SRC_HALF_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Rounding moves a number by at most SHB_HALF_RELATIVE of it, or SHB_HALF_ABSOLUTE. */
#define SHB_HALF_RELATIVE 0x1p-11
#define SHB_HALF_ABSOLUTE 0x1p-25

#define SHB_HALF_INFINITY 0x7c00u

/* Rounds to nearest, ties to even; NaN becomes infinity. Adding 1.5 * 2^52 leaves no bit for a
 * fraction. */
static inline uint16_t shb_half_of(double value) {
    const double size = value < 0 ? -value : value;
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint16_t sign = (uint16_t)(bits >> 63 << 15);
    if (!(size < 65520.0))
        return (uint16_t)(sign | SHB_HALF_INFINITY);
    if (size < 0x1p-14) {
        const double steps = (size * 0x1p24 + 0x1.8p52) - 0x1.8p52;
        return (uint16_t)(sign | (uint16_t)steps);
    }
    memcpy(&bits, &size, sizeof bits);
    bits += 0x1ffffffffffu + (bits >> 42 & 1);
    return (uint16_t)(sign | (uint16_t)((bits >> 42) - ((uint64_t)(1023 - 15) << 10)));
}

/* Two of them, x in the lower one; both are infinite where one is. */
static inline uint32_t shb_halves_of(double x, double y) {
    const uint32_t low = shb_half_of(x), high = shb_half_of(y);
    const bool infinite = (low & SHB_HALF_INFINITY) == SHB_HALF_INFINITY ||
                          (high & SHB_HALF_INFINITY) == SHB_HALF_INFINITY;
    return infinite ? SHB_HALF_INFINITY | SHB_HALF_INFINITY << 16 : low | high << 16;
}

/* Exact. The exponent field counts from 15, that of a float from 127. */
static inline float shb_half_to_float(uint16_t half) {
    const uint32_t magnitude = (uint32_t)(half & 0x7fff) << 13;
    float value;
    memcpy(&value, &magnitude, sizeof value);
    value *= 0x1p112f;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits |= (uint32_t)(half & 0x8000) << 16;
    bits |= magnitude >= SHB_HALF_INFINITY << 13 ? 0x7f800000u : 0;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
