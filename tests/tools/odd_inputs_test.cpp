// Inputs as they come by accident: pipes where files are meant, links that lead nowhere, what is
// packed twice or under another ending. Each is read, or refused in words that say what it is.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <fstream>
#include <thread>

#include "command_runner.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "prep/image.h"

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_command;
using test::run_here;
using test::TempDir;
using test::write_text;

std::string gzipped(const std::string& text) {
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string out(text.size() + 200, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = uInt(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = uInt(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";

class OddInputs : public ::testing::Test {
  protected:
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    std::string error_of(const std::string& name) const {
        const test::Ran ran = run_here({"prepare", at(name), "-o", at("no.glb")});
        EXPECT_EQ(ran.exit_code, 1) << name;
        EXPECT_FALSE(fs::exists(dir_ / "no.glb")) << name;
        const std::string head = "meshprep: error: " + at(name) + ": ";
        const std::size_t begin = ran.err.find(head);
        if (begin == std::string::npos) return ran.err;
        return ran.err.substr(begin + head.size(), ran.err.size() - begin - head.size() - 1);
    }
    TempDir dir_;
};

// A named pipe, and somebody who writes `text` to it once.
class Pipe {
  public:
    Pipe(const fs::path& path, std::string text) : path_(path) {
        EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
        writer_ = std::thread(
            [path, text = std::move(text)] { std::ofstream(path, std::ios::binary) << text; });
    }
    ~Pipe() {
        // Whoever should have read it may not have: the writer ends either way.
        const int reader = ::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        writer_.join();
        ::close(reader);
    }

  private:
    fs::path path_;
    std::thread writer_;
};

// Every way to read a file looks at some more than once: all of a pipe is kept.
TEST_F(OddInputs, NamedPipesAreReadOnce) {
    write_text(dir_ / "m.mtl", "newmtl red\nKd 1 0 0\n");
    const std::string obj = "mtllib m.mtl\nusemtl red\n" + triangle;
    fs::create_directory(dir_ / "plain");
    write_text(dir_ / "plain/p.obj", obj);
    write_text(dir_ / "plain/m.mtl", file_text(dir_ / "m.mtl"));
    ASSERT_EQ(run_here({"prepare", at("plain/p.obj"), "-o", at("plain/p.glb")}).exit_code, 0);
    const std::string glb = file_text(dir_ / "plain/p.glb");
    const std::pair<const char*, std::string> pipes[] = {
        {"p.obj", obj}, {"p", obj}, {"p.obj.gz", gzipped(obj)}};
    for (const auto& [name, text] : pipes) {
        {
            const Pipe pipe(dir_ / name, text);
            const test::Ran ran = run_command(
                {"prepare", at(name), "-o", at("out.glb"), "--manifest", at("made.json")});
            EXPECT_EQ(ran.exit_code, 0) << ran.err;
            EXPECT_EQ(ran.err, "") << name;
            EXPECT_EQ(file_text(dir_ / "out.glb"), glb) << name;
        }
        fs::remove(dir_ / name);
    }
    {
        const Pipe pipe(dir_ / "p.glb", glb);
        const test::Ran ran = run_command({"inspect", at("p.glb"), "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.json()["files"][0]["status"], "ok");
    }
    {
        const Pipe pipe(dir_ / "none.obj", "");
        EXPECT_EQ(error_of("none.obj"), "is empty; is the program before the pipe at fault?");
    }
}

// The command, for what would otherwise wait for ever.
test::Ran run_at_most_30_seconds(std::vector<std::string> words) {
    words.insert(words.begin(), {"30", test::command_path().string()});
    return test::run_program("/usr/bin/timeout", words);
}

// What came through a pipe the last time says nothing of what would come now.
TEST_F(OddInputs, AChangedPipeIsNotSkipped) {
    write_text(dir_ / "m.mtl", "newmtl red\nKd 1 0 0\n");
    const std::string obj = "mtllib m.mtl\nusemtl red\n" + triangle;
    std::string before;
    for (const char* const more : {"", "v 0 0 1\nf 1 2 4\n"}) {
        fs::remove(dir_ / "p.obj");
        const Pipe pipe(dir_ / "p.obj", obj + more);
        const test::Ran ran =
            run_command({"prepare", at("p.obj"), "-o", at("out.glb"), "--manifest", at("made.json"),
                         "--skip-unchanged", "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.json()["files"][0]["status"], "ok");
        EXPECT_NE(file_text(dir_ / "out.glb"), before);
        before = file_text(dir_ / "out.glb");
    }
}

TEST_F(OddInputs, WhatAPipedModelIsReadFromStays) {
    write_text(dir_ / "m.mtl", "newmtl m\nmap_Kd spot.png\n");
    const prep::Image image{2, 2, 3, std::vector<float>(12, 0.5f)};
    ASSERT_TRUE(prep::save_image(dir_ / "spot.png", image).has_value());
    const std::string picture = file_text(dir_ / "spot.png");
    const Pipe pipe(dir_ / "spot.obj",
                    "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                    "f 1/1 2/2 3/3\n");
    const test::Ran ran = run_at_most_30_seconds(
        {"validate", at("spot.obj"), "-o", dir_.path().string(), "--panel", "64"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find(at("spot.png") + ": a model is read from this file"), std::string::npos)
        << ran.err;
    EXPECT_EQ(file_text(dir_ / "spot.png"), picture);
}

TEST_F(OddInputs, WhatAPackedModelIsReadFromStays) {
    const std::string library = "newmtl m\nKd 1 0 0\n";
    write_text(dir_ / "a.mtl", library);
    write_text(dir_ / "a.obj.gz", gzipped("mtllib a.mtl\nusemtl m\n" + triangle));
    const test::Ran ran = run_here({"cost", at("a.obj.gz"), "--ladder", "normal-precision",
                                    "--rounds", "1", "--csv", at("a.mtl")});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find(at("a.mtl") + ": the output is also an input"), std::string::npos)
        << ran.err;
    EXPECT_EQ(file_text(dir_ / "a.mtl"), library);
}

TEST_F(OddInputs, PipesAreNotWrittenInPlaceNorReadTwice) {
    const std::string pipe = at("p.obj");
    const std::vector<std::pair<std::vector<std::string>, std::string>> lines = {
        {{"prepare", pipe, "--in-place"}, "nothing can be written in place of what it was"},
        {{"prepare", pipe, at("link.obj"), "-o", at("out/")},
         "this is read once, and an earlier input is the same"},
        {{"diff", pipe, pipe}, "this is read once, and an earlier input is the same"},
        {{"cost", pipe, at("./p.obj"), "--ladder", "normal-precision", "--rounds", "1"},
         "this is read once, and an earlier input is the same"},
        {{"inspect", pipe, at("link.obj")}, "this is read once, and an earlier input is the same"},
        {{"validate", pipe, at("link.obj"), "-o", at("out"), "--panel", "64"},
         "this is read once, and an earlier input is the same"}};
    fs::create_symlink("p.obj", dir_ / "link.obj");
    for (const auto& [words, text] : lines) {
        {
            const Pipe open(pipe, triangle);
            const test::Ran ran = run_at_most_30_seconds(words);
            EXPECT_NE(ran.exit_code, 0) << words[0];
            EXPECT_NE(ran.exit_code, 124) << words[0] << " waits";
            EXPECT_NE(ran.err.find(text), std::string::npos) << words[0] << ran.err;
        }
        fs::remove(pipe);
    }
}

TEST_F(OddInputs, DevicesAreNoFiles) {
    // Where they were read, the limit on files would end it, not a full disk.
    for (const char* const device : {"/dev/zero", "/dev/null"}) {
        const test::Ran ran =
            run_command({"prepare", device, "-o", at("no.glb")}, {.largest_file = 1 << 20});
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_EQ(ran.err, "meshprep: error: " + std::string(device) +
                               ": this is a device or a socket, expected a file or a pipe\n");
    }
}

TEST_F(OddInputs, StreamsWithoutAnEndAreGivenUp) {
    for (const std::uint64_t most : {triangle.size(), triangle.size() - 1}) {
        fs::remove(dir_ / "p.obj");
        const Pipe pipe(dir_ / "p.obj", triangle);
        const auto opened = meshprep::InputFile::open(dir_ / "p.obj", "", nullptr, {most});
        EXPECT_EQ(opened.has_value(), most == triangle.size());
        if (!opened) {
            EXPECT_EQ(opened.error().code, prep::ErrorCode::limit);
            EXPECT_EQ(opened.error().place, at("p.obj"));
        }
    }
}

// What processes have open is nobody's library; a folder of shared memory is a folder.
TEST_F(OddInputs, DescriptorsAreNoNeighbours) {
    EXPECT_TRUE(meshprep::is_of_descriptors("/dev/fd"));
    EXPECT_TRUE(meshprep::is_of_descriptors("/dev"));
    EXPECT_TRUE(meshprep::is_of_descriptors("/proc/self/fd"));
    EXPECT_FALSE(meshprep::is_of_descriptors("/development/models"));
    EXPECT_FALSE(meshprep::is_of_descriptors("/processed"));
    EXPECT_FALSE(meshprep::is_of_descriptors("/dev/shm/models"));
    EXPECT_FALSE(meshprep::is_of_descriptors("/"));
    write_text(dir_ / "m.mtl", "newmtl m\nKd 1 0 0\n");
    const int library = ::open(at("m.mtl").c_str(), O_RDONLY | O_CLOEXEC);
    const std::string name = std::to_string(library);
    const std::string obj = "mtllib " + name + "\nusemtl m\n" + triangle;
    for (const std::string& text : {obj, gzipped(obj)}) {
        int ends[2] = {};
        ASSERT_EQ(::pipe(ends), 0);
        ASSERT_EQ(::write(ends[1], text.data(), text.size()), ssize_t(text.size()));
        ::close(ends[1]);
        const test::Ran ran =
            run_here({"prepare", "/dev/fd/" + std::to_string(ends[0]), "-o", at("a.glb")});
        ::close(ends[0]);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_NE(ran.err.find("material library '" + name + "' cannot be read"), std::string::npos)
            << ran.err;
    }
    ::close(library);
}

TEST_F(OddInputs, ScalesThatNoFloatHoldsAreRefused) {
    write_text(dir_ / "a.obj", "v 0 0 0\nv 20 0 0\nv 0 20 0\nf 1 2 3\n");
    const auto run = [&](const char* scale) {
        return run_here({"prepare", at("a.obj"), "-o", at("a.stl"), "--scale", scale});
    };
    for (const char* const scale : {"1e60", "1e-60"}) {
        const test::Ran ran = run(scale);
        EXPECT_EQ(ran.exit_code, 2) << scale;
        EXPECT_NE(ran.err.find("--scale: beyond the range of float"), std::string::npos) << ran.err;
    }
    const test::Ran far = run("3e37");
    EXPECT_EQ(far.exit_code, 1);
    EXPECT_NE(far.err.find(at("a.obj") + ": coordinates are beyond the range of float"),
              std::string::npos)
        << far.err;
    EXPECT_FALSE(fs::exists(dir_ / "a.stl"));
    write_text(dir_ / "a.obj", "v 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n");
    const test::Ran near = run("2e-38");
    EXPECT_EQ(near.exit_code, 1);
    EXPECT_NE(near.err.find(at("a.obj") + ": no coordinate is left in the range of float"),
              std::string::npos)
        << near.err;
    EXPECT_FALSE(fs::exists(dir_ / "a.stl"));
    EXPECT_EQ(run("3e37").exit_code, 0);
    EXPECT_EQ(run("2e-37").exit_code, 0);
}

// Where a model names a pipe or a device as its picture, nobody waits for it.
TEST_F(OddInputs, PipesAndDevicesAreNoPictures) {
    ASSERT_EQ(::mkfifo(at("pipe.png").c_str(), 0600), 0);
    for (const char* const picture : {"pipe.png", "/dev/zero"}) {
        write_text(dir_ / "a.mtl", "newmtl m\nmap_Kd " + std::string(picture) + "\n");
        write_text(dir_ / "a.obj", "mtllib a.mtl\nusemtl m\n" + triangle);
        for (const char* const format : {"glb", "obj"}) {
            const test::Ran ran =
                run_command({"prepare", at("a.obj"), "-o", at("out/a." + std::string(format)),
                             "--manifest", at("made.json")});
            EXPECT_EQ(ran.exit_code, 0) << ran.err;
            EXPECT_NE(ran.err.find("a picture was not found: " + std::string(picture)),
                      std::string::npos)
                << ran.err;
        }
    }
}

TEST_F(OddInputs, LinksThatLeadNowhereAreNamed) {
    fs::create_symlink("gone.obj", dir_ / "link.obj");
    fs::create_symlink("b.obj", dir_ / "a.obj");
    fs::create_symlink("a.obj", dir_ / "b.obj");
    EXPECT_EQ(error_of("link.obj"), "this is a link to 'gone.obj', which is not there");
    EXPECT_EQ(error_of("a.obj"), "this is a link that leads back to itself");
}

TEST_F(OddInputs, PackedTwiceOrUnderAnotherEnding) {
    write_text(dir_ / "a.obj.gz", gzipped(gzipped(triangle)));
    write_text(dir_ / "b.obj.gz.gz", gzipped(gzipped(triangle)));
    write_text(dir_ / "c.obj", gzipped(triangle));
    write_text(dir_ / "d.glb", std::string("PK\x05\x06", 4) + std::string(18, '\0'));
    const std::string twice = "a gzip file is packed in this one; unpack it once, with gunzip";
    EXPECT_EQ(error_of("a.obj.gz"), twice);
    EXPECT_EQ(error_of("b.obj.gz.gz"), twice);
    EXPECT_EQ(error_of("c.obj"),
              "this is a gz file, whatever its ending says; end its name with .gz");
    EXPECT_EQ(error_of("d.glb"),
              "this is a zip file, whatever its ending says; end its name with .zip");
}

TEST_F(OddInputs, EmptyOnesSaySoHoweverTheyArePacked) {
    for (const char* const name : {"a.obj.gz", "a.zip"}) {
        write_text(dir_ / name, "");
        EXPECT_EQ(error_of(name), "the file is empty") << name;
    }
    // Its name is a word of the message.
    write_text(dir_ / "empty.gz", gzipped(""));
    EXPECT_EQ(error_of("empty.gz"), "the file that is packed in it is empty");
}

// As gzip itself reads them: what is packed in pieces may begin with an empty one.
TEST_F(OddInputs, EmptyMembersOfAGzipFileAreNothing) {
    const std::string empty = gzipped(""), half = triangle.substr(0, 20),
                      rest = triangle.substr(20);
    for (const std::string& packed :
         {empty + gzipped(triangle),
          empty + empty + gzipped(half) + empty + gzipped(rest) + empty}) {
        write_text(dir_ / "t.obj.gz", packed);
        const test::Ran ran = run_here({"inspect", at("t.obj.gz"), "--json"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.json()["files"][0]["counts"]["triangles"], 1);
        EXPECT_TRUE(ran.json()["files"][0]["warnings"].empty()) << ran.out;
    }
    write_text(dir_ / "t.obj.gz", empty + empty);
    EXPECT_EQ(error_of("t.obj.gz"), "the file that is packed in it is empty");
}

TEST_F(OddInputs, WhatFollowsAFileIsTold) {
    write_text(dir_ / "a.obj.gz", gzipped(triangle) + "rubbish");
    write_text(dir_ / "b.obj.gz", gzipped(triangle) + std::string(7, '\0'));
    const std::string out = at("out.glb");
    const test::Ran told = run_here({"prepare", at("a.obj.gz"), "-o", out, "--json"});
    EXPECT_EQ(told.exit_code, 0);
    EXPECT_EQ(told.json()["files"][0]["warnings"],
              nlohmann::json{"behind the packed file are 7 bytes of something else: left out"});
    EXPECT_EQ(run_here({"prepare", at("b.obj.gz"), "-o", out}).err, "");
    write_text(dir_ / "c.glb", file_text(out) + "rubbish");
    EXPECT_EQ(
        run_here({"prepare", at("c.glb"), "-o", at("d.glb"), "--json"})
            .json()["files"][0]["warnings"],
        nlohmann::json{"c.glb: 7 bytes stand behind the end that the header announces: left out"});
    // Said once, where the reader says the name as well.
    const std::string said = "meshprep: warning: " + at("c.glb") + ": 7 bytes stand behind the end";
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"prepare", at("c.glb"), "-o", at("d.glb")},
             {"inspect", at("c.glb")},
             {"validate", at("c.glb"), "-o", at("s"), "--panel", "64"},
             {"render", at("c.glb"), "-o", at("d.png"), "--size", "16x16"}})
        EXPECT_EQ(run_here(words).err.substr(0, said.size()), said);
    EXPECT_EQ(meshprep::said_of("x/a.obj", "a.obj:4: odd"), "x/a.obj:4: odd");
    EXPECT_EQ(meshprep::said_of("x/a.obj", "x/a.obj#/nodes: odd"), "x/a.obj#/nodes: odd");
    EXPECT_EQ(meshprep::said_of("x/a.obj", "a.obj.mtl:4: odd"), "x/a.obj: a.obj.mtl:4: odd");
}

TEST_F(OddInputs, NothingThatIsFiniteIsNothing) {
    write_text(dir_ / "a.obj", "v nan 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\nl 1 3\np 2\n");
    EXPECT_EQ(
        error_of("a.obj").rfind(
            "no face, line or point has coordinates that are all finite; found 3 vertices", 0),
        0u);
    write_text(dir_ / "b.obj", "v nan 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\np 3\n");
    EXPECT_EQ(run_here({"prepare", at("b.obj"), "-o", at("b.glb")}).exit_code, 0);
}

TEST_F(OddInputs, AMaterialLibraryInUtf16IsNamed) {
    std::string wide("\xff\xfe", 2);
    for (const char c : std::string("newmtl m\nKd 1 0 0\n")) wide += std::string{c, '\0'};
    write_text(dir_ / "a.mtl", wide);
    write_text(dir_ / "a.obj", "mtllib a.mtl\nusemtl m\n" + triangle);
    const test::Ran ran = run_here({"prepare", at("a.obj"), "-o", at("a.glb"), "--json"});
    EXPECT_EQ(ran.json()["files"][0]["warnings"],
              nlohmann::json{"material library 'a.mtl' is in UTF-16, which is not read: save it as "
                             "UTF-8; its materials get the default look"});
}

// What a terminal would obey is not printed; JSON has it as it is.
TEST_F(OddInputs, NamesInFilesDoNotDriveTheTerminal) {
    const std::string name =
        "no\x1b[2Jwh\xc2\x9b"
        "2Jere\x07.mtl";
    write_text(dir_ / "a.obj", "mtllib " + name + "\n" + triangle);
    const test::Ran ran = run_here({"prepare", at("a.obj"), "-o", at("a.glb")});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_NE(ran.err.find("material library 'no?[2Jwh?2Jere?.mtl' cannot be read"),
              std::string::npos)
        << ran.err;
    const nlohmann::json json =
        run_here({"prepare", at("a.obj"), "-o", at("a.glb"), "--json"}).json();
    EXPECT_NE(json["files"][0]["warnings"][0].get<std::string>().find(name), std::string::npos);
}

// The results of an earlier run below the inputs are no inputs of the next.
TEST_F(OddInputs, OutputsBelowTheInputsAreNotTakenForInputs) {
    fs::create_directories(dir_ / "in/sub");
    write_text(dir_ / "in/a.obj", triangle);
    write_text(dir_ / "in/sub/b.obj", triangle);
    for (const char* const out : {"in/out", "in/out/", "in/../in/out"}) {
        const test::Ran ran = run_here({"prepare", at("in"), "-r", "-o", at(out), "--json"});
        EXPECT_EQ(ran.exit_code, 0) << out << ran.err;
        EXPECT_EQ(ran.json()["files"].size(), 2u) << out;
    }
    EXPECT_TRUE(fs::exists(dir_ / "in/out/sub/b.glb"));
    EXPECT_FALSE(fs::exists(dir_ / "in/out/out"));
    // Another directory of outputs is one of inputs.
    EXPECT_EQ(
        run_here({"prepare", at("in"), "-r", "-o", at("other"), "--json"}).json()["files"].size(),
        4u);
}

TEST_F(OddInputs, ErrorsNameTheDirectoryOfTheirFile) {
    for (const char* const name : {"x/a.obj", "y/c.obj"}) {
        fs::create_directory(fs::path(at(name)).parent_path());
        write_text(dir_ / name, "v 0 0 0\nf 1 2 9\n");
    }
    write_text(dir_ / "x/b.glb", "glTF");
    const test::Ran ran = run_here({"prepare", at("x"), at("y"), "-o", at("out")});
    EXPECT_EQ(ran.exit_code, 1);
    for (const char* const place : {"x/a.obj:2: ", "y/c.obj:2: ", "x/b.glb, byte 0: "})
        EXPECT_NE(ran.err.find("meshprep: error: " + at(place)), std::string::npos) << ran.err;
}

// What lies beside a packed file is named by its place, not by that of the unpacked one.
TEST_F(OddInputs, PackedFilesAreSkippedWhereNothingChanged) {
    write_text(dir_ / "a.mtl", "newmtl m\nKd 1 0 0\n");
    write_text(dir_ / "a.obj.gz", gzipped("mtllib a.mtl\nusemtl m\n" + triangle));
    const auto run = [&] {
        return run_here({"prepare", at("a.obj.gz"), "-o", at("a.glb"), "--manifest",
                         at("made.json"), "--skip-unchanged", "--json"})
            .json()["files"][0]["status"]
            .get<std::string>();
    };
    EXPECT_EQ(run(), "ok");
    const nlohmann::json made = nlohmann::json::parse(file_text(dir_ / "made.json"));
    EXPECT_EQ(made["files"][0]["sources"][1]["path"], at("a.mtl"));
    EXPECT_EQ(run(), "skipped");
    write_text(dir_ / "a.mtl", "newmtl m\nKd 0 1 0\n");
    EXPECT_EQ(run(), "ok");
}

TEST_F(OddInputs, ADashIsRefusedWhereNoStreamIsMeant) {
    const fs::path before = fs::current_path();
    fs::current_path(dir_.path());
    write_text("a.obj", triangle);
    const test::Ran twice = run_here({"diff", "-", "-"});
    const test::Ran manifest = run_here({"prepare", "a.obj", "-o", "a.glb", "--manifest", "-"});
    const test::Ran sheets = run_here({"validate", "a.obj", "-o", "-"});
    const bool made = fs::exists("-");
    fs::current_path(before);
    EXPECT_FALSE(made);
    EXPECT_EQ(twice.exit_code, 1);
    EXPECT_EQ(twice.err,
              "meshprep: error: -: both are standard input, which is read once; name a file for "
              "one of them\n");
    EXPECT_EQ(manifest.exit_code, 2);
    EXPECT_NE(manifest.err.find("--manifest: is written to a file"), std::string::npos);
    EXPECT_EQ(sheets.exit_code, 2);
    EXPECT_NE(sheets.err.find("--output: is a directory for several files"), std::string::npos);
}

TEST_F(OddInputs, AFileWhoseNameLooksLikeAnOptionIsRecognised) {
    const fs::path before = fs::current_path();
    fs::current_path(dir_.path());
    write_text("-a.obj", triangle);
    const test::Ran ran = run_here({"prepare", "-a.obj", "-o", "a.glb"});
    const test::Ran meant = run_here({"prepare", "./-a.obj", "-o", "a.glb"});
    fs::current_path(before);
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_NE(ran.err.find("-a.obj: is no option of prepare; the file of this name is meant by "
                           "./-a.obj"),
              std::string::npos)
        << ran.err;
    EXPECT_EQ(meant.exit_code, 0) << meant.err;
}

// A file that could not be read again.
TEST_F(OddInputs, NodesThatPutPointsBeyondFloats) {
    write_text(dir_ / "s.json",
               R"({"meshprep": 1, "meshes": {"b": {"shape": {"kind": "box"}}}, "nodes":
        [{"name": "a", "scale": 1e30}, {"mesh": "b", "parent": "a", "scale": 1e30}]})");
    for (const char* const ending : {"obj", "ply", "stl", "off"}) {
        const test::Ran ran =
            run_here({"prepare", at("s.json"), "-o", at("out." + std::string(ending))});
        EXPECT_EQ(ran.exit_code, 1) << ending;
        EXPECT_NE(ran.err.find("beyond the range of float (3.4e38) where nodes put them"),
                  std::string::npos)
            << ran.err;
        EXPECT_FALSE(std::filesystem::exists(at("out." + std::string(ending))));
    }
    // Where nodes are kept, they stay as they are.
    EXPECT_EQ(run_here({"prepare", at("s.json"), "-o", at("out.glb")}).exit_code, 0);
}

}  // namespace
