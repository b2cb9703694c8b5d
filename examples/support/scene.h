/* A scene for examples and tools: geometry, how it looks, where camera and lights stand. */
#ifndef EXAMPLES_SCENE_H
#define EXAMPLES_SCENE_H

#include "owned_mesh.h"

#include "shadowbias/clusters.h"
#include "shadowbias/scene.h"
#include "shadowbias/view.h"

#define SCENE_MESHES_MAX 32
#define SCENE_INSTANCES_MAX 512

typedef enum scene_pattern {
    SCENE_PLAIN = 0,
    SCENE_TILES, /* squares of both colours in the xz plane */
    SCENE_SLOPES /* color where the surface is level, second where it is steep */
} scene_pattern;

/* Linear colours, 0 .. 1. */
typedef struct scene_surface {
    float color[3];
    float second[3];
    scene_pattern pattern;
    float tile_size; /* world units */
    float lowest;    /* of slopes: what lies below this height has the second colour */
} scene_surface;

typedef struct scene_camera {
    shb_vec3 eye, target;
    double vertical_angle; /* radians */
    double near_distance, far_distance;
} scene_camera;

/* A line where an occluder stands on its receiver; arguments as in shb_detachment_desc. */
typedef struct scene_contact {
    shb_vec3 contact, direction, normal;
    double length; /* 0: the scene has none */
} scene_contact;

typedef struct scene_light {
    bool present;
    shb_vec3 source; /* the direction to a directional light, the position of a spot light */
    shb_vec3 target; /* spot only, as the rest of this line: */
    double angle, near_distance, far_distance;
    float color[3];
    scene_contact contact;
} scene_light;

typedef enum scene_light_kind {
    SCENE_DIRECTIONAL = 0,
    SCENE_SPOT,
    SCENE_LIGHT_KINDS
} scene_light_kind;

typedef struct example_scene {
    shb_scene scene; /* what the library draws: the instances below */
    uint64_t triangle_count;
    shb_box bounds;
    scene_camera camera;
    scene_light lights[SCENE_LIGHT_KINDS];
    float background[3];
    float ambient;                               /* of the sky's light, 0 .. 1 */
    uint16_t *instance_of_triangle;              /* by triangle id */
    scene_surface surfaces[SCENE_INSTANCES_MAX]; /* one an instance */
    shb_instance instances[SCENE_INSTANCES_MAX];
    shb_mesh views[SCENE_MESHES_MAX];
    owned_mesh meshes[SCENE_MESHES_MAX];
    shb_clusters *clusters[SCENE_MESHES_MAX]; /* of the views, or NULL */
    size_t mesh_count;
    bool failed; /* out of memory, or of the room above, while building */
} example_scene;

/* The view of one of the scene's lights, for a map of the given size. */
shb_result scene_light_view(const example_scene *scene, scene_light_kind kind, uint32_t map_size,
                            bool reversed, shb_view *view);

shb_result scene_camera_view(const example_scene *scene, uint32_t width, uint32_t height,
                             shb_view *view);

/* Moves the camera; its near and far distances then suit the scene's bounds. */
void scene_move_camera(example_scene *scene, shb_vec3 eye, shb_vec3 target);

/* Prepares the meshes for drawing, all or none; for scenes that are drawn more than once. Before
 * the context is destroyed the clusters must be removed or the scene closed. */
shb_result scene_add_clusters(shb_context *context, example_scene *scene);
void scene_remove_clusters(example_scene *scene);

/* For those who build scenes. */

/* A new empty mesh; never NULL. */
owned_mesh *scene_add_mesh(example_scene *scene);

/* A new empty mesh for a closed solid, with its one instance. */
owned_mesh *scene_add_solid(example_scene *scene, const scene_surface *surface);

/* An instance of a mesh of the scene. transform NULL: none. */
void scene_add_instance(example_scene *scene, const owned_mesh *mesh, const shb_mat4 *transform,
                        shb_cull cull, const scene_surface *surface);

/* A directional light of the colour of the sun. */
void scene_set_sun(example_scene *scene, shb_vec3 to_light);

/* A spot light as bright as the sun. */
void scene_set_spot(example_scene *scene, shb_vec3 position, shb_vec3 target, double angle,
                    double near_distance, double far_distance);

/* Gives every light the contact line at the foot of a box, in the middle of the side that faces
 * away from the light most. The box stands on a level receiver. */
void scene_set_box_contact(example_scene *scene, shb_box box, double length);

#endif
