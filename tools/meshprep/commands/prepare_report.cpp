#include "meshprep/commands/prepare_report.h"

#include <fmt/format.h>

#include <cmath>

#include "meshprep/output/count_rows.h"
#include "meshprep/output/findings_text.h"
#include "meshprep/output/placement_text.h"

namespace meshprep {
namespace {

std::string split_text(const Outcome& o) {
    std::string text;
    for (const prep::SplitCountName& row : prep::split_count_names)
        if (const std::uint64_t count = o.splits.*row.count; count > 0)
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", row.text, with_commas(count));
    return text;
}

// Three digits, no less than the value.
std::string not_below(double value) {
    const double digit = std::pow(10.0, std::floor(std::log10(value)) - 2);
    const std::string near = fmt::format("{:.3g}", value);
    return value > 0 && std::stod(near) < value ? fmt::format("{:.3g}", value + digit) : near;
}

std::string residual_text(const prep::ResidualMap& map, const std::string& material) {
    const std::string away =
        map.facing_away > 0
            ? fmt::format("; {} texels face away from their triangles, which no such map says",
                          with_commas(map.facing_away))
            : "";
    return fmt::format(
        "residual normals of '{}': {} × {}, {} bits, {} of the texels in charts; "
        "triangles' normals are off by {:.3g}° in the mean, {:.3g}° at most{}",
        material, map.size, map.size, map.bits,
        fmt::format("{:.3g} %", 100.0 * double(map.texels) / (double(map.size) * double(map.size))),
        map.mean_degrees, map.largest_degrees, away);
}

// What was asked of a mesh's triangles, what is proved of them, what was measured.
std::string certificate_text(const prep::TessellationCertificate& c) {
    std::string text = count_of(c.triangles, "triangle");
    if (c.asked) text += fmt::format(", error asked {:.3g}", *c.asked);
    text += std::isfinite(c.proved) ? ", proved at most " + not_below(c.proved)
                                    : std::string(", none proved");
    if (c.asked_pixels && c.proved_pixels)
        text += fmt::format(", {:.3g} pixels asked, ", *c.asked_pixels) +
                (std::isfinite(*c.proved_pixels) ? not_below(*c.proved_pixels) + " proved"
                                                 : std::string("none proved"));
    if (c.samples > 0)
        text += fmt::format(", measured {:.3g} on {} points", c.measured, with_commas(c.samples));
    return text;
}

}  // namespace

Json outcome_json(const Outcome& o) {
    Json json;
    json["input"] = o.job.input.string();
    json["output"] = o.job.output.string();
    json["status"] = o.error ? "failed" : o.skipped ? "skipped" : "ok";
    if (o.error) json["error"] = to_json(*o.error);
    if (o.skipped || o.before.figures.empty()) return json;  // nothing is known of what is in it
    json["before"] = to_json(o.before);
    json["after"] = to_json(o.after);
    if (!o.parts.figures.empty()) json["parts"] = to_json(o.parts);
    json["placement"] = to_json(o.placement);
    if (!o.gltf_before.figures.empty()) json["gltf_before"] = to_json(o.gltf_before);
    if (!o.gltf_after.figures.empty()) json["gltf_after"] = to_json(o.gltf_after);
    json["splits"] = to_json(o.splits);
    json["stages"] = Json::array();
    for (const prep::StageReport& stage : o.stages) json["stages"].push_back(to_json(stage));
    json["bytes"] = {{"input", o.bytes_before}, {"output", o.bytes_after}};
    if (!o.repairs.empty()) {
        json["repairs"] = Json::array();
        for (const prep::RepairStep& r : o.repairs) json["repairs"].push_back(to_json(r));
    }
    for (std::size_t m = 0; m < o.tessellated.size(); ++m) {
        if (!o.tessellated[m]) continue;
        Json certificate = to_json(*o.tessellated[m]);
        certificate["mesh"] = m;
        certificate["mesh_name"] = o.mesh_names[m];
        json["tessellated"].push_back(std::move(certificate));
    }
    for (std::size_t k = 0; k < o.residual_maps.size(); ++k)
        json["residual_maps"].push_back(to_json(o.residual_maps[k], o.residual_names[k]));
    json["findings"] = Json::array();
    for (const prep::Finding& f : o.findings) {
        Json finding = to_json(f, {});
        if (f.mesh < o.mesh_names.size()) finding["mesh_name"] = o.mesh_names[f.mesh];
        json["findings"].push_back(std::move(finding));
    }
    json["warnings"] = o.warnings;
    if (!o.remarks.empty()) json["remarks"] = o.remarks;
    json["notes"] = o.notes;
    json["milliseconds"] = {{"read", o.read_ms}, {"prepare", o.prepare_ms}, {"write", o.write_ms}};
    return json;
}

ManifestEntry manifest_entry(const Outcome& o) {
    ManifestEntry entry;
    entry.job = o.job;
    entry.job.error = o.error;
    entry.sources = o.sources;
    entry.complete = o.complete;
    if (o.error) return entry;
    for (const std::filesystem::path& file : o.written) entry.outputs.push_back(hashed(file));
    const Json json = outcome_json(o);
    for (const char* key : {"before", "after", "repairs", "tessellated", "residual_maps",
                            "findings", "warnings", "remarks", "notes"})
        if (json.contains(key)) entry.said[key] = json[key];
    return entry;
}

void print_details(const Outcome& o, const PrepareCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    console.result(common, fmt::format("{} → {}", o.job.input.string(), o.job.output.string()));
    std::vector<std::vector<std::string>> rows = {{"", "before", "after"}};
    add_count_rows(rows, o.before, o.after, {});
    const bool both_gltf = !o.gltf_before.figures.empty() && !o.gltf_after.figures.empty();
    if (both_gltf)
        add_count_rows(rows, o.gltf_before, o.gltf_after, {"meshes", "materials", "textures"});
    if (!o.gltf_after.figures.empty() && !o.parts.figures.empty()) {
        Counts after;
        for (const auto& figure : o.parts.figures)
            if (const std::uint64_t* value = o.gltf_after.find(figure.first))
                after.figures.emplace_back(figure.first, *value);
        add_count_rows(rows, o.parts, after, {});
    }
    rows.push_back({"bytes", with_commas(o.bytes_before), with_commas(o.bytes_after)});
    console.table(common, rows, {false, true, true});
    if (const std::string placed = placement_text(o.placement); !placed.empty())
        console.result(common, "  " + placed);
    if (both_gltf && !(o.gltf_before.extensions.empty() && o.gltf_after.extensions.empty()))
        console.result(
            common, fmt::format("  extensions  {} → {}", fmt::join(o.gltf_before.extensions, " "),
                                fmt::join(o.gltf_after.extensions, " ")));
    for (const std::string& remark : o.remarks) console.result(common, "  " + remark);
    if (const std::string splits = split_text(o); !splits.empty())
        console.result(common, "  vertices split at: " + splits);
    for (std::size_t m = 0; m < o.tessellated.size(); ++m)
        if (o.tessellated[m])
            console.result(common, fmt::format("  tessellated '{}': {}", o.mesh_names[m],
                                               certificate_text(*o.tessellated[m])));
    for (std::size_t k = 0; k < o.residual_maps.size(); ++k)
        console.result(common, "  " + residual_text(o.residual_maps[k], o.residual_names[k]));
    if (command.explain) {
        console.result(common, "  stages");
        std::vector<std::vector<std::string>> stages;
        for (const prep::StageReport& s : o.stages)
            stages.push_back({"  " + s.stage, s.run ? "run" : "skipped",
                              s.run ? duration(s.milliseconds) : "",
                              s.exact > 0 ? fmt::format("{}; {} decided by exact arithmetic",
                                                        s.reason, with_commas(s.exact))
                                          : s.reason});
        console.table(common, stages, {false, false, true});
    }
    for (const std::string& line : repairs_text(o.repairs, o.mesh_names, 4))
        console.result(common, line);
    for (const std::string& line : findings_text(o.findings, o.mesh_names, 4))
        console.result(common, line);
    console.result(common, fmt::format("  read {}, prepare {}, write {}", duration(o.read_ms),
                                       duration(o.prepare_ms), duration(o.write_ms)));
}

void print_row(const Outcome& o, const PrepareCommand& command, Console& console) {
    const auto figure = [](const Counts& counts, const char* name) {
        const std::uint64_t* value = counts.find(name);
        return value ? *value : 0;
    };
    const std::size_t warnings = o.warning_count();
    console.result(command.common,
                   fmt::format("ok      {} → {}  {} → {} vertices, {}, {}{}", o.job.input.string(),
                               o.job.output.string(), with_commas(figure(o.before, "vertices")),
                               with_commas(figure(o.after, "vertices")),
                               count_of(figure(o.after, "triangles"), "triangle"),
                               duration(o.read_ms + o.prepare_ms + o.write_ms),
                               warnings > 0 ? ", " + count_of(warnings, "warning") : ""));
    if (!command.explain) return;
    std::vector<std::vector<std::string>> stages;
    for (const prep::StageReport& s : o.stages)
        stages.push_back({"      " + s.stage, s.run ? "run" : "skipped",
                          s.run ? duration(s.milliseconds) : "", s.reason});
    console.table(command.common, stages, {false, false, true});
}

}  // namespace meshprep
