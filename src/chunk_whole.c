#include "strict.h"

#include "chunk_whole.h"

#include "format.h"
#include "marks.h"

#include <stdatomic.h>

/* More threads would spend their time on merging. */
#define LANES_MAX 4

#define CHUNKS_AT_ONCE 16
#define ROWS_PER_TASK 16

typedef struct whole_job {
    const shb_kernels *kernels;
    const shb_draw_desc *desc;
    const shb_target *target;
    const shb_chunks *chunks;
    bool counts;
    size_t lane_count;
    shb_layers lanes[LANES_MAX]; /* the first one is the target */
    uint64_t drawn[LANES_MAX];
    atomic_size_t next; /* chunk that nobody has begun */
} whole_job;

shb_tile shb_layers_tile(const shb_layers *layers, const shb_draw_desc *desc,
                         const shb_target *target, bool counts) {
    const shb_samples *samples = &layers->samples;
    const int32_t width = samples->last_column - samples->first_column + 1;
    const size_t columns = (size_t)width;
    const size_t rows = (size_t)(samples->last_row - samples->first_row + 1);
    const shb_tile tile = {
        .depth = layers->nearest,
        .second = layers->second,
        .ids = layers->ids,
        .planes = target->planes,
        .stride = (ptrdiff_t)layers->pitch,
        .far_depth = shb_far_depth(desc->view->reversed),
        .counts = counts,
        .cells = layers->cells,
        .second_cells = layers->second ? layers->cells + shb_cells_count(columns, rows) : NULL,
        .cell_stride = (ptrdiff_t)shb_cells_stride(columns),
        .marks = layers->marks,
        .marks_stride = (ptrdiff_t)shb_marks_stride(desc->width),
        .has_depth_image = desc->depth.texels != NULL,
        .copied = layers->copied,
        .x0 = samples->first_column,
        .y0 = samples->first_row,
        .right = samples->last_column + 1,
        .x1 = samples->first_column + (width + 15) / 16 * 16,
        .y1 = samples->last_row + 1,
    };
    shb_cells_reset(&tile);
    return tile;
}

static void run_lane(void *arg, size_t index) {
    whole_job *job = arg;
    const shb_tile tile = shb_layers_tile(&job->lanes[index], job->desc, job->target, job->counts);
    const shb_chunk *chunks = job->chunks->chunks;
    const size_t count = job->chunks->count;
    uint64_t drawn = 0;
    for (size_t first; (first = atomic_fetch_add(&job->next, CHUNKS_AT_ONCE)) < count;)
        for (size_t i = first; i < count && i < first + CHUNKS_AT_ONCE; i++)
            drawn += job->kernels->draw(&chunks[i], &tile);
    job->kernels->clear(&tile);
    job->drawn[index] = drawn;
}

/* Of two pairs of layers the lowest (depth, id) and the next depth. */
static void merge_ids(size_t count, const float *restrict a, const float *restrict b,
                      const int32_t *restrict ids_b, int32_t *restrict ids_a) {
    for (size_t i = 0; i < count; i++) {
        const int32_t closer = b[i] < a[i] ? ids_b[i] : ids_a[i];
        const int32_t lower = ids_b[i] < ids_a[i] ? ids_b[i] : ids_a[i];
        ids_a[i] = a[i] == b[i] ? lower : closer;
    }
}

static void merge_second(size_t count, const float *restrict a, const float *restrict b,
                         const float *restrict second_b, float *restrict second_a) {
    for (size_t i = 0; i < count; i++) {
        const float loser = b[i] < a[i] ? a[i] : b[i];
        const float second = second_b[i] < second_a[i] ? second_b[i] : second_a[i];
        second_a[i] = loser < second ? loser : second;
    }
}

static void merge_nearest(size_t count, const float *restrict b, float *restrict a) {
    for (size_t i = 0; i < count; i++)
        a[i] = b[i] < a[i] ? b[i] : a[i];
}

static void merge_row(const shb_layers *a, const shb_layers *b, size_t row) {
    const size_t count = (size_t)a->samples.last_column + 1;
    const size_t at_a = row * a->pitch, at_b = row * b->pitch;
    if (a->ids)
        merge_ids(count, a->nearest + at_a, b->nearest + at_b,
                  (const int32_t *)(const void *)(b->ids + at_b),
                  (int32_t *)(void *)(a->ids + at_a));
    if (a->second)
        merge_second(count, a->nearest + at_a, b->nearest + at_b, b->second + at_b,
                     a->second + at_a);
    merge_nearest(count, b->nearest + at_b, a->nearest + at_a);
}

static void merge_rows(void *arg, size_t index) {
    const whole_job *job = arg;
    const size_t rows = (size_t)job->lanes[0].samples.last_row + 1;
    const size_t first = index * ROWS_PER_TASK;
    for (size_t row = first; row < rows && row < first + ROWS_PER_TASK; row++)
        for (size_t lane = 1; lane < job->lane_count; lane++)
            merge_row(&job->lanes[0], &job->lanes[lane], row);
}

bool shb_chunk_whole_draw(shb_context *context, const shb_draw_desc *desc, const shb_target *target,
                          const shb_chunks *chunks, const shb_layers *layers, bool counts,
                          uint64_t *drawn) {
    const size_t shares = chunks->count / CHUNKS_AT_ONCE + 1;
    const size_t most = context->threads < LANES_MAX ? context->threads : LANES_MAX;
    whole_job job = {.kernels = context->kernels,
                     .desc = desc,
                     .target = target,
                     .chunks = chunks,
                     .counts = counts,
                     .lane_count = shares < most ? shares : most,
                     .lanes = {*layers}};
    const size_t rows = desc->height;
    if (job.lane_count > 1) {
        job.lanes[0].marks = NULL;
        shb_marks_forget(target->marks, desc->width, desc->height);
        const shb_layers *own =
            shb_layers_reserve(context, desc, target, job.lane_count - 1, desc->width, rows);
        if (!own)
            return false;
        for (size_t lane = 1; lane < job.lane_count; lane++) {
            job.lanes[lane] = own[lane - 1];
            job.lanes[lane].samples = layers->samples;
        }
    }
    float *cells = shb_cells_reserve(context, job.lane_count, desc->width, rows);
    if (!cells)
        return false;
    for (size_t lane = 0; lane < job.lane_count; lane++)
        job.lanes[lane].cells = cells + lane * 2 * shb_cells_count(desc->width, rows);
    atomic_init(&job.next, 0);
    shb_parallel_for(context, run_lane, &job, job.lane_count);
    if (job.lane_count > 1)
        shb_parallel_for(context, merge_rows, &job, (rows + ROWS_PER_TASK - 1) / ROWS_PER_TASK);
    for (size_t lane = 0; lane < job.lane_count; lane++)
        *drawn += job.drawn[lane];
    return true;
}
