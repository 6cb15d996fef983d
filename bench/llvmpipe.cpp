#include "llvmpipe.h"

#define GL_GLEXT_PROTOTYPES 0
#include <GL/osmesa.h>
// After osmesa.h, which brings gl.h.
#include <GL/glext.h>

#include <algorithm>
#include <cstddef>

namespace bench {
namespace {

// OpenGL beyond 1.1 comes from the driver by name.
#define BENCH_GL_FUNCTIONS(X)                                      \
    X(PFNGLACTIVETEXTUREPROC, glActiveTexture)                     \
    X(PFNGLATTACHSHADERPROC, glAttachShader)                       \
    X(PFNGLBINDBUFFERPROC, glBindBuffer)                           \
    X(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer)                 \
    X(PFNGLBINDRENDERBUFFERPROC, glBindRenderbuffer)               \
    X(PFNGLBINDVERTEXARRAYPROC, glBindVertexArray)                 \
    X(PFNGLBUFFERDATAPROC, glBufferData)                           \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, glCheckFramebufferStatus)   \
    X(PFNGLCOMPILESHADERPROC, glCompileShader)                     \
    X(PFNGLCREATEPROGRAMPROC, glCreateProgram)                     \
    X(PFNGLCREATESHADERPROC, glCreateShader)                       \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, glEnableVertexAttribArray) \
    X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, glFramebufferRenderbuffer) \
    X(PFNGLGENBUFFERSPROC, glGenBuffers)                           \
    X(PFNGLGENERATEMIPMAPPROC, glGenerateMipmap)                   \
    X(PFNGLGENFRAMEBUFFERSPROC, glGenFramebuffers)                 \
    X(PFNGLGENRENDERBUFFERSPROC, glGenRenderbuffers)               \
    X(PFNGLGENVERTEXARRAYSPROC, glGenVertexArrays)                 \
    X(PFNGLGETPROGRAMIVPROC, glGetProgramiv)                       \
    X(PFNGLGETUNIFORMLOCATIONPROC, glGetUniformLocation)           \
    X(PFNGLLINKPROGRAMPROC, glLinkProgram)                         \
    X(PFNGLRENDERBUFFERSTORAGEPROC, glRenderbufferStorage)         \
    X(PFNGLSHADERSOURCEPROC, glShaderSource)                       \
    X(PFNGLUNIFORM1FPROC, glUniform1f)                             \
    X(PFNGLUNIFORM1IPROC, glUniform1i)                             \
    X(PFNGLUNIFORM3FVPROC, glUniform3fv)                           \
    X(PFNGLUNIFORMMATRIX4FVPROC, glUniformMatrix4fv)               \
    X(PFNGLUSEPROGRAMPROC, glUseProgram)                           \
    X(PFNGLVERTEXATTRIBPOINTERPROC, glVertexAttribPointer)

struct Functions {
#define BENCH_DECLARE(type, name) type name = nullptr;
    BENCH_GL_FUNCTIONS(BENCH_DECLARE)
#undef BENCH_DECLARE
    bool load() {
        bool all = true;
#define BENCH_LOAD(type, name)                                  \
    name = reinterpret_cast<type>(OSMesaGetProcAddress(#name)); \
    all = all && name != nullptr;
        BENCH_GL_FUNCTIONS(BENCH_LOAD)
#undef BENCH_LOAD
        return all;
    }
};

constexpr const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 tangent;
layout(location = 3) in vec2 uv;
uniform mat4 to_clip;
out vec3 world;
out vec3 n;
#ifdef MAPPED
out vec3 t;
flat out float turn;
out vec2 at;
#endif
void main() {
    gl_Position = to_clip * vec4(position, 1.0);
    world = position;
    n = normal;
#ifdef MAPPED
    t = tangent.xyz;
    turn = tangent.w;
    at = uv;
#endif
}
)";

constexpr const char* fragment_source = R"(#version 330 core
in vec3 world;
in vec3 n;
#ifdef MAPPED
in vec3 t;
flat in float turn;
in vec2 at;
uniform sampler2D diffuse_map;
uniform sampler2D normal_map;
#endif
uniform vec3 ambient, diffuse, specular, to_light, light, eye;
uniform float shininess;
out vec4 color;
void main() {
    vec3 albedo = diffuse;
    vec3 normal = n;
#ifdef MAPPED
    albedo *= texture(diffuse_map, at).rgb;
    vec3 m = texture(normal_map, at).xyz * 2.0 - 1.0;
    normal = t * m.x + cross(n, t) * turn * m.y + n * m.z;
#endif
    normal = normalize(normal);
    float n_l = max(dot(normal, to_light), 0.0);
    vec3 middle = normalize(to_light + normalize(eye - world));
    float highlight = n_l > 0.0 ? pow(max(dot(normal, middle), 0.0), shininess) : 0.0;
    color = vec4(albedo * ambient + light * (albedo * n_l + specular * highlight), 1.0);
}
)";

class OsMesa final : public Llvmpipe {
  public:
    ~OsMesa() override {
        if (context_ != nullptr) OSMesaDestroyContext(context_);
    }

    bool start(std::uint32_t width, std::uint32_t height, std::string& message) {
        width_ = width;
        height_ = height;
        const int wanted[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
        context_ = OSMesaCreateContextAttribs(wanted, nullptr);
        unused_.resize(16 * 16 * 4);
        if (context_ == nullptr ||
            !OSMesaMakeCurrent(context_, unused_.data(), GL_UNSIGNED_BYTE, 16, 16)) {
            message = "OSMesa gives no context of OpenGL 3.3";
            return false;
        }
        if (!gl_.load()) {
            message = "OSMesa lacks functions of OpenGL 3.3";
            return false;
        }
        // A framebuffer object, so that no frame is copied out to OSMesa's own buffer.
        GLuint framebuffer = 0, buffers[2] = {};
        gl_.glGenFramebuffers(1, &framebuffer);
        gl_.glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        gl_.glGenRenderbuffers(2, buffers);
        const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT32F};
        const GLenum places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
        for (int i = 0; i < 2; ++i) {
            gl_.glBindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
            gl_.glRenderbufferStorage(GL_RENDERBUFFER, formats[i], GLsizei(width), GLsizei(height));
            gl_.glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers[i]);
        }
        if (gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            message = "OSMesa gives no framebuffer object of RGBA8 with depth";
            return false;
        }
        glViewport(0, 0, GLsizei(width), GLsizei(height));
        programs_[0] = program("");
        programs_[1] = program("#define MAPPED\n");
        if (programs_[0] == 0 || programs_[1] == 0) message = "the shaders do not link";
        return programs_[0] != 0 && programs_[1] != 0;
    }

    void upload(const prep::VertexMesh& mesh, const prep::Image& diffuse,
                const prep::Image& normals) override {
        GLuint array = 0;
        gl_.glGenVertexArrays(1, &array);
        gl_.glBindVertexArray(array);
        attribute(0, 3, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
        attribute(1, 3, mesh.normals.data(), mesh.normals.size() * sizeof(glm::vec3));
        attribute(2, 4, mesh.tangents.data(), mesh.tangents.size() * sizeof(glm::vec4));
        attribute(3, 2, mesh.uvs[0].data(), mesh.uvs[0].size() * sizeof(glm::vec2));
        GLuint indices = 0;
        gl_.glGenBuffers(1, &indices);
        gl_.glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
        gl_.glBufferData(GL_ELEMENT_ARRAY_BUFFER,
                         GLsizeiptr(mesh.indices.size() * sizeof(std::uint32_t)),
                         mesh.indices.data(), GL_STATIC_DRAW);
        index_count_ = GLsizei(mesh.indices.size());
        texture(0, diffuse);
        texture(1, normals);
        glFinish();
    }

    void draw(const Surface& s) override {
        glEnable(GL_DEPTH_TEST);
        glEnable(GL_CULL_FACE);
        glClearColor(0, 0, 0, 0);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        const GLuint p = programs_[s.mapped ? 1 : 0];
        gl_.glUseProgram(p);
        const auto place = [&](const char* name) { return gl_.glGetUniformLocation(p, name); };
        gl_.glUniformMatrix4fv(place("to_clip"), 1, GL_FALSE, &s.to_clip[0][0]);
        gl_.glUniform3fv(place("ambient"), 1, &s.ambient[0]);
        gl_.glUniform3fv(place("diffuse"), 1, &s.diffuse[0]);
        gl_.glUniform3fv(place("specular"), 1, &s.specular[0]);
        gl_.glUniform3fv(place("to_light"), 1, &s.to_light[0]);
        gl_.glUniform3fv(place("light"), 1, &s.light[0]);
        gl_.glUniform3fv(place("eye"), 1, &s.eye[0]);
        gl_.glUniform1f(place("shininess"), s.shininess);
        gl_.glUniform1i(place("diffuse_map"), 0);
        gl_.glUniform1i(place("normal_map"), 1);
        glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
        glFinish();
    }

    std::vector<std::uint8_t> pixels() const override {
        const std::size_t row = std::size_t(width_) * 4;
        std::vector<std::uint8_t> bytes(row * height_);
        glReadPixels(0, 0, GLsizei(width_), GLsizei(height_), GL_RGBA, GL_UNSIGNED_BYTE,
                     bytes.data());
        for (std::size_t top = 0, bottom = height_ - 1; top < bottom; ++top, --bottom)
            std::swap_ranges(bytes.begin() + std::ptrdiff_t(top * row),
                             bytes.begin() + std::ptrdiff_t((top + 1) * row),
                             bytes.begin() + std::ptrdiff_t(bottom * row));
        return bytes;
    }

    std::string version() const override {
        const auto text = [](GLenum name) {
            const GLubyte* s = glGetString(name);
            return s == nullptr ? std::string() : reinterpret_cast<const char*>(s);
        };
        return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
    }

  private:
    void attribute(GLuint location, GLint components, const void* data, std::size_t bytes) {
        GLuint buffer = 0;
        gl_.glGenBuffers(1, &buffer);
        gl_.glBindBuffer(GL_ARRAY_BUFFER, buffer);
        gl_.glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(bytes), data, GL_STATIC_DRAW);
        gl_.glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, 0, nullptr);
        gl_.glEnableVertexAttribArray(location);
    }

    void texture(int unit, const prep::Image& image) {
        GLuint name = 0;
        glGenTextures(1, &name);
        gl_.glActiveTexture(GLenum(GL_TEXTURE0 + unit));
        glBindTexture(GL_TEXTURE_2D, name);
        std::vector<std::uint8_t> bytes;
        for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                bytes.push_back(std::uint8_t(image.pixels[i * image.channels + c] * 255.0f + 0.5f));
            bytes.push_back(255);
        }
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, GLsizei(image.width), GLsizei(image.height), 0,
                     GL_RGBA, GL_UNSIGNED_BYTE, bytes.data());
        gl_.glGenerateMipmap(GL_TEXTURE_2D);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }

    GLuint program(const char* define) {
        const GLuint p = gl_.glCreateProgram();
        const auto add = [&](GLenum kind, const char* source) {
            const std::string whole(source);
            const std::size_t first_line = whole.find('\n') + 1;
            const std::string text =
                whole.substr(0, first_line) + define + whole.substr(first_line);
            const char* pointer = text.c_str();
            const GLuint shader = gl_.glCreateShader(kind);
            gl_.glShaderSource(shader, 1, &pointer, nullptr);
            gl_.glCompileShader(shader);
            gl_.glAttachShader(p, shader);
        };
        add(GL_VERTEX_SHADER, vertex_source);
        add(GL_FRAGMENT_SHADER, fragment_source);
        gl_.glLinkProgram(p);
        GLint linked = 0;
        gl_.glGetProgramiv(p, GL_LINK_STATUS, &linked);
        return linked ? p : 0;
    }

    Functions gl_;
    OSMesaContext context_ = nullptr;
    std::vector<std::uint8_t> unused_;
    std::uint32_t width_ = 0, height_ = 0;
    GLuint programs_[2] = {};
    GLsizei index_count_ = 0;
};

}  // namespace

std::unique_ptr<Llvmpipe> Llvmpipe::make(std::uint32_t width, std::uint32_t height,
                                         std::string& message) {
    auto peer = std::make_unique<OsMesa>();
    if (!peer->start(width, height, message)) return nullptr;
    return peer;
}

}  // namespace bench
