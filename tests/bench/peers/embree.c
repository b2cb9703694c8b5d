/* Embree's hierarchy and shadow rays beside depth maps and exact maps: hard shadows of all
 * fragments of a camera's view, one thread each. */
#include "comparison.h"

#include "tool.h"

#include <embree3/rtcore.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { PACKET = 16 };

/* One scene in Embree and the light's rays. */
typedef struct embree_work {
    const comparison *c;
    RTCDevice device;
    RTCScene scene; /* the latest */
    enum RTCBuildQuality quality;
    shb_light_source light;
    float nearest; /* where rays start: a hundred-thousandth of the scene's size */
    float *visibility;
} embree_work;

static shb_result build(void *state) {
    embree_work *work = state;
    const world_mesh *mesh = &work->c->mesh;
    if (work->scene)
        rtcReleaseScene(work->scene);
    work->scene = rtcNewScene(work->device);
    rtcSetSceneBuildQuality(work->scene, work->quality);
    RTCGeometry geometry = rtcNewGeometry(work->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, work->quality);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh->positions, 0, 12, mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->indices,
                               0, 12, mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(work->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(work->scene);
    return rtcGetDeviceError(work->device) == RTC_ERROR_NONE ? SHB_OK : SHB_ERROR_MEMORY;
}

static void set_ray(const embree_work *work, size_t fragment, int lane, struct RTCRay16 *rays) {
    const float *p = work->c->frame.positions + 3 * fragment;
    const shb_light_source *light = &work->light;
    rays->org_x[lane] = p[0];
    rays->org_y[lane] = p[1];
    rays->org_z[lane] = p[2];
    rays->dir_x[lane] = (float)(light->position.x - light->w * (double)p[0]);
    rays->dir_y[lane] = (float)(light->position.y - light->w * (double)p[1]);
    rays->dir_z[lane] = (float)(light->position.z - light->w * (double)p[2]);
    rays->tnear[lane] = work->nearest;
    rays->tfar[lane] = light->w != 0 ? 1 : INFINITY;
    rays->mask[lane] = ~0u;
    rays->time[lane] = 0;
    rays->flags[lane] = 0;
}

static shb_result trace(void *state) {
    const embree_work *work = state;
    const size_t count = work->c->frame.fragment_count;
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    struct RTCRay16 rays;
    for (size_t first = 0; first < count; first += PACKET) {
        _Alignas(64) int valid[PACKET];
        for (int lane = 0; lane < PACKET; lane++) {
            valid[lane] = first + (size_t)lane < count ? -1 : 0;
            if (valid[lane])
                set_ray(work, first + (size_t)lane, lane, &rays);
        }
        rtcOccluded16(valid, work->scene, &context, &rays);
        for (int lane = 0; lane < PACKET && valid[lane]; lane++)
            work->visibility[first + (size_t)lane] = rays.tfar[lane] < 0 ? 0.0f : 1.0f;
    }
    return SHB_OK;
}

/* The library's way to the same answers. */
typedef struct own_work {
    const comparison *c;
    shb_map *map;
    shb_bias bias;
    float *visibility;
} own_work;

static shb_result draw_map(void *state) {
    const own_work *work = state;
    return shb_map_draw(work->map, &work->c->scene->scene, &work->bias, NULL);
}

static shb_result ask_map(void *state) {
    const own_work *work = state;
    const measure_frame *frame = &work->c->frame;
    const shb_points points = {
        .count = frame->fragment_count, .positions = frame->positions, .normals = frame->normals};
    return shb_map_visibility(work->map, &points, &work->bias, NULL, work->visibility);
}

/* The share of fragments, boundaries included, that differ from the truth. */
static double wrong_ppm(const measure_truth *truth, size_t count, const float *visibility) {
    shb_errors e;
    if (shb_errors_measure(count, truth->fragments, visibility, &e) || e.lit + e.shadowed == 0)
        return -1;
    return e.wrong_ppm;
}

typedef struct own_method {
    const char *name;
    shb_occluders occluders;
    uint32_t map_size;
    bool classifies;
} own_method;

static bool compare_method(const comparison *c, embree_work *peer, const own_method *method,
                           const char *task) {
    shb_map_desc desc = {.width = method->map_size,
                         .occluders = method->occluders,
                         .classifies = method->classifies,
                         .exact_only = method->occluders == SHB_OCCLUDERS_LISTS};
    own_work own = {.c = c,
                    .bias = method->occluders ? shb_bias_exact() : shb_bias_adaptive(1e-4f, 0),
                    .visibility = c->frame.visibility};
    if (!tool_succeeds(
            c->peer, "light",
            scene_light_view(c->scene, SCENE_DIRECTIONAL, desc.width, false, &desc.view)) ||
        !tool_succeeds(c->peer, "map", shb_map_create(c->context, &desc, &own.map)))
        return false;
    peer->light = shb_map_get_info(own.map)->light;
    comparison_row row = {.task = task,
                          .own_method = method->name,
                          .map_size = method->map_size,
                          .fragment_count = c->frame.fragment_count};
    bool done =
        comparison_measure(c, (bench_work){build, peer}, (bench_work){draw_map, &own},
                           &row.build) &&
        comparison_measure(c, (bench_work){trace, peer}, (bench_work){ask_map, &own}, &row.ask);
    measure_truth truth;
    done =
        done && tool_succeeds(c->peer, "truth", measure_truth_create(&c->frame, own.map, &truth));
    if (done) {
        row.peer_wrong_ppm = wrong_ppm(&truth, row.fragment_count, peer->visibility);
        row.own_wrong_ppm = wrong_ppm(&truth, row.fragment_count, own.visibility);
        comparison_print(c, &row);
        measure_truth_destroy(&truth);
    }
    shb_map_destroy(own.map);
    return done;
}

static bool compare(const comparison *c) {
    static const own_method methods[] = {
        {"adaptive", SHB_OCCLUDERS_NONE, 2048, false},
        {"exact planes", SHB_OCCLUDERS_PLANES, 2048, false},
        {"exact triangles", SHB_OCCLUDERS_TRIANGLES, 1024, false},
        {"exact lists", SHB_OCCLUDERS_LISTS, 1024, false},
        {"certain lists", SHB_OCCLUDERS_LISTS, 1024, true},
    };
    const shb_vec3 size = shb_vec3_subtract(c->scene->bounds.hi, c->scene->bounds.lo);
    embree_work peer = {.c = c,
                        .device = rtcNewDevice("threads=1"),
                        .quality = RTC_BUILD_QUALITY_LOW,
                        .nearest = (float)(1e-5 * shb_vec3_length(size)),
                        .visibility = malloc((c->frame.fragment_count + 1) * sizeof(float))};
    bool done = peer.device && peer.visibility;
    if (!done)
        fprintf(stderr, "%s: no device or no memory\n", c->peer);
    for (size_t i = 0; i < sizeof methods / sizeof *methods && done; i++)
        done = compare_method(c, &peer, &methods[i], "hard shadows, fast build");
    peer.quality = RTC_BUILD_QUALITY_MEDIUM;
    done = done && compare_method(c, &peer, &methods[3], "hard shadows, medium build");
    if (peer.scene)
        rtcReleaseScene(peer.scene);
    if (peer.device)
        rtcReleaseDevice(peer.device);
    free(peer.visibility);
    return done;
}

int main(int argc, char **argv) {
    return comparison_run(argc, argv, "embree", compare);
}
