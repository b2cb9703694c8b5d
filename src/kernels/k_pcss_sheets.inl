/* Pcss where a map keeps planes: sheets are found for a whole batch between its searches and its
 * filters. */

/* Words with a bit for each tap on the disk. */
#define TAP_WORDS (SHB_POISSON_MAX / 32)

/* What the searches of a batch found where a map keeps planes. */
typedef struct pcss_found {
    SHB_ALIGN int32_t open[SHB_BATCH];    /* -1: there are blockers */
    float weight[SHB_BATCH];              /* of blockers */
    float depth[SHB_BATCH];               /* their sum */
    int32_t sides[SHB_BATCH];             /* of the square that holds the search */
    uint32_t taps[SHB_BATCH * TAP_WORDS]; /* on the disk that have a blocker, a bit each */
} pcss_found;

/* Searches of a batch where a map keeps planes, and the answers where there are no blockers. Lists
 * fragments with blockers that stand on what their own texels hold. */
static size_t search_batch(const shb_pcss *pcss, size_t count, mutual_batch *mutual,
                           pcss_found *found, uint16_t *fragments, float *visibility) {
    const shb_receivers *receivers = &mutual->receivers;
    const vi most = vi_splat(SHEET_MOST);
    own_texel texels[SHB_BATCH + 1];
    size_t listed = 0;
    int pause = 0;
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE) {
        pcss_lanes own;
        load_pcss_lanes(pcss, receivers, i, mutual, &own);
        own.taps = pcss->blockers ? found->taps + i * TAP_WORDS : NULL;
        pcss_open open = open_lanes(pcss, mutual->map, &own, &pause);
        vf_store(visibility + i, open.visibility);
        if (vi_any(open.lanes)) {
            for (int k = 0; k < pcss->blockers; k += 32)
                vu_store(word_of_tap(own.taps, k), (vu){0});
            take_open(pcss, receivers, open.lanes, &own);
            const pcss_blocked blockers =
                search(pcss, mutual->map, &own, open.search_x, open.search_y, open.lanes);
            open.lanes &= blockers.weight > 0;
            vf_store(found->weight + i, blockers.weight);
            vf_store(found->depth + i, blockers.depth);
            const vi reach = reach_of(vf_max(open.search_x, open.search_y)), less = reach < most;
            vi_store(found->sides + i, (reach & less) | (most & ~less));
            listed = list_lit_by_own(mutual, i, open.lanes, fragments, texels, listed);
        }
        vi_store(found->open + i, open.lanes);
    }
    return listed > 0 ? keep_on_own(mutual, texels, fragments, listed) : 0;
}

/* Of fragments whose search found blockers. */
static vf filter_on_sheets(const shb_pcss *pcss, size_t i, mutual_batch *mutual, pcss_found *found,
                           const kept_sheets *sheets, vf visibility) {
    const shb_map *map = mutual->map;
    const vf near_depth = vf_splat(pcss->near_depth);
    pcss_lanes own;
    pcss_blocked blockers = {vf_load(found->weight + i), vf_load(found->depth + i), vf_splat(0)};
    vi open = vi_load(found->open + i);
    load_pcss_lanes(pcss, &mutual->receivers, i, mutual, &own);
    take_open(pcss, &mutual->receivers, open, &own);
    if (have_sheets(sheets, i)) {
        const vf search_x = radius_lanes(pcss->texels_x, own.depth, near_depth);
        const vf search_y = radius_lanes(pcss->texels_y, own.depth, near_depth);
        own.sheets = sheets;
        blockers = pcss->blockers ? leave_sheets(pcss, map, &own, found->taps + i * TAP_WORDS,
                                                 search_x, search_y)
                                  : search(pcss, map, &own, search_x, search_y, open);
        open &= blockers.weight > 0;
    }
    return vf_where(open, lit_by_blockers(pcss, map, &own, &blockers, open), visibility);
}

/* Sheets are found for a whole batch at once. */
static void ask_pcss_on_sheets(const shb_pcss *pcss, size_t count, mutual_batch *mutual,
                               float *visibility) {
    pcss_found found;
    kept_sheets sheets;
    uint16_t fragments[SHB_BATCH + 1];
    const size_t listed = search_batch(pcss, count, mutual, &found, fragments, visibility);
    find_kept_sheets(mutual, fragments, listed, found.sides, &sheets);
    for (size_t i = 0; i < shb_round_to_lanes(count); i += WIDE)
        if (vi_any(vi_load(found.open + i)))
            vf_store(visibility + i,
                     filter_on_sheets(pcss, i, mutual, &found, &sheets, vf_load(visibility + i)));
}
