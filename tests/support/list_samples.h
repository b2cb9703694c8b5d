/* Points of a scene that are asked of lists and of the truth. */
#ifndef TESTS_SUPPORT_LIST_SAMPLES_H
#define TESTS_SUPPORT_LIST_SAMPLES_H

#include "../../src/lists.h"
#include "oracle.h"
#include "random.h"
#include "shadowbias/reference.h"
#include "soup.h"

shb_context *lists_context(uint32_t threads);

typedef struct lists_light {
    bool is_spot;
    shb_vec3 source; /* direction, or position in units of the box about its centre */
} lists_light;

extern const lists_light lists_slanted, lists_grazing, lists_spot;

/* Of the light, for a box and a map of this size. */
shb_view lists_view(const lists_light *l, shb_box box, uint32_t size, bool reversed);

/* Plain lists of size by size texels. */
shb_lists_desc lists_desc(const shb_view *view, uint32_t size, const shb_scene *scene);

/* The lists of a square map. */
shb_lists *lists_of(shb_context *context, const shb_view *view, uint32_t size,
                    const shb_scene *scene);

/* One point without a bound of rounding. */
void lists_ask_one(const shb_lists *lists, double x, double y, double z, float *visibility);

/* Points on triangles of a scene, exact but for double rounding. */
typedef struct list_samples {
    size_t count;
    double *x, *y, *z;
    shb_vec3 *points;
    uint32_t *own_ids;
    uint8_t *occluded;
    float *visibility;
} list_samples;

list_samples list_samples_create(const shb_scene *scene, size_t count, uint64_t seed);
void list_samples_free(list_samples *s);

/* Coordinates as floats would hold them. */
void list_samples_to_float(list_samples *s);

/* Writes the visibility. */
void list_samples_ask(const shb_lists *lists, list_samples *s, bool with_ids, double rounding);

/* Writes what is occluded. */
void list_samples_find_truth(const shb_reference *reference, const shb_view *view, list_samples *s);

/* Points whose visibility differs from the truth, and all that are occluded. */
size_t list_samples_false_shadow(const list_samples *s);
size_t list_samples_false_light(const list_samples *s);
size_t list_samples_occluded(const list_samples *s);

/* A triangle of about this size with its centre in -1 .. 1. */
void soup_add_random(soup *s, test_random *random, double size);

#endif
