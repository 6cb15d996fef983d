// The distance within which vertices become one: too small leaves cracks, too large melts details.
#include <cmath>
#include <memory>
#include <random>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/oracles/partitions.h"
#include "prep/repair.h"

namespace cost {
namespace {

constexpr double scatter = 1e-5;  // of each copy of a point, at most

struct WeldState {
    prep::Mesh soup;
    std::vector<std::uint32_t> points;  // by corner: the vertex of the whole surface
    int threads = 0;
};

// Every corner of a torus with a vertex of its own, moved by at most `scatter` in any direction.
void make_soup(WeldState& s) {
    const KnownMesh known = known_torus(120, 48, 0.3);
    std::mt19937_64 random(27);
    const auto component = [&] { return double(random() >> 11) * 0x1p-52 - 1; };
    s.points = known.mesh.corner_vertices;
    s.soup.face_offsets = known.mesh.face_offsets;
    for (const std::uint32_t point : s.points) {
        glm::dvec3 by;
        do by = {component(), component(), component()};
        while (glm::dot(by, by) > 1);
        s.soup.corner_vertices.push_back(std::uint32_t(s.soup.positions.size()));
        // A hair less, for the rounding to float.
        s.soup.positions.push_back(
            glm::vec3(glm::dvec3(known.mesh.positions[point]) + 0.97 * scatter * by));
    }
}

}  // namespace

prep::Result<Ladder> weld_distance_ladder(const Subject& subject) {
    const auto s = std::make_shared<WeldState>();
    s->threads = subject.threads;
    make_soup(*s);
    Ladder ladder;
    ladder.name = "weld-distance";
    ladder.title = "Distance of welding";
    ladder.setting = "repair: --repair weld=DISTANCE";
    ladder.subject = "a torus of 11,520 triangles whose corners were scattered by up to 0.00001";
    ladder.oracle = "which corners were one point before they were scattered";
    ladder.timed = {"a copy of the mesh", "welding"};
    ladder.metrics = {{"wrong", "% of points", "torn or melted"},
                      {"torn", "% of points", "left with several vertices"},
                      {"melted", "% of points", "made one with another"}};
    ladder.reference_is_default = false;
    ladder.reference = 3;
    constexpr const char* torn_or_melted =
        "below the scatter, points stay torn and more vertices are written; at the length of an "
        "edge, neighbours melt";
    for (const char* const distance :
         {"0", "0.000005", "0.00001", "0.00002", "0.001", "0.03", "0.06"}) {
        Rung rung;
        rung.name = distance;
        rung.command = std::string("prepare --repair weld=") + distance;
        rung.because = torn_or_melted;
        prep::RepairOptions options;
        options.weld_tolerance = std::strtod(distance, nullptr);
        const auto made = std::make_shared<prep::Mesh>();
        rung.run = [s, made, options]() -> prep::Result<void> {
            *made = s->soup;
            const auto done = prep::repair(*made, options, 0, s->threads);
            if (!done) return done.error();
            return {};
        };
        rung.judge = [s, made] {
            const PartitionMistakes m = partition_mistakes(s->points, made->corner_vertices);
            const auto share = [&](std::size_t n) { return 100.0 * double(n) / double(m.points); };
            return std::vector<double>{share(m.wrong), share(m.torn), share(m.melted)};
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
