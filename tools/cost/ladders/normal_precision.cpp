// Precision of corner normals: what the arithmetic alone loses.
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/fan_normals.h"
#include "hard_cases.h"
#include "prep/corner_normals.h"

namespace cost {
namespace {

using prep::Error;
using prep::Precision;
using prep::Result;

struct State {
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

Result<prep::CornerNormals> computed(const State& s, Precision precision) {
    prep::NormalOptions options;
    options.precision = precision;
    options.keep_doubles = true;
    options.threads = s.threads;
    const prep::FaceNormals faces = prep::face_normals(s.view, precision, s.threads);
    return prep::corner_normals(s.view, s.topology, faces, s.hard, options);
}

std::vector<double> errors_of(const State& s, bool rounded) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < s.truth.sums.size(); ++i) {
        if (!s.judged[i]) continue;
        const glm::dvec3& n = s.result.doubles[i];
        errors.push_back(rounded ? degrees_between(Vector(glm::vec3(n)), s.truth.sums[i])
                                 : degrees_between(Vector(n), s.truth.sums[i]));
    }
    return errors;
}

}  // namespace

Result<Ladder> normal_precision_ladder(const Subject& subject) {
    const auto s = std::make_shared<State>();
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
    auto first = computed(*s, Precision::accurate);
    if (!first) return first.error();
    s->result = *std::move(first);
    s->fans = s->result.normals.indices;
    s->truth = area_fan_normals(s->mesh.positions, s->mesh.face_offsets, s->mesh.corner_vertices,
                                s->fans, s->result.normals.values.size());
    // Where faces cancel all but completely, long double cannot tell either.
    std::size_t judged = 0;
    for (const double bound : s->truth.bounds) {
        s->judged.push_back(bound < 1e-9);
        judged += s->judged.back();
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
        "sums of area vectors in long double; fans whose sum it cannot tell to 1e-9° are not "
        "judged";
    ladder.timed = {"face normals", "corner normals weighted by area, no edge hard by its angle"};
    ladder.metrics = {{"largest", "°", "normals before rounding to float"},
                      {"99.9 %", "°", "normals before rounding to float"},
                      {"mean", "°", "normals before rounding to float"},
                      {"largest as floats", "°", "normals as they are written"}};
    // What the truth itself loses when it is rounded to float.
    double most = 0;
    for (std::size_t i = 0; i < s->truth.sums.size(); ++i) {
        if (!s->judged[i]) continue;
        const Vector& v = s->truth.sums[i];
        const Vector unit = v / std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        most = std::max(most, degrees_between(Vector(glm::vec3(unit)), v));
    }
    ladder.floor = most;
    ladder.floor_text = "largest error of the truth rounded to float";
    ladder.reference = 1;
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
        Rung rung;
        rung.name = std::string(prep::name_of(precision));
        rung.command = "prepare --precision " + rung.name + " --hard-angle off";
        rung.exact = precision == Precision::exact;
        rung.run = [s, precision]() -> prep::Result<void> {
            auto result = computed(*s, precision);
            if (!result) return result.error();
            s->result = *std::move(result);
            return {};
        };
        rung.judge = [s] {
            std::vector<double> numbers = three_of(errors_of(*s, false));
            numbers.push_back(summary_of(errors_of(*s, true)).largest);
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
