/* Moment shadow maps: Peters and Klein 2015, Hamburger's problem for four moments.
 *
 * Of all distributions with the given mean, variance, third and fourth moment, the one that has the
 * least below t is known (their algorithm 3): it sits on three points, t and the two roots of
 *     c0 + c1 z + c2 z^2 = 0   where   B c = (1, t, t^2),   B = (1 m1 m2; m1 m2 m3; m2 m3 m4).
 * With distances counted from the mean in standard deviations, u for t, m1 = 0, m2 = 1 and, s and k
 * being skewness and kurtosis, Cholesky's B = L diag(1, 1, D) L^T has D = k - 1 - s^2, and
 *     c2 = q / D,  c1 = u - s c2,  c0 = 1 - c2   where   q = u^2 - s u - 1.
 * The weight of a point z is 1 / (1 + z^2 + (z^2 - s z - 1)^2 / D). D is 0 where the box holds one
 * or two distances only, and these are then the roots.
 *
 * The paper's moment bias is what the depths' error e does to the moments: independent noise of
 * this deviation adds e^2 to the variance and 6 variance e^2 + 3 e^4 to the fourth moment. Rounding
 * of the moments themselves moves D by some units of k. */
#include "strict.h"

#include "moment_map.h"

#include <math.h>

enum { SIZE };

/* The receiver is taken nearer by the deviation of its own plane, so that a plane that is all in
 * the light has nothing below it: with s = 0 no weight lies below u <= -1. */
#define SPREAD 1.0f

/* Of k; moments are off by a few units of 2^-24. */
#define ROUNDING 0x1p-19f

static float weight(float z, float s, float d) {
    const float off = (z - s) * z - 1;
    return d / (d * (1 + z * z) + off * off);
}

/* The least part of a distribution of skewness s that lies below u. */
static float least_below(float u, float s, float d) {
    const float q = (u - s) * u - 1;
    const float b = d * u - s * q, c = d - q;
    const float square = b * b - 4 * q * c;
    const float root = sqrtf(square > 0 ? square : 0);
    const float sum = -0.5f * (b + (b < 0 ? -root : root));
    const float first = sum / q, second = c / sum;
    const float below = first < u ? weight(first, s, d) : 0;
    return below + (second < u ? weight(second, s, d) : 0);
}

static float lit_part(float t, float error, float mean, float variance, float third, float fourth) {
    const float noise = error * error;
    const float total = variance + noise;
    const float all_fourth = fourth + noise * (6 * variance + 3 * noise);
    const float scale = 1 / sqrtf(total);
    const float s = third * scale * scale * scale;
    const float k = all_fourth * scale * scale * scale * scale;
    const float rest = (k - 1) - s * s, least = ROUNDING * k;
    const float u = ((t - mean) - error) * scale;
    const float lit = 1 - least_below(u, s, rest > least ? rest : least);
    return lit > 0 ? lit : 0;
}

static void moments(const shb_filter_args *args) {
    const shb_moment_map *prepared = args->prepared;
    shb_distance_batch receiver;
    shb_moment_batch box;
    shb_moment_receivers(prepared, args->receivers, SPREAD, args->count, &receiver);
    shb_moment_image_sample(&prepared->images[0], args->receivers, args->count, &box);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = lit_part(receiver.at[i], receiver.error[i], box.at[0][i],
                                       box.at[1][i], box.at[2][i], box.at[3][i]);
    shb_light_outside(args);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    const shb_result result = shb_filter_check_size(map, filter, filter->params[SIZE]);
    if (result != SHB_OK)
        return result;
    const shb_moment_map plan = {
        .size = (int)filter->params[SIZE], .image_count = 1, .images = {{.count = 4}}};
    return shb_moment_map_prepare(map, filter->name, &plan, prepared, bytes);
}

shb_filter shb_filter_moments(int size) {
    return (shb_filter){.name = "moments",
                        .filter = moments,
                        .prepare = prepare,
                        .release = shb_moment_map_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {(float)size}};
}
