#include "strict.h"

#include "pcss.h"

/* Adding this rounds a float below 2^22 to an integer, ties to even, as the kernels do. */
#define ROUNDING 12582912.0f

static bool is_inside(const shb_map *map, const shb_pcss_fragment *f, int32_t m, int32_t n) {
    return (uint32_t)(f->texel_x + m) < map->info.width &&
           (uint32_t)(f->texel_y + n) < map->info.height;
}

static shb_pcss_stage ask_disk(const shb_pcss *pcss, const shb_map *map, const shb_pcss_fragment *f,
                               float radius_x, float radius_y, int count) {
    const float cosine = pcss->turns[2 * f->turn], sine = pcss->turns[2 * f->turn + 1];
    shb_pcss_stage stage = {0, 0, (float)count};
    for (int k = 0; k < count; k++) {
        const float px = pcss->points[k][0], py = pcss->points[k][1];
        const float x = (radius_x * cosine * px - radius_x * sine * py) - f->to_center_x;
        const float y = (radius_y * sine * px + radius_y * cosine * py) - f->to_center_y;
        const int32_t m = (int32_t)((x + ROUNDING) - ROUNDING);
        const int32_t n = (int32_t)((y + ROUNDING) - ROUNDING);
        float depth;
        if (!is_inside(map, f, m, n) || !f->is_blocked(f->taps, m, n, &depth))
            continue;
        stage.blocked += 1;
        stage.depth += depth;
    }
    return stage;
}

/* The columns of each lane, row by row. */
static shb_pcss_stage ask_square(const shb_map *map, const shb_pcss_fragment *f, float radius_x,
                                 float radius_y) {
    const shb_square_axis across = shb_square_axis_of(f->to_center_x, radius_x);
    const shb_square_axis down = shb_square_axis_of(f->to_center_y, radius_y);
    float blocked[SHB_SQUARE_LANES] = {0}, depths[SHB_SQUARE_LANES] = {0};
    float all[SHB_SQUARE_LANES] = {0};
    float height = 0;
    for (int32_t n = down.first; n <= down.last; n++)
        height += shb_square_cover(&down, n);
    for (int32_t m = across.first; m <= across.last; m++) {
        const int lane = (m - across.first) % SHB_SQUARE_LANES;
        const float width = shb_square_cover(&across, m);
        float column_blocked = 0, column_depth = 0;
        for (int32_t n = down.first; n <= down.last && width > 0; n++) {
            float depth;
            if (!is_inside(map, f, m, n) || !f->is_blocked(f->taps, m, n, &depth))
                continue;
            const float part = shb_square_cover(&down, n);
            column_blocked += part;
            column_depth += part * depth;
        }
        blocked[lane] += width * column_blocked;
        depths[lane] += width * column_depth;
        all[lane] += width * height;
    }
    return (shb_pcss_stage){shb_square_sum(blocked), shb_square_sum(depths), shb_square_sum(all)};
}

static shb_pcss_stage ask_taps(const shb_pcss *pcss, const shb_map *map, const shb_pcss_fragment *f,
                               float blocker, int count) {
    const float radius_x = shb_pcss_radius(pcss->texels_x, f->depth, blocker);
    const float radius_y = shb_pcss_radius(pcss->texels_y, f->depth, blocker);
    if (count)
        return ask_disk(pcss, map, f, radius_x, radius_y, count);
    if (radius_x > SHB_PCSS_SQUARE_MOST || radius_y > SHB_PCSS_SQUARE_MOST)
        return ask_disk(pcss, map, f, radius_x, radius_y, SHB_PCSS_SPREAD);
    return ask_square(map, f, radius_x, radius_y);
}

float shb_pcss_visibility(const shb_pcss *pcss, const shb_map *map, const shb_pcss_fragment *f) {
    if (!is_inside(map, f, 0, 0))
        return 1;
    const shb_pcss_stage search = ask_taps(pcss, map, f, pcss->near_depth, pcss->blockers);
    if (!(search.blocked > 0))
        return 1;
    const float mean = search.depth / search.blocked;
    const float blocker = mean > pcss->near_depth ? mean : pcss->near_depth;
    const shb_pcss_stage filter = ask_taps(pcss, map, f, blocker, pcss->samples);
    return (filter.all - filter.blocked) / filter.all;
}
