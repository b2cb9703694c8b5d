/* Boxes of texels along rows and then along columns, mixed as moments.h says. */

static void warp(const shb_distance *distance, float exponent, size_t count,
                 float *restrict values) {
    for (size_t i = 0; i < count; i++)
        values[i] = shb_distance_at(distance, values[i]);
    for (size_t i = 0; i < count && exponent != 0; i++)
        values[i] = shb_moment_warp(exponent, values[i]);
}

/* The mean of size neighbours each, taken from the middle one on so that equal values give
 * themselves, and their moments about it. */
static inline ALWAYS_INLINE void mix_row(bool four, int size, size_t count,
                                         const float *restrict values, shb_moment_row *out) {
    float mean[SHB_MOMENT_SPAN] = {0}, variance[SHB_MOMENT_SPAN] = {0};
    float third[SHB_MOMENT_SPAN] = {0}, fourth[SHB_MOMENT_SPAN] = {0};
    const float parts = (float)size;
    const float *middle = values + size / 2;
    for (int k = 0; k < size; k++)
        for (size_t i = 0; i < count; i++)
            mean[i] += values[i + (size_t)k] - middle[i];
    for (size_t i = 0; i < count; i++)
        mean[i] = middle[i] + mean[i] / parts;
    for (int k = 0; k < size; k++)
        for (size_t i = 0; i < count; i++) {
            const float d = values[i + (size_t)k] - mean[i], d2 = d * d;
            variance[i] += d2;
            if (four) {
                third[i] += d2 * d;
                fourth[i] += d2 * d2;
            }
        }
    for (size_t i = 0; i < count; i++) {
        out[0][i] = mean[i];
        out[1][i] = variance[i] / parts;
    }
    for (size_t i = 0; i < count && four; i++) {
        out[2][i] = third[i] / parts;
        out[3][i] = fourth[i] / parts;
    }
}

static void mix_neighbours(int moments, int size, size_t count, const float *values,
                           shb_moment_row *out) {
    if (moments == 4)
        mix_row(true, size, count, values, out);
    else
        mix_row(false, size, count, values, out);
}

/* The mean of all means, as along rows. */
static void mix_means(int size, size_t count, const shb_moment_row *const *rows,
                      float *restrict mean) {
    const float *middle = rows[size / 2][0];
    for (size_t i = 0; i < count; i++)
        mean[i] = 0;
    for (int k = 0; k < size; k++) {
        const float *part = rows[k][0];
        for (size_t i = 0; i < count; i++)
            mean[i] += part[i] - middle[i];
    }
    for (size_t i = 0; i < count; i++)
        mean[i] = middle[i] + mean[i] / (float)size;
}

static void mix_variances(int size, size_t count, const shb_moment_row *const *rows,
                          const float *restrict mean, float *restrict variance) {
    for (size_t i = 0; i < count; i++)
        variance[i] = 0;
    for (int k = 0; k < size; k++) {
        const float *means = rows[k][0], *variances = rows[k][1];
        for (size_t i = 0; i < count; i++) {
            const float d = means[i] - mean[i];
            variance[i] += variances[i] + d * d;
        }
    }
    for (size_t i = 0; i < count; i++)
        variance[i] /= (float)size;
}

/* With d from the common mean to the part's: E(x + d)^3 = third + 3 variance d + d^3, and E(x +
 * d)^4 = fourth + 4 third d + 6 variance d^2 + d^4. */
static void mix_higher(int size, size_t count, const shb_moment_row *const *rows,
                       const float *restrict mean, float *restrict third, float *restrict fourth) {
    for (size_t i = 0; i < count; i++)
        third[i] = fourth[i] = 0;
    for (int k = 0; k < size; k++) {
        const float *means = rows[k][0], *variances = rows[k][1];
        const float *thirds = rows[k][2], *fourths = rows[k][3];
        for (size_t i = 0; i < count; i++) {
            const float d = means[i] - mean[i], d2 = d * d;
            third[i] += thirds[i] + d * (3 * variances[i] + d2);
            fourth[i] += fourths[i] + 4 * d * thirds[i] + d2 * (6 * variances[i] + d2);
        }
    }
    for (size_t i = 0; i < count; i++) {
        third[i] /= (float)size;
        fourth[i] /= (float)size;
    }
}

static void mix_rows(int moments, int size, size_t count, const shb_moment_row *const *rows,
                     float *texels) {
    SHB_ALIGN float mixed[SHB_MOMENTS_MAX][SHB_MOMENT_SPAN];
    mix_means(size, count, rows, mixed[0]);
    mix_variances(size, count, rows, mixed[0], mixed[1]);
    if (moments == 4)
        mix_higher(size, count, rows, mixed[0], mixed[2], mixed[3]);
    for (size_t i = 0; i < count; i++)
        for (int m = 0; m < moments; m++)
            texels[i * (size_t)moments + (size_t)m] = mixed[m][i];
}
