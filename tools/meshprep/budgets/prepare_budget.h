// The most accurate settings of preparation that fit a time: `prepare --budget-ms`.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "meshprep/budgets/time_certificate.h"
#include "prep/prepare.h"

namespace meshprep {

// Of a scene's faces whose normals are made, some hundred to some thousand that lie together, as
// meshes without anything but positions.
struct SampledFaces {
    prep::Scene scene;
    double corners = 0;
    double corners_of_all = 0;  // that `scene` stands for; those of morph targets count again
};

// Whole meshes of at most 4,096 faces, and of larger ones the 1,024 nearest to each of some faces:
// at most four such parts, spread over all faces. `made`: by mesh.
SampledFaces sampled_faces(const prep::Scene& scene, const std::vector<bool>& made);

// What each precision takes, from what `fast` took with all faces, and what each took with the
// sampled ones: the difference to `fast` is that of each corner. Milliseconds; in the order fast,
// accurate, exact.
std::vector<TimePrediction> precision_predictions(double fast, const std::array<double, 3>& sampled,
                                                  double corners, double corners_of_all);

// What levels 0, 1, … took, and what those after them take, up to `most`: what the last level added
// for each face that it added, or all of it where it took no longer than the one before. `scheme`:
// "catmark".
std::vector<TimePrediction> level_predictions(const std::vector<double>& milliseconds, int most,
                                              const std::string& scheme);

// The finest level at which cages of so many corners have at most 2^24 faces.
int finest_level(std::uint64_t corners);

struct PreparedWithin {
    prep::PreparedScene prepared;
    double milliseconds = 0;  // of preparing it; `times.taken` has what a process of its own adds
    TimeCertificate times;
};

// Chooses the precision of normals, or, where `options` subdivides, the level, and prepares so.
// Pilots are `fast` with all faces and each precision with some of them; or levels 0 and 1 and each
// next one that is predicted to fit, or of which too little is known.
// What was prepared for a pilot is the result where it is what was chosen. Errors: those of
// preparing.
prep::Result<PreparedWithin> prepare_within(prep::Scene scene, const prep::PrepareOptions& options,
                                            double asked);

inline constexpr TimedWork preparing_work = {
    "prepare", "preparing",
    "milliseconds to prepare, without reading and writing; the most accurate normals, or the "
    "finest level"};

}  // namespace meshprep
