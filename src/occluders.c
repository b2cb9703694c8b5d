#include "strict.h"

#include "occluders.h"

#include "format.h"
#include "kernels/shade.h"
#include "occluder_planes.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Depth changes by this much from texel to texel at the near plane, on a plane at 45 degrees to the
 * light's axis. */
static double diagonal_slope(const shb_map *map) {
    const shb_projection *p = &map->projection;
    const shb_light_rows *rows = &map->rows;
    const double ww = (rows->w[0] * rows->w[0] + rows->w[1] * rows->w[1]) + rows->w[2] * rows->w[2];
    double near_w = 1;
    if (ww > 0) {
        const double zw =
            (rows->z[0] * rows->w[0] + rows->z[1] * rows->w[1]) + rows->z[2] * rows->w[2];
        const double near_depth = map->info.view.reversed ? -1 : 0;
        near_w = p->depth_scale / sqrt(ww) / (zw / ww - near_depth);
    }
    return p->texel_scale * p->depth_scale / near_w;
}

/* 45 degrees become 4 .. 8 at the near plane: infinity begins at 89.98 degrees there, and a map
 * that is a thousand times deeper still has more than 2^-12 of them. */
static double choose_slope_unit(const shb_map *map) {
    const double slope = diagonal_slope(map);
    if (!(slope > 0x1p-500 && slope < 0x1p500))
        return 1;
    int exponent;
    frexp(slope, &exponent);
    return ldexp(1, exponent - 3);
}

bool shb_occluders_create(shb_map *map) {
    shb_occluder_data *data = &map->occluders;
    if (map->classifies && !shb_sheets_create(map, &data->sheets))
        return false;
    map->info.memory_bytes += data->sheets.stride * data->sheets.height * sizeof(float);
    if (map->info.occluders == SHB_OCCLUDERS_NONE || map->info.occluders == SHB_OCCLUDERS_LISTS)
        return true;
    data->slope_unit = choose_slope_unit(map);
    data->stride = ((size_t)map->info.width * sizeof(uint32_t) + 63) / 64 * 64 + 64;
    data->texels = shb_alloc(map->context, map->info.height, data->stride);
    map->info.memory_bytes += data->stride * map->info.height;
    return data->texels != NULL;
}

void shb_occluders_destroy(shb_map *map) {
    shb_occluders_release(map, &map->occluders);
    shb_topology_release(map->context, &map->occluders.topology);
    shb_sheets_destroy(map->context, &map->occluders.sheets);
    shb_free(map->context, map->occluders.texels);
}

/* All that a drawing makes, but a topology that stays. */
static void release_drawn(const shb_context *context, shb_occluder_data *data) {
    shb_free(context, data->plane_buffer.data);
    shb_light_mesh_release(context, &data->mesh);
    data->plane_buffer = (shb_buffer){NULL, 0};
    data->planes = NULL;
    data->plane_count = 0;
}

void shb_occluders_release(const shb_map *map, shb_occluder_data *data) {
    release_drawn(map->context, data);
    if (data->topology.corners != map->occluders.topology.corners)
        shb_topology_release(map->context, &data->topology);
}

/* The map's own if the scene is the same. */
static bool find_topology(const shb_map *map, const shb_scene *scene, shb_topology *topology) {
    const uint64_t key = shb_topology_key(scene);
    *topology = map->occluders.topology;
    return (topology->corners && topology->key == key &&
            topology->triangle_count == shb_scene_triangle_count(scene)) ||
           shb_topology_make(map->context, scene, key, topology);
}

/* Memory of an earlier drawing, if it is large enough. */
static bool take_plane_buffer(shb_context *context, size_t count, shb_occluder_data *made) {
    made->plane_buffer = context->occluder_scratch[0];
    context->occluder_scratch[0] = (shb_buffer){NULL, 0};
    if (!shb_buffer_reserve(context, &made->plane_buffer, count, sizeof *made->planes))
        return false;
    made->planes = made->plane_buffer.data;
    return true;
}

/* For the next drawing. */
static void return_plane_buffer(shb_context *context, shb_occluder_data *data) {
    shb_free(context, context->occluder_scratch[0].data);
    context->occluder_scratch[0] = data->plane_buffer;
    data->plane_buffer = (shb_buffer){NULL, 0};
}

bool shb_occluders_prepare(const shb_map *map, const shb_scene *scene, bool keeps,
                           shb_occluder_data *made) {
    const size_t count = (size_t)shb_scene_triangle_count(scene);
    const bool walks = keeps && map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    const bool planes = keeps && (walks || map->info.occluders == SHB_OCCLUDERS_PLANES);
    *made = map->occluders;
    made->mesh = (shb_light_mesh){0};
    made->plane_count = count;
    made->plane_buffer = (shb_buffer){NULL, 0};
    made->planes = NULL;
    bool done = true;
    if (walks)
        done = take_plane_buffer(map->context, count, made);
    else if (planes)
        done = shb_occluder_scratch_reserve(map->context, count, &made->scratch);
    if (done && map->classifies)
        done = shb_sheet_bins_reserve(map->context, &map->info, count, &made->bins);
    if (done && (walks || map->classifies))
        done = find_topology(map, scene, &made->topology) &&
               shb_light_mesh_make(map->context, &map->info, &made->topology, walks, &made->mesh,
                                   map->classifies ? made->bins.boxes : NULL);
    if (done && map->classifies)
        done = shb_sheet_bins_fill(map->context, &made->bins);
    if (!done)
        shb_occluders_release(map, made);
    else if (walks)
        shb_occluder_planes_make(map, scene, count, made->planes);
    return done;
}

/* The texels of a map that hold triangles' ids. */
typedef struct texel_job {
    const shb_map *map;
    const shb_occluder_scratch *scratch;
} texel_job;

/* Texels are looked at this many at a time: most of these hold one triangle, or none. */
enum { BLOCK = 64 };

/* True if all texels of a block hold the id. */
static bool is_uniform(const uint32_t *texels, uint32_t count, uint32_t id) {
    uint32_t differ = 0;
    for (uint32_t i = 0; i < count; i++)
        differ |= texels[i] ^ id;
    return differ == 0;
}

static uint32_t block_size(const shb_map *map, uint32_t first) {
    return map->info.width - first < BLOCK ? map->info.width - first : BLOCK;
}

static void see_row(void *arg, size_t row) {
    const texel_job *job = arg;
    const uint32_t *texels = shb_occluder_row(job->map, (int32_t)row);
    uint32_t latest = SHB_ID_NONE;
    for (uint32_t first = 0; first < job->map->info.width; first += BLOCK) {
        const uint32_t count = block_size(job->map, first);
        if (is_uniform(texels + first, count, latest))
            continue;
        for (uint32_t i = first; i < first + count; i++) {
            if (texels[i] != latest && texels[i] != SHB_ID_NONE)
                atomic_store_explicit(&job->scratch->seen[texels[i]], 1, memory_order_relaxed);
            latest = texels[i];
        }
    }
}

/* Depths and slopes take the place of ids; what holds none is as far as it was drawn. */
static void resolve_row(void *arg, size_t row) {
    const texel_job *job = arg;
    const shb_map_info *info = &job->map->info;
    const shb_resolve resolve = {.planes = job->scratch->planes,
                                 .slopes = job->scratch->slopes,
                                 .far_depth = shb_far_depth(info->view.reversed)};
    uint32_t *texels = shb_occluder_row(job->map, (int32_t)row);
    char *stored = (char *)job->map->depth.texels + row * job->map->depth.stride;
    float depths[BLOCK + SHB_PLANE_LANES];
    uint32_t slopes[BLOCK + SHB_PLANE_LANES];
    for (uint32_t first = 0; first < info->width; first += BLOCK) {
        const uint32_t count = block_size(job->map, first);
        if (is_uniform(texels + first, count, SHB_ID_NONE)) {
            memset(texels + first, 0, count * sizeof *texels);
            continue;
        }
        job->map->context->shade_kernels->resolve(&resolve, (uint32_t)row, first, count,
                                                  texels + first, depths, slopes);
        memcpy(texels + first, slopes, count * sizeof *slopes);
        shb_format_store(info->format, info->view.reversed, count, depths,
                         stored + first * shb_format_size(info->format));
    }
}

/* The planes of what the map sees, and of nothing else, are made after it was drawn. */
static void resolve_map(shb_map *map, const shb_scene *scene, const shb_occluder_data *made) {
    const shb_context *context = map->context;
    texel_job job = {map, &made->scratch};
    for (size_t i = 0; i < made->plane_count; i++)
        atomic_init(&made->scratch.seen[i], 0);
    shb_parallel_for(context, see_row, &job, map->info.height);
    shb_occluder_planes_make_seen(map, scene, made->plane_count, &made->scratch);
    shb_parallel_for(context, resolve_row, &job, map->info.height);
}

static size_t texel_bytes(const shb_map *map) {
    const shb_sheets *sheets = &map->occluders.sheets;
    return (map->depth.stride + map->occluders.stride) * map->info.height +
           sheets->stride * sheets->height * sizeof *sheets->bounds;
}

static size_t scene_bytes(const shb_occluder_data *data) {
    const size_t vertex = data->mesh.vertices ? sizeof *data->mesh.vertices : 0;
    const size_t triangle = data->planes ? sizeof *data->planes + sizeof *data->mesh.facing : 0;
    return data->plane_count * triangle + data->topology.vertex_count * vertex +
           shb_topology_bytes(&data->topology);
}

void shb_occluders_finish(shb_map *map, const shb_scene *scene, bool keeps,
                          const shb_occluder_data *made) {
    const shb_context *context = map->context;
    if (made->planes)
        return_plane_buffer(map->context, &map->occluders);
    release_drawn(context, &map->occluders);
    if (map->occluders.topology.corners != made->topology.corners)
        shb_topology_release(context, &map->occluders.topology);
    map->occluders = *made;
    shb_occluder_data *data = &map->occluders;
    data->mesh.topology = &data->topology;
    if (map->classifies)
        shb_sheets_find(map, &data->mesh, &data->bins);
    if (keeps && map->info.occluders == SHB_OCCLUDERS_PLANES)
        resolve_map(map, scene, made);
    if (!keeps || map->info.occluders != SHB_OCCLUDERS_TRIANGLES)
        release_drawn(context, data);
    map->info.memory_bytes = texel_bytes(map) + scene_bytes(data);
}
