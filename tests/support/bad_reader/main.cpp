// A reader that does what the name of its file says, so that every way to go wrong is there at
// will.
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <optional>
#include <thread>

#include "contained/messages.h"
#include "contained/scene_bytes.h"
#include "reader/serve.h"

namespace {

using namespace prep::detail;

void say(const void* bytes, std::size_t size) {
    send_all(reader_socket, bytes, size);
}

prep::Scene one_node() {
    prep::Scene scene;
    scene.nodes.emplace_back().name = "n";
    return scene;
}

// What goes wrong outside of what it reads.
void go_wrong(const std::string& what) {
    const std::vector<std::byte> scene = scene_bytes(one_node());
    MessageHeader header = message_header(MessageKind::scene, scene.size());
    if (what == "half") {
        say(&header, sizeof header);
        say(scene.data(), scene.size() / 2);
        ::raise(SIGKILL);
    } else if (what == "half-header") {
        say(&header, 7);
        ::_exit(0);
    } else if (what == "stalls") {
        say(&header, sizeof header);
        std::this_thread::sleep_for(std::chrono::hours(1));
    } else if (what == "lies") {  // about how much follows
        header.size = std::uint64_t(1) << 60;
        say(&header, sizeof header);
        std::this_thread::sleep_for(std::chrono::hours(1));
    } else if (what == "other-build") {
        header.build ^= 1;
        say(&header, sizeof header);
        say(scene.data(), scene.size());
    } else if (what == "nonsense") {
        std::vector<std::byte> bytes(scene.size(), std::byte(0xff));
        say(&header, sizeof header);
        say(bytes.data(), bytes.size());
    } else if (what == "no-message") {
        header.kind = MessageKind(77);
        say(&header, sizeof header);
        say(scene.data(), scene.size());
    } else if (what == "closes") {  // and lives on
        ::shutdown(reader_socket, SHUT_WR);
        std::this_thread::sleep_for(std::chrono::hours(1));
    }
}

std::vector<char*> kept;

// What goes wrong while it reads; an error where it ends with one.
std::optional<prep::Error> read_badly(const std::string& format,
                                      const std::filesystem::path& path) {
    const std::string what = path.stem().string();
    go_wrong(what);
    if (what == "segv") ::raise(SIGSEGV);
    if (what == "abort") std::abort();
    if (what == "exit") ::_exit(3);
    if (what == "hangs") std::this_thread::sleep_for(std::chrono::hours(1));
    if (what == "spins")
        for (volatile bool on = true; on;) {
        }
    if (what == "eats")
        for (;;) kept.push_back(new char[1 << 24]);
    if (what == "eats-politely") try {
            for (;;) kept.push_back(new char[1 << 24]);
        } catch (const std::bad_alloc&) {
            for (char* const block : kept) delete[] block;
            kept.clear();
            return prep::Error{prep::ErrorCode::syntax, "std::bad_alloc", path.string()};
        }
    if (what == "prints") {
        std::puts("to stdout");
        std::fputs("to stderr\n", stderr);
    }
    if (what == "floods")
        for (int i = 0; i < 100000; ++i) std::printf("line %d of a long story\n", i);
    if (what == "floods-for-ever")
        for (;;) std::puts("and on it goes");
    if (what == "writes") std::ofstream(path.parent_path() / "written") << "text";
    // Harm that shows with the next file only.
    static bool harmed = false;
    if (what == "harms") harmed = true;
    if (what == "suffers" && harmed) ::raise(SIGSEGV);
    if (what == "error")
        return prep::Error{prep::ErrorCode::syntax, "an error of the reader of " + format,
                           path.string()};
    return std::nullopt;
}

prep::Result<prep::Scene> load(const std::string& format, const std::filesystem::path& path,
                               const prep::LoadOptions& options) {
    const std::string what = path.stem().string();
    if (auto error = read_badly(format, path)) return *std::move(error);
    prep::Scene scene = one_node();
    scene.name = what;
    scene.source_bytes = std::uint64_t(options.threads);
    if (what == "out-of-range") scene.nodes[0].mesh = 5;
    return scene;
}

// 2 × 1 texels of four channels, of which "no-texels" has lost some.
prep::Result<prep::Image> load_picture(const std::filesystem::path& path,
                                       prep::ImageChannels channels) {
    if (auto error = read_badly("pictures", path)) return *std::move(error);
    prep::Image image;
    image.width = 2;
    image.height = 1;
    image.channels = 4;
    image.pixels = {0, 0.25f, 0.5f, 1, 1, 0.5f, 0.25f, 0};
    if (channels == prep::ImageChannels::all) image.channel_names = {"R", "G", "B", "A"};
    if (path.stem() == "no-texels") image.pixels.resize(3);
    return image;
}

}  // namespace

int main() {
    reader::serve(load, load_picture);
}
