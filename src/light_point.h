/* Points and planes as a light's map sees them, in double, each with a bound of its error.
 *
 * Map coordinates are X, Y in texels from the top left corner and canonical depth Z. With rows T of
 * four numbers, X = Tx(P) / w, Y = Ty(P) / w, Z = Tz(P) / w, w = Tw(P). If P moves by v, X moves by
 * A.v / w' exactly, where A = Tx - X Tw (first three elements) and w' belongs to the moved point;
 * likewise Y by B.v / w' and Z by C.v / w'.
 *
 * Error of a point. Let u = 2^-24, e = 2^-53. The rows count as exact. A fragment's position is the
 * true point P rounded to float, so |v_i| <= u |P_i|. A plane Z = gx X + gy Y + k that holds the
 * true point is therefore missed by the rounded one by no more than
 *     sum_i |C_i - gx A_i - gy B_i| u |P_i| / w'                                              (1)
 * The vectors are calculated at the rounded point instead of the true one, which changes them by
 * (u |P| |Tw| / w) of the same movement: of second order, covered by the factor 1 + 2^-10 + 2 Ew /
 * w with Ew = u sum |Tw_i P_i|, and w' >= w - Ew. Calculating X takes four products, four sums and
 * a division, whose inputs are rounded rows: less than
 *     8 e (sum |Tx_i P_i| + |Tx_3| + |X| (sum |Tw_i P_i| + |Tw_3|)) / w                       (2)
 * and so on.
 *
 * Slopes of the plane through a point with normal n: gx = n.(C x B) / n.(A x B), gy = n.(A x C) /
 * n.(A x B). If the elements of n, A, B and C are off by dn, da, db and dc, the numerator N and the
 * denominator D are off by
 *     dD = dn.|A x B| + da.|B x n| + db.|n x A| + 16 e |A| |B| |n|                             (3)
 * and the like, and N / D by no more than (dN + |N / D| dD) / (|D| - dD); the products of two
 * errors are covered by taking 2 dD from |D|. Plain sums of absolute values stand for lengths. */
#ifndef SRC_LIGHT_POINT_H
#define SRC_LIGHT_POINT_H

#include "map.h"

#include <math.h>

#define SHB_FLOAT_ROUNDING 0x1p-24
#define SHB_DOUBLE_ROUNDING 0x1p-53

/* Of numbers or of vectors of numbers. */
#define SHB_DOT(a, b) (((a)[0] * (b)[0] + (a)[1] * (b)[1]) + (a)[2] * (b)[2])

static inline double shb_dot(const double *a, const double *b) {
    return SHB_DOT(a, b);
}

/* What the arithmetic below is done in; kernels take vectors. */
#define REAL double
#define REAL_NAME(name) shb_##name
#define REAL_SPLAT(value) (value)
#define REAL_ABS(value) fabs(value)
#define REAL_WHERE_GREATER(a, b, yes, no) ((a) > (b) ? (yes) : (no))
#define REAL_GREATER_BITS(a, b) ((uint32_t)((a) > (b)))
#include "light_point.inl"

#endif
