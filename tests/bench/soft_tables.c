/* Tables 1 and 2 of Ehm et al. 2015, rebuilt: map, shading and overall times of a picture of
 * 1024 x 768, each method measured by turns with the receiver plane's, and the ratio beside the
 * paper's (a graphics card's). */
#include "soft_shadows.h"

#include "ehm_tables.h"

#include <stdio.h>

/* Times of a row and of the receiver plane's, by turns. */
static shb_result measure_times(const bench_session *session, soft_work *work, soft_work *beside,
                                bench_times *visibility, bench_soft *measured) {
    const bench_plan plan = {session->options.quick ? 2 : 5, 0.02};
    soft_work_times times[2];
    shb_result result = soft_work_compare(work, beside, plan, times);
    if (!result)
        result = bench_measure(soft_work_visibility(work), BENCH_CLOCK_THREAD, plan, visibility);
    if (result)
        return result;
    measured->map_seconds = times[0].map;
    measured->shade_seconds = times[0].shade;
    measured->ratio = (times[0].map + times[0].shade) / (times[1].map + times[1].shade);
    return SHB_OK;
}

static shb_result measure_errors(const ehm_subject *subject, const ehm_row *row,
                                 bench_soft *measured) {
    shb_soft_errors errors;
    const shb_result result = ehm_judge(subject, row, &errors);
    if (result)
        return result;
    measured->rms = errors.rms;
    measured->similarity = errors.similarity;
    return SHB_OK;
}

static bool measure_row(bench_session *session, const ehm_subject *subject, const ehm_row *row,
                        soft_work *beside) {
    bench_row reported = {.triangles = subject->scene->triangle_count,
                          .size = EHM_MAP_SIZE,
                          .isa = shb_context_isa(session_single(session)),
                          .threads = 1,
                          .items = (double)subject->timed.fragment_count,
                          .by_fragment = true,
                          .soft = {.paper = row->paper}};
    snprintf(reported.stage, sizeof reported.stage, "soft:%s", row->name);
    snprintf(reported.scene, sizeof reported.scene, "tree");
    soft_work work;
    progress_step(&session->progress, row->name);
    if (!session_succeeds(row->name, ehm_work(subject, row, EHM_MAP_SIZE, &work)))
        return false;
    const bool done = session_succeeds(row->name, measure_times(session, &work, beside,
                                                                &reported.times, &reported.soft)) &&
                      session_succeeds(row->name, measure_errors(subject, row, &reported.soft));
    soft_work_destroy(&work);
    if (done)
        report_soft(session, &reported);
    return done;
}

static bool measure_table(bench_session *session, const ehm_subject *subject, int table) {
    size_t count;
    const ehm_row *rows = ehm_rows(table, &count);
    soft_work beside = {0};
    bool done = true;
    report_soft_heading(session,
                        table == 0 ? "PCF over boxes of texels" : "PCSS, 25 taps search blockers");
    for (size_t i = 0; i < count && done; i++) {
        if (!soft_work_is_served(rows[i].bias, rows[i].filter))
            continue;
        if (rows[i].paper == 1) {
            soft_work_destroy(&beside);
            done =
                session_succeeds(rows[i].name, ehm_work(subject, &rows[i], EHM_MAP_SIZE, &beside));
        }
        done = done && measure_row(session, subject, &rows[i], &beside);
    }
    soft_work_destroy(&beside);
    return done;
}

bool soft_measure_tables(bench_session *session) {
    const ehm_desc desc = {.single = session_single(session),
                           .several = session->two,
                           .size = {1024, 768},
                           .truth_size = {320, 240},
                           .samples = session->options.quick ? 64 : 1024};
    ehm_subject subject;
    progress_step(&session->progress, "truth");
    bool done = session_succeeds("tree", ehm_open(&desc, &subject));
    for (int table = 0; table < EHM_TABLES && done; table++)
        done = measure_table(session, &subject, table);
    ehm_close(&subject);
    return done;
}
