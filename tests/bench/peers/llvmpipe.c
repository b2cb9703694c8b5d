/* Mesa's software renderer beside this library, through EGL without a window: depth maps, and whole
 * frames, one thread each. Both draw meshes that they were given before: it from static buffers,
 * the library with clusters. */
#include "comparison.h"

#include "draw_work.h"
#include "tool.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAME = 1024 };

static const char depth_vertex[] = "#version 300 es\n"
                                   "uniform mat4 clip_from_world;\n"
                                   "layout(location = 0) in vec3 position;\n"
                                   "void main() {\n"
                                   "    gl_Position = clip_from_world * vec4(position, 1.0);\n"
                                   "}\n";

static const char depth_fragment[] = "#version 300 es\n"
                                     "void main() {}\n";

static const char frame_vertex[] = "#version 300 es\n"
                                   "uniform mat4 clip_from_world, light_from_world;\n"
                                   "layout(location = 0) in vec3 position;\n"
                                   "layout(location = 1) in vec3 normal;\n"
                                   "out vec3 shading_normal;\n"
                                   "out vec4 light_position;\n"
                                   "void main() {\n"
                                   "    gl_Position = clip_from_world * vec4(position, 1.0);\n"
                                   "    light_position = light_from_world * vec4(position, 1.0);\n"
                                   "    shading_normal = normal;\n"
                                   "}\n";

/* RADIUS is 0 for one tap, 2 for 5 x 5. */
static const char frame_fragment[] =
    "precision highp float;\n"
    "uniform highp sampler2DShadow map;\n"
    "uniform vec3 to_light;\n"
    "uniform float bias, texel;\n"
    "in vec3 shading_normal;\n"
    "in vec4 light_position;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() {\n"
    "    vec3 place = light_position.xyz / light_position.w * 0.5 + 0.5;\n"
    "    float lit = 0.0;\n"
    "    for (int y = -RADIUS; y <= RADIUS; y++)\n"
    "        for (int x = -RADIUS; x <= RADIUS; x++)\n"
    "            lit += texture(map, place + vec3(vec2(x, y) * texel, -bias));\n"
    "    lit /= float((2 * RADIUS + 1) * (2 * RADIUS + 1));\n"
    "    float cosine = max(dot(normalize(shading_normal), to_light), 0.0);\n"
    "    color = vec4(vec3(sqrt(lit * cosine + 0.04)), 1.0);\n"
    "}\n";

/* What one scene needs in GL. */
typedef struct gl_work {
    const comparison *c;
    uint32_t map_size;
    shb_view light, camera;
    shb_vec3 to_light;
    float bias;
    GLuint array, buffers[3], depth_program, frame_program, map_target, map, frame_target;
    GLuint frame_images[2];
    uint8_t *pixels; /* reading them ends a frame, as a host of a software renderer would */
} gl_work;

static GLuint compile(GLenum kind, const char *prefix, const char *source) {
    const GLuint shader = glCreateShader(kind);
    const char *const parts[] = {prefix, source};
    glShaderSource(shader, 2, parts, NULL);
    glCompileShader(shader);
    return shader;
}

static GLuint link_program(const char *vertex, const char *prefix, const char *fragment) {
    const GLuint program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, "", vertex));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, prefix, fragment));
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    return linked ? program : 0;
}

/* Depth from -w to w, as OpenGL clips, instead of 0 to w. */
static void set_matrix(GLuint program, const char *name, const shb_view *view) {
    const double *from = view->clip_from_world.m;
    GLfloat to[16];
    for (int i = 0; i < 16; i++)
        to[i] = (GLfloat)(i % 4 == 2 ? 2 * from[i] - from[i + 1] : from[i]);
    glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, to);
}

static void create_buffers(gl_work *work) {
    const world_mesh *mesh = &work->c->mesh;
    glGenVertexArrays(1, &work->array);
    glBindVertexArray(work->array);
    glGenBuffers(3, work->buffers);
    const float *const attributes[] = {mesh->positions, mesh->normals};
    for (GLuint i = 0; i < 2; i++) {
        glBindBuffer(GL_ARRAY_BUFFER, work->buffers[i]);
        glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)12 * mesh->vertex_count, attributes[i],
                     GL_STATIC_DRAW);
        glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 12, NULL);
        glEnableVertexAttribArray(i);
    }
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, work->buffers[2]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)12 * mesh->triangle_count, mesh->indices,
                 GL_STATIC_DRAW);
}

static bool create_map(gl_work *work) {
    const GLsizei size = (GLsizei)work->map_size;
    glGenTextures(1, &work->map);
    glBindTexture(GL_TEXTURE_2D, work->map);
    glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, size, size);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glGenFramebuffers(1, &work->map_target);
    glBindFramebuffer(GL_FRAMEBUFFER, work->map_target);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, work->map, 0);
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static bool create_frame(gl_work *work) {
    glGenRenderbuffers(2, work->frame_images);
    glGenFramebuffers(1, &work->frame_target);
    glBindFramebuffer(GL_FRAMEBUFFER, work->frame_target);
    const GLenum formats[] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
    const GLenum attachments[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (int i = 0; i < 2; i++) {
        glBindRenderbuffer(GL_RENDERBUFFER, work->frame_images[i]);
        glRenderbufferStorage(GL_RENDERBUFFER, formats[i], FRAME, FRAME);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachments[i], GL_RENDERBUFFER,
                                  work->frame_images[i]);
    }
    return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static void gl_work_destroy(gl_work *work) {
    glDeleteFramebuffers(1, &work->map_target);
    glDeleteFramebuffers(1, &work->frame_target);
    glDeleteRenderbuffers(2, work->frame_images);
    glDeleteTextures(1, &work->map);
    glDeleteProgram(work->depth_program);
    glDeleteProgram(work->frame_program);
    glDeleteVertexArrays(1, &work->array);
    glDeleteBuffers(3, work->buffers);
    free(work->pixels);
}

static void draw(const gl_work *work, GLuint target, GLsizei size, GLbitfield clear) {
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, size, size);
    glClear(clear);
    glDrawElements(GL_TRIANGLES, (GLsizei)(3 * work->c->mesh.triangle_count), GL_UNSIGNED_INT,
                   NULL);
}

static void draw_map(const gl_work *work) {
    glUseProgram(work->depth_program);
    set_matrix(work->depth_program, "clip_from_world", &work->light);
    draw(work, work->map_target, (GLsizei)work->map_size, GL_DEPTH_BUFFER_BIT);
}

static shb_result gl_depth(void *state) {
    draw_map(state);
    glFinish();
    return glGetError() == GL_NO_ERROR ? SHB_OK : SHB_ERROR_MEMORY;
}

static shb_result gl_frame(void *state) {
    const gl_work *work = state;
    const GLuint program = work->frame_program;
    draw_map(work);
    glUseProgram(program);
    set_matrix(program, "clip_from_world", &work->camera);
    set_matrix(program, "light_from_world", &work->light);
    glUniform3f(glGetUniformLocation(program, "to_light"), (GLfloat)work->to_light.x,
                (GLfloat)work->to_light.y, (GLfloat)work->to_light.z);
    glUniform1f(glGetUniformLocation(program, "bias"), work->bias);
    glUniform1f(glGetUniformLocation(program, "texel"), 1.0f / (GLfloat)work->map_size);
    draw(work, work->frame_target, FRAME, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glReadPixels(0, 0, FRAME, FRAME, GL_RGBA, GL_UNSIGNED_BYTE, work->pixels);
    return glGetError() == GL_NO_ERROR ? SHB_OK : SHB_ERROR_MEMORY;
}

/* The library's way to the same images. */
typedef struct own_work {
    const comparison *c;
    shb_map *map;
    shb_bias bias;
    shb_filter filter;
    draw_work camera;
    shb_image image;
} own_work;

static shb_result own_depth(void *state) {
    const own_work *work = state;
    return shb_map_draw(work->map, &work->c->scene->scene, NULL, NULL);
}

static shb_result own_frame(void *state) {
    own_work *work = state;
    const bench_work camera = draw_work_of(&work->camera);
    shb_result result = own_depth(work);
    if (!result)
        result = camera.run(camera.state);
    const shb_shade_light light = {
        .map = work->map, .bias = &work->bias, .filter = &work->filter, .color = {1, 1, 1}};
    const shb_shade_desc desc = {.frame = {.view = &work->camera.view,
                                           .scene = &work->c->scene->scene,
                                           .width = FRAME,
                                           .height = FRAME,
                                           .ids = work->camera.desc.ids,
                                           .id_stride = work->camera.desc.id_stride},
                                 .lights = &light,
                                 .light_count = 1,
                                 .shade = shb_shade_lambert,
                                 .image = work->image};
    return result ? result : shb_shade(work->c->context, &desc);
}

static shb_result own_create(const comparison *c, const shb_view *light, uint32_t map_size,
                             own_work *work) {
    const shb_map_desc desc = {.view = *light, .width = map_size, .scene_scale = 1};
    *work = (own_work){.c = c, .bias = shb_bias_adaptive(1e-4f, 0)};
    work->image = (shb_image){malloc(3 * FRAME * FRAME), FRAME, FRAME, 0};
    const shb_result result = draw_work_create(c->context, &c->scene->scene, &c->frame.view, FRAME,
                                               FRAME, DRAW_IDS, &work->camera);
    return result ? result : shb_map_create(c->context, &desc, &work->map);
}

static void own_destroy(own_work *work) {
    shb_map_destroy(work->map);
    draw_work_destroy(&work->camera);
    free(work->image.pixels);
}

typedef struct task {
    const char *name, *own_method;
    const char *filter; /* of the library; NULL: the depth map alone */
    const char *prefix; /* of the fragment shader */
    uint32_t map_size;
} peer_task;

static bool measure_task(const comparison *c, const peer_task *task, gl_work *gl, own_work *own) {
    comparison_row row = {.task = task->name,
                          .own_method = task->own_method,
                          .map_size = task->map_size,
                          .peer_wrong_ppm = -1,
                          .own_wrong_ppm = -1};
    bool done;
    if (!task->filter) {
        done = comparison_measure(c, (bench_work){gl_depth, gl}, (bench_work){own_depth, own},
                                  &row.build);
    } else {
        row.fragment_count = c->frame.fragment_count;
        done = tool_succeeds(c->peer, task->filter, shb_filter_parse(task->filter, &own->filter)) &&
               comparison_measure(c, (bench_work){gl_frame, gl}, (bench_work){own_frame, own},
                                  &row.ask);
    }
    if (done)
        comparison_print(c, &row);
    return done;
}

static bool compare_task(const comparison *c, const peer_task *task) {
    gl_work gl = {.c = c, .map_size = task->map_size, .camera = c->frame.view, .bias = 0.002f};
    own_work own = {0};
    gl.to_light = shb_vec3_normalize(c->scene->lights[SCENE_DIRECTIONAL].source);
    gl.pixels = malloc(4 * FRAME * FRAME);
    if (!tool_succeeds(
            c->peer, "light",
            scene_light_view(c->scene, SCENE_DIRECTIONAL, task->map_size, false, &gl.light)))
        return false;
    gl.depth_program = link_program(depth_vertex, "", depth_fragment);
    gl.frame_program = link_program(frame_vertex, task->prefix, frame_fragment);
    create_buffers(&gl);
    bool done =
        gl.pixels && gl.depth_program && gl.frame_program && create_map(&gl) && create_frame(&gl);
    if (!done)
        fprintf(stderr, "%s: %s: GL refuses a shader or an image\n", c->peer, c->title);
    done = done && tool_succeeds(c->peer, "map", own_create(c, &gl.light, task->map_size, &own)) &&
           measure_task(c, task, &gl, &own);
    own_destroy(&own);
    gl_work_destroy(&gl);
    return done;
}

/* As the library draws the scene. */
static void set_culling(const example_scene *scene) {
    if (scene->scene.instances[0].cull == SHB_CULL_BACK)
        glEnable(GL_CULL_FACE);
    else
        glDisable(GL_CULL_FACE);
}

static bool compare(const comparison *c) {
#define ONE_TAP "#version 300 es\n#define RADIUS 0\n"
#define BOX_5X5 "#version 300 es\n#define RADIUS 2\n"
    static const peer_task tasks[] = {
        {"depth map", "depth map", NULL, ONE_TAP, 1024},
        {"depth map", "depth map", NULL, ONE_TAP, 2048},
        {"frame, hard", "adaptive, hard", "hard", ONE_TAP, 2048},
        {"frame, 5x5", "adaptive, pcf 5x5", "pcf:size=5", BOX_5X5, 2048},
    };
    bool done = tool_succeeds(c->peer, "clusters", scene_add_clusters(c->context, c->scene));
    set_culling(c->scene);
    for (size_t i = 0; i < sizeof tasks / sizeof *tasks && done; i++)
        done = compare_task(c, &tasks[i]);
    return done;
}

/* Mesa takes memory for every frame anew: without this the system clears its pages each time, which
 * can double a frame's time. The library's context keeps its own. */
static void keep_freed_memory(void) {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
}

/* A context without a window or a surface, of Mesa's software renderer on the calling thread. */
static bool open_gl(void) {
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    setenv("GALLIUM_DRIVER", "llvmpipe", 1);
    setenv("LP_NUM_THREADS", "0", 1);
    EGLDisplay display =
        eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT, EGL_SURFACE_TYPE, 0,
                             EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
    EGLConfig config;
    EGLint count = 0;
    if (!eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_ES_API) ||
        !eglChooseConfig(display, wanted, &config, 1, &count) || count == 0)
        return false;
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        return false;
    glEnable(GL_DEPTH_TEST);
    return strstr((const char *)glGetString(GL_RENDERER), "llvmpipe") != NULL;
}

int main(int argc, char **argv) {
    keep_freed_memory();
    if (!open_gl()) {
        printf("skipped llvmpipe: EGL has no software renderer without a window\n");
        return TOOL_OK;
    }
    printf(
        "# meshes were handed over before: llvmpipe draws static buffers, this library clusters\n");
    return comparison_run(argc, argv, "llvmpipe", compare);
}
