/* Fragments whose kernels the bounds of a map's pyramid show to be lit or dark as a whole. */

/* WIDE fragments with their receiver planes, and a rectangle of texels that holds their kernels. */
typedef struct plain_group {
    int32_t left, top, right, bottom; /* inclusive */
    vi texel_x, texel_y;
    vf ref, step_x, step_y;
} plain_group;

/* -1 where all that the rectangle holds is lit, or is dark. */
typedef struct plain_outcome {
    vi lit, dark;
} plain_outcome;

/* The bounds give way by this much of the numbers that went into a comparison: eight times what
 * the rounding of a handful of operations can be. */
#define PLAIN_ROUNDING 0x1p-20f

/* The least of the lanes in the mask, of which there is one; all within 2^24. */
static inline ALWAYS_INLINE int32_t least_of(vi mask, vi v) {
    const vf lanes = __builtin_convertvector(v, vf);
    return (int32_t)vf_least(vf_where(mask, lanes, vf_splat(0x1p24f)));
}

/* The rectangle of the wanted lanes, of which there is one; lane by lane it is inclusive, too. */
static inline ALWAYS_INLINE void set_rectangle(plain_group *group, vi wanted, vi left, vi top,
                                               vi right, vi bottom) {
    group->left = least_of(wanted, left);
    group->top = least_of(wanted, top);
    group->right = -least_of(wanted, -right);
    group->bottom = -least_of(wanted, -bottom);
}

/* The level where the rectangle takes no more than three steps. */
static int choose_level(const shb_pyramid *pyramid, const plain_group *group) {
    const int32_t wide = group->right - group->left, tall = group->bottom - group->top;
    int level = 0;
    while (level + 1 < pyramid->count &&
           (wide > tall ? wide : tall) >= 3 << (SHB_PYRAMID_SHIFT + level))
        level++;
    return level;
}

/* The first and the last cell along an axis that together hold a stretch of texels of the map. */
static inline void choose_cells(int32_t first, int32_t last, uint32_t size, int shift,
                                int32_t cells[2]) {
    const int32_t end = (int32_t)size - 1;
    cells[0] = (first > 0 ? first : 0) >> shift;
    cells[1] = ((last < end ? last : end) >> shift) - 1;
    cells[1] = cells[1] > cells[0] ? cells[1] : cells[0];
}

/* Rectangles have to hold a texel of the map, and the own ones of lanes whose outcome matters. */
static plain_outcome find_plain(const shb_pyramid *pyramid, const shb_map *map,
                                const plain_group *group) {
    const int chosen = choose_level(pyramid, group);
    const shb_pyramid_level *level = &pyramid->levels[chosen];
    const int shift = SHB_PYRAMID_SHIFT + chosen;
    int32_t columns[2], rows[2];
    choose_cells(group->left, group->right, map->info.width, shift, columns);
    choose_cells(group->top, group->bottom, map->info.height, shift, rows);
    const bool inside = group->left >= 0 && group->top >= 0 &&
                        group->right < (int32_t)map->info.width &&
                        group->bottom < (int32_t)map->info.height;
    const float end = (float)((2 << shift) - 1);
    const vf zero = vf_splat(0), step_x = group->step_x, step_y = group->step_y;
    const vf texel_x = __builtin_convertvector(group->texel_x, vf);
    const vf texel_y = __builtin_convertvector(group->texel_y, vf);
    const vf rounding =
        PLAIN_ROUNDING * (vf_abs(group->ref) + (vf_abs(step_x) + vf_abs(step_y)) * (2 * end));
    plain_outcome plain = {vi_splat(-1), vi_splat(inside ? -1 : 0)};
    for (int k = 0; k < 4; k++) {
        const int32_t column = columns[k & 1], row = rows[k >> 1];
        const shb_pyramid_cell *cell = &level->cells[(size_t)row * level->columns + (size_t)column];
        const vf m = (float)(column << shift) - texel_x, n = (float)(row << shift) - texel_y;
        const vf plane = (group->ref + m * step_x) + n * step_y;
        const vf more_x = (cell->slope_x - step_x) * end, more_y = (cell->slope_y - step_y) * end;
        plain.lit &=
            (cell->nearest - plane) + (vf_min(more_x, zero) + vf_min(more_y, zero)) >= rounding;
        plain.dark &=
            (cell->farthest - plane) + (vf_max(more_x, zero) + vf_max(more_y, zero)) < -rounding;
    }
    return plain;
}
