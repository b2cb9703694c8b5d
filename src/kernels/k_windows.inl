/* What could stand between fragments and a light: the formulas of light_span.h. */

/* The nearest texel of a window makes it smaller, and that its nearest texel farther. */
enum { NARROWINGS = 3 };

/* Rectangles of texels inside the map, last ones included. */
typedef struct wide_window {
    vi x0, y0, x1, y1;
} wide_window;

/* The texel that holds a place, or the map's first or last one. */
static inline ALWAYS_INLINE vi texel_at(vf place, uint32_t size) {
    const vf at_most = vf_min(place, vf_splat((float)(size - 1)));
    return __builtin_convertvector(vf_max(at_most, vf_splat(0)), vi);
}

/* The texels that the light spans for a blocker so much nearer than the fragment. */
static inline ALWAYS_INLINE wide_window spanned(const shb_map_info *info,
                                                const shb_light_span *span, vf x, vf y,
                                                vf nearer_by) {
    const vf reach_x = 0.5f * span->x * nearer_by, reach_y = 0.5f * span->y * nearer_by;
    return (wide_window){texel_at(x - reach_x, info->width), texel_at(y - reach_y, info->height),
                         texel_at(x + reach_x, info->width), texel_at(y + reach_y, info->height)};
}

/* No texel of the window is nearer: the least of four cells, the smallest that hold it. */
static inline ALWAYS_INLINE vf least_depth(const shb_depth_minima *minima, const shb_map_info *info,
                                           const wide_window *w) {
    vi shift = vi_splat(SHB_MINIMA_SHIFT), larger = vi_splat(-1);
    while (vi_any(larger)) {
        larger =
            ((w->x1 >> shift) - (w->x0 >> shift) > 1) | ((w->y1 >> shift) - (w->y0 >> shift) > 1);
        shift -= larger;
    }
    const vi columns = (((int32_t)info->width - 1) >> shift) + 1;
    const vi first = (vi)look_up(minima->firsts, shift - SHB_MINIMA_SHIFT);
    const vi top = first + (w->y0 >> shift) * columns, bottom = first + (w->y1 >> shift) * columns;
    const vi left = w->x0 >> shift, right = w->x1 >> shift;
    const vf above =
        vf_min(vf_gather(minima->cells, top + left), vf_gather(minima->cells, top + right));
    const vf below =
        vf_min(vf_gather(minima->cells, bottom + left), vf_gather(minima->cells, bottom + right));
    return vf_min(above, below);
}

static void find_windows(const shb_map *map, const shb_light_span *span, size_t count,
                         const shb_receivers *r, shb_light_windows *out) {
    const shb_map_info *info = &map->info;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        const vi texel_x = vi_load(r->texel_x + i), texel_y = vi_load(r->texel_y + i);
        const vf to_x = vf_load(r->to_center_x + i), to_y = vf_load(r->to_center_y + i);
        const vf run = vf_load(r->step_x + i) * to_x + vf_load(r->step_y + i) * to_y;
        const vf own = vf_load(r->ref + i) - run;
        const vf depth = vf_min(own, vf_splat(span->far_depth));
        const vf x = (__builtin_convertvector(texel_x, vf) + 0.5f) - to_x;
        const vf y = (__builtin_convertvector(texel_y, vf) + 0.5f) - to_y;
        const vi inside = (vi)((vu)texel_x < info->width) & (vi)((vu)texel_y < info->height);
        const vi open = inside & (own > span->near_depth);
        vf nearest = vf_where(open, vf_splat(span->near_depth), depth);
        for (int k = 0; k < NARROWINGS && vi_any(nearest < depth); k++) {
            const wide_window window = spanned(info, span, x, y, depth - nearest);
            const vf least = least_depth(&span->minima, info, &window);
            nearest = vf_where(nearest < depth, least, nearest);
        }
        const wide_window window = spanned(info, span, x, y, depth - nearest);
        vf_store(out->x + i, x);
        vf_store(out->y + i, y);
        vf_store(out->depth + i, depth);
        vf_store(out->nearest + i, nearest);
        vi_store(out->x0 + i, window.x0);
        vi_store(out->y0 + i, window.y0);
        vi_store(out->x1 + i, window.x1);
        vi_store(out->y1 + i, window.y1);
    }
}
