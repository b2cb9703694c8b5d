#include "starved.h"

#include "allocator.h"
#include "test.h"

static shb_result draw(const shb_map_desc *desc, const shb_scene *scene, size_t fail_at) {
    test_allocator state = {.fail_at = fail_at};
    const shb_context_desc context_desc = {.threads = 1, .allocator = test_allocator_hooks(&state)};
    shb_context *context = NULL;
    shb_map *map = NULL;
    shb_result result = shb_context_create(&context_desc, &context);
    if (!result)
        result = shb_map_create(context, desc, &map);
    if (!result)
        result = shb_map_draw(map, scene, NULL, NULL);
    shb_map_destroy(map);
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
    return result;
}

size_t test_starve_map(const shb_map_desc *desc, const shb_scene *scene) {
    size_t fail_at = 1;
    shb_result result = draw(desc, scene, fail_at);
    while (result == SHB_ERROR_MEMORY && fail_at < 1000)
        result = draw(desc, scene, ++fail_at);
    CHECK_INT(result, SHB_OK);
    return fail_at - 1;
}
