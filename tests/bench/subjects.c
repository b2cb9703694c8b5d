#include "subjects.h"

#include "shapes_measured.h"
#include "tool.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct made_subject {
    const char *name;
    void (*build)(example_scene *scene);
} made_subject;

static const made_subject made_subjects[] = {
    {"height-field", measured_height_field},
    {"hills", measured_hills},
    {"huge", measured_huge},
    {"stack", measured_stack},
    {"triangle", measured_triangle},
    {"culled", measured_culled},
};

static const char *const closed_meshes[] = {"bunny_69k", "bunny_144k", "dx_island", NULL};

void subject_title(const char *name, char *title, size_t size) {
    const char *slash = strrchr(name, '/');
    snprintf(title, size, "%s", slash ? slash + 1 : name);
    char *ending = strstr(title, ".obj");
    if (ending)
        *ending = 0;
}

static bool is_file(const char *name) {
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    const size_t length = strcspn(name, ":");
    for (size_t i = 0; i < count; i++)
        if (strlen(entries[i].name) == length && memcmp(entries[i].name, name, length) == 0)
            return false;
    return true;
}

static bool is_closed(const char *name) {
    char title[64];
    subject_title(name, title, sizeof title);
    return tool_is_among(title, closed_meshes);
}

static bool make_subject(const made_subject *subject, example_scene **scene, char *error,
                         size_t error_size) {
    example_scene *made = calloc(1, sizeof *made);
    if (made) {
        subject->build(made);
        measured_finish(made);
    }
    if (made && !made->failed) {
        *scene = made;
        return true;
    }
    snprintf(error, error_size, "scene %s: out of memory", subject->name);
    scene_close(made);
    return false;
}

bool subject_open(const char *name, example_scene **scene, char *error, size_t error_size) {
    for (size_t i = 0; i < sizeof made_subjects / sizeof *made_subjects; i++)
        if (strcmp(name, made_subjects[i].name) == 0)
            return make_subject(&made_subjects[i], scene, error, error_size);
    if (!scene_open(name, scene, error, error_size))
        return false;
    if (is_file(name)) {
        (*scene)->lights[SCENE_DIRECTIONAL].source = (shb_vec3){0.4, 0.8, 0.45};
        (*scene)->instances[0].cull = is_closed(name) ? SHB_CULL_BACK : SHB_CULL_NONE;
    }
    return true;
}

example_scene *subject_open_if_there(const char *folder, const char *name) {
    char path[1024], error[256];
    example_scene *scene = NULL;
    bool is_made = false;
    for (size_t i = 0; i < sizeof made_subjects / sizeof *made_subjects; i++)
        is_made |= strcmp(name, made_subjects[i].name) == 0;
    if (is_made)
        snprintf(path, sizeof path, "%s", name);
    else
        snprintf(path, sizeof path, "%s/%s.obj", folder, name);
    return subject_open(path, &scene, error, sizeof error) ? scene : NULL;
}

static shb_vec3 corner(const owned_mesh *mesh, uint32_t index) {
    const float *p = mesh->positions + 3 * (size_t)index;
    return (shb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

void subject_keep_back_faces(example_scene *scene) {
    owned_mesh *mesh = &scene->meshes[0];
    const shb_vec3 to_light = scene->lights[SCENE_DIRECTIONAL].source;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *triangle = mesh->indices + 3 * (size_t)i;
        const shb_vec3 a = corner(mesh, triangle[0]);
        const shb_vec3 b = shb_vec3_subtract(corner(mesh, triangle[1]), a);
        const shb_vec3 c = shb_vec3_subtract(corner(mesh, triangle[2]), a);
        if (shb_vec3_dot(shb_vec3_cross(b, c), to_light) < 0)
            memmove(mesh->indices + 3 * (size_t)kept++, triangle, 3 * sizeof *triangle);
    }
    mesh->triangle_count = kept;
    scene->triangle_count = kept;
    scene->views[0] = owned_mesh_view(mesh);
}

bool subject_list_add(subject_list *list, const char *name) {
    char **names = realloc(list->names, (list->count + 1) * sizeof *names);
    if (!names)
        return false;
    list->names = names;
    const size_t size = strlen(name) + 1;
    names[list->count] = malloc(size);
    if (!names[list->count])
        return false;
    memcpy(names[list->count++], name, size);
    return true;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool add_files(const char *folder, subject_list *list) {
    DIR *directory = opendir(folder);
    if (!directory)
        return true;
    const size_t first = list->count;
    bool done = true;
    for (struct dirent *entry = readdir(directory); entry && done; entry = readdir(directory)) {
        const size_t length = strlen(entry->d_name);
        char path[1024];
        if (length > 4 && strcmp(entry->d_name + length - 4, ".obj") == 0 &&
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path)
            done = subject_list_add(list, path);
    }
    closedir(directory);
    qsort(list->names + first, list->count - first, sizeof *list->names, compare_names);
    return done;
}

bool subject_list_all(const char *folder, subject_list *list) {
    size_t count;
    const scene_entry *entries = scene_entries(&count);
    bool done = true;
    for (size_t i = 0; i < count && done; i++)
        done = subject_list_add(list, entries[i].name);
    return done && subject_list_add(list, "height-field") && subject_list_add(list, "huge") &&
           add_files(folder, list);
}

void subject_list_free(subject_list *list) {
    for (size_t i = 0; i < list->count; i++)
        free(list->names[i]);
    free(list->names);
    *list = (subject_list){0};
}
