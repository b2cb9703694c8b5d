#include "allocator.h"
#include "contexts.h"
#include "target.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 20
#define HEIGHT 12

static const float corners[9] = {-1, -1, 0.5f, 3, -1, 0.5f, -1, 3, 0.5f};

/* Everything that one valid drawing needs, to be spoiled field by field. */
typedef struct drawing {
    shb_mesh mesh;
    shb_instance instance;
    shb_scene scene;
    shb_view view;
    test_target target;
    shb_draw_desc desc;
} drawing;

static drawing *make_drawing(void) {
    drawing *d = calloc(1, sizeof *d);
    d->mesh = (shb_mesh){.positions = corners, .vertex_count = 3, .triangle_count = 1};
    d->instance.mesh = &d->mesh;
    d->scene = (shb_scene){&d->instance, 1};
    d->view.clip_from_world = shb_mat4_identity();
    d->target = test_target_create(WIDTH, HEIGHT);
    d->desc = test_target_desc(&d->target, &d->view, &d->scene);
    return d;
}

static void free_drawing(drawing *d) {
    test_target_destroy(&d->target);
    free(d);
}

static bool is_untouched(const test_target *target) {
    test_target fresh = test_target_create(target->width, target->height);
    const bool equal = test_target_equal(target, &fresh);
    test_target_destroy(&fresh);
    return equal;
}

/* Draws, expects the result, a sentence that names the field, and outputs as they were. */
static void check_refused(drawing *d, shb_result expected, const char *field) {
    test_log log = {0};
    const shb_context_desc desc = {.threads = 1, .log = test_log_keep, .log_user = &log};
    shb_context *context = NULL;
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    shb_draw_stats stats, before;
    memset(&stats, 0x5a, sizeof stats);
    before = stats;
    CHECK_INT(shb_draw(context, &d->desc, &stats), expected);
    CHECK(memcmp(&stats, &before, sizeof stats) == 0);
    CHECK(is_untouched(&d->target));
    CHECK_INT(log.result, expected);
    test_check(strstr(log.sentence, "shb_draw") && strstr(log.sentence, field), __FILE__, __LINE__,
               "\"%s\" does not name %s", log.sentence, field);
    shb_context_destroy(context);
    free_drawing(d);
}

#define CHECK_REFUSED(field, value, expected, name)                                                \
    do {                                                                                           \
        drawing *d = make_drawing();                                                               \
        d->field = value;                                                                          \
        check_refused(d, expected, name);                                                          \
    } while (0)

TEST(wrong_fields_are_refused_by_name) {
    CHECK_REFUSED(desc.view, NULL, SHB_ERROR_ARGUMENT, "desc.view");
    CHECK_REFUSED(desc.scene, NULL, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(desc.width, 0, SHB_ERROR_SIZE, "desc.width");
    CHECK_REFUSED(desc.width, SHB_SIZE_MAX + 1, SHB_ERROR_SIZE, "desc.width 16385");
    CHECK_REFUSED(desc.height, 0, SHB_ERROR_SIZE, "desc.height");
    CHECK_REFUSED(desc.height, UINT32_MAX, SHB_ERROR_SIZE, "desc.height 4294967295");
    CHECK_REFUSED(desc.depth.format, (shb_format)3, SHB_ERROR_ARGUMENT, "desc.depth.format 3");
    CHECK_REFUSED(desc.second.format, (shb_format)-1, SHB_ERROR_ARGUMENT, "desc.second.format");
    CHECK_REFUSED(desc.depth.stride, WIDTH * 4 + 2, SHB_ERROR_ARGUMENT, "desc.depth.stride 82");
    CHECK_REFUSED(desc.depth.stride, WIDTH * 4 - 4, SHB_ERROR_ARGUMENT, "desc.depth.stride 76");
    CHECK_REFUSED(desc.second.stride, 2, SHB_ERROR_ARGUMENT, "desc.second.stride 2");
    CHECK_REFUSED(desc.second.stride, SIZE_MAX - 3, SHB_ERROR_SIZE, "desc.second.stride");
    CHECK_REFUSED(desc.second.stride, (size_t)PTRDIFF_MAX / HEIGHT / 4 * 4 + 4, SHB_ERROR_SIZE,
                  "desc.second.stride");
    CHECK_REFUSED(desc.id_stride, (size_t)PTRDIFF_MAX / HEIGHT / 4 * 4 + 4, SHB_ERROR_SIZE,
                  "desc.id_stride");
    CHECK_REFUSED(desc.id_stride, WIDTH * 4 - 4, SHB_ERROR_ARGUMENT, "desc.id_stride 76");
    CHECK_REFUSED(desc.id_stride, WIDTH * 4 + 1, SHB_ERROR_ARGUMENT, "desc.id_stride 81");
    CHECK_REFUSED(desc.id_stride, SIZE_MAX - 3, SHB_ERROR_SIZE, "desc.id_stride");
    CHECK_REFUSED(desc.depth.texels, (char *)d->target.depth + 2, SHB_ERROR_ARGUMENT,
                  "desc.depth.texels");
    CHECK_REFUSED(desc.ids, (uint32_t *)(void *)((char *)d->target.ids + 1), SHB_ERROR_ARGUMENT,
                  "desc.ids");
    CHECK_REFUSED(desc.tile_size, 8, SHB_ERROR_ARGUMENT, "desc.tile_size 8");
    CHECK_REFUSED(desc.tile_size, 48, SHB_ERROR_ARGUMENT, "desc.tile_size 48");
    CHECK_REFUSED(desc.tile_size, 1024, SHB_ERROR_ARGUMENT, "desc.tile_size 1024");
    CHECK_REFUSED(view.clip_from_world.m[7], (double)NAN, SHB_ERROR_NUMBER, "desc.view");
    CHECK_REFUSED(view.clip_from_world.m[0], HUGE_VAL, SHB_ERROR_NUMBER, "desc.view");
}

TEST(marks_of_another_size_are_refused) {
    CHECK_INT(shb_clear_marks_size(0, HEIGHT), 0);
    CHECK_INT(shb_clear_marks_size(WIDTH, SHB_SIZE_MAX + 1), 0);
    const size_t size = shb_clear_marks_size(WIDTH, HEIGHT);
    char *marks = calloc(1, size);
    for (int off = -1; off <= 1; off += 2) {
        drawing *d = make_drawing();
        d->desc.clear_marks = marks;
        d->desc.clear_marks_size = size + (size_t)off;
        check_refused(d, SHB_ERROR_SIZE, "desc.clear_marks_size");
    }
    for (size_t i = 0; i < size; i++)
        CHECK_INT(marks[i], 0);
    free(marks);
}

TEST(wrong_scenes_are_refused) {
    CHECK_REFUSED(scene.instances, NULL, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(instance.mesh, NULL, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(instance.cull, (shb_cull)7, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(instance.world_from_mesh.m[12], (double)NAN, SHB_ERROR_NUMBER, "desc.scene");
    CHECK_REFUSED(mesh.positions, NULL, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(mesh.vertex_count, 2, SHB_ERROR_ARGUMENT, "desc.scene");
    CHECK_REFUSED(mesh.position_stride, 13, SHB_ERROR_ARGUMENT, "desc.scene");
}

TEST(null_pointers_are_refused) {
    drawing *d = make_drawing();
    shb_context *context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_draw(NULL, &d->desc, NULL), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_draw(context, NULL, NULL), SHB_ERROR_ARGUMENT);
    CHECK(is_untouched(&d->target));
    CHECK_INT(shb_draw(context, &d->desc, NULL), SHB_OK);
    CHECK(!is_untouched(&d->target));
    shb_context_destroy(context);
    free_drawing(d);
}

/* A scene with every kind of scratch: several tiles, triangles, instances. */
static void make_busy(drawing *d, shb_instance instances[2]) {
    instances[0] = instances[1] = d->instance;
    d->scene = (shb_scene){instances, 2};
    d->desc.tile_size = 16;
}

/* A context whose memory the state counts. */
static shb_context *create_counted(test_allocator *state, shb_isa isa, uint32_t threads) {
    shb_context *context = NULL;
    const shb_context_desc desc = {
        .threads = threads, .max_isa = isa, .allocator = test_allocator_hooks(state)};
    CHECK_INT(shb_context_create(&desc, &context), SHB_OK);
    return context;
}

/* Draws with the allocation of this number failing; true if it was never reached. */
static bool draw_without_memory(drawing *d, shb_isa isa, size_t fail_at) {
    test_allocator state = {0};
    shb_context *context = create_counted(&state, isa, 1);
    state.fail_at = state.calls + fail_at;
    const shb_result result = shb_draw(context, &d->desc, NULL);
    if (result) {
        CHECK_INT(result, SHB_ERROR_MEMORY);
        CHECK(is_untouched(&d->target));
        /* The context is not spoiled. */
        state.fail_at = 0;
        uint32_t id = 7;
        shb_draw_desc one = d->desc;
        one.width = one.height = 1;
        one.depth.texels = one.second.texels = NULL;
        one.ids = &id;
        CHECK_INT(shb_draw(context, &one, NULL), SHB_OK);
        CHECK_INT(id, 0);
    }
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
    return result == SHB_OK;
}

TEST(out_of_memory_anywhere_leaves_images_untouched_and_nothing_leaks) {
    for (int best = 0; best < 2; best++) {
        drawing *d = make_drawing();
        shb_instance instances[2];
        make_busy(d, instances);
        size_t fail_at = 1;
        while (!draw_without_memory(d, best ? SHB_ISA_BEST : SHB_ISA_SCALAR, fail_at))
            fail_at++;
        CHECK(fail_at > 5);
        free_drawing(d);
    }
}

TEST(a_warm_context_allocates_nothing) {
    for (int best = 0; best < 2; best++) {
        drawing *d = make_drawing();
        shb_instance instances[2];
        make_busy(d, instances);
        test_allocator state = {0};
        shb_context *context = create_counted(&state, best ? SHB_ISA_BEST : SHB_ISA_SCALAR, 2);
        CHECK_INT(shb_draw(context, &d->desc, NULL), SHB_OK);
        const size_t warm = state.calls;
        CHECK(warm > 1);
        CHECK_INT(shb_draw(context, &d->desc, NULL), SHB_OK);
        d->desc.second.texels = NULL;
        d->scene.instance_count = 1;
        CHECK_INT(shb_draw(context, &d->desc, NULL), SHB_OK);
        CHECK_INT(state.calls, warm);
        shb_context_destroy(context);
        free_drawing(d);
    }
}

/* A host's memory cannot hold this many transformed vertices: refused, not attempted. */
TEST(more_vertices_than_memory_are_refused) {
    drawing *d = make_drawing();
    shb_instance instances[64];
    d->mesh.vertex_count = UINT32_MAX;
    for (int i = 0; i < 64; i++)
        instances[i] = d->instance;
    d->scene = (shb_scene){instances, 64};
    test_allocator state = {0};
    shb_context *context = NULL;
    CHECK_INT(
        shb_context_create(
            &(shb_context_desc){.threads = 1, .allocator = test_allocator_hooks(&state)}, &context),
        SHB_OK);
    state.fail_at = state.calls + 2;
    CHECK_INT(shb_draw(context, &d->desc, NULL), SHB_ERROR_MEMORY);
    CHECK(is_untouched(&d->target));
    shb_context_destroy(context);
    CHECK_INT(state.live, 0);
    free_drawing(d);
}
