/* IEEE half floats: 10 bits of mantissa, exponents -14 .. 15, subnormals, infinity. */
#ifndef SRC_HALF_H
#define SRC_HALF_H

#include <stdint.h>
#include <string.h>

/* Rounding moves a number by at most SHB_HALF_RELATIVE of it, or SHB_HALF_ABSOLUTE. */
#define SHB_HALF_RELATIVE 0x1p-11
#define SHB_HALF_ABSOLUTE 0x1p-25

#define SHB_HALF_INFINITY 0x7c00u

static inline uint64_t shb_bits_of_double(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Rounds to nearest, ties to even; NaN becomes infinity. Adding 1.5 * 2^52 leaves no bit for a
 * fraction, and a small whole number in the lowest ones. Free of branches, for loops in vectors. */
static inline uint64_t shb_half_bits(double value) {
    const double size = value < 0 ? -value : value;
    const uint64_t sign = shb_bits_of_double(value) >> 63 << 15, bits = shb_bits_of_double(size);
    const uint64_t steps = shb_bits_of_double(size * 0x1p24 + 0x1.8p52) & 0xffff;
    const uint64_t rounded = (bits + 0x1ffffffffffu + (bits >> 42 & 1)) >> 42;
    const uint64_t finite = size < 0x1p-14 ? steps : rounded - ((uint64_t)(1023 - 15) << 10);
    return sign | (size < 65520.0 ? finite : SHB_HALF_INFINITY);
}

static inline uint16_t shb_half_of(double value) {
    return (uint16_t)shb_half_bits(value);
}

/* Two of them, x in the lower one; both are infinite where one is. */
static inline uint32_t shb_halves_of(double x, double y) {
    const double size_x = x < 0 ? -x : x, size_y = y < 0 ? -y : y;
    const uint64_t both = shb_half_bits(x) | shb_half_bits(y) << 16;
    const uint64_t infinite = SHB_HALF_INFINITY | SHB_HALF_INFINITY << 16;
    const uint64_t some = size_x < 65520.0 ? both : infinite;
    return (uint32_t)(size_y < 65520.0 ? some : infinite);
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
