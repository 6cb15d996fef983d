// What the official glTF validator says about its own test files (the *.report.json beside each of
// them), against what we do with the file: an error that matters must be refused at the place that
// the report names, everything else must load. The table of outcomes is docs/gltf-conformance.md;
// the environment variable MESHPREP_UPDATE_DOCS rewrites it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "formats/gltf/gltf.h"
#include "prep/prepare.h"
#include "prep/save.h"
#include "shared_data.h"
#include "temporary_files.h"

namespace {

namespace fs = std::filesystem;

// Errors of the validator with which a file still loads. `pointer` narrows the rule to places that
// start with it, or with $ to that one place.
struct Leniency {
    std::string_view code, pointer, reason;
};

constexpr Leniency leniencies[] = {
    {"EMPTY_ENTITY", "/accessors$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/animations$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/bufferViews$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/buffers$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/cameras$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/images$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/materials$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/meshes$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/nodes$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/samplers$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/scenes$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/skins$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/textures$",
     "an empty list says what an absent one says; left out when written"},
    {"EMPTY_ENTITY", "/nodes/", "no children; left out when written"},
    {"ACCESSOR_MIN_MISMATCH", "",
     "bounds are not read from the file; they are computed anew when written"},
    {"ACCESSOR_MAX_MISMATCH", "", "as above"},
    {"ACCESSOR_ELEMENT_OUT_OF_MIN_BOUND", "", "as above"},
    {"ACCESSOR_ELEMENT_OUT_OF_MAX_BOUND", "", "as above"},
    {"MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "", "as above"},
    {"ANIMATION_SAMPLER_INPUT_ACCESSOR_WITHOUT_BOUNDS", "", "as above"},
    {"ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "",
     "the bytes are read one element at a time, at any address; written aligned"},
    {"MESH_PRIMITIVE_ACCESSOR_UNALIGNED", "", "as above"},
    {"MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE", "",
     "without a stride the elements are tightly packed, shared view or not; written each in its "
     "own view"},
    {"ANIMATION_SAMPLER_ACCESSOR_WITH_BYTESTRIDE", "",
     "the stride is obeyed, whoever uses the view"},
    {"BUFFER_VIEW_TOO_BIG_BYTE_STRIDE", "",
     "every accessor is checked against the end of its view, which one element may reach"},
    {"ANIMATION_DUPLICATE_TARGETS", "", "animations are carried, not played"},
    {"ANIMATION_CHANNEL_TARGET_NODE_WEIGHTS_NO_MORPHS", "", "animations are carried, not played"},
    {"ACCESSOR_ANIMATION_SAMPLER_OUTPUT_NON_NORMALIZED_QUATERNION", "",
     "animations are carried, not played"},
    {"INVALID_URI", "/images/",
     "a picture that cannot be read costs its texture, with a warning, not the mesh"},
    {"IO_ERROR", "/images/", "as above"},
    {"IMAGE_DATA_INVALID", "", "as above, once something wants to see the picture"},
    {"IMAGE_UNEXPECTED_EOS", "", "as above"},
    {"ONE_OF_MISMATCH", "/cameras/", "the type says which of the two holds"},
    {"MESH_PRIMITIVE_INVALID_ATTRIBUTE", "", "attributes of unknown names are carried as they are"},
    {"MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR", "",
     "targets are carried; preparing normals gives NORMAL its base"},
    {"MESH_INVALID_WEIGHTS_COUNT", "", "morph weights are carried, not applied"},
    {"MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "", "joints without weights move nothing"},
    {"ACCESSOR_JOINTS_INDEX_DUPLICATE", "", "the weights of a joint named twice add up"},
    {"ACCESSOR_WEIGHTS_NEGATIVE", "", "weights are carried, not applied; written as 0"},
    {"ACCESSOR_WEIGHTS_NON_NORMALIZED", "",
     "weights are carried, not applied; scaled to the sum 1 when written, as said below"},
    {"ACCESSOR_INVALID_IBM", "", "inverse bind matrices are carried, not applied"},
    {"NODE_SKIN_NO_SCENE", "", "skins are carried, not applied"},
    {"UNSATISFIED_DEPENDENCY", "/nodes/",
     "a skin or weights on a node without a mesh have no effect"},
    {"UNDECLARED_EXTENSION", "", "extensions are found where they are used; declared when written"},
};

// Warnings of the validator with which a file is refused all the same.
constexpr Leniency strictnesses[] = {
    {"UNKNOWN_ASSET_MINOR_VERSION", "/asset", "its minVersion says that 2.0 is not enough"},
};

// Files that the validator can judge without their vertex data, which are not there.
constexpr std::string_view without_data[] = {
    "mesh/accessor_unaligned.gltf",
    "mesh/accessor_without_bytestride.gltf",
};

const Leniency* find_rule(std::span<const Leniency> rules, const std::string& code,
                          const std::string& pointer) {
    for (const Leniency& rule : rules) {
        if (rule.code != code) continue;
        std::string_view wanted = rule.pointer;
        if (wanted.ends_with('$')) {
            wanted.remove_suffix(1);
            if (pointer == wanted) return &rule;
        } else if (pointer.starts_with(wanted)) {
            return &rule;
        }
    }
    return nullptr;
}

struct Message {
    std::string code, pointer;
};

struct Case {
    std::string file;             // relative to the folder of the files
    std::vector<Message> errors;  // the validator's
    std::string severest;         // code of the first error, else of the first warning
    std::vector<Message> that_matter;
};

// Directory iteration has no order of its own.
std::vector<Case> cases(const fs::path& folder) {
    std::vector<Case> out;
    constexpr std::string_view ending = ".report.json";
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string path = entry.path().string();
        if (!path.ends_with(ending)) continue;
        Case c;
        const fs::path file = path.substr(0, path.size() - ending.size());
        c.file = fs::relative(file, folder).generic_string();
        const auto report = nlohmann::json::parse(test::file_text(entry.path()));
        int severity = 9;
        for (const auto& message : report["issues"]["messages"]) {
            Message m{message["code"], message.value("pointer", std::string())};
            if (message["severity"] < severity && message["severity"] <= 1) {
                severity = message["severity"];
                c.severest = (severity == 0 ? "error " : "warning ") + m.code;
            }
            const bool error = message["severity"] == 0;
            if (error) c.errors.push_back(m);
            if (error && !find_rule(leniencies, m.code, m.pointer)) c.that_matter.push_back(m);
            if (const Leniency* rule = find_rule(strictnesses, m.code, m.pointer); rule && !error)
                c.that_matter.push_back({m.code, std::string(rule->pointer)});
        }
        out.push_back(std::move(c));
    }
    std::sort(out.begin(), out.end(), [](const Case& a, const Case& b) { return a.file < b.file; });
    return out;
}

// One place is the other's, or above or below it in the document.
bool same_place(const std::string& ours, const std::string& theirs) {
    const auto below = [](const std::string& a, const std::string& b) {
        return b.empty() || b == "/" || a == b || a.starts_with(b + "/");
    };
    return below(ours, theirs) || (!ours.empty() && below(theirs, ours));
}

std::string row(const Case& c, const prep::Result<prep::Scene>& scene) {
    std::string out = "| " + c.file + " | " + (c.severest.empty() ? "valid" : c.severest) + " | ";
    if (scene) {
        out += c.errors.empty() ? "loads |" : "loads (tolerated) |";
        return out;
    }
    std::string text = prep::to_string(scene.error());
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, "\\");
    std::replace(text.begin(), text.end(), '\n', ' ');
    return out + "error: " + text + " |";
}

std::string page(const std::vector<std::string>& rows, std::size_t loaded, std::size_t refused) {
    std::string out =
        "# glTF conformance\n\n"
        "What we do with the test files of the official glTF validator, beside the severest "
        "message\n"
        "of the validator about each (its reports come with the files). Written by the test\n"
        "`prep_gltf_conformance_test` when the environment variable `MESHPREP_UPDATE_DOCS` is "
        "set,\n"
        "and compared by it otherwise.\n\n";
    out += "Files: " + std::to_string(rows.size()) + ". Loaded: " + std::to_string(loaded) +
           ". Refused: " + std::to_string(refused) + ". Crashed or hung: 0.\n\n";
    out +=
        "## Where we are more lenient\n\n"
        "An error of the validator in one of these files refuses it unless it stands here. What "
        "none "
        "of\n"
        "them has wrong, as rotations that are not unit or factors out of range, may be carried as "
        "it "
        "is.\n\n"
        "| validator's code | where | why the file still loads |\n|---|---|---|\n";
    for (const Leniency& rule : leniencies) {
        std::string where(rule.pointer);
        if (where.ends_with('$')) where.pop_back();
        out += "| " + std::string(rule.code) + " | " + (where.empty() ? "anywhere" : where) +
               " | " + std::string(rule.reason) + " |\n";
    }
    out +=
        "\n## Where we are stricter\n\n"
        "| validator's warning | where | why the file is refused |\n|---|---|---|\n";
    for (const Leniency& rule : strictnesses)
        out += "| " + std::string(rule.code) + " | " + std::string(rule.pointer) + " | " +
               std::string(rule.reason) + " |\n";
    out +=
        "| (none) | /buffers | a mesh needs vertex data that are nowhere to be found; the "
        "validator "
        "judges the rest without them |\n";
    out +=
        "\n## What is made valid when a file is written back\n\n"
        "Each with a note, and only at the vertices that are written; all else keeps its bytes.\n\n"
        "- Skin weights: all sets of a vertex are scaled together to the sum 1, so that their "
        "ratios stay.\n"
        "  Floats are divided by the sum. Normalised integers get all 255 or 65535 of their steps "
        "by largest\n"
        "  remainder: they add up exactly. Where a vertex has sets of several types, the coarser "
        "take their\n"
        "  share of the sum, rounded down to their step, and the finer share what is left to 1. "
        "Weights of 0\n"
        "  stay 0; vertices without any weight, and those whose sum is 1 within the validator's "
        "tolerance,\n"
        "  are left alone. Weights that are negative or not finite become 0 first.\n"
        "- UVs and other vertex data that are not finite become 0; float colours are clamped to "
        "0 … 1\n"
        "  (but not what morph targets add to them).\n"
        "- Normals that are not finite become (0, 0, 1), such tangents any in the surface, where "
        "nothing asked\n"
        "  for computed ones.\n"
        "- Triangles with a position that is not finite are left out.\n\n"
        "Of what is carried over, whatever else stays:\n\n"
        "- Bounds of accessors that say other than the values, or that positions and times of "
        "animations lack,\n"
        "  are computed (not those of what Draco holds).\n"
        "- Vertex data at addresses or strides that are no multiples of 4, and several of it in "
        "one "
        "view without\n"
        "  a stride, gets a stride or views of its own (no matrices; up to four times the file's "
        "bytes).\n"
        "- Extensions that are used are declared; `KHR_mesh_quantization`, where vertex data has "
        "its "
        "types, as\n"
        "  required.\n";
    out += "\n## File by file\n\n| file | validator | meshprep |\n|---|---|---|\n";
    for (const std::string& r : rows) out += r + "\n";
    return out;
}

TEST(GltfConformance, RefusesWhatMattersAtItsPlaceAndLoadsTheRest) {
    MESHPREP_REQUIRE_SHARED(shared);
    const fs::path folder = shared / "corpus/gltf-validator";
    const std::vector<Case> all = cases(folder);
    ASSERT_GE(all.size(), 132u);
    std::vector<std::string> rows;
    std::size_t loaded = 0;
    for (const Case& c : all) {
        SCOPED_TRACE(c.file);
        const auto scene = prep::load_gltf(folder / c.file);
        rows.push_back(row(c, scene));
        loaded += scene.has_value();
        if (std::find(std::begin(without_data), std::end(without_data), c.file) !=
            std::end(without_data)) {
            ASSERT_FALSE(scene.has_value());
            EXPECT_EQ(scene.error().place, fs::path(c.file).filename().string() + "#/buffers/0");
            continue;
        }
        if (c.that_matter.empty()) {
            EXPECT_TRUE(scene.has_value()) << prep::to_string(scene.error());
            continue;
        }
        const Message& first = c.that_matter.front();
        EXPECT_FALSE(scene.has_value()) << first.code << " at " << first.pointer;
        if (scene) continue;
        const std::string& place = scene.error().place;
        EXPECT_TRUE(place.starts_with(fs::path(c.file).filename().string())) << place;
        const std::size_t hash = place.find('#');
        const std::string ours = hash == std::string::npos ? "" : place.substr(hash + 1);
        EXPECT_TRUE(std::any_of(c.that_matter.begin(), c.that_matter.end(),
                                [&](const Message& m) { return same_place(ours, m.pointer); }))
            << "ours: " << prep::to_string(scene.error()) << "\nvalidator: " << first.code << " at "
            << first.pointer;
        EXPECT_FALSE(scene.error().text.empty());
    }
    const std::string expected = page(rows, loaded, all.size() - loaded);
    const fs::path doc = test::source_dir() / "docs/gltf-conformance.md";
    if (std::getenv("MESHPREP_UPDATE_DOCS")) {
        std::ofstream(doc, std::ios::binary) << expected;
    } else {
        EXPECT_EQ(test::file_text(doc), expected) << "set MESHPREP_UPDATE_DOCS to rewrite the page";
    }
}

}  // namespace
