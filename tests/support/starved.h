/* Uses of the library while memory ends. */
#ifndef TESTS_SUPPORT_STARVED_H
#define TESTS_SUPPORT_STARVED_H

#include "shadowbias/map.h"

/* Creates a context and a map and draws it, again and again, with memory ending at the first
 * allocation, the second and so on, until all of it succeeds. Checks that it ends in a lack of
 * memory every time before and that nothing leaks. Returns the number of allocations. */
size_t test_starve_map(const shb_map_desc *desc, const shb_scene *scene);

#endif
