// Readers in a process of their own: whatever happens there, the caller gets an error and goes on.
// tests/support/bad_reader goes wrong in every way; real files are read with and without.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "contained/sanitized.h"
#include "contained/scene_bytes.h"
#include "invariants.h"
#include "mesh_files.h"
#include "prep/formats.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

std::size_t open_files() {
    return std::size_t(std::distance(fs::directory_iterator("/proc/self/fd"), {}));
}

// A folder of files that the bad reader is asked for by name, as FBX.
class BadReader {
  public:
    explicit BadReader(double seconds = 20, std::uint64_t memory = std::uint64_t(1) << 30) {
        prep::ReaderProcessOptions limits;
        limits.program = MESHPREP_BAD_READER;
        limits.seconds = seconds;
        limits.memory = memory;
        options_.reader_process = std::make_shared<prep::ReaderProcess>(limits);
        options_.reader_log = [this](const fs::path& file, std::string_view text) {
            log += file.stem().string() + ": " + std::string(text);
        };
    }
    prep::Result<prep::Scene> read(const std::string& what) {
        test::write_text(dir / (what + ".fbx"), "x");
        return prep::load_scene(dir / (what + ".fbx"), options_);
    }
    std::string error_of(const std::string& what) {
        const auto scene = read(what);
        if (scene) return "no error";
        EXPECT_EQ(scene.error().place, (dir / (what + ".fbx")).string());
        return scene.error().text;
    }
    bool reads_on() { return read("good").has_value(); }
    std::size_t started() const { return options_.reader_process->started(); }

    test::TempDir dir;
    std::string log;

  private:
    prep::LoadOptions options_;
};

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Contained, ACrashIsAnErrorWithFileReaderAndSignal) {
    BadReader reader;
    for (const auto& [what, how] : {std::pair{"segv", "SIGSEGV"},
                                    {"abort", "SIGABRT"},
                                    {"exit", "exit code 3"},
                                    {"half", "SIGKILL"},
                                    {"half-header", "exit code 0"}}) {
        SCOPED_TRACE(what);
        const auto scene = reader.read(what);
        ASSERT_FALSE(scene.has_value());
        EXPECT_EQ(scene.error().code, prep::ErrorCode::unsupported);
        EXPECT_EQ(scene.error().place, (reader.dir / (std::string(what) + ".fbx")).string());
        EXPECT_EQ(
            scene.error().text.rfind(
                "Assimp, which reads this format, crashed on the file (" + std::string(how) + ")",
                0),
            0u)
            << scene.error().text;
        EXPECT_TRUE(reader.reads_on());
    }
}

TEST(Contained, TheClockEndsWhatHangs) {
    for (const char* what : {"hangs", "stalls", "floods-for-ever"}) {
        SCOPED_TRACE(what);
        BadReader reader(0.1);
        const auto start = Clock::now();
        const std::string error = reader.error_of(what);
        EXPECT_TRUE(has(error, "0.1 s of processor time or 0.4 s by the clock")) << error;
        EXPECT_LT(Clock::now() - start, std::chrono::seconds(20));
        EXPECT_TRUE(reader.reads_on());
    }
}

// By the clock it could go on for 12 s; processor time is told in whole seconds.
TEST(Contained, ProcessorTimeEndsWhatSpins) {
    BadReader reader(3);
    const auto start = Clock::now();
    const std::string error = reader.error_of("spins");
    EXPECT_TRUE(has(error, "3 s of processor time or 12 s by the clock")) << error;
    EXPECT_GT(Clock::now() - start, std::chrono::seconds(2));
    EXPECT_TRUE(reader.reads_on());
}

TEST(Contained, MemoryIsLimited) {
    if (prep::detail::sanitized) GTEST_SKIP() << "a sanitizer needs all the addresses there are";
    BadReader reader(20, std::uint64_t(512) << 20);
    for (const char* what : {"eats", "eats-politely"}) {
        const std::string error = reader.error_of(what);
        EXPECT_TRUE(has(error, "needed more than 512 MiB of memory")) << error;
        EXPECT_TRUE(reader.reads_on());
    }
}

TEST(Contained, AnswersThatAreNoneAreErrors) {
    BadReader reader(0.5);
    for (const auto& [what, says] :
         {std::pair{"nonsense", "made no usable scene of the file: the bytes are no scene"},
          {"no-message", "answered nonsense"},
          {"out-of-range", "made no usable scene of the file: a node of the scene is out of range"},
          {"lies", "needed more than 1024 MiB of memory"},
          {"closes", "crashed on the file (SIGKILL)"}}) {
        SCOPED_TRACE(what);
        const std::string error = reader.error_of(what);
        EXPECT_TRUE(has(error, says)) << error;
        EXPECT_TRUE(reader.reads_on());
    }
    const auto other = reader.read("other-build");
    ASSERT_FALSE(other.has_value());
    EXPECT_TRUE(has(other.error().text, "of another build")) << other.error().text;
}

TEST(Contained, ErrorsOfTheReaderArriveAsTheyAre) {
    BadReader reader;
    const auto scene = reader.read("error");
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().code, prep::ErrorCode::syntax);
    EXPECT_EQ(scene.error().text, "an error of the reader of Assimp");
    EXPECT_EQ(scene.error().place, (reader.dir / "error.fbx").string());
}

TEST(Contained, WhatReadersPrintGoesToTheLog) {
    BadReader reader;
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const bool read = reader.read("prints").has_value();
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_TRUE(read);
    EXPECT_TRUE(reader.log.starts_with("prints: ")) << reader.log;
    EXPECT_TRUE(has(reader.log, "to stdout\n") && has(reader.log, "to stderr\n")) << reader.log;
    reader.log.clear();
    EXPECT_TRUE(reader.read("floods").has_value());
    EXPECT_EQ(reader.log.size(), std::string("floods: ").size() + (64 << 10));
    EXPECT_TRUE(reader.log.ends_with("line 99999 of a long story\n"));
}

TEST(Contained, OneProcessServesManyFilesAndAnotherComesAfterAFailure) {
    BadReader reader;
    EXPECT_EQ(reader.started(), 0u);
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(reader.reads_on());
    EXPECT_EQ(reader.started(), 1u);
    EXPECT_TRUE(has(reader.error_of("error"), "an error"));  // in the same
    EXPECT_TRUE(reader.reads_on());
    EXPECT_EQ(reader.started(), 2u);
}

// A file that harms the process may not end the one after it: that gets a second, fresh reading.
TEST(Contained, NoFileSuffersFromTheOneBefore) {
    BadReader reader;
    EXPECT_TRUE(reader.read("harms").has_value());
    const auto scene = reader.read("suffers");
    ASSERT_TRUE(scene.has_value()) << scene.error().text;
    EXPECT_EQ(scene->name, "suffers");
    EXPECT_EQ(reader.started(), 2u);
}

TEST(Contained, ReadersLeaveNoFiles) {
    BadReader reader;
    EXPECT_TRUE(reader.read("writes").has_value());
    std::error_code ec;
    EXPECT_LE(fs::exists(reader.dir / "written") ? fs::file_size(reader.dir / "written", ec) : 0,
              0u);
    reader.error_of("segv");
    for (const std::string& name : reader.dir.names()) EXPECT_FALSE(has(name, "core")) << name;
}

TEST(Contained, NothingIsLeftOpenNorRunning) {
    const std::size_t before = open_files();
    {
        BadReader reader(0.2);
        for (const char* what : {"good", "segv", "half", "lies", "good", "hangs", "error"})
            static_cast<void>(reader.read(what));
    }
    EXPECT_EQ(open_files(), before);
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1);
    EXPECT_EQ(errno, ECHILD);
}

// Standard streams that are closed leave their numbers to whatever is opened next.
TEST(Contained, TheCallersStreamsMayBeClosed) {
    const int saved = ::dup(STDIN_FILENO);
    ::close(STDIN_FILENO);
    BadReader reader;
    EXPECT_TRUE(reader.reads_on());
    EXPECT_TRUE(has(reader.error_of("segv"), "SIGSEGV"));
    if (saved >= 0) {
        ::dup2(saved, STDIN_FILENO);
        ::close(saved);
    }
}

// A reader that died between two files is replaced; writing to it raises no signal.
TEST(Contained, AReaderThatIsGoneIsStartedAgain) {
    ::signal(SIGPIPE, SIG_DFL);
    BadReader reader;
    EXPECT_TRUE(reader.reads_on());
    for (const auto& process : fs::directory_iterator("/proc")) {
        const std::string number = process.path().filename().string();
        if (number.find_first_not_of("0123456789") != std::string::npos) continue;
        const std::string stat = test::file_text(process.path() / "stat");
        const std::size_t name = stat.rfind(')');
        if (name == std::string::npos) continue;
        int parent = 0;
        if (std::sscanf(stat.c_str() + name, ") %*c %d", &parent) == 1 && parent == ::getpid())
            ::kill(std::stoi(number), SIGKILL);
    }
    EXPECT_TRUE(reader.reads_on());
}

TEST(ContainedThreads, EachFileThatIsReadMeanwhileHasAProcess) {
    BadReader reader;
    test::write_text(reader.dir / "good.fbx", "x");
    prep::LoadOptions options;
    prep::ReaderProcessOptions limits;
    limits.program = MESHPREP_BAD_READER;
    options.reader_process = std::make_shared<prep::ReaderProcess>(limits);
    std::atomic<int> good = 0;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 10; ++i)
                good += prep::load_scene(reader.dir / "good.fbx", options).has_value();
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(good, 40);
    EXPECT_LE(options.reader_process->started(), 4u);
}

// --- pictures -----------------------------------------------------------------------------------

// A folder of pictures that the bad reader is asked for by name, as ICO.
class BadPictures {
  public:
    explicit BadPictures(double seconds = 20, std::uint64_t memory = std::uint64_t(1) << 30) {
        prep::ReaderProcessOptions limits;
        limits.program = MESHPREP_BAD_READER;
        limits.seconds = seconds;
        limits.memory = memory;
        options.reader_process = std::make_shared<prep::ReaderProcess>(limits);
        options.reader_log = [this](const fs::path&, std::string_view text) { log += text; };
    }
    fs::path file(const std::string& what) {
        test::write_text(dir / (what + ".ico"), "x");
        return dir / (what + ".ico");
    }
    prep::Result<prep::Image> read(const std::string& what) {
        return prep::load_image(file(what), options);
    }
    std::string error_of(const std::string& what) {
        const auto image = read(what);
        if (image) return "no error";
        EXPECT_EQ(image.error().place, (dir / (what + ".ico")).string());
        return image.error().text;
    }

    test::TempDir dir;
    prep::ImageOptions options;
    std::string log;
};

TEST(ContainedPictures, ACrashIsAnErrorWithFileDecoderAndSignal) {
    BadPictures pictures;
    for (const auto& [what, how] : {std::pair{"segv", "SIGSEGV"},
                                    {"abort", "SIGABRT"},
                                    {"exit", "exit code 3"},
                                    {"half", "SIGKILL"}}) {
        SCOPED_TRACE(what);
        EXPECT_EQ(pictures.error_of(what),
                  "OpenImageIO, which reads this format, crashed on the "
                  "file (" +
                      std::string(how) +
                      "); if the file is not damaged, save it in another "
                      "format (PNG, EXR)");
        EXPECT_TRUE(pictures.read("good").has_value()) << "and the next one is read";
    }
}

TEST(ContainedPictures, TimeAndMemoryAreLimited) {
    BadPictures slow(0.1);
    EXPECT_TRUE(has(slow.error_of("hangs"), "0.1 s of processor time or 0.4 s by the clock"));
    if (!prep::detail::sanitized) {
        BadPictures large;
        EXPECT_TRUE(has(large.error_of("eats"), "needed more than 1024 MiB of memory"));
    }
}

TEST(ContainedPictures, AnswersThatAreNoneAreErrors) {
    BadPictures pictures;
    EXPECT_TRUE(has(pictures.error_of("no-texels"), "made no usable picture of the file"));
    EXPECT_TRUE(has(pictures.error_of("nonsense"), "answered nonsense"));  // a scene
    EXPECT_TRUE(has(pictures.error_of("no-message"), "answered nonsense"));
    EXPECT_EQ(pictures.error_of("error"), "an error of the reader of pictures");
}

TEST(ContainedPictures, TexelsChannelsAndWhatIsPrintedArrive) {
    BadPictures pictures;
    pictures.options.channels = prep::ImageChannels::all;
    const auto image = pictures.read("prints");
    ASSERT_TRUE(image.has_value()) << prep::to_string(image.error());
    EXPECT_EQ(image->width, 2u);
    EXPECT_EQ(image->pixels, (std::vector<float>{0, 0.25f, 0.5f, 1, 1, 0.5f, 0.25f, 0}));
    EXPECT_EQ(image->channel_names, (std::vector<std::string>{"R", "G", "B", "A"}));
    EXPECT_TRUE(has(pictures.log, "to stdout") && has(pictures.log, "to stderr")) << pictures.log;
}

// Scenes tell their pictures where to be decoded: those of files, embedded ones, and those that a
// picture is put together from.
TEST(ContainedPictures, OfAScenesMaterialsAreDecodedThere) {
    BadPictures pictures;
    pictures.file("segv");
    test::write_text(pictures.dir / "a.obj",
                     "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    test::write_text(pictures.dir / "a.mtl",
                     "newmtl m\nKd 1 1 1\nmap_Kd segv.ico\nmap_d abort.ico\n");
    pictures.file("abort");
    prep::LoadOptions load;
    load.reader_process = pictures.options.reader_process;
    auto scene = prep::load_scene(pictures.dir / "a.obj", load);
    ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
    std::size_t packed = 0;
    for (const prep::ImageRef& ref : scene->images) {
        const auto image = prep::load_image(ref);
        ASSERT_FALSE(image.has_value());
        EXPECT_TRUE(has(image.error().text, "crashed on the file (SIG")) << image.error().text;
        packed += !ref.channels.empty();
    }
    EXPECT_EQ(packed, 1u);
    // The output is there, and its notes say what is missing.
    const auto prepared = prep::prepare(*std::move(scene));
    ASSERT_TRUE(prepared.has_value());
    const auto notes = prep::save_scene(*prepared, pictures.dir / "a.glb");
    ASSERT_TRUE(notes.has_value()) << prep::to_string(notes.error());
    EXPECT_TRUE(std::any_of(notes->begin(), notes->end(), [](const std::string& note) {
        return has(note, "OpenImageIO, which reads this format, crashed on the file (SIG");
    })) << testing::PrintToString(*notes);

    prep::ImageRef embedded;
    embedded.name = "logo.ico";
    embedded.bytes.assign(4, std::byte('x'));
    embedded.options = std::make_shared<const prep::ImageOptions>(pictures.options);
    const auto image = prep::load_image(embedded);
    ASSERT_TRUE(image.has_value()) << prep::to_string(image.error());
    EXPECT_EQ(image->width, 2u);  // the bad reader's
    // No TGA file: what else it may be is no decoder's here to find out.
    embedded.name = "logo.tga";
    const auto other = prep::load_image(embedded);
    ASSERT_TRUE(other.has_value()) << prep::to_string(other.error());
    EXPECT_EQ(other->width, 2u);
}

TEST(ContainedPictures, TriedFormatsStartNoProcess) {
    BadPictures pictures;
    prep::Image image;
    image.width = image.height = 4;
    image.channels = 3;
    image.pixels.assign(48, 0.5f);
    for (const char* const ending :
         {"png", "jpg", "exr", "hdr", "webp", "bmp", "tif", "tga", "ppm"}) {
        SCOPED_TRACE(ending);
        const fs::path file = pictures.dir / ("tried." + std::string(ending));
        ASSERT_TRUE(prep::save_image(file, image).has_value());
        const auto here = prep::load_image(file);
        const auto there = prep::load_image(file, pictures.options);
        ASSERT_TRUE(here.has_value());
        ASSERT_TRUE(there.has_value()) << prep::to_string(there.error());
        EXPECT_EQ(here->pixels, there->pixels);
        // By its bytes, whatever its name.
        if (ending == std::string("tga") || ending == std::string("ppm")) continue;
        fs::copy_file(file, pictures.dir / "other.ico", fs::copy_options::overwrite_existing);
        EXPECT_TRUE(prep::load_image(pictures.dir / "other.ico", pictures.options).has_value());
    }
    // Damaged ones neither: no other decoder is tried on them.
    test::write_text(pictures.dir / "cut.png", "\x89PNG\r\n\x1a\n");
    EXPECT_FALSE(prep::load_image(pictures.dir / "cut.png", pictures.options).has_value());
    EXPECT_FALSE(prep::load_image(pictures.dir / "none.ico", pictures.options).has_value());
    EXPECT_EQ(pictures.options.reader_process->started(), 0u);
}

// A real decoder in the real process: the bits that it has here.
TEST(ContainedPictures, TexelsAreThoseOfTheDecoderInThisProcess) {
    const test::TempDir dir;
    // SGI, plain: 512 bytes of head, then the planes from the bottom row up, a byte a texel.
    std::string sgi{1, char(0xda), 0, 1, 0, 3, 0, 5, 0, 3, 0, 3};
    sgi.resize(512);
    for (int k = 0; k < 45; ++k) sgi += char(5 * k);
    const fs::path file = dir / "a.sgi";
    test::write_text(file, sgi);
    prep::ImageOptions options;
    options.reader_process = std::make_shared<prep::ReaderProcess>();
    const auto here = prep::load_image(file);
    ASSERT_TRUE(here.has_value()) << prep::to_string(here.error());
    const auto there = prep::load_image(file, options);
    ASSERT_TRUE(there.has_value()) << prep::to_string(there.error());
    EXPECT_EQ(here->pixels, there->pixels);
    EXPECT_EQ(here->channels, there->channels);
    EXPECT_EQ(here->srgb, there->srgb);
    EXPECT_EQ(here->floating, there->floating);
    ASSERT_EQ(there->pixels.size(), 45u);
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x)
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(there->pixels[std::size_t((y * 5 + x) * 3 + c)],
                          float(5 * (c * 15 + (2 - y) * 5 + x)) / 255);
    EXPECT_EQ(options.reader_process->started(), 1u);
}

TEST(Contained, AProgramThatIsNotThereIsAnErrorThatSaysWhereItWasSought) {
    const test::TempDir dir;
    test::write_text(dir / "a.fbx", "x");
    prep::ReaderProcessOptions where;
    where.program = dir / "nowhere";
    prep::LoadOptions options;
    options.reader_process = std::make_shared<prep::ReaderProcess>(where);
    const auto scene = prep::load_scene(dir / "a.fbx", options);
    ASSERT_FALSE(scene.has_value());
    EXPECT_EQ(scene.error().code, prep::ErrorCode::io);
    EXPECT_TRUE(has(scene.error().text, (dir / "nowhere").string())) << scene.error().text;
    where.program = "/bin/true";  // it is there, and is no reader
    options.reader_process = std::make_shared<prep::ReaderProcess>(where);
    EXPECT_TRUE(has(prep::load_scene(dir / "a.fbx", options).error().text, "crashed"));
}

TEST(Contained, OurOwnFormatsStartNoProcess) {
    const test::TempDir dir;
    test::write_text(dir / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test::write_text(dir / "a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    prep::LoadOptions options;
    options.reader_process = std::make_shared<prep::ReaderProcess>();
    EXPECT_TRUE(prep::load_scene(dir / "a.obj", options).has_value());
    EXPECT_TRUE(prep::load_scene(dir / "a.off", options).has_value());
    EXPECT_EQ(options.reader_process->started(), 0u);
}

TEST(Contained, OptionsOfLoadingReachTheReader) {
    const test::TempDir dir;
    test::write_text(dir / "good.fbx", "x");
    prep::ReaderProcessOptions where;
    where.program = MESHPREP_BAD_READER;
    prep::LoadOptions options;
    options.threads = 7;
    options.reader_process = std::make_shared<prep::ReaderProcess>(where);
    const auto scene = prep::load_scene(dir / "good.fbx", options);
    ASSERT_TRUE(scene.has_value()) << scene.error().text;
    EXPECT_EQ(scene->source_bytes, 7u);  // as the bad reader tells it
}

// A path relative to a directory that changes while the process waits for the next file.
TEST(Contained, RelativePathsAreTheCallers) {
    const test::TempDir a, b;
    const fs::path before = fs::current_path();
    const std::string triangle = "0 0 0 1 0 0 0 1 0\n";
    test::write_text(a / "m.raw", triangle);
    test::write_text(b / "m.raw", triangle + "0 0 1 1 0 1 0 1 1\n");
    prep::LoadOptions options;
    options.reader_process = std::make_shared<prep::ReaderProcess>();
    std::vector<std::size_t> faces;
    for (const test::TempDir* dir : {&a, &b}) {
        fs::current_path(dir->path());
        const auto scene = prep::load_scene("m.raw", options);
        ASSERT_TRUE(scene.has_value()) << prep::to_string(scene.error());
        ASSERT_EQ(scene->meshes.size(), 1u);
        faces.push_back(scene->meshes[0].face_count());
    }
    fs::current_path(before);
    EXPECT_EQ(faces, (std::vector<std::size_t>{1, 2}));
    EXPECT_EQ(options.reader_process->started(), 1u);
}

// ---- with and without, on files of other programs ----

bool is_foreign(const fs::path& path) {
    const prep::FileFormat* format = prep::file_format(path);
    return path.extension() == ".csm" ||
           (format && (format->name == "Assimp" || format->name == "OM"));
}

// What would end this process is not read in it.
const std::vector<std::string> crash_outside = {"counterX.3MF", "DropoutBufferOverflow.csm"};

TEST(Contained, ScenesAndWrittenFilesAreThoseOfAReaderInThisProcess) {
    MESHPREP_REQUIRE_SHARED(shared);
    prep::LoadOptions contained;
    contained.reader_process = std::make_shared<prep::ReaderProcess>();
    std::size_t compared = 0;
    const test::TempDir dir;
    for (const fs::directory_entry& entry :
         fs::recursive_directory_iterator(shared / "real_files")) {
        const std::string name = entry.path().filename().string();
        if (!entry.is_regular_file() || !is_foreign(entry.path()) ||
            std::count(crash_outside.begin(), crash_outside.end(), name))
            continue;
        SCOPED_TRACE(name);
        auto here = prep::load_scene(entry.path()),
             there = prep::load_scene(entry.path(), contained);
        ASSERT_EQ(here.has_value(), there.has_value());
        if (!here) {
            EXPECT_EQ(prep::to_string(here.error()), prep::to_string(there.error()));
            continue;
        }
        EXPECT_EQ(test::broken_promise(*there), "");
        EXPECT_TRUE(prep::detail::scene_bytes(*here) == prep::detail::scene_bytes(*there));
        std::string written[2];
        for (int k = 0; k < 2; ++k) {
            const auto prepared = prep::prepare(std::move(k == 0 ? *here : *there));
            ASSERT_TRUE(prepared.has_value());
            ASSERT_TRUE(prep::save_scene(*prepared, dir / "out.glb").has_value());
            written[k] = test::file_text(dir / "out.glb");
        }
        EXPECT_FALSE(written[0].empty());
        EXPECT_TRUE(written[0] == written[1]);
        ++compared;
    }
    EXPECT_GE(compared, 10u);
    EXPECT_GE(contained.reader_process->started(), 1u);
}

}  // namespace
