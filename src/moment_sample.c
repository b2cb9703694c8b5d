/* Moments between texels: two distributions mixed, along x and then along y. */
#include "strict.h"

#include "moments.h"
#include "project.h"

static int32_t clamped(int32_t texel, uint32_t size) {
    const int32_t last = (int32_t)size - 1;
    const int32_t at_least = texel > 0 ? texel : 0;
    return at_least < last ? at_least : last;
}

/* The centre of the fragment's own texel lies before or behind it. */
static void read_corners(const shb_moment_image *image, const shb_receivers *r, size_t lanes,
                         shb_moment_corners *out) {
    const size_t count = (size_t)image->count;
    for (size_t i = 0; i < lanes; i++) {
        const float to_x = r->to_center_x[i], to_y = r->to_center_y[i];
        const int32_t column = clamped(r->texel_x[i], image->width - 2) + (to_x > 0 ? 0 : 1);
        const int32_t row = clamped(r->texel_y[i], image->height - 2) + (to_y > 0 ? 0 : 1);
        const float *first = image->texels + ((size_t)row * image->width + (size_t)column) * count;
        const float *below = first + image->width * count;
        for (size_t m = 0; m < count; m++) {
            out->at[0].at[m][i] = first[m];
            out->at[1].at[m][i] = first[m + count];
            out->at[2].at[m][i] = below[m];
            out->at[3].at[m][i] = below[m + count];
        }
        out->x[i] = to_x > 0 ? 1 - to_x : 0 - to_x;
        out->y[i] = to_y > 0 ? 1 - to_y : 0 - to_y;
    }
}

/* With e = f (1 - f) and d between the means, what the moments about the common mean add up to
 * beyond the mixed ones is
 *     variance   e d^2
 *     third      3 e d (variance_b - variance_a) + e (1 - 2 f) d^3
 *     fourth     4 e d (third_b - third_a) + 6 e d^2 (f variance_a + (1 - f) variance_b)
 *                + e (1 - 3 e) d^4 */
void shb_moment_mix(int count, size_t lanes, const float *restrict f, shb_moment_batch *restrict a,
                    const shb_moment_batch *restrict b) {
    for (size_t i = 0; i < lanes; i++) {
        const float e = f[i] * (1 - f[i]), d = b->at[0][i] - a->at[0][i], ed = e * d, d2 = d * d;
        const float mean = a->at[0][i] + f[i] * d;
        const float variance_a = a->at[1][i], variance_b = b->at[1][i];
        if (count == 4) {
            const float third_a = a->at[2][i], third_b = b->at[2][i], fourth_a = a->at[3][i];
            const float crossed = f[i] * variance_a + (1 - f[i]) * variance_b;
            a->at[2][i] = third_a + f[i] * (third_b - third_a) +
                          ed * (3 * (variance_b - variance_a) + (1 - 2 * f[i]) * d2);
            a->at[3][i] = fourth_a + f[i] * (b->at[3][i] - fourth_a) +
                          ed * (4 * (third_b - third_a) + d * (6 * crossed + (1 - 3 * e) * d2));
        }
        a->at[0][i] = mean;
        a->at[1][i] = variance_a + f[i] * (variance_b - variance_a) + ed * d;
    }
}

void shb_moment_mix_corners(int count, size_t lanes, shb_moment_corners *corners) {
    shb_moment_mix(count, lanes, corners->x, &corners->at[0], &corners->at[1]);
    shb_moment_mix(count, lanes, corners->x, &corners->at[2], &corners->at[3]);
    shb_moment_mix(count, lanes, corners->y, &corners->at[0], &corners->at[2]);
}

void shb_moment_image_sample(const shb_moment_image *image, const shb_receivers *receivers,
                             size_t count, shb_moment_batch *moments) {
    const size_t lanes = shb_round_to_lanes(count);
    shb_moment_corners read;
    read_corners(image, receivers, lanes, &read);
    shb_moment_mix_corners(image->count, lanes, &read);
    *moments = read.at[0];
}
