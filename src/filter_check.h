/* What keeps a filter from being prepared; failures are logged in the name of shb_map_prepare. */
#ifndef SRC_FILTER_CHECK_H
#define SRC_FILTER_CHECK_H

#include "shadowbias/filter.h"

/* SHB_ERROR_MEMORY with its sentence. */
shb_result shb_filter_no_memory(const shb_map *map, const shb_filter *filter);

/* SHB_ERROR_ARGUMENT unless a parameter of the filter lies within lo .. hi. */
shb_result shb_filter_check_param(const shb_map *map, const shb_filter *filter, const char *param,
                                  float value, float lo, float hi);

#endif
