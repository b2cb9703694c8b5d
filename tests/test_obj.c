#include "obj.h"

#include "decimal.h"
#include "random.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char error[256];

static bool read_text(const char *text, owned_mesh *mesh) {
    error[0] = 0;
    return obj_read_text(text, strlen(text), "t.obj", mesh, error, sizeof error);
}

static void check_indices(const owned_mesh *mesh, uint32_t triangle_count,
                          const uint32_t *expected) {
    CHECK_INT(mesh->triangle_count, triangle_count);
    if (mesh->triangle_count == triangle_count)
        for (uint32_t i = 0; i < 3 * triangle_count; i++)
            CHECK_INT(mesh->indices[i], expected[i]);
}

/* Reading must fail with exactly this sentence and leave the mesh alone. */
static void check_error(const char *text, const char *sentence) {
    owned_mesh mesh = {.vertex_count = 77};
    CHECK(!read_text(text, &mesh));
    test_check(strcmp(error, sentence) == 0, __FILE__, __LINE__, "\"%s\", expected \"%s\"", error,
               sentence);
    CHECK(mesh.vertex_count == 77 && !mesh.positions);
}

#define FOUR_VERTICES "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

TEST(obj_reads_positions_and_a_triangle) {
    owned_mesh mesh = {0};
    CHECK(read_text("v 1 -2.5 3e2\nv .5 +4. 1E-2\nv 0 0 -0\nf 1 2 3\n", &mesh));
    const float expected[] = {1, -2.5f, 300, 0.5f, 4, 0.01f, 0, 0, 0};
    CHECK_INT(mesh.vertex_count, 3);
    for (int i = 0; i < 9; i++)
        CHECK(mesh.positions[i] == expected[i]);
    CHECK(signbit(mesh.positions[8]));
    CHECK(!mesh.normals);
    check_indices(&mesh, 1, (uint32_t[]){0, 1, 2});
    owned_mesh_free(&mesh);
}

TEST(obj_face_of_many_corners_becomes_a_fan) {
    owned_mesh mesh = {0};
    CHECK(read_text(FOUR_VERTICES "v -1 1 0\nf 2 3 4 5 1\n", &mesh));
    check_indices(&mesh, 3, (uint32_t[]){1, 2, 3, 1, 3, 4, 1, 4, 0});
    owned_mesh_free(&mesh);
}

TEST(obj_reads_every_form_of_a_corner) {
    owned_mesh mesh = {0};
    CHECK(read_text(FOUR_VERTICES "vt 0 0\nvn 0 0 1\nf 1 2/1 3//1\nf 4/1/1 3 2\n", &mesh));
    check_indices(&mesh, 2, (uint32_t[]){0, 1, 2, 3, 2, 1});
    CHECK(!mesh.normals);
    owned_mesh_free(&mesh);
}

TEST(obj_negative_index_counts_back_from_the_statement) {
    owned_mesh mesh = {0};
    CHECK(read_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf -3 -2 -1\nv 0 1 0\nf -1 -3 1\n", &mesh));
    check_indices(&mesh, 2, (uint32_t[]){0, 1, 2, 3, 1, 0});
    owned_mesh_free(&mesh);
}

TEST(obj_negative_normal_index_counts_normals) {
    owned_mesh mesh = {0};
    CHECK(read_text("vn 1 0 0\n" FOUR_VERTICES "vn 0 1 0\nf 1//-1 2//-1 3//-2\nvn 0 0 1\n", &mesh));
    const float expected[] = {0, 1, 0, 0, 1, 0, 1, 0, 0};
    for (int i = 0; i < 9; i++)
        CHECK(mesh.normals && mesh.normals[i] == expected[i]);
    owned_mesh_free(&mesh);
}

TEST(obj_face_may_name_vertices_further_down) {
    owned_mesh mesh = {0};
    CHECK(read_text("f 1 2 3\n" FOUR_VERTICES, &mesh));
    check_indices(&mesh, 1, (uint32_t[]){0, 1, 2});
    owned_mesh_free(&mesh);
}

TEST(obj_splits_vertices_by_normal_and_shares_equal_pairs) {
    owned_mesh mesh = {0};
    CHECK(
        read_text(FOUR_VERTICES "vn 0 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//2 3//1 4//2\n", &mesh));
    /* pairs in order of use: (1,1) (2,1) (3,1) (1,2) (4,2) */
    CHECK_INT(mesh.vertex_count, 5);
    check_indices(&mesh, 2, (uint32_t[]){0, 1, 2, 3, 2, 4});
    const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 1, 0};
    const float normals[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0};
    for (int i = 0; i < 15 && mesh.vertex_count == 5; i++) {
        CHECK(mesh.positions[i] == positions[i]);
        CHECK(mesh.normals[i] == normals[i]);
    }
    owned_mesh_free(&mesh);
}

TEST(obj_accepts_comments_blank_lines_tabs_and_other_statements) {
    owned_mesh mesh = {0};
    CHECK(read_text("# made by hand \\\n\tv 0\t0 0 # origin\n\nmtllib a b.mtl\no part\n"
                    "v 1 0 0 1.0\n  v 1 1 0 0.5 0.5 0.5\ns off\ng\nusemtl x\nvp 1 2\n"
                    "vt 0 0 0\n\nf\t1 2\t3 # face",
                    &mesh));
    CHECK_INT(mesh.vertex_count, 3);
    check_indices(&mesh, 1, (uint32_t[]){0, 1, 2});
    owned_mesh_free(&mesh);
}

TEST(obj_accepts_all_line_ends_and_continued_lines) {
    owned_mesh mesh = {0};
    CHECK(read_text("v 0 0 0\r\nv 1\\\r\n0 \\\n 0\rv 1 1 0\r\ng a \\\r\nv 9 9 9\r\nf 1 \\\n2 3\r\n",
                    &mesh));
    CHECK_INT(mesh.vertex_count, 3);
    CHECK(mesh.positions[3] == 1 && mesh.positions[4] == 0 && mesh.positions[7] == 1);
    check_indices(&mesh, 1, (uint32_t[]){0, 1, 2});
    owned_mesh_free(&mesh);
}

TEST(obj_error_names_file_line_and_value) {
    check_error("v 0 0\n", "t.obj:1: a value is missing");
    check_error("# x\nv 0 0 zero\n", "t.obj:2: \"zero\" is not a number");
    check_error("v 0 0 1.5.2\n", "t.obj:1: \"1.5.2\" is not a number");
    check_error("v 0 0 nan\n", "t.obj:1: \"nan\" is not a number");
    check_error("v 0 0 inf\n", "t.obj:1: \"inf\" is not a number");
    check_error("v 0 0 0x10\n", "t.obj:1: \"0x10\" is not a number");
    check_error("v 0 0 1e\n", "t.obj:1: \"1e\" is not a number");
    check_error("v 0 0 3.5e38\n", "t.obj:1: \"3.5e38\" is too large for a float");
    check_error("v 0 0 -1e999999999999\n", "t.obj:1: \"-1e999999999999\" is too large for a float");
    check_error("v 0 0 0 0 0 0 0 0\n", "t.obj:1: too many numbers");
    check_error("vn 0 0 1 0\n", "t.obj:1: too many numbers");
    check_error("\r\n\\\r\nv 1 2 x\r\n", "t.obj:3: \"x\" is not a number");
}

TEST(obj_error_for_bad_faces) {
    check_error(FOUR_VERTICES "f 1 2\n", "t.obj:5: a face has 2 corners, it needs 3");
    check_error(FOUR_VERTICES "f\n", "t.obj:5: a face has 0 corners, it needs 3");
    check_error(FOUR_VERTICES "f 1 2 0\n", "t.obj:5: position 0 is not one of the 4 there are");
    check_error(FOUR_VERTICES "f 1 2 5\n", "t.obj:5: position 5 is not one of the 4 there are");
    check_error(FOUR_VERTICES "f 1 2 -5\n", "t.obj:5: position -5 is not one of the 4 there are");
    check_error(FOUR_VERTICES "f 1 2 4294967297\n",
                "t.obj:5: position 4294967297 is not one of the 4 there are");
    check_error(FOUR_VERTICES "f 1 2 18446744073709551617\n",
                "t.obj:5: position 18446744073709551617 is not one of the 4 there are");
    check_error("v 0 0 0\nf -1 -1 -2\nv 0 0 0\n",
                "t.obj:2: position -2 is not one of the 1 there are");
    check_error(FOUR_VERTICES "f 1//1 2//1 3//1\n",
                "t.obj:5: normal 1 is not one of the 0 there are");
    check_error(FOUR_VERTICES "f 1/1 2/1 3/1\n",
                "t.obj:5: texture coordinate 1 is not one of the 0 there are");
    check_error(FOUR_VERTICES "f 1 2 3x\n", "t.obj:5: \"3x\" is not a face corner");
    check_error(FOUR_VERTICES "f 1 2 a\n", "t.obj:5: \"a\" is not an index");
    check_error(FOUR_VERTICES "vt 0\nf 1 2 3/1/ 4\n", "t.obj:6: a value is missing");
    check_error(FOUR_VERTICES, "t.obj:5: the file has no faces");
    check_error("", "t.obj:1: the file has no faces");
}

TEST(obj_error_for_missing_file_names_it) {
    owned_mesh mesh = {0};
    CHECK(!obj_read_file("tests/no such file.obj", &mesh, error, sizeof error));
    CHECK(strstr(error, "tests/no such file.obj: ") == error);
}

/* Any bytes must give a mesh or an error: run with the sanitizers. */
TEST(obj_survives_random_text) {
    static const char *const pieces[] = {
        "v ", "vn ",       "vt ",           "f ",        "1", "-1", "/", "//", " ",
        "\n", "\r\n",      "\\\n",          "#",         ".", "e",  "9", "-",  "\\",
        "\t", "v 1 2 3\n", "f 1 2 1//-1\n", "vn 0 1 0\n"};
    test_random random = {7};
    unsigned meshes = 0;
    for (int round = 0; round < 20000; round++) {
        char text[256] = "v 0 0 0\nv 1 0 0\n";
        for (uint32_t left = random_below(&random, 12); left; left--)
            strcat(text, pieces[random_below(&random, sizeof pieces / sizeof *pieces)]);
        const size_t length = random_below(&random, (uint32_t)strlen(text) + 1);
        text[length] = 0;
        owned_mesh mesh = {0};
        if (obj_read_text(text, length, "random", &mesh, error, sizeof error)) {
            meshes++;
            for (uint32_t i = 0; i < 3 * mesh.triangle_count; i++)
                CHECK(mesh.indices[i] < mesh.vertex_count);
        }
        owned_mesh_free(&mesh);
    }
    CHECK(meshes > 0);
}

/* The C library's strtof is correctly rounded. */
static void check_decimal(const char *text) {
    const char *at = text;
    float value;
    CHECK(decimal_read_float(&at, &value));
    CHECK(*at == 0);
    const float expected = strtof(text, NULL);
    test_check(memcmp(&value, &expected, sizeof value) == 0, __FILE__, __LINE__,
               "%s gives %.9g, expected %.9g", text, (double)value, (double)expected);
}

TEST(decimal_agrees_with_strtof) {
    test_random random = {1};
    for (int i = 0; i < 100000; i++) {
        char text[64];
        const uint32_t bits = random_bits(&random) & 0x7f7fffff;
        float value;
        memcpy(&value, &bits, sizeof value);
        snprintf(text, sizeof text, "%.*g", (int)(1 + random_below(&random, 20)), (double)value);
        check_decimal(text);
        snprintf(text, sizeof text, "%.*f", (int)random_below(&random, 12),
                 random_double(&random, -2000, 2000));
        check_decimal(text);
    }
}

/* Decimals close to the middle between two floats, where rounding twice would go wrong. */
TEST(decimal_rounds_once) {
    test_random random = {2};
    for (int i = 0; i < 100000; i++) {
        const double ulp = 0x1p-23, low = 1 + ulp * random_below(&random, 1 << 23);
        char text[64];
        snprintf(text, sizeof text, "%.*f", (int)(13 + random_below(&random, 4)), low + ulp / 2);
        check_decimal(text);
    }
    check_decimal("8388608.5");
    check_decimal("8388609.5");
    check_decimal("16777217.000000000000000000000000000000000000000000000001");
    check_decimal("16777217");
    check_decimal("3.4028235677973366e38");
    check_decimal("3.4028235677973365e38");
    check_decimal("1.1754943e-38");
    check_decimal("1e-45");
    check_decimal("7e-46");
    check_decimal("0.000000000000000000000000000000000000000000000000001e51");
    check_decimal("100000000000000000000000000000000000000000000000000e-50");
    check_decimal("-0");
    check_decimal("-0.0e5");
}
