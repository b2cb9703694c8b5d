/* How far a shadow is detached: probes along the receiver, away from the contact line. */
#include "../strict.h"

#include "shadowbias/reference.h"

#include <math.h>

#include "../map.h"
#include "../vector.h"
#include "reference.h"

/* Probes that are asked at a time. */
typedef struct probes {
    size_t count;
    shb_vec3 points[SHB_BATCH];
    uint32_t own_ids[SHB_BATCH];
    float positions[3 * SHB_BATCH], normals[3 * SHB_BATCH];
    uint8_t occluded[SHB_BATCH];
    float visibility[SHB_BATCH];
} probes;

static double distance_of(const shb_detachment_desc *desc, uint32_t sample) {
    return desc->length * (sample + 0.5) / desc->samples;
}

static void to_floats(shb_vec3 v, float *out) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static void place_probes(const shb_detachment_desc *desc, uint32_t first, probes *p) {
    const uint32_t left = desc->samples - first;
    p->count = left < SHB_BATCH ? left : SHB_BATCH;
    for (uint32_t i = 0; i < p->count; i++) {
        const shb_vec3 way = shb_vec3_scale(desc->direction, distance_of(desc, first + i));
        p->points[i] = shb_vec3_add(desc->contact, way);
        p->own_ids[i] = desc->receiver_id;
        to_floats(p->points[i], &p->positions[3 * i]);
        to_floats(desc->normal, &p->normals[3 * i]);
    }
}

/* Asks truth and map about the probes from sample first on. */
static shb_result ask_probes(const shb_reference *reference, const shb_detachment_desc *desc,
                             uint32_t first, probes *p) {
    place_probes(desc, first, p);
    const shb_light_source *light = &shb_map_get_info(desc->map)->light;
    const shb_result result =
        shb_reference_occluded(reference, light, p->count, p->points, p->own_ids, p->occluded);
    if (result)
        return result;
    const shb_points points = {.count = p->count, .positions = p->positions, .normals = p->normals};
    return shb_map_visibility(desc->map, &points, desc->bias, desc->filter, p->visibility);
}

/* The width of a texel at a point, as the bias methods know it; not positive behind the light. */
static double texel_size(const shb_map *map, shb_vec3 point) {
    const shb_projection *projection = &map->projection;
    const double *r = projection->row_w;
    const double w =
        projection->affine ? 1 : r[0] * point.x + r[1] * point.y + r[2] * point.z + r[3];
    return projection->texel_scale * w;
}

static shb_result check_numbers(const shb_context *context, const shb_detachment_desc *desc) {
    if (!vec3_is_finite(desc->contact) || !vec3_is_finite(desc->direction) ||
        !vec3_is_finite(desc->normal))
        return shb_fail(context, SHB_ERROR_NUMBER, "shb_detachment_measure: desc.%s is not finite",
                        !vec3_is_finite(desc->contact)     ? "contact"
                        : !vec3_is_finite(desc->direction) ? "direction"
                                                           : "normal");
    const double length = shb_vec3_length(desc->direction);
    if (!(fabs(length - 1) < 1e-6))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_detachment_measure: desc.direction has the length %g, not 1", length);
    if (!(desc->length > 0) || !isfinite(desc->length))
        return shb_fail(context, SHB_ERROR_NUMBER,
                        "shb_detachment_measure: desc.length %g is not positive and finite",
                        desc->length);
    if (desc->samples == 0 || desc->samples > 1u << 20)
        return shb_fail(context, SHB_ERROR_SIZE,
                        "shb_detachment_measure: desc.samples %lu is not 1 .. 2^20",
                        (unsigned long)desc->samples);
    if (!(texel_size(desc->map, desc->contact) > 0))
        return shb_fail(context, SHB_ERROR_ARGUMENT,
                        "shb_detachment_measure: desc.contact lies behind the light");
    return SHB_OK;
}

static shb_result check_desc(const shb_reference *reference, const shb_detachment_desc *desc,
                             const shb_detachment *detachment) {
    if (!reference)
        return SHB_ERROR_ARGUMENT;
    const shb_context *context = reference->context;
    if (!desc || !detachment || !desc->map || !desc->bias)
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_detachment_measure: %s is NULL",
                        !desc         ? "desc"
                        : !detachment ? "detachment"
                        : !desc->map  ? "desc.map"
                                      : "desc.bias");
    return check_numbers(context, desc);
}

shb_result shb_detachment_measure(const shb_reference *reference, const shb_detachment_desc *desc,
                                  shb_detachment *detachment) {
    shb_result result = check_desc(reference, desc, detachment);
    if (result)
        return result;
    shb_detachment found = {0};
    probes p;
    for (uint32_t first = 0; first < desc->samples; first += SHB_BATCH) {
        result = ask_probes(reference, desc, first, &p);
        if (result)
            return result;
        for (uint32_t i = 0; i < p.count; i++) {
            found.probed += p.occluded[i];
            if (p.occluded[i] && !(p.visibility[i] < 0.5f))
                found.world = distance_of(desc, first + i);
        }
    }
    found.texels = found.world / texel_size(desc->map, desc->contact);
    *detachment = found;
    return SHB_OK;
}
