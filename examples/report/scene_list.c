#include "scene_list.h"

#include "tool.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static report_scene *append(report_scene_list *list) {
    if (list->count == list->capacity) {
        const size_t capacity = list->capacity ? 2 * list->capacity : 32;
        report_scene *grown = realloc(list->scenes, capacity * sizeof *grown);
        if (!grown) {
            list->failed = true;
            return NULL;
        }
        list->scenes = grown;
        list->capacity = capacity;
    }
    return &list->scenes[list->count++];
}

static bool is_taken(const report_scene_list *list, const report_scene *scene) {
    for (size_t i = 0; i < list->count; i++)
        if (&list->scenes[i] != scene && strcmp(list->scenes[i].name, scene->name) == 0)
            return true;
    return false;
}

void report_name_scene(const char *text, char *name, size_t size) {
    const char *slash = strrchr(text, '/');
    const char *base = slash ? slash + 1 : text;
    const size_t length = strlen(base);
    const bool is_file = length > 4 && strcmp(base + length - 4, ".obj") == 0;
    snprintf(name, size, "%.*s", (int)(is_file ? length - 4 : length), base);
    for (char *c = name; *c; c++)
        if (!isalnum((unsigned char)*c) && !strchr("-_.", *c))
            *c = '-';
}

/* A number stands behind a name that is taken. */
static void name_scene(const report_scene_list *list, report_scene *scene) {
    char stem[48];
    report_name_scene(scene->text, stem, sizeof stem);
    snprintf(scene->name, sizeof scene->name, "%s", stem);
    for (unsigned number = 2; is_taken(list, scene); number++)
        snprintf(scene->name, sizeof scene->name, "%s-%u", stem, number);
}

static void add_scene(report_scene_list *list, const char *text, bool both_lights, bool soft) {
    report_scene *scene = append(list);
    if (!scene)
        return;
    *scene = (report_scene){.both_lights = both_lights, .soft = soft};
    snprintf(scene->text, sizeof scene->text, "%s", text);
    name_scene(list, scene);
}

/* Scenes whose shadows fall far enough for penumbras. */
static const char *const soft_scenes[] = {
    "columns", "island", "tree", "sponza.obj", "japanese_temple.obj", NULL};

static void add_built_in(report_scene_list *list, bool quick) {
    static const char *const quick_scenes[] = {"columns", "island", "gap", "sphere", NULL};
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    for (size_t i = 0; i < count; i++) {
        const char *name = entries[i].name;
        if (!quick || tool_is_among(name, quick_scenes))
            add_scene(list, name, !quick || strcmp(name, "columns") == 0,
                      tool_is_among(name, soft_scenes));
    }
}

static int compare_texts(const void *a, const void *b) {
    return strcmp(((const report_scene *)a)->text, ((const report_scene *)b)->text);
}

/* The OBJ files of a directory in alphabetical order; none if there is no such directory. A quick
 * survey takes one of them. */
static void add_meshes(report_scene_list *list, const char *path, bool quick) {
    DIR *directory = opendir(path);
    const size_t first = list->count;
    if (!directory)
        return;
    for (const struct dirent *entry; (entry = readdir(directory));) {
        const char *ending = strrchr(entry->d_name, '.');
        char text[512];
        if (!ending || strcmp(ending, ".obj") != 0 ||
            (quick && strcmp(entry->d_name, "dx_crypt.obj") != 0))
            continue;
        if (snprintf(text, sizeof text, "%s/%s", path, entry->d_name) < (int)sizeof text)
            add_scene(list, text, !quick, tool_is_among(entry->d_name, soft_scenes));
    }
    closedir(directory);
    if (list->count > first)
        qsort(list->scenes + first, list->count - first, sizeof *list->scenes, compare_texts);
}

report_scene_list report_list_scenes(const report_options *options) {
    report_scene_list list = {0};
    if (!options->operands[0]) {
        add_built_in(&list, options->quick);
        add_meshes(&list, options->meshes, options->quick);
    }
    for (size_t i = 0; options->operands[i]; i++)
        add_scene(&list, options->operands[i], true, true);
    return list;
}

report_scene_list report_list_main_scenes(const report_options *options) {
    report_scene_list list = {0};
    if (!options->operands[0]) {
        add_scene(&list, "columns", !options->quick, false);
        add_scene(&list, "island", false, false);
    }
    for (size_t i = 0; options->operands[i]; i++)
        add_scene(&list, options->operands[i], true, false);
    return list;
}

void report_scene_list_free(report_scene_list *list) {
    free(list->scenes);
    *list = (report_scene_list){0};
}
