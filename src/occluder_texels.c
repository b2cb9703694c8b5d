/* A band of rows at a time: the planes of the triangles that its texels hold are found and the
 * texels written while all of it is in a cache. A thread knows the triangles of its band by a
 * sparse set: ids[places[id]] is id if the band holds the triangle. */
#include "strict.h"

#include "occluder_texels.h"

#include "format.h"
#include "half.h"
#include "kernels/shade.h"
#include "occluder_planes.h"
#include "occluders.h"
#include "scene.h"

#include <stdatomic.h>
#include <string.h>

/* Ids and depths of so many texels fit into a second-level cache. */
#define BAND_TEXELS 65536

/* Each thread has this many bands to take at least. */
#define BANDS_PER_THREAD 4

/* What one thread works with. */
typedef struct band {
    uint32_t *places; /* by triangle */
    size_t count;     /* of triangles */
    uint32_t *ids;
    shb_occluder_plane *planes;
    uint32_t *slopes;
    shb_texel_runs *runs; /* of each row, in the memory that follows */
    uint16_t *columns;
    uint32_t *run_places;
    float *depths; /* of a row that the map does not hold as floats */
} band;

typedef struct texel_job {
    const shb_map *map;
    const shb_texel_scratch *scratch;
    atomic_size_t next; /* band that nobody has begun */
} texel_job;

static uint32_t choose_rows(const shb_map *map) {
    const uint32_t height = map->info.height;
    const uint32_t cached = BAND_TEXELS / map->info.width + 1;
    const uint32_t shared = height / (BANDS_PER_THREAD * map->context->threads) + 1;
    return cached < shared ? cached : shared;
}

/* Columns of a row's runs, and what is written beyond the last. */
static size_t row_columns(const shb_map *map) {
    return (size_t)map->info.width + 4;
}

static size_t row_floats(const shb_map *map) {
    return (size_t)map->info.width + SHB_PLANE_LANES;
}

static bool reserve(const shb_map *map, shb_texel_scratch *scratch, int number, size_t count,
                    size_t size) {
    shb_buffer *buffer = &map->context->occluder_scratch[number];
    scratch->bytes += scratch->lanes * count * size;
    return shb_buffer_reserve(map->context, buffer, scratch->lanes * count, size);
}

bool shb_texel_scratch_reserve(const shb_map *map, const shb_scene *scene,
                               shb_texel_scratch *scratch) {
    const size_t triangles = (size_t)shb_scene_triangle_count(scene);
    *scratch = (shb_texel_scratch){.lanes = map->context->threads, .rows = choose_rows(map)};
    scratch->triangles = triangles;
    scratch->band_triangles = (size_t)scratch->rows * map->info.width;
    if (scratch->band_triangles > triangles)
        scratch->band_triangles = triangles;
    const size_t most = scratch->band_triangles, columns = scratch->rows * row_columns(map);
    scratch->bytes = scene->instance_count * sizeof *scratch->placed.instances;
    return shb_placed_scene_make(map->context, scene, &scratch->placed) &&
           reserve(map, scratch, SHB_OCCLUDER_PLACES, triangles, sizeof(uint32_t)) &&
           reserve(map, scratch, SHB_OCCLUDER_BAND_IDS, most, sizeof(uint32_t)) &&
           reserve(map, scratch, SHB_OCCLUDER_BAND_PLANES, most, sizeof(shb_occluder_plane)) &&
           reserve(map, scratch, SHB_OCCLUDER_BAND_SLOPES, most, sizeof(uint32_t)) &&
           reserve(map, scratch, SHB_OCCLUDER_RUNS, scratch->rows, sizeof(shb_texel_runs)) &&
           reserve(map, scratch, SHB_OCCLUDER_RUN_COLUMNS, columns, sizeof(uint16_t)) &&
           reserve(map, scratch, SHB_OCCLUDER_RUN_PLACES, columns, sizeof(uint32_t)) &&
           reserve(map, scratch, SHB_OCCLUDER_ROWS, row_floats(map), sizeof(float));
}

static band band_of(const texel_job *job, size_t lane) {
    const shb_buffer *buffers = job->map->context->occluder_scratch;
    const shb_texel_scratch *scratch = job->scratch;
    const size_t first = lane * scratch->band_triangles;
    const size_t first_column = lane * scratch->rows * row_columns(job->map);
    const band b = {
        .places = (uint32_t *)buffers[SHB_OCCLUDER_PLACES].data + lane * scratch->triangles,
        .ids = (uint32_t *)buffers[SHB_OCCLUDER_BAND_IDS].data + first,
        .planes = (shb_occluder_plane *)buffers[SHB_OCCLUDER_BAND_PLANES].data + first,
        .slopes = (uint32_t *)buffers[SHB_OCCLUDER_BAND_SLOPES].data + first,
        .runs = (shb_texel_runs *)buffers[SHB_OCCLUDER_RUNS].data + lane * scratch->rows,
        .columns = (uint16_t *)buffers[SHB_OCCLUDER_RUN_COLUMNS].data + first_column,
        .run_places = (uint32_t *)buffers[SHB_OCCLUDER_RUN_PLACES].data + first_column,
        .depths = (float *)buffers[SHB_OCCLUDER_ROWS].data + lane * row_floats(job->map)};
    memset(b.places, 0, scratch->triangles * sizeof *b.places);
    return b;
}

/* Where a triangle is among the band's, which it joins if it is new. */
static uint32_t place_of(band *b, uint32_t id) {
    if (id == SHB_ID_NONE)
        return SHB_ID_NONE;
    const uint32_t place = b->places[id];
    if (place < b->count && b->ids[place] == id)
        return place;
    b->ids[b->count] = id;
    return b->places[id] = (uint32_t)b->count++;
}

static void find_runs(const texel_job *job, uint32_t first, uint32_t end, band *b) {
    const shb_shade_kernels *kernels = job->map->context->shade_kernels;
    shb_texel_runs runs = {0, b->columns, b->run_places};
    b->count = 0;
    for (uint32_t row = first; row < end; row++) {
        const uint32_t *texels = shb_occluder_row(job->map, (int32_t)row);
        runs.count = kernels->starts(texels, job->map->info.width, runs.columns);
        for (size_t i = 0; i < runs.count; i++)
            runs.places[i] = place_of(b, texels[runs.columns[i]]);
        b->runs[row - first] = runs;
        runs.columns += runs.count + 1;
        runs.places += runs.count;
    }
}

/* Two halves over the map's unit; both are infinite where one is. */
static uint32_t pack_slopes(const shb_occluder_plane *plane, double scale) {
    const uint32_t x = shb_half_of(plane->slope_x * scale);
    const uint32_t y = shb_half_of(plane->slope_y * scale);
    const bool infinite = (x & SHB_HALF_INFINITY) == SHB_HALF_INFINITY ||
                          (y & SHB_HALF_INFINITY) == SHB_HALF_INFINITY;
    return infinite ? SHB_HALF_INFINITY | SHB_HALF_INFINITY << 16 : x | y << 16;
}

static void find_planes(const texel_job *job, band *b) {
    const double scale = 1 / job->map->occluders.slope_unit;
    shb_occluder_planes_find(job->map, &job->scratch->placed, b->ids, 0, b->count, b->planes);
    for (size_t i = 0; i < b->count; i++)
        b->slopes[i] = pack_slopes(&b->planes[i], scale);
}

static void write_texels(const texel_job *job, uint32_t first, uint32_t end, const band *b) {
    const shb_map *map = job->map;
    const shb_map_info *info = &map->info;
    const bool reversed = info->view.reversed, floats = info->format == SHB_FORMAT_FLOAT32;
    const shb_resolve resolve = {.planes = b->planes,
                                 .slopes = b->slopes,
                                 .far_depth = shb_far_depth(reversed),
                                 .negates = reversed && floats};
    for (uint32_t row = first; row < end; row++) {
        void *stored = (char *)map->depth.texels + row * map->depth.stride;
        float *depths = floats ? stored : b->depths;
        for (uint32_t i = 0; i < info->width && !floats; i++)
            depths[i] = resolve.far_depth;
        map->context->shade_kernels->resolve(&resolve, row, &b->runs[row - first], depths,
                                             shb_occluder_row(map, (int32_t)row));
        if (!floats)
            shb_format_store(info->format, reversed, info->width, depths, stored);
    }
}

static void run_lane(void *arg, size_t lane) {
    texel_job *job = arg;
    const uint32_t height = job->map->info.height, rows = job->scratch->rows;
    band b = band_of(job, lane);
    for (size_t number; (number = atomic_fetch_add(&job->next, 1)) * rows < height;) {
        const uint32_t first = (uint32_t)number * rows;
        const uint32_t end = height - first < rows ? height : first + rows;
        find_runs(job, first, end, &b);
        find_planes(job, &b);
        write_texels(job, first, end, &b);
    }
}

void shb_occluder_texels_resolve(shb_map *map, const shb_texel_scratch *scratch) {
    texel_job job = {.map = map, .scratch = scratch};
    atomic_init(&job.next, 0);
    shb_parallel_for(map->context, run_lane, &job, scratch->lanes);
}
