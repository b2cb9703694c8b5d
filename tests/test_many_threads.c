/* While a context draws, prepares and shades, other threads ask its maps, and make and destroy
 * some; another context draws beside it. Nobody notices. */
#include "asked_map.h"
#include "contexts.h"
#include "probe.h"
#include "test.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

typedef struct question {
    const char *bias, *filter;
    shb_occluders occluders;
    bool classifies, exact_only;
} question;

static const question questions[] = {
    {"adaptive", "pcss", SHB_OCCLUDERS_NONE, true, false},
    {"constant", "variance", SHB_OCCLUDERS_NONE, false, false},
    {"receiver-plane", "moments-soft", SHB_OCCLUDERS_NONE, false, false},
    {"slope", "bitmask", SHB_OCCLUDERS_NONE, false, false},
    {"midpoint", "jittered", SHB_OCCLUDERS_NONE, false, false},
    {"exact", "hard", SHB_OCCLUDERS_PLANES, true, false},
    {"exact", "pcf", SHB_OCCLUDERS_PLANES, false, false},
    {"exact", "pcss", SHB_OCCLUDERS_PLANES, false, false},
    {"exact", "hard", SHB_OCCLUDERS_TRIANGLES, true, false},
    {"exact", "poisson", SHB_OCCLUDERS_TRIANGLES, false, false},
    {"exact", "hard", SHB_OCCLUDERS_LISTS, false, false},
    {"exact", "hard", SHB_OCCLUDERS_LISTS, true, true},
};

enum {
    QUESTIONS = sizeof questions / sizeof *questions,
    SCENES = 2,
    POINTS = 600,
    PIXELS = 48, /* to a side of the picture */
    ROUNDS = 3
};

typedef struct answers {
    float visibility[POINTS];
    uint8_t certain[POINTS];
} answers;

typedef struct picture {
    uint8_t pixels[PIXELS * PIXELS * 3];
} picture;

typedef struct play {
    soup scenes[SCENES];
    asked_points points;
    answers expected[SCENES][QUESTIONS];
    picture expected_picture;
    shb_context *context;
    shb_map *asked[QUESTIONS]; /* of the first scene */
    _Atomic(shb_map *) unused; /* to be destroyed by another thread */
    atomic_bool done;
} play;

/* A thread's own count: checks belong to the main thread. */
typedef struct worker {
    play *play;
    pthread_t thread;
    size_t asked, wrong;
} worker;

static shb_bias bias_of(const question *q) {
    shb_bias bias;
    (void)shb_bias_parse(q->bias, &bias);
    return bias;
}

static shb_filter filter_of(const question *q) {
    shb_filter filter;
    (void)shb_filter_parse(q->filter, &filter);
    return filter;
}

static bool draw(shb_map *map, const question *q, const soup *scene) {
    const shb_bias bias = bias_of(q);
    const shb_filter filter = filter_of(q);
    return shb_map_draw(map, &scene->scene, &bias, NULL) == SHB_OK &&
           (q->exact_only || shb_map_prepare(map, &filter) == SHB_OK);
}

static shb_map *make(shb_context *context, const question *q) {
    const shb_map_desc desc = {.view = probe_orthographic(false),
                               .width = 128,
                               .occluders = q->occluders,
                               .classifies = q->classifies,
                               .exact_only = q->exact_only};
    shb_map *map = NULL;
    return shb_map_create(context, &desc, &map) == SHB_OK ? map : NULL;
}

static void ask(const shb_map *map, const question *q, const asked_points *given, answers *out) {
    const shb_points points = {
        .count = POINTS, .positions = given->positions, .normals = given->normals};
    const shb_bias bias = bias_of(q);
    const shb_filter filter = filter_of(q);
    memset(out, 0xee, sizeof *out);
    (void)shb_map_visibility(map, &points, &bias, &filter, out->visibility);
    (void)shb_map_classify(map, &points, out->certain);
}

static bool answers_as(const play *p, const shb_map *map, int scene, int k) {
    answers out;
    ask(map, &questions[k], &p->points, &out);
    return memcmp(&out, &p->expected[scene][k], sizeof out) == 0;
}

/* The first scene as the camera sees it, under a light for each map. */
static bool shade(shb_context *context, const play *p, shb_map *const maps[QUESTIONS],
                  picture *out) {
    static const shb_view zero;
    shb_view camera = zero;
    uint32_t ids[PIXELS * PIXELS];
    shb_bias biases[QUESTIONS];
    shb_filter filters[QUESTIONS];
    shb_shade_light lights[QUESTIONS];
    for (int k = 0; k < QUESTIONS; k++) {
        biases[k] = bias_of(&questions[k]);
        filters[k] = filter_of(&questions[k]);
        lights[k] = (shb_shade_light){maps[k], &biases[k], &filters[k], {0.1f, 0.1f, 0.1f}};
    }
    const shb_scene *scene = &p->scenes[0].scene;
    const shb_draw_desc drawn = {
        .view = &camera, .scene = scene, .width = PIXELS, .height = PIXELS, .ids = ids};
    const shb_shade_desc desc = {
        .frame = {.view = &camera, .scene = scene, .width = PIXELS, .height = PIXELS, .ids = ids},
        .lights = lights,
        .light_count = QUESTIONS,
        .shade = shb_shade_lambert,
        .image = {out->pixels, PIXELS, PIXELS, 0}};
    return shb_view_perspective((shb_vec3){1, -2, 2}, (shb_vec3){0, 0, 0}, (shb_vec3){0, 0, 1}, 1,
                                1, 0.1, 10, true, &camera) == SHB_OK &&
           shb_draw(context, &drawn, NULL) == SHB_OK && shb_shade(context, &desc) == SHB_OK;
}

/* Draws every scene for every question over and over; all of them must come out as expected. */
static bool draw_all(play *p, shb_context *context) {
    bool good = true;
    for (int k = 0; k < QUESTIONS; k++) {
        shb_map *map = make(context, &questions[k]);
        for (int scene = SCENES; scene-- > 0;)
            good = map && draw(map, &questions[k], &p->scenes[scene]) &&
                   answers_as(p, map, scene, k) && good;
        if (context == p->context)
            map = atomic_exchange(&p->unused, map);
        shb_map_destroy(map);
    }
    return good;
}

static void *keep_asking(void *arg) {
    worker *w = arg;
    play *p = w->play;
    while (!atomic_load(&p->done))
        for (int k = 0; k < QUESTIONS; k++, w->asked++)
            w->wrong += !answers_as(p, p->asked[k], 0, k);
    return NULL;
}

/* Wraps depths of a map, and destroys maps while others that share their scene are drawn. */
static void *keep_making(void *arg) {
    worker *w = arg;
    play *p = w->play;
    while (!atomic_load(&p->done)) {
        const shb_depth_image depth = shb_map_get_depth(p->asked[1]);
        const shb_map_desc desc = {.view = probe_orthographic(false),
                                   .width = 128,
                                   .scene_scale = shb_map_get_info(p->asked[1])->scene_scale};
        shb_map *wrapped = NULL;
        w->wrong +=
            shb_map_wrap(p->context, &desc, depth.texels, depth.stride, NULL, &wrapped) != SHB_OK;
        shb_map_destroy(wrapped);
        for (int k = 0; k < QUESTIONS; k++, w->asked++) {
            shb_map *empty = make(p->context, &questions[k]);
            w->wrong += !empty;
            shb_map_destroy(empty);
            shb_map_destroy(atomic_exchange(&p->unused, NULL));
        }
    }
    return NULL;
}

static void *keep_drawing_elsewhere(void *arg) {
    worker *w = arg;
    shb_context *context = NULL;
    const shb_context_desc desc = {.threads = 2};
    w->wrong += shb_context_create(&desc, &context) != SHB_OK;
    while (!atomic_load(&w->play->done) && context) {
        w->wrong += !draw_all(w->play, context);
        w->asked++;
    }
    shb_context_destroy(context);
    return NULL;
}

/* What a single thread finds, of maps that nobody else knows. */
static void find_expected(play *p) {
    shb_context *context = test_context(1, SHB_ISA_BEST);
    shb_map *maps[QUESTIONS];
    for (int k = 0; k < QUESTIONS; k++) {
        maps[k] = make(context, &questions[k]);
        for (int scene = SCENES; scene-- > 0;) {
            CHECK(draw(maps[k], &questions[k], &p->scenes[scene]));
            ask(maps[k], &questions[k], &p->points, &p->expected[scene][k]);
            const float first = p->expected[scene][k].visibility[0];
            CHECK(first >= 0 && first <= 1);
        }
    }
    CHECK(shade(context, p, maps, &p->expected_picture));
    for (int k = 0; k < QUESTIONS; k++)
        shb_map_destroy(maps[k]);
    shb_context_destroy(context);
}

static play *open_play(void) {
    play *p = calloc(1, sizeof *p);
    asked_scene_add(&p->scenes[0]);
    asked_scene_add_relief(&p->scenes[1]);
    for (int scene = 0; scene < SCENES; scene++)
        (void)soup_scene(&p->scenes[scene]);
    asked_points_fill(&p->scenes[0], 1, &p->points);
    find_expected(p);
    return p;
}

static void close_play(play *p) {
    for (int scene = 0; scene < SCENES; scene++)
        soup_free(&p->scenes[scene]);
    free(p);
}

/* With more stack than shading needs, which some systems do not give. */
static int start_thread(pthread_t *thread, void *(*run)(void *), void *arg) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, (size_t)8 << 20);
    const int failed = pthread_create(thread, &attributes, run, arg);
    pthread_attr_destroy(&attributes);
    return failed;
}

static void run_beside(play *p, shb_context *context) {
    static void *(*const works[])(void *) = {keep_asking, keep_asking, keep_asking, keep_making,
                                             keep_drawing_elsewhere};
    enum { WORKERS = sizeof works / sizeof *works };
    worker workers[WORKERS] = {{0}};
    p->context = context;
    atomic_store(&p->done, false);
    for (int k = 0; k < QUESTIONS; k++) {
        p->asked[k] = make(context, &questions[k]);
        CHECK(draw(p->asked[k], &questions[k], &p->scenes[0]));
    }
    for (int i = 0; i < WORKERS; i++) {
        workers[i].play = p;
        CHECK_INT(start_thread(&workers[i].thread, works[i], &workers[i]), 0);
    }
    for (int round = 0; round < ROUNDS; round++) {
        picture shaded;
        CHECK(draw_all(p, context));
        CHECK(shade(context, p, p->asked, &shaded));
        CHECK(memcmp(&shaded, &p->expected_picture, sizeof shaded) == 0);
    }
    atomic_store(&p->done, true);
    for (int i = 0; i < WORKERS; i++) {
        CHECK_INT(pthread_join(workers[i].thread, NULL), 0);
        CHECK_INT(workers[i].wrong, 0);
        CHECK(workers[i].asked > 0);
    }
    shb_map_destroy(atomic_exchange(&p->unused, NULL));
    for (int k = 0; k < QUESTIONS; k++)
        shb_map_destroy(p->asked[k]);
}

TEST(maps_are_asked_made_and_destroyed_while_their_context_works) {
    play *p = open_play();
    shb_context *context = test_context(3, SHB_ISA_BEST);
    run_beside(p, context);
    shb_context_destroy(context);
    close_play(p);
}

typedef struct host_job {
    shb_task_fn *task;
    void *arg;
    size_t count;
    atomic_size_t next;
} host_job;

static void *take_tasks(void *arg) {
    host_job *job = arg;
    for (size_t i; (i = atomic_fetch_add(&job->next, 1)) < job->count;)
        job->task(job->arg, i);
    return NULL;
}

/* New threads for every call, and none of them the caller's. */
static void run_on_new_threads(void *user, shb_task_fn *task, void *arg, size_t count) {
    enum { THREADS = 2 };
    host_job job = {task, arg, count, 0};
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        *(int *)user += start_thread(&threads[i], take_tasks, &job) != 0;
    for (int i = 0; i < THREADS; i++)
        pthread_join(threads[i], NULL);
}

TEST(a_host_that_runs_tasks_on_threads_of_its_own_gets_the_same) {
    play *p = open_play();
    int failed = 0;
    const shb_context_desc desc = {.parallel_for = run_on_new_threads, .parallel_user = &failed};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    run_beside(p, context);
    CHECK_INT(failed, 0);
    shb_context_destroy(context);
    close_play(p);
}
