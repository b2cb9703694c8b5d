#include "depth_map.h"

#include "../../src/kernels/shade.h"
#include "test.h"

#include <stdlib.h>

depth_map depth_map_open(const shb_context_desc *context, const shb_map_desc *desc,
                         const float *depths) {
    const bool reversed = desc->view.reversed;
    const size_t width = desc->width, height = desc->height ? desc->height : width;
    const size_t row_bytes = width * shb_format_size(desc->format);
    float *canonical = malloc(width * sizeof *canonical);
    depth_map opened = {.texels = malloc(height * row_bytes)};
    for (size_t y = 0; y < height; y++) {
        for (size_t x = 0; x < width; x++)
            canonical[x] = depths[y * width + x] - (reversed ? 1 : 0);
        shb_shade_kernels_scalar.store(desc->format, reversed, width, canonical,
                                       (char *)opened.texels + y * row_bytes);
    }
    free(canonical);
    CHECK_INT(shb_context_create(context, &opened.context), SHB_OK);
    CHECK_INT(shb_map_wrap(opened.context, desc, opened.texels, 0, NULL, &opened.map), SHB_OK);
    return opened;
}

depth_map depth_map_open_lit(shb_isa isa, bool spot, bool reversed, shb_map_desc desc,
                             const float *depths) {
    const shb_context_desc context = {.max_isa = isa, .threads = 1};
    const shb_box box = {{-1, -1, -1}, {1, 1, 1}};
    const shb_vec3 light = {3, 4, 2};
    desc.scene_scale = 3;
    CHECK_INT(spot ? shb_view_fit_spot(light, box, desc.width, reversed, &desc.view)
                   : shb_view_fit_directional(light, box, desc.width, reversed, &desc.view),
              SHB_OK);
    return depth_map_open(&context, &desc, depths);
}

void depth_map_close(depth_map *opened) {
    shb_map_destroy(opened->map);
    shb_context_destroy(opened->context);
    free(opened->texels);
}

void depth_map_prepare(const depth_map *asked, const shb_filter *filter) {
    CHECK_INT(shb_map_prepare(asked->map, filter), SHB_OK);
}

double depth_map_ask(const depth_map *asked, const shb_filter *filter, double x, double y,
                     double z) {
    const float position[3] = {(float)x, (float)y, (float)z};
    const shb_points points = {.count = 1, .positions = position};
    const shb_bias none = shb_bias_none();
    float visibility = -7;
    CHECK_INT(shb_map_visibility(asked->map, &points, &none, filter, &visibility), SHB_OK);
    return (double)visibility;
}
