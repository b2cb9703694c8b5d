/* Decimal text to float: correctly rounded, and fast for the numbers that files are full of. */
#ifndef EXAMPLES_DECIMAL_H
#define EXAMPLES_DECIMAL_H

#include <stdbool.h>

/* Reads [+-]digits[.digits][(e|E)[+-]digits] at *text, at least one digit before the exponent, and
 * moves *text behind it. The text must end with a NUL byte somewhere. A number beyond the range of
 * float gives infinity. False, and *text unmoved, when there is no number. */
bool decimal_read_float(const char **text, float *value);

#endif
