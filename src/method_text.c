#include "strict.h"

#include "method_text.h"

#include <float.h>
#include <string.h>

const char *shb_method_name(const char *name) {
    return name ? name : "unnamed";
}

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

static size_t name_length(const char *text) {
    return strcspn(text, ":");
}

bool shb_text_has_name(const char *text, const char *name) {
    const size_t length = name_length(text);
    return strlen(name) == length && memcmp(text, name, length) == 0;
}

/* A decimal number without its sign and exponent: digits * 10^exponent. */
typedef struct decimal {
    double digits;
    int exponent;
} decimal;

/* Exponents beyond this give 0 or infinity whatever the digits that fit in memory. */
#define EXPONENT_LIMIT 100000

/* Reads "12", "12.5", ".5" or "12."; NULL without a digit. */
static const char *read_digits(const char *text, decimal *out) {
    *out = (decimal){0, 0};
    size_t count = 0;
    bool after_point = false;
    for (; is_digit(*text) || (*text == '.' && !after_point); text++) {
        if (*text == '.') {
            after_point = true;
            continue;
        }
        out->digits = out->digits * 10 + (*text - '0');
        out->exponent -= after_point;
        count++;
    }
    return count ? text : NULL;
}

/* Reads an optional "e5", "E+5" or "e-5"; NULL without a digit. */
static const char *read_exponent(const char *text, int *exponent) {
    *exponent = 0;
    if (*text != 'e' && *text != 'E')
        return text;
    text++;
    const bool negative = *text == '-';
    text += *text == '-' || *text == '+';
    if (!is_digit(*text))
        return NULL;
    for (; is_digit(*text); text++)
        if (*exponent < EXPONENT_LIMIT)
            *exponent = *exponent * 10 + (*text - '0');
    if (negative)
        *exponent = -*exponent;
    return text;
}

/* Powers up to 10^22 are exact, so that numbers of up to 15 digits are rounded once. */
static double scaled(double digits, int exponent) {
    double power = 1;
    for (int i = exponent < 0 ? -exponent : exponent; i > 0 && power <= DBL_MAX; i--)
        power *= 10;
    return digits == 0 ? 0 : exponent < 0 ? digits / power : digits * power;
}

/* Numbers from here on round to infinity. */
#define FLOAT_LIMIT 0x1.ffffffp127

/* The C library's conversion follows the locale of the host; this one does not. */
static const char *read_float(const char *text, float *out) {
    const bool negative = *text == '-';
    text += *text == '-' || *text == '+';
    decimal number;
    int exponent;
    text = read_digits(text, &number);
    if (text)
        text = read_exponent(text, &exponent);
    if (!text)
        return NULL;
    const double value = scaled(number.digits, number.exponent + exponent);
    if (!(value < FLOAT_LIMIT))
        return NULL;
    *out = (float)(negative ? -value : value);
    return text;
}

/* Reads "param=value". */
static const char *read_param(const char *text, const char *const *names, float *params) {
    const size_t length = strcspn(text, "=");
    if (text[length] != '=')
        return NULL;
    for (int i = 0; i < SHB_PARAMS_MAX && names[i]; i++)
        if (strlen(names[i]) == length && memcmp(text, names[i], length) == 0)
            return read_float(text + length + 1, &params[i]);
    return NULL;
}

bool shb_text_read_params(const char *text, const char *const names[SHB_PARAMS_MAX],
                          float params[SHB_PARAMS_MAX]) {
    text += name_length(text);
    while (*text) {
        text = read_param(text + 1, names, params);
        if (!text || (*text && *text != ','))
            return false;
    }
    return true;
}
