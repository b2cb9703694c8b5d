/* What lies before the receiver in a distribution, from its moments. */

/* A plane over a kernel of the square width n^2 has the variance n^2 / 12 of its square step on
 * each axis. */
static void place_receivers(const shb_distance *distance, size_t count,
                            const shb_receivers *restrict r, const float *restrict square_widths,
                            shb_distance_batch *restrict out) {
    const size_t lanes = shb_round_to_lanes(count);
    for (size_t i = 0; i < lanes; i++) {
        const float step_x = r->step_x[i], step_y = r->step_y[i];
        const float run = step_x * r->to_center_x[i] + step_y * r->to_center_y[i];
        const float deviation =
            sqrtf((step_x * step_x + step_y * step_y) * (square_widths[i] / 12));
        const float depth = (r->ref[i] - run) - deviation;
        out->at[i] = shb_distance_at(distance, depth);
        out->error[i] = shb_distance_error(distance, depth);
    }
}

/* ---- variance ---- */

/* An upper bound of the part of a distribution that lies at or beyond t, from its mean and
 * variance: Chebyshev's inequality on one side. 1 where t is NaN. */
static inline float chebyshev(float t, float mean, float variance) {
    const float d = t - mean;
    const float part = variance / (variance + d * d);
    return d > 0 ? part : 1;
}

/* The mean of what lies below t in a distribution that meets that bound: all of the rest lies at
 * mean - variance / d. */
static inline float chebyshev_below(float t, float mean, float variance) {
    return mean - variance / (t - mean);
}

static void judge_variance(const shb_moment_question *question, shb_moment_answer *restrict out) {
    const shb_distance_batch *receiver = question->receiver;
    const shb_moment_batch *box = question->images;
    const size_t lanes = shb_round_to_lanes(question->count);
    for (size_t i = 0; i < lanes; i++) {
        const float t = receiver->at[i], mean = box->at[0][i];
        const float variance = box->at[1][i] + receiver->error[i] * receiver->error[i];
        out->lit[i] = chebyshev(t, mean, variance);
        out->blocker[i] = chebyshev_below(t, mean, variance);
    }
}

/* ---- exponentials ---- */

static inline float magnitude(float value) {
    return value < 0 ? -value : value;
}

/* The distance whose exponential this is; limited to 0 .. at. */
static inline float unwarped(float exponent, float largest, float warped, float at) {
    const float least = 1 / largest;
    const float at_most = warped < largest ? warped : largest;
    const float inside = warped > least ? at_most : least;
    const float distance = 0.5f + shb_logarithm(inside) / exponent;
    return distance < at ? distance : at;
}

/* Takes the bound of one image where it is the smaller one. Distances are scaled to the larger of
 * mean and receiver, whose squares may leave the range of floats. */
static void judge_exponential(const shb_moment_question *question, const shb_moment_batch *box,
                              float exponent, shb_moment_answer *restrict out) {
    const shb_distance_batch *receiver = question->receiver;
    const size_t lanes = shb_round_to_lanes(question->count);
    const float sign = exponent > 0 ? 1 : -1; /* of shb_moment_warp */
    const float end = shb_exponential(magnitude(exponent) / 2);
    for (size_t i = 0; i < lanes; i++) {
        const float at = receiver->at[i];
        const float t = sign * shb_exponential(exponent * (at - 0.5f)), mean = box->at[0][i];
        const float largest = magnitude(t) > magnitude(mean) ? magnitude(t) : magnitude(mean);
        const float scale = 1 / largest;
        const float error = exponent * receiver->error[i] * (t * scale);
        const float variance = box->at[1][i] * scale * scale + error * error;
        const float part = chebyshev(t * scale, mean * scale, variance);
        const float below = chebyshev_below(t * scale, mean * scale, variance) * largest;
        const float blocker = unwarped(exponent, end, sign * below, at);
        out->blocker[i] = part < out->lit[i] ? blocker : out->blocker[i];
        out->lit[i] = part < out->lit[i] ? part : out->lit[i];
    }
}

static void judge_exponentials(const shb_moment_question *question, shb_moment_answer *out) {
    for (size_t i = 0; i < SHB_BATCH; i++)
        out->lit[i] = out->blocker[i] = 1;
    judge_exponential(question, &question->images[0], question->exponents[0], out);
    judge_exponential(question, &question->images[1], question->exponents[1], out);
}

/* ---- four moments ---- */

/* Of k; moments are off by a few units of 2^-24. */
#define MOMENT_ROUNDING 0x1p-19f

static inline float weight(float z, float s, float d) {
    const float off = (z - s) * z - 1;
    return d / (d * (1 + z * z) + off * off);
}

/* The part of a distribution that lies below u, and the sum of what lies there. */
typedef struct lower_part {
    float weight, sum;
} lower_part;

static inline lower_part add_below(lower_part below, float z, float u, float s, float d) {
    const float heavy = weight(z, s, d), part = z < u ? heavy : 0, sum = z < u ? heavy * z : 0;
    return (lower_part){below.weight + part, below.sum + sum};
}

/* The least part of a distribution of skewness s that lies below u. With s = 0 there is none below
 * u <= -1, which is where a plane's receiver is that lies nearer by the plane's own deviation. */
static inline lower_part least_below(float u, float s, float d) {
    const float q = (u - s) * u - 1;
    const float b = d * u - s * q, c = d - q;
    const float square = b * b - 4 * q * c;
    const float root = sqrtf(square > 0 ? square : 0);
    const float sum = -0.5f * (b + (b < 0 ? -root : root));
    const lower_part first = add_below((lower_part){0, 0}, sum / q, u, s, d);
    return add_below(first, c / sum, u, s, d);
}

/* The formulas of filter_moments.c. */
static void judge_moments(const shb_moment_question *question, shb_moment_answer *restrict out) {
    const shb_distance_batch *receiver = question->receiver;
    const shb_moment_batch *box = question->images;
    const size_t lanes = shb_round_to_lanes(question->count);
    for (size_t i = 0; i < lanes; i++) {
        const float error = receiver->error[i], noise = error * error;
        const float mean = box->at[0][i], variance = box->at[1][i];
        const float fourth = box->at[3][i] + noise * (6 * variance + 3 * noise);
        const float deviation = sqrtf(variance + noise), scale = 1 / deviation;
        const float s = box->at[2][i] * scale * scale * scale;
        const float k = fourth * scale * scale * scale * scale;
        const float rest = (k - 1) - s * s, least = MOMENT_ROUNDING * k;
        const float u = ((receiver->at[i] - mean) - error) * scale;
        const lower_part below = least_below(u, s, rest > least ? rest : least);
        const float lit = 1 - below.weight;
        out->lit[i] = lit > 0 ? lit : 0;
        out->blocker[i] = mean + deviation * (below.sum / below.weight);
    }
}
