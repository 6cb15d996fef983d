// The threshold of hard edges on a turned part: too low splits what is round, too high smears rims.
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "prep/corner_normals.h"
#include "prep/split_vertices.h"

namespace cost {
namespace {

constexpr int facets_around = 240;  // 1.5° from facet to facet

struct HardAngleState {
    prep::Mesh mesh;
    std::vector<Vector> truth;  // by corner
    prep::MeshView view;
    prep::Topology topology;
    prep::FaceNormals faces;
    int threads = 0;
};

// Of one rung: what is overwritten while the clock runs is its own.
struct HardAngleResult {
    prep::CornerLayer<glm::vec3> normals;
    prep::VertexMesh split;
};

void add_face(HardAngleState& s, const std::vector<std::uint32_t>& vertices, TurnedFace face) {
    for (const std::uint32_t v : vertices) {
        s.mesh.corner_vertices.push_back(v);
        s.truth.push_back(turned_normal(face, Real(v % facets_around) / facets_around));
    }
    s.mesh.face_offsets.push_back(std::uint32_t(s.mesh.corner_vertices.size()));
}

// Two rings of quads between three rings of vertices, and two polygons.
void make_part(HardAngleState& s) {
    for (const ProfilePoint& p : turned_profile())
        for (int i = 0; i < facets_around; ++i) {
            const Vector out = turned_normal(TurnedFace::side, Real(i) / facets_around) * p.radius;
            s.mesh.positions.push_back(glm::vec3(out + Vector(0, 0, p.z)));
        }
    std::vector<std::uint32_t> bottom, top;
    for (std::uint32_t i = 0; i < facets_around; ++i) {
        const std::uint32_t j = (i + 1) % facets_around;
        add_face(s, {i, j, facets_around + j, facets_around + i}, TurnedFace::side);
        add_face(
            s, {facets_around + i, facets_around + j, 2 * facets_around + j, 2 * facets_around + i},
            TurnedFace::chamfer);
        bottom.push_back(facets_around - 1 - i);
        top.push_back(2 * facets_around + i);
    }
    add_face(s, bottom, TurnedFace::bottom);
    add_face(s, top, TurnedFace::top);
}

prep::Result<void> compute(HardAngleState& s, std::optional<double> angle,
                           HardAngleResult& result) {
    prep::HardEdgeOptions edges;
    edges.angle_degrees = angle;
    edges.threads = s.threads;
    const auto hard = prep::hard_edges(s.view, s.topology, s.faces, edges);
    if (!hard) return hard.error();
    prep::NormalOptions options;
    options.threads = s.threads;
    auto normals = prep::corner_normals(s.view, s.topology, s.faces, *hard, options);
    if (!normals) return normals.error();
    s.mesh.normals = std::move(normals->normals);
    prep::SplitOptions split;
    split.threads = s.threads;
    auto vertices = prep::split(s.mesh, &*hard, split);
    result.normals = std::move(s.mesh.normals);
    s.mesh.normals = {};
    if (!vertices) return vertices.error();
    result.split = *std::move(vertices);
    return {};
}

}  // namespace

prep::Result<Ladder> hard_angle_ladder(const Subject& subject) {
    const auto s = std::make_shared<HardAngleState>();
    s->threads = subject.threads;
    make_part(*s);
    s->view = prep::MeshView(s->mesh);
    s->topology = prep::build_topology(s->view, {}, s->threads);
    s->faces = prep::face_normals(s->view, prep::Precision::accurate, s->threads);

    Ladder ladder;
    ladder.name = "hard-angle";
    ladder.title = "Threshold of hard edges";
    ladder.setting = "hard edges: --hard-angle";
    ladder.subject = "a turned part: a side of 240 facets, a chamfer of 45°, a sharp rim";
    ladder.oracle = "the part's own normals, in closed form";
    ladder.timed = {"hard edges", "corner normals weighted by area", "split into vertices"};
    ladder.metrics = {{"largest", "°", "normals at corners"},
                      {"99.9 %", "°", "normals at corners"},
                      {"mean", "°", "normals at corners"},
                      {"vertices", "", "after the split"}};
    ladder.primary = 2;
    const std::pair<const char*, std::optional<double>> angles[] = {
        {"0", 0.0}, {"15", 15.0}, {"30", 30.0}, {"60", 60.0}, {"90", 90.0}, {"off", std::nullopt}};
    ladder.reference = 3;
    for (const auto& [word, angle] : angles) {
        const std::optional<double> a = angle;
        Rung rung;
        rung.name = word;
        if (angle) rung.name += "°";
        rung.command = std::string("prepare --hard-angle ") + word;
        if (a == 0.0)
            rung.because = "every edge is hard: all vertices are split, and facets are no surface";
        else if (a > 45.0)
            rung.because =
                "the chamfer's 45° are smoothed away; an edge at exactly 90° is decided exactly, "
                "which takes long";
        else if (!a)
            rung.because = "nothing is hard: rims are smoothed away";
        const auto result = std::make_shared<HardAngleResult>();
        rung.run = [s, result, a] { return compute(*s, a, *result); };
        rung.judge = [s, result] {
            std::vector<double> numbers = three_of(corner_errors(
                s->mesh, result->normals, [&](std::uint32_t c) { return s->truth[c]; }));
            numbers.push_back(double(result->split.vertex_count()));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
