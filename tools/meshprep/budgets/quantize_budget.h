// The fewest bits that keep normals and tangents within an error: `prepare --normal-error
// --tangent-error --quantize auto`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meshprep/output/report_json.h"
#include "prep/prepared_scene.h"
#include "prep/save.h"

namespace meshprep {

// "positions=16,normals=12,…", those that are not floats.
std::string quantization_words(const prep::Quantization& bits);

// What `auto` says where no error is asked for: 16 bits for positions and UVs, 12 for normals and
// tangents, which keeps these within 0.026°.
prep::Quantization usual_quantization();

struct DirectionErrors {  // degrees; none: not asked for
    std::optional<double> normals, tangents;
    bool any() const { return normals || tangents; }
};

struct BitsTried {
    int bits = 0;        // 0: floats
    double degrees = 0;  // the largest, by the writer's own numbers, with floats' own rounding
    std::uint64_t values = 0;  // that were rounded, wherever they are in the file
    std::uint64_t bytes = 0;   // that the attribute takes in the file, not compressed
};

struct DirectionChoice {
    const char* name = "";
    // Of what the judge measured and of the stored values, the larger.
    double asked = 0, achieved = 0;
    std::uint64_t corners = 0;  // that the judge compared
    std::uint64_t placed = 0;   // of as many that nodes of the default scene have, or more
    bool met = false;
    BitsTried chosen;
    std::optional<BitsTried> next;
    std::vector<BitsTried> tried;
    bool there() const { return placed > 0 || chosen.values > 0; }
    std::string scope() const;
};

struct QuantizationCertificate {
    prep::Quantization bits;
    std::vector<DirectionChoice> directions;
    bool met() const;
    std::string scope() const;
};

// Fewest bits first: fixed, so that the choice depends on no clock. Floats are the last.
std::vector<int> direction_rungs();

// Half a unit in the last place, as degrees: what a float's rounding turns a direction by at most.
// The truth of what is measured are floats, so that it is added.
inline constexpr double float_rounding_degrees = 3.4151e-6;

struct SavedWithin {
    std::vector<std::string> notes;
    QuantizationCertificate certificate;
};

// Writes the file with the fewest bits that keep what was asked for (positions and UVs as
// `options` say, and so directions of which nothing was asked). Each is written to a private
// directory first, read back and measured; where that is more than was asked for, bits are added.
// What is at `path` is replaced once, by what was chosen.
// Errors: those of save_scene() and load_scene(), io (temporary files).
prep::Result<SavedWithin> save_within(const prep::PreparedScene& prepared,
                                      const std::filesystem::path& path,
                                      const prep::SaveOptions& options,
                                      const DirectionErrors& asked, int threads);

Json to_json(const QuantizationCertificate& certificate, const std::string& command);
Json to_json(const prep::QuantizationReport& report);

}  // namespace meshprep
