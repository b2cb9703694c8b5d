#include "deflate.h"

#include <stdlib.h>

enum {
    HASH_BITS = 15,
    WINDOW = 32768,
    SHORTEST = 3,
    LONGEST = 258,
    TRIES = 32, /* earlier places that are compared */
    END_OF_BLOCK = 256
};

/* Bits go into bytes from the lowest on. */
typedef struct bit_writer {
    bytes *out;
    uint32_t bits;
    unsigned count;
} bit_writer;

/* Where the same three bytes stood before: positions plus 1, 0 for none. */
typedef struct history {
    size_t newest[1 << HASH_BITS];
    size_t older[WINDOW]; /* by position modulo the window */
} history;

typedef struct repetition {
    size_t length, distance; /* length 0: none */
} repetition;

static void put_bits(bit_writer *writer, uint32_t value, unsigned count) {
    writer->bits |= value << writer->count;
    writer->count += count;
    while (writer->count >= 8) {
        bytes_append_byte(writer->out, (uint8_t)writer->bits);
        writer->bits >>= 8;
        writer->count -= 8;
    }
}

/* Huffman codes, other than numbers, begin with their highest bit. */
static void put_code(bit_writer *writer, uint32_t code, unsigned count) {
    uint32_t turned = 0;
    for (unsigned i = 0; i < count; i++)
        turned |= (code >> i & 1) << (count - 1 - i);
    put_bits(writer, turned, count);
}

/* The fixed code of a literal, a length symbol or the end. */
static void put_symbol(bit_writer *writer, unsigned symbol) {
    if (symbol < 144)
        put_code(writer, 0x30 + symbol, 8);
    else if (symbol < 256)
        put_code(writer, 0x190 + symbol - 144, 9);
    else if (symbol < 280)
        put_code(writer, symbol - 256, 7);
    else
        put_code(writer, 0xC0 + symbol - 280, 8);
}

/* Lengths and distances come in groups that double in width every fourth (second) group: the number
 * of the group, then the place inside it. from_zero counts from the smallest; per_width is the
 * number of groups of one width. */
static unsigned group_of(size_t from_zero, unsigned per_width, unsigned *extra_bits) {
    unsigned extra = 0;
    while (from_zero >> extra >= 2 * per_width)
        extra++;
    *extra_bits = extra;
    return (unsigned)(from_zero >> extra) + extra * per_width;
}

static void put_repetition(bit_writer *writer, repetition found) {
    unsigned extra;
    if (found.length == LONGEST)
        put_symbol(writer, 285);
    else {
        const size_t length = found.length - SHORTEST;
        put_symbol(writer, 257 + group_of(length, 4, &extra));
        put_bits(writer, (uint32_t)(length & ((1u << extra) - 1)), extra);
    }
    const size_t distance = found.distance - 1;
    put_code(writer, group_of(distance, 2, &extra), 5);
    put_bits(writer, (uint32_t)(distance & ((1u << extra) - 1)), extra);
}

static unsigned hash_of(const uint8_t *data) {
    const uint32_t three = data[0] | (uint32_t)data[1] << 8 | (uint32_t)data[2] << 16;
    return three * 2654435761u >> (32 - HASH_BITS);
}

static void remember(history *known, const uint8_t *data, size_t size, size_t position) {
    if (position + SHORTEST > size)
        return;
    size_t *newest = &known->newest[hash_of(data + position)];
    known->older[position % WINDOW] = *newest;
    *newest = position + 1;
}

static size_t common_length(const uint8_t *a, const uint8_t *b, size_t limit) {
    size_t length = 0;
    while (length < limit && a[length] == b[length])
        length++;
    return length;
}

/* The longest earlier run of the bytes at position. */
static repetition find_repetition(const history *known, const uint8_t *data, size_t size,
                                  size_t position) {
    repetition best = {0, 0};
    if (position + SHORTEST > size)
        return best;
    const size_t limit = size - position < LONGEST ? size - position : LONGEST;
    size_t place = known->newest[hash_of(data + position)];
    for (int i = 0; i < TRIES && place && position - (place - 1) <= WINDOW - 1; i++) {
        const size_t length = common_length(data + place - 1, data + position, limit);
        if (length >= SHORTEST && length > best.length)
            best = (repetition){length, position - (place - 1)};
        place = known->older[(place - 1) % WINDOW];
    }
    return best;
}

static void put_block(bit_writer *writer, history *known, const uint8_t *data, size_t size) {
    put_bits(writer, 1, 1); /* the last block */
    put_bits(writer, 1, 2); /* of fixed codes */
    for (size_t position = 0; position < size;) {
        const repetition found = find_repetition(known, data, size, position);
        if (found.length)
            put_repetition(writer, found);
        else
            put_symbol(writer, data[position]);
        for (const size_t end = position + (found.length ? found.length : 1); position < end;)
            remember(known, data, size, position++);
    }
    put_symbol(writer, END_OF_BLOCK);
    put_bits(writer, 0, 7); /* the last byte is filled up */
}

uint32_t deflate_adler32(const uint8_t *data, size_t size) {
    uint32_t sum = 1, sum_of_sums = 0;
    for (size_t i = 0; i < size; i++) {
        sum = (sum + data[i]) % 65521;
        sum_of_sums = (sum_of_sums + sum) % 65521;
    }
    return sum_of_sums << 16 | sum;
}

void deflate_zlib(const uint8_t *data, size_t size, bytes *out) {
    static const uint8_t header[2] = {0x78, 0x01}; /* a window of 32 KB; 0x7801 = 31 * 991 */
    history *known = calloc(1, sizeof *known);
    if (!known) {
        out->failed = true;
        return;
    }
    bytes_append(out, header, sizeof header);
    bit_writer writer = {.out = out};
    put_block(&writer, known, data, size);
    bytes_append_big_endian(out, deflate_adler32(data, size));
    free(known);
}
