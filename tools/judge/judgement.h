// Two scenes held against limits: where they differ, by how much, and which difference is the cause
// of the others.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "prep/image.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace judge {

// The largest value that passes; unset: not judged.
struct Limits {
    std::optional<double> faces = 0, positions = 1e-5, distance = 1e-5, lost = 0, added = {},
                          uvs = 1e-5, colors = 1.0 / 510, normals = 0.05, tangents = 0.05,
                          tangent_signs = 0, skins = 1e-5, morphs = 1e-5, materials = 0,
                          silhouettes = 0.1, flip = {};
};

struct LimitRow {
    const char* name;  // in gates, JSON and words
    std::optional<double> Limits::*limit;
    const char* stage;  // of the pipeline, that such a difference comes from
    const char* unit;   // of its value
    const char* what;
};
// In the order in which one is the cause of another.
inline constexpr LimitRow limit_rows[] = {
    {"faces", &Limits::faces, "geometry", "faces", "faces without a partner in the other file"},
    {"positions", &Limits::positions, "geometry", "of the diagonal",
     "how far a corner moved, over the first file's diagonal"},
    {"distance", &Limits::distance, "geometry", "of the diagonal",
     "distance of the surfaces, from each to the other"},
    {"lost", &Limits::lost, "attributes", "lists",
     "attributes, animations, lights and cameras that the second file lacks"},
    {"added", &Limits::added, "attributes", "lists", "those that the second file alone has"},
    {"uvs", &Limits::uvs, "uvs", "", "UV coordinates"},
    {"colors", &Limits::colors, "colors", "", "colours of corners, linear"},
    {"normals", &Limits::normals, "normals", "degrees", "normals"},
    {"tangents", &Limits::tangents, "tangents", "degrees", "tangents"},
    {"tangent_signs", &Limits::tangent_signs, "tangents", "corners", "tangents' signs"},
    {"skins", &Limits::skins, "skins", "of the diagonal",
     "the weighted places of a corner's joints, where they pose it, the sum of its weights"},
    {"morphs", &Limits::morphs, "morph targets", "of the diagonal",
     "how far morph targets move a corner"},
    {"materials", &Limits::materials, "materials", "faces", "faces whose material looks different"},
    {"silhouettes", &Limits::silhouettes, "picture", "pixels", "outlines over all views"},
    {"flip", &Limits::flip, "picture", "", "mean FLIP of the shaded pictures, of the worst view"},
};

struct Finding {
    double value = 0;                                              // in the row's unit
    std::uint32_t mesh = prep::no_index;                           // of the first file,
    std::uint32_t node = prep::no_index;                           // under this node
    std::uint32_t face = prep::no_index, corner = prep::no_index;  // corner within its face
    std::string text;                                              // what else there is to say
};

struct Measured {
    const LimitRow* row = nullptr;
    std::optional<double> limit;
    double value = 0;  // the largest, or the count; not a number where it was not measured
    // Where only bounds are known, `value` is the lower one and this the upper, which decides.
    std::optional<double> high = {};
    bool proved = false;         // an upper bound: the value itself may be smaller
    std::uint64_t compared = 0;  // corners, faces or views
    std::uint64_t beyond = 0;    // of these over the limit (for corners), by themselves or not
    bool within = true;
    // The name of the row whose differences are all over this one's: it follows from them. Empty:
    // it stands for itself.
    std::string follows;
    std::vector<Finding> findings;  // the largest, at most 8
};

struct ViewJudged {
    glm::dvec3 direction{0.0};  // from the scene to the eye
    double outline = 0;         // pixels
    std::uint32_t x = 0, y = 0;
    bool compared_flip = false;
    double flip = 0;               // mean
    prep::Image a, b, difference;  // with pictures alone
};

struct JudgeOptions {
    Limits limits;
    std::vector<std::string> meshes;      // by name, in both files; none: all
    std::uint32_t views = 6, size = 256;  // 0 views: no outlines
    bool always_views = false;            // drawn even where it is proved that no outline moved
    bool pictures = false;                // kept for a page
    int threads = 0;
    std::size_t most_pieces = 2'000'000;  // of triangles, that distances are searched by
};

struct Judgement {
    std::vector<Measured> measured;  // by limit_rows
    std::vector<ViewJudged> views;   // none where nothing had to be drawn
    std::vector<std::string> notes;
    double diagonal = 0;
    bool within() const;
};

// Errors: invalid (a name in `meshes` that no mesh of the first file has), limit (more than 2^28
// corners under all nodes), those of preparing and drawing.
prep::Result<Judgement> judge(const prep::Scene& a, const prep::Scene& b,
                              const JudgeOptions& options = {});

}  // namespace judge
