#include "decimal.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* mantissa * 10^exponent; exact unless digits did not fit. */
typedef struct decimal {
    uint64_t mantissa;
    int exponent;
    bool negative, exact;
} decimal;

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Returns the end of the digits; those after the point lower the exponent. */
static const char *read_digits(const char *at, int weight, decimal *number) {
    for (; is_digit(*at); at++) {
        if (number->mantissa > (UINT64_MAX - 9) / 10) {
            number->exact = false;
            continue;
        }
        number->mantissa = 10 * number->mantissa + (uint64_t)(*at - '0');
        number->exponent -= weight;
    }
    return at;
}

/* Returns the end of the exponent, or NULL when the letter has no digits after it. */
static const char *read_exponent(const char *at, decimal *number) {
    if (*at != 'e' && *at != 'E')
        return at;
    at++;
    const bool negative = *at == '-';
    if (*at == '-' || *at == '+')
        at++;
    if (!is_digit(*at))
        return NULL;
    int exponent = 0;
    for (; is_digit(*at); at++)
        if (exponent < 100000)
            exponent = 10 * exponent + (*at - '0');
    number->exponent += negative ? -exponent : exponent;
    return at;
}

/* The powers that double holds exactly. */
static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* With mantissa and power exact, one multiplication or division gives the double nearest to the
 * number. Rounding that to float is right too, unless the double lies half-way between two floats,
 * where the number itself may lie on either side. (1e-22 is far from the subnormal floats.) */
static bool convert_exactly(const decimal *number, float *value) {
    if (!number->exact || number->mantissa > 1ull << 53 || number->exponent < -22 ||
        number->exponent > 22)
        return false;
    const double mantissa = (double)number->mantissa;
    const double magnitude = number->exponent < 0 ? mantissa / powers[-number->exponent]
                                                  : mantissa * powers[number->exponent];
    uint64_t bits;
    memcpy(&bits, &magnitude, sizeof bits);
    const bool halfway = (bits & 0x1fffffff) == 0x10000000;
    if (halfway)
        return false;
    *value = (float)(number->negative ? -magnitude : magnitude);
    return true;
}

bool decimal_read_float(const char **text, float *value) {
    const char *at = *text;
    decimal number = {.negative = *at == '-', .exact = true};
    if (*at == '-' || *at == '+')
        at++;
    const char *digits = at;
    at = read_digits(at, 0, &number);
    size_t digit_count = (size_t)(at - digits);
    if (*at == '.') {
        digits = ++at;
        at = read_digits(at, 1, &number);
        digit_count += (size_t)(at - digits);
    }
    if (!digit_count || !(at = read_exponent(at, &number)))
        return false;
    if (!convert_exactly(&number, value))
        *value = strtof(*text, NULL);
    *text = at;
    return true;
}
