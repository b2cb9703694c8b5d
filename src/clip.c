#include "strict.h"

#include "clip.h"

#include <math.h>

/* Window X = (x / w + 1) * (width / 2) lies within the guard band where x / w lies within
 * -(2 * guard / width + 1) .. 2 * guard / width - 1; Y turns the axis round. */
shb_clip_volume shb_clip_volume_of(uint32_t width, uint32_t height, bool reversed) {
    const double guard_x = 2 * SHB_GUARD_PIXELS / (double)width;
    const double guard_y = 2 * SHB_GUARD_PIXELS / (double)height;
    return (shb_clip_volume){
        .cut = {{2, 1, reversed ? 1 : 0},
                {0, 1, guard_x + 1},
                {0, -1, guard_x - 1},
                {1, 1, guard_y - 1},
                {1, -1, guard_y + 1}},
        .border = {{0, 1, 1}, {0, -1, 1}, {1, 1, 1}, {1, -1, 1}},
    };
}

bool shb_clip_is_finite(const shb_clip_position *position) {
    const double *v = position->v;
    return fabs(v[0]) <= SHB_CLIP_MAX && fabs(v[1]) <= SHB_CLIP_MAX && fabs(v[2]) <= SHB_CLIP_MAX &&
           fabs(v[3]) <= SHB_CLIP_MAX;
}

static double distance(const shb_clip_plane *plane, const shb_clip_position *position) {
    return plane->sign * position->v[plane->axis] + plane->offset * position->v[3];
}

static bool is_outside(const shb_clip_plane *plane, const shb_clip_position corners[3]) {
    return distance(plane, &corners[0]) < 0 && distance(plane, &corners[1]) < 0 &&
           distance(plane, &corners[2]) < 0;
}

static bool is_inside(const shb_clip_plane *plane, const shb_clip_position corners[3]) {
    return distance(plane, &corners[0]) >= 0 && distance(plane, &corners[1]) >= 0 &&
           distance(plane, &corners[2]) >= 0;
}

/* Where the edge leaves the plane's inside. It depends on the two ends alone, taken from the inside
 * to the outside, so that the triangle on the other side of the edge finds the same point. */
static shb_clip_position cut_edge(const shb_clip_plane *plane, const shb_clip_position *inside,
                                  const shb_clip_position *outside) {
    const double from = distance(plane, inside), to = distance(plane, outside);
    const double t = from / (from - to);
    shb_clip_position cut;
    for (int i = 0; i < 4; i++)
        cut.v[i] = inside->v[i] + (outside->v[i] - inside->v[i]) * t;
    cut.v[plane->axis] = 0.0 - plane->sign * plane->offset * cut.v[3];
    return cut;
}

/* Sutherland and Hodgman: a plane adds at most one corner to a convex polygon. Rounding can make it
 * slightly concave; then a plane could add more, and what no longer fits is left out. */
static void cut_polygon(const shb_clip_plane *plane, shb_polygon *polygon) {
    const shb_polygon whole = *polygon;
    size_t count = 0;
    for (size_t i = 0; i < whole.count; i++) {
        const shb_clip_position *here = &whole.corners[i];
        const shb_clip_position *next = &whole.corners[(i + 1) % whole.count];
        const bool here_inside = distance(plane, here) >= 0;
        const bool next_inside = distance(plane, next) >= 0;
        if (here_inside && count < SHB_POLYGON_MAX)
            polygon->corners[count++] = *here;
        if (here_inside != next_inside && count < SHB_POLYGON_MAX)
            polygon->corners[count++] =
                here_inside ? cut_edge(plane, here, next) : cut_edge(plane, next, here);
    }
    polygon->count = count;
}

static bool can_project(const shb_polygon *polygon) {
    for (size_t i = 0; i < polygon->count; i++)
        if (polygon->corners[i].v[3] < SHB_W_MIN)
            return false;
    return polygon->count >= 3;
}

shb_clip_outcome shb_clip_triangle(const shb_clip_volume *volume,
                                   const shb_clip_position corners[3], shb_polygon *polygon) {
    for (int i = 0; i < 4; i++)
        if (is_outside(&volume->border[i], corners))
            return SHB_CLIP_OUTSIDE;
    *polygon = (shb_polygon){3, {corners[0], corners[1], corners[2]}};
    bool whole = true;
    for (int i = 0; i < SHB_CUT_PLANES; i++) {
        if (is_inside(&volume->cut[i], corners))
            continue;
        cut_polygon(&volume->cut[i], polygon);
        whole = false;
    }
    if (!can_project(polygon))
        return SHB_CLIP_OUTSIDE;
    return whole ? SHB_CLIP_WHOLE : SHB_CLIP_CUT;
}
