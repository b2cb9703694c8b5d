/* What drawing promises of one triangle, calculated slowly and in another way: per sample, without
 * boxes, tiles, biases or shifts, and with 113 bits where the library has 53. */
#ifndef TESTS_SUPPORT_ORACLE_H
#define TESTS_SUPPORT_ORACLE_H

#include "shadowbias/raster.h"

#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 oracle_real;
#else
typedef long double oracle_real;
#endif

static inline oracle_real oracle_exact(double v) {
    return (oracle_real)v;
}

/* Rounded to float. gcc 12 drops both conversions where it makes a vector of two numbers that go
 * to float and back: (double)(float)v is v there. */
static inline double oracle_float(double v) {
    volatile float rounded = (float)v;
    return (double)rounded;
}

typedef struct oracle_triangle {
    uint32_t width, height;
    bool is_finite;
    bool needs_clipping;     /* X, Y, Z and the snapped corners are undefined then */
    double clip[3][4];       /* canonical: z negated for a reversed view */
    double X[3], Y[3], Z[3]; /* window, canonical depth */
    int64_t snapped_x[3], snapped_y[3];
    oracle_real opposite[3][3]; /* cross product of the other two corners' (x, y, w) */
} oracle_triangle;

/* corners: three times x, y, z in world units. */
oracle_triangle oracle_project(const shb_view *view, uint32_t width, uint32_t height,
                               const float corners[9]);

/* The top-left rule by its meaning: the sample, moved right by an infinitely small distance and
 * down by its square, lies strictly inside the snapped triangle. */
bool oracle_covers(const oracle_triangle *triangle, int column, int row);

/* The winding number of a polygon of snapped corners about the sample, positive clockwise with y
 * down: how many triangles of the fan about its first corner contain the sample, by their signs. */
int oracle_winding(size_t count, const int64_t *x, const int64_t *y, int column, int row);

/* Nearest even. */
int64_t oracle_snap(double pixels);

/* The plane through the unsnapped triangle at the sample. */
oracle_real oracle_depth(const oracle_triangle *triangle, int column, int row);

/* The same by the ray through the sample and the plane in clip space, for clipped triangles. */
oracle_real oracle_clip_depth(const oracle_triangle *triangle, int column, int row);

/* How many pixels the sample lies inside the triangle as the eye sees it (negative: outside), by
 * the edges' planes in clip space; exact for triangles that reach behind the eye too. Infinite
 * edges count as far away. */
double oracle_clip_inside(const oracle_triangle *triangle, int column, int row);

/* The canonical depth that the library promises to store, bit by bit; not for clipped triangles. */
float oracle_stored(const oracle_triangle *triangle, int column, int row);

/* True if that depth is evaluated in float and within 5 * 2^-24 of the plane, else it is clamped to
 * the range of the corners. */
bool oracle_is_plain(const oracle_triangle *triangle);

#endif
