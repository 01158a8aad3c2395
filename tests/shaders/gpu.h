/* A graphics processor without a window for tests: Mesa's software renderer through EGL, as OpenGL 3.3 or OpenGL
 * ES 3.0, and the runtime's shaders on it. Whatever goes wrong here ends the program with a line that says so. */
#ifndef STYLUT_TESTS_GPU_H
#define STYLUT_TESTS_GPU_H

#include <epoxy/gl.h>
/* After gl.h. */
#include <epoxy/egl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

__attribute__((noreturn, format(printf, 1, 2))) static inline void give_up(const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  fprintf(stderr, "shaders: ");
  vfprintf(stderr, format, arguments);
  fputc('\n', stderr);
  va_end(arguments);
  exit(1);
}

/* ---- textures ---- */

/* All that passes sample; the place in this list is the texture unit. */
enum {
  UNIT_EXEMPLARS,
  UNIT_GUIDES,
  UNIT_LUTS,
  UNIT_PARAMS,
  UNIT_JITTER,
  UNIT_GUIDE,
  UNIT_FINE,
  UNIT_DEPTH,
  UNIT_STYLES,
  UNIT_OBJECTS,
  UNIT_LUMA,
  UNIT_ALBEDO,
  UNIT_ANCHORS,
  UNIT_MATCHES,
  UNIT_HALF_MATCHES,
  UNIT_PICTURE,
  UNIT_PATTERN,
  UNIT_NOISE,
  UNIT_CONTOURS,
  UNIT_COLUMNS,
  UNIT_WOBBLE,
  UNIT_LINES,
  UNIT_BELOW,
  UNITS
};

typedef struct Format {
  const char *sampler;
  GLenum target;
  GLint internal;
  GLenum format, type;
} Format;

static const Format formats[UNITS] = {
    {"bundle_exemplars", GL_TEXTURE_2D_ARRAY, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    {"bundle_guides", GL_TEXTURE_2D_ARRAY, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    {"bundle_luts", GL_TEXTURE_2D_ARRAY, GL_RG16UI, GL_RG_INTEGER, GL_UNSIGNED_SHORT},
    {"bundle_params", GL_TEXTURE_2D_ARRAY, GL_RGBA32F, GL_RGBA, GL_FLOAT},
    {"bundle_jitter", GL_TEXTURE_2D_ARRAY, GL_RG8, GL_RG, GL_UNSIGNED_BYTE},
    {"frame_guide", GL_TEXTURE_2D, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    {"frame_fine", GL_TEXTURE_2D, GL_RG32F, GL_RG, GL_FLOAT},
    {"frame_depth", GL_TEXTURE_2D, GL_R32F, GL_RED, GL_FLOAT},
    {"frame_styles", GL_TEXTURE_2D, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE},
    {"frame_objects", GL_TEXTURE_2D, GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT},
    {"frame_luma", GL_TEXTURE_2D, GL_R8, GL_RED, GL_UNSIGNED_BYTE},
    {"frame_albedo", GL_TEXTURE_2D, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    {"frame_anchors", GL_TEXTURE_2D, GL_RG32I, GL_RG_INTEGER, GL_INT},
    {"matches", GL_TEXTURE_2D, GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT},
    {"half_matches", GL_TEXTURE_2D, GL_RGBA16UI, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT},
    {"double_picture", GL_TEXTURE_2D, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
    {"toon_pattern", GL_TEXTURE_2D, GL_R8, GL_RED, GL_UNSIGNED_BYTE},
    {"outline_noise", GL_TEXTURE_2D, GL_R8, GL_RED, GL_UNSIGNED_BYTE},
    {"contours", GL_TEXTURE_2D, GL_R8, GL_RED, GL_UNSIGNED_BYTE},
    {"columns", GL_TEXTURE_2D, GL_R8I, GL_RED_INTEGER, GL_BYTE},
    {"line_wobble", GL_TEXTURE_2D, GL_RG8, GL_RG, GL_UNSIGNED_BYTE},
    {"lines", GL_TEXTURE_2D, GL_R8, GL_RED, GL_UNSIGNED_BYTE},
    {"below", GL_TEXTURE_2D, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE},
};

/* Leaves the texture bound to its unit. texels: NULL for whatever, as targets and what nobody reads have it. */
static inline GLuint upload(int unit, int width, int height, int layers, const void *texels) {
  const Format *format = &formats[unit];
  GLuint texture;
  glGenTextures(1, &texture);
  glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
  glBindTexture(format->target, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexParameteri(format->target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(format->target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (format->target == GL_TEXTURE_2D_ARRAY)
    glTexImage3D(format->target, 0, format->internal, width, height, layers, 0, format->format, format->type, texels);
  else
    glTexImage2D(format->target, 0, format->internal, width, height, 0, format->format, format->type, texels);
  return texture;
}

/* ---- passes ---- */

enum {
  PASS_TRANSFER,
  PASS_LOOK_UP,
  PASS_EXPAND,
  PASS_BLEND,
  PASS_HALVE,
  PASS_TOON,
  PASS_CONTOURS,
  PASS_COLUMNS,
  PASS_LINES,
  PASS_LAY,
  PASSES
};
static const char *const pass_names[PASSES] = {"transfer", "look_up",  "expand",  "blend", "halve",
                                               "toon",     "contours", "columns", "lines", "lay"};

typedef struct Gpu {
  const char *dialect;
  EGLDisplay display;
  EGLContext context;
  GLuint programs[PASSES], vertices, framebuffer;
} Gpu;

/* The program is BUILD/tests/shaders/NAME, shaders are in BUILD/glsl. */
static inline char *read_shader(const char *dialect, const char *name) {
  char path[PATH_MAX] = {0};
  if (readlink("/proc/self/exe", path, sizeof path - 1) < 0) give_up("/proc/self/exe cannot be read");
  for (int i = 0; i < 3; i++) *strrchr(path, '/') = 0;
  snprintf(path + strlen(path), sizeof path - strlen(path), "/glsl/%s/%s", dialect, name);
  FILE *file = fopen(path, "rb");
  char *text = calloc(1, 1 << 20);
  if (!file || !text || fread(text, 1, (1 << 20) - 1, file) == 0) give_up("%s cannot be read", path);
  fclose(file);
  return text;
}

static inline GLuint compile(GLenum kind, const char *dialect, const char *name) {
  char *text = read_shader(dialect, name), said[4096] = "";
  const GLuint shader = glCreateShader(kind);
  GLint compiled = 0;
  glShaderSource(shader, 1, (const GLchar *const *)&text, NULL);
  glCompileShader(shader);
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  glGetShaderInfoLog(shader, sizeof said, NULL, said);
  if (!compiled || said[0]) give_up("%s/%s: %s", dialect, name, said);
  free(text);
  return shader;
}

static inline GLuint link_pass(const char *dialect, const char *pass) {
  char name[64], said[4096] = "";
  snprintf(name, sizeof name, "%s.frag", pass);
  const GLuint program = glCreateProgram(), vertex = compile(GL_VERTEX_SHADER, dialect, "full_screen.vert"),
               fragment = compile(GL_FRAGMENT_SHADER, dialect, name);
  GLint linked = 0;
  glAttachShader(program, vertex);
  glAttachShader(program, fragment);
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  glGetProgramInfoLog(program, sizeof said, NULL, said);
  if (!linked) give_up("%s/%s: %s", dialect, name, said);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  glUseProgram(program);
  for (int unit = 0; unit < UNITS; unit++) glUniform1i(glGetUniformLocation(program, formats[unit].sampler), unit);
  return program;
}

static inline void open_context(Gpu *gpu, bool es) {
  const EGLint core[] = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
  /* The same renderer on every machine, whatever card it has. */
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  gpu->display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  if (!eglInitialize(gpu->display, NULL, NULL)) give_up("EGL without a surface doesn't start; is Mesa installed?");
  eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
  gpu->context = eglCreateContext(gpu->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, es ? embedded : core);
  if (!gpu->context || !eglMakeCurrent(gpu->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gpu->context))
    give_up("EGL has no context for %s", es ? "OpenGL ES 3.0" : "OpenGL 3.3");
}

/* dialect: "330" or "es300". */
static inline Gpu open_gpu(const char *dialect) {
  Gpu gpu = {.dialect = dialect};
  open_context(&gpu, strcmp(dialect, "es300") == 0);
  for (int pass = 0; pass < PASSES; pass++) gpu.programs[pass] = link_pass(dialect, pass_names[pass]);
  glGenVertexArrays(1, &gpu.vertices);
  glBindVertexArray(gpu.vertices);
  glGenFramebuffers(1, &gpu.framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, gpu.framebuffer);
  glDisable(GL_DITHER);
  return gpu;
}

static inline void close_gpu(Gpu *gpu) {
  eglMakeCurrent(gpu->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(gpu->display, gpu->context);
  eglTerminate(gpu->display);
}

static inline void set_integer(const Gpu *gpu, int pass, const char *uniform, int value) {
  glUseProgram(gpu->programs[pass]);
  glUniform1i(glGetUniformLocation(gpu->programs[pass], uniform), value);
}

static inline void set_size(const Gpu *gpu, int pass, const char *uniform, int width, int height) {
  glUseProgram(gpu->programs[pass]);
  glUniform2i(glGetUniformLocation(gpu->programs[pass], uniform), width, height);
}

static inline void set_integers(const Gpu *gpu, int pass, const char *uniform, int count, const int *values) {
  glUseProgram(gpu->programs[pass]);
  glUniform1iv(glGetUniformLocation(gpu->programs[pass], uniform), count, values);
}

/* Of 4 bytes each. */
static inline void set_colours(const Gpu *gpu, int pass, const char *uniform, int count, const uint8_t (*colours)[4]) {
  for (int i = 0; i < count; i++) {
    char name[32];
    snprintf(name, sizeof name, count > 1 ? "%s[%d]" : "%s", uniform, i);
    glUseProgram(gpu->programs[pass]);
    glUniform4i(glGetUniformLocation(gpu->programs[pass], name), colours[i][0], colours[i][1], colours[i][2],
                colours[i][3]);
  }
}

static inline void set_number(const Gpu *gpu, int pass, const char *uniform, float value) {
  glUseProgram(gpu->programs[pass]);
  glUniform1f(glGetUniformLocation(gpu->programs[pass], uniform), value);
}

/* Draws a pass into a texture, which has the format of `unit`, and reads it back: 4 values of 32 bits a pixel from
 * integers, of 8 from others. */
static inline void draw_pass(const Gpu *gpu, int pass, GLuint target, int unit, int width, int height, void *out) {
  glUseProgram(gpu->programs[pass]);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, target, 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) give_up("%s: no target", pass_names[pass]);
  glViewport(0, 0, width, height);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const GLenum from = formats[unit].format;
  const bool is_signed = from == GL_RED_INTEGER, integers = from == GL_RGBA_INTEGER || is_signed;
  glReadPixels(0, 0, width, height, integers ? GL_RGBA_INTEGER : GL_RGBA,
               is_signed  ? GL_INT
               : integers ? GL_UNSIGNED_INT
                          : GL_UNSIGNED_BYTE,
               out);
  const GLenum error = glGetError();
  if (error) give_up("%s/%s: GL error 0x%x", gpu->dialect, pass_names[pass], error);
}

#endif
