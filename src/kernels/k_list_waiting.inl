/* Triangles of a tile that no cells hide so far wait until there is a batch of them. */

/* Triangles after which blocks are looked at anew, and the rest is left if all of them hide it. */
enum { LIST_SPELL = 64 };

/* Triangles that no cells hide so far: where they lie in a tile, in cells, and a bound of their
 * depths. There is room for what vectors write too much. */
enum { LIST_WAITING = LIST_SPELL + 2 * LIST_LANES };
typedef struct list_waiting {
    SHB_ALIGN uint32_t numbers[LIST_WAITING];
    int32_t first_columns[LIST_WAITING], first_rows[LIST_WAITING];
    int32_t columns[LIST_WAITING], rows[LIST_WAITING]; /* behind the first one */
    float nearest[LIST_WAITING];
    size_t count;
} list_waiting;

/* Where WIDE triangles lie in a tile, in cells. */
typedef struct list_places {
    vi first_columns, first_rows, columns, rows; /* behind the first one */
} list_places;

/* The cells of texels, whose numbers are those of the map, on one axis. */
static inline vi cells_on_axis(vi texels, uint32_t tile, int bits) {
    const vi at = texels - (int32_t)tile, last = vi_splat(SHB_LIST_TILE - 1);
    const vi before = at<0, beyond = at> last;
    return ((last & beyond) | (at & ~(before | beyond))) >> bits;
}

static inline list_places places_of(const shb_list_cover *cover, vi numbers) {
    const uint32_t step = sizeof *cover->boxes / sizeof(float);
    const int bits = cover->cell_bits;
    vf words[4];
    vf_read_quads((const float *)(const void *)cover->boxes, (vu)numbers * step, words);
    const vi first = (vi)words[0], last = (vi)words[1];
    const vi left = cells_on_axis(first & 0xffff, cover->column, bits);
    const vi top = cells_on_axis((vi)((vu)first >> 16), cover->row, bits);
    const vi right = cells_on_axis(last & 0xffff, cover->column, bits);
    const vi bottom = cells_on_axis((vi)((vu)last >> 16), cover->row, bits);
    return (list_places){left, top, right - left, bottom - top};
}

/* Triangles that all the cells near them hide, one bit each. */
static inline uint32_t hidden_of(const shb_list_cover *cover, const list_places *places,
                                 vf nearest) {
    const vi blocks = (places->first_rows >> SHB_LIST_BLOCK_BITS) * SHB_LIST_BLOCKS +
                      (places->first_columns >> SHB_LIST_BLOCK_BITS);
    const vi more = (places->columns >= SHB_LIST_BLOCK) | (places->rows >= SHB_LIST_BLOCK);
    const vi hidden = nearest > vf_gather(cover->farthest, blocks);
    uint32_t bits = vi_bits(hidden);
    for (uint32_t larger = vi_bits(hidden & more); larger; larger &= larger - 1) {
        const int lane = __builtin_ctz(larger);
        const list_cells cells =
            cells_between(places->first_columns[lane], places->first_rows[lane],
                          places->columns[lane], places->rows[lane]);
        if (!is_hidden(cover, &cells, nearest[lane]))
            bits &= ~(1u << lane);
    }
    return bits;
}

/* Lets those of up to LIST_LANES triangles from number k on wait that no cells hide. */
static inline void wait_for(const shb_list_cover *cover, bool hides, size_t k,
                            list_waiting *waiting) {
    const size_t count = cover->count - k < LIST_LANES ? cover->count - k : LIST_LANES;
    SHB_ALIGN uint32_t numbers[LIST_LANES];
    SHB_ALIGN float nearest[LIST_LANES];
    uint64_t keys[LIST_LANES];
    for (size_t i = 0; i < LIST_LANES; i++)
        keys[i] = cover->keys[k];
    memcpy(keys, cover->keys + k, count * sizeof *keys);
    for (int i = 0; i < LIST_LANES; i++) {
        numbers[i] = (uint32_t)keys[i];
        nearest[i] = (float)shb_list_level_depth(cover->frame, (double)(int32_t)(keys[i] >> 32));
    }
    for (int i = 0; i < LIST_LANES; i += WIDE) {
        const vi lane_numbers = (vi)vu_load(numbers + i);
        const vf lane_nearest = vf_load(nearest + i);
        const list_places places = places_of(cover, lane_numbers);
        uint32_t kept = vi_bits(vi_numbers() + i < (int32_t)count);
        if (hides)
            kept &= ~hidden_of(cover, &places, lane_nearest);
        const size_t end = waiting->count;
        vi_append((int32_t *)waiting->numbers, end, lane_numbers, kept);
        vi_append((int32_t *)(void *)waiting->nearest, end, (vi)lane_nearest, kept);
        vi_append(waiting->first_columns, end, places.first_columns, kept);
        vi_append(waiting->first_rows, end, places.first_rows, kept);
        vi_append(waiting->columns, end, places.columns, kept);
        vi_append(waiting->rows, end, places.rows, kept);
        waiting->count += (size_t)__builtin_popcount(kept);
    }
}

/* Drops so many that wait; fewer than LIST_LANES stay. */
static inline void drop_waiting(list_waiting *waiting, size_t dropped) {
    const size_t size = LIST_LANES * sizeof *waiting->numbers;
    memmove(waiting->numbers, waiting->numbers + dropped, size);
    memmove(waiting->first_columns, waiting->first_columns + dropped, size);
    memmove(waiting->first_rows, waiting->first_rows + dropped, size);
    memmove(waiting->columns, waiting->columns + dropped, size);
    memmove(waiting->rows, waiting->rows + dropped, size);
    memmove(waiting->nearest, waiting->nearest + dropped, size);
    waiting->count -= dropped;
}

/* Fetches the boxes of the spell that follows this one. */
static inline void fetch_boxes(const shb_list_cover *cover, size_t k) {
    const size_t end = cover->count < k + LIST_SPELL ? cover->count : k + LIST_SPELL;
    for (; k < end; k++)
        __builtin_prefetch(&cover->boxes[(uint32_t)cover->keys[k]]);
}

static inline void fetch_waiting(const shb_list_cover *cover, const list_waiting *waiting,
                                 size_t first) {
    for (; first < waiting->count; first++) {
        __builtin_prefetch(&cover->triangles[waiting->numbers[first]]);
        if (cover->with_sheets)
            __builtin_prefetch(&cover->outlines[waiting->numbers[first]]);
    }
}
