#include "report.h"

#include <stdio.h>
#include <string.h>

static double ghz(const bench_session *session) {
    return session->machine.cycles_per_second * 1e-9;
}

static void print_machine(const bench_session *session) {
    const bench_machine *machine = &session->machine;
    printf("%s, %u thread%s, %s time, %.2f GHz by a chain of additions\n",
           shb_isa_name(shb_context_isa(session->context)), shb_context_threads(session->context),
           shb_context_threads(session->context) == 1 ? "" : "s",
           session->clock == BENCH_CLOCK_THREAD ? "the thread's processor" : "wall", ghz(session));
    printf("medians of at least %u runs, scalar of %u\n", session->plan.runs,
           session->scalar_plan.runs);
    printf("%-24s", "bandwidth in GB/s of MB");
    for (size_t i = 0; i < machine->bandwidth_count; i++)
        printf("%8zu", machine->bandwidths[i].bytes >> 20);
    printf("\n%-24s", "  memset");
    for (size_t i = 0; i < machine->bandwidth_count; i++)
        printf("%8.1f", machine->bandwidths[i].set * 1e-9);
    printf("\n%-24s", "  64-byte stores");
    for (size_t i = 0; i < machine->bandwidth_count; i++)
        printf("%8.1f", machine->bandwidths[i].store * 1e-9);
    printf("\n%-24s", "  copy, read and written");
    for (size_t i = 0; i < machine->bandwidth_count; i++)
        printf("%8.1f", machine->bandwidths[i].copy * 1e-9);
    printf("\n");
}

void report_begin(bench_session *session) {
    if (session->options.tsv)
        printf("stage\tscene\ttriangles\tsize\tisa\tthreads\tms_median\tms_min\tcycles_per_item\t"
               "ns_per_item\tspeedup_vs_scalar\tfraction_of_limit\tmeasured\tgoal\t"
               "map_ms\tshade_ms\tratio\tpaper_ratio\trms\tsimilarity\n");
    else
        print_machine(session);
    fflush(stdout);
}

/* A number, or a dash for one that was not measured. */
static void print_field(double value, int decimals, const char *separator) {
    if (value > 0)
        printf("%.*f%s", decimals, value, separator);
    else
        printf("-%s", separator);
}

static void print_tabs(const bench_session *session, const bench_row *row) {
    const double ns = row->items > 0 ? 1e9 * row->times.median / row->items : 0;
    printf("%s\t%s\t%llu\t%u\t%s\t%u\t%.4f\t%.4f\t", row->stage, row->scene,
           (unsigned long long)row->triangles, row->size, shb_isa_name(row->isa), row->threads,
           1e3 * row->times.median, 1e3 * row->times.least);
    print_field(ns * ghz(session), 3, "\t");
    print_field(ns, 3, "\t");
    print_field(row->scalar.median / row->times.median, 2, "\t");
    print_field(row->limit_seconds / row->times.median, 4, "\t");
    print_field(row->measured, 3, "\t");
    print_field(row->goal, 3, "\t");
    print_field(1e3 * row->soft.map_seconds, 4, "\t");
    print_field(1e3 * row->soft.shade_seconds, 4, "\t");
    print_field(row->soft.ratio, 3, "\t");
    print_field(row->soft.paper, 3, "\t");
    print_field(row->soft.rms, 5, "\t");
    print_field(row->soft.similarity, 5, "\n");
}

/* The same row of the reference. */
static bench_row scalar_row(const bench_row *row) {
    bench_row scalar = *row;
    scalar.isa = SHB_ISA_SCALAR;
    scalar.times = row->scalar;
    return scalar;
}

/* Nine characters and a space before them, digits as far as they fit. */
static void print_cost(double value) {
    if (value < 1e5)
        printf(" %9.2f", value);
    else
        printf(" %9.3g", value);
}

static void print_columns(const bench_session *session, const bench_row *row) {
    const double ms = 1e3 * row->times.median;
    const double ns = 1e9 * row->times.median / row->items;
    printf("  %-24s%6u%10.3f%10.3f", row->stage, row->size, ms, 1e3 * row->times.least);
    if (row->by_fragment)
        printf("%9s", "-");
    else
        printf("%9.1f", (double)row->triangles / ms * 1e-3);
    printf("%10.0f", row->texels / ms * 1e-3);
    print_cost(ns);
    print_cost(ns * ghz(session));
    printf("%7.1f%8.1f%%", row->texels > 0 ? row->bytes / row->texels : 0,
           100 * row->limit_seconds / row->times.median);
    if (row->scalar.median > 0)
        printf("%11.3f%8.1f", 1e3 * row->scalar.median, row->scalar.median / row->times.median);
    printf("\n");
}

static void print_scene_heading(bench_session *session, const bench_row *row) {
    printf("\n%s, %llu triangles\n  %-24s%6s%10s%10s%9s%10s%10s%10s%7s%9s%11s%8s\n", row->scene,
           (unsigned long long)row->triangles, "stage", "size", "ms", "least", "Mtri/s", "Mtexel/s",
           "ns/item", "cyc/item", "B/tex", "limit", "scalar ms", "times");
    snprintf(session->heading, sizeof session->heading, "%s", row->scene);
}

void report_stage(bench_session *session, const bench_row *row) {
    progress_end(&session->progress);
    if (session->options.tsv) {
        print_tabs(session, row);
        if (row->scalar.median > 0) {
            const bench_row reference = scalar_row(row);
            print_tabs(session, &reference);
        }
    } else {
        if (strcmp(session->heading, row->scene) != 0)
            print_scene_heading(session, row);
        print_columns(session, row);
    }
    fflush(stdout);
}

void report_heading(bench_session *session, const char *heading) {
    progress_end(&session->progress);
    if (!session->options.tsv)
        printf("\n%-34s%-16s%6s%9s%12s%10s%10s%10s  %s\n", heading, "scene", "size", "isa", "goal",
               "measured", "least", "ms", "reached");
}

void report_goal(bench_session *session, const bench_row *row, const char *unit, double least,
                 bool at_least) {
    progress_end(&session->progress);
    const bool reached = at_least ? row->measured >= row->goal : row->measured <= row->goal;
    if (session->options.tsv)
        print_tabs(session, row);
    else
        printf("  %-32s%-16s%6u%9s  %s%6.2f%s%10.3f%10.3f%10.3f  %s\n", row->stage, row->scene,
               row->size, shb_isa_name(row->isa), at_least ? ">=" : "<=", row->goal, unit,
               row->measured, least, 1e3 * row->times.median, reached ? "yes" : "no");
    fflush(stdout);
}

void report_soft_heading(bench_session *session, const char *heading) {
    progress_end(&session->progress);
    if (!session->options.tsv)
        printf("\n%-34s%9s%9s%9s%8s%8s%9s%9s%9s\n", heading, "map ms", "shade ms", "overall",
               "times", "paper", "ns/item", "rms", "ssim");
}

void report_soft(bench_session *session, const bench_row *row) {
    const bench_soft *soft = &row->soft;
    progress_end(&session->progress);
    if (session->options.tsv) {
        print_tabs(session, row);
    } else {
        printf("  %-32s%9.2f%9.2f%9.2f%8.2f", row->stage, 1e3 * soft->map_seconds,
               1e3 * soft->shade_seconds, 1e3 * (soft->map_seconds + soft->shade_seconds),
               soft->ratio);
        if (soft->paper > 0)
            printf("%8.2f", soft->paper);
        else
            printf("%8s", "-");
        printf("%9.1f%9.4f%9.4f\n", 1e9 * row->times.median / row->items, soft->rms,
               soft->similarity);
    }
    fflush(stdout);
}
