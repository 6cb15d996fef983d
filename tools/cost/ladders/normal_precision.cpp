// Precision of corner normals: what the arithmetic alone loses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/fan_normals.h"
#include "prep/corner_normals.h"

namespace cost {
namespace {

using prep::Error;
using prep::Precision;
using prep::Result;

// Degrees; a unit in the last place of a double is 1.3e-14.
constexpr double most_doubt = 1e-14;

struct PrecisionState {
    prep::Mesh mesh;
    prep::MeshView view;
    prep::Topology topology;
    prep::HardEdges hard;  // none by angle: fans are as large as they get
    FanNormals truth;
    std::vector<bool> judged;         // by fan
    std::vector<std::uint32_t> fans;  // by corner
    prep::CornerNormals result;
    int threads = 0;
};

// A torus with needles: what is thin cancels.
prep::Mesh torus_with_needles() {
    KnownMesh known = known_torus(160, 96, 0.4);
    prep::Mesh& mesh = known.mesh;
    // Every ninth vertex is pulled to within a millionth of a neighbour's place.
    for (std::size_t v = 0; v + 1 < mesh.positions.size(); v += 9)
        mesh.positions[v] =
            mesh.positions[v + 1] + (mesh.positions[v] - mesh.positions[v + 1]) * 1e-6f;
    return mesh;
}

Result<prep::CornerNormals> computed(const PrecisionState& s, Precision precision, bool doubles) {
    prep::NormalOptions options;
    options.precision = precision;
    options.keep_doubles = doubles;
    options.threads = s.threads;
    const prep::FaceNormals faces = prep::face_normals(s.view, precision, s.threads);
    return prep::corner_normals(s.view, s.topology, faces, s.hard, options);
}

template <class Value>
std::vector<double> errors_of(const PrecisionState& s, const std::vector<Value>& normals) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < s.truth.sums.size(); ++i)
        if (s.judged[i]) errors.push_back(degrees_between(Vector(normals[i]), s.truth.sums[i]));
    return errors;
}

// What the truth itself loses when it is rounded to such vectors.
template <class Rounded>
double largest_rounding(const PrecisionState& s) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < s.truth.sums.size(); ++i) {
        if (!s.judged[i]) continue;
        const Vector& v = s.truth.sums[i];
        const Vector unit = v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        errors.push_back(degrees_between(Vector(Rounded(unit)), v));
    }
    return summary_of(errors).largest;
}

}  // namespace

Result<Ladder> normal_precision_ladder(const Subject& subject) {
    const auto s = std::make_shared<PrecisionState>();
    s->mesh = subject.mesh ? *subject.mesh : torus_with_needles();
    s->threads = subject.threads;
    s->view = prep::MeshView(s->mesh);
    s->topology =
        prep::build_topology(s->view, prep::weld_exact(s->mesh.positions, s->threads), s->threads);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    edges.threads = s->threads;
    const auto hard = prep::hard_edges(
        s->view, s->topology, prep::face_normals(s->view, Precision::accurate, s->threads), edges);
    if (!hard) return hard.error();
    s->hard = *hard;
    // Which corners share a normal is not what is judged: taken from the stage.
    auto first = computed(*s, Precision::accurate, false);
    if (!first) return first.error();
    s->result = *std::move(first);
    s->fans = s->result.normals.indices;
    s->truth = area_fan_normals(s->mesh.positions, s->mesh.face_offsets, s->mesh.corner_vertices,
                                s->fans, s->result.normals.values.size());
    // Where faces cancel, long double cannot tell doubles' last bits apart either.
    std::size_t judged = 0;
    double largest_bound = 0;
    for (const double bound : s->truth.bounds) {
        s->judged.push_back(bound < most_doubt);
        if (!s->judged.back()) continue;
        ++judged;
        largest_bound = std::max(largest_bound, bound);
    }
    if (judged == 0)
        return Error{prep::ErrorCode::invalid, "the mesh has no normals that can be judged",
                     subject.name};

    Ladder ladder;
    ladder.name = "normal-precision";
    ladder.title = "Precision of normals";
    ladder.setting = "normals: --precision";
    ladder.subject =
        subject.mesh ? subject.name : "a torus of 30,720 triangles, some of them needles";
    ladder.subject += ": " + std::to_string(judged) + " of " +
                      std::to_string(s->truth.sums.size()) + " normals judged";
    ladder.oracle =
        "sums of area vectors in long double; fans whose sum it cannot tell to 1e-14° are not "
        "judged";
    ladder.timed = {"face normals", "corner normals weighted by area, no edge hard by its angle"};
    ladder.metrics = {
        {"largest", "°", "normals before rounding to float"},
        {"99.9 %", "°", "normals before rounding to float"},
        {"mean", "°", "normals before rounding to float"},
        {"largest as floats", "°",
         fmt::format("normals as they are written; the truth rounded to float: {:.2g}°",
                     largest_rounding<glm::vec3>(*s))}};
    ladder.floor = std::max(largest_rounding<glm::dvec3>(*s), largest_bound);
    ladder.floor_text = "largest error of the truth rounded to double, or of the truth itself";
    ladder.reference = 1;
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
        Rung rung;
        rung.name = std::string(prep::name_of(precision));
        rung.command = "prepare --precision " + rung.name + " --hard-angle off";
        rung.exact = precision == Precision::exact;
        rung.run = [s, precision]() -> prep::Result<void> {
            auto result = computed(*s, precision, false);
            if (!result) return result.error();
            s->result = *std::move(result);
            return {};
        };
        rung.judge = [s, precision] {
            // What was timed keeps floats only.
            const auto whole = computed(*s, precision, true);
            std::vector<double> numbers =
                whole ? three_of(errors_of(*s, whole->doubles)) : std::vector<double>(3, 180.0);
            numbers.push_back(summary_of(errors_of(*s, s->result.normals.values)).largest);
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
