#include "strict.h"

#include "occluders.h"

#include "light_point.h"
#include "occluder_planes.h"
#include "padded_rows.h"
#include "prepare.h"
#include "shared_topologies.h"

#include <math.h>
#include <string.h>

/* Depth changes by this much from texel to texel at the near plane, on a plane at 45 degrees to the
 * light's axis. */
static double diagonal_slope(const shb_map *map) {
    const shb_projection *p = &map->projection;
    const shb_light_rows *rows = &map->rows;
    const double ww = shb_dot(rows->w, rows->w);
    double near_w = rows->w[3];
    if (ww > 0) {
        const double near_depth = map->info.view.reversed ? -1 : 0;
        near_w = p->depth_scale / sqrt(ww) / (shb_dot(rows->z, rows->w) / ww - near_depth);
    }
    return p->texel_scale * p->depth_scale / near_w;
}

/* 45 degrees become 2^29 .. 2^30 at the near plane: slopes of more than 89.99 degrees are none
 * there, and 1e6 times as far 45 degrees still are known by 2^-10 at least. At most 2^-27, which
 * makes the largest slope a map's depth in a 2^16th of a texel. */
static double choose_slope_unit(const shb_map *map) {
    const double slope = diagonal_slope(map);
    if (!(slope > 0x1p-500 && slope < 0x1p500))
        return 0x1p-27;
    int exponent;
    frexp(slope, &exponent);
    return ldexp(1, exponent < 3 ? exponent - 30 : -27);
}

bool shb_occluders_create(shb_map *map) {
    shb_occluder_data *data = &map->occluders;
    if (shb_map_keeps_sheets(map) && !shb_sheets_create(map, &data->sheets))
        return false;
    map->info.memory_bytes += data->sheets.stride * data->sheets.height * sizeof(float);
    if (map->info.occluders == SHB_OCCLUDERS_NONE || map->info.occluders == SHB_OCCLUDERS_LISTS)
        return true;
    data->slope_unit = choose_slope_unit(map);
    data->stride = shb_padded_stride(map->info.width, sizeof *data->texels);
    data->texels = shb_alloc(map->context, map->info.height, data->stride);
    map->info.memory_bytes += data->stride * map->info.height;
    if (!data->texels)
        return false;
    if (map->info.occluders != SHB_OCCLUDERS_PLANES)
        return true;
    /* Kernels read slopes beyond the last column, too, though they decide nothing. */
    memset(data->texels, 0, map->info.height * data->stride);
    data->quick = shb_quick_planes_of(map);
    const bool done =
        shb_joints_create(map->context, map->info.width, map->info.height, &data->joints);
    map->info.memory_bytes += shb_joints_bytes(&data->joints);
    return done;
}

/* All that a drawing makes, but a topology that stays. */
static void release_drawn(const shb_context *context, shb_occluder_data *data) {
    shb_buffers_free(context, SHB_OCCLUDER_KEPT, data->kept);
    data->mesh = (shb_light_mesh){0};
    data->planes = NULL;
    data->world_planes = NULL;
    data->plane_count = 0;
}

void shb_occluders_destroy(shb_map *map) {
    release_drawn(map->context, &map->occluders);
    shb_topology_leave(map->context, &map->occluders.topology);
    shb_sheets_destroy(map->context, &map->occluders.sheets);
    shb_joints_destroy(map->context, &map->occluders.joints);
    shb_free(map->context, map->occluders.texels);
}

void shb_occluders_release(const shb_map *map, const shb_occluder_data *made) {
    const shb_occluder_data *held = &map->occluders;
    for (int i = 0; i < SHB_OCCLUDER_KEPT; i++)
        if (made->kept[i].data != held->kept[i].data)
            shb_free(map->context, made->kept[i].data);
    shb_topology topology = made->topology;
    shb_topology_return(map->context, &topology);
}

/* What walks need: planes and the mesh as the light sees it, in memory of an earlier drawing, which
 * is taken from the context. */
static bool make_walked(const shb_map *map, const shb_scene *scene, shb_occluder_data *made) {
    shb_context *context = map->context;
    const size_t count = made->plane_count;
    shb_placed_scene placed;
    shb_buffer *kept = made->kept;
    shb_buffers_move(SHB_OCCLUDER_KEPT, context->occluder_scratch, kept);
    shb_occluder_plane *planes =
        shb_buffer_reserve(context, &kept[SHB_OCCLUDER_PLANES], count, sizeof *planes);
    shb_world_plane *world_planes =
        shb_buffer_reserve(context, &kept[SHB_OCCLUDER_WORLD_PLANES], count, sizeof *world_planes);
    shb_walk_triangle *triangles =
        shb_buffer_reserve(context, &kept[SHB_OCCLUDER_TRIANGLES], count, sizeof *triangles);
    if (!planes || !world_planes || !triangles || !shb_placed_scene_make(context, scene, &placed) ||
        !shb_light_mesh_make(context, &map->info, &made->topology, triangles,
                             shb_map_keeps_sheets(map) ? made->bins.boxes : NULL, &made->mesh))
        return false;
    made->planes = planes;
    made->world_planes = world_planes;
    shb_occluder_planes_make(map, &placed, count, planes, world_planes);
    return true;
}

/* A scene that is drawn again looks as it did before, but sheets want boxes of its triangles. */
static bool is_known(const shb_map *map, const shb_occluder_data *made) {
    return made->topology.corners == map->occluders.topology.corners && map->occluders.planes &&
           !shb_map_keeps_sheets(map);
}

static bool prepare_mesh(const shb_map *map, const shb_scene *scene, bool walks,
                         shb_occluder_data *made) {
    shb_context *context = map->context;
    if (!shb_topology_join(context, scene, &map->occluders.topology, &made->topology))
        return false;
    if (walks && is_known(map, made)) {
        made->mesh = map->occluders.mesh;
        made->planes = map->occluders.planes;
        made->world_planes = map->occluders.world_planes;
        for (int i = 0; i < SHB_OCCLUDER_KEPT; i++)
            made->kept[i] = map->occluders.kept[i];
        return true;
    }
    return walks ? make_walked(map, scene, made)
                 : shb_light_mesh_make(context, &map->info, &made->topology, NULL, made->bins.boxes,
                                       &made->mesh);
}

bool shb_occluders_prepare(const shb_map *map, const shb_scene *scene, bool keeps,
                           shb_occluder_data *made) {
    const size_t count = (size_t)shb_scene_triangle_count(scene);
    const bool walks = keeps && map->info.occluders == SHB_OCCLUDERS_TRIANGLES;
    *made = map->occluders;
    made->topology = (shb_topology){0};
    made->mesh = (shb_light_mesh){0};
    made->plane_count = count;
    made->planes = NULL;
    made->world_planes = NULL;
    for (int i = 0; i < SHB_OCCLUDER_KEPT; i++)
        made->kept[i] = (shb_buffer){NULL, 0};
    bool done = true;
    if (shb_map_keeps_sheets(map))
        done = shb_sheet_bins_reserve(map->context, &map->info, count, &made->bins);
    if (done && (walks || shb_map_keeps_sheets(map)))
        done = prepare_mesh(map, scene, walks, made);
    if (done && shb_map_keeps_sheets(map))
        done = shb_sheet_bins_fill(map->context, &made->bins);
    if (!done)
        shb_occluders_release(map, made);
    return done;
}

static size_t texel_bytes(const shb_map *map) {
    const shb_sheets *sheets = &map->occluders.sheets;
    return shb_map_depth_bytes(map) + map->occluders.stride * map->info.height +
           shb_joints_bytes(&map->occluders.joints) +
           sheets->stride * sheets->height * sizeof *sheets->bounds;
}

static size_t scene_bytes(const shb_occluder_data *data) {
    return shb_topology_bytes(&data->topology) + shb_buffers_bytes(SHB_OCCLUDER_KEPT, data->kept);
}

void shb_occluders_finish(shb_map *map, bool keeps, const shb_occluder_data *made) {
    shb_context *context = map->context;
    const bool is_new = made->planes != map->occluders.planes;
    if (is_new && made->planes) {
        shb_buffers_free(context, SHB_OCCLUDER_KEPT, context->occluder_scratch);
        shb_buffers_move(SHB_OCCLUDER_KEPT, map->occluders.kept, context->occluder_scratch);
    }
    if (is_new)
        release_drawn(context, &map->occluders);
    shb_topology_return(map->context, &map->occluders.topology);
    map->occluders = *made;
    shb_occluder_data *data = &map->occluders;
    data->mesh.topology = &data->topology;
    if (data->joints.found)
        shb_joints_forget(&data->joints);
    if (shb_map_keeps_sheets(map))
        shb_sheets_find(map, &data->mesh, &data->bins);
    data->mesh.vertices = NULL;
    data->mesh.facing = NULL;
    if (!keeps || map->info.occluders != SHB_OCCLUDERS_TRIANGLES)
        release_drawn(context, data);
    map->info.memory_bytes = texel_bytes(map) + scene_bytes(data) + shb_prepared_bytes(map);
}
