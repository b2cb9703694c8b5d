/* Filters of scattered taps: each reads the texel that holds a place of its own near the fragment.
 */

#include "../poisson.h"

/* Taps stay within this many texels of the fragment, beyond any map. */
#define SCATTER_LIMIT 32768.0f

/* A batch whose fragments ask scattered taps, one tap of all fragments at a time. */
typedef struct scatter_batch {
    const shb_map *map;
    const shb_receivers *receivers;
    size_t lanes;
    shb_taps taps;
    float far_depth;
    SHB_ALIGN float reach[SHB_BATCH];               /* radius or half width, texels */
    float dx[SHB_BATCH], dy[SHB_BATCH];             /* the tap, from the fragment on */
    int32_t column[SHB_BATCH], row[SHB_BATCH];      /* its texel, from the fragment's own one */
    int32_t texel_x[SHB_BATCH], texel_y[SHB_BATCH]; /* its texel */
    float depth[SHB_BATCH];                         /* of the tap on the fragment's plane */
    float stored[SHB_BATCH];
    int32_t shadowed[SHB_BATCH];         /* taps */
    shb_tap_surface surfaces[SHB_BATCH]; /* of SHB_TAPS_NAIVE */
    mutual_batch *mutual;                /* of the exact method; else NULL */
    held_taps *held;                     /* where the map keeps planes; else NULL */
} scatter_batch;

/* texel_size: NULL for a reach in texels. */
static void scatter_reach(const float *restrict texel_size, float reach, size_t lanes,
                          float *restrict reaches) {
    for (size_t i = 0; i < lanes; i++) {
        const float wide = texel_size ? reach / texel_size[i] : reach;
        const float some = wide > 0 ? wide : 0;
        reaches[i] = some < SCATTER_LIMIT / 2 ? some : SCATTER_LIMIT / 2;
    }
}

/* Beyond all taps, whose places are rounded. */
static int32_t side_of_square(float reach) {
    return (int32_t)(reach * (1 + 0x1p-10f)) + 1;
}

/* mutual: NULL but for the exact method; held: room for its taps. */
static void scatter_init(const shb_filter_args *args, float reach, float unit, float taps,
                         mutual_batch *mutual, held_taps *held, scatter_batch *batch) {
    const shb_receivers *r = mutual ? &mutual->receivers : args->receivers;
    batch->map = args->map;
    batch->receivers = r;
    batch->lanes = shb_round_to_lanes(args->count);
    batch->taps = SHB_TAPS_PLANE;
    if (!mutual && (taps == SHB_TAPS_OWN || taps == SHB_TAPS_NAIVE))
        batch->taps = (shb_taps)taps;
    batch->far_depth = shb_far_depth(args->map->info.view.reversed);
    batch->mutual = mutual;
    scatter_reach(unit == SHB_UNIT_WORLD ? r->texel_size : NULL, reach, batch->lanes, batch->reach);
    memset(batch->shadowed, 0, sizeof batch->shadowed);
    for (size_t i = 0; batch->taps == SHB_TAPS_NAIVE && i < batch->lanes; i++)
        batch->surfaces[i] = shb_tap_surface_of(&args->map->rows, r, i);
    batch->held = NULL;
    if (!mutual)
        return;
    for (size_t i = 0; i < batch->lanes; i++)
        mutual->reach[i] = batch->reach[i] * 1.5f + 2;
    mutual_batch_finish(mutual, args->count);
    if (args->map->info.occluders == SHB_OCCLUDERS_TRIANGLES)
        return;
    batch->held = held;
    drop_taps(held);
    for (size_t i = 0; i < batch->lanes; i++)
        held->side[i] = side_of_square(batch->reach[i]);
}

/* The texel in a row that holds a place d texels from the fragment. */
static void scatter_texels(const float *restrict d, const float *restrict to_center,
                           const int32_t *restrict own, size_t lanes, int32_t *restrict offset,
                           int32_t *restrict texel) {
    for (size_t i = 0; i < lanes; i++) {
        const float place = (0.5f - to_center[i]) + d[i];
        const int32_t cut = (int32_t)place;
        offset[i] = cut - ((float)cut > place);
        texel[i] = own[i] + offset[i];
    }
}

static void scatter_depths(const scatter_batch *batch, float *restrict depth) {
    const shb_receivers *r = batch->receivers;
    switch (batch->taps) {
    case SHB_TAPS_OWN:
        memcpy(depth, r->ref, sizeof r->ref);
        break;
    case SHB_TAPS_NAIVE:
        for (size_t i = 0; i < batch->lanes; i++)
            depth[i] = shb_tap_naive(&batch->map->rows, &batch->surfaces[i], batch->column[i],
                                     batch->row[i]);
        break;
    case SHB_TAPS_PLANE:
        for (size_t i = 0; i < batch->lanes; i++)
            depth[i] = shb_tap_depth(r->ref[i], r->step_x[i], r->step_y[i], (float)batch->column[i],
                                     (float)batch->row[i]);
    }
}

/* Leaves the taps that lie in front of the fragment's plane and whose occluder shadows it. */
static void scatter_mutual(scatter_batch *batch, int32_t *shadowed) {
    const shb_map_info *info = &batch->map->info;
    for (size_t i = 0; i < batch->lanes; i += WIDE) {
        const vi x = vi_load(batch->texel_x + i), y = vi_load(batch->texel_y + i);
        vi hits = vi_load(shadowed + i) != 0;
        hits &= ((vu)x < info->width) & ((vu)y < info->height);
        if (vi_any(hits))
            hits = shadowed_taps(
                batch->mutual, i, hits, __builtin_convertvector(vi_load(batch->column + i), vf),
                __builtin_convertvector(vi_load(batch->row + i), vf), vf_load(batch->stored + i));
        vi_store(shadowed + i, hits & 1);
    }
}

/* Asks one tap of each fragment, whose texels are known: shadowed[i] is 0 or 1. */
static void scatter_ask(scatter_batch *restrict batch, int32_t *restrict shadowed) {
    const size_t lanes = batch->lanes;
    const float far_depth = batch->far_depth;
    scatter_depths(batch, batch->depth);
    fetch(batch->map, lanes, batch->texel_x, batch->texel_y, batch->stored);
    for (size_t i = 0; i < lanes; i++)
        shadowed[i] = (batch->stored[i] < batch->depth[i]) & (batch->stored[i] < far_depth);
    if (batch->mutual)
        scatter_mutual(batch, shadowed);
}

/* Counts those that are held. */
static void scatter_release(scatter_batch *batch) {
    held_taps *held = batch->held;
    if (!held->count)
        return;
    light_held(batch->mutual, batch->lanes, held);
    for (size_t i = 0; i < batch->lanes; i++)
        batch->shadowed[i] += __builtin_popcountll(held->shadowed[i]);
    drop_taps(held);
}

/* The same for the tap at (dx, dy), added to the others. */
static void scatter_add(scatter_batch *restrict batch) {
    const shb_receivers *r = batch->receivers;
    SHB_ALIGN int32_t shadowed[SHB_BATCH];
    scatter_texels(batch->dx, r->to_center_x, r->texel_x, batch->lanes, batch->column,
                   batch->texel_x);
    scatter_texels(batch->dy, r->to_center_y, r->texel_y, batch->lanes, batch->row, batch->texel_y);
    scatter_ask(batch, shadowed);
    if (batch->held) {
        hold_tap(batch->column, batch->row, shadowed, batch->lanes, batch->held);
        if (batch->held->count == HELD_TAPS)
            scatter_release(batch);
        return;
    }
    for (size_t i = 0; i < batch->lanes; i++)
        batch->shadowed[i] += shadowed[i];
}

static void scatter_finish(scatter_batch *batch, int taps, float *restrict visibility) {
    const double share = 1 / (double)taps;
    if (batch->held)
        scatter_release(batch);
    for (size_t i = 0; i < batch->lanes; i++)
        visibility[i] = (float)(share * (taps - batch->shadowed[i]));
}

static void hash_positions(const shb_receivers *restrict r, size_t lanes, uint32_t *restrict hash) {
    for (size_t i = 0; i < lanes; i++)
        hash[i] = shb_position_hash(r->x[i], r->y[i], r->z[i]);
}

/* params: count, radius, unit, taps. */
static void ask_poisson(const shb_filter_args *args, mutual_batch *mutual) {
    scatter_batch batch;
    held_taps held;
    SHB_ALIGN uint32_t hash[SHB_BATCH];
    SHB_ALIGN float cosine[SHB_BATCH], sine[SHB_BATCH];
    const float *params = args->filter->params;
    const float some = params[0] > 1 ? params[0] : 1;
    const int count = (int)(some < SHB_POISSON_MAX ? some : SHB_POISSON_MAX);
    scatter_init(args, params[1], params[2], params[3], mutual, &held, &batch);
    hash_positions(batch.receivers, batch.lanes, hash);
    for (size_t i = 0; i < batch.lanes; i++) {
        const int16_t *turn = shb_poisson_turns[hash[i] % SHB_POISSON_TURNS];
        cosine[i] = batch.reach[i] * ((float)turn[0] * SHB_POISSON_UNIT);
        sine[i] = batch.reach[i] * ((float)turn[1] * SHB_POISSON_UNIT);
    }
    for (int k = 0; k < count; k++) {
        const float x = (float)shb_poisson_disk[k][0] * SHB_POISSON_UNIT;
        const float y = (float)shb_poisson_disk[k][1] * SHB_POISSON_UNIT;
        for (size_t i = 0; i < batch.lanes; i++) {
            batch.dx[i] = cosine[i] * x - sine[i] * y;
            batch.dy[i] = sine[i] * x + cosine[i] * y;
        }
        scatter_add(&batch);
    }
    scatter_finish(&batch, count, args->visibility);
}

#define JITTER_ROW 4

/* Each tap lies anywhere in its own cell of 4 x 4. params: size, unit, taps. */
static void ask_jittered(const shb_filter_args *args, mutual_batch *mutual) {
    scatter_batch batch;
    held_taps held;
    SHB_ALIGN uint32_t hash[SHB_BATCH];
    const float *params = args->filter->params;
    scatter_init(args, params[0] / 2, params[1], params[2], mutual, &held, &batch);
    hash_positions(batch.receivers, batch.lanes, hash);
    for (int k = 0; k < JITTER_ROW * JITTER_ROW; k++) {
        const float left = (float)(k % JITTER_ROW) - JITTER_ROW / 2;
        const float top = (float)(k / JITTER_ROW) - JITTER_ROW / 2;
        for (size_t i = 0; i < batch.lanes; i++) {
            hash[i] = 1664525u * hash[i] + 1013904223u;
            const float width = batch.reach[i] * (2.0f / JITTER_ROW);
            batch.dx[i] = width * (left + (float)(int32_t)(hash[i] >> 24) * 0x1p-8f);
            batch.dy[i] = width * (top + (float)(int32_t)(hash[i] >> 16 & 255) * 0x1p-8f);
        }
        scatter_add(&batch);
    }
    scatter_finish(&batch, JITTER_ROW * JITTER_ROW, args->visibility);
}

static void pair_of_texels(const float *restrict to_center, const int32_t *restrict own,
                           int32_t second, size_t lanes, int32_t *restrict offset,
                           int32_t *restrict texel) {
    for (size_t i = 0; i < lanes; i++) {
        offset[i] = box_start(to_center[i], 2) + second;
        texel[i] = own[i] + offset[i];
    }
}

/* The smooth box of 2 x 2 texels: four taps of all fragments at a time. */
static void bilinear(const shb_filter_args *args) {
    scatter_batch batch;
    SHB_ALIGN int32_t shadowed[2][SHB_BATCH];
    SHB_ALIGN double lit[2][SHB_BATCH];
    const shb_receivers *r = args->receivers;
    scatter_init(args, 0, SHB_UNIT_TEXEL, args->filter->params[2], NULL, NULL, &batch);
    for (int row = 0; row < 2; row++) {
        pair_of_texels(r->to_center_y, r->texel_y, row, batch.lanes, batch.row, batch.texel_y);
        for (int column = 0; column < 2; column++) {
            pair_of_texels(r->to_center_x, r->texel_x, column, batch.lanes, batch.column,
                           batch.texel_x);
            scatter_ask(&batch, shadowed[column]);
        }
        for (size_t i = 0; i < batch.lanes; i++) {
            const double right = last_weight(r->to_center_x[i], 2);
            lit[row][i] = (1 - right) * (1 - shadowed[0][i]) + right * (1 - shadowed[1][i]);
        }
    }
    for (size_t i = 0; i < batch.lanes; i++) {
        const double bottom = last_weight(r->to_center_y[i], 2);
        args->visibility[i] = (float)((1 - bottom) * lit[0][i] + bottom * lit[1][i]);
    }
}

static void pcf_smooth(const shb_filter_args *args) {
    const float *params = args->filter->params;
    if (params[1] != SHB_UNIT_WORLD && !(params[0] >= 2.5f))
        bilinear(args);
    else
        smooth_boxes(args);
}

static void poisson(const shb_filter_args *args) {
    ask_poisson(args, NULL);
}

static void poisson_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    mutual_batch_init(args, &mutual);
    ask_poisson(args, &mutual);
}

static void jittered(const shb_filter_args *args) {
    ask_jittered(args, NULL);
}

static void jittered_exact(const shb_filter_args *args) {
    mutual_batch mutual;
    mutual_batch_init(args, &mutual);
    ask_jittered(args, &mutual);
}
