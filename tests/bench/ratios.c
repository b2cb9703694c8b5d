#include "goals.h"

#include "light_work.h"
#include "subjects.h"

#include <stdio.h>
#include <string.h>

/* Of maps, where nothing else is said. */
#define RATIO_SIZE 2048

/* Scenes for ratios of drawings, left out where their file is missing. */
static const char *const drawn_scenes[] = {"bunny_69k", "sponza", "littlest_tokyo", "height-field"};
enum { DRAWN_SCENES = sizeof drawn_scenes / sizeof *drawn_scenes };

/* A pair of drawings of one scene as its light sees it. */
typedef struct draw_ratio {
    const char *name;
    draw_images first_images, second_images;
    shb_context *first, *second;
    bench_clock clock;
    double goals[DRAWN_SCENES]; /* 0: not measured */
    bool at_least;
} draw_ratio;

/* A drawing of a map. */
typedef struct map_work {
    shb_map *map;
    const shb_scene *scene;
} map_work;

static bench_row start_row(const char *name, const char *scene, const example_scene *drawn,
                           uint32_t size, const shb_context *context, double goal) {
    bench_row row = {.triangles = drawn->triangle_count,
                     .size = size,
                     .isa = shb_context_isa(context),
                     .threads = shb_context_threads(context),
                     .items = (double)drawn->triangle_count,
                     .goal = goal};
    snprintf(row.stage, sizeof row.stage, "ratio:%s", name);
    snprintf(row.scene, sizeof row.scene, "%s", scene);
    return row;
}

/* Measures a pair by turns and reports the ratio; the row's times are those of the first. */
static bool report_pair(bench_session *session, bench_work first, bench_work second,
                        bench_clock clock, bool at_least, bench_row *row) {
    bench_comparison pair;
    const shb_result result = bench_compare(first, second, clock, session->plan, &pair);
    if (!session_succeeds(row->stage, result))
        return false;
    row->times = pair.first;
    row->measured = pair.ratio;
    report_goal(session, row, "  ", pair.least_ratio, at_least);
    return true;
}

static shb_result create_draw(shb_context *context, const example_scene *scene, uint32_t size,
                              draw_images images, draw_work *work) {
    shb_view view;
    const shb_result result = scene_light_view(scene, SCENE_DIRECTIONAL, size, false, &view);
    return result ? result
                  : draw_work_create(context, &scene->scene, &view, size, size, images, work);
}

static bool measure_draw_ratio(bench_session *session, const draw_ratio *ratio,
                               const example_scene *scene, int index) {
    draw_work first = {0}, second = {0};
    bench_row row = start_row(ratio->name, drawn_scenes[index], scene, RATIO_SIZE, ratio->first,
                              ratio->goals[index]);
    bool done = session_succeeds(row.stage, create_draw(ratio->first, scene, RATIO_SIZE,
                                                        ratio->first_images, &first)) &&
                session_succeeds(row.stage, create_draw(ratio->second, scene, RATIO_SIZE,
                                                        ratio->second_images, &second));
    if (done)
        done = report_pair(session, draw_work_of(&first), draw_work_of(&second), ratio->clock,
                           ratio->at_least, &row);
    draw_work_destroy(&first);
    draw_work_destroy(&second);
    return done;
}

/* A map's drawing with what the exact method asks for. */
static shb_result run_map(void *state) {
    map_work *work = state;
    return shb_map_draw(work->map, work->scene, NULL, NULL);
}

static shb_result create_map(shb_context *context, const example_scene *scene,
                             shb_occluders occluders, map_work *work) {
    shb_map_desc desc = {.width = RATIO_SIZE, .occluders = occluders};
    work->scene = &scene->scene;
    const shb_result result =
        scene_light_view(scene, SCENE_DIRECTIONAL, RATIO_SIZE, false, &desc.view);
    return result ? result : shb_map_create(context, &desc, &work->map);
}

static bool measure_map_ratio(bench_session *session, const char *name, shb_occluders occluders,
                              double goal, const example_scene *scene, int index) {
    shb_context *const context = session_single(session);
    map_work kept = {0}, plain = {0};
    bench_row row = start_row(name, drawn_scenes[index], scene, RATIO_SIZE, context, goal);
    bool done = session_succeeds(name, create_map(context, scene, occluders, &kept)) &&
                session_succeeds(name, create_map(context, scene, SHB_OCCLUDERS_NONE, &plain));
    if (done)
        done = report_pair(session, (bench_work){run_map, &kept}, (bench_work){run_map, &plain},
                           BENCH_CLOCK_THREAD, false, &row);
    shb_map_destroy(kept.map);
    shb_map_destroy(plain.map);
    return done;
}

/* Every ratio of drawings for one scene. */
static bool measure_drawn_scene(bench_session *session, int index) {
    shb_context *const one = session_single(session);
    shb_context *const sse2 = session->capped[SHB_ISA_SSE2];
    shb_context *const avx512 = session->capped[SHB_ISA_AVX512];
    const draw_ratio ratios[] = {
        {"one thread/two",
         DRAW_DEPTH,
         DRAW_DEPTH,
         one,
         session->two,
         BENCH_CLOCK_WALL,
         {1.6, 1.8, 1.8, 1.8},
         true},
        {"camera/depth",
         DRAW_DEPTH_IDS,
         DRAW_DEPTH,
         one,
         one,
         BENCH_CLOCK_THREAD,
         {1.3, 1.3, 1.3, 1.3},
         false},
        {"dual/depth",
         DRAW_DEPTH_SECOND,
         DRAW_DEPTH,
         one,
         one,
         BENCH_CLOCK_THREAD,
         {1.4, 1.4, 1.4, 1.4},
         false},
        {"sse2/avx512",
         DRAW_DEPTH,
         DRAW_DEPTH,
         sse2,
         avx512,
         BENCH_CLOCK_THREAD,
         {2.2, 2.2, 2.2, 2.2},
         false},
    };
    example_scene *scene = subject_open_if_there(session->options.folder, drawn_scenes[index]);
    bool done = !scene ||
                session_succeeds(drawn_scenes[index], scene_add_clusters(session->context, scene));
    for (size_t i = 0; scene && done && i < sizeof ratios / sizeof *ratios; i++)
        if (ratios[i].first && ratios[i].second)
            done = measure_draw_ratio(session, &ratios[i], scene, index);
    if (scene && done)
        done = measure_map_ratio(session, "map planes/depth", SHB_OCCLUDERS_PLANES, 1.2, scene,
                                 index) &&
               measure_map_ratio(session, "map triangles/depth", SHB_OCCLUDERS_TRIANGLES, 1.15,
                                 scene, index);
    scene_close(scene);
    return done;
}

/* Bytes to be written as fast as can be. */
typedef struct fill_work {
    void *bytes;
    size_t size;
} fill_work;

static shb_result run_memset(void *state) {
    fill_work *work = state;
    memset(work->bytes, 0x3f, work->size);
    return SHB_OK;
}

static shb_result run_stores(void *state) {
    fill_work *work = state;
    machine_store_lines(work->bytes, work->size);
    return SHB_OK;
}

/* One triangle over a whole map against writing the map's bytes. */
static bool measure_fill(bench_session *session) {
    const uint32_t size = 4096;
    example_scene *scene = subject_open_if_there(NULL, "triangle");
    shb_context *const context = session_single(session);
    draw_work work = {0}, other = {0};
    bool done =
        scene &&
        session_succeeds("triangle", create_draw(context, scene, size, DRAW_DEPTH, &work)) &&
        session_succeeds("triangle", create_draw(context, scene, size, DRAW_DEPTH, &other));
    fill_work fill = {other.desc.depth.texels, (size_t)size * size * 4};
    bench_row row;
    if (done) {
        row = start_row("triangle/memset", "triangle", scene, size, context, 1.5);
        done = report_pair(session, draw_work_of(&work), (bench_work){run_memset, &fill},
                           BENCH_CLOCK_THREAD, false, &row);
    }
    if (done) {
        row = start_row("triangle/stores", "triangle", scene, size, context, 1.5);
        done = report_pair(session, draw_work_of(&work), (bench_work){run_stores, &fill},
                           BENCH_CLOCK_THREAD, false, &row);
    }
    draw_work_destroy(&work);
    draw_work_destroy(&other);
    scene_close(scene);
    return done;
}

/* Nanoseconds a triangle where nothing is to be drawn. */
static bool report_culled(bench_session *session, const char *title, example_scene *scene) {
    shb_context *const context = session_single(session);
    if (!session_succeeds(title, scene_add_clusters(context, scene)))
        return false;
    bench_row row = start_row("culled", title, scene, RATIO_SIZE, context, 0.3);
    draw_work work;
    row.size = 64;
    if (!session_succeeds(row.stage, create_draw(context, scene, row.size, DRAW_DEPTH, &work)))
        return false;
    const bool done = goals_report_time(session, draw_work_of(&work), "ns", 1e9 / row.items, &row);
    draw_work_destroy(&work);
    return done;
}

static bool measure_culled(bench_session *session) {
    example_scene *hills = subject_open_if_there(NULL, "culled");
    bool done = hills && report_culled(session, "height-field", hills);
    scene_close(hills);
    example_scene *bunny = subject_open_if_there(session->options.folder, "bunny_69k");
    if (bunny && done) {
        subject_keep_back_faces(bunny);
        done = report_culled(session, "bunny_69k", bunny);
    }
    scene_close(bunny);
    return done;
}

/* A bias against the constant one. */
static bool measure_light_ratio(bench_session *session, const char *name, const shb_bias *bias,
                                double goal, const measure_frame *frame,
                                bench_work (*work_of)(light_work *work)) {
    const shb_bias constant = shb_bias_constant(0.002f, SHB_UNIT_DEPTH);
    shb_context *const context = session_single(session);
    bench_row row = start_row(name, "hills", frame->scene, RATIO_SIZE, context, goal);
    row.items = (double)frame->fragment_count;
    light_work first = {0}, second = {0};
    bool done =
        session_succeeds(name, light_work_create(context, frame, RATIO_SIZE, bias, &first)) &&
        session_succeeds(name, light_work_create(context, frame, RATIO_SIZE, &constant, &second));
    if (done)
        done = report_pair(session, work_of(&first), work_of(&second), BENCH_CLOCK_THREAD, false,
                           &row);
    light_work_destroy(&first);
    light_work_destroy(&second);
    return done;
}

/* The plain test on 256-bit vectors. */
static bool measure_hard(bench_session *session, const measure_frame *frame) {
    const shb_bias constant = shb_bias_constant(0.002f, SHB_UNIT_DEPTH);
    shb_context *const context = session->capped[SHB_ISA_AVX2];
    if (!context)
        return true;
    bench_row row = start_row("hard:constant", "hills", frame->scene, RATIO_SIZE, context, 1.2);
    row.items = (double)frame->fragment_count;
    light_work work;
    if (!session_succeeds(row.stage,
                          light_work_create(context, frame, RATIO_SIZE, &constant, &work)))
        return false;
    const bool done =
        goals_report_time(session, light_work_visibility(&work), "ns", 1e9 / row.items, &row);
    light_work_destroy(&work);
    return done;
}

static bool measure_light_ratios(bench_session *session) {
    example_scene *scene = subject_open_if_there(NULL, "hills");
    const shb_bias adaptive = shb_bias_adaptive(1e-4f, 0), exact = shb_bias_exact();
    measure_frame frame = {0};
    bool done = scene && session_succeeds("hills", measure_frame_create(session_single(session),
                                                                        scene, 1024, 1024, &frame));
    done = done && measure_hard(session, &frame) &&
           measure_light_ratio(session, "test planes/constant", &exact, 1.4, &frame,
                               light_work_visibility) &&
           measure_light_ratio(session, "test adaptive/constant", &adaptive, 1.5, &frame,
                               light_work_visibility) &&
           measure_light_ratio(session, "shade adaptive/constant", &adaptive, 1.5, &frame,
                               light_work_shade) &&
           measure_light_ratio(session, "frame adaptive/constant", &adaptive, 1.08, &frame,
                               light_work_frame);
    measure_frame_destroy(&frame);
    scene_close(scene);
    return done;
}

bool ratios_measure(bench_session *session) {
    report_heading(session, "ratios, drawn meshes with clusters");
    progress_step(&session->progress, "ratios");
    bool done = measure_fill(session);
    for (int i = 0; i < DRAWN_SCENES && done; i++) {
        progress_step(&session->progress, drawn_scenes[i]);
        done = measure_drawn_scene(session, i);
    }
    return done && measure_light_ratios(session) && measure_culled(session);
}
