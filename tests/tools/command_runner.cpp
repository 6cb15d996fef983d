#include "command_runner.h"

#include <fcntl.h>
#include <grp.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <sstream>

#include "meshprep/run.h"

extern char** environ;

namespace test {

std::filesystem::path command_path() {
    return MESHPREP_COMMAND;
}

Ran run_command(const std::vector<std::string>& arguments) {
    return run_program(command_path(), arguments);
}

Ran run_here(const std::vector<std::string>& arguments) {
    std::vector<const char*> argv{"meshprep"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    std::ostringstream out, err;
    Ran ran;
    ran.exit_code =
        meshprep::run(static_cast<int>(argv.size()), argv.data(), out, err, /*terminal*/ false);
    ran.out = out.str();
    ran.err = err.str();
    return ran;
}

std::vector<std::optional<unsigned>> users() {
    std::vector<std::optional<unsigned>> list{std::nullopt};
    if (::geteuid() == 0) list.push_back(65534);  // nobody
    return list;
}

namespace {

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (std::string& text : texts) list.push_back(text.data());
    list.push_back(nullptr);
    return list;
}

// In the new process; what fails here ends it with a code that the command does not have.
[[noreturn]] void become(int program, const Circumstances& c, const std::string& out,
                         const std::string& err, char* const* argv, char* const* variables) {
    const auto expect = [](bool good) {
        if (!good) ::_exit(120);
    };
    const auto open_as = [&](int as, const std::string& path, int flags) {
        const int file = ::open(path.c_str(), flags, 0600);
        expect(file >= 0 && (file == as || (::dup2(file, as) == as && ::close(file) == 0)));
    };
    open_as(0, c.in, O_RDONLY);
    open_as(1, out, O_WRONLY | O_CREAT);
    open_as(2, err, O_WRONLY | O_CREAT);
    if (c.out && c.out->empty()) expect(::close(1) == 0);
    for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGXFSZ, SIGPIPE})
        expect(::signal(number, SIG_DFL) != SIG_ERR);
    for (const int number : c.ignored_signals) expect(::signal(number, SIG_IGN) != SIG_ERR);
    const auto limit = [&](auto what, std::uint64_t bytes) {
        const rlimit wanted{bytes, bytes};
        expect(bytes == 0 || ::setrlimit(what, &wanted) == 0);
    };
    limit(RLIMIT_FSIZE, c.largest_file);
    limit(RLIMIT_AS, c.memory);
    if (c.user)
        expect(::setgroups(0, nullptr) == 0 && ::setgid(*c.user) == 0 && ::setuid(*c.user) == 0);
    ::fexecve(program, argv, variables);
    ::_exit(121);
}

}  // namespace

Ran run_command(const std::vector<std::string>& arguments, const Circumstances& circumstances) {
    const TempDir directory;
    const bool elsewhere = circumstances.out && !circumstances.out->empty();
    const std::string out = elsewhere ? circumstances.out->string() : (directory / "out").string();
    const std::string err = (directory / "err").string();
    std::vector<std::string> words{command_path().string()}, variables;
    words.insert(words.end(), arguments.begin(), arguments.end());
    for (char** at = environ; *at; ++at) {
        const std::string variable = *at;
        const auto& given = circumstances.environment;
        if (std::none_of(given.begin(), given.end(), [&](const auto& entry) {
                return variable.rfind(entry.first + "=", 0) == 0;
            }))
            variables.push_back(variable);
    }
    for (const auto& [name, value] : circumstances.environment)
        variables.push_back(name + "=" + value);
    const std::vector<char*> argv = pointers_to(words), envp = pointers_to(variables);
    // Opened here: another user may not get to where the command stands.
    const int program = ::open(command_path().c_str(), O_RDONLY | O_CLOEXEC);
    const pid_t pid = ::fork();
    if (pid == 0) become(program, circumstances, out, err, argv.data(), envp.data());
    Ran ran;
    int status = 0;
    if (pid > 0 && ::waitpid(pid, &status, 0) == pid)
        ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    ::close(program);
    if (!elsewhere) ran.out = file_text(out);
    ran.err = file_text(err);
    return ran;
}

Ran run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
    const TempDir directory;
    const std::string out = (directory / "out").string(), err = (directory / "err").string();
    std::vector<char*> argv;
    std::string binary = program.string();
    argv.push_back(binary.data());
    std::vector<std::string> copies = arguments;
    for (std::string& argument : copies) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
    pid_t pid = 0;
    Ran ran;
    if (posix_spawn(&pid, binary.c_str(), &actions, nullptr, argv.data(), environ) == 0) {
        int status = 0;
        waitpid(pid, &status, 0);
        ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    posix_spawn_file_actions_destroy(&actions);
    ran.out = file_text(out);
    ran.err = file_text(err);
    return ran;
}

std::string base64_of(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : bytes) {
        bits = bits << 8 | static_cast<unsigned char>(c);
        for (held += 8; held >= 6; held -= 6) text += digits[bits >> (held - 6) & 63];
    }
    if (held > 0) text += digits[bits << (6 - held) & 63];
    while (text.size() % 4 != 0) text += '=';
    return text;
}

std::string json_quoted(const std::string& text) {
    return nlohmann::json(text).dump();
}

std::size_t GltfText::accessor(const void* bytes, std::size_t size, std::size_t count, int type,
                               const std::string& kind, const std::string& more) {
    const std::string comma = accessor_count_ > 0 ? "," : "", number = std::to_string(size);
    buffers_ += comma + R"({"uri":"data:application/octet-stream;base64,)" +
                base64_of(std::string(static_cast<const char*>(bytes), size)) +
                R"(","byteLength":)" + number + "}";
    views_ += comma + R"({"buffer":)" + std::to_string(accessor_count_) + R"(,"byteLength":)" +
              number + "}";
    accessors_ += comma + R"({"bufferView":)" + std::to_string(accessor_count_) +
                  R"(,"componentType":)" + std::to_string(type) + R"(,"count":)" +
                  std::to_string(count) + R"(,"type":")" + kind + "\"" + more + "}";
    return accessor_count_++;
}

std::size_t GltfText::add_scalars(const std::vector<float>& values) {
    return accessor(values.data(), values.size() * 4, values.size(), 5126, "SCALAR",
                    R"(,"min":[)" + nlohmann::json(values.front()).dump() + R"(],"max":[)" +
                        nlohmann::json(values.back()).dump() + "]");
}

void GltfText::add(const Primitive& p) {
    const std::string comma = count_ > 0 ? "," : "", number = std::to_string(count_);
    std::string low, high;
    for (std::size_t k = 0; k < 3; ++k) {
        float least = p.positions[k], most = least;
        for (std::size_t i = k; i < p.positions.size(); i += 3) {
            least = std::min(least, p.positions[i]);
            most = std::max(most, p.positions[i]);
        }
        low += (k > 0 ? "," : "") + nlohmann::json(least).dump();
        high += (k > 0 ? "," : "") + nlohmann::json(most).dump();
    }
    std::string attributes;
    const auto layer = [&](const char* name, const std::vector<float>& values, std::size_t width,
                           const std::string& more) {
        if (values.empty()) return;
        const std::size_t at = accessor(values.data(), values.size() * 4, values.size() / width,
                                        5126, "VEC" + std::to_string(width), more);
        attributes +=
            (attributes.empty() ? "\"" : ",\"") + std::string(name) + "\":" + std::to_string(at);
    };
    layer("POSITION", p.positions, 3, R"(,"min":[)" + low + R"(],"max":[)" + high + "]");
    layer("NORMAL", p.normals, 3, "");
    layer("TEXCOORD_0", p.uvs, 2, "");
    layer("TANGENT", p.tangents, 4, "");
    const std::size_t indices =
        accessor(p.indices.data(), p.indices.size() * 4, p.indices.size(), 5125, "SCALAR", "");
    meshes_ += comma + R"({"name":)" + json_quoted(p.name) + R"(,"primitives":[{"attributes":{)" +
               attributes + R"(},"indices":)" + std::to_string(indices) +
               (p.more.empty() ? "" : "," + p.more) + "}]}";
    nodes_ += comma + R"({"mesh":)" + number + (p.node.empty() ? "" : "," + p.node) + "}";
    roots_ += comma + number;
    ++count_;
}

std::string GltfText::text(const std::string& more) const {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[)" + roots_ +
           R"(]}],"nodes":[)" + nodes_ + R"(],"meshes":[)" + meshes_ + R"(],"accessors":[)" +
           accessors_ + R"(],"bufferViews":[)" + views_ + R"(],"buffers":[)" + buffers_ + "]" +
           (more.empty() ? "" : "," + more) + "}";
}

namespace {

constexpr const char* cube_vertices =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
constexpr int cube_faces[6][4] = {{4, 3, 2, 1}, {5, 6, 7, 8}, {1, 2, 6, 5},
                                  {2, 3, 7, 6}, {3, 4, 8, 7}, {4, 1, 5, 8}};

}  // namespace

std::string cube_obj() {
    std::ostringstream text;
    text << cube_vertices;
    for (const auto& f : cube_faces)
        text << "f " << f[0] << ' ' << f[1] << ' ' << f[2] << ' ' << f[3] << '\n';
    return text.str();
}

std::string textured_cube_obj() {
    std::ostringstream text;
    text << cube_vertices << "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    for (const auto& f : cube_faces)
        text << "f " << f[0] << "/1 " << f[1] << "/2 " << f[2] << "/3 " << f[3] << "/4\n";
    return text.str();
}

std::string sphere_obj(int segments, int rings) {
    std::ostringstream text;
    text.precision(9);
    for (int j = 0; j <= rings; ++j) {
        for (int i = 0; i <= segments; ++i) {
            const double a = 2 * std::numbers::pi * (i % segments) / segments;
            const double b = std::numbers::pi * j / rings;
            const double r = j == 0 || j == rings ? 0 : std::sin(b);
            text << "v " << r * std::cos(a) << ' ' << std::cos(b) << ' ' << -r * std::sin(a)
                 << "\nvt " << double(i) / segments << ' ' << 1 - double(j) / rings << '\n';
        }
    }
    const auto at = [&](int i, int j) {
        // The seam's and the poles' vertices are shared; their UVs are not.
        const int v = j == 0       ? 0
                      : j == rings ? rings * (segments + 1)
                                   : j * (segments + 1) + i % segments;
        return std::to_string(v + 1) + "/" + std::to_string(j * (segments + 1) + i + 1);
    };
    for (int j = 0; j < rings; ++j)
        for (int i = 0; i < segments; ++i) {
            text << "f " << at(i, j) << ' ' << at(i, j + 1);
            if (j + 1 < rings) text << ' ' << at(i + 1, j + 1);
            if (j > 0) text << ' ' << at(i + 1, j);
            text << '\n';
        }
    return text.str();
}

}  // namespace test
