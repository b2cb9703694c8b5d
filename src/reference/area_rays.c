/* How much of an area light reaches points, by rays. */
#include "../strict.h"

#include <string.h>

#include "../area_light.h"
#include "../hash.h"
#include "../vector.h"
#include "reference.h"
#include "shaft.h"

/* Points of one task, and triangles that are tested one by one instead of through the hierarchy. */
enum { POINTS = 16, BLOCKERS = 128 };

typedef struct query {
    const shb_reference *reference;
    const shb_area_light *area;
    uint32_t samples;
    const shb_area_points *points;
    float *visibility;
} query;

/* A point and what can stand between it and the light. */
typedef struct receiver {
    shb_vec3 position, normal; /* no normal: zero */
    uint32_t own_id;
    const shb_triangle *own;
    shb_shaft shaft;
    bool gathered; /* what can is known */
    uint32_t blocker_count;
    shb_shaft_blocker blockers[BLOCKERS]; /* the first one is the latest that did */
} receiver;

static shb_area_place shift_of(shb_vec3 position) {
    const double coordinates[3] = {position.x, position.y, position.z};
    uint64_t hash = 0;
    for (int i = 0; i < 3; i++) {
        uint64_t bits;
        memcpy(&bits, &coordinates[i], sizeof bits);
        hash = shb_mix(hash * 0x9e3779b97f4a7c15u + bits + 1);
    }
    return (shb_area_place){(double)(hash >> 32) * 0x1p-32, (double)(hash & 0xffffffffu) * 0x1p-32};
}

/* The blockers that the direction does not clearly miss decide by the ray itself. */
static bool is_blocked_by_gathered(receiver *r, const shb_light_source *sample,
                                   const double direction[3]) {
    shb_ray ray;
    bool has_ray = false;
    for (uint32_t i = 0; i < r->blocker_count; i++) {
        const shb_shaft_blocker blocker = r->blockers[i];
        if (shb_shaft_blocker_is_missed(&blocker, direction))
            continue;
        if (!has_ray && !shb_ray_to_light(sample, r->position, &ray))
            return false;
        has_ray = true;
        if (!shb_ray_is_blocked(&ray, blocker.triangle, r->own))
            continue;
        r->blockers[i] = r->blockers[0];
        r->blockers[0] = blocker;
        return true;
    }
    return false;
}

static bool is_lit(const shb_bvh *bvh, receiver *r, const shb_light_source *sample) {
    const bool directional = sample->w == 0;
    const shb_vec3 way =
        directional ? sample->position : vec3_subtract(sample->position, r->position);
    if (vec3_dot(way, r->normal) < 0)
        return false;
    if (r->gathered)
        return !is_blocked_by_gathered(r, sample, (double[3]){way.x, way.y, way.z});
    shb_ray ray;
    return !shb_ray_to_light(sample, r->position, &ray) || !shb_bvh_occluded(bvh, &ray, r->own_id);
}

/* True if one triangle stands before all of the light: the lines of all rays meet it, and those to
 * the corners of the square meet it between point and light, so that all others do. */
static bool is_covered(receiver *r, const shb_area_light *area) {
    for (uint32_t i = 0; i < r->blocker_count; i++) {
        if (!shb_shaft_is_covered(&r->shaft, &r->blockers[i]))
            continue;
        bool covers = true;
        for (int corner = 0; corner < 4 && covers; corner++) {
            const shb_light_source light = shb_area_corner(area, corner);
            shb_ray ray;
            covers = shb_ray_to_light(&light, r->position, &ray) &&
                     shb_ray_is_blocked(&ray, r->blockers[i].triangle, r->own);
        }
        if (covers)
            return true;
    }
    return false;
}

static uint32_t count_lit(const query *q, receiver *r) {
    const shb_bvh *bvh = &q->reference->bvh;
    const bool has_normal = r->normal.x != 0 || r->normal.y != 0 || r->normal.z != 0;
    if (r->gathered && r->blocker_count == 0 &&
        (!has_normal || shb_shaft_is_before(&r->shaft, r->normal)))
        return q->samples;
    if (r->gathered && is_covered(r, q->area))
        return 0;
    const shb_area_place shift = shift_of(r->position);
    uint32_t lit = 0;
    for (uint32_t i = 0; i < q->samples; i++) {
        const shb_area_place place = shb_area_shift(shb_area_pattern(i, q->samples), shift);
        const shb_light_source sample = shb_area_sample(q->area, place);
        lit += is_lit(bvh, r, &sample);
    }
    return lit;
}

static float ask_point(const query *q, size_t index) {
    const shb_bvh *bvh = &q->reference->bvh;
    const shb_area_points *points = q->points;
    receiver r;
    r.position = points->positions[index];
    r.normal = points->normals && vec3_is_finite(points->normals[index]) ? points->normals[index]
                                                                         : (shb_vec3){0, 0, 0};
    r.own_id = points->own_ids ? points->own_ids[index] : SHB_ID_NONE;
    if (!vec3_is_finite(r.position))
        return 1;
    r.own = shb_bvh_find(bvh, r.own_id);
    r.shaft = shb_shaft_of(bvh, q->area, r.position);
    r.gathered = shb_shaft_gather(bvh, &r.shaft, r.own_id, BLOCKERS, r.blockers, &r.blocker_count);
    return (float)((double)count_lit(q, &r) / q->samples);
}

static void ask_points(void *arg, size_t index) {
    const query *q = arg;
    const size_t begin = index * POINTS;
    const size_t end = q->points->count - begin < POINTS ? q->points->count : begin + POINTS;
    for (size_t i = begin; i < end; i++)
        q->visibility[i] = ask_point(q, i);
}

shb_result shb_reference_area(const shb_reference *reference, const shb_area_light *area,
                              uint32_t samples, const shb_area_points *points, float *visibility) {
    if (!reference)
        return SHB_ERROR_ARGUMENT;
    const shb_context *context = reference->context;
    if (!area || !points || (points->count && (!points->positions || !visibility)))
        return shb_fail(context, SHB_ERROR_ARGUMENT, "shb_reference_area: %s is NULL",
                        !area                ? "area"
                        : !points            ? "points"
                        : !points->positions ? "points.positions"
                                             : "visibility");
    const shb_result result = shb_area_check(context, "shb_reference_area", area, samples);
    if (result)
        return result;
    query q = {reference, area, samples, points, visibility};
    if (points->count)
        shb_parallel_for(context, ask_points, &q, (points->count - 1) / POINTS + 1);
    return SHB_OK;
}
