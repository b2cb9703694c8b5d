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

#include "moment_soft.h"

#include <math.h>

#include "project.h"

enum { SIZE };

/* Of k; moments are off by a few units of 2^-24. */
#define ROUNDING 0x1p-19f

static float weight(float z, float s, float d) {
    const float off = (z - s) * z - 1;
    return d / (d * (1 + z * z) + off * off);
}

/* The part of a distribution that lies below u, and the sum of what lies there. */
typedef struct lower_part {
    float weight, sum;
} lower_part;

static lower_part add_below(lower_part below, float z, float u, float s, float d) {
    const float part = z < u ? weight(z, s, d) : 0;
    return (lower_part){below.weight + part, below.sum + (z < u ? part * z : 0)};
}

/* The least part of a distribution of skewness s that lies below u. With s = 0 there is none below
 * u <= -1, which is where a plane's receiver is that lies nearer by the plane's own deviation. */
static lower_part least_below(float u, float s, float d) {
    const float q = (u - s) * u - 1;
    const float b = d * u - s * q, c = d - q;
    const float square = b * b - 4 * q * c;
    const float root = sqrtf(square > 0 ? square : 0);
    const float sum = -0.5f * (b + (b < 0 ? -root : root));
    const lower_part first = add_below((lower_part){0, 0}, sum / q, u, s, d);
    return add_below(first, c / sum, u, s, d);
}

static void judge(const shb_moment_question *question, shb_moment_answer *answer) {
    const shb_distance_batch *receiver = question->receiver;
    const shb_moment_batch *box = question->images;
    for (size_t i = 0; i < shb_round_to_lanes(question->count); i++) {
        const float error = receiver->error[i], noise = error * error;
        const float mean = box->at[0][i], variance = box->at[1][i];
        const float fourth = box->at[3][i] + noise * (6 * variance + 3 * noise);
        const float deviation = sqrtf(variance + noise), scale = 1 / deviation;
        const float s = box->at[2][i] * scale * scale * scale;
        const float k = fourth * scale * scale * scale * scale;
        const float rest = (k - 1) - s * s, least = ROUNDING * k;
        const float u = ((receiver->at[i] - mean) - error) * scale;
        const lower_part below = least_below(u, s, rest > least ? rest : least);
        const float lit = 1 - below.weight;
        answer->lit[i] = lit > 0 ? lit : 0;
        answer->blocker[i] = mean + deviation * (below.sum / below.weight);
    }
}

static void moments(const shb_filter_args *args) {
    shb_moment_map_visibility(args, judge, false, 0);
}

static void moments_soft(const shb_filter_args *args) {
    shb_moment_soft_visibility(args, judge, 0);
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

static shb_result prepare_soft(const shb_map *map, const shb_filter *filter, void **prepared,
                               size_t *bytes) {
    const shb_moment_soft plan = {.image_count = 1, .images = {{.count = 4}}};
    return shb_moment_soft_prepare(map, filter, &plan, prepared, bytes);
}

shb_filter shb_filter_moments_soft(float light_size) {
    return (shb_filter){.name = "moments-soft",
                        .filter = moments_soft,
                        .prepare = prepare_soft,
                        .release = shb_moment_soft_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size}};
}
