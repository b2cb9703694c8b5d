/* A reference and what tests of rays ask it. */
#ifndef TESTS_SUPPORT_RAY_CASTER_H
#define TESTS_SUPPORT_RAY_CASTER_H

#include "random.h"
#include "soup.h"

#include "shadowbias/reference.h"

typedef struct ray_caster {
    shb_context *context;
    shb_reference *reference;
} ray_caster;

ray_caster ray_caster_create(const shb_scene *scene);
void ray_caster_destroy(ray_caster *caster);

shb_light_source light_at(double x, double y, double z);
shb_light_source light_along(double x, double y, double z);

/* 1 or 0 for one point; own_id may be SHB_ID_NONE. */
int ray_caster_occluded(const shb_reference *reference, shb_light_source light, shb_vec3 point,
                        uint32_t own_id);

/* In a cube around the origin of half this size. */
shb_vec3 random_point(test_random *random, double half);

/* Triangles of this size with their middles within 1 of the origin on each axis; every third is a
 * needle. */
void soup_add_needles(soup *s, test_random *random, uint32_t count, double size);

#endif
