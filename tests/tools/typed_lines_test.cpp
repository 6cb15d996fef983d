// What a person gets for a line that cannot be followed as it was typed: what is wrong, where, and
// what to do. Each answer stands here as it is seen.
#include <gtest/gtest.h>
#include <zlib.h>

#include <sstream>

#include "command_runner.h"
#include "prep/version.h"
#include "sanitized.h"

namespace {

namespace fs = std::filesystem;
using test::write_text;

struct TypedLine {
    const char* typed;  // after "meshprep "
    int exit_code;
    const char* answer;  // on both streams
};

const TypedLine typed_lines[] = {
    {"prepear cube.obj -o x.glb", 2,
     "meshprep: error: 'prepear' is no subcommand; did you mean 'prepare'? There are prepare, "
     "inspect, render, validate, cost, diff, height-to-normal\n"
     "'meshprep help' lists what there is.\n"},
    {"convert cube.obj x.glb", 2,
     "meshprep: error: 'convert' is no subcommand; there are prepare, inspect, render, validate, "
     "cost, diff, height-to-normal\n"
     "'meshprep help' lists what there is.\n"},
    {"cube.obj", 2,
     "meshprep: error: 'cube.obj' is a file, and a subcommand says what to do with it: meshprep "
     "inspect cube.obj, or meshprep prepare cube.obj -o OUTPUT\n"
     "'meshprep help' lists what there is.\n"},
    {"help prepaer", 2,
     "meshprep: error: 'prepaer' is no subcommand; did you mean 'prepare'? There are prepare, "
     "inspect, render, validate, cost, diff, height-to-normal\n"
     "'meshprep help' lists what there is.\n"},
    {"--json inspect cube.obj", 2,
     "{\n"
     "  \"command\": \"meshprep\",\n"
     "  \"version\": \"VERSION\",\n"
     "  \"error\": {\n"
     "    \"code\": \"usage\",\n"
     "    \"text\": \"stands after the subcommand, as in meshprep inspect --json\",\n"
     "    \"place\": \"--json\"\n"
     "  }\n"
     "}\n"
     "meshprep: error: --json: stands after the subcommand, as in meshprep inspect --json\n"
     "'meshprep help inspect' lists its options.\n"},
    {"--verison", 2,
     "meshprep: error: --verison: is no option of meshprep; did you mean '--version'?\n"
     "'meshprep help' lists what there is.\n"},
    {"prepare", 2,
     "meshprep: error: input: is missing; give FILE|DIR (Mesh or scene files, .gz and .zip too, "
     "directories of them, or - for standard input)\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj", 2,
     "meshprep: error: --output: is missing; give -o FILE or -o DIR (or --in-place)\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o", 2,
     "meshprep: error: --output: needs a value: FILE|DIR (A file (its ending says the format), a "
     "directory, or - for standard output)\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj --ouput x.glb", 2,
     "meshprep: error: --ouput: is no option of prepare; did you mean '--output'?\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --jsno", 2,
     "meshprep: error: --jsno: is no option of prepare; did you mean '--json'?\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb -json", 2,
     "meshprep: error: -json: is no option of prepare; did you mean '--json'?\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --panel 64", 2,
     "meshprep: error: --panel: is no option of prepare; validate has it\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --budget-ms 40 --subdivide catmark:3", 2,
     "meshprep: error: --budget-ms: chooses the level of --subdivide; give the scheme alone, as in "
     "catmark\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --weight aera", 2,
     "meshprep: error: --weight: 'aera' is not one of area|uniform|angle|area-angle|edge-length; "
     "did you mean 'area'?\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --weight=heavy", 2,
     "meshprep: error: --weight: 'heavy' is not one of area|uniform|angle|area-angle|edge-length\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --hard-angle 200", 2,
     "meshprep: error: --hard-angle: '200' is not an angle from 0 to 180 degrees, off or auto\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --threads many", 2,
     "meshprep: error: --threads: 'many' is not a whole number from 0 to 4096\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --threads -1", 2,
     "meshprep: error: --threads: '-1' is not a whole number from 0 to 4096\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb -o y.glb", 2,
     "meshprep: error: --output: is given more than once; leave all but one out\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.fbx", 2,
     "meshprep: error: x.fbx: cannot write .fbx; written are glb, gltf, obj, ply, stl, off. End it "
     "with / for a directory\n"},
    {"prepare cube.obj -o x", 2,
     "meshprep: error: x: the output has no ending; written are glb, gltf, obj, ply, stl, off. End "
     "it with / for a directory\n"},
    {"prepare cube.obj -o cube.obj", 2,
     "meshprep: error: cube.obj: the output is also an input; give another name, or --in-place\n"},
    {"prepare cube.obj ball.obj -o x.glb", 2,
     "meshprep: error: x.glb: several inputs need a directory, and this is the name of one mesh; "
     "end it with a slash if it is to be one\n"},
    {"prepare cbue.obj -o x.glb", 1,
     "meshprep: error: cbue.obj: there is no such file; did you mean 'cube.obj'?\n"},
    {"prepare models/cube.obj -o x.glb", 1,
     "meshprep: error: models/cube.obj: there is no such file; nor is there a directory 'models'; "
     "check its name\n"},
    {"prepare broken.obj -o x.glb", 1,
     "meshprep: error: broken.obj:4: vertex index 9 is out of range: the file has 3\n"},
    {"prepare empty.obj -o x.glb", 1, "meshprep: error: empty.obj: the file is empty\n"},
    {"prepare notes.txt -o x.glb", 1,
     "meshprep: error: notes.txt: unknown file type '.txt': GLB, glTF, OBJ, PLY, STL, OFF, OM, "
     "JSON scenes and the formats of Assimp (FBX, DAE, 3DS, …) are read\n"},
    {"prepare emptydir -o out", 1,
     "meshprep: error: emptydir: the directory holds no mesh file; -r also looks below it\n"},
    {"prepare cube.obj sub/cube.obj -o out -q", 1,
     "meshprep: error: sub/cube.obj: two inputs would be written to out/cube.glb, and cube.obj "
     "comes first; rename one or prepare them apart\n"},
    {"prepare cube.obj -o x.glb --format ply", 2,
     "meshprep: error: x.glb: its ending says the format, and --format ply another; leave one of "
     "them out\n"},
    {"prepare cube.obj -o x.glb --ascii", 2,
     "meshprep: error: x.glb: --ascii is for PLY and STL, which also have a binary form; leave it "
     "out\n"},
    {"prepare cube.obj --in-place -o x.glb", 2,
     "meshprep: error: --in-place: writes over the inputs; it takes no --output\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o old.glb --no-overwrite", 1,
     "meshprep: error: old.glb: the output exists, and --no-overwrite was given; leave that out, "
     "or give another name\n"},
    {"prepare cube.obj -o notes.txt/x.glb", 1,
     "meshprep: error: notes.txt: a file of this name is in the way of the output directory\n"},
    {"prepare cube.obj -o x.glb --skip-unchanged", 2,
     "meshprep: error: --skip-unchanged: works only together with --manifest; give both\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o -", 2,
     "meshprep: error: -: has no ending to say the format; give --format, one of glb, gltf, obj, "
     "ply, stl, off\n"},
    {"prepare - -o x.glb", 1,
     "meshprep: error: standard input: is empty; is the program before the pipe at fault?\n"},
    {"prepare two.zip -o x.glb", 1,
     "meshprep: error: two.zip: the archive holds 2 mesh files (a.obj, b.obj), and one is read; "
     "unpack it and name those you mean\n"},
    {"prepare short.obj.gz -o x.glb", 1,
     "meshprep: error: short.obj.gz: the gzip file is cut short; fetch it again\n"},
    {"prepare cube.obj -o x.glb --repair holes=2", 2,
     "meshprep: error: --repair: 'holes=2': holes of 3 to 1000 edges can be filled\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --repair hols", 2,
     "meshprep: error: --repair: 'hols' is not one of weld[=DISTANCE], degenerate, duplicates, "
     "edges, vertices, orientation, holes[=EDGES], outward, isolated, all\n"
     "'meshprep help prepare' lists its options.\n"},
    {"prepare cube.obj -o x.glb --input-format objj", 2,
     "meshprep: error: --input-format: 'objj' is no ending of a file that is read; did you mean "
     "'obj'?\n"
     "'meshprep help prepare' lists its options.\n"},
    {"inspect", 2,
     "meshprep: error: input: is missing; give files (or --selftest)\n"
     "'meshprep help inspect' lists its options.\n"},
    {"inspect sub", 1,
     "meshprep: error: sub: this is a directory, expected a file; name the files in it\n"},
    {"inspect photo.png", 1,
     "meshprep: error: photo.png: unknown file type '.png': GLB, glTF, OBJ, PLY, STL, OFF, OM, "
     "JSON scenes and the formats of Assimp (FBX, DAE, 3DS, …) are read\n"},
    {"render cube.obj", 2,
     "meshprep: error: --output: is missing; give -o IMAGE (The picture: .png, .jpg, .exr and "
     "others, or - for standard output)\n"
     "'meshprep help render' lists its options.\n"},
    {"render cube.obj -o x.zzz", 2,
     "meshprep: error: x.zzz: images are not written as '.zzz'; use .png, .jpg, .exr, .tif, .hdr, "
     ".webp, .tga, .bmp or .ppm\n"},
    {"render cube.obj -o x.png --size 1280", 2,
     "meshprep: error: --size: '1280' is not a size such as 1280x720, up to 32768x32768\n"
     "'meshprep help render' lists its options.\n"},
    {"render cube.obj -o x.png --shading fong", 2,
     "meshprep: error: --shading: 'fong' is not one of flat|gouraud|phong|normal-mapped; did you "
     "mean 'phong'?\n"
     "'meshprep help render' lists its options.\n"},
    {"render cube.obj -o x.png --look-at 0,0,0", 2,
     "meshprep: error: --look-at: works only together with --look-from; give both\n"
     "'meshprep help render' lists its options.\n"},
    {"render cube.obj -o x.png --camera Main", 1,
     "meshprep: error: cube.obj: no camera 'Main' in the scene; it has none: give --camera "
     "AZIMUTH,ELEVATION\n"},
    {"render cube.obj -o x.png --camera 0,0 --look-from 1,1,1", 2,
     "meshprep: error: --camera: cannot stand beside --look-from; give one of them\n"
     "'meshprep help render' lists its options.\n"},
    {"validate cube.obj", 2,
     "meshprep: error: --output: is missing; give -o DIR (Directory for the sheets; made if it is "
     "not there)\n"
     "'meshprep help validate' lists its options.\n"},
    {"validate cube.obj -o sheets --mesh roof", 1,
     "meshprep: error: cube.obj: no mesh 'roof'; the file has 0 'cube'\n"},
    {"diff cube.obj", 2,
     "meshprep: error: b: is missing; give B (Another of the same kind)\n"
     "'meshprep help diff' lists its options.\n"},
    {"diff cube.obj photo.png", 1,
     "meshprep: error: photo.png: one is a picture, the other a mesh; give two of a kind\n"},
    {"diff cube.obj ball.obj third.obj", 2,
     "meshprep: error: 'third.obj' is more than diff takes, which is A B\n"
     "'meshprep help diff' lists its options.\n"},
    {"diff cube.obj ball.obj --tolerance=-1", 2,
     "meshprep: error: --tolerance: '-1' is not a number of 0 or more\n"
     "'meshprep help diff' lists its options.\n"},
    {"prepare cube.obj -o x.glb --json --weight aera", 2,
     "{\n"
     "  \"command\": \"prepare\",\n"
     "  \"version\": \"VERSION\",\n"
     "  \"error\": {\n"
     "    \"code\": \"usage\",\n"
     "    \"text\": \"'aera' is not one of area|uniform|angle|area-angle|edge-length; did you mean "
     "'area'?\",\n"
     "    \"place\": \"--weight\"\n"
     "  }\n"
     "}\n"
     "meshprep: error: --weight: 'aera' is not one of area|uniform|angle|area-angle|edge-length; "
     "did you mean 'area'?\n"
     "'meshprep help prepare' lists its options.\n"},
};

// The files that the lines name, in a directory that is the current one meanwhile.
class TypedLines : public ::testing::Test {
  protected:
    TypedLines() : before_(fs::current_path()) {
        fs::current_path(dir_.path());
        for (const char* name : {"cube.obj", "ball.obj"}) write_text(name, test::cube_obj());
        write_text("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
        write_text("empty.obj", "");
        write_text("notes.txt", "hello\n");
        write_text("photo.png", "no picture");
        write_text("old.glb", "old");
        fs::create_directory("sub");
        fs::create_directory("emptydir");
        write_text("sub/cube.obj", test::cube_obj());
        const gzFile packed = gzopen("whole.gz", "wb9");
        gzputs(packed, test::cube_obj().c_str());
        gzclose(packed);
        write_text("short.obj.gz", test::file_text("whole.gz").substr(0, 60));
        fs::remove("whole.gz");
        write_text("two.zip", two_meshes());
    }
    ~TypedLines() override { fs::current_path(before_); }

    // Two stored entries, "a.obj" and "b.obj", of no bytes.
    static std::string two_meshes() {
        std::string files, list;
        for (const char name : {'a', 'b'}) {
            const std::string at(1, static_cast<char>(files.size()));
            const std::string entry(20, '\0');
            std::string head("\x14\0", 2);
            head += entry;
            head.append("\x05\0\0\0", 4);
            std::string text(1, name);
            text += ".obj";
            list += "PK\x01\x02" + std::string("\x14\0", 2) + head + std::string(10, '\0') + at +
                    std::string(3, '\0') + text;
            files += "PK\x03\x04" + head + text;
        }
        const auto byte = [](std::size_t n) { return std::string(1, static_cast<char>(n)); };
        return files + list + "PK\x05\x06" + std::string(4, '\0') + std::string("\2\0\2\0", 4) +
               byte(list.size()) + std::string(3, '\0') + byte(files.size()) + std::string(5, '\0');
    }

    test::TempDir dir_;
    fs::path before_;
};

TEST_F(TypedLines, AreAnsweredWithWhatIsWrongWhereAndWhatToDo) {
    const std::vector<std::string> names = dir_.names();
    EXPECT_GE(std::size(typed_lines), 40u);
    std::size_t number = 0;
    for (const TypedLine& line : typed_lines) {
        if (test::sanitized && number++ % 3 != 0) continue;
        std::istringstream text(line.typed);
        std::vector<std::string> words;
        for (std::string word; text >> word;) words.push_back(word);
        test::Ran ran = test::run_command(words, {});
        const std::string version(prep::version());
        if (const std::size_t at = ran.out.find("\"" + version); at != std::string::npos)
            ran.out.replace(at + 1, version.size(), "VERSION");
        EXPECT_EQ(ran.exit_code, line.exit_code) << line.typed;
        EXPECT_EQ(ran.out + ran.err, line.answer) << line.typed;
    }
    // None of them left anything behind but the output of the one that could be done in part.
    fs::remove_all("out");
    EXPECT_EQ(dir_.names(), names);
}

TEST_F(TypedLines, HelpAndVersionsHaveTheirShortForms) {
    const auto said = [](const std::vector<std::string>& words) {
        const test::Ran ran = test::run_here(words);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        EXPECT_EQ(ran.err, "");
        return ran.out;
    };
    EXPECT_EQ(said({"-V"}), said({"--version"}));
    EXPECT_EQ(said({"help"}), said({"--help"}));
    for (const char* name : {"prepare", "inspect", "render", "validate", "diff"})
        EXPECT_EQ(said({"help", name}), said({name, "--help"}));
    EXPECT_NE(said({"-V"}).find("zlib"), std::string::npos);
}

}  // namespace
