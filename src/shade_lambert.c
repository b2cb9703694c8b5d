/* The built-in callbacks: Lambert surfaces, and the view of errors over them. */
#include "strict.h"

#include "shadowbias/shade.h"

#include "shadowbias/reference.h"

#include <string.h>

#define AMBIENT 0.08f

/* Of one fragment, or of a vector of them. */
#define AMBIENT_LIGHT(shading_y) (AMBIENT * 0.5f * (1 + (shading_y)))

/* Of the grey under the error colours. */
#define DIM 0.25f

/* Neighbouring fragments. */
typedef float floats4 __attribute__((vector_size(16)));

static inline floats4 load4(const float *p) {
    floats4 v;
    memcpy(&v, p, sizeof v);
    return v;
}

static inline void store4(float *p, floats4 v) {
    memcpy(p, &v, sizeof v);
}

void shb_shade_lambert(const shb_shade_args *args) {
    static const float white[3] = {1, 1, 1};
    float surface[3];
    memcpy(surface, args->user ? args->user : white, sizeof surface);
    const shb_shade_args given = *args;
    for (size_t i = 0; i < given.count; i += 4) {
        const floats4 low = AMBIENT_LIGHT(load4(given.fragments->shading_y + i));
        floats4 red = low, green = low, blue = low;
        for (size_t k = 0; k < given.light_count; k++) {
            const floats4 visibility = load4(given.lighting[k].visibility + i);
            const floats4 cosine = load4(given.lighting[k].cosine + i);
            const float *color = given.lights[k].color;
            red += color[0] * visibility * cosine;
            green += color[1] * visibility * cosine;
            blue += color[2] * visibility * cosine;
        }
        store4(given.red + i, red * surface[0]);
        store4(given.green + i, green * surface[1]);
        store4(given.blue + i, blue * surface[2]);
    }
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
        const float level = DIM * (AMBIENT_LIGHT(fragments->shading_y[i]) + visibility * cosine);
        const float grey[3] = {level, level, level};
        const size_t row = (size_t)fragments->pixel_y[i], column = (size_t)fragments->pixel_x[i];
        const float *error = error_color(params->truth[row * params->stride + column], visibility);
        const float *color = error ? error : grey;
        args->red[i] = color[0];
        args->green[i] = color[1];
        args->blue[i] = color[2];
    }
}
