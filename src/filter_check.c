#include "filter_check.h"

#include "map.h"
#include "method_text.h"

shb_result shb_filter_check_param(const shb_map *map, const shb_filter *filter, const char *param,
                                  float value, float lo, float hi) {
    if (value >= lo && value <= hi)
        return SHB_OK;
    return shb_fail(map->context, SHB_ERROR_ARGUMENT,
                    "shb_map_prepare: %s %g of the filter \"%s\" is not in %g .. %g", param,
                    (double)value, shb_method_name(filter->name), (double)lo, (double)hi);
}

shb_result shb_filter_no_memory(const shb_map *map, const shb_filter *filter) {
    return shb_fail(map->context, SHB_ERROR_MEMORY,
                    "shb_map_prepare: no memory for the filter \"%s\" over %u by %u texels",
                    shb_method_name(filter->name), (unsigned)map->info.width,
                    (unsigned)map->info.height);
}
