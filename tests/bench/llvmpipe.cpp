#define EGL_NO_X11
#define GL_GLEXT_PROTOTYPES
#include "tests/bench/llvmpipe.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <utility>
#include <vector>

namespace frustum::bench {
namespace {

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 clip_from_world;
out vec3 p, n;
out vec2 t;
void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  p = position;
  n = normal;
  t = uv;
})";

constexpr const char* fragment_shader = R"(#version 330 core
in vec3 p, n;
in vec2 t;
uniform vec3 eye, to_light;
uniform sampler2D board;
layout(location = 0) out vec4 color;
void main() {
  vec3 unit = normalize(n);
  float facing = max(dot(unit, to_light), 0.0);
  vec3 h = normalize(to_light + normalize(eye - p));
  float highlight = facing > 0.0 ? 0.3 * pow(max(dot(unit, h), 0.0), 32.0) : 0.0;
  color = vec4(texture(board, t).rgb * (0.1 + 0.8 * facing) + highlight, 1.0);
})";

constexpr const char* id_shader = R"(#version 330 core
layout(location = 0) out uint face;
void main() { face = uint(gl_PrimitiveID); })";

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(std::string("llvmpipe: ") + what);
}

GLuint compiled(GLenum stage, const char* text) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  require(done != 0, "a shader does not compile");
  return shader;
}

GLuint linked(const char* fragments) {
  const GLuint program = glCreateProgram();
  glAttachShader(program, compiled(GL_VERTEX_SHADER, vertex_shader));
  glAttachShader(program, compiled(GL_FRAGMENT_SHADER, fragments));
  glLinkProgram(program);
  GLint done = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &done);
  require(done != 0, "the shaders do not link");
  return program;
}

void use_program(GLuint program, const PeerScene& scene) {
  glUseProgram(program);
  const auto at = [&](const char* name) { return glGetUniformLocation(program, name); };
  glUniformMatrix4fv(at("clip_from_world"), 1, GL_FALSE, &scene.clip_from_world[0][0]);
  glUniform3fv(at("eye"), 1, &scene.eye[0]);
  glUniform3fv(at("to_light"), 1, &scene.to_light[0]);
}

void upload_texture(const PeerScene& scene) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, scene.texture_edge, scene.texture_edge, 0, GL_RGBA,
               GL_UNSIGNED_BYTE, scene.texture);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

void upload_mesh(const PeerScene& scene) {
  GLuint array = 0;
  std::array<GLuint, 4> buffer{};
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glGenBuffers(static_cast<GLsizei>(buffer.size()), buffer.data());
  const std::tuple<const void*, std::size_t, GLint> attributes[] = {
      {scene.position.data(), scene.position.size_bytes(), 3},
      {scene.normal.data(), scene.normal.size_bytes(), 3},
      {scene.uv.data(), scene.uv.size_bytes(), 2}};
  for (GLuint i = 0; i < 3; ++i) {
    const auto& [data, bytes, width] = attributes[i];
    glBindBuffer(GL_ARRAY_BUFFER, buffer[i]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), data, GL_STATIC_DRAW);
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, width, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer[3]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(scene.face.size_bytes()), scene.face.data(),
               GL_STATIC_DRAW);
}

// A framebuffer of one colour and one depth store; the bound one afterwards.
GLuint make_target(const PeerScene& scene, GLenum color, int samples) {
  GLuint frame = 0;
  std::array<GLuint, 2> store{};
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glGenRenderbuffers(2, store.data());
  const std::pair<GLenum, GLenum> parts[] = {{GL_COLOR_ATTACHMENT0, color},
                                             {GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F}};
  for (std::size_t i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, store[i]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples > 1 ? samples : 0, parts[i].second, scene.width,
                                     scene.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, parts[i].first, GL_RENDERBUFFER, store[i]);
  }
  require(glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE, "no complete framebuffer");
  return frame;
}

}  // namespace

struct Llvmpipe::Context {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  PeerScene scene{};
  GLsizei indices = 0;
  GLuint shaded = 0, numbered = 0;           // programs
  GLuint target = 0, averaged = 0, ids = 0;  // framebuffers; averaged: 0 with one sample a pixel

  Context() {
    setenv("GALLIUM_DRIVER", "llvmpipe", 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    require(get_display != nullptr, "EGL has no platform displays");
    display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    require(eglInitialize(display, nullptr, nullptr) != 0, "no display without a surface");
    eglBindAPI(EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                             EGL_NONE};
    EGLConfig config{};
    EGLint count = 0;
    require(eglChooseConfig(display, wanted, &config, 1, &count) != 0 && count > 0, "no configuration");
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    require(context != EGL_NO_CONTEXT, "no OpenGL 3.3");
    require(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != 0, "no current context");
  }
  ~Context() {
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
    eglTerminate(display);
  }
};

Llvmpipe::Llvmpipe(const PeerScene& scene) : context_(std::make_unique<Context>()) {
  Context& c = *context_;
  c.scene = scene;
  c.indices = static_cast<GLsizei>(3 * scene.face.size());
  c.shaded = linked(fragment_shader);
  c.numbered = linked(id_shader);
  upload_texture(scene);
  upload_mesh(scene);
  c.ids = make_target(scene, GL_R32UI, 1);
  if (scene.samples > 1) c.averaged = make_target(scene, GL_RGBA8, 1);
  c.target = make_target(scene, GL_RGBA8, scene.samples);
  use_program(c.shaded, scene);
  glViewport(0, 0, scene.width, scene.height);
  glEnable(GL_DEPTH_TEST);
  if (scene.cull) glEnable(GL_CULL_FACE);
  require(glGetError() == GL_NO_ERROR, "an OpenGL call failed");
}

Llvmpipe::~Llvmpipe() = default;

void Llvmpipe::frame() {
  const Context& c = *context_;
  const GLfloat background[4] = {0, 0, 0, 0}, farthest = 1;
  glClearBufferfv(GL_COLOR, 0, background);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  glDrawElements(GL_TRIANGLES, c.indices, GL_UNSIGNED_INT, nullptr);
  if (c.averaged != 0) {
    const int w = c.scene.width, h = c.scene.height;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, c.averaged);
    glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, c.target);
  }
  glFinish();
}

PeerVisibility Llvmpipe::visibility() {
  const Context& c = *context_;
  const auto pixels = static_cast<std::size_t>(c.scene.width) * static_cast<std::size_t>(c.scene.height);
  PeerVisibility seen{std::vector<std::uint32_t>(pixels), std::vector<float>(pixels)};
  const GLuint nothing[4] = {~0u, 0, 0, 0};
  const GLfloat farthest = 1;
  glBindFramebuffer(GL_FRAMEBUFFER, c.ids);
  use_program(c.numbered, c.scene);
  glClearBufferuiv(GL_COLOR, 0, nothing);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  glDrawElements(GL_TRIANGLES, c.indices, GL_UNSIGNED_INT, nullptr);
  glReadPixels(0, 0, c.scene.width, c.scene.height, GL_RED_INTEGER, GL_UNSIGNED_INT, seen.face.data());
  glReadPixels(0, 0, c.scene.width, c.scene.height, GL_DEPTH_COMPONENT, GL_FLOAT, seen.depth.data());
  glBindFramebuffer(GL_FRAMEBUFFER, c.target);
  use_program(c.shaded, c.scene);
  require(glGetError() == GL_NO_ERROR, "an OpenGL call failed");
  return seen;
}

std::string Llvmpipe::name() const { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

}  // namespace frustum::bench
