/* The loops of shading for one instruction set. The including file has chosen the target, included
 * its doubles and the wide types, and defined NARROW, WIDE and SHADE_KERNELS, the name of the
 * table. */

#include <float.h>
#include <stddef.h>

#include "../format.h"
#include "../stages.h"
#include "shade.h"

#define ALWAYS_INLINE __attribute__((always_inline))
#define NEVER_INLINE __attribute__((noinline))

#include "vectors.h"

#include "k_project.inl"

#include "k_lookup.inl"

#include "k_stores.inl"

#include "k_quick.inl"

#include "k_bias.inl"

#include "k_mutual.inl"

#include "k_mutual_triangles.inl"

#include "k_mutual_taps.inl"

#include "k_wide_planes.inl"

#include "k_planes.inl"

#include "k_points.inl"

#include "k_nearest.inl"

#include "k_ways.inl"

#include "k_walks.inl"

#include "k_occluders.inl"

#include "k_filter.inl"

#include "k_plane_boxes.inl"

#include "k_filter_exact.inl"

#include "k_squares.inl"

#include "k_held_taps.inl"

#include "k_scatter.inl"

#include "k_surface.inl"

#include "k_spans.inl"

#include "k_fragments.inl"

#include "k_lambert.inl"

#include "k_pyramid_cells.inl"

#include "k_pyramid.inl"

#include "k_pcss.inl"

const shb_shade_kernels SHADE_KERNELS = {
    .load = load_triples,
    .project = project_batch,
    .normals = turn_normals,
    .fetch = fetch,
    .store = store_texels,
    .hard = hard,
    .planes = ask_planes,
    .place = place_on_triangles,
    .nearest = ask_nearest,
    .ways = go_ways,
    .walk = walk_on,
    .quick = WIDE > 1 ? test_quickly : NULL,
    .find_planes = find_planes,
    .find_world_planes = find_world_planes,
    .pcf = pcf,
    .pcf_smooth = pcf_smooth,
    .jittered = jittered,
    .poisson = poisson,
    .pcf_exact = pcf_exact,
    .pcf_smooth_exact = pcf_smooth_exact,
    .jittered_exact = jittered_exact,
    .poisson_exact = poisson_exact,
    .pcss = pcss_batch,
    .pcss_exact = pcss_exact,
    .bound_cells = bound_cells,
    .join_cells = join_cells,
    .own_depth = own_depth,
    .constant = constant_depth,
    .slope = slope_depth,
    .angle = angle_depth,
    .receiver_plane = receiver_plane_depth,
    .adaptive = adaptive_depth,
    .adaptive_soft = adaptive_soft_depth,
    .normal_offset = normal_offset,
    .normal_offset_depth = normal_offset_depth,
    .texel_cone = texel_cone,
    .take = take_span,
    .triangles = prepare_surfaces,
    .fragments = read_fragments,
    .keep_within = keep_within,
    .lighting = light_fragments,
    .display = display,
    .lambert = shade_lambert,
};
