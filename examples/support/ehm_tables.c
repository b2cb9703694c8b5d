#include "ehm_tables.h"

/* World units, in the proportions of the paper's small, medium and large. */
static const double light_widths[EHM_LIGHTS] = {0.2, 0.4, 0.64};

static const ehm_row pcf_rows[] = {
    {"5x5 receiver plane", "receiver-plane", "pcf:size=5", 0, false, 1},
    {"5x5 adaptive, naive", "adaptive", "pcf:size=5,taps=2", 0, false, 1.82 / 1.18},
    {"5x5 adaptive", "adaptive", "pcf:size=5", 0, false, 1.30 / 1.18},
    {"5x5 exact", "exact", "pcf:size=5", 0, false, 0},
    {"7x7 receiver plane", "receiver-plane", "pcf:size=7", 0, false, 1},
    {"7x7 adaptive, naive", "adaptive", "pcf:size=7,taps=2", 0, false, 2.93 / 1.49},
    {"7x7 adaptive", "adaptive", "pcf:size=7", 0, false, 1.82 / 1.49},
    {"7x7 exact", "exact", "pcf:size=7", 0, false, 0},
    {"11x11 receiver plane", "receiver-plane", "pcf:size=11", 0, false, 1},
    {"11x11 adaptive, naive", "adaptive", "pcf:size=11,taps=2", 0, false, 6.19 / 2.71},
    {"11x11 adaptive", "adaptive", "pcf:size=11", 0, false, 3.45 / 2.71},
    {"11x11 exact", "exact", "pcf:size=11", 0, false, 0},
};

#define ALL(width) "pcss:light=" width ",blockers=25,samples=0"
#define POISSON(width) "pcss:light=" width ",blockers=25,samples=25"

static const ehm_row pcss_rows[] = {
    {"small receiver plane", "receiver-plane", ALL("0.2"), 0, false, 1},
    {"small adaptive", "adaptive", ALL("0.2"), 0, false, 5.55 / 4.05},
    {"small exact", "exact", ALL("0.2"), 0, false, 0},
    {"small Poisson rec. plane", "receiver-plane", POISSON("0.2"), 0, true, 1},
    {"small Poisson adaptive", "adaptive", POISSON("0.2"), 0, true, 3.01 / 2.36},
    {"small Poisson exact", "exact", POISSON("0.2"), 0, true, 0},
    {"medium receiver plane", "receiver-plane", ALL("0.4"), 1, false, 1},
    {"medium adaptive", "adaptive", ALL("0.4"), 1, false, 19.54 / 14.09},
    {"medium exact", "exact", ALL("0.4"), 1, false, 0},
    {"medium Poisson rec. plane", "receiver-plane", POISSON("0.4"), 1, true, 1},
    {"medium Poisson adaptive", "adaptive", POISSON("0.4"), 1, true, 3.15 / 2.48},
    {"medium Poisson exact", "exact", POISSON("0.4"), 1, true, 0},
    {"large receiver plane", "receiver-plane", ALL("0.64"), 2, false, 1},
    {"large adaptive", "adaptive", ALL("0.64"), 2, false, 48.95 / 35.18},
    {"large exact", "exact", ALL("0.64"), 2, false, 0},
    {"large Poisson rec. plane", "receiver-plane", POISSON("0.64"), 2, true, 1},
    {"large Poisson adaptive", "adaptive", POISSON("0.64"), 2, true, 3.30 / 2.61},
    {"large Poisson exact", "exact", POISSON("0.64"), 2, true, 0},
};

const ehm_row *ehm_rows(int table, size_t *count) {
    *count = table == 0 ? sizeof pcf_rows / sizeof *pcf_rows : sizeof pcss_rows / sizeof *pcss_rows;
    return table == 0 ? pcf_rows : pcss_rows;
}

static shb_result create_truths(ehm_subject *subject) {
    shb_view view;
    shb_result result = scene_light_view(subject->scene, SCENE_SPOT, EHM_MAP_SIZE, true, &view);
    for (int light = 0; light < EHM_LIGHTS; light++)
        for (int disk = 0; disk < 2 && !result; disk++) {
            const shb_area_light area = soft_light(&view, light_widths[light], disk);
            result = soft_truth_create(&subject->judged, &view, &area, subject->desc.samples,
                                       &subject->truths[light][disk]);
        }
    return result;
}

shb_result ehm_open(const ehm_desc *desc, ehm_subject *subject) {
    char error[256];
    *subject = (ehm_subject){.desc = *desc};
    if (!scene_open("tree", &subject->scene, error, sizeof error))
        return SHB_ERROR_MEMORY;
    shb_result result = measure_frame_create(desc->single, subject->scene, desc->size[0],
                                             desc->size[1], &subject->timed);
    if (!result)
        result = measure_frame_create(desc->several, subject->scene, desc->truth_size[0],
                                      desc->truth_size[1], &subject->judged);
    return result ? result : create_truths(subject);
}

void ehm_close(ehm_subject *subject) {
    for (int light = 0; light < EHM_LIGHTS; light++)
        for (int disk = 0; disk < 2; disk++)
            soft_truth_destroy(&subject->truths[light][disk]);
    measure_frame_destroy(&subject->judged);
    measure_frame_destroy(&subject->timed);
    scene_close(subject->scene);
    *subject = (ehm_subject){0};
}

static shb_result create_work(const ehm_subject *subject, const measure_frame *frame,
                              const ehm_row *row, uint32_t map_size, soft_work *work) {
    const soft_work_desc desc = {SCENE_SPOT, map_size, row->bias, row->filter, false};
    return soft_work_create(subject->desc.single, frame, &desc, work);
}

shb_result ehm_work(const ehm_subject *subject, const ehm_row *row, uint32_t map_size,
                    soft_work *work) {
    return create_work(subject, &subject->timed, row, map_size, work);
}

shb_result ehm_judge(const ehm_subject *subject, const ehm_row *row, shb_soft_errors *errors) {
    soft_work work;
    shb_result result = create_work(subject, &subject->judged, row, EHM_MAP_SIZE, &work);
    if (result)
        return result;
    const bench_work asked = soft_work_visibility(&work);
    result = asked.run(asked.state);
    if (!result)
        result =
            soft_truth_compare(&subject->judged, &subject->truths[row->light][row->disk], errors);
    soft_work_destroy(&work);
    return result;
}
