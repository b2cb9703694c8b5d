#include "filters.h"

#include "light_space.h"
#include "tool.h"

#include <string.h>

/* Fragments whose answer is off by more than this are counted. */
#define BAD_ERROR 0.2

/* Of either stage of soft shadows. */
enum { TAPS = 25 };

/* Of fragments whose kernel holds no silhouette; errors are sums of |answer - truth|. */
typedef struct kernel_errors {
    uint64_t lit, shadowed, bad_lit;
    double lit_error, shadowed_error;
} kernel_errors;

/* Sums over cases of what print_rates shows. */
typedef struct kernel_mean {
    char method[32];
    uint64_t lit, shadowed;
    size_t lit_cases, shadowed_cases;
    double lit_error, bad_lit, shadowed_error; /* parts of 1 */
} kernel_mean;

enum { MEANS_MAX = 32 };

typedef struct kernel_run {
    FILE *stream;
    kernel_mean means[STABILITY_MEANS][MEANS_MAX];
} kernel_run;

static kernel_errors count_errors(const stability_stage *stage) {
    kernel_errors errors = {0};
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

/* The width of a texel at a depth in the middle of a map, in the world. */
static double texel_width(const light_space *space, double depth) {
    const light_point left = {space->width / 2, space->height / 2, depth};
    const light_point right = {left.x + 1, left.y, depth};
    return shb_vec3_length(
        shb_vec3_subtract(light_space_unproject(space, right), light_space_unproject(space, left)));
}

/* How large a light is whose penumbra, from the near plane to the far one, takes so many texels:
 * L (w_far - w_near) / w_near of a spot, where w is as the width of a texel; of parallel rays L
 * times the way. */
static double light_of_texels(const light_space *space, bool is_spot, double texels) {
    const double near_depth = space->reversed ? -1 : 0, far_depth = near_depth + 1;
    const double at_near = texel_width(space, near_depth), at_far = texel_width(space, far_depth);
    if (is_spot)
        return texels * at_far * at_near / (at_far - at_near);
    const light_point first = {space->width / 2, space->height / 2, near_depth};
    const light_point last = {first.x, first.y, far_depth};
    return texels * at_far /
           shb_vec3_length(shb_vec3_subtract(light_space_unproject(space, last),
                                             light_space_unproject(space, first)));
}

static shb_result make_filter(const stability_options *options, const shb_map *map,
                              shb_filter *filter) {
    const shb_map_info *info = shb_map_get_info(map);
    shb_light_source source;
    light_space space;
    if (options->box) {
        *filter = shb_filter_pcf((float)options->box, SHB_UNIT_TEXEL, SHB_TAPS_PLANE);
        return SHB_OK;
    }
    shb_result result = shb_view_light_source(&info->view, &source);
    if (!result)
        result = light_space_create(info, &space);
    if (!result)
        *filter = shb_filter_pcss((float)light_of_texels(&space, source.w != 0, options->pcss),
                                  TAPS, TAPS, SHB_TAPS_PLANE);
    return result;
}

static shb_result measure(const stability_stage *stage, const stability_options *options,
                          const listed_method *method, kernel_errors *errors) {
    const shb_bias bias = method->method->make();
    shb_filter filter;
    shb_map *map = NULL;
    shb_result result = stability_draw_map(stage, method, &bias, &map);
    if (!result)
        result = make_filter(options, map, &filter);
    if (!result)
        result = shb_map_visibility(map, &stage->points, &bias, &filter, stage->frame.visibility);
    if (!result)
        *errors = count_errors(stage);
    shb_map_destroy(map);
    return result;
}

static double share(double part, uint64_t all) {
    return all ? part / (double)all : 0;
}

/* The method's own place, or the first empty one. */
static kernel_mean *mean_of(kernel_mean *means, const char *method) {
    int i = 0;
    while (i < MEANS_MAX - 1 && *means[i].method && strcmp(means[i].method, method) != 0)
        i++;
    snprintf(means[i].method, sizeof means[i].method, "%s", method);
    return &means[i];
}

static void add_to_mean(kernel_mean *means, const char *method, const kernel_errors *errors) {
    kernel_mean *mean = mean_of(means, method);
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
                      const kernel_errors *errors) {
    const uint64_t counts[2] = {errors->lit, errors->shadowed};
    const double parts[3] = {share(errors->lit_error, errors->lit),
                             share((double)errors->bad_lit, errors->lit),
                             share(errors->shadowed_error, errors->shadowed)};
    fprintf(stream, "%s\t%s\t", c->name, c->group);
    print_rates(stream, method, counts, parts);
}

static void print_means(FILE *stream, const kernel_mean *means, const char *name) {
    for (const kernel_mean *m = means; *m->method; m++) {
        const uint64_t counts[2] = {m->lit, m->shadowed};
        const double parts[3] = {share(m->lit_error, m->lit_cases), share(m->bad_lit, m->lit_cases),
                                 share(m->shadowed_error, m->shadowed_cases)};
        fprintf(stream, "%s\t%s\t", name, name);
        print_rates(stream, m->method, counts, parts);
    }
}

static bool run_case(shb_context *context, const stability_options *options,
                     const stability_case *c, void *user) {
    kernel_run *run = user;
    const uint32_t reach = options->box ? (options->box + 1) / 2 : options->pcss / 2 + 1;
    stability_stage stage;
    listed_method method;
    bool done =
        tool_succeeds("stability", c->name, stability_open(context, options, c, reach, &stage));
    for (size_t i = 0; done && method_list_at(i, &method); i++) {
        kernel_errors errors = {0};
        if (!stability_wants_method(options, method.name) ||
            method.occluders == SHB_OCCLUDERS_LISTS)
            continue;
        done = tool_succeeds("stability", method.name, measure(&stage, options, &method, &errors));
        if (!done)
            break;
        for (stability_mean over = STABILITY_RESOLVED; over < STABILITY_MEANS; over++)
            if (stability_mean_has(over, c))
                add_to_mean(run->means[over], method.name, &errors);
        if (options->tsv)
            print_row(run->stream, c, method.name, &errors);
    }
    stability_stage_close(&stage);
    return done;
}

bool stability_run_filter(shb_context *context, const stability_options *options, FILE *stream) {
    kernel_run run = {.stream = stream};
    fprintf(stream, "case\tgroup\tmethod\tlit\tshadowed\tlit_error_ppm\tlit_bad_ppm\t"
                    "shadowed_error_ppm\n");
    const bool done = stability_each_case(context, options, run_case, &run);
    for (stability_mean over = STABILITY_RESOLVED; over < STABILITY_MEANS; over++)
        print_means(stream, run.means[over], stability_mean_name(over));
    return done;
}
