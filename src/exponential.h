/* Exponentials and logarithms without libm: the same bits everywhere. */
#ifndef SRC_EXPONENTIAL_H
#define SRC_EXPONENTIAL_H

#include <stdint.h>
#include <string.h>

/* Larger arguments of either sign leave the range of normal floats. */
#define SHB_EXPONENTIAL_LIMIT 87.0f

/* e^x for |x| <= SHB_EXPONENTIAL_LIMIT, within 2^-22 of its size.
 *
 * x = n ln 2 + r with |r| <= 0.3466, and e^r by its series up to r^7 / 7!, which leaves
 * r^8 / 8! < 2^-27. n has 7 bits and the first part of ln 2 has 15, so their product is exact; n r
 * off by rounding is 2^-25 at most. The sum's last steps add 1.5 * 2^-24. 1.5 * 2^23 leaves no bit
 * for a fraction. */
static inline float shb_exponential(float x) {
    const float to_integer = 0x1.8p23f;
    const float n = (x * 1.44269504f + to_integer) - to_integer;
    const float r = (x - n * 0x1.62e4p-1f) - n * 0x1.7f7d1cp-20f;
    float sum = 1.0f / 5040;
    sum = sum * r + 1.0f / 720;
    sum = sum * r + 1.0f / 120;
    sum = sum * r + 1.0f / 24;
    sum = sum * r + 1.0f / 6;
    sum = sum * r + 0.5f;
    sum = sum * r + 1;
    sum = sum * r + 1;
    const uint32_t bits = (uint32_t)((int32_t)n + 127) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return sum * power;
}

/* ln x for normal floats above 0, within 2^-22 of the larger of its size and 1.
 *
 * x = 2^n m with m from 1 / sqrt 2 to sqrt 2, and ln m = 2 (s + s^3 / 3 + s^5 / 5 + s^7 / 7) for
 * s = (m - 1) / (m + 1), |s| <= 0.1716, which leaves 2 s^9 / 9 < 2^-24. */
static inline float shb_logarithm(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const uint32_t half_root = 0x3f3504f3; /* 1 / sqrt 2 */
    const int32_t n = (int32_t)(bits - half_root) >> 23;
    bits -= (uint32_t)n << 23;
    float m;
    memcpy(&m, &bits, sizeof m);
    const float s = (m - 1) / (m + 1), s2 = s * s;
    const float series = ((1.0f / 7 * s2 + 1.0f / 5) * s2 + 1.0f / 3) * s2 + 1;
    return 2 * s * series + (float)n * 0.693147181f;
}

#endif
