#include "architecture.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

void architecture_column(owned_mesh *mesh, shb_vec3 base, double radius, double height,
                         uint32_t segments) {
    const double foot = 1.45 * radius, head = 1.40 * radius;
    const double low = 0.45 * radius, high = height - 0.35 * radius;
    shape_box(mesh, (shb_vec3){base.x - foot, base.y, base.z - foot},
              (shb_vec3){base.x + foot, base.y + low, base.z + foot});
    /* base mouldings, a slightly swollen shaft, neck ring and bell of the capital */
    const shape_point profile[] = {{0, low},
                                   {1.36 * radius, low},
                                   {1.40 * radius, low + 0.12 * radius},
                                   {1.34 * radius, low + 0.24 * radius},
                                   {1.14 * radius, low + 0.30 * radius},
                                   {1.12 * radius, low + 0.42 * radius},
                                   {1.20 * radius, low + 0.50 * radius},
                                   {1.18 * radius, low + 0.62 * radius},
                                   {1.00 * radius, low + 0.68 * radius},
                                   {1.00 * radius, low + 0.40 * (high - low)},
                                   {0.86 * radius, high - 1.10 * radius},
                                   {0.96 * radius, high - 1.04 * radius},
                                   {0.96 * radius, high - 0.92 * radius},
                                   {0.86 * radius, high - 0.86 * radius},
                                   {0.92 * radius, high - 0.50 * radius},
                                   {1.12 * radius, high - 0.18 * radius},
                                   {1.34 * radius, high},
                                   {0, high}};
    shape_lathe(mesh, base, profile, sizeof profile / sizeof *profile, segments);
    shape_box(mesh, (shb_vec3){base.x - head, base.y + high, base.z - head},
              (shb_vec3){base.x + head, base.y + height, base.z + head});
}

void architecture_arcade(owned_mesh *mesh, const arcade_shape *arcade) {
    shape_point edge[16 * 25 + 2];
    size_t count = 0;
    const double start = -0.5 * arcade->bays * arcade->bay;
    const double radius = 0.5 * (arcade->bay - arcade->pillar);
    if (arcade->pillar > 0)
        edge[count++] = (shape_point){start, arcade->spring};
    for (uint32_t bay = 0; bay < arcade->bays; bay++) {
        const double middle = start + (bay + 0.5) * arcade->bay;
        for (uint32_t i = 0; i <= arcade->steps; i++)
            edge[count++] = (shape_point){middle - radius * cos(pi * i / arcade->steps),
                                          arcade->spring + radius * sin(pi * i / arcade->steps)};
    }
    if (arcade->pillar > 0)
        edge[count++] = (shape_point){-start, arcade->spring};
    shape_wall(mesh, edge, count, arcade->top, arcade->back, arcade->front);
}
