#include "survey.h"

#include "group.h"
#include "pictures.h"
#include "progress.h"
#include "scene_list.h"
#include "stopwatch.h"
#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* How much work a survey does. */
typedef struct survey_scale {
    uint32_t size[2], runs; /* of the picture, pixels */
    uint32_t map_sizes[4];  /* 0 ends them */
} survey_scale;

typedef struct survey {
    shb_context *context;
    const survey_scale *scale;
    report_methods methods;
    const char *settings, *path;
    char pictures[REPORT_PICTURE_PATH];
    report_rows *rows;
    report_row *fresh; /* of one group */
    progress_line progress;
} survey;

static const survey_scale *scale_of(const report_options *options) {
    static const survey_scale full = {{640, 400}, 5, {512, 1024, 2048, 0}};
    static const survey_scale quick = {{480, 300}, 3, {512, 1024, 0}};
    return options->quick ? &quick : &full;
}

void report_settings(const report_options *options, const shb_context *context, char *text,
                     size_t size) {
    const survey_scale *scale = scale_of(options);
    snprintf(text, size, "%ux%u pixels, %u runs, %u threads, %s", (unsigned)scale->size[0],
             (unsigned)scale->size[1], (unsigned)scale->runs,
             (unsigned)shb_context_threads(context), shb_isa_name(shb_context_isa(context)));
}

const uint32_t *report_picture_size(const report_options *options) {
    return scale_of(options)->size;
}

/* True if all rows of a group are there. */
static bool is_complete(const survey *s, const report_group *group) {
    for (size_t i = 0; i < s->methods.count; i++) {
        const report_row key = report_group_key(group, &s->methods.methods[i]);
        if (!report_rows_find(s->rows, &key))
            return false;
    }
    return true;
}

static void show_progress(survey *s, const report_group *group) {
    char step[192];
    progress_line *progress = &s->progress;
    const double elapsed = stopwatch_seconds() - progress->start;
    const size_t done = progress->done, rest = progress->total - done;
    snprintf(step, sizeof step, "%s %s %u, %.0f s left", group->stage->name,
             report_light_name(group->light), (unsigned)group->map_size,
             done ? elapsed * (double)rest / (double)done : 0.0);
    progress_step(progress, step);
}

static bool add_rows(survey *s) {
    for (size_t i = 0; i < s->methods.count; i++)
        if (!report_rows_add(s->rows, &s->fresh[i]))
            return tool_succeeds("report", "rows", SHB_ERROR_MEMORY);
    return tool_succeeds("report", s->path,
                         report_rows_append(s->fresh, s->methods.count, s->path) ? SHB_OK
                                                                                 : SHB_ERROR_FILE);
}

static bool run_group(survey *s, report_stage *stage, scene_light_kind light, uint32_t map_size) {
    const report_group group = {.stage = stage,
                                .light = light,
                                .map_size = map_size,
                                .methods = &s->methods,
                                .runs = s->scale->runs,
                                .settings = s->settings,
                                .pictures = s->pictures};
    show_progress(s, &group);
    return is_complete(s, &group) ||
           (tool_succeeds("report", stage->name, report_group_measure(&group, s->fresh)) &&
            add_rows(s));
}

static bool run_scene(survey *s, const report_scene *scene) {
    report_stage stage;
    bool done = report_stage_open(s->context, scene->text, scene->name, s->scale->size, &stage);
    for (int light = 0; done && light < (scene->both_lights ? SCENE_LIGHT_KINDS : 1); light++)
        for (const uint32_t *map_size = s->scale->map_sizes; done && *map_size; map_size++)
            done = run_group(s, &stage, (scene_light_kind)light, *map_size);
    report_stage_close(&stage);
    return done;
}

static size_t count_groups(const survey *s, const report_scene_list *scenes) {
    size_t lights = 0, sizes = 0;
    for (size_t i = 0; i < scenes->count; i++)
        lights += scenes->scenes[i].both_lights ? SCENE_LIGHT_KINDS : 1;
    while (s->scale->map_sizes[sizes])
        sizes++;
    return lights * sizes;
}

static bool run_scenes(survey *s, const report_scene_list *scenes) {
    bool done = true;
    progress_begin(&s->progress, count_groups(s, scenes));
    for (size_t i = 0; done && i < scenes->count; i++)
        done = run_scene(s, &scenes->scenes[i]);
    progress_end(&s->progress);
    return done;
}

bool report_survey(shb_context *context, const report_options *options, const char *settings,
                   const char *path, report_rows *rows) {
    survey s = {.context = context,
                .scale = scale_of(options),
                .methods = report_list_methods(),
                .settings = settings,
                .path = path,
                .rows = rows};
    snprintf(s.pictures, sizeof s.pictures, "%s/pictures", options->directory);
    mkdir(s.pictures, 0777);
    report_scene_list scenes = report_list_scenes(options);
    s.fresh = calloc(s.methods.count + 1, sizeof *s.fresh);
    const bool room = s.methods.methods && s.fresh && !scenes.failed;
    const bool done = tool_succeeds("report", "survey", room ? SHB_OK : SHB_ERROR_MEMORY) &&
                      run_scenes(&s, &scenes);
    free(s.fresh);
    free(s.methods.methods);
    report_scene_list_free(&scenes);
    return done;
}
