#include "map.h"
#include "method_text.h"
#include "prepare.h"
#include "triples.h"
#include "visibility.h"

#include <string.h>

bool shb_visibility_needs_normals(const shb_map *map, const shb_bias *bias,
                                  const shb_filter *filter) {
    const bool by_planes =
        bias->needs & SHB_NEEDS_OCCLUDERS && map->info.occluders != SHB_OCCLUDERS_LISTS;
    const uint32_t needs = bias->needs | (filter ? filter->needs : 0);
    return by_planes || needs & (SHB_NEEDS_NORMAL | SHB_NEEDS_SLOPE);
}

static const char *name_of(const shb_bias *bias) {
    return shb_method_name(bias->name);
}

/* True if the map's depths are those that the method works on. */
static bool map_serves(const shb_map *map, const shb_bias *bias) {
    if (map->empty)
        return true;
    const bool flipped = (bias->needs & SHB_NEEDS_FLIPPED) != 0;
    if (map->combine != bias->combine || map->flipped != flipped)
        return false;
    return !bias->combine || (map->combine_user == bias->user &&
                              memcmp(map->combine_params, bias->params, sizeof bias->params) == 0);
}

static shb_result check_occluders(const shb_map *map, const char *caller, const shb_bias *bias,
                                  const shb_filter *filter) {
    if (!map->info.occluders && !map->empty)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs a map that was created with desc.occluders",
                        caller, name_of(bias));
    if (!map->empty && !map->occluders.held)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs occluders and the map was drawn for another",
                        caller, name_of(bias));
    if (filter && !filter->exact)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" asks occluders, which the filter \"%s\" cannot",
                        caller, name_of(bias), shb_method_name(filter->name));
    if (filter && filter->needs & SHB_NEEDS_SAMPLES && map->info.occluders == SHB_OCCLUDERS_LISTS)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "%s: the filter \"%s\" asks the occluder of each texel, and "
                        "desc.occluders of the map are lists",
                        caller, shb_method_name(filter->name));
    return SHB_OK;
}

static shb_result check_filter(const shb_map *map, const char *caller, const shb_filter *filter) {
    const uint32_t known = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE |
                           SHB_NEEDS_PREPARED | SHB_NEEDS_SAMPLES;
    if (!filter->filter)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "%s: filter.filter is NULL", caller);
    if (filter->needs & ~known)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "%s: filter.needs 0x%x has unknown bits",
                        caller, (unsigned)filter->needs);
    return SHB_OK;
}

static shb_result check_prepared(const shb_map *map, const char *caller, const shb_filter *filter) {
    if (!(filter->needs & SHB_NEEDS_PREPARED) || shb_prepared_find(map, filter))
        return SHB_OK;
    return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                    "%s: the filter \"%s\" needs shb_map_prepare after the map was drawn", caller,
                    shb_method_name(filter->name));
}

shb_result shb_visibility_check(const shb_map *map, const char *caller, const shb_bias *bias,
                                const shb_filter *filter, bool has_normals) {
    const shb_context *context = map->context;
    const uint32_t known = SHB_NEEDS_NORMAL | SHB_NEEDS_SCALE | SHB_NEEDS_SLOPE |
                           SHB_NEEDS_FLIPPED | SHB_NEEDS_OCCLUDERS;
    if (!bias)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: bias is NULL", caller);
    if (bias->needs & ~known)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "%s: bias.needs 0x%x has unknown bits", caller,
                        (unsigned)bias->needs);
    shb_result result = filter ? check_filter(map, caller, filter) : SHB_OK;
    if (result != SHB_OK)
        return result;
    if (shb_visibility_needs_normals(map, bias, filter) && !has_normals)
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" or the filter needs normals and points.normals is "
                        "NULL",
                        caller, name_of(bias));
    if (map->exact_only && !(bias->needs & SHB_NEEDS_OCCLUDERS))
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs depths, and the map was created with "
                        "desc.exact_only",
                        caller, name_of(bias));
    if (!map_serves(map, bias))
        return shb_fail(context, SHB_ERROR_UNSUPPORTED,
                        "%s: the method \"%s\" needs a map that was drawn for it with the same "
                        "parameters",
                        caller, name_of(bias));
    if (bias->needs & SHB_NEEDS_OCCLUDERS)
        result = check_occluders(map, caller, bias, filter);
    return result || !filter ? result : check_prepared(map, caller, filter);
}

static bool are_aligned(const shb_points *points) {
    const uintptr_t addresses = (uintptr_t)points->positions | (uintptr_t)points->normals |
                                (uintptr_t)points->own.ids | (uintptr_t)points->own.weight_1 |
                                (uintptr_t)points->own.weight_2;
    return addresses % sizeof(float) == 0;
}

shb_result shb_points_check(const shb_context *context, const char *caller,
                            const shb_points *points) {
    if (points->count && !points->positions)
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.positions is NULL and points.count is %zu", caller,
                        points->count);
    if (!shb_is_triple_stride(points->position_stride) ||
        !shb_is_triple_stride(points->normal_stride))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.position_stride %zu or points.normal_stride %zu is no multiple "
                        "of 4 or below 12",
                        caller, points->position_stride, points->normal_stride);
    if (!are_aligned(points))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: points.positions, normals or an array of points.own is not aligned "
                        "to 4",
                        caller);
    if (shb_triples_overflow(points->count, points->position_stride) ||
        (points->normals && shb_triples_overflow(points->count, points->normal_stride)))
        return shb_fail(context, SHB_ERROR_SIZE,
                        "%s: points.count %zu times points.position_stride %zu or "
                        "points.normal_stride %zu overflows",
                        caller, points->count, points->position_stride, points->normal_stride);
    if (!points->own.weight_1 != !points->own.weight_2 ||
        (points->own.weight_1 && !points->own.ids))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "%s: of points.own.ids, weight_1 and weight_2 some are NULL that others "
                        "need",
                        caller);
    return SHB_OK;
}
