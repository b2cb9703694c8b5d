/* Bitmask soft shadows: Schwarz and Stamminger 2007. Samples of the light are bits, and quads clear
 * those that they cover: what two quads cover counts once.
 *
 * The samples are Hammersley's: the one of number k of count lies at ((k + 0.5) / count, (r + 0.5)
 * / count), r being k with its bits in reverse order. No two share a column or a row, and each cell
 * of a grid of 8 x 8 (16 x 16) holds one of 64 (256). What lies left of a line is then the first
 * bits, and what lies above one is looked up. */
#include "strict.h"

#include "backprojection.h"
#include "method_text.h"

enum { SAMPLES = SHB_PARAM_WINDOW + 1 };

enum { SAMPLES_MAX = 256, WORDS_MAX = SAMPLES_MAX / 64 };

typedef struct sample_set {
    uint64_t words[WORDS_MAX];
} sample_set;

typedef struct light_samples {
    int count, words;
    sample_set above[SAMPLES_MAX + 1]; /* the samples of the first rows */
} light_samples;

static int reversed_bits(int number, int count) {
    int reversed = 0;
    for (int bit = 1; bit < count; bit *= 2)
        reversed = reversed * 2 + (number & bit ? 1 : 0);
    return reversed;
}

static void place_samples(int count, light_samples *samples) {
    samples->count = count;
    samples->words = count / 64;
    samples->above[0] = (sample_set){{0}};
    for (int row = 0; row < count; row++) {
        const int number = reversed_bits(row, count);
        samples->above[row + 1] = samples->above[row];
        samples->above[row + 1].words[number / 64] |= (uint64_t)1 << number % 64;
    }
}

/* The first count bits of word number of a set. */
static inline uint64_t first_bits(int32_t count, int word) {
    const int32_t here = count - 64 * word;
    return here >= 64 ? ~(uint64_t)0 : here > 0 ? ((uint64_t)1 << here) - 1 : 0;
}

static void cover(const light_samples *samples, const shb_quad_row *row, int32_t i,
                  sample_set *covered) {
    const uint64_t *begin = samples->above[row->y0[i]].words;
    const uint64_t *end = samples->above[row->y1[i]].words;
    for (int word = 0; word < samples->words; word++) {
        const uint64_t columns = first_bits(row->x1[i], word) & ~first_bits(row->x0[i], word);
        covered->words[word] |= columns & end[word] & ~begin[word];
    }
}

static float visible_part(const shb_filter_args *args, const shb_light_windows *windows,
                          const light_samples *samples, size_t index) {
    shb_quad_window window;
    shb_quad_row row;
    sample_set covered = {{0}};
    if (!shb_quad_window_open(args, windows, index, &window))
        return 1;
    for (int32_t y = 0; y < window.rows; y++) {
        if (!shb_quad_window_read(&window, y, (float)samples->count, &row))
            continue;
        for (int32_t i = 0; i < window.columns; i++)
            cover(samples, &row, i, &covered);
    }
    int visible = samples->count;
    for (int word = 0; word < samples->words; word++)
        visible -= __builtin_popcountll(covered.words[word]);
    return (float)visible / (float)samples->count;
}

static void bitmask(const shb_filter_args *args) {
    light_samples samples;
    shb_light_windows windows;
    shb_quad_windows_find(args, &windows);
    place_samples((int)args->filter->params[SAMPLES], &samples);
    for (size_t i = 0; i < args->count; i++)
        args->visibility[i] = visible_part(args, &windows, &samples, i);
}

static shb_result prepare(const shb_map *map, const shb_filter *filter, void **prepared,
                          size_t *bytes) {
    const float samples = filter->params[SAMPLES];
    if (samples != 64 && samples != SAMPLES_MAX)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT,
                        "shb_map_prepare: samples %g of the filter \"%s\" is not 64 or %d",
                        (double)samples, shb_method_name(filter->name), SAMPLES_MAX);
    return shb_backprojection_prepare(map, filter, prepared, bytes);
}

shb_filter shb_filter_bitmask(float light_size, int window, int samples) {
    return (shb_filter){.name = "bitmask",
                        .filter = bitmask,
                        .prepare = prepare,
                        .release = shb_backprojection_release,
                        .needs = SHB_NEEDS_PREPARED,
                        .params = {light_size, (float)window, (float)samples}};
}
