/* The point of a triangle that a pixel sees: shared by shading and by the truth, in double. */
#ifndef SRC_SURFACE_H
#define SRC_SURFACE_H

#include "shadowbias/shade.h"

typedef struct shb_surface_triangle {
    uint32_t id;
    shb_vec3 corners[3];   /* world, in mesh order */
    shb_vec3 normal;       /* unit, by winding; zero for a triangle without area */
    shb_vec3 clip[3];      /* the corners' x, y and w */
    shb_vec3 cofactors[3]; /* rows: weight of corner k at ndc (x, y) ~ dot(row k, (x, y, 1)) >= 0 */
    shb_vec3 shading[3];   /* world, not normalised; zero where the mesh has no normals */
} shb_surface_triangle;

/* What the triangles of an instance have in common. */
typedef struct shb_surface_instance {
    const shb_mesh *mesh;
    uint32_t first_id;
    bool mirrors;
    shb_mat4 transform;
    shb_vec3 normal_columns[3]; /* of the matrix that takes normals to the world */
} shb_surface_instance;

/* The instance that a triangle id belongs to; false when the scene has no such id. */
bool shb_surface_find_instance(const shb_scene *scene, uint32_t id, shb_surface_instance *instance);

/* Prepares a triangle of the instance for one camera; false, and nothing is written, when an index
 * is out of range or a corner is not finite. */
bool shb_surface_prepare_of(const shb_surface_instance *instance, const shb_view *camera,
                            uint32_t id, shb_surface_triangle *triangle);

/* The same for any triangle of a scene; false also when the scene has no such id. */
bool shb_surface_prepare(const shb_scene *scene, const shb_view *camera, uint32_t id,
                         shb_surface_triangle *triangle);

/* Barycentric weights of the point under the centre of pixel (column, row), or of the nearest point
 * on the screen if the centre lies outside of the triangle: all >= 0, sum 1. (1, 0, 0) if no corner
 * lies in front of the camera. */
void shb_surface_weights(const shb_surface_triangle *triangle, uint32_t width, uint32_t height,
                         uint32_t column, uint32_t row, double weights[3]);

/* The point of these weights. */
shb_vec3 shb_surface_point(const shb_surface_triangle *triangle, const double weights[3]);

/* The mesh's normal at these weights as a unit vector, turned to the side of the triangle's own;
 * that one where the mesh has none. */
shb_vec3 shb_surface_shading_normal(const shb_surface_triangle *triangle, const double weights[3]);

/* True if the eye of the camera lies on the side that the normal points to. */
bool shb_surface_faces(const shb_surface_triangle *triangle, const shb_light_source *eye);

#endif
