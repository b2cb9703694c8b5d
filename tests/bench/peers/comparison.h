/* The table of a peer beside this library: scenes, timing by turns, rows. */
#ifndef PEERS_COMPARISON_H
#define PEERS_COMPARISON_H

#include "measure.h"
#include "timing.h"
#include "world_mesh.h"

/* One scene as both see it. The camera's frame is 1024 x 1024. */
typedef struct comparison {
    const char *peer;
    char title[48];
    shb_context *context; /* one thread */
    example_scene *scene;
    measure_frame frame;
    world_mesh mesh;
    bench_plan plan;
} comparison;

/* What a row says; times are measured by turns, one thread each. */
typedef struct comparison_row {
    const char *task, *own_method;
    uint32_t map_size;
    bench_comparison build; /* the peer's first; zero: there is none */
    bench_comparison ask;
    size_t fragment_count;                /* that were asked; 0: none */
    double peer_wrong_ppm, own_wrong_ppm; /* against the ray-cast truth; negative: not measured */
} comparison_row;

/* Both pieces of work; the peer's first. False: a line on stderr told why. */
bool comparison_measure(const comparison *c, bench_work peer, bench_work own,
                        bench_comparison *times);

void comparison_print(const comparison *c, const comparison_row *row);

/* Runs compare for every scene that the command line names, or for bunny_69k, sponza and hills as
 * far as they are there. Returns the program's exit code. */
int comparison_run(int argc, char **argv, const char *peer, bool (*compare)(const comparison *c));

#endif
