#include "meshprep/budgets/quantize_budget.h"

#include <fmt/format.h>

#include <algorithm>

#include "judge/judgement.h"
#include "meshprep/budgets/stored_bytes.h"
#include "meshprep/files/private_directory.h"
#include "prep/load.h"

namespace meshprep {
namespace {

using prep::Quantization;
using prep::Result;

struct DirectionRow {
    const char* name;
    std::size_t row;  // of prep::quantization_rows
    std::optional<double> DirectionErrors::*asked;
    int Quantization::*bits;
    std::optional<double> judge::Limits::*limit;
    const char* attribute;  // in glTF files
};
constexpr DirectionRow direction_rows[] = {
    {"normals", 1, &DirectionErrors::normals, &Quantization::normals, &judge::Limits::normals,
     "NORMAL"},
    {"tangents", 2, &DirectionErrors::tangents, &Quantization::tangents, &judge::Limits::tangents,
     "TANGENT"},
};

const DirectionRow& row_of(const DirectionChoice& choice) {
    return std::string_view(choice.name) == direction_rows[0].name ? direction_rows[0]
                                                                   : direction_rows[1];
}

class Search {
  public:
    Search(const prep::PreparedScene& prepared, std::filesystem::path directory,
           const prep::SaveOptions& options, const DirectionErrors& asked)
        : prepared_(prepared), directory_(std::move(directory)), options_(options) {
        for (const DirectionRow& row : direction_rows)
            if (asked.*row.asked) {
                DirectionChoice& choice = choices_.emplace_back();
                choice.name = row.name;
                choice.asked = *(asked.*row.asked);
            }
    }

    // Rung by rung, until each choice has one that holds and the one after it.
    Result<void> run() {
        for (const int bits : direction_rungs()) {
            if (std::all_of(choices_.begin(), choices_.end(),
                            [](const DirectionChoice& c) { return c.next.has_value(); }))
                break;
            const auto tried = rung_of(bits);
            if (!tried) return tried.error();
            for (DirectionChoice& choice : choices_) take(choice, (*tried)[row_of(choice).row]);
        }
        return {};
    }

    // More bits for what turned out to be less exact than it is by the writer's numbers. Whether
    // there are any.
    Result<bool> refine(DirectionChoice& choice) {
        if (choice.chosen.bits == 0 || !choice.next) return false;
        const std::vector<int> rungs = direction_rungs();
        const auto at = std::find(rungs.begin(), rungs.end(), choice.next->bits);
        std::optional<BitsTried> after;
        if (at + 1 != rungs.end()) {
            const auto tried = rung_of(at[1]);
            if (!tried) return tried.error();
            after = (*tried)[row_of(choice).row];
        }
        choice.tried.push_back(*choice.next);
        choice.chosen = *choice.next;
        choice.next = after;
        return true;
    }

    Quantization chosen() const {
        Quantization bits = options_.quantization;
        for (const DirectionChoice& choice : choices_)
            bits.*row_of(choice).bits = choice.chosen.bits;
        return bits;
    }

    // The same with directions as floats.
    Result<std::filesystem::path> reference() {
        Quantization bits = options_.quantization;
        for (const DirectionChoice& choice : choices_) bits.*row_of(choice).bits = 0;
        std::filesystem::path file = directory_ / "floats.glb";
        if (const auto done = save(file, bits, nullptr); !done) return done.error();
        return file;
    }

    std::vector<DirectionChoice>& choices() { return choices_; }

  private:
    static void take(DirectionChoice& choice, const BitsTried& rung) {
        if (choice.met) {
            if (!choice.next) choice.next = rung;
            return;
        }
        choice.tried.push_back(rung);
        if (choice.tried.size() == 1 || rung.degrees < choice.chosen.degrees) choice.chosen = rung;
        choice.met = rung.degrees <= choice.asked;
        if (choice.met) choice.chosen = rung;
    }

    Result<void> save(const std::filesystem::path& file, const Quantization& bits,
                      prep::QuantizationReport* report) {
        prep::SaveOptions options;
        options.compression = prep::Compression::none;
        options.quantization = bits;
        options.quantized = report;
        const auto notes = prep::save_scene(prepared_, file, options);
        return notes ? Result<void>() : Result<void>(notes.error());
    }

    Result<std::vector<BitsTried>> rung_of(int bits) {
        Quantization tried;
        for (const DirectionChoice& choice : choices_) tried.*row_of(choice).bits = bits;
        prep::QuantizationReport report;
        const std::filesystem::path file = directory_ / "rung.glb";
        if (const auto done = save(file, tried, &report); !done) return done.error();
        std::vector<BitsTried> rows;
        for (const prep::QuantizationError& row : report.rows)
            rows.push_back({bits, row.largest + float_rounding_degrees, row.values});
        for (const DirectionChoice& choice : choices_) {
            const DirectionRow& row = row_of(choice);
            // As the file has them: what came as whole numbers stays so where nothing is rounded.
            const Result<std::uint64_t> bytes = stored_bytes(file, row.attribute);
            if (!bytes) return bytes.error();
            rows[row.row].bytes = *bytes;
        }
        return rows;
    }

    const prep::PreparedScene& prepared_;
    std::filesystem::path directory_;
    const prep::SaveOptions& options_;
    std::vector<DirectionChoice> choices_;
};

// Both files, read; angles where nodes place them.
Result<judge::Judgement> measured(const prep::Scene& reference, const std::filesystem::path& path,
                                  int threads) {
    prep::LoadOptions load;
    load.threads = threads;
    const Result<prep::Scene> written = prep::load_scene(path, load);
    if (!written) return written.error();
    judge::JudgeOptions options;
    for (const judge::LimitRow& row : judge::limit_rows) options.limits.*row.limit = {};
    options.limits.normals = options.limits.tangents = 0;
    options.views = 0;
    options.threads = threads;
    return judge::judge(reference, *written, options);
}

// Of the faces that nodes place, those of meshes with normals or tangents.
std::uint64_t corners_of(const prep::Scene& scene, const DirectionRow& row) {
    std::uint64_t corners = 0;
    for (const prep::Node& node : scene.nodes) {
        if (node.mesh == prep::no_index) continue;
        const prep::Mesh& mesh = scene.meshes[node.mesh];
        const bool there =
            row.limit == &judge::Limits::normals ? !mesh.normals.empty() : !mesh.tangents.empty();
        if (there) corners += mesh.corner_vertices.size();
    }
    return corners;
}

// What the judge compares, and the stored values wherever they are.
void measure(DirectionChoice& choice, const prep::Scene& truth, const judge::Judgement& judgement) {
    const DirectionRow& row = row_of(choice);
    for (const judge::Measured& m : judgement.measured) {
        if (m.row->limit != row.limit) continue;
        choice.corners = m.compared;
        // Of both files' directions.
        choice.achieved = m.compared > 0 ? m.value + 2 * float_rounding_degrees : 0;
    }
    choice.placed = std::max(corners_of(truth, row), choice.corners);
    if (choice.there()) choice.achieved = std::max(choice.achieved, choice.chosen.degrees);
    choice.met = choice.achieved <= choice.asked;
}

Json rung_json(const BitsTried& rung) {
    return {{"bits", rung.bits}, {"degrees", rung.degrees}, {"bytes", rung.bytes}};
}

}  // namespace

std::string quantization_words(const Quantization& bits) {
    std::string text;
    for (const prep::QuantizationRow& row : prep::quantization_rows)
        if (bits.*row.bits != 0)
            text += fmt::format("{}{}={}", text.empty() ? "" : ",", row.name, bits.*row.bits);
    return text;
}

Quantization usual_quantization() {
    return {16, 12, 12, 16};
}

std::vector<int> direction_rungs() {
    return {8, 9, 10, 11, 12, 13, 14, 15, 16, 0};
}

bool QuantizationCertificate::met() const {
    return std::all_of(directions.begin(), directions.end(),
                       [](const DirectionChoice& c) { return c.met; });
}

std::string DirectionChoice::scope() const {
    if (!there()) return "none there";
    std::string text = corners == placed ? "measured on all " : "measured on ";
    text += with_commas(corners);
    if (corners != placed) text += " of " + with_commas(placed);
    text += " corners that were read";
    if (chosen.values > 0)
        text += fmt::format(", and on all {} stored values", with_commas(chosen.values));
    return text;
}

std::string QuantizationCertificate::scope() const {
    std::string text;
    for (const DirectionChoice& c : directions)
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", c.name, c.scope());
    return text;
}

namespace {

// Where no other program looks: what is at `path` stays until what replaces it is known.
Result<std::filesystem::path> candidate_in(const std::filesystem::path& directory,
                                           const std::filesystem::path& path) {
    std::error_code failed;
    std::filesystem::create_directories(directory / "candidate", failed);
    if (failed)
        return prep::Error{prep::ErrorCode::io, failed.message(),
                           (directory / "candidate").string()};
    return directory / "candidate" / path.filename();
}

}  // namespace

Result<SavedWithin> save_within(const prep::PreparedScene& prepared,
                                const std::filesystem::path& path, const prep::SaveOptions& options,
                                const DirectionErrors& asked, int threads) {
    const Result<PrivateDirectory> directory = PrivateDirectory::make();
    if (!directory) return directory.error();
    Search search(prepared, directory->path(), options, asked);
    if (const auto done = search.run(); !done) return done.error();
    const auto reference = search.reference();
    if (!reference) return reference.error();
    prep::LoadOptions load;
    load.threads = threads;
    const Result<prep::Scene> truth = prep::load_scene(*reference, load);
    if (!truth) return truth.error();
    const auto candidate = candidate_in(directory->path(), path);
    if (!candidate) return candidate.error();
    prep::SaveOptions save = options;
    save.replace = true;
    save.spared = {};
    save.written = nullptr;
    for (bool again = true; again;) {
        again = false;
        save.quantization = search.chosen();
        if (const auto done = prep::save_scene(prepared, *candidate, save); !done)
            return done.error();
        const Result<judge::Judgement> judgement = measured(*truth, *candidate, threads);
        if (!judgement) return judgement.error();
        for (DirectionChoice& choice : search.choices()) {
            measure(choice, *truth, *judgement);
            if (choice.met) continue;
            const Result<bool> refined = search.refine(choice);
            if (!refined) return refined.error();
            again |= *refined;
        }
    }
    SavedWithin out;
    prep::SaveOptions last = options;
    last.quantization = search.chosen();
    auto notes = prep::save_scene(prepared, path, last);
    if (!notes) return notes.error();
    out.notes = *std::move(notes);
    out.certificate.bits = search.chosen();
    out.certificate.directions = std::move(search.choices());
    return out;
}

Json to_json(const QuantizationCertificate& c, const std::string& command) {
    Json json;
    json["met"] = c.met();
    json["scope"] = c.scope();
    json["unit"] = "degrees, the largest";
    json["directions"] = Json::array();
    for (const DirectionChoice& d : c.directions) {
        Json one{{"attribute", d.name},
                 {"asked", d.asked},
                 {"achieved", d.achieved},
                 {"met", d.met},
                 {"corners", d.corners},
                 {"corners_placed", d.placed},
                 {"values", d.chosen.values},
                 {"chosen", rung_json(d.chosen)},
                 {"next", d.next ? rung_json(*d.next) : Json(nullptr)},
                 {"tried", Json::array()}};
        for (const BitsTried& rung : d.tried) one["tried"].push_back(rung_json(rung));
        json["directions"].push_back(std::move(one));
    }
    json["command"] = command;
    return json;
}

Json to_json(const prep::QuantizationReport& report) {
    Json json = Json::array();
    for (std::size_t r = 0; r < std::size(report.rows); ++r) {
        const prep::QuantizationError& e = report.rows[r];
        if (e.bits == 0) continue;
        json.push_back({{"attribute", prep::quantization_rows[r].name},
                        {"bits", e.bits},
                        {"values", e.values},
                        {"kept", e.kept},
                        {"largest", e.largest},
                        {"mean", e.mean},
                        {"unit", prep::quantization_rows[r].unit}});
    }
    return json;
}

}  // namespace meshprep
