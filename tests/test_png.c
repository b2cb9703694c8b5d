/* PNG files, read back by a decoder of their own: the tables of RFC 1951 and the filters of the PNG
 * specification, written out. */
#include "deflate.h"
#include "png.h"

#include "random.h"
#include "test.h"

#include <stdlib.h>
#include <string.h>

typedef struct bit_reader {
    const uint8_t *data;
    size_t size, place; /* place: in bits */
} bit_reader;

static unsigned get_bits(bit_reader *reader, unsigned count) {
    unsigned value = 0;
    for (unsigned i = 0; i < count; i++, reader->place++)
        if (reader->place / 8 < reader->size)
            value |= (unsigned)(reader->data[reader->place / 8] >> reader->place % 8 & 1) << i;
    return value;
}

static unsigned get_code(bit_reader *reader, unsigned count) {
    unsigned value = 0;
    for (unsigned i = 0; i < count; i++)
        value = value << 1 | get_bits(reader, 1);
    return value;
}

/* The fixed codes: 7 bits up to 0010111, 8 bits up to 11000111, then 9 bits. */
static unsigned get_symbol(bit_reader *reader) {
    unsigned code = get_code(reader, 7);
    if (code <= 23)
        return 256 + code;
    code = code << 1 | get_bits(reader, 1);
    if (code <= 191)
        return code - 48;
    if (code <= 199)
        return 280 + code - 192;
    return 144 + (code << 1 | get_bits(reader, 1)) - 400;
}

static unsigned get_length(bit_reader *reader, unsigned symbol) {
    static const unsigned base[29] = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                      15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                      67, 83, 99, 115, 131, 163, 195, 227, 258};
    static const unsigned extra[29] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                       2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
    return base[symbol - 257] + get_bits(reader, extra[symbol - 257]);
}

static unsigned get_distance(bit_reader *reader) {
    static const unsigned base[30] = {
        1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
        193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
    static const unsigned extra[30] = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                       6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};
    const unsigned code = get_code(reader, 5);
    return code < 30 ? base[code] + get_bits(reader, extra[code]) : 0;
}

/* Reads a zlib stream of one fixed block; the number of bytes, or SIZE_MAX if it is not right. */
static size_t inflate(const uint8_t *data, size_t size, uint8_t *out, size_t room) {
    bit_reader reader = {data, size, 16};
    size_t count = 0;
    if (size < 6 || (data[0] * 256 + data[1]) % 31 || (data[0] & 15) != 8)
        return SIZE_MAX;
    if (get_bits(&reader, 1) != 1 || get_bits(&reader, 2) != 1)
        return SIZE_MAX;
    for (unsigned symbol; reader.place < 8 * size && (symbol = get_symbol(&reader)) != 256;) {
        unsigned length = 1, distance = 0;
        if (symbol > 256) {
            length = get_length(&reader, symbol);
            distance = get_distance(&reader);
            if (distance == 0 || distance > count)
                return SIZE_MAX;
        }
        for (unsigned i = 0; i < length && count < room; i++, count++)
            out[count] = symbol < 256 ? (uint8_t)symbol : out[count - distance];
    }
    reader.place = (reader.place + 7) / 8 * 8;
    const uint32_t sum = get_bits(&reader, 8) << 24 | get_bits(&reader, 8) << 16 |
                         get_bits(&reader, 8) << 8 | get_bits(&reader, 8);
    const bool right = reader.place == 8 * size && sum == deflate_adler32(out, count);
    return right ? count : SIZE_MAX;
}

static void check_round_trip(const uint8_t *data, size_t size, size_t most) {
    bytes stream = {0};
    uint8_t *read = malloc(size + 1);
    deflate_zlib(data, size, &stream);
    if (CHECK(read && !stream.failed)) {
        CHECK_INT(inflate(stream.data, stream.size, read, size + 1), size);
        CHECK(memcmp(read, data, size) == 0);
        CHECK(stream.size <= most);
    }
    bytes_free(&stream);
    free(read);
}

/* CRC-32 of the usual check string and of an empty last chunk, Adler-32 of "Wikipedia": published
 * values. */
TEST(checksums_have_their_published_values) {
    CHECK_INT(png_crc32((const uint8_t *)"123456789", 9), 0xCBF43926);
    CHECK_INT(png_crc32((const uint8_t *)"IEND", 4), 0xAE426082);
    CHECK_INT(deflate_adler32((const uint8_t *)"Wikipedia", 9), 0x11E60398);
    CHECK_INT(deflate_adler32(NULL, 0), 1);
}

/* One grey pixel 0x80 behind the filter byte 0. Bits of the block, in order: 1 (last), 1 0 (fixed
 * codes), 00110000 (literal 0), 10110000 (literal 128), 0000000 (end), which are the bytes 63 68 00
 * 00. Sums of Adler: 1 + 0 + 128 = 0x81 and 1 + 129 = 0x82. */
TEST(one_grey_pixel_makes_the_file_that_was_worked_out_by_hand) {
    static const uint8_t expected[] = {
        0x89, 'P',  'N',  'G',  '\r', '\n', 0x1A, '\n', 0,    0,    0,    13,   'I',  'H',
        'D',  'R',  0,    0,    0,    1,    0,    0,    0,    1,    8,    0,    0,    0,
        0,    0x3A, 0x7E, 0x9B, 0x55, 0,    0,    0,    10,   'I',  'D',  'A',  'T',  0x78,
        0x01, 0x63, 0x68, 0,    0,    0,    0x82, 0,    0x81, 0x4C, 0x17, 0xD7, 0xDF, 0,
        0,    0,    0,    'I',  'E',  'N',  'D',  0xAE, 0x42, 0x60, 0x82};
    const uint8_t pixel = 0x80;
    bytes file = {0};
    CHECK(png_encode(&(png_image){&pixel, 1, 1, 0, PNG_GREY}, &file));
    CHECK_INT(file.size, sizeof expected);
    CHECK(file.size == sizeof expected && memcmp(file.data, expected, sizeof expected) == 0);
    bytes_free(&file);
}

/* 100,000 equal bytes are 388 repetitions of 258 at 13 bits each, some 630 bytes. */
TEST(equal_bytes_become_repetitions) {
    static uint8_t data[100000];
    check_round_trip(data, sizeof data, 650);
    check_round_trip(data, 0, 8);
    check_round_trip(data, 1, 9);
}

/* Nothing repeats: literals take 8 or 9 bits, and a few chance repetitions less. */
TEST(noise_comes_back_as_it_was) {
    static uint8_t data[70000];
    test_random random = {1};
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)random_bits(&random);
    check_round_trip(data, sizeof data, sizeof data * 9 / 8 + 8);
}

/* A block of noise again after every distance, each in its own group of distances, and each length
 * of a repetition. */
TEST(repetitions_of_every_length_and_distance_come_back) {
    static uint8_t data[80000];
    test_random random = {2};
    for (size_t distance = 300; distance < 32768; distance = distance * 5 / 4 + 1) {
        for (size_t i = 0; i < sizeof data; i++)
            data[i] = i < distance ? (uint8_t)random_bits(&random) : data[i - distance];
        check_round_trip(data, sizeof data, distance * 9 / 8 + 1000);
    }
    size_t size = 0;
    for (size_t length = 3; length <= 260; length++)
        for (size_t i = 0; i < length + 1; i++)
            data[size++] = i < length ? (uint8_t)(i * 7 % 256) : (uint8_t)random_bits(&random);
    check_round_trip(data, size, 4000);
}

/* Undoes the filter of a row. */
static void unfilter(uint8_t filter, uint8_t *row, const uint8_t *above, size_t size, size_t step) {
    for (size_t i = 0; i < size; i++) {
        const int a = i >= step ? row[i - step] : 0, b = above[i],
                  c = i >= step ? above[i - step] : 0;
        const int p = a + b - c, pa = abs(p - a), pb = abs(p - b), pc = abs(p - c);
        const int paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
        const int taken[5] = {0, a, b, (a + b) / 2, paeth};
        row[i] = (uint8_t)(row[i] + taken[filter]);
    }
}

/* Decodes the image that a file holds into rows without gaps. */
static void decode(const bytes *file, size_t row_size, uint32_t height, size_t step,
                   uint8_t *rows) {
    enum { DATA = 8 + 25 + 8 }; /* behind signature, header and the head of the data */
    const uint8_t zeros[64] = {0};
    const size_t size = (size_t)file->data[35] << 8 | file->data[36];
    uint8_t raw[4096];
    if (!CHECK(inflate(file->data + DATA, size, raw, sizeof raw) == (row_size + 1) * height))
        return;
    for (uint32_t y = 0; y < height; y++) {
        memcpy(rows + y * row_size, raw + y * (row_size + 1) + 1, row_size);
        unfilter(raw[y * (row_size + 1)], rows + y * row_size,
                 y ? rows + (y - 1) * row_size : zeros, row_size, step);
    }
}

/* Rows that suit each of the filters: noise, a ramp to the right, a copy of the row above, a sum of
 * both; with a gap behind each row. */
TEST(pictures_come_back_through_every_filter) {
    enum { WIDTH = 20, HEIGHT = 16, STRIDE = 3 * WIDTH + 5 };
    uint8_t pixels[HEIGHT * STRIDE], rows[HEIGHT * 3 * WIDTH];
    test_random random = {3};
    for (size_t y = 0; y < HEIGHT; y++)
        for (size_t i = 0; i < STRIDE; i++) {
            const uint8_t noise = (uint8_t)random_bits(&random);
            const uint8_t above = y ? pixels[(y - 1) * STRIDE + i] : 0;
            const uint8_t choices[4] = {noise, (uint8_t)(100 + 3 * i), above,
                                        (uint8_t)(above + 2 * (i / 3))};
            pixels[y * STRIDE + i] = choices[y % 4];
        }
    bytes file = {0};
    CHECK(png_encode(&(png_image){pixels, WIDTH, HEIGHT, STRIDE, PNG_RGB}, &file));
    decode(&file, 3 * WIDTH, HEIGHT, 3, rows);
    for (size_t y = 0; y < HEIGHT; y++)
        CHECK(memcmp(rows + y * 3 * WIDTH, pixels + y * STRIDE, 3 * WIDTH) == 0);
    bytes_free(&file);
}

/* Ten pixels, every third one white: bits 1001 0010 01, the rest of the last byte 0. */
TEST(two_colours_take_a_bit_a_pixel) {
    const uint8_t pixels[10] = {255, 0, 0, 1, 0, 0, 7, 0, 0, 255};
    uint8_t row[2];
    bytes file = {0};
    CHECK(png_encode(&(png_image){pixels, 10, 1, 0, PNG_BITS}, &file));
    decode(&file, 2, 1, 1, row);
    CHECK_INT(row[0], 0x92);
    CHECK_INT(row[1], 0x40);
    CHECK_INT(file.data[24], 1); /* bits a sample */
    bytes_free(&file);
}

TEST(pictures_without_pixels_are_refused) {
    const uint8_t pixel = 0;
    bytes file = {0};
    CHECK(!png_encode(&(png_image){NULL, 1, 1, 0, PNG_GREY}, &file));
    CHECK(!png_encode(&(png_image){&pixel, 0, 1, 0, PNG_GREY}, &file));
    CHECK(!png_encode(&(png_image){&pixel, 1, 0, 0, PNG_GREY}, &file));
    CHECK(!png_write(&(png_image){&pixel, 1, 1, 0, PNG_GREY}, "no/such/directory/image.png"));
    bytes_free(&file);
}
