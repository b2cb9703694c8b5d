#include "ray_caster.h"

#include "contexts.h"
#include "test.h"

ray_caster ray_caster_create(const shb_scene *scene) {
    ray_caster caster = {0};
    caster.context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(caster.context, scene, &caster.reference), SHB_OK);
    return caster;
}

void ray_caster_destroy(ray_caster *caster) {
    shb_reference_destroy(caster->reference);
    shb_context_destroy(caster->context);
}

shb_light_source light_at(double x, double y, double z) {
    return (shb_light_source){{x, y, z}, 1};
}

shb_light_source light_along(double x, double y, double z) {
    return (shb_light_source){{x, y, z}, 0};
}

int ray_caster_occluded(const shb_reference *reference, shb_light_source light, shb_vec3 point,
                        uint32_t own_id) {
    uint8_t result = 99;
    CHECK_INT(shb_reference_occluded(reference, &light, 1, &point, &own_id, &result), SHB_OK);
    return result;
}

shb_vec3 random_point(test_random *random, double half) {
    const double x = random_double(random, -half, half), y = random_double(random, -half, half);
    return (shb_vec3){x, y, random_double(random, -half, half)};
}

void soup_add_needles(soup *s, test_random *random, uint32_t count, double size) {
    for (uint32_t i = 0; i < count; i++) {
        const shb_vec3 middle = random_point(random, 1);
        float corners[3][3];
        const double thin = random_below(random, 3) ? size : size * 1e-3;
        const shb_vec3 axis = random_point(random, size);
        for (int k = 0; k < 3; k++) {
            const shb_vec3 jitter = random_point(random, thin);
            const double along = k == 1 ? 1 : 0;
            corners[k][0] = (float)(middle.x + axis.x * along + jitter.x);
            corners[k][1] = (float)(middle.y + axis.y * along + jitter.y);
            corners[k][2] = (float)(middle.z + axis.z * along + jitter.z);
        }
        soup_add(s, corners[0], corners[1], corners[2]);
    }
}
