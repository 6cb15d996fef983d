// The error that adaptive triangles are asked for against the error that they have.
#include <limits>
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/ladders/spline_cage.h"
#include "prep/displacement/tessellate.h"

namespace cost {

prep::Result<Ladder> chord_error_ladder(const Subject& subject) {
    struct State {
        SplineCage cage;
        prep::TessellatedMesh result;
    };
    const auto s = std::make_shared<State>();
    Ladder ladder;
    ladder.name = "chord-error";
    ladder.title = "Chord error of adaptive triangles";
    ladder.setting = "tessellation of a subdivision surface: --chord-error";
    ladder.subject = "a closed cage of 48 quads";
    ladder.oracle = "the limit as a bicubic B-spline in long double, and its nearest point";
    ladder.timed = {"tessellation with its proof; without the samples that measure it"};
    ladder.metrics = {{"largest", "of the diagonal", "distance of triangles' middles to the limit"},
                      {"99.9 %", "of the diagonal", "distance of triangles' middles to the limit"},
                      {"mean", "of the diagonal", "distance of triangles' middles to the limit"},
                      {"asked", "of the diagonal", "--chord-error"},
                      {"proved", "of the diagonal", "the certificate"},
                      {"triangles", "", ""}};
    ladder.reference = 2;
    ladder.floor = 0x1p-25;
    ladder.floor_text = "coordinates rounded to float: half a unit in the last place of 1";
    for (const double share : {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5}) {
        const double asked = share * s->cage.diagonal;
        char text[32];
        std::snprintf(text, sizeof text, "%.4g", asked);
        Rung rung;
        rung.name = text;
        rung.command = std::string("prepare --subdivide catmark --chord-error ") + text;
        prep::TessellateOptions options;
        options.scheme = prep::SubdivisionScheme::catmark;
        options.chord_error = std::strtod(text, nullptr);
        options.samples = 0;
        options.threads = subject.threads;
        rung.run = [s, options]() -> prep::Result<void> {
            auto result = prep::tessellate(s->cage.mesh, options);
            if (!result) return result.error();
            s->result = *std::move(result);
            return {};
        };
        rung.judge = [s, asked = *options.chord_error] {
            const LimitErrors errors = limit_errors(s->cage, s->result.mesh);
            std::vector<double> numbers = three_of(errors.distances);
            numbers.push_back(asked / s->cage.diagonal);
            numbers.push_back(s->result.certificate.proved / s->cage.diagonal);
            numbers.push_back(double(s->result.mesh.face_count()));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
