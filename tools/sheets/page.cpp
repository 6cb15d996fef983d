#include "sheets/page.h"

#include <fmt/format.h>

#include "sheets/stroke_font.h"

namespace report {
namespace {

constexpr const char* style_sheet = R"(
:root { color-scheme: light dark; --page: #ffffff; --card: #eef1f5; --text: #111827; --soft: #4b5563;
  --rule: #d5dae1; --attention: #b45309; }
@media (prefers-color-scheme: dark) { :root { --page: #14171c; --card: #c9ced6; --text: #e5e7eb;
  --soft: #a3abb8; --rule: #343a44; --attention: #fbbf24; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 16px/1.45 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 1480px; margin: 0 auto; padding: 32px 24px 64px; }
h1 { font-size: 1.9rem; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 1.35rem; margin: 40px 0 4px; overflow-wrap: anywhere; }
h3 { font-size: 1rem; margin: 0 0 6px; padding-bottom: 6px; border-bottom: 1px solid var(--rule); }
p { margin: 0 0 20px; color: var(--soft); }
.panels { display: grid; gap: 20px; grid-template-columns: repeat(auto-fill, minmax(270px, 1fr)); }
figure { margin: 0; }
.picture { position: relative; aspect-ratio: 1; background: var(--card); border-radius: 8px;
  overflow: hidden; display: grid; place-items: center; color: #4b5563; text-align: center; }
.picture img { width: 100%; height: 100%; display: block; }
.picture span { padding: 24px; }
figcaption { padding: 8px 2px 0; font-size: .88rem; color: var(--soft); }
figcaption strong { display: block; font-size: 1rem; color: var(--text); }
ul.legend { list-style: none; margin: 6px 0 0; padding: 0; display: flex; flex-wrap: wrap;
  gap: 2px 14px; }
ul.legend i { display: inline-block; width: 16px; height: 4px; border-radius: 2px; margin-right: 6px;
  vertical-align: middle; }
.groups { display: grid; gap: 28px 36px; margin-top: 32px;
  grid-template-columns: repeat(auto-fill, minmax(300px, 1fr)); }
dl { margin: 0; display: grid; grid-template-columns: auto 1fr; gap: 3px 16px; font-size: .92rem; }
dt { color: var(--soft); }
dd { margin: 0; text-align: right; font-variant-numeric: tabular-nums; overflow-wrap: anywhere; }
dd.attention { color: var(--attention); font-weight: 600; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; width: 100%; }
th, td { text-align: left; padding: 5px 14px 5px 0; border-bottom: 1px solid var(--rule);
  vertical-align: top; font-variant-numeric: tabular-nums; }
th { color: var(--soft); font-weight: 600; }
footer { margin-top: 40px; color: var(--soft); font-size: .85rem; }
)";

std::string hex(Color c) {
    const auto byte = [](float v) { return static_cast<int>(v * 255 + 0.5f); };
    return fmt::format("#{:02x}{:02x}{:02x}", byte(c.r), byte(c.g), byte(c.b));
}

prep::Result<std::string> panel_html(const Panel& p, const std::string& anchor) {
    std::string html = "<figure id=\"" + html_escaped(anchor) + "\"><div class=\"picture\">";
    if (p.picture) {
        const prep::Result<std::vector<std::byte>> png = prep::encode_png(*p.picture);
        if (!png) return png.error();
        html +=
            fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,",
                        p.picture->width, p.picture->height, html_escaped(p.alt));
        html += base64(*png) + "\">";
    } else {
        html += "<span>" + html_escaped(p.note) + "</span>";
    }
    html += "</div><figcaption><strong>" + html_escaped(p.title) + "</strong>" +
            html_escaped(p.caption);
    if (!p.legend.empty()) {
        html += "<ul class=\"legend\">";
        for (const LegendItem& item : p.legend)
            html += fmt::format("<li><i style=\"background:{}\"></i>{}</li>", hex(item.color),
                                html_escaped(item.text));
        html += "</ul>";
    }
    return html + "</figcaption></figure>\n";
}

std::string tables_html(const std::vector<Table>& tables) {
    std::string html;
    for (const Table& table : tables) {
        html += "<section>\n<h2>" + html_escaped(table.title) +
                "</h2>\n<div class=\"scroll\"><table>\n<thead><tr>";
        for (const std::string& cell : table.head)
            html += "<th scope=\"col\">" + html_escaped(cell) + "</th>";
        html += "</tr></thead>\n<tbody>\n";
        for (const auto& row : table.rows) {
            html += "<tr>";
            for (const std::string& cell : row) html += "<td>" + html_escaped(cell) + "</td>";
            html += "</tr>\n";
        }
        html += "</tbody></table></div>\n</section>\n";
    }
    return html;
}

}  // namespace

std::string base64(const std::vector<std::byte>& bytes) {
    static constexpr char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t left = bytes.size() - i;
        const auto at = [&](std::size_t k) {
            return k < left ? static_cast<unsigned>(bytes[i + k]) : 0u;
        };
        const unsigned word = at(0) << 16 | at(1) << 8 | at(2);
        text += digits[word >> 18 & 63];
        text += digits[word >> 12 & 63];
        text += left > 1 ? digits[word >> 6 & 63] : '=';
        text += left > 2 ? digits[word & 63] : '=';
    }
    return text;
}

std::string html_escaped(const std::string& text) {
    std::string out;
    std::string_view rest = text;
    while (!rest.empty()) {
        const std::string_view before = rest;
        const char32_t code = next_code_point(rest);
        if (code == U'&')
            out += "&amp;";
        else if (code == U'<')
            out += "&lt;";
        else if (code == U'>')
            out += "&gt;";
        else if (code == U'"')
            out += "&quot;";
        else if (code == 0xFFFD || (code < 32 && code != U'\n' && code != U'\t'))
            out += "\xEF\xBF\xBD";
        else
            out += before.substr(0, before.size() - rest.size());
    }
    return out;
}

prep::Result<std::string> html_page(const Page& page) {
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<title>" +
        html_escaped(page.title) + "</title>\n<style>" + style_sheet +
        "</style>\n</head>\n<body>\n<main>\n<h1>" + html_escaped(page.title) + "</h1>\n<p>" +
        html_escaped(page.subtitle) + "</p>\n";
    if (page.tables_first) html += tables_html(page.tables);
    for (std::size_t s = 0; s < page.sheets.size(); ++s) {
        const Sheet& sheet = page.sheets[s];
        html += "<section>\n";
        if (page.sheets.size() > 1)
            html += "<h2>" + html_escaped(sheet.title) + "</h2>\n<p>" +
                    html_escaped(sheet.subtitle) + "</p>\n";
        html += "<div class=\"panels\">\n";
        for (const Panel& panel : sheet.panels) {
            prep::Result<std::string> part =
                panel_html(panel, fmt::format("sheet{}-{}", s + 1, panel.id));
            if (!part) return part.error();
            html += *part;
        }
        html += "</div>\n<div class=\"groups\">\n";
        for (const FigureGroup& group : sheet.groups) {
            html += "<div><h3>" + html_escaped(group.title) + "</h3><dl>";
            for (const Figure& f : group.figures)
                html += "<dt>" + html_escaped(f.name) + "</dt><dd" +
                        (f.attention ? " class=\"attention\"" : "") + ">" + html_escaped(f.value) +
                        "</dd>";
            html += "</dl></div>\n";
        }
        html += "</div>\n</section>\n";
    }
    if (!page.tables_first) html += tables_html(page.tables);
    if (!page.sheets.empty() && !page.sheets[0].footer.empty())
        html += "<footer>" + html_escaped(page.sheets[0].footer) + "</footer>\n";
    return html + "</main>\n</body>\n</html>\n";
}

}  // namespace report
