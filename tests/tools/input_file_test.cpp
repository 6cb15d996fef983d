// Inputs that are packed or come from standard input, and results on standard output.
#include "meshprep/files/input_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <chrono>
#include <thread>

#include "command_runner.h"
#include "meshprep/files/archive.h"
#include "prep/image.h"
#include "prep/load.h"
#include "sanitized.h"

extern char** environ;

namespace {

namespace fs = std::filesystem;
using test::file_text;
using test::run_command;
using test::TempDir;
using test::write_text;

// gzip (bits 16 + 15) or bare deflate (−15) of a text, by zlib's own packer.
std::string packed(const std::string& text, int bits) {
    z_stream stream{};
    EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, bits, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::string out(deflateBound(&stream, uLong(text.size())) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    stream.avail_in = uInt(text.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = uInt(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

std::string gzip(const std::string& text) {
    return packed(text, 16 + 15);
}

// A zip file, written from PKWARE's description.
class ZipText {
  public:
    struct Entry {
        std::string name, text;
        bool deflate = true;
        std::uint32_t flags = 0, method = 99, mode = 0100644;  // 99: as `deflate` says
        std::optional<std::uint32_t> said_size = {};
    };
    void add(const Entry& e) {
        const std::string bytes = e.deflate ? packed(e.text, -15) : e.text;
        const std::uint32_t method = e.method != 99 ? e.method : e.deflate ? 8 : 0;
        const auto crc = std::uint32_t(
            ::crc32(0, reinterpret_cast<const Bytef*>(e.text.data()), uInt(e.text.size())));
        const std::uint32_t size = e.said_size.value_or(std::uint32_t(e.text.size()));
        const std::string common = u16(20) + u16(e.flags) + u16(method) + u32(0) + u32(crc) +
                                   u32(std::uint32_t(bytes.size())) + u32(size) +
                                   u16(std::uint32_t(e.name.size())) + u16(0);
        entries_ += u32(0x02014b50) + u16(3 << 8 | 20) + common + u16(0) + u16(0) + u16(0) +
                    u32(e.mode << 16) + u32(std::uint32_t(files_.size())) + e.name;
        files_ += u32(0x04034b50) + common + e.name + bytes;
        ++count_;
    }
    void add(const std::string& name, const std::string& text) { add(Entry{name, text}); }
    std::string text(const std::string& comment = "") const {
        return files_ + entries_ + u32(0x06054b50) + u16(0) + u16(0) + u16(count_) + u16(count_) +
               u32(std::uint32_t(entries_.size())) + u32(std::uint32_t(files_.size())) +
               u16(std::uint32_t(comment.size())) + comment;
    }

  private:
    static std::string u16(std::uint32_t n) {
        return {static_cast<char>(n & 255), static_cast<char>(n >> 8 & 255)};
    }
    static std::string u32(std::uint32_t n) { return u16(n & 0xffff) + u16(n >> 16); }
    std::string files_, entries_;
    std::uint32_t count_ = 0;
};

// The command with its own directory for temporary files, which must be empty afterwards.
class Input : public ::testing::Test {
  protected:
    Input() { fs::create_directory(dir_ / "tmp"); }
    test::Ran run(const std::vector<std::string>& words, const fs::path& in = "/dev/null") {
        test::Circumstances c;
        c.environment = {{"TMPDIR", (dir_ / "tmp").string()}};
        c.in = in;
        const test::Ran ran = run_command(words, c);
        EXPECT_TRUE(fs::is_empty(dir_ / "tmp")) << words[1];
        return ran;
    }
    void expect_error(const std::string& name, const std::string& text) {
        const test::Ran ran = run({"prepare", at(name), "-o", at("never.glb")});
        EXPECT_EQ(ran.exit_code, 1) << name;
        EXPECT_NE(ran.err.find(at(name)), std::string::npos) << ran.err;
        EXPECT_NE(ran.err.find(text), std::string::npos) << ran.err;
        EXPECT_EQ(ran.err.find((dir_ / "tmp").string()), std::string::npos) << ran.err;
        EXPECT_FALSE(fs::exists(at("never.glb"))) << name;
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    // What preparing the same file unpacked writes.
    std::string plain(const std::string& name, const std::string& format = "glb") {
        EXPECT_EQ(run({"prepare", at(name), "-o", at("plain." + format)}).exit_code, 0);
        return file_text(dir_ / ("plain." + format));
    }
    TempDir dir_;
};

TEST_F(Input, GzipIsReadAsTheFileInIt) {
    write_text(dir_ / "wood.mtl", "newmtl w\nKd 1 0.5 0\n");
    write_text(dir_ / "cube.obj", "mtllib wood.mtl\nusemtl w\n" + test::cube_obj());
    write_text(dir_ / "cube.obj.gz", gzip(file_text(dir_ / "cube.obj")));
    const std::string glb = plain("cube.obj");
    // With what lies beside it.
    const test::Ran ran = run({"prepare", at("cube.obj.gz"), "-o", at("g.glb")});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
    EXPECT_EQ(file_text(dir_ / "g.glb"), glb);
    // Members in a row are one file; an ending inside is not needed where the bytes tell.
    const std::string text = file_text(dir_ / "cube.obj");
    write_text(dir_ / "two.gz", gzip(text.substr(0, 50)) + gzip(text.substr(50)));
    EXPECT_EQ(run({"prepare", at("two.gz"), "-o", at("t.glb")}).exit_code, 0);
    fs::copy(dir_ / "cube.obj", dir_ / "two.obj");  // meshes are named by their files
    EXPECT_EQ(file_text(dir_ / "t.glb"), plain("two.obj"));
    // A directory is read for them, and their outputs are named by the mesh.
    fs::create_directory(dir_ / "in");
    fs::copy(dir_ / "cube.obj.gz", dir_ / "in/cube.obj.gz");
    EXPECT_EQ(run({"prepare", at("in"), "-o", at("out")}).exit_code, 0);
    EXPECT_TRUE(fs::exists(dir_ / "out/cube.glb"));
    for (const char* subcommand : {"inspect"})
        EXPECT_EQ(run({subcommand, at("cube.obj.gz")}).exit_code, 0);
    EXPECT_EQ(run({"render", at("cube.obj.gz"), "-o", at("x.png"), "--size", "16x16"}).exit_code,
              0);
    EXPECT_EQ(run({"validate", at("cube.obj.gz"), "-o", at("v"), "--panel", "64"}).exit_code, 0);
    EXPECT_EQ(run({"diff", "--normals", at("g.glb"), at("t.glb")}).exit_code, 0);
}

TEST_F(Input, GzipThatIsDamagedIsAnErrorThatNamesIt) {
    const std::string good = gzip(test::sphere_obj(20, 10));
    write_text(dir_ / "short.obj.gz", good.substr(0, good.size() / 2));
    expect_error("short.obj.gz", "is cut short; fetch it again");
    std::string bad = good;
    bad[bad.size() / 2] ^= 0x55;
    bad[bad.size() / 2 + 1] ^= 0x55;
    write_text(dir_ / "bad.obj.gz", bad);
    expect_error("bad.obj.gz", "fetch it again");
    write_text(dir_ / "no.obj.gz", test::cube_obj());
    expect_error("no.obj.gz", "this is no gzip file, whatever its ending says");
    write_text(dir_ / "wrong.obj.gz", gzip("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"));
    expect_error("wrong.obj.gz", at("wrong.obj.gz") + ":4: vertex index 9 is out of range");
    ZipText zip;
    zip.add("sub/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    write_text(dir_ / "wrong.zip", zip.text());
    expect_error("wrong.zip", at("wrong.zip") + "/sub/a.obj:4: vertex index 9");
}

// The mesh with its library and picture, all from within the archive.
std::string textured_zip(const fs::path& png) {
    ZipText zip;
    zip.add({"chair/", "", false});
    zip.add({"chair/chair.obj", "mtllib lib/chair.mtl\nusemtl m\n" + test::textured_cube_obj()});
    zip.add({"chair/lib/chair.mtl", "newmtl m\nKd 1 1 1\nmap_Kd ../tex/t.png\n", false});
    zip.add({"chair/tex/t.png", file_text(png), false});
    zip.add({"__MACOSX/chair/._chair.obj", "no mesh"});
    zip.add({"chair/._chair.obj", "no mesh"});
    zip.add({"readme.txt", "hello"});
    return zip.text("a comment");
}

TEST_F(Input, ZipWithOneMeshIsReadWithWhatLiesBesideIt) {
    prep::Image image;
    image.width = image.height = 2;
    image.channels = 3;
    image.pixels.assign(12, 0.25f);
    ASSERT_TRUE(prep::save_image(dir_ / "t.png", image));
    write_text(dir_ / "chair.zip", textured_zip(dir_ / "t.png"));
    fs::create_directories(dir_ / "chair/lib");
    fs::create_directories(dir_ / "chair/tex");
    fs::copy(dir_ / "t.png", dir_ / "chair/tex/t.png");
    write_text(dir_ / "chair/lib/chair.mtl", "newmtl m\nKd 1 1 1\nmap_Kd ../tex/t.png\n");
    write_text(dir_ / "chair/chair.obj",
               "mtllib lib/chair.mtl\nusemtl m\n" + test::textured_cube_obj());
    const std::string glb = plain("chair/chair.obj");
    const test::Ran ran = run({"prepare", at("chair.zip"), "-o", at("z.glb")});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.err, "");
    EXPECT_EQ(file_text(dir_ / "z.glb"), glb);
    // A format that refers to pictures gets its own copy: the unpacked one is gone.
    EXPECT_EQ(run({"prepare", at("chair.zip"), "-o", at("o/z.obj")}).exit_code, 0);
    EXPECT_EQ(file_text(dir_ / "o/z_image0.png"), file_text(dir_ / "t.png"));
    EXPECT_NE(file_text(dir_ / "o/z.mtl").find("map_Kd z_image0.png"), std::string::npos);
    EXPECT_EQ(run({"render", at("chair.zip"), "-o", at("x.png"), "--size", "16x16"}).exit_code, 0);
    EXPECT_EQ(run({"inspect", at("chair.zip")}).exit_code, 0);
    EXPECT_EQ(run({"prepare", at("chair.zip"), "--in-place"}).exit_code, 2);
}

// Pictures above the packed file are its own, those above the temporary directory are not.
TEST_F(Input, PackedFilesFindPicturesWhereTheUnpackedOnesDo) {
    prep::Image image;
    image.width = image.height = 2;
    image.channels = 3;
    image.pixels.assign(12, 0.25f);
    fs::create_directories(dir_ / "assets/models");
    fs::create_directories(dir_ / "assets/textures");
    fs::create_directories(dir_ / "tmp/run");
    fs::create_directories(dir_ / "tmp/textures");
    ASSERT_TRUE(prep::save_image(dir_ / "assets/textures/wood.png", image));
    ASSERT_TRUE(prep::save_image(dir_ / "tmp/textures/strange.png", image));
    ASSERT_TRUE(prep::save_image(dir_ / "tmp/run/strange.png", image));
    write_text(dir_ / "assets/models/a.mtl",
               "newmtl m\nKd 1 1 1\nmap_Kd ../textures/wood.png\nmap_Ks strange.png\n");
    const std::string text = "mtllib a.mtl\nusemtl m\n" + test::textured_cube_obj();
    write_text(dir_ / "assets/models/a.obj", text);
    const test::Circumstances elsewhere{.environment = {{"TMPDIR", (dir_ / "tmp/run").string()}}};
    const test::Ran unpacked =
        run_command({"prepare", at("assets/models/a.obj"), "-o", at("u.glb")}, elsewhere);
    EXPECT_EQ(unpacked.exit_code, 0) << unpacked.err;
    fs::remove(dir_ / "assets/models/a.obj");
    write_text(dir_ / "assets/models/a.obj.gz", gzip(text));
    const test::Ran ran =
        run_command({"prepare", at("assets/models/a.obj.gz"), "-o", at("p.glb")}, elsewhere);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(file_text(dir_ / "p.glb"), file_text(dir_ / "u.glb"));
    EXPECT_NE(ran.err.find("strange.png"), std::string::npos) << ran.err;
    EXPECT_EQ(ran.err.find("tmp/run"), std::string::npos) << ran.err;
}

// Directories for what is unpacked have another name in every run; what is written has not.
TEST_F(Input, PicturesThatAreMissingAreNamedAlikeInEveryRun) {
    write_text(dir_ / "t.mtl",
               "newmtl a\nmap_Kd tex.png\nmap_Ks ../up.png\nmap_Ke ../../far.png\n"
               "map_Bump broken.png\n");
    write_text(dir_ / "broken.png", "no picture");
    const std::string obj =
        "mtllib t.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "f 1/1 2/2 3/3\n";
    write_text(dir_ / "t.obj", obj);
    write_text(dir_ / "t.obj.gz", gzip(obj));
    ZipText zip;
    for (const char* const name : {"t.mtl", "broken.png"}) zip.add(name, file_text(dir_ / name));
    zip.add("t.obj", obj);
    write_text(dir_ / "t.zip", zip.text());
    fs::create_directory(dir_ / "private");
    const test::Circumstances around{.environment = {{"TMPDIR", at("private")}},
                                     .in = dir_ / "t.obj"};
    for (const char* const ending : {"obj", "glb", "gltf"})
        for (const char* const name : {"t.obj.gz", "t.zip", "-"}) {
            if (test::sanitized && *ending != 'o') break;
            const std::string input = *name == '-' ? "-" : at(name);
            std::vector<std::string> outputs, said;
            for (int run = 0; run < 2; ++run) {
                const fs::path out = dir_ / "out";
                fs::remove_all(out);
                const test::Ran ran =
                    run_command({"prepare", input, "-o", (out / "o.").string() + ending}, around);
                EXPECT_EQ(ran.exit_code, 0) << ran.err;
                std::string bytes;
                for (const auto& file : fs::directory_iterator(out))
                    bytes += file.path().filename().string() + file_text(file.path());
                outputs.push_back(bytes);
                said.push_back(ran.err);
                for (const std::string& text : {bytes, ran.err, ran.out})
                    EXPECT_EQ(text.find("/private/"), std::string::npos) << name << text;
            }
            EXPECT_EQ(outputs[0], outputs[1]) << name << ending;
            EXPECT_EQ(said[0], said[1]) << name << ending;
        }
    for (const char* const name : {"t.obj.gz", "t.zip", "-"}) {
        const test::Ran ran = run_command(
            {"render", *name == '-' ? "-" : at(name), "-o", at("t.png"), "--size", "8x8"}, around);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        // Beside standard input there are no libraries that would name pictures.
        EXPECT_EQ(ran.err.find("texture left out") == std::string::npos, *name == '-') << ran.err;
        EXPECT_EQ(ran.err.find("/private/"), std::string::npos) << ran.err;
    }
    // What lies beside the packed file is named where it lies.
    const test::Ran ran =
        run_command({"render", at("t.obj.gz"), "-o", at("t.png"), "--size", "8x8"}, around);
    EXPECT_NE(ran.err.find(at("tex.png")), std::string::npos) << ran.err;
}

// One directory of links for all packed files of a folder, not one each.
TEST_F(Input, PackedFilesOfAFolderShareTheLinksToTheirSiblings) {
    const TempDir dir;
    const auto obj = [](const char* mtl) {
        return "mtllib " + std::string(mtl) +
               ".mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    };
    for (const char* name : {"a", "b", "c"}) {
        write_text(dir / (std::string(name) + ".obj.gz"), gzip(obj(name)));
        write_text(dir / (std::string(name) + ".mtl"), std::string("newmtl m\nKd 1 0 0\n"));
    }
    write_text(dir / "c.obj", obj("b"));  // the name that the unpacked one would have
    meshprep::SiblingLinks links;
    const auto a = meshprep::InputFile::open(dir / "a.obj.gz", "", &links);
    const auto c = meshprep::InputFile::open(dir / "c.obj.gz", "", &links);
    ASSERT_TRUE(a && c);
    fs::path gone;
    {
        const auto b = meshprep::InputFile::open(dir / "b.obj.gz", "", &links);
        ASSERT_TRUE(b);
        gone = b->path();
        EXPECT_EQ(gone.filename(), "b.obj");
        EXPECT_EQ(gone.parent_path(), a->path().parent_path());
        EXPECT_EQ(b->relabelled(gone.string()), (dir / "b.obj.gz").string());
        EXPECT_EQ(b->relabelled((gone.parent_path() / "b.mtl").string()), (dir / "b.mtl").string());
        EXPECT_TRUE(b->passing(gone));
        EXPECT_FALSE(b->passing(gone.parent_path() / "b.mtl"));
    }
    EXPECT_FALSE(fs::exists(gone));
    EXPECT_NE(c->path().parent_path(), a->path().parent_path());  // c.obj is another file
    for (const auto* input : {&a, &c}) {
        const auto scene = prep::load_scene((*input)->path());
        ASSERT_TRUE(scene);
        ASSERT_EQ(scene->materials.size(), 1u);
        EXPECT_EQ(scene->libraries.size(), 1u);
        EXPECT_EQ(scene->libraries[0].filename(), (*input)->path().stem().string() + ".mtl");
    }
    EXPECT_EQ(file_text(dir / "c.obj"), obj("b"));
}

TEST_F(Input, ZipsThatCannotBeReadSaySoAndWhatToDo) {
    const std::string cube = test::cube_obj();
    const auto write = [&](const std::string& name, const std::vector<ZipText::Entry>& entries) {
        ZipText zip;
        for (const ZipText::Entry& e : entries) zip.add(e);
        write_text(dir_ / name, zip.text());
    };
    write("two.zip", {{"a.obj", cube}, {"sub/b.stl", cube}});
    expect_error("two.zip", "holds 2 mesh files (a.obj, sub/b.stl), and one is read");
    write("none.zip", {{"a.txt", cube}});
    expect_error("none.zip", "the archive holds no mesh file among its 1 file");
    write("scene.zip", {{"s.json", "{}"}, {"a.txt", cube}});
    expect_error("scene.zip", "among its 2 files; a scene file is read where it is unpacked");
    write("up.zip", {{"../../evil.obj", cube}});
    expect_error("up.zip", "leads out of the archive with '..'; do not trust");
    write("up2.zip", {{"a\\..\\..\\evil.obj", cube}});
    expect_error("up2.zip", "leads out of the archive with '..'");
    write("abs.zip", {{(dir_ / "evil.obj").string(), cube}});
    expect_error("abs.zip", "has an absolute name");
    write("drive.zip", {{"C:\\evil.obj", cube}});
    expect_error("drive.zip", "has an absolute name");
    write("link.zip", {{"a.obj", "/etc/passwd", false, 0, 99, 0120777}});
    expect_error("link.zip", "an entry is a link, which is not followed");
    write("secret.zip", {{"a.obj", cube, true, 1}});
    expect_error("secret.zip", "an entry is encrypted; unpack it first");
    write("lzma.zip", {{"a.obj", cube, true, 0, 14}});
    expect_error("lzma.zip", "is packed by method 14");
    write("twice.zip", {{"a.obj", cube}, {"a.obj", cube}});
    expect_error("twice.zip", "two entries have this name");
    // A size that the bytes do not keep, either way.
    write("more.zip", {{"a.obj", cube, true, 0, 99, 0100644, std::uint32_t(cube.size() + 9)}});
    expect_error("more.zip", "damaged or cut short");
    write("less.zip", {{"a.obj", cube, true, 0, 99, 0100644, std::uint32_t(cube.size() - 9)}});
    expect_error("less.zip", "damaged or cut short");
    ZipText zip;
    zip.add("a.obj", cube);
    const std::string good = zip.text();
    write_text(dir_ / "short.zip", good.substr(0, good.size() - 30));
    expect_error("short.zip", "its end is missing: it may be cut short");
    // No prefix and no damaged byte is worse than an error.
    for (std::size_t k = 0; k < good.size(); ++k) {
        std::string bad = good;
        bad[k] = static_cast<char>(bad[k] ^ 0xff);
        const TempDir out;
        write_text(out / "z.zip", bad);
        (void)meshprep::unpack_zip(out / "z.zip", out / "u");
        write_text(out / "z.zip", good.substr(0, k));
        EXPECT_FALSE(meshprep::unpack_zip(out / "z.zip", out / "v")) << k;
    }
    EXPECT_FALSE(fs::exists(dir_ / "evil.obj"));
}

TEST_F(Input, BombsAreRefusedByTheStatedLimit) {
    const std::string zeros(std::size_t(100) << 20, '\0');  // deflate packs it 1,000 to 1
    write_text(dir_ / "bomb.obj.gz", gzip(zeros));
    expect_error("bomb.obj.gz", "it unpacks to more than 64 MiB");
    ZipText zip;
    zip.add("a.obj", zeros);
    write_text(dir_ / "bomb.zip", zip.text());
    expect_error("bomb.zip", "it unpacks to more than 64 MiB");
    const meshprep::ArchiveLimits limits;
    EXPECT_EQ(limits.of(1000), std::uint64_t(64) << 20);
    EXPECT_EQ(limits.of(std::uint64_t(1) << 20), std::uint64_t(200) << 20);
    EXPECT_EQ(limits.of(~std::uint64_t(0)), std::uint64_t(16) << 30);
}

TEST_F(Input, StandardInputIsReadByItsFirstBytes) {
    write_text(dir_ / "cube.obj", test::cube_obj());
    fs::copy(dir_ / "cube.obj", dir_ / "stdin.obj");  // meshes are named by their files
    const std::string glb = plain("stdin.obj");
    plain("cube.obj", "ply");
    plain("cube.obj", "stl");
    for (const char* name : {"cube.obj", "plain.glb", "plain.ply"}) {
        const test::Ran ran = run({"inspect", "-", "--json"}, dir_ / name);
        EXPECT_EQ(ran.exit_code, 0) << name << ran.err;
        EXPECT_EQ(ran.json()["files"][0]["counts"]["triangles"], 12) << name;
    }
    // Binary STL has no first bytes of its own: the user says it.
    const test::Ran unknown = run({"inspect", "-"}, dir_ / "plain.stl");
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_NE(unknown.err.find("standard input: its first bytes tell no format; say it with "
                               "--input-format"),
              std::string::npos)
        << unknown.err;
    EXPECT_EQ(run({"inspect", "-", "--input-format", "stl"}, dir_ / "plain.stl").exit_code, 0);
    write_text(dir_ / "cube.obj.gz", gzip(file_text(dir_ / "cube.obj")));
    EXPECT_EQ(run({"inspect", "-"}, dir_ / "cube.obj.gz").exit_code, 0);
    ZipText zip;
    zip.add("a.obj", test::cube_obj());
    write_text(dir_ / "a.zip", zip.text());
    EXPECT_EQ(run({"inspect", "-"}, dir_ / "a.zip").exit_code, 0);
    EXPECT_EQ(run({"prepare", "-", "-o", at("s.glb")}, dir_ / "cube.obj").exit_code, 0);
    EXPECT_EQ(file_text(dir_ / "s.glb"), glb);
    EXPECT_EQ(run({"prepare", "-", "-o", at("made/")}, dir_ / "cube.obj").exit_code, 0);
    EXPECT_TRUE(fs::exists(dir_ / "made/stdin.glb"));
    EXPECT_EQ(
        run({"render", "-", "-o", at("x.png"), "--size", "16x16"}, dir_ / "cube.obj").exit_code, 0);
    const test::Ran empty = run({"inspect", "-"});
    EXPECT_EQ(empty.exit_code, 1);
    EXPECT_NE(empty.err.find("standard input: is empty"), std::string::npos) << empty.err;
    // Errors name the stream, not a file that nobody gave.
    write_text(dir_ / "bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    const test::Ran bad = run({"inspect", "-"}, dir_ / "bad.obj");
    EXPECT_NE(bad.err.find("meshprep: error: standard input:4"), std::string::npos) << bad.err;
}

TEST_F(Input, StandardOutputGetsTheBytesAndWordsGoElsewhere) {
    write_text(dir_ / "cube.obj", test::cube_obj());
    fs::copy(dir_ / "cube.obj", dir_ / "stdin.obj");
    for (const char* format : {"glb", "ply", "stl", "off", "obj"}) {
        const std::string bytes = plain("stdin.obj", format);
        const test::Ran ran =
            run({"prepare", "-", "-o", "-", "--format", format}, dir_ / "cube.obj");
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.out, bytes) << format;
        EXPECT_NE(ran.err.find("- → -"), std::string::npos) << ran.err;
        EXPECT_EQ(run({"prepare", at("cube.obj"), "-o", "-", "--format", format, "-q"}).err, "");
    }
    const test::Ran two = run({"prepare", at("cube.obj"), "-o", "-", "--format", "gltf"});
    EXPECT_EQ(two.exit_code, 1);
    EXPECT_EQ(two.out, "");
    EXPECT_NE(two.err.find("this result is 2 files, and standard output takes one"),
              std::string::npos)
        << two.err;
    EXPECT_EQ(run({"prepare", at("cube.obj"), "-o", "-"}).exit_code, 2);
    EXPECT_EQ(run({"prepare", at("cube.obj"), "-o", "-", "--format", "glb", "--json"}).exit_code,
              2);
    EXPECT_EQ(
        run({"prepare", at("cube.obj"), at("plain.glb"), "-o", "-", "--format", "glb"}).exit_code,
        2);
}

TEST_F(Input, PicturesGoToStandardOutputToo) {
    write_text(dir_ / "cube.obj", test::cube_obj());
    ASSERT_EQ(run({"render", at("cube.obj"), "-o", at("x.png"), "--size", "16x16"}).exit_code, 0);
    const test::Ran ran =
        run({"render", at("cube.obj"), "-o", "-", "--format", "png", "--size", "16x16"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.out, file_text(dir_ / "x.png"));
    EXPECT_NE(ran.err.find(at("cube.obj") + " → -  16×16"), std::string::npos) << ran.err;
    for (const std::vector<std::string>& more :
         std::vector<std::vector<std::string>>{{},
                                               {"--format", "zzz"},
                                               {"--format", "png", "--json"},
                                               {"--format", "png", "--turntable", "2"},
                                               {"--format", "exr", "--buffers", "depth"}}) {
        std::vector<std::string> words{"render", at("cube.obj"), "-o", "-"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run(words).exit_code, 2);
    }
}

TEST_F(Input, InputFormatOverrulesTheEnding) {
    write_text(dir_ / "wood.mtl", "newmtl w\nKd 1 0.5 0\n");
    write_text(dir_ / "scan.dat", "mtllib wood.mtl\nusemtl w\n# no first bytes\n" +
                                      std::string(600, '#') + "\n" + test::cube_obj());
    EXPECT_EQ(run({"inspect", at("scan.dat")}).exit_code, 1);
    const test::Ran ran = run({"inspect", at("scan.dat"), "--input-format", "obj", "--json"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(ran.json()["files"][0]["counts"]["materials"], 1);
    EXPECT_EQ(ran.json()["files"][0]["warnings"].size(), 0u) << ran.out;
    EXPECT_EQ(run({"inspect", at("scan.dat"), "--input-format", "jpg"}).exit_code, 2);
}

// `meshprep inspect -`, sent a signal once it has a directory for what it unpacks: standard input
// that never ends holds it. Its status; -1 if it did not start.
int status_of_interrupted(int number, const fs::path& tmp, std::chrono::milliseconds step) {
    int ends[2];
    if (::pipe(ends) != 0) return -1;
    std::string command = test::command_path().string(), verb = "inspect", dash = "-";
    char* const argv[] = {command.data(), verb.data(), dash.data(), nullptr};
    std::string variable = "TMPDIR=" + tmp.string();
    char* const env[] = {variable.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    sigset_t defaults;
    sigfillset(&defaults);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    pid_t process = 0;
    const int failed = ::posix_spawn(&process, command.c_str(), &actions, &attributes, argv, env);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[0]);
    int status = -1;
    if (!failed) {
        EXPECT_EQ(::write(ends[1], "v 0 0 0\n", 8), 8);
        const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
        while (fs::is_empty(tmp) && std::chrono::steady_clock::now() < give_up)
            if (step.count() > 0) std::this_thread::sleep_for(step);
        EXPECT_FALSE(fs::is_empty(tmp));
        for (const auto& entry : fs::directory_iterator(tmp))
            EXPECT_EQ(fs::status(entry.path()).permissions(), fs::perms::owner_all);
        ::kill(process, number);
        EXPECT_EQ(::waitpid(process, &status, 0), process);
    }
    ::close(ends[1]);
    return status;
}

TEST_F(Input, WhatWasUnpackedIsRemovedOnInterrupts) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        const int status =
            status_of_interrupted(number, dir_ / "tmp", std::chrono::milliseconds(10));
        EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 128 + number) << status;
        EXPECT_TRUE(fs::is_empty(dir_ / "tmp")) << number;
    }
}

// The directory goes while the command is about to write into it: the status stays the signal's.
TEST_F(Input, InterruptsThatComeEarlyAreNoOtherFailures) {
    for (int run = 0; run < (test::sanitized ? 20 : 100); ++run) {
        const int status = status_of_interrupted(SIGTERM, dir_ / "tmp", {});
        ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 128 + SIGTERM) << run;
        ASSERT_TRUE(fs::is_empty(dir_ / "tmp")) << run;
    }
}

}  // namespace
