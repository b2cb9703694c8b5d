#include "slow_taps.h"

#include "../../src/format.h"
#include "../../src/occluders.h"

#include <math.h>

static bool is_in_map(const shb_map *map, int x, int y) {
    return x >= 0 && y >= 0 && x < (int)map->info.width && y < (int)map->info.height;
}

static int mantissa_of(uint32_t bits) {
    const int whole = (int)(bits % 16384);
    return whole < 8192 ? whole : whole - 16384;
}

shb_exact_sample slow_sample_of(const shb_map *map, int x, int y) {
    const int32_t column = x, row = y;
    const uint32_t texel = shb_occluder_row(map, y)[x];
    const double step = pow(4, texel % 16) * map->occluders.slope_unit;
    const double unit = texel == 0xffffffff ? (double)INFINITY : step;
    float depth;
    shb_map_fetch(map, 1, &column, &row, &depth);
    return (shb_exact_sample){.center_x = x + 0.5,
                              .center_y = y + 0.5,
                              .depth = (double)depth,
                              .slope_x = mantissa_of(texel >> 18) * unit,
                              .slope_y = mantissa_of(texel >> 4) * unit,
                              .slope_error_x = unit / 2,
                              .slope_error_y = unit / 2};
}

/* A plane through a place of the map. */
typedef struct sheet_plane {
    double x, y, z, slope_x, slope_y;
    double slope_error; /* of each */
    bool is_covered;    /* by an occluder */
} sheet_plane;

static sheet_plane plane_of_texel(const shb_map *map, int x, int y) {
    const shb_exact_sample s = slow_sample_of(map, x, y);
    const bool is_covered = s.depth < (map->info.view.reversed ? 0 : 1);
    return (sheet_plane){s.center_x, s.center_y,      s.depth,   s.slope_x,
                         s.slope_y,  s.slope_error_x, is_covered};
}

static bool is_known(const sheet_plane *plane) {
    return plane->is_covered && plane->slope_error < (double)INFINITY;
}

static double behind(const sheet_plane *a, const sheet_plane *b) {
    return b->z - (a->z + a->slope_x * (b->x - a->x) + a->slope_y * (b->y - a->y));
}

/* The planes cut each other between the places, or meet within what their slopes are off by and a
 * step of the format, times so much. */
static bool planes_meet(const shb_map *map, const sheet_plane *a, const sheet_plane *b,
                        double times) {
    const double way = fabs(b->x - a->x) + fabs(b->y - a->y);
    const double slopes = (a->slope_error + b->slope_error) * way;
    const double step = map->info.format == SHB_FORMAT_UNORM16 ? 0x1p-16 : 0;
    const double error = slopes + 0x1p-21 * (fabs(a->z) + fabs(b->z)) + step;
    const double ahead = behind(a, b), back = behind(b, a);
    return is_known(a) && is_known(b) &&
           fmin(fmax(ahead, back), -fmin(ahead, back)) <= error * times;
}

slow_joint slow_joint_of(const shb_map *map, int ax, int ay, int bx, int by) {
    if (!is_in_map(map, ax, ay) || !is_in_map(map, bx, by))
        return SLOW_JOINT_APART;
    const sheet_plane a = plane_of_texel(map, ax, ay), b = plane_of_texel(map, bx, by);
    const bool strictly = planes_meet(map, &a, &b, 0.5), nearly = planes_meet(map, &a, &b, 2);
    return strictly == nearly ? (slow_joint)strictly : SLOW_JOINT_UNSURE;
}

/* The scalar test less what it allows for snapping, which taps do not. */
static bool is_shadowed(const shb_exact_fragment *fragment, const shb_exact_sample *sample) {
    shb_exact_fragment strict = *fragment;
    const double turn =
        fabs(fragment->slopes.x - sample->slope_x) + fabs(fragment->slopes.y - sample->slope_y);
    strict.error -= turn * SHB_SNAPPED_TEXELS;
    return shb_exact_is_shadowed(&strict, sample);
}

bool slow_tap_is_shadowed(const shb_map *map, const shb_exact_fragment *fragment, int x, int y) {
    if (!is_in_map(map, x, y))
        return false;
    if (map->info.occluders == SHB_OCCLUDERS_TRIANGLES) {
        const uint32_t texel = shb_occluder_row(map, y)[x];
        shb_exact_sample sample = {.center_x = x + 0.5, .center_y = y + 0.5};
        if (texel == SHB_ID_NONE)
            return false;
        const shb_occluder_plane *plane = &map->occluders.planes[texel];
        sample.slope_x = plane->slope_x;
        sample.slope_y = plane->slope_y;
        sample.depth = shb_occluder_depth(plane, x + 0.5, y + 0.5) + plane->error;
        return is_shadowed(fragment, &sample);
    }
    const sheet_plane plane = plane_of_texel(map, x, y);
    const shb_exact_sample sample = slow_sample_of(map, x, y);
    return plane.is_covered && is_shadowed(fragment, &sample);
}

/* How far a texel's plane misses the occluder of the one beside it, beyond rounding; infinite where
 * there is none. */
static double miss_beside(const shb_map *map, const sheet_plane *plane, int x, int y) {
    if (!is_in_map(map, x, y))
        return (double)INFINITY;
    const sheet_plane beside = plane_of_texel(map, x, y);
    const double rounding = (1 + 0x1p-6) * plane->slope_error +
                            0x1p-21 * (fabs(plane->z) + fabs(beside.z)) +
                            (double)shb_format_step(map->info.format);
    const double miss = fmax(fabs(behind(plane, &beside)) - rounding, 0);
    return beside.is_covered ? miss : (double)INFINITY;
}

bool slow_is_fine_sheet(const shb_map *map, const shb_exact_fragment *fragment, int x, int y) {
    const shb_light_point *point = &fragment->point;
    const shb_light_slopes *slopes = &fragment->slopes;
    const sheet_plane plane = plane_of_texel(map, x, y);
    const double misses[4] = {
        miss_beside(map, &plane, x - 1, y), miss_beside(map, &plane, x + 1, y),
        miss_beside(map, &plane, x, y - 1), miss_beside(map, &plane, x, y + 1)};
    const double texel = map->projection.texel_scale * map->projection.depth_scale / point->w;
    const double turn = fabs(slopes->x - plane.slope_x) + fabs(slopes->y - plane.slope_y);
    const double passed =
        point->z -
        (plane.z - (plane.slope_x * (plane.x - point->x) + plane.slope_y * (plane.y - point->y)));
    const bool has_plane = slopes->x != 0 || slopes->y != 0 || slopes->error_x > 0;
    int missed = 0, known = 0;
    for (int k = 0; k < 4; k++) {
        missed += passed < 2 * misses[k];
        known += misses[k] < (double)INFINITY;
    }
    return has_plane && passed < 4 * texel && turn < texel && missed >= 3 && known >= 2;
}

/* A texel, and those that are joined to it one after the other. */
static void reach(const shb_map *map, slow_box *box, int column, int row) {
    const sheet_plane own = plane_of_texel(map, box->left + column, box->top + row);
    box->sheet[row][column] = true;
    for (int k = row - 1; k <= row + 1; k++)
        for (int j = column - 1; j <= column + 1; j++) {
            if (k < 0 || j < 0 || k >= box->n || j >= box->n || box->sheet[k][j] ||
                !is_in_map(map, box->left + j, box->top + k))
                continue;
            const sheet_plane other = plane_of_texel(map, box->left + j, box->top + k);
            if (planes_meet(map, &own, &other, 1))
                reach(map, box, j, k);
        }
}

/* Of n texels around a place on an axis. */
static int first_of(double place, int n) {
    return (int)floor(n % 2 ? place : place + 0.5) - n / 2;
}

slow_box slow_box_of(const shb_map *map, const shb_exact_fragment *fragment, int n) {
    const int x = (int)floor(fragment->point.x), y = (int)floor(fragment->point.y);
    slow_box box = {
        .left = first_of(fragment->point.x, n), .top = first_of(fragment->point.y, n), .n = n};
    if (map->info.occluders != SHB_OCCLUDERS_PLANES || !is_in_map(map, x, y))
        return box;
    const sheet_plane own = {fragment->point.x,
                             fragment->point.y,
                             fragment->point.z,
                             fragment->slopes.x,
                             fragment->slopes.y,
                             0,
                             true};
    const sheet_plane texel = plane_of_texel(map, x, y);
    if (planes_meet(map, &own, &texel, 1) && !slow_tap_is_shadowed(map, fragment, x, y))
        reach(map, &box, x - box.left, y - box.top);
    return box;
}

bool slow_is_on_sheet(const slow_box *box, int x, int y) {
    const int column = x - box->left, row = y - box->top;
    return column >= 0 && row >= 0 && column < box->n && row < box->n && box->sheet[row][column];
}

/* How much of the texel at this place a side of length n - 1 around the middle covers. */
static double covered_side(double middle, int texel, int n) {
    const double half = (n - 1) / 2.0;
    return fmax(fmin(middle + half, texel + 1.0) - fmax(middle - half, texel), 0);
}

double slow_lit_in_box(const shb_map *map, const shb_exact_fragment *fragment, int n, bool smooth) {
    const double x = fragment->point.x, y = fragment->point.y;
    const slow_box box = slow_box_of(map, fragment, n);
    double lit = 0, all = 0;
    for (int k = 0; k < n; k++)
        for (int j = 0; j < n; j++) {
            const int column = box.left + j, row = box.top + k;
            const double part = smooth ? covered_side(x, column, n) * covered_side(y, row, n) : 1;
            lit += part * (box.sheet[k][j] || !slow_tap_is_shadowed(map, fragment, column, row));
            all += part;
        }
    return lit / all;
}
