/* The built-in callbacks: Lambert surfaces, and the view of errors over them. */
#include "strict.h"

#include "shadowbias/shade.h"

#include "shadowbias/reference.h"

#define AMBIENT 0.08f

/* Of the grey under the error colours. */
#define DIM 0.25f

static float ambient(float shading_y) {
    return AMBIENT * 0.5f * (1 + shading_y);
}

/* Light of one colour channel that a surface of this colour sends back. */
static void reflect(const shb_shade_args *args, int channel, float surface, float *restrict out) {
    const float *restrict shading_y = args->fragments->shading_y;
    for (size_t i = 0; i < args->count; i++)
        out[i] = ambient(shading_y[i]);
    for (size_t k = 0; k < args->light_count; k++) {
        const float color = args->lights[k].color[channel];
        const float *restrict visibility = args->lighting[k].visibility;
        const float *restrict cosine = args->lighting[k].cosine;
        for (size_t i = 0; i < args->count; i++)
            out[i] += color * visibility[i] * cosine[i];
    }
    for (size_t i = 0; i < args->count; i++)
        out[i] *= surface;
}

void shb_shade_lambert(const shb_shade_args *args) {
    static const float white[3] = {1, 1, 1};
    const float *surface = args->user ? args->user : white;
    reflect(args, 0, surface[0], args->red);
    reflect(args, 1, surface[1], args->green);
    reflect(args, 2, surface[2], args->blue);
}

/* The colour of what the truth and the visibility say together: NULL where they agree. */
static const float *error_color(unsigned truth, float visibility) {
    static const float false_shadow[2][3] = {{1, 0.02f, 0.02f}, {0.8f, 0.35f, 0.35f}};
    static const float false_light[2][3] = {{0.02f, 0.1f, 1}, {0.35f, 0.4f, 0.8f}};
    const int pale = (truth & SHB_TRUTH_BOUNDARY) != 0;
    const bool shadowed = visibility < 0.5f;
    if (truth & SHB_TRUTH_LIT && shadowed)
        return false_shadow[pale];
    if (truth & SHB_TRUTH_SHADOWED && !shadowed)
        return false_light[pale];
    return NULL;
}

void shb_shade_error(const shb_shade_args *args) {
    const shb_shade_error_params *params = args->user;
    const shb_fragments *fragments = args->fragments;
    for (size_t i = 0; i < args->count; i++) {
        const float visibility = args->light_count ? args->lighting[0].visibility[i] : 1;
        const float cosine = args->light_count ? args->lighting[0].cosine[i] : 0;
        const float level = DIM * (ambient(fragments->shading_y[i]) + visibility * cosine);
        const float grey[3] = {level, level, level};
        const size_t row = (size_t)fragments->pixel_y[i], column = (size_t)fragments->pixel_x[i];
        const float *error = error_color(params->truth[row * params->stride + column], visibility);
        const float *color = error ? error : grey;
        args->red[i] = color[0];
        args->green[i] = color[1];
        args->blue[i] = color[2];
    }
}
