#include "peers.h"

#include "machine_name.h"
#include "page_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool read_row(const char *line, peer_row *row) {
    unsigned map_size;
    unsigned long long triangles, fragments;
    const int found = sscanf(
        line,
        "%31[^\t]\t%63[^\t]\t%llu\t%63[^\t]\t%63[^\t]\t%u\t%llu\t%lf\t%lf\t%lf\t%lf\t%lf\t%lf"
        "\t%lf",
        row->peer, row->scene, &triangles, row->task, row->own_method, &map_size, &fragments,
        &row->build_ms, &row->ask_ms, &row->own_build_ms, &row->own_ask_ms, &row->times_faster,
        &row->peer_wrong_ppm, &row->own_wrong_ppm);
    if (found != 14)
        return false;
    row->map_size = map_size;
    row->triangles = triangles;
    row->fragments = fragments;
    return true;
}

static bool add(peer_rows *peers, const peer_row *row) {
    peer_row *grown = realloc(peers->rows, (peers->count + 1) * sizeof *grown);
    if (!grown)
        return false;
    peers->rows = grown;
    peers->rows[peers->count++] = *row;
    return true;
}

bool report_peers_read(peer_rows *peers, const char *path) {
    FILE *stream = fopen(path, "r");
    char line[1024];
    bool room = stream != NULL;
    while (room && fgets(line, sizeof line, stream)) {
        peer_row row;
        if (read_row(line, &row))
            room = add(peers, &row);
    }
    if (stream)
        fclose(stream);
    return room;
}

/* ---- report.tsv ---- */

static double unless(bool missing, double value) {
    return missing ? (double)NAN : value;
}

static report_row row_of(const peer_row *peer, bool own) {
    const bool is_frame = strncmp(peer->task, "frame", 5) == 0;
    const double build = own ? peer->own_build_ms : peer->build_ms;
    const double ask = own ? peer->own_ask_ms : peer->ask_ms;
    const double wrong = own ? peer->own_wrong_ppm : peer->peer_wrong_ppm;
    report_row row = {.map_size = peer->map_size,
                      .triangles = peer->triangles,
                      .fragments = peer->fragments,
                      .map_ms = unless(build <= 0, build),
                      .shading_ms = unless(!is_frame, ask),
                      .wrong_ppm = unless(wrong < 0, wrong)};
    row.ns_per_fragment = unless(is_frame || !peer->fragments, 1e6 * ask / (double)peer->fragments);
    row.false_shadow_ppm = row.false_light_ppm = row.boundary_ppm = (double)NAN;
    row.rms = row.ssim = row.detachment_texels = (double)NAN;
    snprintf(row.scene, sizeof row.scene, "%s", peer->scene);
    snprintf(row.light, sizeof row.light, "sun");
    snprintf(row.filter, sizeof row.filter, "%s", peer->task);
    snprintf(row.method, sizeof row.method, "%s", own ? peer->own_method : peer->peer);
    return row;
}

bool report_peers_append(const peer_rows *peers, const char *path) {
    char machine[96];
    bool written = true;
    report_machine_name(machine, sizeof machine);
    for (size_t i = 0; written && i < peers->count; i++) {
        report_row rows[2] = {row_of(&peers->rows[i], false), row_of(&peers->rows[i], true)};
        for (int k = 0; k < 2; k++)
            snprintf(rows[k].settings, sizeof rows[k].settings, "beside %s, one thread, %s",
                     peers->rows[i].peer, machine);
        written = report_rows_append(rows, 2, path);
    }
    return written;
}

/* ---- the page ---- */

static void write_head(FILE *stream) {
    static const char *const titles[] = {"task",   "this library", "map texels", "its ms",
                                         "our ms", "times faster", "wrong, its", "wrong, ours"};
    fprintf(stream, "<thead><tr><th class=\"text\" scope=\"col\">peer and scene</th>");
    for (size_t i = 0; i < sizeof titles / sizeof *titles; i++)
        fprintf(stream, "<th%s scope=\"col\">%s</th>", i < 2 ? " class=\"text\"" : "", titles[i]);
    fprintf(stream, "</tr></thead>\n");
}

static void write_cell(FILE *stream, double value) {
    char text[32];
    report_format_number(text, sizeof text, value);
    fprintf(stream, "<td>%s</td>", text);
}

static void write_row(FILE *stream, const peer_row *row) {
    fprintf(stream,
            "<tr><th scope=\"row\">%s, %s</th><td class=\"text\">%s</td><td class=\"text\">%s</td>"
            "<td>%u</td>",
            row->peer, row->scene, row->task, row->own_method, (unsigned)row->map_size);
    write_cell(stream, row->build_ms + row->ask_ms);
    write_cell(stream, row->own_build_ms + row->own_ask_ms);
    write_cell(stream, row->times_faster);
    write_cell(stream, unless(row->peer_wrong_ppm < 0, row->peer_wrong_ppm));
    write_cell(stream, unless(row->own_wrong_ppm < 0, row->own_wrong_ppm));
    fprintf(stream, "</tr>\n");
}

void report_peers_write(FILE *stream, const peer_rows *peers) {
    if (peers->count == 0)
        return;
    fprintf(
        stream,
        "<section aria-labelledby=\"peers-title\" id=\"peers\">\n"
        "<h2 id=\"peers-title\">Beside other renderers</h2>\n"
        "<p class=\"lead\">Embree's shadow rays and Mesa's llvmpipe at the same work as this "
        "library, by turns on one thread: hierarchy or map, and the answers for every fragment "
        "of a picture, together. Below 1 the other one is faster. Wrong fragments in parts per "
        "million, boundaries included, against rays in double precision.</p>\n"
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"peers-title\">\n"
        "<table class=\"plain\">\n<caption>The same work by another renderer and by this "
        "library</caption>\n");
    write_head(stream);
    fprintf(stream, "<tbody>\n");
    for (size_t i = 0; i < peers->count; i++)
        write_row(stream, &peers->rows[i]);
    fprintf(stream, "</tbody>\n</table>\n</div>\n</section>\n");
}
