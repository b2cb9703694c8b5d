/* The loops of asking lists. A question is one triangle's cache line against a run of points. Its
 * lines come from all over the memory, so they are fetched ahead, and what a question says is not
 * branched on: few could be foreseen. */

static void locate_points(const shb_list_frame *frame, shb_list_group *restrict g) {
    const shb_list_frame f = *frame;
    const double *const restrict world[3] = {g->world[0], g->world[1], g->world[2]};
    for (int i = 0; i < SHB_LIST_GROUP; i++) {
        const double px = world[0][i], py = world[1][i], pz = world[2][i];
        const double w = shb_list_row(f.rows[3], px, py, pz), inverse = 1 / w;
        const double x = shb_list_row(f.rows[0], px, py, pz) * inverse;
        const double y = shb_list_row(f.rows[1], px, py, pz) * inverse;
        const double depth = shb_list_row(f.rows[2], px, py, pz) * inverse;
        const double size = list_max(list_max(fabs(px), fabs(py)), fabs(pz));
        const int seen = (w > 0) & (x >= 0) & (x < f.width) & (y >= 0) & (y < f.height) &
                         (fabs(depth) < HUGE_VAL);
        g->x[i] = x;
        g->y[i] = y;
        g->about_x[i] = (float)x;
        g->about_y[i] = (float)y;
        g->depth[i] = depth;
        g->inverse_w[i] = inverse;
        g->scale[i] = size > f.reach ? size / f.reach : 1;
        g->column[i] = (int32_t)(seen ? x : -1.0);
        g->row[i] = (int32_t)(seen ? y : 0.0);
    }
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
#if DOUBLES == 8
    const __m512i step = _mm512_loadu_si512(run->entry);
    const __m256 begins = _mm256_castsi256_ps(_mm512_cvtepi64_epi32(_mm512_srli_epi64(step, 32)));
    const __mmask8 before = _mm256_cmp_ps_mask(begins, _mm256_set1_ps(run->depth), _CMP_LE_OQ);
    const uint32_t taken = before & ((1u << left) - 1);
    const uint32_t rest = (uint32_t)number | (uint32_t)run->first << 8 | (uint32_t)run->open << 16;
    const __m512i made = _mm512_mask_blend_epi32(0xaaaa, step, _mm512_set1_epi32((int32_t)rest));
    _mm512_storeu_si512(questions, _mm512_maskz_compress_epi64((__mmask8)taken, made));
    return (size_t)__builtin_popcount(taken);
#elif DOUBLES == 4
    const __m256 depth = _mm256_set1_ps(run->depth);
    const int32_t rest =
        (int32_t)((uint32_t)number | (uint32_t)run->first << 8 | (uint32_t)run->open << 16);
    const uint32_t most = (1u << left) - 1;
    size_t count = 0;
    for (int half = 0; half < SHB_LIST_STEP; half += 4) {
        const __m256i four = _mm256_loadu_si256((const __m256i *)(const void *)(run->entry + half));
        const __m256 before = _mm256_cmp_ps(_mm256_castsi256_ps(four), depth, _CMP_LE_OQ);
        const uint32_t taken =
            (uint32_t)_mm256_movemask_pd(_mm256_castps_pd(before)) & (most >> half);
        const __m256i made = _mm256_blend_epi32(four, _mm256_set1_epi32(rest), 0xaa);
        const __m256i order = _mm256_loadu_si256((const __m256i *)(const void *)list_pairs[taken]);
        _mm256_storeu_si256((__m256i *)(void *)(questions + count),
                            _mm256_permutevar8x32_epi32(made, order));
        count += (size_t)__builtin_popcount(taken);
    }
    return count;
#else
    size_t count = 0;
    for (size_t i = 0; i < SHB_LIST_STEP; i++) {
        questions[count] = (shb_list_question){.triangle = run->entry[i].triangle,
                                               .run = (uint8_t)number,
                                               .first = run->first,
                                               .asked = run->open};
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
    }
    return taken;
}

/* Questions whose triangles are fetched before they are asked. */
enum { LIST_ASK_AHEAD = 24 };

/* gcc takes a function that does nothing else for one without effect, unless it is inlined first.
 */
static inline __attribute__((always_inline)) void fetch_asked(const shb_list_triangle *triangles,
                                                              const shb_list_question *questions,
                                                              size_t number, size_t count) {
    if (number < count)
        __builtin_prefetch(&triangles[questions[number].triangle]);
}

/* The points of a run that lie on the triangle. */
static inline uint32_t own_points(const shb_list_group *g, uint32_t triangle, size_t first) {
    uint32_t own = 0;
    for (int lane = 0; lane < SHB_LIST_RUN; lane += WIDE)
        own |= vi_bits((vi)(vu_load(g->own + first + lane) == triangle)) << lane;
    return own;
}

/* Keeps the points whose rays the triangle may meet, its own apart. Those that pass no edge are
 * marked in doubt for the time being. */
static inline __attribute__((always_inline)) size_t
keep_covered(const shb_list_triangle *triangles, const shb_list_group *g, bool has_own,
             shb_list_question *questions, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count && i < LIST_ASK_AHEAD; i++)
        fetch_asked(triangles, questions, i, count);
    for (size_t i = 0; i < count; i++) {
        fetch_asked(triangles, questions, i + LIST_ASK_AHEAD, count);
        shb_list_question q = questions[i];
        const shb_list_triangle *t = &triangles[q.triangle];
        const float margin = 2 * t->margin;
        uint32_t covered = 0, inside = 0;
        for (int lane = 0; lane < SHB_LIST_RUN; lane += WIDE) {
            const vf x = vf_load(g->about_x + q.first + lane);
            const vf y = vf_load(g->about_y + q.first + lane);
            const vf u = (t->u[0] * x + t->u[1] * y) + t->u[2];
            const vf v = (t->v[0] * x + t->v[1] * y) + t->v[2];
            const vf least = vf_min(vf_min(u, v), (t->rest - u) - v);
            const vm covers = vm_not_above(vf_splat(0), least);
            covered |= vm_bits(covers) << lane;
            inside |= vm_bits(vm_below(covers, vf_splat(margin), least)) << lane;
        }
        if (has_own)
            covered &= ~own_points(g, q.triangle, q.first);
        q.asked = (uint8_t)(q.asked & covered);
        q.doubt = (uint8_t)inside;
        questions[kept] = q;
        kept += q.asked != 0;
    }
    return kept;
}

/* How much each coordinate of a point changes its distance behind the plane, before the division by
 * w. */
static inline void list_changes(const shb_list_frame *frame, const shb_list_triangle *t,
                                double changes[3]) {
    const double(*rows)[4] = frame->rows;
    for (int i = 0; i < 3; i++)
        changes[i] = fabs((rows[2][i] + t->plane[0] * rows[0][i]) +
                          (t->plane[1] * rows[1][i] + t->plane[2] * rows[3][i]));
}

static size_t answer_questions(const shb_list_frame *frame, const shb_list_triangle *triangles,
                               const shb_list_group *g, double rounding,
                               shb_list_question *questions, size_t count) {
    const size_t covered = g->has_own ? keep_covered(triangles, g, true, questions, count)
                                      : keep_covered(triangles, g, false, questions, count);
    const bool is_rounded = rounding > 0;
    const wd unit = wd_splat((1 + 0x1p-20) * rounding);
    size_t kept = 0;
    for (size_t i = 0; i < covered; i++) {
        shb_list_question q = questions[i];
        const shb_list_triangle *t = &triangles[q.triangle];
        const wd bound = wd_splat((double)(is_rounded ? t->bound : -t->bound));
        const wd clear = wd_splat((double)t->clear);
        double changes[3];
        list_changes(frame, t, changes);
        uint32_t behind = 0, clearly = 0;
        for (int lane = 0; lane < SHB_LIST_RUN; lane += DOUBLES) {
            const size_t at = (size_t)(q.first + lane);
            const wd distance = ((wd_splat(t->plane[0]) * wd_load(g->x + at) +
                                  wd_splat(t->plane[1]) * wd_load(g->y + at)) +
                                 wd_splat(t->plane[2])) +
                                wd_load(g->depth + at);
            const wd moved = (wd_splat(changes[0]) * wd_abs(wd_load(g->world[0] + at)) +
                              wd_splat(changes[1]) * wd_abs(wd_load(g->world[1] + at))) +
                             wd_splat(changes[2]) * wd_abs(wd_load(g->world[2] + at));
            const wd least = bound + (moved * wd_load(g->inverse_w + at)) * unit;
            behind |= wd_greater_bits(distance, least) << lane;
            clearly |= wd_greater_bits(distance, clear) << lane;
        }
        const uint32_t met = q.asked & behind;
        q.asked = (uint8_t)(met & q.doubt & (is_rounded ? behind : clearly));
        q.doubt = (uint8_t)(met & ~(uint32_t)q.asked);
        questions[kept] = q;
        kept += met != 0;
    }
    return kept;
}
