/* Counting what a method got wrong. */
#include "../strict.h"

#include "shadowbias/reference.h"

static double per_million(uint64_t part, uint64_t whole) {
    return whole ? 1e6 * (double)part / (double)whole : 0;
}

static void count_fragment(shb_errors *errors, uint8_t truth, float visibility) {
    const bool boundary = truth & SHB_TRUTH_BOUNDARY;
    const bool seen_shadowed = visibility < 0.5f;
    if (truth & SHB_TRUTH_LIT) {
        errors->lit++;
        errors->false_shadow += seen_shadowed && !boundary;
        errors->boundary_shadow += seen_shadowed && boundary;
    } else if (truth & SHB_TRUTH_SHADOWED) {
        errors->shadowed++;
        errors->false_light += !seen_shadowed && !boundary;
        errors->boundary_light += !seen_shadowed && boundary;
    }
}

shb_result shb_errors_measure(size_t count, const uint8_t *truth, const float *visibility,
                              shb_errors *errors) {
    if (!errors || (count && (!truth || !visibility)))
        return SHB_ERROR_ARGUMENT;
    shb_errors counted = {0};
    for (size_t i = 0; i < count; i++)
        count_fragment(&counted, truth[i], visibility[i]);
    const uint64_t fragments = counted.lit + counted.shadowed;
    const uint64_t boundary = counted.boundary_shadow + counted.boundary_light;
    counted.false_shadow_ppm = per_million(counted.false_shadow, counted.lit);
    counted.false_light_ppm = per_million(counted.false_light, counted.shadowed);
    counted.boundary_ppm = per_million(boundary, fragments);
    counted.wrong = counted.false_shadow + counted.false_light + boundary;
    counted.wrong_ppm = per_million(counted.wrong, fragments);
    *errors = counted;
    return SHB_OK;
}
