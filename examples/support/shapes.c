#include "shapes.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;

static uint32_t add_vertex(owned_mesh *mesh, shb_vec3 position, shb_vec3 normal) {
    const float p[3] = {(float)position.x, (float)position.y, (float)position.z};
    const float n[3] = {(float)normal.x, (float)normal.y, (float)normal.z};
    return owned_mesh_add_vertex(mesh, p, n);
}

/* The normal of a triangle, of twice its area's length. */
static shb_vec3 area_normal(shb_vec3 a, shb_vec3 b, shb_vec3 c) {
    return shb_vec3_cross(shb_vec3_subtract(b, a), shb_vec3_subtract(c, a));
}

static void add_flat_triangle(owned_mesh *mesh, shb_vec3 a, shb_vec3 b, shb_vec3 c) {
    const shb_vec3 normal = shb_vec3_normalize(area_normal(a, b, c));
    const uint32_t first = add_vertex(mesh, a, normal);
    add_vertex(mesh, b, normal);
    add_vertex(mesh, c, normal);
    owned_mesh_add_triangle(mesh, first, first + 1, first + 2);
}

void shape_quad(owned_mesh *mesh, shb_vec3 a, shb_vec3 b, shb_vec3 c, shb_vec3 d) {
    const shb_vec3 normal = shb_vec3_normalize(area_normal(a, b, c));
    const uint32_t first = add_vertex(mesh, a, normal);
    add_vertex(mesh, b, normal);
    add_vertex(mesh, c, normal);
    add_vertex(mesh, d, normal);
    owned_mesh_add_triangle(mesh, first, first + 1, first + 2);
    owned_mesh_add_triangle(mesh, first, first + 2, first + 3);
}

void shape_box(owned_mesh *mesh, shb_vec3 lo, shb_vec3 hi) {
    const shb_vec3 c[8] = {{lo.x, lo.y, lo.z}, {hi.x, lo.y, lo.z}, {lo.x, hi.y, lo.z},
                           {hi.x, hi.y, lo.z}, {lo.x, lo.y, hi.z}, {hi.x, lo.y, hi.z},
                           {lo.x, hi.y, hi.z}, {hi.x, hi.y, hi.z}};
    shape_quad(mesh, c[0], c[4], c[6], c[2]);
    shape_quad(mesh, c[1], c[3], c[7], c[5]);
    shape_quad(mesh, c[0], c[1], c[5], c[4]);
    shape_quad(mesh, c[2], c[6], c[7], c[3]);
    shape_quad(mesh, c[0], c[2], c[3], c[1]);
    shape_quad(mesh, c[4], c[5], c[7], c[6]);
}

/* The unit normal of a profile's segment, outwards for a profile that runs up. */
static shape_point segment_normal(const shape_point *segment) {
    const double x = segment[1].y - segment[0].y, y = segment[0].x - segment[1].x;
    const double length = sqrt(x * x + y * y);
    return (shape_point){x / length, y / length};
}

/* The normal of a segment at an end that it shares with a neighbour. */
static shape_point bend_normal(shape_point own, shape_point neighbour) {
    if (own.x * neighbour.x + own.y * neighbour.y < cos(40 * pi / 180))
        return own;
    const double x = own.x + neighbour.x, y = own.y + neighbour.y;
    const double length = sqrt(x * x + y * y);
    return (shape_point){x / length, y / length};
}

static void add_ring(owned_mesh *mesh, shb_vec3 center, shape_point point, shape_point normal,
                     uint32_t segments) {
    for (uint32_t i = 0; i < segments; i++) {
        const double c = cos(2 * pi * i / segments), s = -sin(2 * pi * i / segments);
        add_vertex(mesh,
                   (shb_vec3){center.x + point.x * c, center.y + point.y, center.z + point.x * s},
                   (shb_vec3){normal.x * c, normal.y, normal.x * s});
    }
}

void shape_lathe(owned_mesh *mesh, shb_vec3 center, const shape_point *profile, size_t count,
                 uint32_t segments) {
    for (size_t k = 0; k + 1 < count; k++) {
        const shape_point own = segment_normal(&profile[k]);
        const shape_point below = k ? segment_normal(&profile[k - 1]) : own;
        const shape_point above = k + 2 < count ? segment_normal(&profile[k + 1]) : own;
        const uint32_t lower = mesh->vertex_count, upper = lower + segments;
        add_ring(mesh, center, profile[k], bend_normal(own, below), segments);
        add_ring(mesh, center, profile[k + 1], bend_normal(own, above), segments);
        for (uint32_t i = 0; i < segments; i++) {
            const uint32_t next = (i + 1) % segments;
            if (profile[k].x > 0)
                owned_mesh_add_triangle(mesh, lower + i, lower + next, upper + next);
            if (profile[k + 1].x > 0)
                owned_mesh_add_triangle(mesh, lower + i, upper + next, upper + i);
        }
    }
}

void shape_ball(owned_mesh *mesh, shb_vec3 center, double radius, uint32_t segments) {
    shape_point profile[65];
    const uint32_t rings = segments / 2;
    for (uint32_t i = 0; i <= rings; i++)
        profile[i] = (shape_point){radius * sin(pi * i / rings), -radius * cos(pi * i / rings)};
    profile[0].x = profile[rings].x = 0;
    shape_lathe(mesh, center, profile, rings + 1, segments);
}

void shape_prism(owned_mesh *mesh, const shape_point *outline, size_t count, double back,
                 double front) {
    for (size_t i = 0; i < count; i++) {
        const shape_point a = outline[i], b = outline[(i + 1) % count];
        shape_quad(mesh, (shb_vec3){a.x, a.y, front}, (shb_vec3){a.x, a.y, back},
                   (shb_vec3){b.x, b.y, back}, (shb_vec3){b.x, b.y, front});
    }
    const shape_point hub = outline[0];
    for (size_t i = 1; i + 1 < count; i++) {
        const shape_point a = outline[i], b = outline[i + 1];
        add_flat_triangle(mesh, (shb_vec3){hub.x, hub.y, front}, (shb_vec3){a.x, a.y, front},
                          (shb_vec3){b.x, b.y, front});
        add_flat_triangle(mesh, (shb_vec3){hub.x, hub.y, back}, (shb_vec3){b.x, b.y, back},
                          (shb_vec3){a.x, a.y, back});
    }
}

/* The vertical end of a wall at one of its points. */
static void add_wall_end(owned_mesh *mesh, shape_point p, double top, double left, double right) {
    shape_quad(mesh, (shb_vec3){p.x, p.y, left}, (shb_vec3){p.x, p.y, right},
               (shb_vec3){p.x, top, right}, (shb_vec3){p.x, top, left});
}

void shape_wall(owned_mesh *mesh, const shape_point *lower, size_t count, double top, double back,
                double front) {
    for (size_t i = 0; i + 1 < count; i++) {
        const shape_point a = lower[i], b = lower[i + 1];
        const shb_vec3 c[8] = {{a.x, a.y, back},  {b.x, b.y, back},  {b.x, top, back},
                               {a.x, top, back},  {a.x, a.y, front}, {b.x, b.y, front},
                               {b.x, top, front}, {a.x, top, front}};
        shape_quad(mesh, c[4], c[5], c[6], c[7]);
        shape_quad(mesh, c[1], c[0], c[3], c[2]);
        shape_quad(mesh, c[0], c[1], c[5], c[4]);
        shape_quad(mesh, c[7], c[6], c[2], c[3]);
    }
    add_wall_end(mesh, lower[0], top, back, front);
    add_wall_end(mesh, lower[count - 1], top, front, back);
}

static void add_grid_triangle(owned_mesh *mesh, const shb_vec3 *points, shb_vec3 *normals,
                              uint32_t first, const uint32_t corners[3]) {
    const shb_vec3 a = points[corners[0]], b = points[corners[1]], c = points[corners[2]];
    const shb_vec3 normal = area_normal(a, b, c);
    if (shb_vec3_length(normal) == 0)
        return;
    for (int i = 0; i < 3; i++)
        normals[corners[i]] = shb_vec3_add(normals[corners[i]], normal);
    owned_mesh_add_triangle(mesh, first + corners[0], first + corners[1], first + corners[2]);
}

void shape_grid(owned_mesh *mesh, const shb_vec3 *points, uint32_t columns, uint32_t rows,
                bool closed) {
    const uint32_t count = columns * rows, first = mesh->vertex_count;
    shb_vec3 *normals = calloc(count, sizeof *normals);
    if (!normals) {
        mesh->failed = true;
        return;
    }
    for (uint32_t row = 0; row + 1 < rows; row++)
        for (uint32_t column = 0; column + !closed < columns; column++) {
            const uint32_t next = (column + 1) % columns, low = row * columns, high = low + columns;
            const uint32_t lower[3] = {low + column, low + next, high + next};
            const uint32_t upper[3] = {low + column, high + next, high + column};
            add_grid_triangle(mesh, points, normals, first, lower);
            add_grid_triangle(mesh, points, normals, first, upper);
        }
    for (uint32_t i = 0; i < count; i++)
        add_vertex(mesh, points[i], shb_vec3_normalize(normals[i]));
    free(normals);
}
