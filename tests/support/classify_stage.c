#include "classify_stage.h"

#include <stdlib.h>
#include <string.h>

#include "contexts.h"
#include "test.h"

stage stage_with_map(const shb_scene *scene, shb_view camera, shb_view light, uint32_t width,
                     uint32_t height) {
    stage s = {.camera = camera, .scene = scene};
    s.context = test_context(0, SHB_ISA_BEST);
    CHECK_INT(shb_reference_create(s.context, scene, &s.reference), SHB_OK);
    const shb_map_desc map = {.view = light, .width = width, .height = height};
    CHECK_INT(shb_map_create(s.context, &map, &s.map), SHB_OK);
    s.ids = malloc(PIXEL_COUNT * sizeof *s.ids);
    s.truth = malloc(PIXEL_COUNT);
    const shb_draw_desc draw = {
        .view = &s.camera, .scene = scene, .width = PIXELS, .height = PIXELS, .ids = s.ids};
    CHECK_INT(shb_draw(s.context, &draw, NULL), SHB_OK);
    return s;
}

stage stage_for(const shb_scene *scene, shb_view camera, shb_view light, uint32_t texels) {
    return stage_with_map(scene, camera, light, texels, texels);
}

shb_classify_desc stage_desc(const stage *s) {
    return (shb_classify_desc){.frame = {.view = &s->camera,
                                         .scene = s->scene,
                                         .width = PIXELS,
                                         .height = PIXELS,
                                         .ids = s->ids},
                               .map = s->map};
}

void stage_classify(stage *s) {
    const shb_classify_desc desc = stage_desc(s);
    memset(s->truth, 99, PIXEL_COUNT);
    CHECK_INT(shb_reference_classify(s->reference, &desc, s->truth), SHB_OK);
}

void stage_end(stage *s) {
    free(s->ids);
    free(s->truth);
    shb_map_destroy(s->map);
    shb_reference_destroy(s->reference);
    shb_context_destroy(s->context);
}

shb_view wide_view(shb_vec3 from, shb_vec3 target) {
    shb_view view;
    const shb_vec3 eye = shb_vec3_add(target, shb_vec3_scale(shb_vec3_normalize(from), 60));
    CHECK_INT(shb_view_orthographic(eye, target, (shb_vec3){0, 1, 0}, 32, 32, 1, 200, false, &view),
              SHB_OK);
    return view;
}

shb_view view_from_height(double height) {
    shb_view view;
    CHECK_INT(shb_view_orthographic((shb_vec3){0, 0, height}, (shb_vec3){0, 0, 0},
                                    (shb_vec3){0, 1, 0}, 32, 32, 0.5, 200, false, &view),
              SHB_OK);
    return view;
}

void add_sheet(soup *s, float x0, float y0, float x1, float y1, float z) {
    soup_add_quad(s, (float[3]){x0, y0, z}, (float[3]){x1, y0, z}, (float[3]){x1, y1, z},
                  (float[3]){x0, y1, z});
}

void add_ground(soup *s) {
    add_sheet(s, -30, -30, 30, 30, 0);
}
