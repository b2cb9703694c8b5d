#include "strict.h"

#include "exact.h"

#include "exact_points.h"
#include "exact_triangles.h"
#include "format.h"
#include "half.h"
#include "kernels/sheets.h"
#include "lists.h"
#include "occluders.h"
#include "project.h"

#include <float.h>

/* What an element of a host's normal may be off by: four roundings of a unit vector in float. */
#define NORMAL_ERROR 0x1p-22

/* Planes whose slopes are known to be 0 take the place of those without a normal. */
static bool is_usable(const double normal[3]) {
    const double squared = shb_dot(normal, normal);
    return squared > 0 && squared <= DBL_MAX;
}

shb_exact_fragment shb_exact_fragment_of(const shb_light_rows *rows, const double position[3],
                                         const double normal[3]) {
    static const double normal_error[3] = {NORMAL_ERROR, NORMAL_ERROR, NORMAL_ERROR};
    shb_exact_fragment fragment = {.point = shb_light_point_at(rows, position, SHB_FLOAT_ROUNDING)};
    if (is_usable(normal))
        fragment.slopes = shb_light_slopes_of(rows, &fragment.point, normal, normal_error);
    const shb_light_point *point = &fragment.point;
    const double moved_x = shb_dot_abs(point->a, point->by_position) + point->error_x;
    const double moved_y = shb_dot_abs(point->b, point->by_position) + point->error_y;
    fragment.error = shb_light_point_error(point, fragment.slopes.x, fragment.slopes.y) +
                     (fragment.slopes.error_x * moved_x + fragment.slopes.error_y * moved_y);
    return fragment;
}

/* Comparisons with NaN are false: lit. */
bool shb_exact_is_shadowed(const shb_exact_fragment *fragment, const shb_exact_sample *sample) {
    const shb_light_point *point = &fragment->point;
    const shb_light_slopes *slopes = &fragment->slopes;
    const double to_x = sample->center_x - point->x, to_y = sample->center_y - point->y;
    const double own = point->z + (slopes->x * to_x + slopes->y * to_y);
    const double own_error =
        fragment->error + (slopes->error_x * fabs(to_x) + slopes->error_y * fabs(to_y));
    const double occluder = sample->depth - (sample->slope_x * to_x + sample->slope_y * to_y);
    const double occluder_error =
        shb_light_point_error(point, sample->slope_x, sample->slope_y) +
        (sample->slope_error_x * fabs(to_x) + sample->slope_error_y * fabs(to_y));
    return (own - sample->depth > own_error) & (point->z - occluder > occluder_error);
}

/* Fragments of a batch in the map; SHB_TEXEL_NONE behind the light and outside. */
typedef struct exact_places {
    SHB_ALIGN double x[SHB_BATCH];
    double y[SHB_BATCH], z[SHB_BATCH];
    int32_t column[SHB_BATCH], row[SHB_BATCH];
} exact_places;

static void find_places(const shb_light_rows *rows, size_t lanes,
                        const shb_receivers *restrict receivers, exact_places *restrict places) {
    const double limit = -(double)SHB_TEXEL_NONE;
    for (size_t i = 0; i < lanes; i++) {
        const double p[3] = {(double)receivers->x[i], (double)receivers->y[i],
                             (double)receivers->z[i]};
        const double w = shb_dot(rows->w, p) + rows->w[3];
        const double inverse_w = 1 / w;
        const double x = (shb_dot(rows->x, p) + rows->x[3]) * inverse_w;
        const double y = (shb_dot(rows->y, p) + rows->y[3]) * inverse_w;
        const int good = (w > 0) & (x >= 0) & (y >= 0) & (x < limit) & (y < limit);
        places->x[i] = x;
        places->y[i] = y;
        places->z[i] = (shb_dot(rows->z, p) + rows->z[3]) * inverse_w;
        places->column[i] = (int32_t)(good ? x : (double)SHB_TEXEL_NONE);
        places->row[i] = (int32_t)(good ? y : (double)SHB_TEXEL_NONE);
    }
}

static shb_exact_sample sample_of_slopes(uint32_t slopes, double unit, int32_t column, int32_t row,
                                         float depth) {
    const double x = (double)shb_half_to_float((uint16_t)(slopes & 0xffff)) * unit;
    const double y = (double)shb_half_to_float((uint16_t)(slopes >> 16)) * unit;
    const double smallest = SHB_HALF_ABSOLUTE * unit;
    return (shb_exact_sample){
        .center_x = column + 0.5,
        .center_y = row + 0.5,
        .depth = (double)depth,
        .slope_x = x,
        .slope_y = y,
        .slope_error_x = fabs(x) * SHB_HALF_RELATIVE + smallest,
        .slope_error_y = fabs(y) * SHB_HALF_RELATIVE + smallest,
    };
}

/* Without any bound; true for few fragments but those in shadow. */
static bool may_be_shadowed(const exact_places *places, size_t i, const shb_exact_sample *sample) {
    const double to_x = sample->center_x - places->x[i], to_y = sample->center_y - places->y[i];
    return places->z[i] > sample->depth - (sample->slope_x * to_x + sample->slope_y * to_y);
}

static shb_exact_fragment read_fragment(const shb_map *map, const shb_receivers *receivers,
                                        size_t i) {
    const double position[3] = {(double)receivers->x[i], (double)receivers->y[i],
                                (double)receivers->z[i]};
    const double normal[3] = {(double)receivers->normal_x[i], (double)receivers->normal_y[i],
                              (double)receivers->normal_z[i]};
    return shb_exact_fragment_of(&map->rows, position, normal);
}

static void ask_planes(const shb_map *map, size_t lanes, const shb_receivers *receivers,
                       float *visibility) {
    exact_places places = {0};
    SHB_ALIGN float depths[SHB_BATCH];
    const float far_depth = shb_far_depth(map->info.view.reversed);
    find_places(&map->rows, lanes, receivers, &places);
    shb_map_fetch(map, lanes, places.column, places.row, depths);
    for (size_t i = 0; i < lanes; i++) {
        visibility[i] = 1;
        if (!(depths[i] < far_depth))
            continue;
        const int32_t column = places.column[i], row = places.row[i];
        const shb_exact_sample sample = sample_of_slopes(
            shb_occluder_row(map, row)[column], map->occluders.slope_unit, column, row, depths[i]);
        if (!may_be_shadowed(&places, i, &sample))
            continue;
        const shb_exact_fragment fragment = read_fragment(map, receivers, i);
        visibility[i] = shb_exact_is_shadowed(&fragment, &sample) ? 0.0f : 1.0f;
    }
}

static void ask_lists(const shb_lists *lists, const shb_exact_points *points, float *visibility) {
    const shb_list_points asked = {.count = points->count,
                                   .x = points->x,
                                   .y = points->y,
                                   .z = points->z,
                                   .own_ids = points->has_ids ? points->own_ids : NULL,
                                   .rounding = points->are_exact ? 0 : SHB_FLOAT_ROUNDING};
    shb_lists_query(lists, &asked, visibility);
}

/* By all that the map keeps for the exact method; nothing held: an empty map. */
static void ask_occluders(const shb_map *map, const shb_exact_points *points,
                          const shb_receivers *receivers, float *visibility) {
    const size_t lanes = shb_round_to_lanes(points->count);
    if (map->lists) {
        ask_lists(map->lists, points, visibility);
    } else if (map->info.occluders == SHB_OCCLUDERS_TRIANGLES && map->occluders.held) {
        shb_exact_ask_triangles(map, points, receivers, visibility);
    } else if (map->occluders.held) {
        ask_planes(map, lanes, receivers, visibility);
    } else {
        for (size_t i = 0; i < lanes; i++)
            visibility[i] = 1;
    }
}

/* Writes the answers that are certain, and the numbers of the other fragments; returns how many
 * these are. */
static size_t settle(const shb_map *map, const shb_exact_points *points, float *visibility,
                     uint16_t unsure[SHB_BATCH]) {
    SHB_ALIGN int32_t answers[SHB_BATCH];
    SHB_ALIGN float x[SHB_BATCH], y[SHB_BATCH], z[SHB_BATCH];
    const shb_sheet_kernels *kernels = shb_sheet_kernels_of(map->context->isa);
    for (size_t i = 0; i < shb_round_to_lanes(points->count); i++) {
        x[i] = (float)points->x[i];
        y[i] = (float)points->y[i];
        z[i] = (float)points->z[i];
    }
    kernels->ask(&map->occluders.sheets, points->count, x, y, z, answers);
    size_t left = 0;
    for (size_t i = 0; i < points->count; i++) {
        visibility[i] = answers[i] == SHB_LIGHT_SHADOWED ? 0.0f : 1.0f;
        unsure[left] = (uint16_t)i;
        left += answers[i] == SHB_LIGHT_UNSURE;
    }
    return left;
}

/* Fragments of these numbers as a batch; has_normals: theirs are read. The last one fills up the
 * lanes. */
static void pick(const shb_receivers *restrict from, const uint16_t *numbers, size_t count,
                 bool has_normals, shb_receivers *restrict to) {
    for (size_t k = 0; k < shb_round_to_lanes(count); k++) {
        const size_t i = numbers[k < count ? k : count - 1];
        to->x[k] = from->x[i];
        to->y[k] = from->y[i];
        to->z[k] = from->z[i];
        if (has_normals) {
            to->normal_x[k] = from->normal_x[i];
            to->normal_y[k] = from->normal_y[i];
            to->normal_z[k] = from->normal_z[i];
        }
    }
}

/* Few fragments are left for the occluders where sheets know the others. */
static void ask_sheets_first(const shb_map *map, const shb_exact_points *points,
                             const shb_receivers *receivers, float *visibility) {
    uint16_t unsure[SHB_BATCH];
    SHB_ALIGN float answers[SHB_BATCH];
    shb_exact_points left_points;
    shb_receivers left;
    const size_t left_count = settle(map, points, visibility, unsure);
    if (left_count == 0)
        return;
    shb_exact_points_pick(points, unsure, left_count, &left_points);
    pick(receivers, unsure, left_count, !map->lists, &left);
    ask_occluders(map, &left_points, &left, answers);
    for (size_t k = 0; k < left_count; k++)
        visibility[unsure[k]] = answers[k];
}

void shb_exact_visibility(const shb_filter_args *args) {
    const shb_map *map = args->map;
    shb_exact_points points;
    shb_exact_points_of(args, &points);
    if (map->classifies && map->occluders.held && !args->lifted)
        ask_sheets_first(map, &points, args->receivers, args->visibility);
    else
        ask_occluders(map, &points, args->receivers, args->visibility);
}
