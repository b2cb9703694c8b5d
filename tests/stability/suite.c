#include "suite.h"

#include "progress.h"
#include "timing.h"
#include "tool.h"

#include <stdio.h>
#include <string.h>

bool stability_wants_method(const stability_options *options, const char *name) {
    return !options->method || strcmp(options->method, name) == 0;
}

bool stability_wants_case(const stability_options *options, const stability_case *c) {
    if (options->subject)
        return strcmp(options->subject, c->name) == 0 && stability_case_exists(c);
    return (c->quick || !options->quick) && stability_case_exists(c);
}

static bool add_row(stability_rows *rows, const stability_stage *stage, const stability_case *c,
                    const char *method, stability_setting setting, const shb_errors *errors) {
    return stability_rows_add(
        rows, (stability_row){c, method, setting, stability_rates_of(errors), stage->map.width});
}

/* Both settings of a method; one without a parameter has nothing to tune. */
static shb_result run_method(stability_stage *stage, const stability_case *c,
                             const listed_method *method, stability_rows *rows) {
    shb_errors errors;
    shb_result result = stability_measure(stage, method, &errors);
    if (!result && !add_row(rows, stage, c, method->name, STABILITY_DEFAULT, &errors))
        return SHB_ERROR_MEMORY;
    if (result || !method->method->param_names[0])
        return result;
    result = stability_tune(stage, method, &errors);
    if (!result && !add_row(rows, stage, c, method->name, STABILITY_TUNED, &errors))
        return SHB_ERROR_MEMORY;
    return result;
}

static shb_result run_certain(const stability_stage *stage, const stability_case *c,
                              stability_rows *rows) {
    stability_certain certain = {.subject = c};
    const shb_result result = stability_ask_certain(stage, &certain);
    if (!result && !stability_rows_add_certain(rows, certain))
        return SHB_ERROR_MEMORY;
    return result;
}

shb_result stability_open(shb_context *context, const stability_options *options,
                          const stability_case *c, uint32_t reach, stability_stage *stage) {
    const uint32_t width = options->quick ? 160 : 320, height = options->quick ? 120 : 240;
    const shb_result result =
        stability_stage_open(context, c, width, height, options->map_size, reach, stage);
    return !result && options->named ? stability_name_points(stage) : result;
}

static bool run_case(shb_context *context, const stability_options *options,
                     const stability_case *c, void *rows) {
    stability_stage stage;
    bool done = tool_succeeds("stability", c->name, stability_open(context, options, c, 1, &stage));
    listed_method method;
    for (size_t i = 0; done && method_list_at(i, &method); i++)
        if (stability_wants_method(options, method.name))
            done = tool_succeeds("stability", method.name, run_method(&stage, c, &method, rows));
    if (done && !options->method)
        done = tool_succeeds("stability", "certain", run_certain(&stage, c, rows));
    stability_stage_close(&stage);
    return done;
}

static size_t count_cases(const stability_options *options) {
    size_t count = 0;
    const stability_case *c;
    for (size_t i = 0; (c = stability_case_at(i)) != NULL; i++)
        count += stability_wants_case(options, c);
    return count;
}

static void show_progress(progress_line *progress, const stability_case *c) {
    char step[96];
    const double elapsed = bench_seconds(BENCH_CLOCK_WALL) - progress->start;
    const size_t done = progress->done, rest = progress->total - done;
    snprintf(step, sizeof step, "%s, %.0f s left", c->name,
             done ? elapsed * (double)rest / (double)done : 0.0);
    progress_step(progress, step);
}

bool stability_each_case(shb_context *context, const stability_options *options,
                         stability_case_fn *run, void *user) {
    progress_line progress;
    progress_begin(&progress, count_cases(options));
    bool succeeds = true;
    const stability_case *c;
    for (size_t i = 0; succeeds && (c = stability_case_at(i)) != NULL; i++) {
        if (!stability_wants_case(options, c))
            continue;
        show_progress(&progress, c);
        succeeds = run(context, options, c, user);
    }
    progress_end(&progress);
    return succeeds;
}

bool stability_run(shb_context *context, const stability_options *options, stability_rows *rows) {
    return stability_each_case(context, options, run_case, rows);
}
