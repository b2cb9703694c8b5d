#include "paint.h"

#include "scene.h"

#include <math.h>

/* How much of the second colour a surface shows at a point. */
static float second_share(const scene_surface *surface, const shb_fragments *fragments, size_t i) {
    if (surface->pattern == SCENE_TILES) {
        const float column = floorf(fragments->x[i] / surface->tile_size);
        const float row = floorf(fragments->z[i] / surface->tile_size);
        return fmodf(fabsf(column + row), 2);
    }
    if (surface->pattern == SCENE_SLOPES) {
        const float steepness = (0.86f - fragments->shading_y[i]) / 0.22f;
        if (fragments->y[i] < surface->lowest)
            return 1;
        return steepness < 0 ? 0 : steepness > 1 ? 1 : steepness;
    }
    return 0;
}

/* The light of the sky from above and what the ground returns of it from below. */
static void sky_light(const example_scene *scene, float up, float light[3]) {
    static const float sky[3] = {0.80f, 0.95f, 1.20f}, ground[3] = {0.60f, 0.52f, 0.44f};
    const float share = 0.5f + 0.5f * up;
    for (int k = 0; k < 3; k++)
        light[k] = scene->ambient * (ground[k] + (sky[k] - ground[k]) * share);
}

void paint_scene(const shb_shade_args *args) {
    const example_scene *scene = args->user;
    for (size_t i = 0; i < args->count; i++) {
        const scene_surface *surface =
            &scene->surfaces[scene->instance_of_triangle[args->fragments->id[i]]];
        const float share = second_share(surface, args->fragments, i);
        float light[3];
        sky_light(scene, args->fragments->shading_y[i], light);
        for (size_t l = 0; l < args->light_count; l++) {
            const float received = args->lighting[l].visibility[i] * args->lighting[l].cosine[i];
            for (int k = 0; k < 3; k++)
                light[k] += received * args->lights[l].color[k];
        }
        float *const outputs[3] = {args->red, args->green, args->blue};
        for (int k = 0; k < 3; k++) {
            const float albedo =
                surface->color[k] + (surface->second[k] - surface->color[k]) * share;
            outputs[k][i] = albedo * light[k];
        }
    }
}
