/* From points to questions: where the light sees them, in which cells, which entries of these begin
 * in front of them. */

static void place_points(const shb_list_frame *frame, shb_list_group *restrict g) {
    const shb_list_frame f = *frame;
    const double *const restrict world[3] = {g->world[0], g->world[1], g->world[2]};
    const int count = (int)((g->count + LIST_LANES - 1) / LIST_LANES * LIST_LANES);
    int outside = 0;
    for (int i = 0; i < count; i++) {
        const double px = world[0][i], py = world[1][i], pz = world[2][i];
        const double w = shb_list_row(f.rows[3], px, py, pz), inverse = 1 / w;
        const double x = shb_list_row(f.rows[0], px, py, pz) * inverse;
        const double y = shb_list_row(f.rows[1], px, py, pz) * inverse;
        const double depth = shb_list_row(f.rows[2], px, py, pz) * inverse;
        const double size = double_max(double_max(fabs(px), fabs(py)), fabs(pz));
        const int seen = (w > 0) & (x >= 0) & (x < f.width) & (y >= 0) & (y < f.height) &
                         (fabs(depth) < HUGE_VAL);
        g->x[i] = x;
        g->y[i] = y;
        g->about_x[i] = (float)x;
        g->about_y[i] = (float)y;
        g->about_depth[i] = (float)depth;
        g->depth[i] = depth;
        g->inverse_w[i] = inverse;
        g->scale[i] = size > f.reach ? size / f.reach : 1;
        outside |= size > f.reach;
        g->texel[i] = (int32_t)(seen ? x : -1.0) | (int32_t)(seen ? y : 0.0) << 16;
    }
    g->has_outside = outside;
}

static void find_least_size(shb_list_group *g) {
    const wd none = wd_splat(0), most = wd_splat(HUGE_VAL);
    wd least = most;
    for (size_t i = 0; i < g->count; i += DOUBLES) {
        const wd x = wd_abs(wd_load(g->world[0] + i)), y = wd_abs(wd_load(g->world[1] + i));
        const wd z = wd_abs(wd_load(g->world[2] + i)), inverse = wd_load(g->inverse_w + i);
        const wd size = wd_max(wd_max(x, y), z) * inverse;
        least = wd_min(wd_where_greater(inverse, none, size, most), least);
    }
    g->least_size = least_lane(least);
}

/* The cells of texels that lie in this tile. */
static inline vi cells_in_tile(const shb_list_tile *tile, vi texel) {
    const int bits = tile->cell_bits;
    if (bits < 0)
        return vi_splat(-1);
    const vi column = (texel & (SHB_LIST_TILE - 1)) >> bits;
    const vi row = (texel >> 16 & (SHB_LIST_TILE - 1)) >> bits;
    return (row << (SHB_LIST_TILE_BITS - bits)) + column + (int32_t)tile->first_cell;
}

/* Neighbours seldom lie in more than two tiles. */
static void find_point_cells(const shb_list_grid *grid, shb_list_group *restrict g) {
    for (size_t i = 0; i < g->count; i += WIDE) {
        const vi texel = vi_load(g->texel + i);
        const vi tile_row = texel >> (16 + SHB_LIST_TILE_BITS);
        const vi tile_column = texel >> SHB_LIST_TILE_BITS & (0xffff >> SHB_LIST_TILE_BITS);
        const vi tile = (vi)(vu_times_short((vu)tile_row, grid->columns) + (vu)tile_column);
        vi cell = vi_splat(-1);
        for (uint32_t left = vi_bits(texel >= 0); left;) {
            const int32_t number = tile[__builtin_ctz(left)];
            const vi is_there = tile == number;
            cell = (cells_in_tile(&grid->tiles[number], texel) & is_there) | (cell & ~is_there);
            left &= ~vi_bits(is_there);
        }
        vi_store(g->cell + i, cell);
    }
}

static size_t locate_points(const shb_list_frame *frame, const shb_list_grid *grid,
                            shb_list_group *restrict g,
                            int32_t changes[SHB_LIST_POINTS + LIST_LANES]) {
    size_t count = 1;
    place_points(frame, g);
    find_least_size(g);
    find_point_cells(grid, g);
    changes[0] = 0;
    for (size_t i = 1; i < g->count; i += WIDE) {
        const size_t left = g->count - i;
        const uint32_t lanes = left < WIDE ? (1u << left) - 1 : ~0u;
        const vi differs = vi_load(g->cell + i) != vi_load(g->cell + i - 1);
        const uint32_t bits = vi_bits(differs) & lanes;
        vi_append(changes, count, vi_numbers() + (int32_t)i, bits);
        count += (size_t)__builtin_popcount(bits);
    }
    return count;
}

/* The largest of the depths of count points. */
static inline float deepest_of(const float *depths, size_t count) {
    const vf none = vf_splat(-HUGE_VALF);
    vf deepest = none;
    for (int lane = 0; lane < SHB_LIST_RUN; lane += WIDE) {
        const vi is_counted = vi_numbers() + lane < (int32_t)count;
        deepest = vf_max(vf_where(is_counted, vf_load(depths + lane), none), deepest);
    }
    return -vf_least(-deepest);
}

/* Points of a run that lie behind a depth. */
static inline uint32_t points_behind(const double *depths, double far) {
    uint32_t behind = 0;
    for (int lane = 0; lane < SHB_LIST_RUN; lane += DOUBLES)
        behind |= wd_greater_bits(wd_load(depths + lane), wd_splat(far)) << lane;
    return behind;
}

static size_t start_runs(const shb_list_group *g, const shb_list_span *spans, size_t count,
                         shb_list_run *runs, float *visibility) {
    size_t made = 0;
    for (size_t s = 0; s < count; s++) {
        const shb_list_cell *cell = spans[s].cell;
        const shb_list_entry *entries = spans[s].entries;
        const size_t end = spans[s + 1].first;
        for (size_t at = spans[s].first; at < end; at += SHB_LIST_RUN) {
            const size_t points = end - at < SHB_LIST_RUN ? end - at : SHB_LIST_RUN;
            const size_t first =
                at < SHB_LIST_POINTS - SHB_LIST_RUN ? at : SHB_LIST_POINTS - SHB_LIST_RUN;
            const uint32_t all = ((1u << points) - 1) << (at - first);
            const uint32_t behind = all & points_behind(g->depth + first, (double)cell[0].far);
            const uint32_t open = all & ~behind;
            for (uint32_t bits = behind; bits; bits &= bits - 1)
                visibility[first + (size_t)__builtin_ctz(bits)] = 0;
            runs[made] = (shb_list_run){.entry = entries + cell[0].start,
                                        .end = entries + cell[1].start,
                                        .depth = deepest_of(g->about_depth + at, points),
                                        .first = (uint8_t)first,
                                        .open = (uint8_t)open};
            __builtin_prefetch(runs[made].entry);
            __builtin_prefetch(runs[made].entry + SHB_LIST_STEP - 1);
            made += (open != 0) & (cell[0].start != cell[1].start);
        }
    }
    return made;
}

#if DOUBLES == 4
/* The numbers of those of four pairs of lanes whose bits are set. */
static const int32_t list_pairs[16][8] = {{0},
                                          {0, 1},
                                          {2, 3},
                                          {0, 1, 2, 3},
                                          {4, 5},
                                          {0, 1, 4, 5},
                                          {2, 3, 4, 5},
                                          {0, 1, 2, 3, 4, 5},
                                          {6, 7},
                                          {0, 1, 6, 7},
                                          {2, 3, 6, 7},
                                          {0, 1, 2, 3, 6, 7},
                                          {4, 5, 6, 7},
                                          {0, 1, 4, 5, 6, 7},
                                          {2, 3, 4, 5, 6, 7},
                                          {0, 1, 2, 3, 4, 5, 6, 7}};
#endif

/* Questions of those of a run's next entries that do not begin behind its depth. */
static inline size_t take_step(const shb_list_run *run, size_t number, size_t left,
                               shb_list_question *questions) {
    const uint32_t bytes = (uint32_t)number | (uint32_t)run->first << SHB_LIST_FIRST |
                           (uint32_t)run->open << SHB_LIST_ASKED;
#if DOUBLES == 8
    const __m512i step = _mm512_loadu_si512(run->entry);
    const __m256 begins = _mm256_castsi256_ps(_mm512_cvtepi64_epi32(_mm512_srli_epi64(step, 32)));
    const __mmask8 before = _mm256_cmp_ps_mask(begins, _mm256_set1_ps(run->depth), _CMP_LE_OQ);
    const uint32_t taken = before & ((1u << left) - 1);
    const __m512i made = _mm512_mask_blend_epi32(0xaaaa, step, _mm512_set1_epi32((int32_t)bytes));
    _mm512_storeu_si512(questions, _mm512_maskz_compress_epi64((__mmask8)taken, made));
    return (size_t)__builtin_popcount(taken);
#elif DOUBLES == 4
    const __m256 depth = _mm256_set1_ps(run->depth);
    const uint32_t most = (1u << left) - 1;
    size_t count = 0;
    for (int half = 0; half < SHB_LIST_STEP; half += 4) {
        const __m256i four = _mm256_loadu_si256((const __m256i *)(const void *)(run->entry + half));
        const __m256 before = _mm256_cmp_ps(_mm256_castsi256_ps(four), depth, _CMP_LE_OQ);
        const uint32_t taken =
            (uint32_t)_mm256_movemask_pd(_mm256_castps_pd(before)) & (most >> half);
        const __m256i made = _mm256_blend_epi32(four, _mm256_set1_epi32((int32_t)bytes), 0xaa);
        const __m256i order = _mm256_loadu_si256((const __m256i *)(const void *)list_pairs[taken]);
        _mm256_storeu_si256((__m256i *)(void *)(questions + count),
                            _mm256_permutevar8x32_epi32(made, order));
        count += (size_t)__builtin_popcount(taken);
    }
    return count;
#else
    size_t count = 0;
    for (size_t i = 0; i < SHB_LIST_STEP; i++) {
        questions[count] = (shb_list_question){run->entry[i].triangle, bytes};
        count += (i < left) & (run->entry[i].begin <= run->depth);
    }
    return count;
#endif
}

static size_t take_entries(shb_list_run *runs, size_t count, shb_list_question *questions) {
    size_t taken = 0;
    for (size_t i = 0; i < count; i++) {
        shb_list_run *run = &runs[i];
        const size_t left = (size_t)(run->end - run->entry);
        const size_t step = left < SHB_LIST_STEP ? left : SHB_LIST_STEP;
        taken += take_step(run, i, step, questions + taken);
        run->entry += step;
        __builtin_prefetch(run->entry);
        __builtin_prefetch(run->entry + SHB_LIST_STEP - 1);
    }
    return taken;
}
