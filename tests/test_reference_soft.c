/* Errors of soft shadows over frames small enough to work them out by hand. */
#include "shadowbias/reference.h"

#include <math.h>

#include "test.h"

enum { SIDE = 8, FRAME = SIDE * SIDE };

static const double c = 1e-4, d = 9e-4;

static void fill(float *values, size_t count, float value) {
    for (size_t i = 0; i < count; i++)
        values[i] = value;
}

static shb_soft_errors measure(uint32_t width, uint32_t height, const float *truth,
                               const float *visibility, const uint8_t *mask) {
    shb_soft_errors errors = {0};
    CHECK_INT(shb_soft_errors_measure(width, height, truth, visibility, mask, &errors), SHB_OK);
    return errors;
}

TEST(equal_frames_have_no_soft_error) {
    float values[FRAME];
    for (int i = 0; i < FRAME; i++)
        values[i] = (float)((i * 37) % 64) / 64;
    const shb_soft_errors errors = measure(SIDE, SIDE, values, values, NULL);
    CHECK_INT(errors.fragments, FRAME);
    CHECK(errors.rms == 0 && errors.mean == 0 && errors.largest == 0);
    CHECK_NEAR(errors.similarity, 1, 1e-12);
}

/* One window without variance: (2 * 0.5 * 0.25 + c) / (0.25 + 0.0625 + c) * d / d. */
TEST(constant_frames_differ_by_their_means) {
    float truth[FRAME], visibility[FRAME];
    fill(truth, FRAME, 0.5f);
    fill(visibility, FRAME, 0.25f);
    const shb_soft_errors errors = measure(SIDE, SIDE, truth, visibility, NULL);
    CHECK_NEAR(errors.rms, 0.25, 1e-12);
    CHECK_NEAR(errors.mean, 0.25, 1e-12);
    CHECK_NEAR(errors.largest, 0.25, 0);
    CHECK_NEAR(errors.similarity, (0.25 + c) / (0.3125 + c), 1e-12);
}

/* Half of the pixels 1, half 0, and the other way round: means 1/2, variances 1/4, covariance
 * -1/4. */
TEST(opposite_frames_are_least_similar) {
    float truth[FRAME], visibility[FRAME];
    for (int i = 0; i < FRAME; i++) {
        truth[i] = (float)(i % 2);
        visibility[i] = 1 - truth[i];
    }
    const shb_soft_errors errors = measure(SIDE, SIDE, truth, visibility, NULL);
    CHECK_NEAR(errors.rms, 1, 1e-12);
    CHECK_NEAR(errors.similarity, (-0.5 + d) / (0.5 + d), 1e-12);
}

/* Errors of 3/4 and 1/4 over 16 pixels: mean 1/16, squares 9/16 + 1/16 of 16: 5/128. */
TEST(few_large_errors_weigh_more_in_rms_than_in_the_mean) {
    float truth[16] = {0}, visibility[16] = {0};
    visibility[3] = 0.75f;
    truth[9] = 0.25f;
    const shb_soft_errors errors = measure(4, 4, truth, visibility, NULL);
    CHECK_INT(errors.fragments, 16);
    CHECK_NEAR(errors.mean, 1.0 / 16, 1e-12);
    CHECK_NEAR(errors.rms, sqrt(5.0 / 128), 1e-12);
    CHECK_NEAR(errors.largest, 0.75, 0);
}

/* A frame of 9 x 8 has two windows. Column 0 is false: in the first window the mean is 1/8 against
 * 0 and the variance 1/8 - 1/64 = 7/64; the second one is right. */
TEST(similarity_is_the_mean_of_all_windows) {
    float truth[72], visibility[72];
    fill(truth, 72, 0);
    for (int i = 0; i < 72; i++)
        visibility[i] = i % 9 == 0 ? 1.0f : 0.0f;
    const double first = c * d / ((1.0 / 64 + c) * (7.0 / 64 + d));
    CHECK_NEAR(measure(9, 8, truth, visibility, NULL).similarity, (first + 1) / 2, 1e-12);
    /* The same on its side: a false row. */
    for (int i = 0; i < 72; i++)
        visibility[i] = i < 8 ? 1.0f : 0.0f;
    CHECK_NEAR(measure(8, 9, truth, visibility, NULL).similarity, (first + 1) / 2, 1e-12);
}

/* As above with pixels left out: of the first window the columns 0 and 1 remain (16 pixels, mean
 * 1/2, variance 1/4), of the second one column 1 (8 pixels, right). */
TEST(pixels_outside_the_mask_are_not_read) {
    float truth[72], visibility[72];
    uint8_t mask[72];
    for (int i = 0; i < 72; i++) {
        mask[i] = i % 9 < 2;
        truth[i] = mask[i] ? 0 : NAN;
        visibility[i] = mask[i] ? (i % 9 == 0) : INFINITY;
    }
    const shb_soft_errors errors = measure(9, 8, truth, visibility, mask);
    const double first = c * d / ((0.25 + c) * (0.25 + d));
    CHECK_INT(errors.fragments, 16);
    CHECK_NEAR(errors.mean, 0.5, 1e-12);
    CHECK_NEAR(errors.rms, sqrt(0.5), 1e-12);
    CHECK_NEAR(errors.similarity, (16 * first + 8) / 24, 1e-12);
}

TEST(frames_smaller_than_a_window_are_one_window) {
    const float truth[2] = {1, 0}, visibility[2] = {0.5f, 0.5f};
    const shb_soft_errors errors = measure(2, 1, truth, visibility, NULL);
    /* equal means, variances 1/4 and 0, no covariance */
    CHECK_NEAR(errors.similarity, d / (0.25 + d), 1e-12);
    const uint8_t nothing[2] = {0, 0};
    const shb_soft_errors none = measure(2, 1, truth, visibility, nothing);
    CHECK(none.fragments == 0 && none.rms == 0 && none.mean == 0 && none.similarity == 1);
}

TEST(soft_errors_refuse_bad_arguments) {
    const float good = 1, bad = NAN;
    shb_soft_errors errors = {.fragments = 9};
    CHECK_INT(shb_soft_errors_measure(1, 1, NULL, &good, NULL, &errors), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_soft_errors_measure(1, 1, &good, NULL, NULL, &errors), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_soft_errors_measure(1, 1, &good, &good, NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_soft_errors_measure(0, 1, &good, &good, NULL, &errors), SHB_ERROR_SIZE);
    CHECK_INT(shb_soft_errors_measure(1, 0, &good, &good, NULL, &errors), SHB_ERROR_SIZE);
    CHECK_INT(shb_soft_errors_measure(1, 1, &good, &bad, NULL, &errors), SHB_ERROR_NUMBER);
    CHECK_INT(shb_soft_errors_measure(1, 1, &bad, &good, NULL, &errors), SHB_ERROR_NUMBER);
    CHECK_INT(errors.fragments, 9);
}
