/* White Lambert surfaces under all lights: the contract of shb_shade_lambert. */

#include "../ambient.h"

static void shade_lambert(const shb_shade_args *args) {
    static const float white[3] = {1, 1, 1};
    const shb_shade_args given = *args;
    float surface[3];
    memcpy(surface, given.user ? given.user : white, sizeof surface);
    for (size_t i = 0; i < given.count; i += WIDE) {
        const vf low = SHB_AMBIENT_LIGHT(vf_load(given.fragments->shading_y + i));
        vf red = low, green = low, blue = low;
        for (size_t k = 0; k < given.light_count; k++) {
            const vf visibility = vf_load(given.lighting[k].visibility + i);
            const vf cosine = vf_load(given.lighting[k].cosine + i);
            const float *color = given.lights[k].color;
            red += color[0] * visibility * cosine;
            green += color[1] * visibility * cosine;
            blue += color[2] * visibility * cosine;
        }
        vf_store(given.red + i, red * surface[0]);
        vf_store(given.green + i, green * surface[1]);
        vf_store(given.blue + i, blue * surface[2]);
    }
}
