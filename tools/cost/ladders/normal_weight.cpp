// What a face counts in a corner's normal: on a surface whose normals are known, alone and together
// with the arithmetic; on a mesh that is given, against what it was sampled from.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cost/ladders/coarse_mesh.h"
#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/fitted_normals.h"
#include "cost/oracles/weighted_normals.h"
#include "prep/corner_normals.h"

namespace cost {
namespace {

struct WeightState {
    prep::Mesh mesh;
    std::vector<Vector> truth;  // by vertex; zero: not judged
    bool torus = false;         // known inside triangles too
    prep::MeshView view;
    prep::Topology topology;
    prep::FaceNormals faces;
    prep::HardEdges hard;
    prep::CornerNormals result;
    int threads = 0;
};

prep::Result<void> measure_surroundings(WeightState& s) {
    s.view = prep::MeshView(s.mesh);
    s.topology = prep::build_topology(s.view, {}, s.threads);
    s.faces = prep::face_normals(s.view, prep::Precision::accurate, s.threads);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    const auto hard = prep::hard_edges(s.view, s.topology, s.faces, edges);
    if (!hard) return hard.error();
    s.hard = *hard;
    return {};
}

prep::Result<std::shared_ptr<WeightState>> torus_state(int around, int across, int threads) {
    const auto s = std::make_shared<WeightState>();
    KnownMesh known = known_torus(around, across, 0.25);
    s->mesh = std::move(known.mesh);
    for (const SurfaceSample& at : known.at) s->truth.push_back(at.normal);
    s->torus = true;
    s->threads = threads;
    if (const prep::Result<void> done = measure_surroundings(*s); !done) return done.error();
    return s;
}

// Against the truth at vertices, {largest, 99.9 %, mean}; the largest against the weight's
// definition; of the torus the mean inside triangles.
std::vector<double> judged_weight(const WeightState& s, const std::string& weight) {
    const prep::Mesh& mesh = s.mesh;
    const prep::CornerLayer<glm::vec3>& normals = s.result.normals;
    // Where a vertex has several normals, faces meet in it that do not lie around it once: the
    // definition is of one that has one.
    std::vector<std::uint32_t> own_index(mesh.positions.size(), prep::no_index);
    std::vector<bool> several(mesh.positions.size(), false);
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        std::uint32_t& index = own_index[mesh.corner_vertices[c]];
        if (index != prep::no_index && index != normals.indices[c])
            several[mesh.corner_vertices[c]] = true;
        index = normals.indices[c];
    }
    const std::vector<Vector> own = weighted_normals(mesh.positions, mesh.corner_vertices, weight);
    std::vector<double> errors, from_definition, inside;
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const std::uint32_t v = mesh.corner_vertices[c];
        const Vector normal(normals.values[normals.indices[c]]);
        if (s.truth[v] != Vector(0)) errors.push_back(degrees_between(normal, s.truth[v]));
        if (!several[v]) from_definition.push_back(degrees_between(normal, own[v]));
    }
    std::vector<double> numbers = three_of(errors);
    numbers.push_back(summary_of(from_definition).largest);
    if (!s.torus) return numbers;
    for (std::uint32_t c = 0; c < mesh.corner_count(); c += 3) {
        Vector middle(0), normal(0);
        for (std::uint32_t k = c; k < c + 3; ++k) {
            middle += Vector(mesh.positions[mesh.corner_vertices[k]]) / Real(3);
            normal += Vector(normals.values[normals.indices[k]]);
        }
        inside.push_back(degrees_between(normal, torus_normal_near(middle)));
    }
    numbers.push_back(summary_of(inside).mean);
    return numbers;
}

std::vector<Metric> metrics_of(const WeightState& s) {
    std::vector<Metric> metrics = {
        {"largest", "°", "normals at corners"},
        {"99.9 %", "°", "normals at corners"},
        {"mean", "°", "normals at corners"},
        {"from the definition", "°", "largest; the weight's own normals"}};
    if (s.torus)
        metrics.push_back({"inside, mean", "°", "at triangles' middles, between the corners'"});
    return metrics;
}

// Of vertices of a coarser mesh, so many at most are held against the dense one.
constexpr std::size_t most_judged = 20000;
// Fewer say little.
constexpr std::size_t least_judged = 200;
// Where a cubic misses more of its surroundings, there is an edge or noise.
constexpr double most_misfit = 0.02;

// What a dense mesh says of one of its coarser selves, if it is dense and smooth enough.
struct Scan {
    std::shared_ptr<WeightState> state;
    std::string subject;
    double floor = 0;
    std::size_t judged = 0;
};

Scan scanned(const Subject& subject) {
    Scan scan;
    const auto s = std::make_shared<WeightState>();
    scan.state = s;
    s->threads = subject.threads;
    CoarseMesh coarse = coarse_mesh(*subject.mesh, 0.25);
    s->mesh = std::move(coarse.mesh);
    s->truth.assign(s->mesh.positions.size(), Vector(0));
    std::vector<std::uint32_t> places, dense;
    const std::size_t stride = s->mesh.positions.size() / most_judged + 1;
    for (std::uint32_t v = 0; v < s->mesh.positions.size(); v += std::uint32_t(stride)) {
        places.push_back(v);
        dense.push_back(coarse.dense_vertices[v]);
    }
    const auto fitted = [&](int rings) {
        return fitted_normals(coarse.dense.positions, coarse.dense.corner_vertices, dense, rings);
    };
    const std::vector<FittedNormal> truth = fitted(3), wider = fitted(4);
    std::vector<double> apart;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (!truth[i].known || truth[i].misfit > most_misfit) continue;
        s->truth[places[i]] = truth[i].normal;
        if (wider[i].known) apart.push_back(degrees_between(truth[i].normal, wider[i].normal));
        ++scan.judged;
    }
    scan.floor = summary_of(apart).mean;
    scan.subject = fmt::format("{}, reduced from {} to {} triangles: {} of {} normals judged",
                               subject.name, coarse.dense.face_count(), s->mesh.face_count(),
                               scan.judged, s->mesh.positions.size());
    return scan;
}

Rung weight_rung(std::shared_ptr<WeightState> s, prep::NormalWeight weight,
                 std::optional<prep::Precision> precision) {
    const std::string word(prep::name_of(weight));
    Rung rung;
    rung.name = word;
    rung.command = "prepare --weight " + word + " --hard-angle off";
    if (precision) rung.command += " --precision " + std::string(prep::name_of(*precision));
    rung.run = [s, weight, precision]() -> prep::Result<void> {
        prep::NormalOptions options;
        options.weight = weight;
        options.threads = s->threads;
        if (precision) {
            options.precision = *precision;
            s->faces = prep::face_normals(s->view, *precision, s->threads);
        }
        auto result = prep::corner_normals(s->view, s->topology, s->faces, s->hard, options);
        if (!result) return result.error();
        s->result = *std::move(result);
        return {};
    };
    rung.judge = [s, word] { return judged_weight(*s, word); };
    return rung;
}

constexpr const char* angles_cost_more =
    "an arctangent a corner takes longer than the lengths of two edges, and Max's weight is exact "
    "on spheres, which smooth surfaces are nearly";

}  // namespace

prep::Result<Ladder> normal_weight_ladder(const Subject& subject) {
    Scan scan;
    if (subject.mesh) scan = scanned(subject);
    const bool given = scan.judged >= least_judged;
    auto s = scan.state;
    if (given) {
        if (const prep::Result<void> done = measure_surroundings(*s); !done) return done.error();
    } else {
        const auto torus = torus_state(96, 48, subject.threads);
        if (!torus) return torus.error();
        s = *torus;
    }
    Ladder ladder;
    ladder.name = "normal-weight";
    ladder.title = "Weights of normals";
    ladder.setting = "normals: --weight";
    ladder.subject = "a jittered torus of 9,216 triangles";
    ladder.oracle =
        "the torus' own normals, in closed form; the weights' definitions in long double";
    if (given) {
        ladder.subject = scan.subject;
        ladder.oracle =
            "cubics fitted to the vertices of the mesh as it was given, three edges around each "
            "that was kept, in long double; not judged: boundaries, and where a cubic misses 2 %";
        ladder.floor = scan.floor;
        ladder.floor_text = "how far that truth moves, on average, with vertices four edges around";
    } else if (subject.mesh) {
        ladder.subject += fmt::format(
            ", as {} has too few smooth vertices to say what surface it was made from ({} where "
            "{} are needed)",
            subject.name, scan.judged, least_judged);
    }
    ladder.timed = {"corner normals (face normals are at hand)"};
    ladder.metrics = metrics_of(*s);
    ladder.primary = 2;
    for (const auto& entry : names_of(prep::NormalWeight{})) {
        Rung rung = weight_rung(s, entry.value, std::nullopt);
        if (entry.value == prep::NormalWeight::edge_length)
            rung.because =
                "Max's weight counts short edges most, and these say least where vertices are "
                "noisy or triangles uneven";
        else if (entry.value != prep::NormalWeight::area)
            rung.because = angles_cost_more;
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

prep::Result<Ladder> weight_by_precision_grid(const Subject& subject) {
    const auto made = torus_state(48, 24, subject.threads);
    if (!made) return made.error();
    const std::shared_ptr<WeightState> s = *made;
    Ladder ladder;
    ladder.name = "weight-by-precision";
    ladder.title = "Weights by precision of normals";
    ladder.setting = "normals: --weight and --precision together";
    ladder.subject = "a jittered torus of 2,304 triangles";
    ladder.oracle =
        "the torus' own normals, in closed form; the weights' definitions in long double";
    ladder.timed = {"face normals", "corner normals, no edge hard by its angle"};
    ladder.metrics = metrics_of(*s);
    ladder.primary = 2;
    const auto weights = names_of(prep::NormalWeight{});
    const auto precisions = names_of(prep::Precision{});
    GridSetting first{"weight", {}}, second{"precision", {}};
    for (const auto& entry : weights) first.values.emplace_back(entry.name);
    for (const auto& entry : precisions) second.values.emplace_back(entry.name);
    ladder.reference = 1;  // area, accurate
    make_grid(ladder, first, second, [&](std::size_t i, std::size_t j) {
        Rung rung = weight_rung(s, weights[i].value, precisions[j].value);
        rung.because = precisions[j].value == prep::Precision::fast
                           ? angles_cost_more
                           : "what triangles and a weight miss of the surface is ten thousand "
                             "times what the arithmetic loses";
        return rung;
    });
    return ladder;
}

}  // namespace cost
