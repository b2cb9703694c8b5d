#include "strict.h"

#include "area_light.h"

#include <math.h>

#include "matrix.h"
#include "vector.h"

static uint32_t reverse_bits(uint32_t n) {
    n = n >> 16 | n << 16;
    n = (n & 0xff00ff00u) >> 8 | (n & 0x00ff00ffu) << 8;
    n = (n & 0xf0f0f0f0u) >> 4 | (n & 0x0f0f0f0fu) << 4;
    n = (n & 0xccccccccu) >> 2 | (n & 0x33333333u) << 2;
    return (n & 0xaaaaaaaau) >> 1 | (n & 0x55555555u) << 1;
}

shb_area_place shb_area_pattern(uint32_t index, uint32_t count) {
    const double half = 0.5 / count;
    return (shb_area_place){(index + 0.5) / count, reverse_bits(index) * 0x1p-32 + half};
}

static double wrap(double x) {
    return x < 1 ? x : x - 1;
}

shb_area_place shb_area_shift(shb_area_place place, shb_area_place by) {
    return (shb_area_place){wrap(place.s + by.s), wrap(place.t + by.t)};
}

/* A point of the square -1 .. 1 to the unit disk, squares around the middle to circles of the same
 * part of the area (Shirley and Chiu 1997). */
static void square_to_disk(double *a, double *b) {
    const double quarter_pi = 0.78539816339744830962;
    const bool is_steep = fabs(*b) > fabs(*a);
    const double radius = is_steep ? *b : *a, other = is_steep ? *a : *b;
    if (radius == 0)
        return;
    double sine, cosine;
    shb_sine_cosine(quarter_pi * (other / radius), &sine, &cosine);
    *a = radius * (is_steep ? sine : cosine);
    *b = radius * (is_steep ? cosine : sine);
}

static shb_light_source point_of(const shb_area_light *area, double a, double b) {
    const shb_vec3 along = vec3_add(vec3_scale(area->u, a), vec3_scale(area->v, b));
    return (shb_light_source){vec3_add(area->light.position, along), area->light.w};
}

shb_light_source shb_area_sample(const shb_area_light *area, shb_area_place place) {
    double a = 2 * place.s - 1, b = 2 * place.t - 1;
    if (area->disk)
        square_to_disk(&a, &b);
    return point_of(area, a, b);
}

shb_light_source shb_area_corner(const shb_area_light *area, int k) {
    return point_of(area, k == 1 || k == 2 ? 1 : -1, k >= 2 ? 1 : -1);
}

shb_result shb_area_check(const shb_context *context, const char *caller,
                          const shb_area_light *area, uint32_t samples) {
    const shb_vec3 p = area->light.position;
    const bool is_zero = p.x == 0 && p.y == 0 && p.z == 0;
    const bool has_kind = area->light.w == 1 || (area->light.w == 0 && !is_zero);
    if (!vec3_is_finite(p) || !has_kind)
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "%s: area.light (%g, %g, %g), w %g is neither a point nor a direction",
                        caller, p.x, p.y, p.z, area->light.w);
    if (!vec3_is_finite(area->u) || !vec3_is_finite(area->v))
        return shb_fail(context, SHB_ERROR_NUMBER, "%s: area.%s is not finite", caller,
                        vec3_is_finite(area->u) ? "v" : "u");
    if (samples == 0 || samples > SHB_AREA_SAMPLES_MAX)
        return shb_fail(context, SHB_ERROR_SIZE, "%s: samples %lu is not 1 .. %d", caller,
                        (unsigned long)samples, SHB_AREA_SAMPLES_MAX);
    return SHB_OK;
}
