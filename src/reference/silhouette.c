/* Edges are clipped in homogeneous texel coordinates, where the sides of a box of texels are linear
 * along an edge: nothing is divided by a w before it is known to be positive. */
#include "../strict.h"

#include "silhouette.h"

#include <math.h>

shb_texel_rows shb_texel_rows_of(const shb_map_info *map) {
    const double *m = map->view.clip_from_world.m;
    const double half_width = 0.5 * map->width, half_height = 0.5 * map->height;
    shb_texel_rows result;
    for (int column = 0; column < 4; column++) {
        const double x = m[4 * column], y = m[4 * column + 1], w = m[4 * column + 3];
        result.rows[0][column] = half_width * (w + x);
        result.rows[1][column] = half_height * (w - y);
        result.rows[2][column] = w;
    }
    return result;
}

void shb_texel_project(const shb_texel_rows *texel, const double position[3], double out[3]) {
    for (int row = 0; row < 3; row++) {
        const double *r = texel->rows[row];
        out[row] = r[0] * position[0] + r[1] * position[1] + r[2] * position[2] + r[3];
    }
}

/* Where a point lies as the light sees it: a vector from the light, or for a light at infinity one
 * in which differences are all that matters. */
static void seen_from(const shb_light_source *light, const double p[3], double out[3]) {
    out[0] = p[0] - light->w * light->position.x;
    out[1] = p[1] - light->w * light->position.y;
    out[2] = p[2] - light->w * light->position.z;
}

/* The side of the plane through light and edge a b that c is on: 1, -1, or 0 if rounding hides it.
 * A determinant of three differences carries 8 * 2^-53 of the sum of its products' sizes. */
static int side_of_edge(const shb_light_source *light, const double a[3], const double b[3],
                        const double c[3]) {
    double u[3], v[3], w[3];
    seen_from(light, a, u);
    seen_from(light, b, v);
    seen_from(light, c, w);
    if (light->w == 0) {
        for (int i = 0; i < 3; i++) {
            v[i] -= u[i];
            w[i] -= u[i];
        }
        u[0] = light->position.x;
        u[1] = light->position.y;
        u[2] = light->position.z;
    }
    double determinant = 0, size = 0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double left = v[j] * w[k], right = v[k] * w[j];
        determinant += u[i] * (left - right);
        size += fabs(u[i]) * (fabs(left) + fabs(right));
    }
    const double error = 8 * 0x1p-53 * size;
    return determinant > error ? 1 : determinant < -error ? -1 : 0;
}

static const double *corner_of(const shb_triangle *triangles, uint32_t half_edge, uint32_t step) {
    return triangles[half_edge / 3].corners[(half_edge % 3 + step) % 3];
}

/* True unless triangles lie on both sides of the edge. */
static bool is_silhouette(const shb_triangle *triangles, const shb_edges *edges,
                          const shb_light_source *light, uint32_t head) {
    const double *a = corner_of(triangles, head, 0), *b = corner_of(triangles, head, 1);
    bool left = false, right = false;
    for (uint32_t h = head; h != SHB_ID_NONE; h = edges->next[h]) {
        const int side = side_of_edge(light, a, b, corner_of(triangles, h, 2));
        left |= side > 0;
        right |= side < 0;
    }
    return !(left && right);
}

/* Narrows begin .. end to where a linear function that is f at 0 and g at 1 is not negative. */
static void keep_positive(double f, double g, double *begin, double *end) {
    const double zero = f / (f - g);
    if (f < 0)
        *begin = g < 0 ? 2 : zero > *begin ? zero : *begin;
    else if (g < 0)
        *end = zero < *end ? zero : *end;
}

/* The four sides together leave only what has w >= 0. */
bool shb_silhouette_clip(const shb_silhouette_edge *edge, const shb_texel_box *box, double *begin,
                         double *end) {
    const double *a = edge->texel[0], *b = edge->texel[1];
    *begin = 0;
    *end = 1;
    keep_positive(a[0] - box->left * a[2], b[0] - box->left * b[2], begin, end);
    keep_positive(box->right * a[2] - a[0], box->right * b[2] - b[0], begin, end);
    keep_positive(a[1] - box->top * a[2], b[1] - box->top * b[2], begin, end);
    keep_positive(box->bottom * a[2] - a[1], box->bottom * b[2] - b[1], begin, end);
    return *begin <= *end;
}

static shb_silhouette_edge project_edge(const shb_texel_rows *texel, const double *a,
                                        const double *b) {
    shb_silhouette_edge edge = {{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}}, {{0}}, 0};
    for (int k = 0; k < 2; k++) {
        shb_texel_project(texel, edge.world[k], edge.texel[k]);
        for (int i = 0; i < 3; i++)
            edge.reach = fabs(edge.world[k][i]) > edge.reach ? fabs(edge.world[k][i]) : edge.reach;
    }
    return edge;
}

/* What decides about an edge. */
typedef struct collector {
    const shb_triangle *triangles;
    const shb_edges *edges;
    const shb_light_source *light;
    shb_texel_rows texel;
    shb_texel_box box;
} collector;

/* True if the edge is a silhouette in the box; its projection is written then. */
static bool collect_edge(const collector *c, uint32_t number, shb_silhouette_edge *edge) {
    const uint32_t head = c->edges->heads[number];
    *edge =
        project_edge(&c->texel, corner_of(c->triangles, head, 0), corner_of(c->triangles, head, 1));
    double begin, end;
    return shb_silhouette_clip(edge, &c->box, &begin, &end) &&
           is_silhouette(c->triangles, c->edges, c->light, head);
}

shb_silhouette_edge *shb_silhouette_collect(const shb_context *context,
                                            const shb_triangle *triangles, const shb_edges *edges,
                                            const shb_map_info *map, double margin, size_t *count) {
    const collector c = {triangles,
                         edges,
                         &map->light,
                         shb_texel_rows_of(map),
                         {-margin, map->width + margin, -margin, map->height + margin}};
    shb_silhouette_edge edge;
    size_t found = 0;
    for (uint32_t i = 0; i < edges->count; i++)
        found += collect_edge(&c, i, &edge);
    shb_silhouette_edge *list = shb_alloc(context, found, sizeof *list);
    if (!list)
        return NULL;
    *count = 0;
    for (uint32_t i = 0; i < edges->count && *count < found; i++)
        if (collect_edge(&c, i, &edge))
            list[(*count)++] = edge;
    return list;
}
