#include <fmt/format.h>

#include <set>

#include "meshprep/commands/selftest.h"
#include "meshprep/commands/subcommand.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/output/cage_summary.h"
#include "meshprep/output/conventions_text.h"
#include "meshprep/output/counts.h"
#include "meshprep/output/file_records.h"
#include "meshprep/output/findings_text.h"
#include "meshprep/output/load_options.h"
#include "meshprep/output/placement_text.h"
#include "meshprep/output/report_json.h"
#include "prep/check.h"
#include "prep/load.h"

namespace meshprep {
namespace {

struct InspectCommand {
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    bool strict = false;
    bool selftest = false;     // instead of inputs
    std::uint32_t places = 4;  // shown per finding
};

std::string image_name(const prep::Scene& scene, const prep::TextureRef& ref) {
    if (ref.texture >= scene.textures.size()) return "texture " + std::to_string(ref.texture);
    const std::uint32_t image = scene.textures[ref.texture].image;
    if (image >= scene.images.size()) return "no image";
    const prep::ImageRef& r = scene.images[image];
    if (!r.channels.empty()) return r.name;  // put together from several
    if (!r.path.empty()) return r.path.filename().string();
    return (r.name.empty() ? "image " + std::to_string(image) : r.name) + " (" +
           byte_size(r.bytes.size()) + ")";
}

std::string name_or(const std::string& name, const char* kind, std::size_t index) {
    return name.empty() ? fmt::format("{} {}", kind, index) : name;
}

std::string attributes_of(const prep::Mesh& mesh) {
    std::vector<std::string> list;
    if (!mesh.normals.empty()) list.emplace_back("normals");
    if (!mesh.tangents.empty()) list.emplace_back("tangents");
    if (!mesh.uvs.empty()) list.push_back(count_of(mesh.uvs.size(), "UV set"));
    if (!mesh.colors.empty()) list.push_back(count_of(mesh.colors.size(), "colour set"));
    if (!mesh.face_smoothing.empty()) list.emplace_back("smoothing groups");
    if (!mesh.subdivision.creases.empty())
        list.push_back(count_of(mesh.subdivision.creases.size(), "crease"));
    return list.empty() ? "no attributes" : fmt::format("{}", fmt::join(list, ", "));
}

std::string faces_of(const prep::MeshSummary& s) {
    std::vector<std::string> list;
    if (s.triangles > 0) list.push_back(count_of(s.triangles, "triangle"));
    if (s.quads > 0) list.push_back(count_of(s.quads, "quad"));
    if (s.polygons > 0)
        list.push_back(
            fmt::format("{} (up to {} corners)", count_of(s.polygons, "polygon"), s.largest_face));
    if (s.line_segments > 0) list.push_back(count_of(s.line_segments, "line segment"));
    if (s.point_primitives > 0) list.push_back(count_of(s.point_primitives, "point"));
    return list.empty() ? "no faces" : fmt::format("{}", fmt::join(list, ", "));
}

std::string shape_of(const prep::MeshSummary& s) {
    if (s.faces == 0) return {};
    std::string text = count_of(s.components, "component");
    text += s.closed ? ", closed"
                     : fmt::format(", {} open edges in {}", with_commas(s.open_edges),
                                   count_of(s.holes, "loop"));
    text += s.manifold ? ", manifold" : ", not manifold";
    if (!s.oriented) text += ", mixed orientation";
    if (s.genus >= 0) text += fmt::format(", genus {}", s.genus);
    return text;
}

std::string size_of(const prep::MeshSummary& s) {
    const glm::dvec3 extent = s.high - s.low;
    std::string text = fmt::format("{:.4g} × {:.4g} × {:.4g}", extent.x, extent.y, extent.z);
    const glm::dvec3 centre = (s.low + s.high) * 0.5;
    text += fmt::format(" about ({:.4g}, {:.4g}, {:.4g})", centre.x, centre.y, centre.z);
    if (s.area > 0) text += fmt::format(", area {:.4g}", s.area);
    if (s.volume != 0) text += fmt::format(", volume {:.4g}", s.volume);
    return text;
}

Json vector_json(const glm::dvec3& v) {
    return Json::array({v.x, v.y, v.z});
}

Json mesh_json(const prep::Mesh& mesh, const prep::MeshSummary& s, int threads) {
    Json json;
    json["name"] = mesh.name;
    json["vertices"] = s.vertices;
    json["points"] = s.points;
    json["faces"] = s.faces;
    json["triangles"] = s.triangles;
    json["quads"] = s.quads;
    json["polygons"] = s.polygons;
    json["largest_face"] = s.largest_face;
    json["line_segments"] = s.line_segments;
    json["point_primitives"] = s.point_primitives;
    json["edges"] = s.edges;
    json["open_edges"] = s.open_edges;
    json["holes"] = s.holes;
    json["non_manifold_edges"] = s.non_manifold_edges;
    json["non_manifold_vertices"] = s.non_manifold_vertices;
    json["mixed_orientation_edges"] = s.mixed_orientation_edges;
    json["components"] = s.components;
    json["closed"] = s.closed;
    json["manifold"] = s.manifold;
    json["oriented"] = s.oriented;
    json["euler"] = s.euler;
    json["genus"] = s.genus >= 0 ? Json(s.genus) : Json(nullptr);
    json["largest_valence"] = s.largest_valence;
    json["mirrored_uv_faces"] = s.mirrored_uv_faces;
    json["low"] = vector_json(s.low);
    json["high"] = vector_json(s.high);
    json["area"] = s.area;
    json["volume"] = s.volume;
    json["has_normals"] = !mesh.normals.empty();
    json["has_tangents"] = !mesh.tangents.empty();
    json["uv_sets"] = mesh.uvs.size();
    json["color_sets"] = mesh.colors.size();
    json["smoothing_groups"] = !mesh.face_smoothing.empty();
    json["parts"] = mesh.parts;
    if (s.faces > 0) json["cage"] = to_json(summarise_cage(mesh, threads));
    return json;
}

Json scene_json(const prep::Scene& scene) {
    Json materials = Json::array();
    for (const prep::Material& m : scene.materials) {
        Json maps = Json::object();
        for (const prep::MaterialMap& map : prep::material_maps)
            if (m.*map.ref) maps[map.name] = image_name(scene, m.*map.ref);
        materials.push_back({{"name", m.name},
                             {"maps", maps},
                             {"double_sided", m.double_sided},
                             {"unlit", m.unlit},
                             {"metallic_roughness", m.metallic_roughness}});
    }
    return materials;
}

void print_file(const std::filesystem::path& path, const prep::Scene& scene,
                const prep::SceneCheck& check, const SceneConventions& conventions,
                const Counts& gltf, const InspectCommand& command, Console& console) {
    const CommonOptions& common = command.common;
    const auto say = [&](const std::string& line) { console.result(common, line); };
    std::error_code ec;
    const auto size = std::filesystem::file_size(path, ec);
    say(fmt::format("{}  {}", path.string(), ec ? "" : byte_size(size)));
    std::vector<std::string> parts = {
        count_of(scene.meshes.size(), "mesh", "meshes"), count_of(scene.nodes.size(), "node"),
        count_of(scene.materials.size(), "material"), count_of(scene.textures.size(), "texture")};
    if (!scene.lights.empty()) parts.push_back(count_of(scene.lights.size(), "light"));
    if (!scene.cameras.empty()) parts.push_back(count_of(scene.cameras.size(), "camera"));
    const Counts own = gltf.figures.empty() ? count_parts(scene) : gltf;
    for (const char* name : {"skins", "animations", "morph targets"})
        if (const std::uint64_t* n = own.find(name); n && *n > 0)
            parts.push_back(with_commas(*n) + " " + name);
    say(fmt::format("  {}", fmt::join(parts, ", ")));
    for (const std::string& remark : scene.remarks) console.result(command.common, "  " + remark);
    if (const std::string placed = placement_text(scene.placement); !placed.empty())
        say("  " + placed);
    if (!gltf.extensions.empty())
        say(fmt::format("  extensions: {}", fmt::join(gltf.extensions, ", ")));

    constexpr std::size_t most = 100;
    for (std::size_t m = 0; m < scene.meshes.size() && m < most; ++m) {
        const prep::MeshSummary& s = check.meshes[m];
        say(fmt::format("  {}: {}, {}; {}", name_or(scene.meshes[m].name, "mesh", m),
                        count_of(s.vertices, "vertex", "vertices"), faces_of(s),
                        attributes_of(scene.meshes[m])));
        if (const std::string shape = shape_of(s); !shape.empty()) say("    " + shape);
        if (s.vertices > 0) say("    " + size_of(s));
        // Quads and tags are what cages have.
        if (s.faces == 0) continue;
        const CageSummary cage = summarise_cage(scene.meshes[m], common.threads);
        if (cage.tagged() || 2 * s.quads > s.faces) say("    " + cage_text(cage));
    }
    if (scene.meshes.size() > most)
        say("  … and " + count_of(scene.meshes.size() - most, "more mesh", "more meshes"));
    std::size_t with_maps = 0;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        std::vector<std::string> maps;
        for (const prep::MaterialMap& map : prep::material_maps)
            if (const prep::TextureRef& ref = scene.materials[m].*map.ref)
                maps.push_back(fmt::format("{} map {}", map.name, image_name(scene, ref)));
        if (!maps.empty() && ++with_maps <= most)
            say(fmt::format("  {}: {}", name_or(scene.materials[m].name, "material", m),
                            fmt::join(maps, ", ")));
    }
    if (with_maps > most)
        say("  … and " +
            count_of(with_maps - most, "more material with maps", "more materials with maps"));
    for (const std::string& line : conventions_text(conventions, scene)) say("  " + line);
    std::vector<std::string> names;
    for (const prep::Mesh& mesh : scene.meshes) names.push_back(mesh.name);
    if (check.findings.empty()) {
        say("  no findings");
        return;
    }
    say("  findings");
    for (const std::string& line : findings_text(check.findings, names, command.places)) say(line);
}

std::string degrees_text(double value) {
    return fmt::format("{:.1e}", value);
}

Json selftest_json(const Selftest& test) {
    Json json;
    json["ok"] = test.ok();
    json["bounds_degrees"] = {{"fast", selftest_fast_bound()},
                              {"accurate", selftest_accurate_bound()},
                              {"rounded", selftest_rounded_bound()}};
    json["cases"] = Json::array();
    for (const SelftestCase& c : test.cases)
        json["cases"].push_back({{"case", c.name},
                                 {"value", c.value},
                                 {"fast_degrees", c.fast},
                                 {"accurate_degrees", c.accurate},
                                 {"rounded_degrees", c.rounded},
                                 {"fans", c.fans},
                                 {"flagged", c.flagged},
                                 {"ok", c.ok}});
    json["checks"] = Json::array();
    for (const SelftestCheck& c : test.checks)
        json["checks"].push_back(
            {{"check", c.name}, {"unit", c.unit}, {"tried", c.tried}, {"wrong", c.wrong}});
    json["milliseconds"] = test.milliseconds;
    return json;
}

int run_selftest(const InspectCommand& command, Console& console) {
    console.progress(command.common, "hard cases …");
    const Selftest test = selftest(command.common.threads);
    console.progress(command.common, "");
    const auto say = [&](const std::string& line) { console.result(command.common, line); };
    say("Largest angles in degrees between our normals and exact ones");
    std::vector<std::vector<std::string>> rows = {
        {"case", "value", "fast", "accurate", "as float", "fans", "undetermined", ""}};
    for (const SelftestCase& c : test.cases)
        rows.push_back({c.name, fmt::format("{:g}", c.value), degrees_text(c.fast),
                        degrees_text(c.accurate), degrees_text(c.rounded), with_commas(c.fans),
                        with_commas(c.flagged), c.ok ? "ok" : "FAILED"});
    rows.push_back({"bound", "", degrees_text(selftest_fast_bound()),
                    degrees_text(selftest_accurate_bound()), degrees_text(selftest_rounded_bound()),
                    "", "", ""});
    for (const std::string& line :
         align_table(rows, {false, true, true, true, true, true, true, false}))
        say(line);
    say("");
    rows = {{"what must hold", "tried", "", "wrong"}};
    for (const SelftestCheck& c : test.checks)
        rows.push_back({c.name, with_commas(c.tried), c.unit, with_commas(c.wrong)});
    for (const std::string& line : align_table(rows, {false, true, false, true})) say(line);
    say(fmt::format("{} in {}", test.ok() ? "all is well" : "something is WRONG",
                    duration(test.milliseconds)));
    if (command.common.json) {
        Json document = json_head("inspect");
        document["selftest"] = selftest_json(test);
        console.json(json_text(document));
    }
    return test.ok() ? exit_done : exit_failed;
}

// What there is to say of one file.
Json inspect_file(std::size_t number, const InspectCommand& command, SiblingLinks& links,
                  Console& console, bool& warned) {
    const std::filesystem::path& path = command.inputs[number];
    Json file;
    file["input"] = path.string();
    const auto failed = [&](const prep::Error& error) {
        console.error(error);
        file["status"] = "failed";
        file["error"] = to_json(error);
        return file;
    };
    if (const auto fresh = require_unread(command.inputs, number); !fresh)
        return failed(fresh.error());
    const prep::Result<InputFile> input =
        InputFile::open(path, command.common.input_format, &links);
    if (!input) return failed(input.error());
    prep::LoadOptions options = load_options(command.common, console);
    options.allowed_extensions = {"all"};  // to describe a file takes no leave
    prep::Result<prep::Scene> scene = prep::load_scene(input->path(), options);
    if (!scene) return failed(input->relabelled(scene.error()));
    const Counts gltf = count_gltf_file(input->path());
    input->settle(*scene);
    const prep::SceneCheck check = prep::check(*scene, {command.common.threads});
    for (const std::string& text : scene->warnings)
        console.warning(command.common, said_of(path, text));
    warned = !scene->warnings.empty();
    const SceneConventions conventions = scene_conventions(*scene, command.common.threads);
    print_file(path, *scene, check, conventions, gltf, command, console);
    for (const prep::Finding& f : check.findings) warned |= f.severity != prep::Severity::info;
    file["status"] = "ok";
    file["counts"] = to_json(count_scene(*scene));
    if (!gltf.figures.empty()) file["gltf"] = to_json(gltf);
    if (gltf.figures.empty()) file["parts"] = to_json(count_parts(*scene));
    file["placement"] = to_json(scene->placement);
    file["meshes"] = Json::array();
    for (std::size_t m = 0; m < scene->meshes.size(); ++m)
        file["meshes"].push_back(
            mesh_json(scene->meshes[m], check.meshes[m], command.common.threads));
    file["materials"] = scene_json(*scene);
    file["conventions"] = to_json(conventions, *scene);
    file["findings"] = Json::array();
    for (const prep::Finding& f : check.findings) file["findings"].push_back(to_json(f, *scene));
    file["warnings"] = scene->warnings;
    if (!scene->remarks.empty()) file["remarks"] = scene->remarks;
    return file;
}

int run(const InspectCommand& command, Console& console) {
    if (command.selftest) return run_selftest(command, console);
    FileRecords records("inspect", command.common, console);
    SiblingLinks links;
    std::size_t failed = 0, with_warnings = 0;
    for (std::size_t number = 0; number < command.inputs.size(); ++number) {
        console.progress(command.common, command.inputs[number].string() + " …");
        bool warned = false;
        Json file = inspect_file(number, command, links, console, warned);
        failed += file["status"] == "failed";
        with_warnings += warned;
        records.add(std::move(file));
    }
    console.progress(command.common, "");
    const std::size_t total = command.inputs.size();
    records.finish({{"files", total},
                    {"ok", total - failed},
                    {"failed", failed},
                    {"with_warnings", with_warnings}});
    return failed > 0 || (command.strict && with_warnings > 0) ? exit_failed : exit_done;
}

void define(OptionSet& options, InspectCommand& c) {
    options.paths("input", c.inputs, "FILE",
                  "Mesh or scene files, .gz and .zip too, or - for standard input");
    options.flag("--selftest", c.selftest,
                 "Instead of files: hard cases in short form on this machine, with the errors "
                 "found; exit 1 when one fails");
    options.flag("--strict", c.strict, "Exit 1 when there is a warning or worse");
    options.number("--places", c.places, 0, 8, "N", "Places shown per finding (default 4)");
    add_input_options(options, c.common);
    add_reading_options(options, c.common.load);
    add_common_options(options, c.common);
    add_json_lines_option(options, c.common);
    options.examples(
        "  meshprep inspect teapot.obj\n"
        "  meshprep inspect model.glb --strict --quiet && echo clean\n"
        "  meshprep inspect model.glb --json | jq '.files[0].findings'\n"
        "  meshprep inspect --selftest");
}

void check(const InspectCommand& c) {
    if (c.common.json && c.common.json_lines)
        usage_error("--json",
                    "is one document, --json-lines a line for each file; give one of them");
    if (c.selftest && c.common.json_lines)
        usage_error("--json-lines", "is for files; --selftest takes --json");
    if (c.inputs.empty() != c.selftest)
        usage_error("input", c.selftest ? "--selftest takes no files"
                                        : "is missing; give files (or --selftest)");
}

}  // namespace

Subcommand inspect_subcommand() {
    return subcommand<InspectCommand>("inspect", "Say what is in a file and what is wrong with it",
                                      define, run, check);
}

}  // namespace meshprep
