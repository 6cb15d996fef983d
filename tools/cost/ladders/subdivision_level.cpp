// Levels of subdivision against the limit surface, a bicubic B-spline in closed form.
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/ladders/spline_cage.h"
#include "prep/subdivide.h"

namespace cost {

prep::Result<Ladder> subdivision_level_ladder(const Subject& subject) {
    struct State {
        SplineCage cage;
        prep::Mesh result;
    };
    const auto s = std::make_shared<State>();
    Ladder ladder;
    ladder.name = "subdivision-level";
    ladder.title = "Levels of subdivision";
    ladder.setting = "subdivision: --subdivide catmark:LEVEL";
    ladder.subject = "a closed cage of 48 quads";
    ladder.oracle = "the limit as a bicubic B-spline in long double, and its nearest point";
    ladder.timed = {"subdivision with limit positions and normals"};
    ladder.metrics = {{"largest", "of the diagonal", "distance of faces' middles to the limit"},
                      {"99.9 %", "of the diagonal", "distance of faces' middles to the limit"},
                      {"mean", "of the diagonal", "distance of faces' middles to the limit"},
                      {"normals, largest", "°", "vertex normals against the limit's"},
                      {"faces", "", "of the refined mesh"}};
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
        rung.run = [s, options]() -> prep::Result<void> {
            auto result = prep::subdivide(s->cage.mesh, options);
            if (!result) return result.error();
            s->result = std::move(result->mesh);
            return {};
        };
        rung.judge = [s] {
            const LimitErrors errors = limit_errors(s->cage, s->result);
            std::vector<double> numbers = three_of(errors.distances);
            numbers.push_back(summary_of(errors.degrees).largest);
            numbers.push_back(double(s->result.face_count()));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
