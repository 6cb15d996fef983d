// The command in a bad world: signals at the worst moments, full disks, renames that fail, standard
// output that cannot be written. Files appear complete or not at all, old ones stay as they were,
// nothing is left beside them, and the exit code says it. See world/world_faults.cpp.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <map>

#include "command_runner.h"
#include "sanitized.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::TempDir;
using test::write_text;
using Variables = std::vector<std::pair<std::string, std::string>>;
using Files = std::map<std::string, std::string>;  // names and what they hold

Files files_in(const fs::path& directory) {
    Files files;
    for (const auto& entry : fs::directory_iterator(directory))
        files[entry.path().filename().string()] = file_text(entry.path());
    return files;
}

const char* const material = "newmtl red\nKd 1 0 0\n";

// A directory for outputs, in a world that can be troubled; the input stands in another.
class World {
  public:
    World() {
        write_text(in_ / "ball.obj", "mtllib red.mtl\nusemtl red\n" + test::sphere_obj(8, 4));
        write_text(in_ / "red.mtl", material);
        // For other users: the library stands where they can read it, and they may write here.
        fs::copy_file(WORLD_FAULTS, in_ / "faults.so");
        ::chmod(in_.path().c_str(), 0755);
        ::chmod(out_.path().c_str(), 0777);
        for (const auto& entry : fs::directory_iterator(in_.path()))
            ::chmod(entry.path().c_str(), 0755);
    }
    const fs::path& out() const { return out_.path(); }
    std::string input() const { return (in_ / "ball.obj").string(); }

    // What the old files of these names hold, set anew.
    Files set(const std::vector<std::string>& old_files) const {
        for (const auto& entry : fs::directory_iterator(out())) fs::remove_all(entry.path());
        for (const std::string& name : old_files) write_text(out() / name, "old " + name);
        return files_in(out());
    }
    std::vector<std::string> prepare(const std::string& name) const {
        return {"prepare", input(), "-o", (out() / name).string()};
    }
    test::Ran run(const std::vector<std::string>& arguments, const Variables& troubles,
                  const std::optional<unsigned>& user = {}, const std::vector<int>& ignored = {},
                  const fs::path& in = "/dev/null") const {
        const char* options = std::getenv("ASAN_OPTIONS");
        Variables variables{
            {"LD_PRELOAD", (in_ / "faults.so").string()},
            {"WORLD_DIR", fs::canonical(out()).string()},
            // The library has to come before the sanitizer's.
            {"ASAN_OPTIONS",
             (options ? options + std::string(":") : std::string()) + "verify_asan_link_order=0"}};
        variables.insert(variables.end(), troubles.begin(), troubles.end());
        test::Circumstances circumstances;
        circumstances.environment = variables;
        circumstances.user = user;
        circumstances.ignored_signals = ignored;
        circumstances.in = in;
        return test::run_command(arguments, circumstances);
    }

  private:
    TempDir in_, out_;
};

std::string as(const std::optional<unsigned>& user) {
    return user ? "as user " + std::to_string(*user) : "as oneself";
}

struct Outputs {
    std::string name;                // what -o says
    std::vector<std::string> files;  // what is written
};
const std::vector<Outputs> outputs{{"a.glb", {"a.glb"}},
                                   {"a.gltf", {"a.bin", "a.gltf"}},
                                   {"a.obj", {"a.mtl", "a.obj"}},
                                   {"a.ply", {"a.ply"}}};

std::vector<std::string> names_of(const Files& files) {
    std::vector<std::string> names;
    for (const auto& [name, text] : files) names.push_back(name);
    return names;
}

// The number of writes is not known here: each is interrupted in turn until there are no more.
TEST(World, AnInterruptWhileWritingLeavesTheOldFilesAndNothingBesideThem) {
    const World world;
    for (const auto& user : test::users())
        for (const Outputs& output : outputs) {
            if (user && output.files.size() == 1) continue;
            const int signals[] = {SIGINT, SIGTERM, SIGHUP};
            const Files old = world.set(output.files);
            for (int n = 1;; ++n) {
                const int signal = signals[n % 3];
                SCOPED_TRACE(output.name + ", write " + std::to_string(n) + ", " + as(user));
                ASSERT_LT(n, 50);
                const test::Ran ran = world.run(world.prepare(output.name),
                                                {{"WORLD_AT", "write:" + std::to_string(n)},
                                                 {"WORLD_SIGNAL", std::to_string(signal)}},
                                                user);
                if (ran.exit_code == 0) {
                    EXPECT_GT(n, int(output.files.size()));  // each file is written
                    break;
                }
                ASSERT_EQ(ran.exit_code, 128 + signal) << ran.err;
                ASSERT_EQ(files_in(world.out()), old);
            }
        }
}

// Between two renames one file is new and the other old: an interrupt waits until both are new.
TEST(World, AnInterruptAmongRenamesLeavesAllFilesNewOrAllOld) {
    const World world;
    for (const Outputs& output : outputs)
        for (const bool exist : {true, false}) {
            const std::vector<std::string> none;
            world.set(none);
            ASSERT_EQ(world.run(world.prepare(output.name), {}).exit_code, 0);
            const Files fresh = files_in(world.out());
            ASSERT_EQ(names_of(fresh), output.files);
            for (const std::string what : {"link", "rename", "unlink"})
                for (std::size_t n = 1; n <= output.files.size(); n += test::sanitized ? 2 : 1) {
                    SCOPED_TRACE(output.name + ", " + what + " " + std::to_string(n));
                    const Files old = world.set(exist ? output.files : none);
                    const test::Ran ran = world.run(world.prepare(output.name),
                                                    {{"WORLD_AT", what + ":" + std::to_string(n)},
                                                     {"WORLD_SIGNAL", std::to_string(SIGINT)}});
                    // What comes too late changes nothing.
                    EXPECT_TRUE(ran.exit_code == 0 || ran.exit_code == 128 + SIGINT) << ran.err;
                    const Files now = files_in(world.out());
                    EXPECT_EQ(names_of(now), names_of(now == old ? old : fresh));
                    EXPECT_TRUE(now == old || now == fresh);
                }
        }
}

TEST(World, SignalsThatAreIgnoredStayIgnored) {
    const World world;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        world.set({});
        const test::Ran ran = world.run(world.prepare("a.glb"),
                                        {{"WORLD_AT", "write:1"},
                                         {"WORLD_SIGNAL", std::to_string(signal)},
                                         {"WORLD_GO_ON", "1"}},
                                        {}, {signal});
        EXPECT_EQ(ran.exit_code, 0) << signal << ran.err;
        EXPECT_EQ(names_of(files_in(world.out())), std::vector<std::string>{"a.glb"}) << signal;
    }
}

// Room for these parts of what is written, and for all of it but one byte.
void expect_full_disk_is_told(const World& world, const std::vector<std::string>& arguments,
                              const std::vector<std::string>& written, const std::string& says,
                              const std::vector<double>& parts,
                              const std::optional<unsigned>& user) {
    world.set({});
    const test::Ran whole = world.run(arguments, {}, user);
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    const Files fresh = files_in(world.out());
    ASSERT_EQ(names_of(fresh), written);
    std::size_t total = 0;
    for (const auto& [name, text] : fresh) total += text.size();
    std::vector<std::size_t> rooms{total - 1};
    for (const double part : parts) rooms.push_back(std::size_t(double(total) * part));
    const Files old = world.set(written);
    for (const std::size_t room : rooms) {
        SCOPED_TRACE(std::to_string(room) + " of " + std::to_string(total) + " bytes");
        const test::Ran ran = world.run(arguments, {{"WORLD_SPACE", std::to_string(room)}}, user);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.err.find(says), std::string::npos) << ran.err;
        ASSERT_EQ(files_in(world.out()), old);
    }
}

TEST(World, AFullDiskIsToldAndLeavesTheOldFiles) {
    const World world;
    for (const auto& user : test::users())
        for (const Outputs& output :
             {Outputs{"a.gltf", {"a.bin", "a.gltf"}}, Outputs{"a.obj", {"a.mtl", "a.obj"}},
              Outputs{"a.glb", {"a.glb"}}, Outputs{"a.ply", {"a.ply"}}, Outputs{"a.stl", {"a.stl"}},
              Outputs{"a.off", {"a.off"}}}) {
            SCOPED_TRACE(output.name + ", " + as(user));
            expect_full_disk_is_told(
                world, world.prepare(output.name), output.files, "No space left on device",
                test::sanitized ? std::vector<double>{0.7} : std::vector<double>{0, 0.3, 0.7},
                user);
            if (user) break;
        }
}

TEST(World, AFullDiskIsToldOfPictures) {
    const World world;
    const auto render = [&](const std::string& name) {
        return std::vector<std::string>{
            "render", world.input(), "-o", (world.out() / name).string(), "--size", "40x30"};
    };
    std::vector<std::string> several = render("a.png");
    several.insert(several.end(), {"--buffers", "depth"});
    expect_full_disk_is_told(world, several, {"a.depth.exr", "a.png"},
                             "the image cannot be written", {}, {});
    // libtiff writes most of a small picture when it closes it, and says nothing of what goes
    // wrong: at a third there is a directory with nothing in it.
    expect_full_disk_is_told(world, render("a.tif"), {"a.tif"}, "the image cannot be written",
                             {1.0 / 3}, {});
}

TEST(World, WritesInPiecesAndInterruptedOnesAreWhole) {
    const World world;
    for (const Outputs& output : outputs) {
        SCOPED_TRACE(output.name);
        world.set({});
        ASSERT_EQ(world.run(world.prepare(output.name), {}).exit_code, 0);
        const Files fresh = files_in(world.out());
        world.set({});
        const test::Ran ran = world.run(world.prepare(output.name), {{"WORLD_PIECES", "1"}});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(files_in(world.out()), fresh);
    }
}

// Network file systems may keep what is wrong until the file is closed.
TEST(World, AnErrorOnClosingIsTold) {
    const World world;
    for (const Outputs& output : outputs)
        for (std::size_t n = 1; n <= output.files.size(); ++n) {
            SCOPED_TRACE(output.name + ", close " + std::to_string(n));
            const Files old = world.set(output.files);
            const test::Ran ran =
                world.run(world.prepare(output.name), {{"WORLD_CLOSE", std::to_string(n)}});
            EXPECT_EQ(ran.exit_code, 1);
            EXPECT_NE(ran.err.find("Input/output error"), std::string::npos) << ran.err;
            EXPECT_EQ(files_in(world.out()), old);
        }
}

// A zip file of one entry that is not packed, from PKWARE's description.
std::string stored_zip(const std::string& name, const std::string& text) {
    const auto little = [](std::uint64_t value, int bytes) {
        std::string out;
        for (int k = 0; k < bytes; ++k) out += char(value >> 8 * k & 255);
        return out;
    };
    const auto size = std::uint32_t(text.size()), length = std::uint32_t(name.size());
    const auto crc =
        std::uint32_t(::crc32(0, reinterpret_cast<const Bytef*>(text.data()), uInt(size)));
    const std::string common = little(20, 2) + little(0, 8) + little(crc, 4) + little(size, 4) +
                               little(size, 4) + little(length, 2) + little(0, 2);
    const std::string entry = little(0x02014b50, 4) + little(20, 2) + common + little(0, 2 * 3) +
                              little(0, 4) + little(0, 4) + name;
    const std::string file = little(0x04034b50, 4) + common + name + text;
    return file + entry + little(0x06054b50, 4) + little(0, 4) + little(1, 2) + little(1, 2) +
           little(std::uint32_t(entry.size()), 4) + little(std::uint32_t(file.size()), 4) +
           little(0, 2);
}

TEST(World, AnErrorOnClosingWhatIsReadByWayOfAFileIsTold) {
    const World world;
    const fs::path in = fs::path(world.input()).parent_path();
    const std::string obj = file_text(world.input());
    gzFile packed = ::gzopen((in / "p.obj.gz").c_str(), "wb");
    ASSERT_EQ(::gzwrite(packed, obj.data(), unsigned(obj.size())), int(obj.size()));
    ASSERT_EQ(::gzclose(packed), Z_OK);
    write_text(in / "p.zip", stored_zip("p.obj", obj));
    for (const char* const name : {"p.obj.gz", "p.zip", "-"}) {
        const std::string input = *name == '-' ? "-" : (in / name).string();
        const auto run = [&](const Variables& more) {
            Variables troubles{{"TMPDIR", world.out().string()}};
            troubles.insert(troubles.end(), more.begin(), more.end());
            return world.run({"inspect", input}, troubles, {}, {}, world.input());
        };
        EXPECT_EQ(run({}).exit_code, 0) << name;
        const test::Ran ran = run({{"WORLD_CLOSE", "1"}});
        EXPECT_EQ(ran.exit_code, 1) << name;
        EXPECT_NE(ran.err.find("Input/output error"), std::string::npos) << name << ran.err;
    }
}

// A triangle with a texture that stands in the file, for formats that write it as a file of its
// own.
const char* const textured = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
"nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1},
"material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
"textures": [{"source": 0}], "images": [{"mimeType": "image/png", "bufferView": 2}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
"min": [0, 0, 0], "max": [1, 1, 0]}, {"bufferView": 1, "componentType": 5126, "count": 3,
"type": "VEC2"}], "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 0,
"byteLength": 24}, {"buffer": 0, "byteOffset": 36, "byteLength": 8}], "buffers": [{"byteLength": 44,
"uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAiVBORw0KGgo="}]})";

// Old files of all outputs, of none, and of one alone; with hard links and without.
TEST(World, AFailedRenameUndoesTheEarlierOnes) {
    const World world;
    const TempDir in;
    write_text(in / "t.gltf", textured);
    ::chmod(in.path().c_str(), 0755);
    const std::string obj = (world.out() / "a.obj").string();
    struct Case {
        std::vector<std::string> arguments, files;
        std::vector<std::vector<std::string>> old;
    };
    const std::vector<Case> cases{
        {world.prepare("a.gltf"), {"a.bin", "a.gltf"}, {{"a.bin", "a.gltf"}, {"a.gltf"}}},
        {{"prepare", (in / "t.gltf").string(), "-o", obj},
         {"a.mtl", "a.obj", "a_image0.png"},
         {{"a.mtl", "a.obj", "a_image0.png"}, {}, {"a.mtl"}}}};
    for (const auto& user : test::users())
        for (const Case& c : cases) {
            for (const auto& exist : c.old)
                for (const char* links : {"1", "0"}) {
                    if (test::sanitized && user && *links == '1') continue;
                    for (std::size_t n = 1; n <= c.files.size(); ++n) {
                        std::string trace = "rename " + std::to_string(n) + ", links " + links +
                                            ", " + as(user) + ", old:";
                        for (const std::string& name : exist) trace += " " + name;
                        SCOPED_TRACE(trace);
                        const Files old = world.set(exist);
                        const test::Ran ran = world.run(
                            c.arguments,
                            {{"WORLD_RENAME", std::to_string(n)}, {"WORLD_LINKS", links}}, user);
                        EXPECT_EQ(ran.exit_code, 1);
                        EXPECT_NE(ran.err.find("Input/output error"), std::string::npos) << ran.err;
                        EXPECT_EQ(files_in(world.out()), old);
                    }
                }
            world.set({});
            EXPECT_EQ(world.run(c.arguments, {}, user).exit_code, 0);
            EXPECT_EQ(names_of(files_in(world.out())), c.files);
        }
}

TEST(World, WithoutHardLinksOutputsAreReplacedAllTheSame) {
    const World world;
    for (const Outputs& output : outputs) {
        SCOPED_TRACE(output.name);
        world.set({});
        ASSERT_EQ(world.run(world.prepare(output.name), {}).exit_code, 0);
        const Files fresh = files_in(world.out());
        world.set(output.files);
        const test::Ran ran = world.run(world.prepare(output.name), {{"WORLD_LINKS", "0"}});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(files_in(world.out()), fresh);
    }
}

// The watcher of signals is a thread, too.
TEST(World, FilesAreDoneByTheThreadsThereAre) {
    const World world;
    std::vector<std::string> words{"prepare"};
    for (const char* const name : {"a", "b", "c"}) {
        const fs::path copy = fs::path(world.input()).parent_path() / (name + std::string(".obj"));
        fs::copy_file(world.input(), copy);
        words.push_back(copy.string());
    }
    words.insert(words.end(), {"-o", world.out().string() + "/", "--threads", "1"});
    world.set({});
    ASSERT_EQ(world.run(words, {}).exit_code, 0);
    const Files whole = files_in(world.out());
    ASSERT_EQ(names_of(whole), (std::vector<std::string>{"a.glb", "b.glb", "c.glb"}));
    words.insert(words.end(), {"--jobs", "3"});
    for (int threads = 0; threads <= 4; ++threads) {
        world.set({});
        const test::Ran ran = world.run(words, {{"WORLD_THREADS", std::to_string(threads)}});
        EXPECT_EQ(ran.exit_code, 0) << threads << ": " << ran.err;
        EXPECT_EQ(ran.err, "") << threads;
        EXPECT_EQ(files_in(world.out()), whole) << threads;
    }
}

// Whenever the edit comes, before the input is loaded or hashed or in between: the next run makes
// of it what a first run would.
TEST(World, WhatIsEditedWhileItIsReadIsDoneAgain) {
    const World world;
    const fs::path in = world.input();
    const std::string original = file_text(in);
    std::vector<std::string> words = world.prepare("a.glb");
    const fs::path manifest = in.parent_path() / "made.json";
    words.insert(words.end(), {"--manifest", manifest.string(), "--skip-unchanged"});
    world.set({});
    ASSERT_EQ(world.run(words, {}).exit_code, 0);
    const Files plain = files_in(world.out());
    int edits = 0, between = 0;
    std::string edited;
    for (bool more = true; more; ++edits) {
        fs::remove(manifest);
        world.set({});
        write_text(in, original);
        ASSERT_EQ(world
                      .run(words, {{"WORLD_EDIT", in.string()},
                                   {"WORLD_EDIT_AT", std::to_string(edits + 1)}})
                      .exit_code,
                  0);
        more = file_text(in) != original;
        if (!more) break;
        between += files_in(world.out()) == plain;
        ASSERT_EQ(world.run(words, {}).exit_code, 0);
        const std::string now = files_in(world.out()).at("a.glb");
        EXPECT_NE(now, plain.at("a.glb")) << edits;
        if (edited.empty()) edited = now;
        EXPECT_EQ(now, edited) << edits;
    }
    EXPECT_GE(edits, 2);
    EXPECT_GE(between, 1);
}

}  // namespace
