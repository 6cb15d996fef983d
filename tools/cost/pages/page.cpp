#include "cost/pages/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cost/pages/plot.h"
#include "sheets/page.h"

namespace cost {
namespace {

using report::html_escaped;

constexpr const char* style_sheet =
    R"(:root { color-scheme: light dark; --page: #f6f7f9; --sheet: #ffffff; --text: #111827;
  --quiet: #4b5563; --line: #d5dae1; --warn: #b45309; }
@media (prefers-color-scheme: dark) { :root { --page: #14171c; --sheet: #1b1f26; --text: #e5e7eb;
  --quiet: #a3abb8; --line: #343a44; --warn: #fbbf24; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 28px 20px 60px; }
h1 { font-size: 1.7rem; margin: 0 0 4px; } h2 { font-size: 1.2rem; margin: 0 0 2px; }
p { margin: 0 0 12px; color: var(--quiet); overflow-wrap: anywhere; }
section { background: var(--sheet); border: 1px solid var(--line); border-radius: 10px;
  padding: 18px; margin: 20px 0; display: grid; gap: 8px 28px; grid-template-columns: minmax(0, 1fr); }
@media (min-width: 900px) { section { grid-template-columns: minmax(0, 11fr) minmax(0, 10fr); }
  section > header, section > .scroll { grid-column: 1 / -1; } section > footer { align-self: center; } }
section svg { width: 100%; max-width: 620px; height: auto; display: block; overflow: visible; }
@media (max-width: 600px) { main { padding: 18px 12px 40px; } section { padding: 12px; } }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .86rem; width: 100%; }
th, td { text-align: left; padding: 4px 12px 4px 0; border-bottom: 1px solid var(--line);
  white-space: nowrap; font-variant-numeric: tabular-nums; }
th { color: var(--quiet); font-weight: 600; } td.n, th.n { text-align: right; }
.warn { color: var(--warn); } ul { margin: 0; padding-left: 1.1em; color: var(--quiet); font-size: .88rem; }
code { font-family: ui-monospace, "DejaVu Sans Mono", monospace; font-size: .92em; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 4px 16px; font-size: .92rem; } a { color: inherit; }
summary { cursor: pointer; color: var(--quiet); font-size: .88rem; }
)";

// In a table of numbers: the ratio and how well it is known.
std::string ratio_text(const Estimate& ratio) {
    if (ratio.low == 1 && ratio.high == 1) return "1";
    if (!std::isfinite(ratio.high)) return short_number(ratio.value);
    return fmt::format("{} ({} to {})", short_number(ratio.value), short_number(ratio.low),
                       short_number(ratio.high));
}

std::string heading(const Metric& m) {
    return m.unit.empty() ? m.name : m.unit == "°" ? m.name + " °" : m.name + " (" + m.unit + ")";
}

std::string table_html(const LadderRecord& ladder) {
    std::string html = "<div class=\"scroll\" tabindex=\"0\"><table><thead><tr>";
    for (const std::string& name : name_headings(ladder))
        html += "<th>" + html_escaped(name) + "</th>";
    html += "<th>where it stands</th><th class=\"n\">time</th><th class=\"n\">";
    html += ladder.reference_is_default ? "to the default</th>" : "to the reference</th>";
    for (const Metric& m : ladder.metrics)
        html += "<th class=\"n\" title=\"" + html_escaped(m.domain) + "\">" +
                html_escaped(heading(m)) + "</th>";
    html += "</tr></thead><tbody>\n";
    for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
        const RungRecord& rung = ladder.rungs[i];
        html += "<tr>";
        for (const std::string& name : name_cells(ladder, i))
            html += "<td>" + html_escaped(name) + "</td>";
        html += fmt::format("<td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                            html_escaped(standing_text(ladder, rung)), short_time(rung.time.value),
                            ratio_text(rung.ratio));
        for (const double e : rung.errors) html += "<td class=\"n\">" + short_number(e) + "</td>";
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string section_html(const LadderRecord& ladder, std::size_t number) {
    std::string html = fmt::format(
        "<section id=\"ladder-{}\"><header><h2>{}</h2><p>{}. Tried on {}. "
        "Truth: {}.</p></header>\n",
        number, html_escaped(ladder.title), html_escaped(ladder.setting),
        html_escaped(ladder.subject), html_escaped(ladder.oracle));
    html += "<div>" + plot_svg(ladder, false) + "</div>\n";
    html += "<footer><ul>";
    for (const std::string& note : ladder.notes)
        html += "<li class=\"warn\">" + html_escaped(note) + "</li>";
    std::string timed;
    for (const std::string& part : ladder.timed) timed += (timed.empty() ? "" : "; ") + part;
    html += "<li>Timed: " + html_escaped(timed) + ".</li>";
    const Metric& m = ladder.metrics[ladder.primary];
    html += "<li>Plotted: " + html_escaped(heading(m)) +
            (m.domain.empty() ? "" : ", " + html_escaped(m.domain)) + ".</li>";
    if (!ladder.grid.empty())
        html += "<li>Lines join the values of one setting, " + html_escaped(ladder.grid[1].name) +
                ", for each of the other, " + html_escaped(ladder.grid[0].name) + ".</li>";
    if (ladder.floor)
        html += std::string(layout_of(ladder).floor > 0 ? "<li>Dashed line at "
                                                        : "<li>Floor, far from what is plotted: ") +
                short_number(*ladder.floor) + ": " + html_escaped(ladder.floor_text) + ".</li>";
    html += fmt::format(
        "<li>{} rounds; the {} setting measured a second time: {} of its own "
        "time.</li></ul>",
        ladder.control.size(), ladder.reference_is_default ? "default" : "reference",
        ratio_text(ladder.control_ratio));
    if (const std::vector<std::string> sentences = rises(ladder); !sentences.empty()) {
        html += "<details><summary>Where more time buys no less error, and why</summary><ul>";
        for (const std::string& sentence : sentences)
            html += "<li>" + html_escaped(sentence) + ".</li>";
        html += "</ul></details>";
    }
    html += "<details><summary>Commands</summary><ul>";
    for (const RungRecord& rung : ladder.rungs)
        html += "<li><code>meshprep " + html_escaped(rung.command) + "</code></li>";
    return html + "</ul></details></footer>\n" + table_html(ladder) + "</section>\n";
}

std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

}  // namespace

std::string cost_page(const CostTable& table) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
        "<title>What accuracy costs in time</title><style>\n";
    html += style_sheet + plot_style() + "</style></head><body><main>\n";
    html += "<h1>What accuracy costs in time</h1>\n";
    html += fmt::format(
        "<p>meshprep {}, {}, {}. Farther down is more accurate, farther left is "
        "faster. Filled points are on the front: nothing is as good and faster. "
        "Orange rings are dominated: something is faster and no worse. Grey rings "
        "are tied: something takes as long and has less error. A horizontal stroke is the "
        "time's 95 % interval.</p>\n",
        html_escaped(table.version), html_escaped(table.processor),
        table.threads == 1 ? std::string("1 thread") : fmt::format("{} threads", table.threads));
    html += "<nav>";
    for (std::size_t i = 0; i < table.ladders.size(); ++i)
        html +=
            fmt::format("<a href=\"#ladder-{}\">{}</a>", i, html_escaped(table.ladders[i].title));
    html += "</nav>\n";
    for (std::size_t i = 0; i < table.ladders.size(); ++i)
        html += section_html(table.ladders[i], i);
    return html + "</main></body></html>\n";
}

std::string cost_csv(const CostTable& table) {
    std::string csv =
        "ladder,subject,setting,command,metric,unit,domain,error,seconds,seconds_low,seconds_high,"
        "ratio,ratio_low,ratio_high,standing,first_setting,first_value,second_setting,"
        "second_value\r\n";
    for (const LadderRecord& ladder : table.ladders)
        for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
            const RungRecord& rung = ladder.rungs[i];
            std::string pair = ",,,";
            if (!ladder.grid.empty()) {
                const GridSetting &first = ladder.grid[0], &second = ladder.grid[1];
                pair = csv_cell(first.name) + "," +
                       csv_cell(first.values[i / second.values.size()]) + "," +
                       csv_cell(second.name) + "," +
                       csv_cell(second.values[i % second.values.size()]);
            }
            for (std::size_t m = 0; m < ladder.metrics.size(); ++m) {
                const Metric& metric = ladder.metrics[m];
                for (const std::string& text :
                     {ladder.name, ladder.subject, rung.name, rung.command, metric.name,
                      metric.unit, metric.domain})
                    csv += csv_cell(text) + ",";
                for (const double v :
                     {rung.errors[m], rung.time.value, rung.time.low, rung.time.high,
                      rung.ratio.value, rung.ratio.low, rung.ratio.high})
                    csv += fmt::format("{},", v);
                csv += csv_cell(standing_text(ladder, rung)) + "," + pair + "\r\n";
            }
        }
    return csv;
}

std::vector<std::vector<std::string>> cost_rows(const LadderRecord& ladder) {
    std::vector<std::vector<std::string>> rows = {name_headings(ladder)};
    rows[0].insert(rows[0].end(),
                   {"where it stands", "time",
                    ladder.reference_is_default ? "to the default" : "to the reference"});
    for (const Metric& m : ladder.metrics) rows[0].push_back(heading(m));
    for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
        const RungRecord& rung = ladder.rungs[i];
        std::vector<std::string> row = name_cells(ladder, i);
        row.insert(row.end(), {standing_text(ladder, rung), short_time(rung.time.value),
                               ratio_text(rung.ratio)});
        for (const double e : rung.errors) row.push_back(short_number(e));
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace cost
