/* Points, planes and their mutual test in vectors of doubles. */

#include "../exact.h"
#include "../occluders.h"

#undef REAL
#undef REAL_NAME
#undef REAL_SPLAT
#undef REAL_ABS
#undef REAL_WHERE_GREATER
#undef REAL_GREATER_BITS
#define REAL wd
#define REAL_NAME(name) wide_##name
#define REAL_SPLAT(value) wd_splat(value)
#define REAL_ABS(value) wd_abs(value)
#define REAL_WHERE_GREATER(a, b, yes, no) wd_where_greater(a, b, yes, no)
#define REAL_GREATER_BITS(a, b) wd_greater_bits(a, b)
#include "../light_point.inl"

#include "../mutual_planes.inl"
