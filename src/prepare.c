#include "prepare.h"

#include <string.h>

static bool is_same(const shb_filter *a, const shb_filter *b) {
    return a->prepare == b->prepare && a->release == b->release && a->user == b->user &&
           memcmp(a->params, b->params, sizeof a->params) == 0;
}

const void *shb_prepared_find(const shb_map *map, const shb_filter *filter) {
    for (int i = 0; filter->prepare && i < map->prepared_count; i++)
        if (is_same(&map->prepared[i].filter, filter))
            return map->prepared[i].data;
    return NULL;
}

/* Later ones move up, so that the first is the oldest. */
static void drop(shb_map *map, int index) {
    shb_prepared *dropped = &map->prepared[index];
    map->info.memory_bytes -= dropped->bytes;
    if (dropped->filter.release)
        dropped->filter.release(map, dropped->data);
    map->prepared_count--;
    memmove(dropped, dropped + 1, (size_t)(map->prepared_count - index) * sizeof *dropped);
}

void shb_prepared_release(shb_map *map) {
    while (map->prepared_count)
        drop(map, map->prepared_count - 1);
}

/* Makes room for one more, first by what the same filter made with other parameters. */
static void make_room(shb_map *map, const shb_filter *filter) {
    for (int i = map->prepared_count - 1; i >= 0; i--)
        if (map->prepared[i].filter.prepare == filter->prepare &&
            map->prepared[i].filter.user == filter->user)
            drop(map, i);
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
    shb_prepared made = {.filter = *filter};
    const shb_result result = filter->prepare(map, filter, &made.data, &made.bytes);
    if (result != SHB_OK)
        return result;
    make_room(map, filter);
    map->prepared[map->prepared_count++] = made;
    map->info.memory_bytes += made.bytes;
    return SHB_OK;
}
