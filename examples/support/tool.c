#include "tool.h"

#include "text_file.h"

#include <string.h>

bool tool_succeeds(const char *program, const char *what, shb_result result) {
    if (result)
        fprintf(stderr, "%s: %s: %s\n", program, what, shb_result_string(result));
    return result == SHB_OK;
}

static void print_failure(void *user, shb_result result, const char *sentence) {
    (void)result;
    fprintf(stderr, "%s: %s\n", (const char *)user, sentence);
}

shb_context *tool_create_context(const char *program, uint32_t threads, shb_isa max_isa) {
    const shb_context_desc desc = {
        .threads = threads, .log = print_failure, .log_user = (void *)program, .max_isa = max_isa};
    shb_context *context = NULL;
    tool_succeeds(program, "context", shb_context_create(&desc, &context));
    return context;
}

example_scene *tool_open_scene(const char *program, const char *name) {
    char error[512];
    example_scene *scene;
    if (scene_open(name, &scene, error, sizeof error))
        return scene;
    fprintf(stderr, "%s: %s\n", program, error);
    return NULL;
}

bool tool_parse_isa(const char *name, shb_isa *isa) {
    if (strcmp(name, "best") == 0) {
        *isa = SHB_ISA_BEST;
        return true;
    }
    for (int i = SHB_ISA_SCALAR; i < SHB_ISA_COUNT; i++)
        if (strcmp(name, shb_isa_name((shb_isa)i)) == 0) {
            *isa = (shb_isa)i;
            return true;
        }
    return false;
}

bool tool_write_image(const char *program, const shb_image *image, const char *path) {
    return tool_succeeds(program, path, shb_image_write_ppm(image, path));
}

bool tool_write_picture(const char *program, const shb_image *image, const char *directory,
                        const char *name) {
    char path[1024];
    if (snprintf(path, sizeof path, "%s/%s.ppm", directory, name) < (int)sizeof path)
        return tool_write_image(program, image, path);
    fprintf(stderr, "%s: %s: the path is too long\n", program, directory);
    return false;
}

bool tool_close_text(const char *program, FILE *stream, const char *path) {
    return tool_succeeds(program, path, text_file_close(stream) ? SHB_OK : SHB_ERROR_FILE);
}

bool tool_is_among(const char *name, const char *const *names) {
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}
