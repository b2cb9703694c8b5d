#include "judge.h"

#include <math.h>

shb_result report_judge_hard(const measure_frame *frame, const uint8_t *truth, report_row *row) {
    shb_errors errors;
    const shb_result result =
        shb_errors_measure(frame->fragment_count, truth, frame->visibility, &errors);
    if (result)
        return result;
    row->fragments = errors.lit + errors.shadowed;
    row->false_shadow_ppm = errors.false_shadow_ppm;
    row->false_light_ppm = errors.false_light_ppm;
    row->boundary_ppm = errors.boundary_ppm;
    row->wrong_ppm = errors.wrong_ppm;
    row->rms = row->ssim = (double)NAN;
    return SHB_OK;
}

/* Light that is missing or too much, and the fragments of its kind. */
typedef struct light_sums {
    double lit, dark, penumbra;
    size_t lit_count, dark_count, count;
} light_sums;

static void add_pixel(light_sums *sums, double truth, double seen) {
    const double error = fabs(seen - truth);
    if (truth >= 1) {
        sums->lit += error;
        sums->lit_count++;
    } else if (truth <= 0) {
        sums->dark += error;
        sums->dark_count++;
    } else
        sums->penumbra += error;
    sums->count++;
}

static double ppm(double sum, size_t count) {
    return count ? 1e6 * sum / (double)count : 0;
}

shb_result report_judge_soft(const measure_frame *frame, const soft_truth *truth, report_row *row) {
    shb_soft_errors errors;
    const shb_result result = soft_truth_compare(frame, truth, &errors);
    if (result)
        return result;
    light_sums sums = {0};
    for (size_t i = 0; i < frame->fragment_count; i++) {
        const size_t pixel = frame->pixels[i];
        if (truth->mask[pixel])
            add_pixel(&sums, (double)truth->visibility[pixel], (double)truth->seen[pixel]);
    }
    row->fragments = errors.fragments;
    row->false_shadow_ppm = ppm(sums.lit, sums.lit_count);
    row->false_light_ppm = ppm(sums.dark, sums.dark_count);
    row->boundary_ppm = ppm(sums.penumbra, sums.count);
    row->wrong_ppm = ppm(sums.lit + sums.dark + sums.penumbra, sums.count);
    row->rms = errors.rms;
    row->ssim = errors.similarity;
    return SHB_OK;
}
