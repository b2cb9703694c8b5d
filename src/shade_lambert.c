/* The built-in callbacks: Lambert surfaces, and the view of errors over them. */
#include "strict.h"

#include "shadowbias/shade.h"

#include "shadowbias/reference.h"

#include "ambient.h"
#include "kernels/shade.h"

/* Of the grey under the error colours. */
#define DIM 0.25f

void shb_shade_lambert(const shb_shade_args *args) {
    shb_stage_kernels(args->kernels)->lambert(args);
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
        const float level =
            DIM * (SHB_AMBIENT_LIGHT(fragments->shading_y[i]) + visibility * cosine);
        const float grey[3] = {level, level, level};
        const size_t row = (size_t)fragments->pixel_y[i], column = (size_t)fragments->pixel_x[i];
        const float *error = error_color(params->truth[row * params->stride + column], visibility);
        const float *color = error ? error : grey;
        args->red[i] = color[0];
        args->green[i] = color[1];
        args->blue[i] = color[2];
    }
}
