#include "obj.h"

#include "decimal.h"
#include "text_file.h"
#include "text_scanner.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Two passes over the text: vertices first, so that a face may name one that follows it. */
typedef struct obj_reader {
    text_scanner scanner;
    const char *name;
    char *error;
    size_t error_size;
    float *positions, *normals;
    uint32_t position_count, normal_count, texture_count; /* all of the file */
    uint32_t position_seen, normal_seen, texture_seen; /* above the statement, in the second pass */
    uint32_t *corner_positions, *corner_normals;       /* three a triangle */
    uint32_t triangle_count, triangle_capacity;
    bool has_normals; /* every corner so far names one */
} obj_reader;

typedef struct obj_corner {
    uint32_t position, normal;
    bool has_normal;
} obj_corner;

static bool fail(obj_reader *reader, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool fail(obj_reader *reader, const char *format, ...) {
    char sentence[128];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    snprintf(reader->error, reader->error_size, "%s:%u: %s", reader->name, reader->scanner.line,
             sentence);
    return false;
}

/* Fails with the token at a place, quoted. */
static bool fail_at(obj_reader *reader, const char *start, const char *problem) {
    const int length = text_token_length(&reader->scanner, start);
    if (length == 0)
        return fail(reader, "a value is missing");
    return fail(reader, "\"%.*s\" %s", length, start, problem);
}

static bool at_token_end(const text_scanner *scanner) {
    const char c = *scanner->at;
    return c == ' ' || c == '\t' || c == '\\' || text_at_statement_end(scanner);
}

static bool read_number(obj_reader *reader, float *value) {
    text_scanner *scanner = &reader->scanner;
    text_skip_blanks(scanner);
    const char *start = scanner->at;
    if (!decimal_read_float(&scanner->at, value) || !at_token_end(scanner))
        return fail_at(reader, start, "is not a number");
    return isfinite(*value) || fail_at(reader, start, "is too large for a float");
}

/* Reads three numbers and checks up to extra more, which are skipped: weight, colour. */
static bool read_vector(obj_reader *reader, uint32_t extra, float *vector) {
    for (int i = 0; i < 3; i++)
        if (!read_number(reader, &vector[i]))
            return false;
    for (text_skip_blanks(&reader->scanner); !text_at_statement_end(&reader->scanner); extra--) {
        float ignored;
        if (extra == 0)
            return fail(reader, "too many numbers");
        if (!read_number(reader, &ignored))
            return false;
        text_skip_blanks(&reader->scanner);
    }
    return true;
}

/* Makes room for one more vector when the count is a power of two. */
static bool reserve_vector(obj_reader *reader, float **vectors, uint32_t count) {
    if (count & (count - 1))
        return true;
    if (count > UINT32_MAX / 2)
        return fail(reader, "too many vertices");
    float *grown = realloc(*vectors, (count ? 2 * (size_t)count : 1) * 3 * sizeof(float));
    if (!grown)
        return fail(reader, "out of memory");
    *vectors = grown;
    return true;
}

static bool read_vertex_statement(obj_reader *reader) {
    if (text_take_keyword(&reader->scanner, "v"))
        return reserve_vector(reader, &reader->positions, reader->position_count) &&
               read_vector(reader, 4, reader->positions + 3 * (size_t)reader->position_count++);
    if (text_take_keyword(&reader->scanner, "vn"))
        return reserve_vector(reader, &reader->normals, reader->normal_count) &&
               read_vector(reader, 0, reader->normals + 3 * (size_t)reader->normal_count++);
    if (text_take_keyword(&reader->scanner, "vt") && reader->texture_count++ == UINT32_MAX)
        return fail(reader, "too many texture coordinates");
    return true;
}

/* Reads one number of a face corner: 1 is the first of count, -1 the last of those seen above. */
static bool read_index(obj_reader *reader, const char *kind, uint32_t seen, uint32_t count,
                       uint32_t *index) {
    text_scanner *scanner = &reader->scanner;
    const char *start = scanner->at;
    const bool negative = *scanner->at == '-';
    scanner->at += negative;
    const char *digits = scanner->at;
    uint64_t value = 0;
    for (; *scanner->at >= '0' && *scanner->at <= '9'; scanner->at++)
        if (value <= UINT32_MAX)
            value = 10 * value + (uint64_t)(*scanner->at - '0');
    if (scanner->at == digits)
        return fail_at(reader, start, "is not an index");
    const uint32_t last = negative ? seen : count;
    if (value == 0 || value > last)
        return fail(reader, "%s %.*s is not one of the %u there are", kind,
                    (int)(scanner->at - start < 40 ? scanner->at - start : 40), start, last);
    *index = negative ? seen - (uint32_t)value : (uint32_t)value - 1;
    return true;
}

/* v, v/vt, v//vn or v/vt/vn. */
static bool read_corner(obj_reader *reader, obj_corner *corner) {
    text_scanner *scanner = &reader->scanner;
    const char *start = scanner->at;
    *corner = (obj_corner){0};
    if (!read_index(reader, "position", reader->position_seen, reader->position_count,
                    &corner->position))
        return false;
    uint32_t texture;
    if (*scanner->at == '/') {
        scanner->at++;
        if (*scanner->at != '/' && !read_index(reader, "texture coordinate", reader->texture_seen,
                                               reader->texture_count, &texture))
            return false;
    }
    if (*scanner->at == '/') {
        scanner->at++;
        corner->has_normal = true;
        if (!read_index(reader, "normal", reader->normal_seen, reader->normal_count,
                        &corner->normal))
            return false;
    }
    return at_token_end(scanner) || fail_at(reader, start, "is not a face corner");
}

static bool reserve_triangle(obj_reader *reader) {
    if (reader->triangle_count < reader->triangle_capacity)
        return true;
    if (reader->triangle_count > SHB_TRIANGLES_MAX / 2)
        return fail(reader, "too many triangles");
    const uint32_t capacity = reader->triangle_count ? 2 * reader->triangle_count : 64;
    const size_t bytes = capacity * 3 * sizeof(uint32_t);
    uint32_t *positions = realloc(reader->corner_positions, bytes);
    if (positions)
        reader->corner_positions = positions;
    uint32_t *normals = realloc(reader->corner_normals, bytes);
    if (normals)
        reader->corner_normals = normals;
    if (!positions || !normals)
        return fail(reader, "out of memory");
    reader->triangle_capacity = capacity;
    return true;
}

static bool add_triangle(obj_reader *reader, const obj_corner corners[3]) {
    if (!reserve_triangle(reader))
        return false;
    const size_t first = 3 * (size_t)reader->triangle_count++;
    for (size_t i = 0; i < 3; i++) {
        reader->corner_positions[first + i] = corners[i].position;
        reader->corner_normals[first + i] = corners[i].normal;
        reader->has_normals &= corners[i].has_normal;
    }
    return true;
}

static bool read_face(obj_reader *reader) {
    obj_corner corners[3]; /* the first, the previous and this one */
    uint32_t count = 0;
    for (;;) {
        text_skip_blanks(&reader->scanner);
        if (text_at_statement_end(&reader->scanner))
            return count >= 3 || fail(reader, "a face has %u corners, it needs 3", count);
        const uint32_t slot = count < 2 ? count : 2;
        if (!read_corner(reader, &corners[slot]))
            return false;
        if (slot == 2) {
            if (!add_triangle(reader, corners))
                return false;
            corners[1] = corners[2];
        }
        count += count < 3;
    }
}

static bool read_face_statement(obj_reader *reader) {
    reader->position_seen += text_take_keyword(&reader->scanner, "v");
    reader->normal_seen += text_take_keyword(&reader->scanner, "vn");
    reader->texture_seen += text_take_keyword(&reader->scanner, "vt");
    return !text_take_keyword(&reader->scanner, "f") || read_face(reader);
}

static bool for_each_statement(obj_reader *reader, const char *text,
                               bool (*read)(obj_reader *reader)) {
    reader->scanner.at = text;
    reader->scanner.line = 1;
    while (reader->scanner.at < reader->scanner.end) {
        text_skip_blanks(&reader->scanner);
        if (!read(reader))
            return false;
        text_skip_statement(&reader->scanner);
    }
    return true;
}

/* A vertex for each (position, normal) pair in use. The vertices of a position form a list. */
typedef struct vertex_splitter {
    uint32_t *first; /* of each position: a vertex, or none */
    uint32_t *next;  /* of each vertex: another one of the same position, or none */
    uint32_t *normal;
} vertex_splitter;

static const uint32_t no_vertex = UINT32_MAX;

static uint32_t split_vertex(const obj_reader *reader, vertex_splitter *splitter, size_t corner,
                             owned_mesh *mesh) {
    const uint32_t position = reader->corner_positions[corner];
    const uint32_t normal = reader->corner_normals[corner];
    for (uint32_t vertex = splitter->first[position]; vertex != no_vertex;
         vertex = splitter->next[vertex])
        if (splitter->normal[vertex] == normal)
            return vertex;
    const uint32_t vertex = owned_mesh_add_vertex(mesh, reader->positions + 3 * (size_t)position,
                                                  reader->normals + 3 * (size_t)normal);
    if (mesh->failed)
        return 0;
    splitter->normal[vertex] = normal;
    splitter->next[vertex] = splitter->first[position];
    splitter->first[position] = vertex;
    return vertex;
}

static bool build_split_mesh(obj_reader *reader, owned_mesh *mesh) {
    const size_t corner_count = 3 * (size_t)reader->triangle_count;
    uint32_t *memory = malloc((reader->position_count + 2 * corner_count) * sizeof(uint32_t));
    if (!memory)
        return fail(reader, "out of memory");
    vertex_splitter splitter = {memory, memory + reader->position_count,
                                memory + reader->position_count + corner_count};
    memset(splitter.first, 0xff, reader->position_count * sizeof(uint32_t));
    for (size_t corner = 0; corner < corner_count && !mesh->failed; corner += 3) {
        uint32_t vertices[3];
        for (size_t i = 0; i < 3; i++)
            vertices[i] = split_vertex(reader, &splitter, corner + i, mesh);
        owned_mesh_add_triangle(mesh, vertices[0], vertices[1], vertices[2]);
    }
    free(memory);
    return !mesh->failed || fail(reader, "out of memory");
}

/* Hands the arrays of the reader over to the mesh. */
static void build_welded_mesh(obj_reader *reader, owned_mesh *mesh) {
    *mesh = (owned_mesh){.positions = reader->positions,
                         .indices = reader->corner_positions,
                         .vertex_count = reader->position_count,
                         .triangle_count = reader->triangle_count,
                         .vertex_capacity = reader->position_count,
                         .triangle_capacity = reader->triangle_capacity};
    reader->positions = NULL;
    reader->corner_positions = NULL;
}

static bool build_mesh(obj_reader *reader, owned_mesh *mesh) {
    if (!reader->triangle_count)
        return fail(reader, "the file has no faces");
    owned_mesh built = {0};
    if (!reader->has_normals) {
        build_welded_mesh(reader, &built);
    } else if (!build_split_mesh(reader, &built)) {
        owned_mesh_free(&built);
        return false;
    }
    *mesh = built;
    return true;
}

bool obj_read_text(const char *text, size_t length, const char *name, owned_mesh *mesh, char *error,
                   size_t error_size) {
    obj_reader reader = {.scanner.end = text + length,
                         .name = name,
                         .error = error,
                         .error_size = error_size,
                         .has_normals = true};
    const bool done = for_each_statement(&reader, text, read_vertex_statement) &&
                      for_each_statement(&reader, text, read_face_statement) &&
                      build_mesh(&reader, mesh);
    free(reader.positions);
    free(reader.normals);
    free(reader.corner_positions);
    free(reader.corner_normals);
    return done;
}

bool obj_read_file(const char *path, owned_mesh *mesh, char *error, size_t error_size) {
    size_t length;
    char *text = text_file_read(path, &length, error, error_size);
    const bool done = text && obj_read_text(text, length, path, mesh, error, error_size);
    free(text);
    return done;
}
