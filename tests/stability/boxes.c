#include "boxes.h"

#include "tool.h"

#include <string.h>

/* Fragments whose answer is off by more than this are counted. */
#define BAD_ERROR 0.2

/* Of fragments whose kernel holds no silhouette; errors are sums of |answer - truth|. */
typedef struct box_errors {
    uint64_t lit, shadowed, bad_lit;
    double lit_error, shadowed_error;
} box_errors;

/* Sums over cases of what print_rates shows. */
typedef struct box_mean {
    char method[32];
    uint64_t lit, shadowed;
    size_t lit_cases, shadowed_cases;
    double lit_error, bad_lit, shadowed_error; /* parts of 1 */
} box_mean;

enum { MEANS_MAX = 32 };

typedef struct box_run {
    FILE *stream;
    shb_filter filter;
    box_mean means[MEANS_MAX];
} box_run;

static box_errors count_errors(const stability_stage *stage) {
    box_errors errors = {0};
    for (size_t i = 0; i < stage->frame.fragment_count; i++) {
        const double seen = (double)stage->frame.visibility[i];
        if (stage->truth[i] == SHB_TRUTH_LIT) {
            errors.lit++;
            errors.lit_error += 1 - seen;
            errors.bad_lit += seen < 1 - BAD_ERROR;
        } else if (stage->truth[i] == SHB_TRUTH_SHADOWED) {
            errors.shadowed++;
            errors.shadowed_error += seen;
        }
    }
    return errors;
}

static shb_result measure(const stability_stage *stage, const listed_method *method,
                          const shb_filter *filter, box_errors *errors) {
    const shb_bias bias = method->method->make();
    shb_map *map = NULL;
    shb_result result = stability_draw_map(stage, method, &bias, &map);
    if (!result)
        result = shb_map_visibility(map, &stage->points, &bias, filter, stage->frame.visibility);
    if (!result)
        *errors = count_errors(stage);
    shb_map_destroy(map);
    return result;
}

static double share(double part, uint64_t all) {
    return all ? part / (double)all : 0;
}

/* The method's own place, or the first empty one. */
static box_mean *mean_of(box_run *run, const char *method) {
    int i = 0;
    while (i < MEANS_MAX - 1 && *run->means[i].method && strcmp(run->means[i].method, method) != 0)
        i++;
    snprintf(run->means[i].method, sizeof run->means[i].method, "%s", method);
    return &run->means[i];
}

static void add_to_mean(box_run *run, const char *method, const box_errors *errors) {
    box_mean *mean = mean_of(run, method);
    mean->lit += errors->lit;
    mean->shadowed += errors->shadowed;
    mean->lit_cases += errors->lit > 0;
    mean->shadowed_cases += errors->shadowed > 0;
    mean->lit_error += share(errors->lit_error, errors->lit);
    mean->bad_lit += share((double)errors->bad_lit, errors->lit);
    mean->shadowed_error += share(errors->shadowed_error, errors->shadowed);
}

static void print_rates(FILE *stream, const char *method, const uint64_t counts[2],
                        const double parts[3]) {
    fprintf(stream, "%s\t%llu\t%llu\t%.3f\t%.3f\t%.3f\n", method, (unsigned long long)counts[0],
            (unsigned long long)counts[1], 1e6 * parts[0], 1e6 * parts[1], 1e6 * parts[2]);
}

static void print_row(FILE *stream, const stability_case *c, const char *method,
                      const box_errors *errors) {
    const uint64_t counts[2] = {errors->lit, errors->shadowed};
    const double parts[3] = {share(errors->lit_error, errors->lit),
                             share((double)errors->bad_lit, errors->lit),
                             share(errors->shadowed_error, errors->shadowed)};
    fprintf(stream, "%s\t%s\t", c->name, c->group);
    print_rates(stream, method, counts, parts);
}

static void print_means(const box_run *run) {
    for (const box_mean *m = run->means; *m->method; m++) {
        const uint64_t counts[2] = {m->lit, m->shadowed};
        const double parts[3] = {share(m->lit_error, m->lit_cases), share(m->bad_lit, m->lit_cases),
                                 share(m->shadowed_error, m->shadowed_cases)};
        fprintf(run->stream, "ALL\tALL\t");
        print_rates(run->stream, m->method, counts, parts);
    }
}

static bool run_case(shb_context *context, const stability_options *options,
                     const stability_case *c, void *user) {
    box_run *run = user;
    const uint32_t reach = (options->box + 1) / 2;
    stability_stage stage;
    listed_method method;
    bool done =
        tool_succeeds("stability", c->name, stability_open(context, options, c, reach, &stage));
    for (size_t i = 0; done && method_list_at(i, &method); i++) {
        box_errors errors = {0};
        if (!stability_wants_method(options, method.name) ||
            method.occluders == SHB_OCCLUDERS_LISTS)
            continue;
        done = tool_succeeds("stability", method.name,
                             measure(&stage, &method, &run->filter, &errors));
        if (!done)
            break;
        add_to_mean(run, method.name, &errors);
        if (options->tsv)
            print_row(run->stream, c, method.name, &errors);
    }
    stability_stage_close(&stage);
    return done;
}

bool stability_run_boxes(shb_context *context, const stability_options *options, FILE *stream) {
    box_run run = {.stream = stream,
                   .filter = shb_filter_pcf((float)options->box, SHB_UNIT_TEXEL, SHB_TAPS_PLANE)};
    fprintf(stream, "case\tgroup\tmethod\tlit\tshadowed\tlit_error_ppm\tlit_bad_ppm\t"
                    "shadowed_error_ppm\n");
    const bool done = stability_each_case(context, options, run_case, &run);
    print_means(&run);
    return done;
}
