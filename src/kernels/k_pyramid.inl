/* Fragments whose kernel the bounds of a map's pyramid show to be lit or dark as a whole. */

/* WIDE kernels as rectangles of texels, with their receiver planes. */
typedef struct plain_lanes {
    vi left, top, right, bottom; /* inclusive */
    vi texel_x, texel_y;
    vf ref, step_x, step_y;
} plain_lanes;

/* -1 where all that the rectangle holds is lit, or is dark. */
typedef struct plain_outcome {
    vi lit, dark;
} plain_outcome;

/* The bounds give way by this much of the numbers that went into a comparison: eight times what
 * the rounding of a handful of operations can be. */
#define PLAIN_ROUNDING 0x1p-20f

/* The cells of lanes i, i + 4, i + 8, ... one after the other. */
#if WIDE == 16
static inline ALWAYS_INLINE vf load_every_fourth(const shb_pyramid_cell *cells, vi index, int i) {
    const __m128 first = _mm_loadu_ps(&cells[index[i]].nearest);
    const vf one = _mm512_castps128_ps512(first);
    const vf two = _mm512_insertf32x4(one, _mm_loadu_ps(&cells[index[i + 4]].nearest), 1);
    const vf three = _mm512_insertf32x4(two, _mm_loadu_ps(&cells[index[i + 8]].nearest), 2);
    return _mm512_insertf32x4(three, _mm_loadu_ps(&cells[index[i + 12]].nearest), 3);
}
#define UNPACK(part, a, b) _mm512_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm512_shuffle_ps(a, b, order)
#elif WIDE == 8
static inline ALWAYS_INLINE vf load_every_fourth(const shb_pyramid_cell *cells, vi index, int i) {
    const vf one = _mm256_castps128_ps256(_mm_loadu_ps(&cells[index[i]].nearest));
    return _mm256_insertf128_ps(one, _mm_loadu_ps(&cells[index[i + 4]].nearest), 1);
}
#define UNPACK(part, a, b) _mm256_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm256_shuffle_ps(a, b, order)
#elif WIDE == 4 && defined(__x86_64__)
static inline ALWAYS_INLINE vf load_every_fourth(const shb_pyramid_cell *cells, vi index, int i) {
    return _mm_loadu_ps(&cells[index[i]].nearest);
}
#define UNPACK(part, a, b) _mm_unpack##part##_ps(a, b)
#define SHUFFLE(a, b, order) _mm_shuffle_ps(a, b, order)
#endif

/* The numbers of WIDE cells. */
static inline ALWAYS_INLINE void read_cells(const shb_pyramid_cell *cells, vi index, vf *nearest,
                                            vf *farthest, vf *slope_x, vf *slope_y) {
#if defined(UNPACK)
    const vf first = load_every_fourth(cells, index, 0);
    const vf second = load_every_fourth(cells, index, 1);
    const vf third = load_every_fourth(cells, index, 2);
    const vf fourth = load_every_fourth(cells, index, 3);
    const vf a = UNPACK(lo, first, second), b = UNPACK(hi, first, second);
    const vf c = UNPACK(lo, third, fourth), d = UNPACK(hi, third, fourth);
    *nearest = SHUFFLE(a, c, _MM_SHUFFLE(1, 0, 1, 0));
    *farthest = SHUFFLE(a, c, _MM_SHUFFLE(3, 2, 3, 2));
    *slope_x = SHUFFLE(b, d, _MM_SHUFFLE(1, 0, 1, 0));
    *slope_y = SHUFFLE(b, d, _MM_SHUFFLE(3, 2, 3, 2));
#else
    *nearest = vf_gather(&cells->nearest, 4 * index);
    *farthest = vf_gather(&cells->farthest, 4 * index);
    *slope_x = vf_gather(&cells->slope_x, 4 * index);
    *slope_y = vf_gather(&cells->slope_y, 4 * index);
#endif
}

static inline vi vi_where(vi mask, vi yes, vi no) {
    return (mask & yes) | (~mask & no);
}

/* The level where the largest rectangle takes no more than three steps. */
static int choose_level(const shb_pyramid *pyramid, const plain_lanes *own) {
    const vi wide = own->right - own->left, tall = own->bottom - own->top;
    int level = 0;
    while (level + 1 < pyramid->count && vi_any((wide >= 3 << (SHB_PYRAMID_SHIFT + level)) |
                                                (tall >= 3 << (SHB_PYRAMID_SHIFT + level))))
        level++;
    return level;
}

/* The first and the last cell along an axis that together hold a stretch of texels of the map. */
static inline ALWAYS_INLINE void choose_cells(vi first, vi last, uint32_t size, int shift,
                                              vi cells[2]) {
    const vi end = vi_splat((int32_t)size - 1);
    cells[0] = vi_where(first > 0, first, vi_splat(0)) >> shift;
    cells[1] = (vi_where(last < end, last, end) >> shift) - 1;
    cells[1] = vi_where(cells[1] > cells[0], cells[1], cells[0]);
}

/* Rectangles have to hold a texel of the map. */
static plain_outcome find_plain(const shb_pyramid *pyramid, const shb_map *map,
                                const plain_lanes *own) {
    const int chosen = choose_level(pyramid, own);
    const shb_pyramid_level *level = &pyramid->levels[chosen];
    const int shift = SHB_PYRAMID_SHIFT + chosen;
    vi columns[2], rows[2];
    choose_cells(own->left, own->right, map->info.width, shift, columns);
    choose_cells(own->top, own->bottom, map->info.height, shift, rows);
    const float end = (float)((2 << shift) - 1);
    const vf zero = vf_splat(0);
    const vf steep = vf_max(own->step_x, -own->step_x) + vf_max(own->step_y, -own->step_y);
    const vf rounding = PLAIN_ROUNDING * (vf_max(own->ref, -own->ref) + steep * (2 * end));
    vi lit = vi_splat(-1);
    vi dark = (own->left >= 0) & (own->top >= 0) & (own->right < (int32_t)map->info.width) &
              (own->bottom < (int32_t)map->info.height);
    for (int k = 0; k < 4; k++) {
        const vi column = columns[k & 1], row = rows[k >> 1];
        const vf m = __builtin_convertvector((column << shift) - own->texel_x, vf);
        const vf n = __builtin_convertvector((row << shift) - own->texel_y, vf);
        vf nearest, farthest, slope_x, slope_y;
        read_cells(level->cells, row * (int32_t)level->columns + column, &nearest, &farthest,
                   &slope_x, &slope_y);
        const vf plane = (own->ref + m * own->step_x) + n * own->step_y;
        const vf more_x = (slope_x - own->step_x) * end, more_y = (slope_y - own->step_y) * end;
        lit &= (nearest - plane) + (vf_min(more_x, zero) + vf_min(more_y, zero)) >= rounding;
        dark &= (farthest - plane) + (vf_max(more_x, zero) + vf_max(more_y, zero)) < -rounding;
    }
    return (plain_outcome){lit, dark};
}
