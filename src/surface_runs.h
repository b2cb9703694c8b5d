/* The triangles of a row of pixels, one element for each run of neighbouring pixels that see the
 * same one: what surface.h prepares for one triangle, as structure of arrays. */
#ifndef SRC_SURFACE_RUNS_H
#define SRC_SURFACE_RUNS_H

#include "surface.h"

/* Kernels run over whole vectors from any run on, and may write as far behind the last. */
#define SHB_RUNS (SHB_BATCH + 16)

typedef struct shb_surface_runs {
    /* as the mesh holds them: x, y, z of the three corners */
    SHB_ALIGN float positions[9][SHB_RUNS];
    float normals[9][SHB_RUNS]; /* zero where it has none */
    /* the fields of shb_surface_triangle; corners and shading normals as the first one and the ways
     * from it to the other two. The normal points to the camera's side and is never zero. */
    double corners[9][SHB_RUNS];
    double cofactors[9][SHB_RUNS];
    double normal[3][SHB_RUNS];
    double shading[9][SHB_RUNS];
    uint32_t facing[SHB_RUNS];  /* bit k: light k stands on the camera's side of it */
    int32_t prepared[SHB_RUNS]; /* 1, or 0 where the kernels leave it to surface.h: triangles
                                   without area, far out of range or not finite */
    uint32_t ids[SHB_RUNS];
    uint32_t begin[SHB_RUNS], end[SHB_RUNS]; /* pixels of the row */
} shb_surface_runs;

/* What the runs are prepared for: a camera, and at most 32 lights. */
typedef struct shb_run_view {
    const shb_view *camera;
    shb_light_source eye;
    const shb_light_source *lights;
    size_t light_count;
} shb_run_view;

#endif
