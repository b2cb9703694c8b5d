#include "strict.h"

#include "occluders.h"

#include "format.h"
#include "half.h"
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
    shb_free(context, data->planes);
    shb_light_mesh_release(context, &data->mesh);
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

bool shb_occluders_prepare(const shb_map *map, const shb_scene *scene, bool keeps,
                           shb_occluder_data *made) {
    const shb_context *context = map->context;
    const size_t count = (size_t)shb_scene_triangle_count(scene);
    const bool walks = keeps && map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    const bool planes = keeps && (walks || map->info.occluders == SHB_OCCLUDERS_PLANES);
    *made = map->occluders;
    made->mesh = (shb_light_mesh){0};
    made->plane_count = count;
    made->planes = NULL;
    bool done = true;
    if (planes)
        done = (made->planes = shb_alloc(context, count, sizeof *made->planes)) != NULL;
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
    else if (planes)
        shb_occluder_planes_make(map, scene, count, made->planes);
    return done;
}

/* Rounded away from the light, by less than two units in the last place. */
static float round_up(double depth) {
    const float rounded = (float)depth;
    return (double)rounded < depth ? rounded + fabsf(rounded) * 0x1p-23f : rounded;
}

typedef struct resolve_job {
    const shb_map *map;
    const shb_occluder_plane *planes;
} resolve_job;

/* Depth and slopes of a texel that holds a triangle's id. The depth lies behind the true plane by
 * all that the plane may be off. */
static void resolve_texel(const resolve_job *job, uint32_t column, uint32_t row, float far_depth,
                          float *depth, uint32_t *texel) {
    if (*texel == SHB_ID_NONE) {
        *depth = far_depth;
        *texel = 0;
        return;
    }
    const shb_occluder_plane *plane = &job->planes[*texel];
    const double z = shb_occluder_depth(plane, column + 0.5, row + 0.5) + plane->error;
    const double scale = 1 / job->map->occluders.slope_unit;
    *depth = round_up(z < (double)far_depth ? z : (double)far_depth);
    *texel = (uint32_t)shb_half_of(plane->slope_x * scale) |
             (uint32_t)shb_half_of(plane->slope_y * scale) << 16;
}

static void resolve_row(void *arg, size_t row) {
    enum { CHUNK = 256 };
    const resolve_job *job = arg;
    const shb_map_info *info = &job->map->info;
    const float far_depth = shb_far_depth(info->view.reversed);
    uint32_t *texels = shb_occluder_row(job->map, (int32_t)row);
    char *stored = (char *)job->map->depth.texels + row * job->map->depth.stride;
    float depths[CHUNK];
    for (uint32_t first = 0; first < info->width; first += CHUNK) {
        const uint32_t count = info->width - first < CHUNK ? info->width - first : CHUNK;
        for (uint32_t i = 0; i < count; i++)
            resolve_texel(job, first + i, (uint32_t)row, far_depth, &depths[i], &texels[first + i]);
        shb_format_store(info->format, info->view.reversed, count, depths,
                         stored + first * shb_format_size(info->format));
    }
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

void shb_occluders_finish(shb_map *map, bool keeps, const shb_occluder_data *made) {
    const shb_context *context = map->context;
    release_drawn(context, &map->occluders);
    if (map->occluders.topology.corners != made->topology.corners)
        shb_topology_release(context, &map->occluders.topology);
    map->occluders = *made;
    shb_occluder_data *data = &map->occluders;
    data->mesh.topology = &data->topology;
    if (map->classifies)
        shb_sheets_find(map, &data->mesh, &data->bins);
    if (keeps && map->info.occluders == SHB_OCCLUDERS_PLANES) {
        resolve_job job = {map, data->planes};
        shb_parallel_for(context, resolve_row, &job, map->info.height);
    }
    if (!keeps || map->info.occluders != SHB_OCCLUDERS_TRIANGLES)
        release_drawn(context, data);
    map->info.memory_bytes = texel_bytes(map) + scene_bytes(data);
}
