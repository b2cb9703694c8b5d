/* With u = 2^-24 and d = 2^-53, the units of rounding of float and double, let p be a fragment, o
 * the middle of the box, |p_i - o_i| <= M_i, |p_i| <= P, and w > 0 the point's own one with w_min
 * below it.
 *
 * Ways. p - o is rounded once, relative error u. The kernel compares rounded ways with a rounded M:
 * that is made larger by both.
 *
 * A coordinate. Its row r = (row - base * row_w), so that the coordinate is base + X / w with X =
 * r.(p - o) + c and c = r.o + r_3. With S = sum M_i |r_i|, T = S + |c| bounds X. In float each
 * product has the rounding of r_i, of the way, its own and three sums', c its own and one sum's: X
 * is within u (7 S + 3 |c|) (one more each for terms of higher order). So is w = row_w.(p - o) +
 * w_o within u (7 S_w + 3 w_o). 1 / w and the product round once more each. With w >= w_min and |X
 * / w| <= reach = T / w_min, X / w is within
 *     u (7 S + 3 |c| + reach (7 S_w + 3 w_o)) / w_min + 3 u reach
 *     <=  u (7 S + 3 |c| + reach (7 S_w + 6 w_o)) / w_min.
 * In an affine map w is 1, and u (7 S + 3 |c|) is all.
 *
 * What the double projection says of it, and r and c here, are each a few operations on the row's
 * elements times coordinates: G = P sum (|row_i| + |x| |row_w,i|) + |row_3| + |x| |row_w,3| with
 * |x| <= |base| + reach bounds all that is rounded, less than 64 times in all: 64 d G / w_min.
 * coordinate_row() sums both up as error.
 *
 * The texel. base is the centre of a texel and |x - base| < 2^22, so that the nearest integer finds
 * the texel and the way to its centre is exact: both are sure where that is less than half a texel
 * by more than error.
 *
 * The comparison. Let A = stored - depth and B = z + run - epsilon, z counted from depth on. That A
 * < B is decided by rounded numbers exactly, A is within u |A|, which matters only where |A| <= 2
 * |B|. z is within its error. The double projection's depth, its sum with the run and its
 * difference with epsilon are rounded to float: 3 u (|depth| + |z| + |run| + |epsilon|); A and B
 * take less than 5 u of the same. Where B is the far depth it is rounded once, and that depth is at
 * most 1. Epsilons are within 64 u of their size: w by less than 7 u 1.5
 * w_o / w_min <= 21 u, as S_w < w_o / 2 and w_o <= 2 w_min, twice that for its square, and some
 * products.
 *
 * The run. n.xy, n.zy and n.xz are sums of three products and, unless the map is affine, of two
 * more that are multiplied by coordinates: 16 u N times the sum S of the elements' sizes, each
 * multiplied by its coordinate's reach, and N times the elements times those coordinates' errors;
 * 64 d N times the same with the coordinates themselves for doubles. As long as error_xy |1 / n.xy|
 * <= 1/4, a slope s = n.zy / n.xy is within 4/3 (error + |s| error_xy) / |n.xy| + 2 u |s|. Doubled
 * instead, that leaves room for |n.xy| itself. Runs are slopes times at most half a texel, which
 * has the coordinate's error; and they are rounded to float by both sides, 12 u of the slopes.
 * All sizes are less than errors / (16 u); with these below 2^60 and, with N, above 2^-100, neither
 * overflows nor roundings of what underflows count. That all of these are less than most_error says
 * that error_xy is small enough, as error_other over |n.xy| is less then, and that slopes with
 * their errors are below 1, where they are cut off, as error_slope times the slopes is less. */
#include "strict.h"

#include "quick_test.h"

#include "format.h"
#include "larger.h"
#include "light_point.h"
#include "stages.h"

#include <math.h>

#define U 0x1p-24
#define D 0x1p-53

/* Where sizes end up to which nothing overflows. */
#define LARGE 0x1p29

/* How far a box goes beyond the batch it is made for, to hold its neighbours, too: a part of the
 * batch's size. */
#define GROWTH 0.25

/* A box in double. */
typedef struct box {
    const double *row_w;
    double origin[3], reach[3], largest; /* o, M, P */
    double w, w_growth;                  /* w_o, S_w */
    double inverse;                      /* of w_min */
    bool affine;
} box;

static double row_at(const double *row, const double *v) {
    return row[0] * v[0] + row[1] * v[1] + row[2] * v[2] + row[3];
}

/* How much a row's product with the ways from the origin may be. */
static double growth(const box *b, const double *row) {
    return fabs(row[0]) * b->reach[0] + fabs(row[1]) * b->reach[1] + fabs(row[2]) * b->reach[2];
}

/* Of numbers below 2^51. */
static double nearest_integer(double value) {
    return (value + 0x1.8p52) - 0x1.8p52;
}

static bool start_box(const shb_map *map, const shb_quick_extent *extent, double growth_of_size,
                      box *b) {
    double size = 0;
    for (int i = 0; i < 3; i++)
        size = larger((double)extent->most[i] - (double)extent->least[i], size);
    b->row_w = map->rows.w;
    b->affine = map->projection.affine;
    b->largest = 0;
    for (int i = 0; i < 3; i++) {
        const double least = (double)extent->least[i], most = (double)extent->most[i];
        b->origin[i] = (double)(float)(0.5 * (least + most));
        b->reach[i] = larger(most - b->origin[i], b->origin[i] - least) + growth_of_size * size;
        b->reach[i] *= 1 + 4 * U;
        b->largest = larger(fabs(b->origin[i]) + b->reach[i], b->largest);
    }
    b->w = row_at(b->row_w, b->origin);
    b->w_growth = growth(b, b->row_w);
    const double w_min = (b->w - b->w_growth) * (1 - 0x1p-20);
    b->inverse = 1 / w_min;
    return w_min > 0.5 * b->w && b->w < LARGE && b->largest < 0x1p100;
}

/* A coordinate counted from base on: its row, how far it may be from base, and its error. */
typedef struct coordinate {
    double base, reach, error;
} coordinate;

static coordinate coordinate_row(const box *b, const double *row, double base, shb_quick_row to) {
    double r[4], sizes[4];
    for (int i = 0; i < 4; i++)
        r[i] = row[i] - base * b->row_w[i];
    const double constant = row_at(r, b->origin);
    const double ways = growth(b, r);
    const double reach = (ways + fabs(constant)) * b->inverse;
    for (int i = 0; i < 4; i++)
        sizes[i] = fabs(row[i]) + (fabs(base) + reach) * fabs(b->row_w[i]);
    const double all = shb_sum_abs(sizes) * b->largest + sizes[3];
    for (int i = 0; i < 3; i++)
        to[i] = (float)r[i];
    to[3] = (float)constant;
    const double by_w = b->affine ? 0 : reach * (7 * b->w_growth + 6 * b->w);
    const double floats = U * (7 * ways + 3 * fabs(constant) + by_w);
    return (coordinate){base, reach, (floats + 64 * D * all) * b->inverse + 0x1p-120};
}

/* A texel coordinate: counted from the centre of the origin's texel. */
static coordinate texel_row(const box *b, const double *row, shb_quick_row to) {
    const double own = row_at(row, b->origin) / b->w;
    return coordinate_row(b, row, nearest_integer(own - 0.5) + 0.5, to);
}

static bool is_usable(const coordinate *texel) {
    return fabs(texel->base) < LARGE && texel->reach < 0x1p22 && texel->error < 0x1p-4;
}

/* sum of the elements' sizes of v, less base_a * a and plus base_b * b, which v becomes. */
static double relative(const double *v, const double *a, double base_a, const double *b,
                       double base_b, float to[3]) {
    double made[3];
    for (int i = 0; i < 3; i++) {
        made[i] = v[i] - base_a * a[i] + base_b * b[i];
        to[i] = (float)made[i];
    }
    return shb_sum_abs(made);
}

/* The error of v - a * at_a + b * at_b, a vector's product with a normal in which at_a and at_b
 * are coordinates; size is that of the vector relative to their bases. */
static double product_error(double size, const double *v, const double *a, const coordinate *at_a,
                            const double *b, const coordinate *at_b) {
    const double sum_a = shb_sum_abs(a), sum_b = shb_sum_abs(b);
    const double far_a = fabs(at_a->base) + at_a->reach, far_b = fabs(at_b->base) + at_b->reach;
    return 16 * U * (size + sum_a * at_a->reach + sum_b * at_b->reach) +
           (sum_a * at_a->error + sum_b * at_b->error) +
           64 * D * (shb_sum_abs(v) + sum_a * far_a + sum_b * far_b);
}

/* False if some products would leave the range of floats. */
static bool set_slopes(const shb_projection *p, double normal, const coordinate *x,
                       const coordinate *y, const coordinate *z, shb_quick_test *test) {
    const double xy =
        relative(p->x_cross_y, p->x_cross_w, y->base, p->y_cross_w, x->base, test->xy);
    const double zy =
        relative(p->z_cross_y, p->z_cross_w, y->base, p->y_cross_w, z->base, test->zy);
    const double xz =
        relative(p->x_cross_z, p->x_cross_w, z->base, p->z_cross_w, x->base, test->xz);
    for (int i = 0; i < 3; i++) {
        test->xw[i] = (float)p->x_cross_w[i];
        test->yw[i] = (float)p->y_cross_w[i];
        test->zw[i] = (float)p->z_cross_w[i];
    }
    const double error_xy = product_error(xy, p->x_cross_y, p->x_cross_w, y, p->y_cross_w, x);
    const double error_zy = product_error(zy, p->z_cross_y, p->z_cross_w, y, p->y_cross_w, z);
    const double error_xz = product_error(xz, p->x_cross_z, p->x_cross_w, z, p->z_cross_w, x);
    test->error_xy = (float)(2 * normal * error_xy);
    test->error_other = (float)(2 * normal * (error_zy + error_xz));
    test->error_slope = (float)(larger(x->error, y->error) + 16 * U);
    test->most_error = fminf(0.49f * test->error_other / test->error_xy, 0.49f * test->error_slope);
    const double errors = error_xy + error_zy + error_xz;
    return normal * errors > 0x1p-100 && larger(normal, 1) * errors < 0x1p60;
}

bool shb_quick_test_of(const shb_map *map, const shb_quick_bias *bias,
                       const shb_quick_extent *extent, shb_quick_test *test) {
    box b;
    if (!start_box(map, extent, GROWTH, &b) && !start_box(map, extent, 0, &b))
        return false;
    for (int i = 0; i < 3; i++) {
        test->origin[i] = (float)b.origin[i];
        test->reach[i] = (float)(b.reach[i] * (1 - 3 * U));
    }
    test->normal = extent->normal * (float)(1 + GROWTH);
    const coordinate x = texel_row(&b, map->rows.x, test->x);
    const coordinate y = texel_row(&b, map->rows.y, test->y);
    test->depth = (float)(row_at(map->rows.z, b.origin) / b.w);
    test->farthest = shb_far_depth(map->info.view.reversed) - test->depth;
    const coordinate z = coordinate_row(&b, map->rows.z, (double)test->depth, test->z);
    for (int i = 0; i < 3; i++)
        test->w[i] = (float)b.row_w[i];
    test->w[3] = (float)b.w;
    double power = 1, epsilon = 0;
    for (int i = 0; i < 3; i++, power *= b.inverse) {
        if (bias->epsilon[i] != 0 && fabs(bias->epsilon[i]) < 0x1p-100)
            return false; /* floats lose its digits */
        test->epsilon[i] = (float)bias->epsilon[i];
        epsilon += fabs(bias->epsilon[i]) * power;
    }
    if (map->projection.affine)
        test->epsilon[0] = (float)(bias->epsilon[0] + bias->epsilon[1] + bias->epsilon[2]);
    if (!is_usable(&x) || !is_usable(&y) || !(fabs(z.base) + z.reach + epsilon < LARGE))
        return false;
    test->texel_x = (int32_t)(x.base - 0.5);
    test->texel_y = (int32_t)(y.base - 0.5);
    test->sure = (float)(0.5 - larger(x.error, y.error) - U);
    const double rounding = 8 * U * (1 + fabs(z.base) + z.reach + epsilon) + 64 * U * epsilon;
    test->error = (float)((z.error + rounding) * (1 + 0x1p-20));
    return !bias->plane || set_slopes(&map->projection, (double)test->normal, &x, &y, &z, test);
}

static void constant_epsilon(const shb_map *map, const shb_bias *bias, double epsilon[3]) {
    const double amount = (double)bias->params[0];
    const float unit = bias->params[1];
    if (unit == SHB_UNIT_TEXEL)
        epsilon[1] = amount * map->projection.texel_scale * map->projection.depth_scale;
    else if (unit == SHB_UNIT_WORLD)
        epsilon[2] = amount * map->projection.depth_scale;
    else
        epsilon[0] = amount;
}

bool shb_quick_bias_of(const shb_map *map, const shb_bias *bias, shb_quick_bias *quick) {
    *quick = (shb_quick_bias){.plane = bias->depth == shb_receiver_plane_depth ||
                                       bias->depth == shb_adaptive_depth};
    if (bias->offset || bias->needs & SHB_NEEDS_OCCLUDERS)
        return false;
    if (bias->depth == shb_constant_depth)
        constant_epsilon(map, bias, quick->epsilon);
    else if (bias->depth == shb_receiver_plane_depth)
        quick->epsilon[0] = (double)bias->params[0];
    else if (bias->depth == shb_adaptive_depth)
        quick->epsilon[2] =
            map->projection.depth_scale * (double)shb_world_epsilon(&map->info, bias);
    else
        return !bias->depth;
    return true;
}
