#include "strict.h"

#include "moment_map.h"

#include "filter_check.h"
#include "kernels/moments.h"
#include "method_text.h"

shb_result shb_filter_check_size(const shb_map *map, const shb_filter *filter, float size) {
    const shb_result result =
        shb_filter_check_param(map, filter, "size", size, 1, SHB_MOMENT_SIZE_MAX);
    if (result != SHB_OK || size == (float)((int)size | 1))
        return result;
    return shb_fail(map->context, SHB_ERROR_ARGUMENT,
                    "shb_map_prepare: size %g of the filter \"%s\" is not odd", (double)size,
                    shb_method_name(filter->name));
}

/* NULL: no memory. */
static shb_moment_map *create(const shb_map *map, const shb_moment_map *plan) {
    shb_moment_map *made = shb_alloc(map->context, 1, sizeof *made);
    if (!made)
        return NULL;
    *made = *plan;
    for (int i = 0; i < plan->image_count; i++)
        if (!shb_moment_image_create(map, &made->images[i])) {
            shb_moment_map_release(map, made);
            return NULL;
        }
    return made;
}

shb_result shb_moment_map_prepare(const shb_map *map, const shb_filter *filter,
                                  const shb_moment_map *plan, void **prepared, size_t *bytes) {
    shb_moment_map *made = *prepared ? *prepared : create(map, plan);
    if (!made)
        return shb_filter_no_memory(map, filter);
    size_t made_bytes = sizeof *made;
    made->distance = shb_distance_of(map);
    for (int i = 0; i < plan->image_count; i++) {
        shb_moment_image_fill(map, &made->distance, plan->size, &made->images[i]);
        made_bytes += shb_moment_image_bytes(&made->images[i]);
    }
    *prepared = made;
    *bytes = made_bytes;
    return SHB_OK;
}

void shb_moment_map_release(const shb_map *map, void *prepared) {
    shb_moment_map *moments = prepared;
    for (int i = 0; i < moments->image_count; i++)
        shb_moment_image_destroy(map, &moments->images[i]);
    shb_free(map->context, moments);
}

/* What lies below bleeding becomes 0, and the rest spans 0 .. 1 again (Lauritzen 2007). */
static float less_bleeding(float lit, float bleeding) {
    return lit > bleeding ? (lit - bleeding) / (1 - bleeding) : 0;
}

void shb_moment_finish(const shb_filter_args *args, float bleeding, const float *lit) {
    const shb_receivers *r = args->receivers;
    const uint32_t width = args->info->width, height = args->info->height;
    for (size_t i = 0; i < args->count; i++) {
        const bool inside = ((uint32_t)r->texel_x[i] < width) & ((uint32_t)r->texel_y[i] < height);
        args->visibility[i] = inside ? less_bleeding(lit[i], bleeding) : 1;
    }
}

/* Mixing between two texels adds a quarter at most to the square of the boxes' width less a
 * quarter. */
static void fill_widths(const shb_moment_map *moments, bool steady, float *square_widths) {
    const float side = (float)moments->size;
    for (size_t i = 0; i < SHB_BATCH; i++)
        square_widths[i] = steady ? 0 : side * side + 2;
}

void shb_moment_map_visibility(const shb_filter_args *args, shb_moment_judge *judge, bool steady,
                               float bleeding) {
    const shb_moment_map *moments = args->prepared;
    const shb_moment_kernels *kernels = shb_moment_kernels_in(args);
    SHB_ALIGN float square_widths[SHB_BATCH];
    shb_distance_batch receiver;
    shb_moment_batch images[SHB_MOMENT_IMAGES_MAX];
    shb_moment_answer answer;
    fill_widths(moments, steady, square_widths);
    kernels->receivers(&moments->distance, args->count, args->receivers, square_widths, &receiver);
    float exponents[SHB_MOMENT_IMAGES_MAX];
    for (int i = 0; i < moments->image_count; i++) {
        exponents[i] = moments->images[i].exponent;
        kernels->sample_image(&moments->images[i], args->count, args->receivers, &images[i]);
    }
    const shb_moment_question question = {args->count, exponents, &receiver, images};
    judge(&question, &answer);
    shb_moment_finish(args, bleeding, answer.lit);
}
