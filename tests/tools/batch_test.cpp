// Batches: what is wrong with one file stops no other, several at once say the same, and a manifest
// tells what is done already.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <sstream>

#include "command_runner.h"
#include "meshprep/commands/batch_sources.h"
#include "meshprep/files/sha256.h"
#include "steps.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::file_text;
using test::run_here;
using test::TempDir;
using test::write_text;

std::vector<json> lines_of(const std::string& text) {
    std::vector<json> list;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        list.push_back(json::parse(line, nullptr, false));
    return list;
}

// The same without what a clock said.
json without_times(json value) {
    if (value.is_object()) {
        value.erase("milliseconds");
        for (auto& member : value) member = without_times(member);
    } else if (value.is_array()) {
        for (auto& element : value) element = without_times(element);
    }
    return value;
}

// Of outputs that are there from an earlier run it is asked whether an input is read from them.
TEST(Batch, WhatIsReadFromAnOutputTakesNoLookAtAllOtherInputs) {
    const TempDir dir;
    std::vector<meshprep::Job> jobs;
    for (int n = 0; n < 2000; ++n)
        jobs.push_back(
            {dir / (std::to_string(n) + ".obj"), dir / (std::to_string(n) + ".glb"), "glb"});
    jobs.push_back({dir / "scene.json", dir / "scene.glb", "glb"});
    ASSERT_EQ(mkfifo((dir / "pipe.obj").c_str(), 0600), 0);
    jobs.push_back({dir / "pipe.obj", dir / "pipe.glb", "glb"});
    const meshprep::CommonOptions common;
    std::ostringstream said;
    meshprep::Console console(said, said, false);
    meshprep::BatchSources sources(jobs, common, console);
    EXPECT_LT(test::steps_of([&] {
                  for (const meshprep::Job& job : jobs)
                      EXPECT_FALSE(sources.of_another(job, job.output));
              }),
              3u);
    // What lies beside an output may be any input's, but each is loaded once.
    EXPECT_LT(test::steps_of([&] {
                  for (const meshprep::Job& job : jobs)
                      EXPECT_FALSE(sources.of_another(job, dir / "beside.bin"));
              }),
              2 * jobs.size());
    EXPECT_TRUE(sources.of_another(jobs[0], jobs[1].input));
    EXPECT_FALSE(sources.of_another(jobs[1], jobs[1].input));
    // A pipe is not read for an answer; what its mesh named is told all the same.
    const std::filesystem::path library = dir / "library.mtl";
    EXPECT_FALSE(sources.of_another(jobs[0], library));
    sources.add(jobs.back(), {library});
    EXPECT_TRUE(sources.of_another(jobs[0], library));
}

TEST(Batch, AMissingInputIsItsOwnErrorAndTheOthersAreDone) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    write_text(dir / "c.obj", test::sphere_obj(8, 4));
    fs::create_directory(dir / "empty");
    const test::Ran ran = run_here({"prepare", (dir / "a.obj").string(), (dir / "b.obj").string(),
                                    (dir / "empty").string(), (dir / "c.obj").string(), "-o",
                                    (dir / "out").string(), "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find((dir / "b.obj").string() + ": there is no such file"), std::string::npos)
        << ran.err;
    EXPECT_NE(ran.err.find((dir / "empty").string() + ": the directory holds no mesh file"),
              std::string::npos)
        << ran.err;
    const json document = ran.json();
    ASSERT_EQ(document["files"].size(), 4u);
    std::string states;
    for (const json& file : document["files"]) states += file["status"].get<std::string>() + " ";
    EXPECT_EQ(states, "ok failed failed ok ");
    EXPECT_EQ(document["files"][1]["error"]["code"], "io");
    EXPECT_EQ(document["summary"]["ok"], 2);
    EXPECT_EQ(document["summary"]["failed"], 2);
    EXPECT_TRUE(fs::exists(dir / "out/a.glb"));
    EXPECT_TRUE(fs::exists(dir / "out/c.glb"));
}

TEST(Batch, ANameClashIsTheLaterInputsError) {
    const TempDir dir;
    fs::create_directory(dir / "sub");
    write_text(dir / "a.obj", test::cube_obj());
    write_text(dir / "sub/a.obj", test::sphere_obj(8, 4));
    write_text(dir / "z.obj", test::cube_obj());
    const std::string first = (dir / "a.obj").string(), later = (dir / "sub/a.obj").string();
    const test::Ran ran = run_here(
        {"prepare", first, later, (dir / "z.obj").string(), first, "-o", (dir / "out").string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find(later + ": two inputs would be written to " +
                           (dir / "out/a.glb").string() + ", and " + first + " comes first"),
              std::string::npos)
        << ran.err;
    EXPECT_NE(ran.err.find(first + ": this input is given twice"), std::string::npos) << ran.err;
    // The first one's: 24 vertices of the cube.
    EXPECT_NE(ran.out.find("8 → 24 vertices"), std::string::npos) << ran.out;
    EXPECT_NE(ran.out.find("4 files: 2 ok, 2 failed"), std::string::npos) << ran.out;
    EXPECT_TRUE(fs::exists(dir / "out/z.glb"));
}

TEST(Batch, AnOutputThatIsAnInputStopsNoOther) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    ASSERT_EQ(
        run_here({"prepare", (dir / "a.obj").string(), "-o", (dir / "b.glb").string()}).exit_code,
        0);
    const std::string before = file_text(dir / "b.glb");
    const test::Ran ran = run_here(
        {"prepare", (dir / "a.obj").string(), (dir / "b.glb").string(), "-o", dir.path().string()});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.err.find("the output is also an input"), std::string::npos) << ran.err;
    EXPECT_EQ(file_text(dir / "b.glb"), before);
    EXPECT_TRUE(fs::exists(dir / "a.glb"));
}

// The first output's material library would have the name of the one that the second input is read
// from, its picture that of the second's picture. Whoever is first at it, and however many at once.
TEST(Batch, FilesBesideAnOutputSpareWhatOtherInputsAreReadFrom) {
    for (const bool late : {false, true})
        for (const char* const jobs : {"1", "2"}) {
            SCOPED_TRACE(std::string(late ? "after" : "before") + ", jobs " + jobs);
            const TempDir dir;
            fs::create_directory(dir / "in");
            // a.obj would be written with a.mtl, which b.obj is read from.
            const std::string library = "newmtl red\nKd 1 0 0\n";
            write_text(dir / "a.mtl", library);
            const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
            write_text(dir / "in/a.obj", "mtllib own.mtl\n" + triangle);
            write_text(dir / "in/own.mtl", "newmtl red\nKd 0 1 0\n");
            write_text(dir / "in/b.obj", "mtllib ../a.mtl\n" + triangle);
            std::vector<std::string> arguments = {"prepare", (dir / "in/a.obj").string(),
                                                  (dir / "in/b.obj").string()};
            if (late) std::swap(arguments[1], arguments[2]);
            for (const char* const more : {"--format", "obj", "--jobs", jobs, "--json", "-o"})
                arguments.emplace_back(more);
            arguments.push_back(dir.path().string() + "/");
            const test::Ran ran = run_here(arguments);
            EXPECT_EQ(ran.exit_code, 1);
            EXPECT_EQ(file_text(dir / "a.mtl"), library);
            const json files = ran.json()["files"];
            const json& refused = files[late ? 1 : 0];
            EXPECT_EQ(refused["status"], "failed");
            EXPECT_EQ(refused["error"]["place"], (dir / "a.mtl").string());
            EXPECT_EQ(refused["error"]["text"].get<std::string>().rfind(
                          "this file is read for another result", 0),
                      0u)
                << refused;
            EXPECT_FALSE(fs::exists(dir / "a.obj"));
            EXPECT_EQ(files[late ? 0 : 1]["status"], "ok");
            EXPECT_TRUE(fs::exists(dir / "b.obj"));
        }
}

// A picture that a glTF output copies beside itself, over one that another input names.
TEST(Batch, PicturesBesideAnOutputSpareThoseOfOtherInputs) {
    const TempDir dir;
    fs::create_directories(dir / "in");
    fs::create_directories(dir / "out");
    const std::string picture = "not a picture, and nobody has to read it";
    // What a.gltf would be written with; the second input is read from it.
    for (const char* const name : {"out/a.bin"}) write_text(dir / name, picture);
    write_text(dir / "in/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_text(dir / "in/b.obj", "mtllib b.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    write_text(dir / "in/b.mtl", "newmtl m\nmap_Kd ../out/a.bin\n");
    const test::Ran ran =
        run_here({"prepare", (dir / "in/a.obj").string(), (dir / "in/b.obj").string(), "--format",
                  "gltf", "-o", (dir / "out").string() + "/", "--json"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_EQ(file_text(dir / "out/a.bin"), picture);
    EXPECT_EQ(ran.json()["files"][0]["status"], "failed");
    EXPECT_EQ(ran.json()["files"][1]["status"], "ok");
}

// Outputs of an earlier run are nobody's source.
TEST(Batch, ASecondRunReplacesWhatTheFirstHasWritten) {
    const TempDir dir;
    for (const char* const name : {"a", "b"}) {
        write_text(
            dir / (std::string(name) + ".obj"),
            "mtllib " + std::string(name) + ".mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
        write_text(dir / (std::string(name) + ".mtl"), "newmtl m\nKd 1 0 0\n");
    }
    for (int run = 0; run < 2; ++run) {
        const test::Ran ran =
            run_here({"prepare", (dir / "a.obj").string(), (dir / "b.obj").string(), "--format",
                      "obj", "-o", (dir / "out").string() + "/"});
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
    }
}

TEST(Batch, OutputDirectoriesAreMadeOnlyWhereSomethingIsWritten) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    write_text(dir / "bad.obj", "v 0 0 0\nf 1 2 9\n");
    const std::string cube = (dir / "cube.obj").string(), bad = (dir / "bad.obj").string();
    EXPECT_EQ(run_here({"prepare", bad, "-o", (dir / "no/where/x.glb").string()}).exit_code, 1);
    EXPECT_EQ(run_here({"render", bad, "-o", (dir / "no/where/x.png").string()}).exit_code, 1);
    EXPECT_EQ(run_here({"validate", bad, "-o", (dir / "no/where").string()}).exit_code, 1);
    EXPECT_FALSE(fs::exists(dir / "no"));

    EXPECT_EQ(run_here({"prepare", cube, "-o", (dir / "p/q/x.glb").string()}).exit_code, 0);
    EXPECT_EQ(run_here({"prepare", cube, "-o", (dir / "p/r/s/").string()}).exit_code, 0);
    EXPECT_EQ(
        run_here({"render", cube, "-o", (dir / "r/s/x.png").string(), "--size", "16x16"}).exit_code,
        0);
    EXPECT_EQ(run_here({"validate", cube, "-o", (dir / "v/w").string(), "--panel", "64"}).exit_code,
              0);
    EXPECT_EQ(run_here({"diff", (dir / "r/s/x.png").string(), (dir / "r/s/x.png").string(),
                        "--heat-map", (dir / "d/h.png").string()})
                  .exit_code,
              0);
    for (const char* name :
         {"p/q/x.glb", "p/r/s/cube.glb", "r/s/x.png", "v/w/cube.html", "d/h.png"})
        EXPECT_TRUE(fs::is_regular_file(dir / name)) << name;

    write_text(dir / "file", "");
    const test::Ran blocked = run_here({"prepare", cube, "-o", (dir / "file/x/y.glb").string()});
    EXPECT_EQ(blocked.exit_code, 1);
    EXPECT_NE(blocked.err.find((dir / "file").string() + ": a file of this name is in the way"),
              std::string::npos)
        << blocked.err;
}

class Several : public ::testing::Test {
  protected:
    Several() {
        for (int n = 0; n < 12; ++n) {
            const fs::path path = dir_ / ("m" + std::to_string(n) + ".obj");
            write_text(path, n == 5   ? "v 0 0 0\nf 1 2 9\n"
                             : n == 9 ? "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"
                                      : test::sphere_obj(4 + 3 * n, 3 + n));
            inputs_.push_back(path.string());
        }
        inputs_.push_back((dir_ / "absent.obj").string());
    }
    test::Ran run(const std::vector<std::string>& more) {
        fs::remove_all(dir_ / "out");
        std::vector<std::string> words{"prepare"};
        words.insert(words.end(), inputs_.begin(), inputs_.end());
        words.insert(words.end(), {"-o", (dir_ / "out").string()});
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words);
    }
    std::string outputs() {
        std::string all;
        for (int n = 0; n < 12; ++n)
            all += file_text(dir_ / ("out/m" + std::to_string(n) + ".glb")) + "|";
        return all;
    }
    TempDir dir_;
    std::vector<std::string> inputs_;
};

TEST_F(Several, AtOnceOnAnyThreadsGiveTheSameBytesAndWordsInTheSameOrder) {
    const test::Ran one = run({"--json"});
    const std::string bytes = outputs();
    EXPECT_EQ(one.exit_code, 1);
    for (const char* jobs : {"2", "3", "16", "0"}) {
        const test::Ran many = run({"--json", "--jobs", jobs});
        EXPECT_EQ(many.exit_code, 1) << jobs;
        EXPECT_EQ(without_times(many.json()), without_times(one.json())) << jobs;
        EXPECT_EQ(many.err, one.err) << jobs;
        EXPECT_TRUE(outputs() == bytes) << jobs;
    }
}

TEST_F(Several, JsonLinesAreARecordForEachFileAndASummary) {
    const test::Ran document = run({"--json"});
    for (const char* jobs : {"1", "4"}) {
        const test::Ran ran = run({"--json-lines", "--jobs", jobs});
        EXPECT_EQ(ran.exit_code, 1);
        const std::vector<json> lines = lines_of(ran.out);
        ASSERT_EQ(lines.size(), inputs_.size() + 1);
        for (std::size_t n = 0; n < inputs_.size(); ++n) {
            EXPECT_EQ(lines[n]["record"], "file");
            EXPECT_EQ(lines[n]["input"], inputs_[n]);
            json file = lines[n];
            for (const char* head : {"record", "command", "version"}) file.erase(head);
            EXPECT_EQ(without_times(file), without_times(document.json()["files"][n]));
        }
        EXPECT_EQ(lines.back()["record"], "summary");
        EXPECT_EQ(without_times(lines.back()["summary"]),
                  without_times(document.json()["summary"]));
    }
    // Other subcommands that take several files have them as well.
    std::vector<std::string> words{"inspect", "--json-lines"};
    words.insert(words.end(), inputs_.begin(), inputs_.end());
    const std::vector<json> inspected = lines_of(run_here(words).out);
    ASSERT_EQ(inspected.size(), inputs_.size() + 1);
    EXPECT_EQ(inspected[5]["status"], "failed");
    EXPECT_EQ(inspected.back()["summary"]["failed"], 2);
}

// FIPS 180-4's own examples.
TEST(Hash, IsSha256) {
    const auto of = [](const std::string& text) {
        return meshprep::sha256(std::as_bytes(std::span<const char>(text)));
    };
    EXPECT_EQ(of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(of(std::string(1000000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

class ManifestTest : public ::testing::Test {
  protected:
    ManifestTest() {
        write_text(dir_ / "a.obj", "mtllib a.mtl\nusemtl m\n" + test::cube_obj());
        write_text(dir_ / "a.mtl", "newmtl m\nKd 1 0 0\n");
        write_text(dir_ / "b.obj", test::sphere_obj(8, 4));
    }
    // The state of each file, in order.
    std::string run(const std::vector<std::string>& more = {}, int expected = 0) {
        std::vector<std::string> words{"prepare",
                                       (dir_ / "a.obj").string(),
                                       (dir_ / "b.obj").string(),
                                       "-o",
                                       (dir_ / "out").string(),
                                       "--manifest",
                                       manifest().string(),
                                       "--json",
                                       "--skip-unchanged"};
        words.insert(words.end(), more.begin(), more.end());
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, expected) << ran.err;
        std::string states;
        const json document = ran.json();
        for (const json& file : document.value("files", json::array()))
            states += file["status"].get<std::string>() + " ";
        return states;
    }
    fs::path manifest() const { return dir_ / "out/made.json"; }
    TempDir dir_;
};

TEST_F(ManifestTest, SkipsWhatIsUnchangedAndDoesTheRest) {
    EXPECT_EQ(run(), "ok ok ");
    const std::string first = file_text(manifest());
    EXPECT_EQ(run(), "skipped skipped ");
    EXPECT_EQ(file_text(manifest()), first);
    EXPECT_EQ(run({"--jobs", "2"}), "skipped skipped ");

    write_text(dir_ / "b.obj", test::sphere_obj(9, 4));
    EXPECT_EQ(run(), "skipped ok ");
    EXPECT_EQ(run(), "skipped skipped ");
    // What is read with the input counts, too.
    write_text(dir_ / "a.mtl", "newmtl m\nKd 0 1 0\n");
    EXPECT_EQ(run(), "ok skipped ");
    // A damaged output is no finished one: cut short, changed by a byte, gone.
    const std::string whole = file_text(dir_ / "out/a.glb");
    write_text(dir_ / "out/a.glb", whole.substr(0, whole.size() - 1));
    EXPECT_EQ(run(), "ok skipped ");
    EXPECT_EQ(file_text(dir_ / "out/a.glb"), whole);
    std::string changed = whole;
    changed[changed.size() / 2] ^= 1;
    write_text(dir_ / "out/a.glb", changed);
    EXPECT_EQ(run(), "ok skipped ");
    fs::remove(dir_ / "out/a.glb");
    EXPECT_EQ(run(), "ok skipped ");
    EXPECT_EQ(file_text(dir_ / "out/a.glb"), whole);
    // Other settings make other files; those that decide nothing do not count.
    EXPECT_EQ(run({"--threads", "1", "--explain"}), "skipped skipped ");
    EXPECT_EQ(run({"--hard-angle", "30"}), "ok ok ");
    EXPECT_EQ(run({"--hard-angle", "30"}), "skipped skipped ");
}

TEST_F(ManifestTest, HoldsHashesSettingsAndFindings) {
    EXPECT_EQ(run({"--weight", "area"}), "ok ok ");
    const json document = json::parse(file_text(manifest()), nullptr, false);
    EXPECT_EQ(document["settings"], (json{{"--weight", {"area"}}}));
    const json& file = document["files"][0];
    EXPECT_EQ(file["input"], (dir_ / "a.obj").string());
    EXPECT_EQ(file["status"], "ok");
    ASSERT_EQ(file["sources"].size(), 2u);
    EXPECT_EQ(file["sources"][1]["path"], (dir_ / "a.mtl").string());
    const std::string bytes = file_text(dir_ / "out/a.glb");
    EXPECT_EQ(file["outputs"][0]["sha256"],
              meshprep::sha256(std::as_bytes(std::span<const char>(bytes))));
    EXPECT_TRUE(file["said"].contains("findings"));
    EXPECT_EQ(document.dump().find("milliseconds"), std::string::npos);
}

TEST_F(ManifestTest, WhatFailedOrMissedSomethingIsDoneAgain) {
    write_text(dir_ / "b.obj", "v 0 0 0\nf 1 2 9\n");
    fs::remove(dir_ / "a.mtl");
    EXPECT_EQ(run({}, 1), "ok failed ");
    EXPECT_EQ(run({}, 1), "ok failed ");
    write_text(dir_ / "a.mtl", "newmtl m\nKd 1 0 0\n");
    write_text(dir_ / "b.obj", test::cube_obj());
    EXPECT_EQ(run(), "ok ok ");
    EXPECT_EQ(run(), "skipped skipped ");
}

TEST_F(ManifestTest, ADamagedManifestIsAnErrorAndAnotherVersionsIsNoHelp) {
    EXPECT_EQ(run(), "ok ok ");
    const std::string good = file_text(manifest());
    write_text(manifest(), good.substr(0, good.size() / 2));
    EXPECT_EQ(run({}, 1), "");
    EXPECT_EQ(file_text(manifest()), good.substr(0, good.size() / 2));
    json other = json::parse(good);
    other["version"] = "0.0.1";
    write_text(manifest(), other.dump());
    EXPECT_EQ(run(), "ok ok ");
}

TEST(Prepare, ObjInPlaceLeavesItsLibraryAlone) {
    const TempDir dir;
    const std::string mtl = "newmtl red\nKd 1 0 0\nillum 7\nPr 0.3\nunknown_word 5\n";
    write_text(dir / "shared.mtl", mtl);
    write_text(dir / "cube.obj", "mtllib shared.mtl\nusemtl red\n" + test::cube_obj());
    const test::Ran ran = run_here({"prepare", (dir / "cube.obj").string(), "--in-place"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(file_text(dir / "shared.mtl"), mtl);
    EXPECT_EQ(dir.names(), (std::vector<std::string>{"cube.obj", "shared.mtl"}));
    const std::string obj = file_text(dir / "cube.obj");
    EXPECT_NE(obj.find("\nmtllib shared.mtl\n"), std::string::npos) << obj;
    EXPECT_NE(obj.find("\nusemtl red\n"), std::string::npos) << obj;
    EXPECT_NE(obj.find("\nvn "), std::string::npos) << obj;
}

TEST(Prepare, TextInPlaceStaysText) {
    const TempDir dir;
    write_text(dir / "cube.obj", test::cube_obj());
    for (const std::string name : {"text.ply", "text.stl", "bytes.ply", "bytes.stl"}) {
        std::vector<std::string> make{"prepare", (dir / "cube.obj").string(), "-o",
                                      (dir / name).string()};
        const bool text = name.starts_with("text");
        if (text) make.push_back("--ascii");
        ASSERT_EQ(run_here(make).exit_code, 0);
        const std::string before = file_text(dir / name);
        ASSERT_EQ(run_here({"prepare", (dir / name).string(), "--in-place"}).exit_code, 0);
        const std::string after = file_text(dir / name);
        EXPECT_EQ(after.find('\0') == std::string::npos, text) << name;
        if (name.ends_with(".stl")) {
            EXPECT_EQ(after, before);
        }
    }
}

// The first is written, the second refused, as where results have names of their own.
TEST(Batch, AFileThatComesInTwiceIsDoneOnceInPlace) {
    const TempDir dir;
    write_text(dir / "a.obj", test::cube_obj());
    fs::create_symlink("a.obj", dir / "z.obj");
    const std::string first = (dir / "a.obj").string(), link = (dir / "z.obj").string();
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"prepare", dir.path().string(), "--in-place"},
          {"prepare", first, first, "--in-place"},
          {"prepare", first, link, "--in-place"}}) {
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, 1);
        EXPECT_NE(ran.out.find("2 files: 1 ok, 1 failed"), std::string::npos) << ran.out << ran.err;
    }
    EXPECT_TRUE(fs::is_symlink(dir / "z.obj"));
}

// What a directory has and cannot be read is told, as where its name is given.
TEST(Batch, LinksThatLeadNowhereAreTold) {
    const TempDir dir;
    fs::create_directories(dir / "in/sub");
    write_text(dir / "in/sub/a.obj", test::cube_obj());
    fs::create_symlink("gone.obj", dir / "in/dangling.obj");
    fs::create_symlink("loop.obj", dir / "in/loop.obj");
    fs::create_symlink("gone.txt", dir / "in/other.txt");
    const std::vector<std::string> words = {"prepare", (dir / "in").string(), "-r", "-o",
                                            (dir / "out").string()};
    const test::Ran ran = run_here(words);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_NE(ran.out.find("3 files: 1 ok, 2 failed"), std::string::npos) << ran.out;
    EXPECT_NE(ran.err.find("dangling.obj: this is a link to 'gone.obj', which is not there"),
              std::string::npos)
        << ran.err;
    EXPECT_NE(ran.err.find("loop.obj: this is a link that leads back to itself"), std::string::npos)
        << ran.err;
}

TEST(Batch, ADirectoryThatIsClosedIsTold) {
    if (::geteuid() == 0) GTEST_SKIP() << "no directory is closed to root";
    const TempDir dir;
    fs::create_directories(dir / "in/closed");
    write_text(dir / "in/a.obj", test::cube_obj());
    fs::permissions(dir / "in/closed", fs::perms::none);
    const test::Ran closed =
        run_here({"prepare", (dir / "in").string(), "-r", "-o", (dir / "out").string()});
    fs::permissions(dir / "in/closed", fs::perms::owner_all);
    EXPECT_EQ(closed.exit_code, 1);
    EXPECT_NE(closed.err.find("closed: cannot list the directory"), std::string::npos)
        << closed.err;
}

}  // namespace
