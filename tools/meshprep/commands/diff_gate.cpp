#include "meshprep/commands/diff_gate.h"

#include <fmt/format.h>

#include <cmath>

#include "meshprep/files/output_directories.h"
#include "prep/files.h"

namespace meshprep {
namespace {

std::string with_unit(double value, const char* unit) {
    if (std::isnan(value)) return "not measured";
    std::string text = fmt::format("{:.4g}", value);
    if (*unit != '\0') text += std::string(" ") + unit;
    return text;
}

std::string measured_text(const judge::Measured& m) {
    if (m.compared == 0 && !(m.value > 0)) return "nothing to compare";
    if (m.high && *m.high > m.value)
        return fmt::format("{:.4g} … ", m.value) + with_unit(*m.high, m.row->unit);
    return (m.proved ? "≤ " : "") + with_unit(m.value, m.row->unit);
}
std::string limit_text(const judge::Measured& m) {
    return m.limit ? fmt::format("{:.4g}", *m.limit) : std::string("none");
}
std::string verdict_text(const judge::Measured& m) {
    if (!m.limit) return "not judged";
    if (m.within) return "within";
    return m.follows.empty() ? "BEYOND" : "beyond, follows from " + m.follows;
}

std::string named(const std::string& name, std::uint32_t index) {
    return name.empty() ? std::to_string(index) : fmt::format("{} '{}'", index, name);
}

std::string place_text(const judge::Finding& f, const prep::Scene& first) {
    std::string text;
    const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
    if (f.mesh < first.meshes.size()) add("mesh " + named(first.meshes[f.mesh].name, f.mesh));
    if (f.node < first.nodes.size()) add("node " + named(first.nodes[f.node].name, f.node));
    if (f.face != prep::no_index) add(fmt::format("face {}", f.face));
    if (f.corner != prep::no_index) add(fmt::format("corner {}", f.corner));
    if (!f.text.empty()) text += (text.empty() ? "" : ": ") + f.text;
    return text;
}

}  // namespace

void say_judgement(const CommonOptions& common, const judge::Judgement& judgement,
                   const prep::Scene& first, Console& console) {
    std::vector<std::vector<std::string>> rows = {
        {"measure", "stage", "found", "limit", "verdict"}};
    for (const judge::Measured& m : judgement.measured)
        rows.push_back(
            {m.row->name, m.row->stage, measured_text(m), limit_text(m), verdict_text(m)});
    console.table(common, rows, {false, false, true, true, false});
    // Names are what files say, and a terminal obeys their control characters.
    const auto say = [&](std::string line) {
        std::erase_if(line, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; });
        console.result(common, line);
    };
    for (const judge::Measured& m : judgement.measured) {
        if (m.within || !m.follows.empty()) continue;
        say(fmt::format("{}: {}, {} beyond the limit of {}", m.row->name, m.row->what,
                        with_commas(m.beyond), limit_text(m)));
        for (const judge::Finding& f : m.findings)
            say(fmt::format("    {} at {}", with_unit(f.value, m.row->unit), place_text(f, first)));
    }
    for (const std::string& note : judgement.notes) say("  " + note);
}

std::string failed_causes(const judge::Judgement& judgement) {
    std::string names;
    for (const judge::Measured& m : judgement.measured)
        if (!m.within && m.follows.empty())
            names += (names.empty() ? "" : ", ") + std::string(m.row->name);
    return names;
}

report::Page judgement_page(const JudgedFiles& files, const judge::Judgement& judgement,
                            const prep::Scene& first, const std::string& replay) {
    report::Page page;
    page.tables_first = true;  // what decides, before what it looks like
    page.title = files.b + " against " + files.a;
    const std::string causes = failed_causes(judgement);
    page.subtitle =
        causes.empty() ? "Everything is within its limits" : "Beyond its limit: " + causes;
    if (!files.gate.empty()) page.subtitle += " (gate " + files.gate + ")";
    page.subtitle += ".";
    report::Table found{"What differs", {"measure", "stage", "found", "where"}, {}};
    for (const judge::Measured& m : judgement.measured) {
        if (m.within) continue;
        for (const judge::Finding& f : m.findings)
            found.rows.push_back(
                {m.row->name, m.row->stage, with_unit(f.value, m.row->unit), place_text(f, first)});
    }
    report::Table all{
        "All measures", {"measure", "what", "found", "limit", "compared", "beyond", "verdict"}, {}};
    for (const judge::Measured& m : judgement.measured)
        all.rows.push_back({m.row->name, m.row->what, measured_text(m), limit_text(m),
                            with_commas(m.compared), with_commas(m.beyond), verdict_text(m)});
    report::Table notes{"Notes", {"note"}, {}};
    for (const std::string& note : judgement.notes) notes.rows.push_back({note});
    if (!replay.empty()) notes.rows.push_back({"The second file is made again by: " + replay});
    for (std::size_t v = 0; v < judgement.views.size(); ++v) {
        const judge::ViewJudged& view = judgement.views[v];
        if (view.a.pixels.empty()) continue;
        report::Sheet sheet;
        sheet.title = fmt::format("View {} of {}", v + 1, judgement.views.size());
        sheet.subtitle =
            view.outline > 0
                ? fmt::format("Outlines {:.3g} pixels apart, largest at ({}, {}); FLIP {:.4g}",
                              view.outline, view.x, view.y, view.flip)
                : fmt::format("Outlines alike; FLIP {:.4g}", view.flip);
        const auto panel = [&](const char* id, const char* title, const std::string& caption,
                               const prep::Image& picture) {
            report::Panel p;
            p.id = id;
            p.title = title;
            p.caption = caption;
            p.alt = fmt::format("{}, view {}", title, v + 1);
            p.picture = picture;
            sheet.panels.push_back(std::move(p));
        };
        panel("first", "First", files.a, view.a);
        panel("second", "Second", files.b, view.b);
        panel("flip", "FLIP", "black is equal, white as different as can be", view.difference);
        page.sheets.push_back(std::move(sheet));
    }
    for (report::Table* table : {&found, &all, &notes})
        if (!table->rows.empty()) page.tables.push_back(std::move(*table));
    return page;
}

prep::Result<void> write_page(const std::filesystem::path& path, const report::Page& page) {
    const prep::Result<std::string> html = report::html_page(page);
    if (!html) return html.error();
    OutputDirectories directories;
    if (const prep::Result<void> made = directories.make_for(path); !made) return made.error();
    return prep::write_file(path, std::as_bytes(std::span<const char>(html->data(), html->size())));
}

}  // namespace meshprep
