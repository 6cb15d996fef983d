// Modes and thresholds of tangents, on a torus whose ∂P/∂u is known.
#include <memory>
#include <numbers>
#include <random>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "prep/tangents.h"

namespace cost {
namespace {

constexpr int torus_around = 96, torus_across = 48;

struct TangentState {
    KnownMesh known;
    prep::CornerTangents result;
    int threads = 0;
};

// UVs and normals of the surface; triangles in random order, as files have them; every 101st
// triangle has all its UVs in one point, as unwrapping leaves some.
void add_attributes(TangentState& s) {
    prep::Mesh& mesh = s.known.mesh;
    std::mt19937_64 random(7);
    const std::size_t triangles = mesh.face_count();
    for (std::size_t i = triangles; i > 1; --i) {
        const std::size_t j = std::size_t(random() % i);
        for (std::size_t k = 0; k < 3; ++k)
            std::swap(mesh.corner_vertices[3 * (i - 1) + k], mesh.corner_vertices[3 * j + k]);
    }
    mesh.uvs.emplace_back();
    for (std::size_t t = 0; t < triangles; ++t) {
        glm::vec2 uv[3];
        float least_u = 2, least_v = 2;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.corner_vertices[3 * t + k];
            uv[k] = {float(v / torus_across) / torus_around,
                     float(v % torus_across) / torus_across};
            least_u = std::min(least_u, uv[k].x);
            least_v = std::min(least_v, uv[k].y);
        }
        for (glm::vec2& p : uv) {  // triangles over the seams keep their UVs together
            if (p.x - least_u > 0.5f) p.x -= 1;
            if (p.y - least_v > 0.5f) p.y -= 1;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.push_back(t % 101 == 0 ? uv[0] : uv[k]);
        }
    }
    for (const SurfaceSample& p : s.known.at) mesh.normals.values.push_back(glm::vec3(p.normal));
    mesh.normals.indices = mesh.corner_vertices;
}

}  // namespace

prep::Result<Ladder> tangent_mode_ladder(const Subject& subject) {
    const auto s = std::make_shared<TangentState>();
    s->threads = subject.threads;
    s->known = known_torus(torus_around, torus_across, 0);
    add_attributes(*s);

    Ladder ladder;
    ladder.name = "tangent-mode";
    ladder.title = "Tangents";
    ladder.setting = "tangents: --tangents and --tangent-angle";
    ladder.subject =
        "a torus of 9,216 triangles in random order, the UVs of every 101st in one point";
    ladder.oracle = "the torus' own ∂P/∂u, in closed form";
    ladder.timed = {"tangents of all corners (normals and UVs are at hand)"};
    ladder.metrics = {{"largest", "°", "tangents at corners"},
                      {"99.9 %", "°", "tangents at corners"},
                      {"mean", "°", "tangents at corners"}};
    ladder.primary = 2;
    constexpr const char* split_what_belongs_together =
        "small angles keep apart what is one surface: each corner has its triangle's own tangent";
    struct Setting {
        const char *name, *command;
        prep::TangentMode mode;
        double degrees;
        const char* because = "";
    };
    const Setting settings[] = {
        {"mikktspace", "prepare --tangents mikktspace", prep::TangentMode::mikktspace, 180},
        {"mikktspace-exact", "prepare --tangents mikktspace-exact",
         prep::TangentMode::mikktspace_exact, 180,
         "it gives the bits of the C reference, which leaves corners without a gradient pointing "
         "anywhere"},
        {"mikktspace, 4°", "prepare --tangents mikktspace --tangent-angle 4",
         prep::TangentMode::mikktspace, 4, split_what_belongs_together},
        {"mikktspace, 1°", "prepare --tangents mikktspace --tangent-angle 1",
         prep::TangentMode::mikktspace, 1, split_what_belongs_together},
    };
    for (const Setting& setting : settings) {
        Rung rung;
        rung.name = setting.name;
        rung.command = setting.command;
        rung.because = setting.because;
        prep::TangentOptions options;
        options.mode = setting.mode;
        options.angular_threshold =
            setting.degrees == 180 ? std::numbers::pi : setting.degrees * std::numbers::pi / 180;
        options.threads = s->threads;
        rung.run = [s, options]() -> prep::Result<void> {
            const prep::MeshView view(s->known.mesh);
            auto result = prep::corner_tangents(prep::TangentInput(view), options);
            if (!result) return result.error();
            s->result = *std::move(result);
            return {};
        };
        rung.judge = [s] {
            const prep::Mesh& mesh = s->known.mesh;
            return three_of(corner_errors(mesh, s->result.tangents, [&](std::uint32_t c) {
                return s->known.at[mesh.corner_vertices[c]].du;
            }));
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
