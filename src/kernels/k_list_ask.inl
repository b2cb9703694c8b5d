/* The loops of asking lists. A question is about one triangle and a run of points. Triangles lie
 * all over the memory, so their cache lines are fetched ahead; and nothing branches on an answer,
 * as few branches would be predicted. */

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
        const size_t first = shb_list_byte(&q, SHB_LIST_FIRST);
        const shb_list_triangle *t = &triangles[q.triangle];
        const float margin = 2 * t->margin;
        uint32_t covered = 0, inside = 0;
        for (int lane = 0; lane < SHB_LIST_RUN; lane += WIDE) {
            const vf x = vf_load(g->about_x + first + lane);
            const vf y = vf_load(g->about_y + first + lane);
            const vf u = (t->u[0] * x + t->u[1] * y) + t->u[2];
            const vf v = (t->v[0] * x + t->v[1] * y) + t->v[2];
            const vf least = vf_min(vf_min(u, v), (t->rest - u) - v);
            covered |= vm_bits(vm_not_above(vf_splat(0), least)) << lane;
            inside |= vm_bits(vm_less(vf_splat(margin), least)) << lane;
        }
        if (has_own)
            covered &= ~own_points(g, q.triangle, first);
        const uint32_t asked = q.bytes & covered << SHB_LIST_ASKED;
        q.bytes = (q.bytes & 0xffff) | asked | inside << SHB_LIST_DOUBT;
        questions[kept] = q;
        kept += asked != 0;
    }
    return kept;
}

static size_t answer_questions(const shb_list_frame *frame, const shb_list_triangle *triangles,
                               const shb_list_group *g, double rounding,
                               shb_list_question *questions, size_t count) {
    const size_t covered = g->has_own ? keep_covered(triangles, g, true, questions, count)
                                      : keep_covered(triangles, g, false, questions, count);
    const bool is_rounded = rounding > 0;
    const double least_rounding = 0.5 * rounding * g->least_size;
    const wd unit = wd_splat((1 + 0x1p-20) * rounding);
    size_t kept = 0;
    for (size_t i = 0; i < covered; i++) {
        shb_list_question q = questions[i];
        const size_t first = shb_list_byte(&q, SHB_LIST_FIRST);
        const shb_list_triangle *t = &triangles[q.triangle];
        double changes[3];
        shb_list_changes(frame, t, changes);
        const double most = ((changes[0] + changes[1]) + changes[2]) * least_rounding;
        const double bound = (double)t->bound, clear = (double)t->clear;
        const wd least = wd_splat(bound <= most ? bound : -bound);
        const wd sure_from = wd_splat(is_rounded ? bound : clear);
        uint32_t behind = 0, clearly = 0;
        for (int lane = 0; lane < SHB_LIST_RUN; lane += DOUBLES) {
            const size_t at = first + (size_t)lane;
            const wd distance = ((wd_splat(t->plane[0]) * wd_load(g->x + at) +
                                  wd_splat(t->plane[1]) * wd_load(g->y + at)) +
                                 wd_splat(t->plane[2])) +
                                wd_load(g->depth + at);
            const wd moved = (wd_splat(changes[0]) * wd_abs(wd_load(g->world[0] + at)) +
                              wd_splat(changes[1]) * wd_abs(wd_load(g->world[1] + at))) +
                             wd_splat(changes[2]) * wd_abs(wd_load(g->world[2] + at));
            const wd rounded = (moved * wd_load(g->inverse_w + at)) * unit;
            behind |= wd_greater_bits(distance, rounded + least) << lane;
            clearly |= wd_greater_bits(distance, rounded + sure_from) << lane;
        }
        const uint32_t met = shb_list_byte(&q, SHB_LIST_ASKED) & behind;
        const uint32_t sure = shb_list_byte(&q, SHB_LIST_DOUBT) & clearly;
        q.bytes =
            (q.bytes & 0xffff) | (met & sure) << SHB_LIST_ASKED | (met & ~sure) << SHB_LIST_DOUBT;
        questions[kept] = q;
        kept += met != 0;
    }
    return kept;
}
