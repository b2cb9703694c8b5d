/* A vector of one double for the loops over fragments: what the operations of all vectors mean. */
#ifndef SRC_KERNELS_DOUBLES_SCALAR_H
#define SRC_KERNELS_DOUBLES_SCALAR_H

#define DOUBLES 1

typedef double wd;

static inline wd wd_splat(double value) {
    return value;
}
static inline wd wd_load_floats(const float *p) {
    return (double)*p;
}
static inline wd wd_load(const double *p) {
    return *p;
}
static inline void wd_store(double *p, wd v) {
    *p = v;
}
static inline void wd_store_floats(float *p, wd v) {
    *p = (float)v;
}
/* Towards zero; what does not fit becomes a number that does not lie in any map. */
static inline int32_t int_of(double v) {
    return v > -0x1p31 && v < 0x1p31 ? (int32_t)v : INT32_MIN;
}
static inline void wd_store_ints(int32_t *p, wd v) {
    *p = int_of(v);
}
/* b if one of them is NaN. */
static inline wd wd_max(wd a, wd b) {
    return a > b ? a : b;
}
static inline wd wd_min(wd a, wd b) {
    return a < b ? a : b;
}
static inline wd wd_sqrt(wd v) {
    return sqrt(v);
}
/* What does not fit an int becomes any number that does not. */
static inline wd wd_floor(wd v) {
    const double truncated = (double)int_of(v);
    return truncated - (truncated > v ? 1.0 : 0.0);
}
static inline wd wd_where_greater(wd a, wd b, wd yes, wd no) {
    return a > b ? yes : no;
}
static inline wd wd_where_equal(wd a, wd b, wd yes, wd no) {
    return a == b ? yes : no;
}
static inline wd wd_abs(wd v) {
    return fabs(v);
}
/* Bit i: lane i of a is greater. */
static inline uint32_t wd_greater_bits(wd a, wd b) {
    return a > b;
}
/* The sign bit is set in some lane. */
static inline bool wd_any_signed(wd v) {
    return signbit(v) != 0;
}
/* Four doubles from each place on, the first ones into out[0] and so on. */
static inline void wd_read_quads(const double *const from[DOUBLES], wd out[4]) {
    for (int k = 0; k < 4; k++)
        out[k] = from[0][k];
}
/* Each double holds the bytes of two floats, or of a float and a word. */
static inline void wd_store_pairs(float *first, void *second, wd v) {
    memcpy(first, &v, sizeof *first);
    memcpy(second, (const char *)&v + sizeof *first, sizeof *first);
}
/* a, b, c, d of lane i go to to + i * step. */
static inline void wd_store_quads(double *to, size_t step, wd a, wd b, wd c, wd d) {
    (void)step;
    to[0] = a;
    to[1] = b;
    to[2] = c;
    to[3] = d;
}

#endif
