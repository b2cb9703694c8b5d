/* The slopes of a plane in 32 bits: two mantissas of 14 bits, two's complement, that of x above
 * that of y, and below them the 4 bits of an exponent that both share. Slopes are mantissas times
 * the step 4^exponent. The exponent is the least one for the larger slope, whose mantissa is at
 * most 8191, and 2048 at least unless the exponent is 0. So either slope is off by half a step at
 * most, which is some 2^-14 to 2^-12 of the larger one. */
#ifndef SRC_SLOPES_H
#define SRC_SLOPES_H

#include <stdint.h>
#include <string.h>

/* Of a plane that is too steep. No other one is kept so: mantissas are not both small where the
 * exponent is not 0. */
#define SHB_SLOPES_NONE UINT32_MAX

static inline uint64_t shb_bits_of_double(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Rounds to nearest, ties to even; none where one is NaN. Free of branches, for loops in vectors:
 * - A size's exponent is 12 at most below 8191.5 = 2^13 - 2^-1, up to which it is rounded to 8191.
 *   So 2^-13 of its power of two is added, and of the field, which counts from 1023, two octaves
 *   each are one step, of which those from 2^11 on are the first.
 * - Adding 1.5 * 2^52 leaves no bit for a fraction, and a small whole number in the lowest ones. */
static inline uint32_t shb_slopes_of(double x, double y) {
    const double least = 0x1p11, end = 8191.5 * 0x1p30;
    const double size_x = x < 0 ? -x : x, size_y = y < 0 ? -y : y;
    const double larger = size_x > size_y ? size_x : size_y, size = larger > least ? larger : least;
    const uint64_t field = (shb_bits_of_double(size) + ((uint64_t)1 << 39)) >> 53;
    const uint64_t scale_bits = (2057 - 2 * field) << 52;
    double scale;
    memcpy(&scale, &scale_bits, sizeof scale);
    const uint64_t bits_x = shb_bits_of_double(x * scale + 0x1.8p52) & 0x3fff;
    const uint64_t bits_y = shb_bits_of_double(y * scale + 0x1.8p52) & 0x3fff;
    const uint64_t both = bits_x << 18 | bits_y << 4 | (field - 517);
    const uint64_t some = size_x < end ? both : SHB_SLOPES_NONE;
    return (uint32_t)(size_y < end ? some : SHB_SLOPES_NONE);
}

/* Of what is not none. Exact, as is what follows. */
static inline double shb_slopes_step(uint32_t slopes) {
    return (double)(1 << 2 * (slopes & 15));
}

static inline double shb_slope_x(uint32_t slopes) {
    return (double)((int32_t)slopes >> 18) * shb_slopes_step(slopes);
}

static inline double shb_slope_y(uint32_t slopes) {
    return (double)((int32_t)(slopes << 14) >> 18) * shb_slopes_step(slopes);
}

#endif
