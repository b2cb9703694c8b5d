#include "study_tuner.h"

#include "page_table.h"
#include "scene_list.h"
#include "tool.h"
#include "tuner.h"

#include <math.h>

enum { MAP_SIZE = 1024 };

/* What is tuned, as all forms of the table name it. */
typedef struct tuned_light {
    const char *scene, *light;
    uint32_t map_size;
    double limit_ppm;
    tuner_result result;
} tuned_light;

/* ---- columns ---- */

static double depth_of_16_bits(const tuner_row *row) {
    return tuner_integer_depth(row->depth, 16);
}
static double depth_of_24_bits(const tuner_row *row) {
    return tuner_integer_depth(row->depth, 24);
}
static double depth(const tuner_row *row) {
    return row->depth;
}
static double texels(const tuner_row *row) {
    return row->texels;
}
static double world(const tuner_row *row) {
    return row->world;
}
static double slope_factor(const tuner_row *row) {
    return row->slope_factor;
}
static double false_shadow(const tuner_row *row) {
    return row->found.tuned.errors.false_shadow_ppm;
}
static double false_light(const tuner_row *row) {
    return row->found.tuned.errors.false_light_ppm;
}
static double boundary(const tuner_row *row) {
    return row->found.tuned.errors.boundary_ppm;
}
static double detachment(const tuner_row *row) {
    return row->detachment.texels;
}

static const struct {
    const char *name, *title;
    double (*value_of)(const tuner_row *row);
} columns[] = {
    {"depth", "map depth", depth},
    {"depth_16_bits", "of 16 bits", depth_of_16_bits},
    {"depth_24_bits", "of 24 bits", depth_of_24_bits},
    {"texels", "texels", texels},
    {"world", "world units", world},
    {"slope_factor", "slope factor", slope_factor},
    {"false_shadow_ppm", "false shadow", false_shadow},
    {"false_light_ppm", "false light", false_light},
    {"boundary_ppm", "at boundaries", boundary},
    {"detachment_texels", "detached texels", detachment},
};
enum { COLUMNS = sizeof columns / sizeof *columns };

static const char *outcome(const tuner_row *row) {
    return row->found.met ? "met" : row->has_knob ? "not met" : "no knob, not met";
}

/* ---- the three forms ---- */

static void write_table_head(FILE *table) {
    fprintf(table, "scene\tlight\tmap_size\tlimit_ppm\tmethod\tsetting\toutcome");
    for (size_t k = 0; k < COLUMNS; k++)
        fprintf(table, "\t%s", columns[k].name);
    fprintf(table, "\n");
}

static void write_table_rows(FILE *table, const tuned_light *light) {
    for (size_t i = 0; i < TUNER_METHODS; i++) {
        const tuner_row *row = &light->result.rows[i];
        fprintf(table, "%s\t%s\t%u\t%g\t%s\t%s\t%s", light->scene, light->light,
                (unsigned)light->map_size, light->limit_ppm, row->method, row->setting,
                outcome(row));
        for (size_t k = 0; k < COLUMNS; k++) {
            const double value = columns[k].value_of(row);
            if (isnan(value))
                fprintf(table, "\t-");
            else
                fprintf(table, "\t%.6g", value);
        }
        fprintf(table, "\n");
    }
}

static void write_section_head(FILE *section, double limit_ppm) {
    fprintf(section,
            "<p class=\"lead\">The smallest constants that leave at most %g falsely shadowed "
            "fragments per million lit ones away from boundaries, and what they cost. Lengths are "
            "along the light's rays; where they differ over a picture, as texels of a spot light "
            "do, they are those of its middle fragment. Direct3D's DepthBias and the units of "
            "OpenGL's polygon offset are the integers of the map's format, SlopeScaledDepthBias "
            "and the factor are the slope factor. The same for a scene of your own: "
            "<code>build/report --tune scene.obj --limit %g</code>.</p>\n",
            limit_ppm, limit_ppm);
}

static void write_section_row(FILE *section, const tuner_row *row) {
    char text[48];
    fprintf(section, "<tr><th scope=\"row\">%s</th><td class=\"text\">%s</td>", row->setting,
            outcome(row));
    for (size_t k = 0; k < COLUMNS; k++) {
        report_format_number(text, sizeof text, columns[k].value_of(row));
        fprintf(section, "<td>%s</td>", text);
    }
    fprintf(section, "</tr>\n");
}

static void write_section_light(FILE *section, const tuned_light *light) {
    fprintf(section,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Constants for %s, "
            "%s\">\n<table class=\"plain\">\n<caption>%s, %s, map of %u</caption>\n<thead><tr><th "
            "class=\"text\" scope=\"col\">smallest setting</th><th class=\"text\" "
            "scope=\"col\">limit</th>",
            light->scene, light->light, light->scene, light->light, (unsigned)light->map_size);
    for (size_t k = 0; k < COLUMNS; k++)
        fprintf(section, "<th scope=\"col\">%s</th>", columns[k].title);
    fprintf(section, "</tr></thead>\n<tbody>\n");
    for (size_t i = 0; i < TUNER_METHODS; i++)
        write_section_row(section, &light->result.rows[i]);
    fprintf(section, "</tbody>\n</table>\n</div>\n");
}

static void print_light(const tuned_light *light) {
    const tuner_result *result = &light->result;
    printf("%s, %s, map of %u: at most %g false shadow per million lit fragments\n", light->scene,
           light->light, (unsigned)light->map_size, light->limit_ppm);
    printf("  a texel is %.4g world units wide, a world unit is %.4g of map depth, the scene "
           "%.4g world units\n",
           result->units.texel_size, result->units.depth_per_world, result->units.scene_scale);
    printf("  %-48s %-16s", "smallest setting", "limit");
    for (size_t k = 0; k < COLUMNS; k++)
        printf(" %15s", columns[k].title);
    printf("\n");
    for (size_t i = 0; i < TUNER_METHODS; i++) {
        const tuner_row *row = &result->rows[i];
        char text[48];
        printf("  %-48s %-16s", row->setting, outcome(row));
        for (size_t k = 0; k < COLUMNS; k++) {
            report_format_number(text, sizeof text, columns[k].value_of(row));
            printf(" %15s", text);
        }
        printf("\n");
    }
    printf("  Direct3D: DepthBias is the integer of the map's format, SlopeScaledDepthBias the "
           "slope factor;\n  OpenGL: glPolygonOffset(slope factor, integer of the format)\n\n");
}

/* ---- running ---- */

static bool tune_light(report_stage *stage, scene_light_kind kind, const report_options *options,
                       tuned_light *light) {
    *light = (tuned_light){.scene = stage->name,
                           .light = report_light_name(kind),
                           .map_size = options->tuned_size ? options->tuned_size : MAP_SIZE,
                           .limit_ppm = options->limit_ppm};
    return tool_succeeds("report", stage->name,
                         tuner_run(stage, kind, light->map_size, light->limit_ppm, &light->result));
}

/* Tunes for the lights of one scene; section NULL: prints. */
static bool tune_scene(shb_context *context, const report_options *options,
                       const report_scene *scene, FILE *table, FILE *section) {
    report_stage stage;
    tuned_light light;
    bool done =
        report_stage_open(context, scene->text, scene->name, report_picture_size(options), &stage);
    for (int kind = 0; done && kind < (scene->both_lights ? SCENE_LIGHT_KINDS : 1); kind++) {
        done = tune_light(&stage, (scene_light_kind)kind, options, &light);
        if (!done)
            break;
        write_table_rows(table, &light);
        if (section)
            write_section_light(section, &light);
        else
            print_light(&light);
    }
    report_stage_close(&stage);
    return done;
}

static bool run_tuner(shb_context *context, const report_options *options, FILE *table,
                      FILE *section) {
    report_scene_list scenes = report_list_main_scenes(options);
    bool done = tool_succeeds("report", "scenes", scenes.failed ? SHB_ERROR_MEMORY : SHB_OK);
    write_table_head(table);
    write_section_head(section, options->limit_ppm);
    for (size_t i = 0; done && i < scenes.count; i++)
        done = tune_scene(context, options, &scenes.scenes[i], table, section);
    report_scene_list_free(&scenes);
    return done;
}

const report_study report_study_tuner = {
    .name = "tuner", .title = "Where there are only constants", .run = run_tuner};

bool report_tune(shb_context *context, const report_options *options, const char *text) {
    char path[512];
    report_scene scene = {.both_lights = true};
    if (snprintf(path, sizeof path, "%s/tuner.tsv", options->directory) >= (int)sizeof path ||
        snprintf(scene.text, sizeof scene.text, "%s", text) >= (int)sizeof scene.text)
        return tool_succeeds("report", text, SHB_ERROR_SIZE);
    report_name_scene(scene.text, scene.name, sizeof scene.name);
    FILE *table = fopen(path, "w");
    if (!table)
        return tool_succeeds("report", path, SHB_ERROR_FILE);
    write_table_head(table);
    const bool done = tune_scene(context, options, &scene, table, NULL);
    return tool_close_text("report", table, path) && done;
}
