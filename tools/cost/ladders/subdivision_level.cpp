// Levels of subdivision against the limit surface, a bicubic B-spline in closed form.
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/ladders/spline_cage.h"
#include "prep/subdivide.h"

namespace cost {

prep::Result<Ladder> subdivision_level_ladder(const Subject& subject) {
    const auto cage = std::make_shared<const SplineCage>();
    Ladder ladder;
    ladder.name = "subdivision-level";
    ladder.title = "Levels of subdivision";
    ladder.setting = "subdivision: --subdivide catmark:LEVEL";
    ladder.subject = "a closed cage of 48 quads";
    ladder.oracle = "the limit as a bicubic B-spline in long double, and its nearest point";
    ladder.timed = {"subdivision with limit positions and normals", "freeing the last result"};
    ladder.metrics = {{"largest", "of the diagonal", limit_samples},
                      {"99.9 %", "of the diagonal", limit_samples},
                      {"mean", "of the diagonal", limit_samples},
                      {"normals, largest", "°", "vertex normals against the limit's"},
                      {"samples", "", "distances to the limit"},
                      {"faces", "", "of the refined mesh"},
                      {"back, largest", "of the diagonal", back_samples},
                      {"inside, largest", "°", "normals at faces' middles, between the corners'"}};
    ladder.reference = 1;
    // A face's middle is rounded nowhere, its corners to float.
    ladder.floor = 0x1p-25;
    ladder.floor_text = "coordinates rounded to float: half a unit in the last place of 1";
    for (int level = 1; level <= 6; ++level) {
        Rung rung;
        rung.name = "level " + std::to_string(level);
        rung.command = "prepare --subdivide catmark:" + std::to_string(level);
        prep::SubdivideOptions options;
        options.level = level;
        options.threads = subject.threads;
        // Each rung frees its own last result, not another's that is larger.
        const auto mesh = std::make_shared<prep::Mesh>();
        rung.run = [cage, mesh, options]() -> prep::Result<void> {
            auto result = prep::subdivide(cage->mesh, options);
            if (!result) return result.error();
            *mesh = std::move(result->mesh);
            return {};
        };
        rung.judge = [cage, mesh] {
            const LimitErrors errors = limit_errors(*cage, *mesh);
            std::vector<double> numbers = three_of(errors.distances);
            numbers.push_back(summary_of(errors.degrees).largest);
            numbers.push_back(double(errors.distances.size()));
            numbers.push_back(double(mesh->face_count()));
            numbers.push_back(farthest_from(*cage, *mesh));
            numbers.push_back(summary_of(errors.inside).largest);
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
