/* Views of lights whose points and rays are of all kinds, around a scene of any size. */
#ifndef TESTS_SUPPORT_ODD_VIEWS_H
#define TESTS_SUPPORT_ODD_VIEWS_H

#include "shadowbias/view.h"

enum { ODD_VIEWS = 6 };

/* Parallel light straight above (0) and aside, reversed (1), both as far as far_distance; spots
 * straight above (2), aside, reversed and without a far plane (3), and amid the scene, part of
 * which lies behind it (4); parallel light that is much deeper than wide (5). The scene reaches
 * size to each side of its center. */
shb_result odd_view(int kind, shb_vec3 center, double size, double far_distance, shb_view *view);

#endif
