// Bits of positions, normals, tangents and UVs of glTF files: each rung writes a file into memory,
// which is read back by a reader of its own and held against the surface that the values are of.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <span>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/glb_corners.h"
#include "prep/prepare.h"
#include "prep/save.h"

namespace cost {
namespace {

constexpr int patch_around = 64, patch_across = 48;

// What a corner of a triangle has on the surface.
struct PatchCorner {
    SurfaceSample surface;
    Real u = 0, v = 0;
    Real handedness = 1;
};

struct QuantizedState {
    std::vector<PatchCorner> corners;  // in the order of triangles
    double diagonal = 0;
    prep::PreparedScene prepared;
};

// Three quarters of a torus around and two thirds across; a vertex is one of all attributes. Its
// UVs are 0 … 1.
SurfaceSample patch_at(Real u, Real v) {
    return torus_at(u * Real(0.75), v * 2 / 3);
}

// Of half of the vertices −1, as where UVs are mirrored.
Real handedness_of(std::uint32_t vertex) {
    return vertex % (patch_across + 1) < patch_across / 2 ? 1 : -1;
}

prep::Mesh patch_mesh(QuantizedState& s) {
    prep::Mesh mesh;
    const auto place = [](std::uint32_t vertex) {
        constexpr std::uint32_t row = patch_across + 1;
        return glm::vec<2, Real>(Real(vertex / row) / patch_around,
                                 Real(vertex % row) / patch_across);
    };
    mesh.uvs.emplace_back();
    for (std::uint32_t v = 0; v < std::uint32_t((patch_around + 1) * (patch_across + 1)); ++v) {
        const glm::vec<2, Real> p = place(v);
        const SurfaceSample at = patch_at(p.x, p.y);
        mesh.positions.emplace_back(at.position);
        mesh.normals.values.emplace_back(at.normal);
        mesh.tangents.values.emplace_back(glm::vec3(glm::normalize(at.du)),
                                          float(handedness_of(v)));
        mesh.uvs[0].values.emplace_back(p);
    }
    glm::vec3 low(mesh.positions[0]), high(low);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    s.diagonal = double(glm::length(high - low));
    const auto corner = [&](int i, int j) {
        const auto v = std::uint32_t(i * (patch_across + 1) + j);
        mesh.corner_vertices.push_back(v);
        const glm::vec<2, Real> p = place(v);
        s.corners.push_back({patch_at(p.x, p.y), p.x, p.y, handedness_of(v)});
    };
    for (int i = 0; i < patch_around; ++i)
        for (int j = 0; j < patch_across; ++j) {
            corner(i, j), corner(i + 1, j), corner(i + 1, j + 1);
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            corner(i, j), corner(i + 1, j + 1), corner(i, j + 1);
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
    mesh.normals.indices = mesh.tangents.indices = mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

prep::Result<std::shared_ptr<QuantizedState>> patch_state(const Subject& subject) {
    auto s = std::make_shared<QuantizedState>();
    prep::Scene scene;
    scene.meshes.push_back(patch_mesh(*s));
    prep::instance_unused_meshes(scene);
    prep::PrepareOptions options;
    options.threads = subject.threads;
    auto prepared = prep::prepare(std::move(scene), options);
    if (!prepared) return prepared.error();
    s->prepared = *std::move(prepared);
    return s;
}

// One number a corner; infinity where the file lacks it.
using CornerError = double (*)(const QuantizedState& s, const GlbCorners& file, std::size_t corner);

std::vector<double> judged_file(const QuantizedState& s, std::span<const std::byte> bytes,
                                CornerError error) {
    const auto file = corners_of_glb(bytes);
    std::vector<double> errors;
    for (std::size_t c = 0; c < s.corners.size(); ++c)
        errors.push_back(file && file->positions.size() == s.corners.size()
                             ? error(s, *file, c)
                             : std::numeric_limits<double>::infinity());
    std::vector<double> numbers = three_of(errors);
    numbers.push_back(double(bytes.size()));
    return numbers;
}

constexpr double missing = std::numeric_limits<double>::infinity();

double position_error(const QuantizedState& s, const GlbCorners& file, std::size_t c) {
    const Vector d = file.positions[c] - s.corners[c].surface.position;
    return double(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z)) / s.diagonal;
}
double normal_error(const QuantizedState& s, const GlbCorners& file, std::size_t c) {
    if (c >= file.normals.size()) return missing;
    return degrees_between(file.normals[c], s.corners[c].surface.normal);
}
double tangent_error(const QuantizedState& s, const GlbCorners& file, std::size_t c) {
    if (c >= file.tangents.size()) return missing;
    // Bitangents point the other way.
    if (file.handedness[c] != s.corners[c].handedness) return 180;
    return degrees_between(file.tangents[c], s.corners[c].surface.du);
}
double uv_error(const QuantizedState& s, const GlbCorners& file, std::size_t c) {
    if (c >= file.uvs.size()) return missing;
    return double(std::max(std::abs(file.uvs[c].x - s.corners[c].u),
                           std::abs(file.uvs[c].y - s.corners[c].v)));
}

struct AttributeLadder {
    const char *name, *title, *attribute, *unit, *domain, *truth, *floor_text;
    int prep::Quantization::*bits;
    std::vector<int> rungs;
    CornerError error;
    double floor;
};

prep::Result<Ladder> attribute_ladder(const Subject& subject, const AttributeLadder& of) {
    const auto made = patch_state(subject);
    if (!made) return made.error();
    const std::shared_ptr<QuantizedState> s = *made;
    Ladder ladder;
    ladder.name = of.name;
    ladder.title = of.title;
    ladder.setting =
        fmt::format("glTF files: --quantize {}=BITS; fewer bits buy bytes, and take no less time",
                    of.attribute);
    ladder.subject = "a part of a torus of 6,144 triangles with normals, tangents and UVs";
    ladder.oracle =
        fmt::format("{} in closed form; the file is read back by a reader of its own", of.truth);
    ladder.timed = {"the bytes of the GLB file, prepared before", "freeing the last ones",
                    "not: the disk"};
    ladder.metrics = {{"largest", of.unit, of.domain},
                      {"99.9 %", of.unit, of.domain},
                      {"mean", of.unit, of.domain},
                      {"bytes", "", "the file"}};
    ladder.floor = of.floor;
    ladder.floor_text = of.floor_text;
    ladder.reference = of.rungs.size();
    const auto add = [&](int bits) {
        Rung rung;
        rung.name = bits == 0 ? "floats" : fmt::format("{} bits", bits);
        rung.command =
            bits == 0 ? "prepare" : fmt::format("prepare --quantize {}={}", of.attribute, bits);
        if (bits > 0)
            rung.because =
                "bits buy bytes of the file, not time: floats are copied, fewer bits are "
                "rounded first";
        prep::SaveOptions options;
        options.quantization.*of.bits = bits;
        // Each its own: files are judged after others were written.
        const auto file = std::make_shared<std::vector<std::byte>>();
        rung.run = [s, file, options]() -> prep::Result<void> {
            auto glb = prep::save_glb(s->prepared, options);
            if (!glb) return glb.error();
            *file = std::move(glb->bytes);
            return {};
        };
        rung.judge = [s, file, error = of.error] { return judged_file(*s, *file, error); };
        ladder.rungs.push_back(std::move(rung));
    };
    for (const int bits : of.rungs) add(bits);
    add(0);
    return ladder;
}

// Half a unit in the last place of each coordinate, as an angle.
constexpr double direction_floor = 3.4151e-6;

}  // namespace

prep::Result<Ladder> quantized_positions_ladder(const Subject& subject) {
    return attribute_ladder(subject,
                            {"quantized-positions",
                             "Bits of positions",
                             "positions",
                             "of the diagonal",
                             "distance of corners from where they are meant, in the file read back",
                             "the torus' points",
                             "coordinates rounded to float: half a unit in the last place of 1",
                             &prep::Quantization::positions,
                             {6, 8, 10, 12, 14, 16},
                             position_error,
                             0x1p-25});
}

prep::Result<Ladder> quantized_normals_ladder(const Subject& subject) {
    return attribute_ladder(subject, {"quantized-normals",
                                      "Bits of normals",
                                      "normals",
                                      "°",
                                      "normals of corners, in the file read back",
                                      "the torus' normals",
                                      "directions rounded to float",
                                      &prep::Quantization::normals,
                                      {8, 9, 10, 12, 14, 16},
                                      normal_error,
                                      direction_floor});
}

prep::Result<Ladder> quantized_tangents_ladder(const Subject& subject) {
    return attribute_ladder(subject, {"quantized-tangents",
                                      "Bits of tangents",
                                      "tangents",
                                      "°",
                                      "tangents of corners, in the file read back",
                                      "the torus' ∂P/∂u",
                                      "directions rounded to float",
                                      &prep::Quantization::tangents,
                                      {8, 9, 10, 12, 14, 16},
                                      tangent_error,
                                      direction_floor});
}

prep::Result<Ladder> quantized_uvs_ladder(const Subject& subject) {
    return attribute_ladder(subject, {"quantized-uvs",
                                      "Bits of UVs",
                                      "uvs",
                                      "of the map",
                                      "the larger of |Δu|, |Δv| of corners, in the file read back",
                                      "the patch's parameters",
                                      "coordinates rounded to float: half a unit in the last "
                                      "place of 1",
                                      &prep::Quantization::uvs,
                                      {6, 8, 10, 12, 14, 16},
                                      uv_error,
                                      0x1p-25});
}

}  // namespace cost
