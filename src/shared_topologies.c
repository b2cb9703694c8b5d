#include "strict.h"

#include "shared_topologies.h"

typedef struct shb_shared_topology {
    shb_topology topology;
    size_t users;
    struct shb_shared_topology *next;
} shared_topology;

static bool join_used(shb_context *context, uint64_t key, uint64_t triangle_count,
                      shb_topology *topology) {
    pthread_mutex_lock(&context->topology_mutex);
    shared_topology *found = context->topologies;
    while (found &&
           (found->topology.key != key || found->topology.triangle_count != triangle_count))
        found = found->next;
    if (found) {
        found->users++;
        *topology = found->topology;
    }
    pthread_mutex_unlock(&context->topology_mutex);
    return found != NULL;
}

static bool join_new(shb_context *context, const shb_scene *scene, uint64_t key,
                     const shb_topology *known, shb_topology *topology) {
    shared_topology *made = shb_alloc(context, 1, sizeof *made);
    if (!made || !shb_topology_make(context, scene, key, known, topology)) {
        shb_free(context, made);
        return false;
    }
    made->topology = *topology;
    made->users = 1;
    pthread_mutex_lock(&context->topology_mutex);
    made->next = context->topologies;
    context->topologies = made;
    pthread_mutex_unlock(&context->topology_mutex);
    return true;
}

bool shb_topology_join(shb_context *context, const shb_scene *scene, const shb_topology *known,
                       shb_topology *topology) {
    const uint64_t key = shb_topology_key(scene);
    return join_used(context, key, shb_scene_triangle_count(scene), topology) ||
           join_new(context, scene, key, known, topology);
}

/* Taken out of the list if nobody uses it any more; else NULL. */
static shared_topology *drop_user(shb_context *context, const shb_topology *topology) {
    pthread_mutex_lock(&context->topology_mutex);
    shared_topology **link = &context->topologies;
    while ((*link)->topology.corners != topology->corners)
        link = &(*link)->next;
    shared_topology *found = *link;
    if (--found->users > 0)
        found = NULL;
    else
        *link = found->next;
    pthread_mutex_unlock(&context->topology_mutex);
    return found;
}

/* Empties *topology; what is left of it is to be freed: NULL if others use it, or it was empty. */
static shared_topology *leave(shb_context *context, shb_topology *topology) {
    shared_topology *unused = topology->corners ? drop_user(context, topology) : NULL;
    *topology = (shb_topology){0};
    return unused;
}

void shb_topology_return(shb_context *context, shb_topology *topology) {
    shared_topology *unused = leave(context, topology);
    if (unused)
        shb_topology_recycle(context, &unused->topology);
    shb_free(context, unused);
}

void shb_topology_leave(shb_context *context, shb_topology *topology) {
    shared_topology *unused = leave(context, topology);
    if (unused)
        shb_topology_release(context, &unused->topology);
    shb_free(context, unused);
}
