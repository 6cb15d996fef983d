// The error that adaptive triangles are asked for against the error that they have.
#include <limits>
#include <memory>

#include "cost/ladders/ladder.h"
#include "cost/ladders/meshes.h"
#include "cost/ladders/spline_cage.h"
#include "prep/displacement/tessellate.h"

namespace cost {

prep::Result<Ladder> chord_error_ladder(const Subject& subject) {
    const auto cage = std::make_shared<const SplineCage>();
    Ladder ladder;
    ladder.name = "chord-error";
    ladder.title = "Chord error of adaptive triangles";
    ladder.setting = "tessellation of a subdivision surface: --chord-error";
    ladder.subject = "a closed cage of 48 quads";
    ladder.oracle = "the limit as a bicubic B-spline in long double, and its nearest point";
    ladder.timed = {"tessellation with its proof; without the samples that measure it",
                    "freeing the last result"};
    ladder.metrics = {{"largest", "of the diagonal", limit_samples},
                      {"99.9 %", "of the diagonal", limit_samples},
                      {"mean", "of the diagonal", limit_samples},
                      {"asked", "of the diagonal", "--chord-error"},
                      {"proved", "of the diagonal", "the certificate"},
                      {"samples", "", "distances to the limit"},
                      {"triangles", "", ""},
                      {"back, largest", "of the diagonal", back_samples}};
    ladder.reference = 2;
    ladder.reference_is_default = false;
    ladder.floor = 0x1p-25;
    ladder.floor_text = "coordinates rounded to float: half a unit in the last place of 1";
    for (const double share : {1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5}) {
        const double asked = share * cage->diagonal;
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
        // Each rung frees its own last result, not another's that is larger.
        const auto made = std::make_shared<prep::TessellatedMesh>();
        rung.run = [cage, made, options]() -> prep::Result<void> {
            auto result = prep::tessellate(cage->mesh, options);
            if (!result) return result.error();
            *made = *std::move(result);
            return {};
        };
        rung.judge = [cage, made, asked = *options.chord_error] {
            const LimitErrors errors = limit_errors(*cage, made->mesh);
            std::vector<double> numbers = three_of(errors.distances);
            numbers.push_back(asked / cage->diagonal);
            numbers.push_back(made->certificate.proved / cage->diagonal);
            numbers.push_back(double(errors.distances.size()));
            numbers.push_back(double(made->mesh.face_count()));
            numbers.push_back(farthest_from(*cage, made->mesh));
            return numbers;
        };
        ladder.rungs.push_back(std::move(rung));
    }
    return ladder;
}

}  // namespace cost
