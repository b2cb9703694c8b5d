#include "comparison.h"

#include "subjects.h"
#include "tool.h"

#include <stdio.h>

enum { FRAME_SIZE = 1024 };

bool comparison_measure(const comparison *c, bench_work peer, bench_work own,
                        bench_comparison *times) {
    return tool_succeeds(c->peer, c->title,
                         bench_compare(peer, own, BENCH_CLOCK_THREAD, c->plan, times));
}

static double ms(const bench_times *times) {
    return 1e3 * times->median;
}

void comparison_print(const comparison *c, const comparison_row *row) {
    const double peer = ms(&row->build.first) + ms(&row->ask.first);
    const double own = ms(&row->build.second) + ms(&row->ask.second);
    printf("%s\t%s\t%llu\t%s\t%s\t%u\t%zu\t%.3f\t%.3f\t%.3f\t%.3f\t%.2f\t%.0f\t%.0f\n", c->peer,
           c->title, (unsigned long long)c->scene->triangle_count, row->task, row->own_method,
           (unsigned)row->map_size, row->fragment_count, ms(&row->build.first), ms(&row->ask.first),
           ms(&row->build.second), ms(&row->ask.second), peer / own, row->peer_wrong_ppm,
           row->own_wrong_ppm);
    fflush(stdout);
}

static bool compare_scene(comparison *c, bool (*compare)(const comparison *c)) {
    bool done = tool_succeeds(
        c->peer, c->title,
        measure_frame_create(c->context, c->scene, FRAME_SIZE, FRAME_SIZE, &c->frame));
    if (done) {
        done = world_mesh_create(&c->scene->scene, &c->mesh) && compare(c);
        world_mesh_free(&c->mesh);
        measure_frame_destroy(&c->frame);
    }
    return done;
}

/* Scenes of the command line must be there; those that stand in for them need not. */
static bool open_and_compare(comparison *c, const char *name, bool required,
                             bool (*compare)(const comparison *c)) {
    char error[512];
    example_scene *scene = NULL;
    if (required && !subject_open(name, &scene, error, sizeof error)) {
        fprintf(stderr, "%s: %s\n", c->peer, error);
        return false;
    }
    if (!required && !(scene = subject_open_if_there("../shared/scenes", name)))
        return true;
    c->scene = scene;
    subject_title(name, c->title, sizeof c->title);
    const bool done = compare_scene(c, compare);
    scene_close(scene);
    return done;
}

int comparison_run(int argc, char **argv, const char *peer, bool (*compare)(const comparison *c)) {
    static const char *const standard[] = {"bunny_69k", "sponza", "hills"};
    comparison c = {.peer = peer, .plan = {7, 1.0}};
    c.context = tool_create_context(peer, 1, SHB_ISA_BEST);
    bool done = c.context != NULL;
    printf("peer\tscene\ttriangles\ttask\town_method\tmap_size\tfragments\tpeer_build_ms\t"
           "peer_ask_ms\town_build_ms\town_ask_ms\ttimes_faster\tpeer_wrong_ppm\town_wrong_ppm\n");
    for (int i = 1; i < argc && done; i++)
        done = open_and_compare(&c, argv[i], true, compare);
    for (size_t i = 0; argc == 1 && i < sizeof standard / sizeof *standard && done; i++)
        done = open_and_compare(&c, standard[i], false, compare);
    shb_context_destroy(c.context);
    return done ? TOOL_OK : TOOL_FAILED;
}
