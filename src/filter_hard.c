/* One tap: Williams, Casting curved shadows on curved surfaces, 1978. */
#include "strict.h"

#include "exact.h"
#include "kernels/shade.h"
#include "stages.h"

void shb_hard_test(const shb_filter_args *args) {
    args->map->context->shade_kernels->hard(args->map, args->count, args->receivers,
                                            args->visibility);
}

shb_filter shb_filter_hard(void) {
    return (shb_filter){.name = "hard", .filter = shb_hard_test, .exact = shb_exact_visibility};
}
