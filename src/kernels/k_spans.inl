/* From rows of a visibility buffer to the pixels of a batch and the triangles that they see. */

/* Bit i % 64: id i, of first .. end - 1 within 64, is none. */
static inline ALWAYS_INLINE uint64_t none_bits(const uint32_t *ids, size_t first, size_t end) {
    const int32_t none = (int32_t)SHB_ID_NONE;
    uint64_t bits = 0;
    size_t i = first;
    for (; i + WIDE <= end; i += WIDE)
        bits |= (uint64_t)vi_bits(vi_load((const int32_t *)ids + i) == none) << i % 64;
    for (; i < end; i++)
        bits |= (uint64_t)(ids[i] == SHB_ID_NONE) << i % 64;
    return bits;
}

/* The same of ids that equal the one before; first > 0. */
static inline ALWAYS_INLINE uint64_t same_bits(const uint32_t *ids, size_t first, size_t end) {
    uint64_t bits = 0;
    size_t i = first;
    for (; i + WIDE <= end; i += WIDE)
        bits |= (uint64_t)vi_bits(vu_load(ids + i) == vu_load(ids + i - 1)) << i % 64;
    for (; i < end; i++)
        bits |= (uint64_t)(ids[i] == ids[i - 1]) << i % 64;
    return bits;
}

/* Of the pixels of a span. */
typedef struct span_marks {
    uint64_t covered[SHB_SPAN_WORDS]; /* those that see something */
    uint64_t starts[SHB_SPAN_WORDS];  /* of them the first, and those that see another triangle than
                                         the pixel before */
} span_marks;

static bool mark_span(const uint32_t *ids, size_t count, span_marks *marks) {
    uint64_t any = 0;
    for (size_t word = 0; word < SHB_SPAN_WORDS; word++) {
        const size_t first = 64 * word, end = count < first + 64 ? count : first + 64;
        const uint64_t all = end > first ? ~(uint64_t)0 >> (64 - (end - first)) : 0;
        marks->covered[word] = all & ~none_bits(ids, first, end);
        any |= marks->covered[word];
    }
    if (!any)
        return false;
    for (size_t word = 0; word < SHB_SPAN_WORDS; word++) {
        const size_t first = 64 * word, end = count < first + 64 ? count : first + 64;
        uint64_t same = 0;
        if (word > 0)
            same = same_bits(ids, first, end);
        else if (count > WIDE)
            same = (uint64_t)vi_bits(vu_load(ids) == vu_load(ids + 1)) << 1 |
                   same_bits(ids, WIDE, end);
        else
            same = same_bits(ids, 1, end);
        marks->starts[word] = marks->covered[word] & ~same;
    }
    return true;
}

/* The place of a triangle in the table of *count ones, where it is or to be prepared. Without a
 * branch for whether it is, which no processor could predict, and without reading what was written
 * for the pixel before, which would wait for it. */
static inline ALWAYS_INLINE uint32_t take_triangle(shb_surface_table *table, uint32_t id,
                                                   uint32_t *count) {
    const size_t at = id % SHB_TABLE_MET;
    const uint32_t held = table->met_places[at], next = *count;
    const uint32_t is_new = table->met_ids[at] != id;
    const uint32_t place = held + ((next - held) & (0 - is_new));
    table->met_ids[at] = id;
    table->met_places[at] = (uint16_t)place;
    table->ids[next] = id;
    *count = next + is_new;
    return place;
}

/* Writes a place for the elements first .. end - 1 of a batch, and for up to SHB_PLACES_MARGIN
 * behind them. */
static inline ALWAYS_INLINE void fill_places(uint32_t *places, size_t first, size_t end,
                                             uint32_t place) {
    for (size_t i = first; i < end; i += SHB_PLACES_MARGIN)
        for (size_t k = 0; k < SHB_PLACES_MARGIN; k++)
            places[i + k] = place;
}

/* Finds the places of neighbouring pixels' triangles, run by run of equal ids; bit i of starts:
 * pixel i begins a run. Those before the first run are of the triangle at place, which becomes that
 * of the last one. */
static inline ALWAYS_INLINE uint32_t take_triangles(shb_surface_table *table, const uint32_t *ids,
                                                    size_t count, uint64_t starts, uint32_t place,
                                                    uint32_t *places) {
    uint32_t triangles = table->count;
    size_t filled = 0;
    for (; starts; starts &= starts - 1) {
        const size_t begin = (size_t)__builtin_ctzll(starts);
        fill_places(places, filled, begin, place);
        place = take_triangle(table, ids[begin], &triangles);
        fill_places(places, begin, begin + 1, place);
        filled = begin + SHB_PLACES_MARGIN;
    }
    fill_places(places, filled, count, place);
    table->count = triangles;
    return place;
}

static void take_span(const uint32_t *ids, const shb_piece *span, shb_surface_table *table,
                      shb_fragment_batch *batch) {
    span_marks marks;
    uint32_t place = 0;
    if (!mark_span(ids, span->count, &marks))
        return;
    for (size_t word = 0; word < SHB_SPAN_WORDS; word++)
        for (uint64_t bits = marks.covered[word]; bits;) {
            const uint64_t behind = bits + (bits & -bits); /* the carry runs through the piece */
            const size_t begin = (size_t)__builtin_ctzll(bits);
            const size_t end = behind ? (size_t)__builtin_ctzll(behind) : 64;
            const size_t count = end - begin, first = 64 * word + begin;
            const uint64_t starts = (marks.starts[word] & (bits ^ behind)) >> begin;
            memcpy(batch->fragments.id + batch->count, ids + first, count * sizeof *ids);
            place = take_triangles(table, ids + first, count, starts, place,
                                   batch->places + batch->count);
            shb_pieces_add(batch, span->row, span->column + (uint32_t)first, (uint32_t)count);
            batch->count += count;
            bits &= behind;
        }
}
