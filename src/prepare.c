#include "prepare.h"

#include <string.h>

static bool is_same(const shb_filter *a, const shb_filter *b) {
    return a->prepare == b->prepare && a->release == b->release && a->user == b->user &&
           memcmp(a->params, b->params, sizeof a->params) == 0;
}

/* The place of what the same filter made, or -1. */
static int find(const shb_map *map, const shb_filter *filter) {
    for (int i = 0; filter->prepare && i < map->prepared_count; i++)
        if (is_same(&map->prepared[i].filter, filter))
            return i;
    return -1;
}

const void *shb_prepared_find(const shb_map *map, const shb_filter *filter) {
    const int found = find(map, filter);
    return found >= 0 && !map->prepared[found].outdated ? map->prepared[found].data : NULL;
}

size_t shb_prepared_bytes(const shb_map *map) {
    size_t bytes = 0;
    for (int i = 0; i < map->prepared_count; i++)
        bytes += map->prepared[i].bytes;
    return bytes;
}

static void release(const shb_map *map, const shb_filter *filter, void *data) {
    if (filter->release && data)
        filter->release(map, data);
}

/* Later ones move up, so that the first is the oldest. */
static shb_prepared take(shb_map *map, int index) {
    shb_prepared *place = &map->prepared[index], taken = *place;
    map->info.memory_bytes -= taken.bytes;
    map->prepared_count--;
    memmove(place, place + 1, (size_t)(map->prepared_count - index) * sizeof *place);
    return taken;
}

static void drop(shb_map *map, int index) {
    const shb_prepared dropped = take(map, index);
    release(map, &dropped.filter, dropped.data);
}

void shb_prepared_release(shb_map *map) {
    while (map->prepared_count)
        drop(map, map->prepared_count - 1);
}

void shb_prepared_outdate(shb_map *map) {
    for (int i = map->prepared_count - 1; i >= 0; i--) {
        if (map->prepared[i].outdated)
            drop(map, i);
        else
            map->prepared[i].outdated = true;
    }
}

/* Makes room for one more: of what is outdated, of what the same filter made with other parameters,
 * and of the oldest if need be. */
static void make_room(shb_map *map, const shb_filter *filter) {
    for (int i = map->prepared_count - 1; i >= 0; i--) {
        const shb_filter *other = &map->prepared[i].filter;
        if (map->prepared[i].outdated ||
            (other->prepare == filter->prepare && other->user == filter->user))
            drop(map, i);
    }
    if (map->prepared_count == SHB_PREPARED_MAX)
        drop(map, 0);
}

shb_result shb_map_prepare(shb_map *map, const shb_filter *filter) {
    if (!map)
        return SHB_ERROR_ARGUMENT;
    if (!filter || !filter->filter)
        return shb_fail(map->context, SHB_ERROR_ARGUMENT, "shb_map_prepare: %s is NULL",
                        filter ? "filter.filter" : "filter");
    if (!filter->prepare)
        return SHB_OK;
    if (map->exact_only)
        return shb_fail(map->context, SHB_ERROR_UNSUPPORTED,
                        "shb_map_prepare: map keeps no depths, as desc.exact_only says");
    const int before = find(map, filter);
    shb_prepared made = {.filter = *filter};
    made.data = before >= 0 ? map->prepared[before].data : NULL;
    const shb_result result = filter->prepare(map, filter, &made.data, &made.bytes);
    if (result != SHB_OK)
        return result;
    if (before >= 0) {
        const shb_prepared old = take(map, before);
        if (old.data != made.data)
            release(map, filter, old.data);
    }
    make_room(map, filter);
    map->prepared[map->prepared_count++] = made;
    map->info.memory_bytes += made.bytes;
    return SHB_OK;
}
