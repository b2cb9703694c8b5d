/* Images of a host that are drawn again and again with marks: what one drawing leaves must not be
 * seen in the next. */
#include "contexts.h"
#include "probe.h"
#include "random.h"
#include "shadowbias/shadowbias.h"
#include "soup.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH_MAX 2064
#define HEIGHT_MAX 150
#define PADDING 16 /* texels behind a row */
#define IMAGE_BYTES ((size_t)(WIDTH_MAX + PADDING) * HEIGHT_MAX * 4)
#define CONTEXTS 5

/* What a host keeps: its images lie in the same memory whatever they are. */
typedef struct host {
    shb_context *contexts[CONTEXTS];
    char *depth, *second, *ids;
    void *marks;
    shb_view view;
} host;

static void *allocate(size_t size) {
    void *memory = calloc(1, size);
    if (!memory)
        abort();
    return memory;
}

static host create_host(void) {
    static const shb_context_desc descs[CONTEXTS] = {{.threads = 1},
                                                     {.threads = 2},
                                                     {.threads = 3},
                                                     {.threads = 1, .max_isa = SHB_ISA_SSE2},
                                                     {.threads = 2, .max_isa = SHB_ISA_SCALAR}};
    host h = {.depth = allocate(IMAGE_BYTES),
              .second = allocate(IMAGE_BYTES),
              .ids = allocate(IMAGE_BYTES),
              .marks = allocate(shb_clear_marks_size(WIDTH_MAX, HEIGHT_MAX))};
    for (int i = 0; i < CONTEXTS; i++)
        CHECK_INT(shb_context_create(&descs[i], &h.contexts[i]), SHB_OK);
    return h;
}

static void destroy_host(host *h) {
    for (int i = 0; i < CONTEXTS; i++)
        shb_context_destroy(h->contexts[i]);
    free(h->depth);
    free(h->second);
    free(h->ids);
    free(h->marks);
}

static shb_depth_image depth_image(void *texels, uint32_t width, shb_format format, bool padded) {
    return (shb_depth_image){texels, (width + (padded ? PADDING : 0)) * shb_format_size(format),
                             format};
}

/* Images of another kind, by chance. */
static shb_draw_desc choose_images(host *h, test_random *random) {
    static const uint32_t widths[] = {400, 240, 50, 32, WIDTH_MAX};
    const uint32_t width = widths[random_below(random, 5)];
    const bool reversed = random_below(random, 2);
    const shb_format format = random_below(random, 3) ? SHB_FORMAT_FLOAT32 : SHB_FORMAT_UNORM16;
    const bool padded = random_below(random, 2);
    const uint32_t wanted = 1 + random_below(random, 7);
    h->view = random_below(random, 2) ? probe_orthographic(reversed) : probe_perspective(reversed);
    return (shb_draw_desc){
        .view = &h->view,
        .width = width,
        .height = 1 + random_below(random, HEIGHT_MAX),
        .depth = depth_image(wanted & 1 ? h->depth : NULL, width, format, padded),
        .second = depth_image(wanted & 2 ? h->second : NULL, width, SHB_FORMAT_FLOAT32, padded),
        .ids = wanted & 4 ? (uint32_t *)(void *)h->ids : NULL,
        .id_stride = (width + (padded ? PADDING : 0)) * 4,
        .tile_size = random_below(random, 2) ? 0 : 64};
}

static bool are_equal(const void *a, const void *b, uint32_t height, size_t stride, size_t row) {
    bool equal = true;
    for (size_t y = 0; y < height; y++)
        equal &= memcmp((const char *)a + y * stride, (const char *)b + y * stride, row) == 0;
    return equal;
}

/* Draws a scene with the marks, and into other images without. */
static void check_drawing(host *h, host *fresh, const shb_draw_desc *images, shb_context *context,
                          const shb_scene *scene) {
    shb_draw_desc desc = *images, other = *images;
    desc.scene = other.scene = scene;
    desc.clear_marks = h->marks;
    desc.clear_marks_size = shb_clear_marks_size(desc.width, desc.height);
    other.depth.texels = desc.depth.texels ? fresh->depth : NULL;
    other.second.texels = desc.second.texels ? fresh->second : NULL;
    other.ids = desc.ids ? (uint32_t *)(void *)fresh->ids : NULL;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK_INT(shb_draw(fresh->contexts[0], &other, NULL), SHB_OK);
    const size_t texel = shb_format_size(desc.depth.format);
    CHECK(!desc.depth.texels ||
          are_equal(h->depth, fresh->depth, desc.height, desc.depth.stride, desc.width * texel));
    CHECK(!desc.second.texels || are_equal(h->second, fresh->second, desc.height,
                                           desc.second.stride, desc.width * sizeof(float)));
    CHECK(!desc.ids || are_equal(h->ids, fresh->ids, desc.height, desc.id_stride,
                                 desc.width * sizeof(uint32_t)));
}

static void draw_again(host *h, host *fresh, const shb_draw_desc *images, test_random *random) {
    soup s = {0};
    for (uint32_t i = random_below(random, 6); i > 0; i--)
        soup_add_patch(&s, random);
    soup_scene(&s);
    shb_context *context = h->contexts[random_below(random, CONTEXTS)];
    shb_clusters *clusters = NULL;
    if (s.count > 0 && random_below(random, 2))
        CHECK_INT(shb_clusters_create(context, &s.mesh, &clusters), SHB_OK);
    s.mesh.clusters = clusters;
    check_drawing(h, fresh, images, context, &s.scene);
    shb_clusters_destroy(clusters);
    soup_free(&s);
}

/* Scenes, contexts and, now and then, images change from one drawing to the next. */
TEST(images_that_are_drawn_again_are_as_new_ones) {
    test_random random = {11};
    host h = create_host(), fresh = create_host();
    shb_draw_desc images = choose_images(&h, &random);
    for (int i = 0; i < 1500; i++) {
        if (random_below(&random, 5) == 0)
            images = choose_images(&h, &random);
        draw_again(&h, &fresh, &images, &random);
    }
    destroy_host(&fresh);
    destroy_host(&h);
}

/* One triangle in the left half of two cells. */
static const float half_corners[9] = {-1, -1, 0.5f, 0, -1, 0.5f, -1, 1, 0.5f};
static const shb_mesh half_mesh = {
    .positions = half_corners, .vertex_count = 3, .triangle_count = 1};
static const shb_instance half_instance = {.mesh = &half_mesh};

/* Of these two cells. */
static shb_draw_desc half_drawing(const shb_view *view, const shb_scene *scene, void *texels,
                                  shb_format format, void *marks) {
    return (shb_draw_desc){.view = view,
                           .scene = scene,
                           .width = 32,
                           .height = 16,
                           .depth = {.texels = texels, .format = format},
                           .clear_marks = marks,
                           .clear_marks_size = shb_clear_marks_size(32, 16)};
}

TEST(marked_images_are_cleared_where_they_were_drawn_in) {
    const shb_scene scene = {&half_instance, 1}, empty = {&half_instance, 0};
    const shb_view view = {.clip_from_world = shb_mat4_identity()};
    static float depths[16][32];
    const size_t size = shb_clear_marks_size(32, 16);
    void *marks = allocate(size);
    shb_draw_desc desc = half_drawing(&view, &scene, depths, SHB_FORMAT_FLOAT32, marks);
    shb_context *context = test_context(1, SHB_ISA_BEST);
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(depths[15][0] == 0.5f && depths[15][31] == 1.0f);
    desc.scene = &empty;
    depths[15][31] = 7;
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    const bool trusts = shb_context_isa(context) != SHB_ISA_SCALAR;
    CHECK(depths[15][0] == 1.0f && depths[15][31] == (trusts ? 7.0f : 1.0f));
    memset(marks, 0, size);
    CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
    CHECK(depths[15][31] == 1.0f);
    shb_context_destroy(context);
    free(marks);
}

/* The same where tiles are copied to the image: 0.5 is 32767.5 steps. */
TEST(marked_images_are_stored_where_they_were_drawn_in) {
    const shb_scene scene = {&half_instance, 1}, empty = {&half_instance, 0};
    const shb_view view = {.clip_from_world = shb_mat4_identity()};
    static uint16_t depths[16][32];
    const size_t size = shb_clear_marks_size(32, 16);
    void *marks = allocate(size);
    shb_draw_desc desc = half_drawing(&view, &scene, depths, SHB_FORMAT_UNORM16, marks);
    shb_context *context = test_context(1, SHB_ISA_BEST);
    const bool trusts = shb_context_isa(context) != SHB_ISA_SCALAR;
    for (int i = 0; i < 3; i++) {
        desc.scene = &scene;
        CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
        CHECK_INT(depths[15][0], 32768);
        CHECK_INT(depths[15][31], 65535);
        desc.scene = &empty;
        depths[15][31] = 7;
        CHECK_INT(shb_draw(context, &desc, NULL), SHB_OK);
        CHECK_INT(depths[15][0], 65535);
        CHECK_INT(depths[15][31], trusts ? 7 : 65535);
        memset(marks, 0, size);
    }
    shb_context_destroy(context);
    free(marks);
}
