// What a face counts in a corner's normal, on surfaces whose normals are known.
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/weighted_normals.h"
#include "prep/corner_normals.h"

namespace cost {
namespace {

struct WeightState {
    KnownMesh known;
    prep::MeshView view;
    prep::Topology topology;
    prep::FaceNormals faces;
    prep::HardEdges hard;
    prep::CornerNormals result;
    int threads = 0;
};

}  // namespace

prep::Result<Ladder> normal_weight_ladder(const Subject& subject) {
    const auto s = std::make_shared<WeightState>();
    s->known = known_torus(96, 48, 0.25);
    s->threads = subject.threads;
    s->view = prep::MeshView(s->known.mesh);
    s->topology = prep::build_topology(s->view, {}, s->threads);
    s->faces = prep::face_normals(s->view, prep::Precision::accurate, s->threads);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    const auto hard = prep::hard_edges(s->view, s->topology, s->faces, edges);
    if (!hard) return hard.error();
    s->hard = *hard;

    Ladder ladder;
    ladder.name = "normal-weight";
    ladder.title = "Weights of normals";
    ladder.setting = "normals: --weight";
    ladder.subject = "a jittered torus of 9,216 triangles";
    ladder.oracle =
        "the torus' own normals, in closed form; the weights' definitions in long double";
    ladder.timed = {"corner normals (face normals are at hand)"};
    ladder.metrics = {{"largest", "°", "normals at corners"},
                      {"99.9 %", "°", "normals at corners"},
                      {"mean", "°", "normals at corners"},
                      {"from the definition", "°", "largest; the weight's own normals"}};
    ladder.primary = 2;
    for (const auto& entry : names_of(prep::NormalWeight{})) {
        Rung rung;
        rung.name = std::string(entry.name);
        rung.command = "prepare --weight " + rung.name + " --hard-angle off";
        rung.run = [s, weight = entry.value]() -> prep::Result<void> {
            prep::NormalOptions options;
            options.weight = weight;
            options.threads = s->threads;
            auto result = prep::corner_normals(s->view, s->topology, s->faces, s->hard, options);
            if (!result) return result.error();
            s->result = *std::move(result);
            return {};
        };
        rung.judge = [s, name = rung.name] {
            const prep::Mesh& mesh = s->known.mesh;
            std::vector<double> numbers =
                three_of(corner_errors(mesh, s->result.normals, [&](std::uint32_t c) {
                    return s->known.at[mesh.corner_vertices[c]].normal;
                }));
            const std::vector<Vector> own =
                weighted_normals(mesh.positions, mesh.corner_vertices, name);
            numbers.push_back(three_of(corner_errors(mesh, s->result.normals, [&](std::uint32_t c) {
                return own[mesh.corner_vertices[c]];
            }))[0]);
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
