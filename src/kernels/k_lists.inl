/* The loops of building lists and asking them for one instruction set: plain loops over lanes,
 * which the compiler makes vectors of. The including file has chosen the target and defined
 * LIST_KERNELS, the name of the table. */

#include <float.h>
#include <math.h>

#include "../clip.h"
#include "lists.h"
#include "min_max.h"
#include "vectors.h"

#include "kept_lanes.h"
#include "lane_masks.h"

enum { LIST_LANES = SHB_LIST_LANES };

#include "k_list_vertices.inl"

#include "k_list_prepare.inl"

#include "k_list_cover.inl"

#include "k_list_runs.inl"

#include "k_list_ask.inl"

const shb_list_kernels LIST_KERNELS = {see_vertices,    prepare_triangles, cover_cells,
                                       locate_points,   start_runs,        take_entries,
                                       answer_questions};
