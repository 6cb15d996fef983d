#include "meshprep/commands/prepare_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "meshprep/budgets/explicit_command.h"
#include "meshprep/budgets/prepare_budget.h"
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

Json reads_json(const prep::AttributeReads& reads) {
    return {{"normals", reads.normals},
            {"tangents", reads.tangents},
            {"colors", reads.colors},
            {"uv_sets", reads.uv_sets}};
}

// What calls for what the stages make: each reason once, with the meshes that have it.
void print_calls(const Json& requirements, const CommonOptions& common, Console& console) {
    std::vector<std::vector<std::string>> rows;
    std::vector<std::size_t> meshes;
    std::map<std::vector<std::string>, std::size_t> places;  // of the rows
    const auto add = [&](const std::string& what, const Json& why) {
        const std::vector<std::string> row{"  " + what, why["label"], why["sentence"]};
        const auto [place, is_new] = places.try_emplace(row, rows.size());
        if (is_new) {
            rows.push_back(row);
            meshes.push_back(0);
        }
        ++meshes[place->second];
    };
    for (const Json& mesh : requirements) {
        for (const char* key : {"normals", "tangents", "uvs"}) {
            const Json& why = mesh[key]["why"];
            const bool called = std::any_of(mesh["calls"].begin(), mesh["calls"].end(),
                                            [&](const Json& call) { return call["why"] == why; });
            if (!called) add(key, why);  // the rest is told with what calls for it
        }
        for (const Json& call : mesh["calls"]) add(call["feature"], call["why"]);
    }
    constexpr std::size_t most = 40;
    for (std::size_t k = 0; k < rows.size(); ++k)
        if (requirements.size() > 1)
            rows[k][2] += " (" + count_of(meshes[k], "mesh", "meshes") + ")";
    const std::size_t left = rows.size() - std::min(rows.size(), most);
    rows.resize(rows.size() - left);
    console.result(common, "  called for");
    console.table(common, rows, {});
    if (left > 0) console.result(common, fmt::format("    and {} more: --json has them", left));
}

// What an order of triangles is worth.
std::string order_text(const prep::OrderChange& c) {
    std::string text = fmt::format(
        "{} and {} moved; vertices shaded a triangle {:.3f} → {:.3f} (16 in the cache), for each "
        "vertex {:.3f} → {:.3f}",
        count_of(c.triangles, "triangle"), count_of(c.vertices, "vertex", "vertices"),
        c.before.acmr, c.after.acmr, c.before.atvr, c.after.atvr);
    if (c.kept_triangles > 0)
        text += fmt::format("; {} stay in order", count_of(c.kept_triangles, "blended triangle"));
    return text;
}

std::string quantized_text(const prep::QuantizationError& e, const prep::QuantizationRow& row) {
    std::string text = fmt::format("{} of {} bits: ", row.name, e.bits);
    if (e.values > 0)
        text += fmt::format("{} rounded, off by {:.3g} {} at most, {:.3g} in the mean",
                            with_commas(e.values), e.largest, row.unit, e.mean);
    if (e.kept > 0)
        text += fmt::format("{}{} stay floats", e.values > 0 ? "; " : "", with_commas(e.kept));
    return e.values + e.kept > 0 ? text : text + "none there";
}

std::string bits_text(int bits) {
    return bits == 0 ? "floats" : fmt::format("{} bits", bits);
}

std::string more_bytes(std::uint64_t from, std::uint64_t to) {
    if (from == to) return "as many bytes";
    return from < to ? count_of(to - from, "byte", "bytes") + " more"
                     : count_of(from - to, "byte", "bytes") + " fewer";
}

void print_certificate(const Outcome& o, const PrepareCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    for (const DirectionChoice& d : o.certificate->directions) {
        console.result(common,
                       fmt::format("  {}: {:.3g}° asked, {:.3g}° with {}, {}", d.name, d.asked,
                                   d.achieved, bits_text(d.chosen.bits), d.scope()));
        if (d.next)
            console.result(common, fmt::format("    next: {:.3g}° with {}, {}", d.next->degrees,
                                               bits_text(d.next->bits),
                                               more_bytes(d.chosen.bytes, d.next->bytes)));
    }
    console.result(common, "  the same again: " + again_text(o, command));
}

}  // namespace

Json requirements_json(const prep::PreparedScene& prepared,
                       const std::vector<std::vector<prep::Call>>& calls) {
    Json all = Json::array();
    for (std::size_t m = 0; m < prepared.requirements.size(); ++m) {
        const prep::MeshRequirements& of = prepared.requirements[m];
        Json mesh{{"mesh", m}, {"mesh_name", prepared.scene.meshes[m].name}};
        const auto need = [&](const char* key, const prep::Need& n) {
            mesh[key] = {{"needed", n.needed}, {"why", to_json(n.why, prepared.scene)}};
        };
        need("normals", of.normals);
        need("tangents", of.tangents);
        need("uvs", of.uvs);
        mesh["provided"] = reads_json(of.provided);
        mesh["calls"] = Json::array();
        for (const prep::Call& call : calls[m])
            mesh["calls"].push_back({{"feature", prep::name_of(call.feature)},
                                     {"reads", reads_json(call.reads)},
                                     {"why", to_json(call.why, prepared.scene)}});
        all.push_back(std::move(mesh));
    }
    return all;
}

std::string again_text(const Outcome& o, const PrepareCommand& command) {
    Settings settings = command.settings;
    // The ending of a file says it, and standard output has none.
    if (!is_standard_stream(o.job.output)) settings.erase("--format");
    const std::filesystem::path output =
        command.files.in_place ? std::filesystem::path() : o.job.output;
    std::string chosen;
    if (o.certificate) {
        for (const char* name : {"--quantize", "--normal-error", "--tangent-error"})
            settings.erase(name);
        chosen = "--quantize " + quantization_words(o.certificate->bits);
    }
    if (o.times) {
        for (const char* name : {"--budget-ms", "--subdivide"}) settings.erase(name);
        chosen += (chosen.empty() ? "" : " ") + o.times->chosen.setting;
    }
    return explicit_command("prepare", o.job.input, output, settings, chosen);
}

std::string unmet_text(const Outcome& o) {
    std::string text;
    for (const DirectionChoice& d : o.certificate->directions)
        if (!d.met)
            text += fmt::format("{}no storage keeps {} within {}°; the best found has {}°",
                                text.empty() ? "" : "; ", d.name, d.asked, not_below(d.achieved));
    return o.job.output.string() + ": " + text;
}

Json outcome_json(const Outcome& o, const PrepareCommand& command) {
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
    for (const prep::StageReport& stage : o.stages)
        json["stages"].push_back(to_json(stage, command.explain));
    if (!o.requirements.is_null()) json["requirements"] = o.requirements;
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
    for (std::size_t m = 0; m < o.orders.size(); ++m) {
        if (!o.orders[m]) continue;
        Json order = to_json(*o.orders[m]);
        order["mesh"] = m;
        order["mesh_name"] = o.mesh_names[m];
        json["optimized"].push_back(std::move(order));
    }
    for (std::size_t k = 0; k < o.residual_maps.size(); ++k)
        json["residual_maps"].push_back(to_json(o.residual_maps[k], o.residual_names[k]));
    if (o.quantized) json["quantized"] = to_json(*o.quantized);
    if (o.certificate) json["certificate"] = to_json(*o.certificate, again_text(o, command));
    if (o.times) json["budget"] = to_json(*o.times, preparing_work, again_text(o, command));
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
    if (!command.explain) return json;
    const auto memory = [](const MemoryUse& m) {
        return Json{{"page_faults", m.page_faults}, {"peak_bytes", m.peak_bytes}};
    };
    json["memory"] = {{"read", memory(o.read_memory)},
                      {"prepare", memory(o.prepare_memory)},
                      {"write", memory(o.write_memory)}};
    return json;
}

ManifestEntry manifest_entry(const Outcome& o, const PrepareCommand& command) {
    ManifestEntry entry;
    entry.job = o.job;
    entry.job.error = o.error;
    entry.sources = o.sources;
    entry.absent.assign(o.absent.begin(), o.absent.end());
    // What is beyond what was asked of it is not done: the next run fails by it as well.
    entry.complete = o.complete && o.met();
    if (o.error) return entry;
    for (const std::filesystem::path& file : o.written) entry.outputs.push_back(hashed(file));
    const Json json = outcome_json(o, command);
    for (const char* key :
         {"before", "after", "repairs", "tessellated", "optimized", "residual_maps", "quantized",
          "certificate", "findings", "warnings", "remarks", "notes"})
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
    for (std::size_t m = 0; m < o.orders.size(); ++m)
        if (o.orders[m])
            console.result(common, fmt::format("  order of '{}': {}", o.mesh_names[m],
                                               order_text(*o.orders[m])));
    for (std::size_t k = 0; k < o.residual_maps.size(); ++k)
        console.result(common, "  " + residual_text(o.residual_maps[k], o.residual_names[k]));
    if (o.quantized)
        for (std::size_t r = 0; r < std::size(o.quantized->rows); ++r)
            if (o.quantized->rows[r].bits != 0)
                console.result(common, "  " + quantized_text(o.quantized->rows[r],
                                                             prep::quantization_rows[r]));
    if (o.certificate) print_certificate(o, command, console);
    if (command.explain) {
        console.result(common, "  stages");
        std::vector<std::vector<std::string>> stages;
        for (const prep::StageReport& s : o.stages)
            stages.push_back({"  " + s.stage, s.run ? "run" : "skipped",
                              s.moved_bytes > 0 ? byte_size(s.moved_bytes) + " moved" : "",
                              s.run ? count_of(s.page_faults, "page fault") : "",
                              s.run ? byte_size(s.peak_bytes) + " at most" : "",
                              s.run ? duration(s.milliseconds) : "",
                              s.exact > 0 ? fmt::format("{}; {} decided by exact arithmetic",
                                                        s.reason, with_commas(s.exact))
                                          : s.reason});
        console.table(common, stages, {false, false, true, true, true, true});
    }
    if (!o.requirements.is_null()) print_calls(o.requirements, common, console);
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
