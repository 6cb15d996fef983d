// How depths are kept: which surfaces close behind another one stay hidden.
#include <algorithm>
#include <cmath>

#include "cost/ladders/scenes.h"

namespace cost {
namespace {

// Strips side by side, each with a white surface in front of a black one: distances from 1 to
// 1,000, gaps from 1e-6 to 1e-2 of the distance.
constexpr int distances = 32, gaps = 32;

// Of each pair the black surface behind, of material 1, is drawn first: it stays where depths that
// are equal cannot show that the white one is nearer.
prep::PreparedScene strips() {
    prep::VertexMesh mesh;
    const auto patch = [&](double x, double y, double distance, std::uint32_t material) {
        const std::uint32_t first = std::uint32_t(mesh.positions.size());
        // Patches fill their cell of the picture at any distance: tan(45°) = 1 = half its height.
        for (const auto& [i, j] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
            const double u = (x + i) * 2 / distances - 1, v = (y + j) * 2 / gaps - 1;
            mesh.positions.push_back({float(u * distance), float(v * distance), float(-distance)});
        }
        for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + k);
        mesh.ranges.push_back(
            {std::uint32_t(mesh.triangle_count()) - 2, 2, material, prep::no_index});
    };
    for (int x = 0; x < distances; ++x) {
        for (int y = 0; y < gaps; ++y) {
            const double d = std::pow(1000.0, double(x) / (distances - 1));
            const double gap = std::pow(10.0, -6 + 4 * double(y) / (gaps - 1));
            patch(x, y, d * (1 + gap), 1);  // first: of equal depths the first is kept
            patch(x, y, d, 0);
        }
    }
    const std::vector<prep::VertexMesh::Range> ranges = mesh.ranges;
    prep::PreparedScene scene = scene_of(std::move(mesh), plain_white());
    scene.meshes[0].ranges = ranges;
    scene.scene.materials.push_back(plain_white());
    scene.scene.materials[1].diffuse = glm::vec4(0, 0, 0, 1);
    return scene;
}

}  // namespace

prep::Result<Ladder> depth_format_ladder(const Subject& subject) {
    const auto scene = std::make_shared<const prep::PreparedScene>(strips());
    Ladder ladder;
    ladder.name = "depth-format";
    ladder.title = "Depth formats";
    ladder.setting = "pictures: --depth";
    ladder.subject =
        "1,024 pairs of surfaces, 1 to 1,000 away, the second behind by 1e-6 to 1e-2 of that; "
        "near plane at 0.1";
    ladder.oracle = "the nearer one is seen, by construction";
    ladder.timed = {"plan", "transform, visibility and shading (two colours)"};
    ladder.metrics = {{"wrong", "of the pixels", "that show the surface behind"}};
    for (const auto& entry : names_of(prep::DepthFormat{})) {
        rast::RenderRequest request;
        request.width = request.height = 256;
        request.depth_format = entry.value;
        request.threads = subject.threads;
        rast::View view;
        view.yfov = 1.5707963267948966;
        view.znear = 0.1;
        request.view = view;
        request.lights = std::vector<rast::LightInstance>{};
        Rung rung;
        rung.name = std::string(entry.name);
        rung.command = "render --depth " + rung.name;
        if (entry.value != prep::DepthFormat::float32)
            rung.because = "fewer bits of a depth take as long here: memory is not what limits";
        const auto drawing = std::make_shared<Drawing>(scene, request);
        rung.run = [drawing] { return drawing->draw(); };
        rung.judge = [drawing] {
            std::size_t wrong = 0;
            const Pixels picture = first_channel(drawing->frame());
            for (const double v : picture.values) wrong += v < 0.5;
            return std::vector<double>{double(wrong) / double(picture.values.size())};
        };
        rung.look = [drawing] {
            const Pixels picture = first_channel(drawing->frame());
            Pixels white = picture;
            std::fill(white.values.begin(), white.values.end(), 1.0);
            return look_of(picture, white);
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
