/* Meshes from files beside the project. */
#include "cases.h"

#define MESH(text)                                                                                 \
    { .group = "mesh", .name = text, .file = "../shared/scenes/" text ".obj" }

static const stability_case cases[] = {
    MESH("bgfx_shadow"),       MESH("bunny_69k"), MESH("bunny_144k"),
    MESH("cornell_box"),       MESH("dx_crypt"),  MESH("dx_island"),
    MESH("dx_shadow_columns"), MESH("house"),     MESH("intel_ivy"),
    MESH("jacksboro_dem"),     MESH("jungle"),    MESH("japanese_temple"),
    MESH("littlest_tokyo"),    MESH("sponza"),
};

stability_cases stability_mesh_cases(void) {
    return (stability_cases){cases, sizeof cases / sizeof *cases};
}
