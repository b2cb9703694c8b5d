/* What is sure of the test of mutual planes (mutual_planes.inl, with the errors of light_point.h)
 * before it is done in double, for a fragment whose texel lies in the map and holds an occluder.
 *
 * Let u = 2^-24, e = 2^-53, |v| the sum of the absolute values of a vector's elements, P and n the
 * fragment's position and normal, nu = |n| + 2^-30, p = |P|, and X, Y, Z, W the first three
 * elements of the rows, X and Y counted from the map's middle, so that texel coordinates x, y are
 * no larger than half the map. A = X - x W, B = Y - y W, C = Z - z W. With
 *     s_x = |X| + |W| width / 2,  s_y = |Y| + |W| height / 2,  s_z = |Z| + |W|
 * |A| <= s_x, |B| <= s_y, |C| <= s_z (1 + |d|), as stored depths are at most 1 and
 *     d = z - stored,  t_x, t_y: the way to the texel's centre, at most 1/2.
 * All vectors' products are divided by s_x s_y, which leaves |A x B| <= 1, |C x B| <= g_x (1 + |d|)
 * and |A x C| <= g_y (1 + |d|), g_x = s_z / s_x and g_y = s_z / s_y.
 *
 * The own plane. Its slopes are N_x / D and N_y / D with D = |n.(A x B)| and the numerators n.(C x
 * B), n.(A x C), signs changed with that of n.(A x B). It passes behind what is stored by T / D, T
 * = D d + N_x t_x + N_y t_y. x, y, z and d come from double, so T in float is off by little: a dot
 * is within 4 u nu of the elements' bound, with coordinates 10 u nu (their rounding and that of the
 * middle's subtraction, 3 u, products and sums, 3 u). N_x t_x, N_y t_y and their sums' roundings
 * make that 9.1 u or 15.1 u of nu (g_x + g_y) (1 + |d|) / 2, and D d 12.1 u nu |d|. So T is within
 *     E = nu (error + (14 u + error) |d|),  error = (4.7 or 7.7) u (g_x + g_y).
 *
 * Surely lit. The normal C - gx A - gy B of the plane is n times det(A, B, C) / n.(A x B), and
 * det(A, B, C) = det / w with the determinant of the four rows. So (1) of light_point.h is at least
 *     R / D,  R = u |det| sum |n_i P_i| / w^2,
 * and what slopes are calculated wrong is in the test's bound by more than it matters here, and in
 * the 2^-10 of its factor. T + E < R: lit. Rounding can only make R smaller here; its factors are
 * cut off before they overflow.
 *
 * Surely shadowed, which is asked where |d| < 2 only, so that |C| <= 3 s_z and |z| <= 3. Let
 *     psi = (3 p + beta) / w,  beta the largest of (|X_3'| + width |W_3|) / s_x, the like for y,
 *           (|Z_3| + 3 |W_3|) / s_z,  X' counted from the corner.
 * Then errors (2) are at most 8 e s psi with s_x, s_y and s_z; A.v is at most .34 u s_x psi for the
 * v of (1), and so on; and P moves w by no more than .34 u |W| psi / w. While
 *     psi < 2^-3 / (u s_x), 2^-3 / (u s_y), 2^-7 / (u |W|)
 * the first is less than 1/20 texel, and the last makes the factor of (1) at most 1.01. The errors
 * (3) are, with dn = 2^-22 and |n x A| <= s_x nu,
 *     dD <= dn + nu (.7 u psi |W| + 40 e)
 *     dN_x + dN_y <= (g_x + g_y) (3 dn + nu (1.4 u psi |W| + 100 e)).
 * While D > 2^12 dD (and 2^-12 nu, so that it is known well), a slope times D is off by no more
 * than 1.001 (dN_x + 2^-12 |N_x|), and that counts by less than 1.5: twice 1/2 texel, and what the
 * point moves, twice. With what snapping may turn, S (D |turn|) <= S (|N_x| + |N_y| + D |slopes of
 * the texel|), the test's bound times D is at most
 *     U = 1.54 (g_x + g_y) (3 dn + nu (1.4 u psi |W| + 100 e)) + (2^-11 + S) (|N_x| + |N_y|)
 *         + nu psi (1.04 u |det| / (3 w) + 8 e s_z) + S D |slopes| + 2^-46 nu,
 * the last for sums of a few numbers in double. T - E > U: its first half says shadowed. T is taken
 * from T + error nu - R, which is less than T + error nu.
 *
 * The occluder's plane passes in front of the fragment by d + s_x t_x + s_y t_y with the texel's
 * slopes, and the test's bound is at least half a step of theirs by |t_x| + |t_y|, at most that and
 *     V = u psi (1.04 s_z + .36 max(s_x, s_y) |slopes|).
 * In float, it is within 2^-22 (|d| + |s_x t_x| + |s_y t_y|), and slopes are less than 2^13 steps:
 * 2^-9 of a step by |t_x| + |t_y| and, with the bound's own rounding, no more than 2^-7. */
#include "strict.h"

#include "quick_planes.h"

#include "exact.h"

#include <math.h>

#define U SHB_FLOAT_ROUNDING
#define E SHB_DOUBLE_ROUNDING

/* Half the exponent that numbers may have. */
#define RANGE 0x1p40

/* Where nothing overflows and nothing that matters underflows. */
static bool in_range(double value) {
    return value > 1 / RANGE && value < RANGE;
}

static void write_cross(const double *a, const double *b, double scale, float to[3]) {
    double product[3];
    shb_cross(a, b, product);
    for (int i = 0; i < 3; i++)
        to[i] = (float)(product[i] * scale);
}

/* |det| of four rows, and what it may be off by. */
static double determinant(const double *const rows[4], double *error) {
    double sum = 0, sizes = 0;
    for (int k = 0; k < 4; k++) {
        const double *a = rows[(k + 1) % 4], *b = rows[(k + 2) % 4], *c = rows[(k + 3) % 4];
        double ab[3];
        shb_cross(a, b, ab);
        sum += (k % 2 ? rows[k][3] : -rows[k][3]) * shb_dot(ab, c);
        sizes += fabs(rows[k][3]) * (shb_sum_abs(a) * shb_sum_abs(b) * shb_sum_abs(c));
    }
    *error = 32 * E * sizes;
    return fabs(sum);
}

shb_quick_planes shb_quick_planes_of(const shb_map *map) {
    const double *from_left = map->rows.x, *from_top = map->rows.y;
    const double *z = map->rows.z, *w = map->rows.w;
    const double width = map->info.width, height = map->info.height;
    const double unit = map->occluders.slope_unit;
    double x[4], y[4], det_error;
    for (int i = 0; i < 4; i++) {
        x[i] = from_left[i] - width / 2 * w[i];
        y[i] = from_top[i] - height / 2 * w[i];
    }
    const double size_w = shb_sum_abs(w);
    const double size_x = shb_sum_abs(x) + size_w * width / 2;
    const double size_y = shb_sum_abs(y) + size_w * height / 2;
    const double size_z = shb_sum_abs(z) + size_w;
    const double larger = fmax(size_x, size_y), slopes = size_z / size_x + size_z / size_y;
    const double scale = 1 / (size_x * size_y);
    const double det = determinant((const double *const[4]){x, y, z, w}, &det_error);
    const double least = fmax(det - det_error, 0) * scale, most = (det + det_error) * scale;
    const double error = (map->projection.affine ? 4.7 : 7.7) * U * slopes;
    const double beta_x = (fabs(from_left[3]) + width * fabs(w[3])) / size_x;
    const double beta_y = (fabs(from_top[3]) + height * fabs(w[3])) / size_y;
    const double beta_z = (fabs(z[3]) + 3 * fabs(w[3])) / size_z;
    const double beta = fmax(fmax(beta_x, beta_y), beta_z);
    const bool known = in_range(slopes) && unit > 0x1p-67 && in_range(larger) && most < 0x1p20 &&
                       size_w < RANGE && beta < RANGE;

    shb_quick_planes quick = {
        .middle_x = (float)(width / 2),
        .middle_y = (float)(height / 2),
        .moved = (float)(U * least * (1 - 0x1p-16)),
        .error = known ? (float)error : NAN,
        .depth_error = (float)(14 * U + error),
        .beta = (float)(beta * (1 + 0x1p-16)),
        .farthest = (float)fmin(0x1p-3 / (U * larger), 0x1p-7 / (U * fmax(size_w, 1 / RANGE))),
        .steep = (float)(0x1p12 * SHB_NORMAL_ERROR * 1.01),
        .steep_by_place = (float)(0x1p12 * 0.71 * U * size_w),
        .own = (float)(1.54 * slopes * 3 * SHB_NORMAL_ERROR),
        .own_by_normal = (float)(1.54 * slopes * 100 * E + 0x1p-46 + 2.3 * error),
        .own_by_place = (float)(1.54 * slopes * 1.4 * U * size_w + 8 * E * size_z),
        .own_by_w = (float)(1.05 * U * most / 3),
        .step_unit = (float)(unit * 0x1p63),
        .occluder_by_place = (float)(1.05 * U * size_z),
        .occluder_by_slope = (float)(0.37 * U * larger),
        .diagonal = (float)(map->projection.texel_scale * map->projection.depth_scale)};
    write_cross(x, y, scale, quick.xy);
    write_cross(z, y, scale, quick.zy);
    write_cross(x, z, scale, quick.xz);
    write_cross(x, w, scale, quick.xw);
    write_cross(y, w, scale, quick.yw);
    write_cross(z, w, scale, quick.zw);
    return quick;
}
