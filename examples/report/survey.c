#include "survey.h"

#include "group.h"
#include "jobs.h"
#include "machine_name.h"
#include "pictures.h"
#include "progress.h"
#include "timing.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>

/* Hard and soft differ in their methods and in the time that they take. */
typedef struct survey_kind {
    report_methods methods;
    double seconds; /* of all groups so far */
    size_t done, total;
} survey_kind;

typedef struct survey {
    shb_context *context;
    const report_scale *scale;
    survey_kind kinds[2]; /* hard, soft */
    const char *settings, *path;
    char pictures[REPORT_PICTURE_PATH];
    report_rows *rows;
    report_row *fresh; /* of one group */
    report_stage stage;
    const report_scene *staged; /* whose stage it is; NULL: none */
    progress_line progress;
} survey;

void report_settings(const report_options *options, const shb_context *context, char *text,
                     size_t size) {
    const report_scale *scale = report_scale_of(options);
    char machine[96];
    report_machine_name(machine, sizeof machine);
    snprintf(text, size, "%ux%u pixels, %u runs (soft: %u), %u threads, %s, %s",
             (unsigned)scale->size[0], (unsigned)scale->size[1], (unsigned)scale->runs[0],
             (unsigned)scale->runs[1], (unsigned)shb_context_threads(context),
             shb_isa_name(shb_context_isa(context)), machine);
}

static survey_kind *kind_of(survey *s, const report_job *job) {
    return &s->kinds[job->light.degrees > 0];
}

/* Soft shadows have pictures of one map size only, as they are many and large. */
static report_group group_of(survey *s, const report_job *job) {
    const bool pictured = job->light.degrees <= 0 || job->map_size == 1024;
    return (report_group){.scene = job->scene->name,
                          .light = job->light,
                          .map_size = job->map_size,
                          .methods = &kind_of(s, job)->methods,
                          .runs = s->scale->runs[job->light.degrees > 0],
                          .samples = s->scale->samples,
                          .settings = s->settings,
                          .pictures = pictured ? s->pictures : NULL};
}

const uint32_t *report_picture_size(const report_options *options) {
    return report_scale_of(options)->size;
}

/* True if all rows of a group are there. */
static bool is_complete(const survey *s, const report_group *group) {
    for (size_t i = 0; i < group->methods->count; i++) {
        const report_row key = report_group_key(group, &group->methods->methods[i]);
        if (!report_rows_find(s->rows, &key))
            return false;
    }
    return true;
}

/* By the mean of the groups of each kind that are done; before the first, of the other kind. */
static double seconds_left(const survey *s) {
    const survey_kind *hard = &s->kinds[0], *soft = &s->kinds[1];
    double left = 0;
    for (int i = 0; i < 2; i++) {
        const survey_kind *kind = &s->kinds[i], *known = kind->done ? kind : i ? hard : soft;
        if (known->done)
            left += (double)(kind->total - kind->done) * known->seconds / (double)known->done;
    }
    return left;
}

static void show_progress(survey *s, const report_group *group) {
    char step[192], light[32], left[32] = "";
    const double seconds = seconds_left(s);
    report_name_light(group->light, light, sizeof light);
    if (seconds >= 90)
        snprintf(left, sizeof left, ", %.0f min left", seconds / 60);
    else if (seconds > 0)
        snprintf(left, sizeof left, ", %.0f s left", seconds);
    snprintf(step, sizeof step, "%s %s %u%s", group->scene, light, (unsigned)group->map_size, left);
    progress_step(&s->progress, step);
}

static bool set_stage(survey *s, const report_scene *scene) {
    if (s->staged == scene)
        return true;
    report_stage_close(&s->stage);
    s->staged = NULL;
    if (!report_stage_open(s->context, scene->text, scene->name, s->scale->size, &s->stage))
        return false;
    s->staged = scene;
    return true;
}

static bool add_rows(survey *s, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!report_rows_add(s->rows, &s->fresh[i]))
            return tool_succeeds("report", "rows", SHB_ERROR_MEMORY);
    return tool_succeeds("report", s->path,
                         report_rows_append(s->fresh, count, s->path) ? SHB_OK : SHB_ERROR_FILE);
}

static bool run_job(survey *s, const report_job *job) {
    const report_group group = group_of(s, job);
    survey_kind *kind = kind_of(s, job);
    const double start = bench_seconds(BENCH_CLOCK_WALL);
    show_progress(s, &group);
    const bool done =
        set_stage(s, job->scene) &&
        tool_succeeds("report", group.scene, report_group_measure(&group, &s->stage, s->fresh)) &&
        add_rows(s, group.methods->count);
    kind->seconds += bench_seconds(BENCH_CLOCK_WALL) - start;
    kind->done++;
    return done;
}

/* Leaves those that remain to be done. */
static void drop_complete(survey *s, report_jobs *jobs) {
    size_t kept = 0;
    for (size_t i = 0; i < jobs->count; i++) {
        const report_group group = group_of(s, &jobs->jobs[i]);
        if (is_complete(s, &group))
            continue;
        kind_of(s, &jobs->jobs[i])->total++;
        jobs->jobs[kept++] = jobs->jobs[i];
    }
    jobs->count = kept;
}

static bool run_jobs(survey *s, report_jobs *jobs) {
    bool done = true;
    drop_complete(s, jobs);
    progress_begin(&s->progress, jobs->count);
    for (size_t i = 0; done && i < jobs->count; i++)
        done = run_job(s, &jobs->jobs[i]);
    progress_end(&s->progress);
    report_stage_close(&s->stage);
    return done;
}

bool report_survey(shb_context *context, const report_options *options, const char *settings,
                   const char *path, report_rows *rows) {
    survey s = {
        .context = context,
        .scale = report_scale_of(options),
        .kinds = {{.methods = report_list_methods(false)}, {.methods = report_list_methods(true)}},
        .settings = settings,
        .path = path,
        .rows = rows};
    snprintf(s.pictures, sizeof s.pictures, "%s/pictures", options->directory);
    report_pictures_begin(s.pictures, rows->count > 0);
    report_scene_list scenes = report_list_scenes(options);
    report_jobs jobs = report_list_jobs(&scenes, s.scale);
    s.fresh = calloc(s.kinds[0].methods.count + s.kinds[1].methods.count + 1, sizeof *s.fresh);
    const bool room = s.kinds[0].methods.methods && s.kinds[1].methods.methods && s.fresh &&
                      jobs.jobs && !scenes.failed;
    const bool done =
        tool_succeeds("report", "survey", room ? SHB_OK : SHB_ERROR_MEMORY) && run_jobs(&s, &jobs);
    free(s.fresh);
    free(s.kinds[0].methods.methods);
    free(s.kinds[1].methods.methods);
    free(jobs.jobs);
    report_scene_list_free(&scenes);
    return done;
}
