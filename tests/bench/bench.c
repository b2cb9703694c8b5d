/* Times of every stage over many scenes, beside the machine's limits and the scalar reference. */
#include "goals.h"
#include "soft_shadows.h"
#include "stages.h"
#include "subjects.h"
#include "tool.h"

#include <stdio.h>

static bool list_scenes(const bench_options *options, subject_list *list) {
    if (options->scene)
        return subject_list_add(list, options->scene);
    if (!options->quick)
        return subject_list_all(options->folder, list);
    /* The first one alone is shaded. */
    return subject_list_add(list, "columns") && subject_list_add(list, "height-field");
}

static bool measure_scene(bench_session *session, const char *name, bool with_light) {
    char error[512], title[48];
    example_scene *scene = NULL;
    if (!subject_open(name, &scene, error, sizeof error)) {
        fprintf(stderr, "bench: %s\n", error);
        return false;
    }
    subject_title(name, title, sizeof title);
    const bool done = stages_draw(session, scene, title) &&
                      (!with_light || (stages_moving(session, scene, title) &&
                                       stages_light(session, scene, title)));
    scene_close(scene);
    return done;
}

static bool measure_scenes(bench_session *session) {
    static const char *const groups[] = {"depth",  "camera",     "dual",  "cull", "prepare",
                                         "moving", "visibility", "shade", "frame"};
    bool wanted = false;
    for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
        wanted |= options_want(&session->options, groups[i], NULL);
    if (!wanted)
        return true;
    subject_list list = {0};
    bool done = list_scenes(&session->options, &list);
    if (!done)
        fprintf(stderr, "bench: no memory for the list of scenes\n");
    progress_begin(&session->progress, list.count * 9);
    for (size_t i = 0; i < list.count && done; i++)
        done = measure_scene(session, list.names[i], i == 0 || !session->options.quick);
    progress_end(&session->progress);
    subject_list_free(&list);
    return done;
}

/* Goals, ratios and soft shadows have scenes of their own. */
static bool measure_goals(bench_session *session) {
    const bench_options *options = &session->options;
    if (options->scene || options->size)
        return true;
    progress_begin(&session->progress, 16);
    return (!options_want(options, "goals", NULL) || goals_measure(session)) &&
           (!options_want(options, "ratios", NULL) || ratios_measure(session)) &&
           (!options_want(options, "soft", NULL) ||
            (soft_measure_tables(session) && soft_measure_goals(session)));
}

int main(int argc, char **argv) {
    bench_options options;
    bench_session session;
    int exit_code;
    if (!options_read(argc, argv, &options, &exit_code))
        return exit_code;
    bool done = session_open(&options, &session);
    if (done) {
        report_begin(&session);
        done = measure_scenes(&session) && measure_goals(&session);
    }
    session_close(&session);
    return done ? TOOL_OK : TOOL_FAILED;
}
