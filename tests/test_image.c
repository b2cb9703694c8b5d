#include "scratch.h"
#include "test.h"

#include "shadowbias/image.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

static uint8_t pixels[] = {1, 2, 3, 4, 5, 6, 70, 71, 7, 8, 9, 0, 10, 255, 72, 73};

/* Writes pixels of 2 x 2 with this stride, and compares the file. */
static void check_file(const char *name, size_t stride, const char *expected, size_t size) {
    const scratch_path path = scratch_name(name);
    const shb_image image = {pixels, 2, 2, stride};
    char bytes[64];
    CHECK_INT(shb_image_write_ppm(&image, path.text), SHB_OK);
    CHECK_INT(scratch_read(path.text, bytes, sizeof bytes), size);
    CHECK(memcmp(bytes, expected, size) == 0);
    remove(path.text);
}

TEST(ppm_has_a_header_and_rows_from_the_top) {
    const char expected[] = "P6\n2 2\n255\n\1\2\3\4\5\6\106\107\7\10\11\0";
    check_file("rows.ppm", 0, expected, sizeof expected - 1);
}

TEST(ppm_leaves_out_the_padding_of_rows) {
    const char expected[] = "P6\n2 2\n255\n\1\2\3\4\5\6\7\10\11\0\12\377";
    check_file("padding.ppm", 8, expected, sizeof expected - 1);
}

TEST(ppm_refuses_bad_images_and_writes_nothing) {
    const scratch_path path = scratch_name("refused.ppm");
    const shb_image good = {pixels, 2, 2, 0};
    const struct {
        shb_image image;
        shb_result expected;
    } bad[] = {
        {{NULL, 2, 2, 0}, SHB_ERROR_ARGUMENT},
        {{pixels, 0, 2, 0}, SHB_ERROR_SIZE},
        {{pixels, 2, 0, 0}, SHB_ERROR_SIZE},
        {{pixels, 2, 2, 5}, SHB_ERROR_ARGUMENT},
        {{pixels, 2, 3, SIZE_MAX / 3}, SHB_ERROR_SIZE},
    };
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        CHECK_INT(shb_image_write_ppm(&bad[i].image, path.text), bad[i].expected);
    CHECK_INT(shb_image_write_ppm(NULL, path.text), SHB_ERROR_ARGUMENT);
    CHECK_INT(shb_image_write_ppm(&good, NULL), SHB_ERROR_ARGUMENT);
    CHECK(!scratch_exists(path.text));
}

TEST(ppm_reports_a_path_that_cannot_be_opened) {
    const shb_image image = {pixels, 2, 2, 0};
    const scratch_path path = scratch_name("no-such-folder/image.ppm");
    CHECK_INT(shb_image_write_ppm(&image, path.text), SHB_ERROR_FILE);
    CHECK_INT(shb_image_write_ppm(&image, ""), SHB_ERROR_FILE);
}

/* A limit on the size of files stands in for a full disk. */
static shb_result write_with_limit(const shb_image *image, const char *path, rlim_t size) {
    struct rlimit before, tight;
    getrlimit(RLIMIT_FSIZE, &before);
    tight = before;
    tight.rlim_cur = size;
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &tight);
    const shb_result result = shb_image_write_ppm(image, path);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    return result;
}

TEST(ppm_written_in_part_is_removed) {
    const scratch_path path = scratch_name("partial.ppm");
    const shb_image small = {pixels, 2, 2, 0};
    CHECK_INT(write_with_limit(&small, path.text, 23), SHB_OK);
    CHECK(scratch_exists(path.text));
    /* The small image fails when the stream is flushed, the large one while it is written. */
    CHECK_INT(write_with_limit(&small, path.text, 22), SHB_ERROR_FILE);
    CHECK(!scratch_exists(path.text));
    static uint8_t many[300 * 300 * 3];
    const shb_image large = {many, 300, 300, 0};
    CHECK_INT(write_with_limit(&large, path.text, 100000), SHB_ERROR_FILE);
    CHECK(!scratch_exists(path.text));
}

TEST(ppm_leaves_a_full_device_in_place) {
    const shb_image image = {pixels, 2, 2, 0};
    if (!scratch_exists("/dev/full")) {
        test_skip("needs /dev/full");
        return;
    }
    CHECK_INT(shb_image_write_ppm(&image, "/dev/full"), SHB_ERROR_FILE);
    CHECK(scratch_exists("/dev/full"));
}
