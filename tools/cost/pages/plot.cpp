#include "cost/pages/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sheets/page.h"

namespace cost {
namespace {

using report::html_escaped;

double milliseconds(const RungRecord& rung) {
    return rung.time.value * 1e3;
}

bool on_lane(const LadderRecord& ladder, const RungRecord& rung) {
    return rung.exact || rung.errors[ladder.primary] == 0;
}

bool placed(const LadderRecord& ladder, const RungRecord& rung) {
    return rung.time.value > 0 &&
           (on_lane(ladder, rung) ||
            (rung.errors[ladder.primary] > 0 && std::isfinite(rung.errors[ladder.primary])));
}

// Powers of ten, with 2 and 5 between them where there are few.
std::vector<double> tick_values(double low, double high) {
    std::vector<double> values;
    const bool fine = high - low < 2.2;
    const int step = high - low > 9 ? 3 : high - low > 6 ? 2 : 1;
    for (int e = int(std::floor(low)); e <= int(std::ceil(high)); ++e)
        for (const double m : {1.0, 2.0, 5.0}) {
            if (m > 1 && !fine) continue;
            if (e % step != 0) continue;
            const double v = m * std::pow(10.0, e);
            if (std::log10(v) >= low - 1e-9 && std::log10(v) <= high + 1e-9) values.push_back(v);
        }
    return values;
}

// `share` of the range on both sides: room for names.
void widen(double& low, double& high, double share) {
    if (high - low < 0.6) {
        const double middle = (low + high) / 2;
        low = middle - 0.3;
        high = middle + 0.3;
    }
    const double margin = share * (high - low);
    low -= margin;
    high += margin;
}

struct Box {
    double x0, y0, x1, y1;
    bool meets(const Box& b) const { return x0 < b.x1 && b.x0 < x1 && y0 < b.y1 && b.y0 < y1; }
};

std::string point_class(const RungRecord& rung) {
    if (rung.exact) return "exact";
    return word_for(rung.verdict.standing);
}

double text_width(const std::string& text) {  // in the plot's units, about
    std::size_t characters = 0;
    for (const char c : text) characters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    return 6.4 * double(characters);
}

// Steps through them: what is the least error for so much time.
std::string front_line(const LadderRecord& ladder, const PlotLayout& plot) {
    const std::vector<const PlotPoint*> points = front_points(ladder, plot);
    if (points.size() < 2) return {};
    std::string path = fmt::format("M{:.2f} {:.2f}", points[0]->x, points[0]->y);
    for (std::size_t i = 1; i < points.size(); ++i)
        path += fmt::format(" H{:.2f} V{:.2f}", points[i]->x, points[i]->y);
    return "<path class=\"front-line\" d=\"" + path + "\"/>\n";
}

std::string series_lines(const LadderRecord& ladder, const PlotLayout& plot) {
    std::string svg;
    const auto series = series_points(ladder, plot);
    for (std::size_t i = 0; i < series.size(); ++i) {
        if (series[i].size() < 2) continue;
        svg += fmt::format("<path class=\"series\" data-series=\"{}\" stroke=\"#{:06x}\" d=\"", i,
                           series_colour(i));
        for (const PlotPoint* p : series[i])
            svg += fmt::format("{}{:.2f} {:.2f}", p == series[i][0] ? "M" : " L", p->x, p->y);
        svg += "\"/>\n";
    }
    return svg;
}

std::string labels(const LadderRecord& ladder, const PlotLayout& plot) {
    std::string svg;
    for (const PlotName& name : names_in(ladder, plot))
        svg += fmt::format(
            "<text class=\"name\" x=\"{:.1f}\" y=\"{:.1f}\" "
            "text-anchor=\"{}\">{}</text>\n",
            name.x, name.y, name.anchor, html_escaped(name.text));
    return svg;
}

// What the rung draws and how far it is off, side by side, with a line of words below each.
std::string looks(const RungRecord& rung, double x, double y) {
    std::string svg;
    for (const auto& [picture, words] :
         {std::pair(&rung.picture, std::string("a part of it")),
          std::pair(&rung.difference, fmt::format("its error, × {:g}", look_gain))}) {
        svg += fmt::format(
            "<image x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" "
            "href=\"data:image/png;base64,{}\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>",
            x, y, look_width, look_height, *picture, x, y + look_height + 14, words);
        x += look_width + 8;
    }
    return svg;
}

// `pictures`: with what the rung draws, where it draws.
std::string tooltip(const LadderRecord& ladder, const PlotLayout& plot, const PlotPoint& p,
                    bool pictures) {
    const RungRecord& rung = ladder.rungs[p.rung];
    const Metric& metric = ladder.metrics[ladder.primary];
    const std::string lines[] = {
        rung.name,
        fmt::format("{} ({} to {})", short_time(rung.time.value), short_time(rung.time.low),
                    short_time(rung.time.high)),
        fmt::format("{}: {}{}{}", metric.name, short_number(rung.errors[ladder.primary]),
                    metric.unit.empty() || metric.unit == "°" ? "" : " ", metric.unit),
        standing_text(ladder, rung)};
    double w = 0;
    for (const std::string& line : lines) w = std::max(w, text_width(line) + 18);
    pictures = pictures && !rung.picture.empty();
    if (pictures) w = std::max(w, 2.0 * look_width + 26);
    w = std::min(w, plot.width - 4);
    const double h = pictures ? 70 + look_height + 22 : 70;
    const double x = std::clamp(p.x - w / 2, 2.0, plot.width - w - 2);
    // Above the point or below it; where there is room for neither, at the top.
    const double y = p.y > h + 16 ? p.y - h - 12 : p.y + 12 + h <= plot.height ? p.y + 12 : 2.0;
    std::string svg = fmt::format(
        "<g class=\"tip\" aria-hidden=\"true\"><rect x=\"{:.1f}\" "
        "y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"5\"/>",
        x, y, w, h);
    double line_y = y + 16;
    for (const std::string& line : lines) {
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", x + 9, line_y,
                           html_escaped(line));
        line_y += 16;
    }
    if (pictures) svg += looks(rung, x + 9, line_y - 6);
    return svg + "</g>";
}

std::string mark(const PlotPoint& p, const std::string& kind) {
    if (kind == "exact")
        return fmt::format("<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"9\" height=\"9\"/>", p.x - 4.5,
                           p.y - 4.5);
    return fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"5\"/>", p.x, p.y);
}

}  // namespace

double PlotLayout::x_of(double milliseconds_) const {
    return left + (std::log10(milliseconds_) - x_low) / (x_high - x_low) * (right - left);
}
double PlotLayout::y_of(double error) const {
    const double low = lane > 0 ? lane - 18 : bottom;
    return low - (std::log10(error) - y_low) / (y_high - y_low) * (low - top);
}

PlotLayout layout_of(const LadderRecord& ladder) {
    PlotLayout plot;
    bool first_x = true, first_y = true, lane = false;
    const auto take = [](double v, double& low, double& high, bool& first) {
        low = first ? v : std::min(low, v);
        high = first ? v : std::max(high, v);
        first = false;
    };
    for (const RungRecord& rung : ladder.rungs) {
        if (!placed(ladder, rung)) continue;
        take(std::log10(milliseconds(rung)), plot.x_low, plot.x_high, first_x);
        if (on_lane(ladder, rung))
            lane = true;
        else
            take(std::log10(rung.errors[ladder.primary]), plot.y_low, plot.y_high, first_y);
    }
    // The floor is shown where it is near enough to mean something.
    bool floor = ladder.floor && *ladder.floor > 0;
    if (floor && !first_y && std::log10(*ladder.floor) > plot.y_low - 4 &&
        std::log10(*ladder.floor) < plot.y_high + 9)
        take(std::log10(*ladder.floor), plot.y_low, plot.y_high, first_y);
    else
        floor = false;
    widen(plot.x_low, plot.x_high, 0.2);
    widen(plot.y_low, plot.y_high, 0.1);
    if (lane) plot.lane = plot.bottom - 12;
    for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
        const RungRecord& rung = ladder.rungs[i];
        if (!placed(ladder, rung)) continue;
        PlotPoint p;
        p.rung = i;
        p.on_lane = on_lane(ladder, rung);
        p.x = plot.x_of(milliseconds(rung));
        p.y = p.on_lane ? plot.lane : plot.y_of(rung.errors[ladder.primary]);
        const auto within = [&](double x) { return std::clamp(x, plot.left, plot.right); };
        p.low_x = rung.time.low > 0 ? within(plot.x_of(rung.time.low * 1e3)) : plot.left;
        p.high_x =
            std::isfinite(rung.time.high) ? within(plot.x_of(rung.time.high * 1e3)) : plot.right;
        plot.points.push_back(p);
    }
    if (floor) plot.floor = plot.y_of(*ladder.floor);
    for (const double v : tick_values(plot.x_low, plot.x_high))
        plot.x_ticks.push_back({v, plot.x_of(v), short_number(v)});
    if (!first_y)
        for (const double v : tick_values(plot.y_low, plot.y_high))
            plot.y_ticks.push_back({v, plot.y_of(v), short_number(v)});
    return plot;
}

std::string lane_text(const LadderRecord& ladder, const PlotLayout& plot) {
    bool exact = false, without = false;
    for (const PlotPoint& p : plot.points)
        if (p.on_lane) (ladder.rungs[p.rung].exact ? exact : without) = true;
    return exact && without ? "exact, 0" : exact ? "exact" : "0";
}

std::vector<const PlotPoint*> front_points(const LadderRecord& ladder, const PlotLayout& plot) {
    std::vector<const PlotPoint*> points;
    for (const PlotPoint& p : plot.points)
        if (!p.on_lane && ladder.rungs[p.rung].verdict.standing == Standing::front)
            points.push_back(&p);
    std::sort(points.begin(), points.end(),
              [](const PlotPoint* a, const PlotPoint* b) { return a->x < b->x; });
    return points;
}

std::vector<std::vector<const PlotPoint*>> series_points(const LadderRecord& ladder,
                                                         const PlotLayout& plot) {
    std::vector<std::vector<const PlotPoint*>> series;
    if (ladder.grid.empty()) return series;
    series.resize(ladder.grid[0].values.size());
    for (const PlotPoint& p : plot.points)
        if (!p.on_lane) series[p.rung / ladder.grid[1].values.size()].push_back(&p);
    return series;
}

std::uint32_t series_colour(std::size_t series) {
    static constexpr std::uint32_t colours[series_colours] = {0x8b5cf6, 0x0891b2, 0xdb2777,
                                                              0x65a30d, 0xa16207, 0x64748b};
    return colours[series % series_colours];
}

std::vector<PlotName> names_in(const LadderRecord& ladder, const PlotLayout& plot) {
    std::vector<Box> taken;
    for (const PlotPoint& p : plot.points) {
        taken.push_back({p.x - 6, p.y - 6, p.x + 6, p.y + 6});
        taken.push_back({p.low_x, p.y - 2, p.high_x, p.y + 2});
    }
    if (plot.floor > 0) taken.push_back({plot.left, plot.floor - 1, plot.right, plot.floor + 1});
    if (plot.lane > 0) taken.push_back({plot.left, plot.lane - 8, plot.left + 40, plot.lane + 8});
    const std::vector<const PlotPoint*> front = front_points(ladder, plot);
    for (std::size_t i = 1; i < front.size(); ++i) {
        const PlotPoint &a = *front[i - 1], &b = *front[i];
        taken.push_back({a.x, a.y - 1, b.x, a.y + 1});
        taken.push_back({b.x - 1, std::min(a.y, b.y), b.x + 1, std::max(a.y, b.y)});
    }
    std::vector<PlotName> names;
    const auto place = [&](const PlotPoint& p, const std::string& name) {
        const double w = text_width(name), h = 12;
        const struct {
            double x, y;
            const char* anchor;
        } tries[] = {{p.x + 9, p.y + 4, "start"}, {p.x - 9, p.y + 4, "end"},
                     {p.x, p.y - 10, "middle"},   {p.x, p.y + 19, "middle"},
                     {p.x + 8, p.y - 7, "start"}, {p.x + 8, p.y + 15, "start"},
                     {p.x - 8, p.y - 7, "end"},   {p.x - 8, p.y + 15, "end"}};
        for (const auto& t : tries) {
            const std::string anchor = t.anchor;
            const double x0 = anchor == "start" ? t.x : anchor == "end" ? t.x - w : t.x - w / 2;
            const Box box{x0, t.y - h + 2, x0 + w, t.y + 3};
            if (box.x0 < plot.left + 2 || box.x1 > plot.right - 3 || box.y0 < plot.top ||
                box.y1 > std::max(plot.bottom, plot.lane + 9))
                continue;
            if (std::any_of(taken.begin(), taken.end(), [&](const Box& b) { return b.meets(box); }))
                continue;
            taken.push_back(box);
            names.push_back({name, p.rung, t.x, t.y, t.anchor});
            return true;
        }
        return false;
    };
    if (ladder.grid.empty()) {
        for (const PlotPoint& p : plot.points) place(p, ladder.rungs[p.rung].name);
        return names;
    }
    // Whole names first, from each series' last point on: there lines are farther apart.
    std::vector<bool> named(ladder.rungs.size(), false);
    const std::size_t columns = ladder.grid[1].values.size();
    for (std::size_t i = 0; i < ladder.grid[0].values.size(); ++i)
        for (auto p = plot.points.rbegin(); p != plot.points.rend(); ++p)
            if (p->rung / columns == i && place(*p, ladder.rungs[p->rung].name)) {
                named[p->rung] = true;
                break;
            }
    for (const PlotPoint& p : plot.points)
        if (!named[p.rung]) place(p, ladder.grid[1].values[p.rung % columns]);
    return names;
}

std::string plot_style() {
    return R"(.plot { --ink: #111827; --soft: #4b5563; --rule: #e2e6ec; --card: #ffffff; --good: #1d4ed8;
  --poor: #b45309; --tie: #6b7280; --sure: #047857; font: 12px system-ui, -apple-system, "Segoe UI", Roboto,
  "DejaVu Sans", sans-serif; }
@media (prefers-color-scheme: dark) { .plot { --ink: #e5e7eb; --soft: #a3abb8; --rule: #2c323b;
  --card: #1b1f26; --good: #93c5fd; --poor: #fbbf24; --tie: #9ca3af; --sure: #6ee7b7; } }
.plot text { fill: var(--soft); } .plot .name { fill: var(--ink); font-size: 11px; }
.plot .rule { stroke: var(--rule); } .plot .frame { fill: none; stroke: var(--soft); }
.plot .front-line { fill: none; stroke: var(--good); stroke-width: 1.5; opacity: .55; }
.plot .series { fill: none; stroke-width: 1.2; opacity: .7; }
.plot .floor { stroke: var(--sure); stroke-dasharray: 5 4; }
.plot .interval { stroke-width: 1.5; stroke: currentColor; }
.plot .mark { color: var(--good); } .plot .mark circle, .plot .mark rect { fill: currentColor; }
.plot .mark.dominated { color: var(--poor); } .plot .mark.tied { color: var(--tie); }
.plot .mark.dominated circle, .plot .mark.tied circle { fill: var(--card); stroke: currentColor; stroke-width: 2; }
.plot .mark.exact { color: var(--sure); }
.plot .p { outline: none; cursor: default; } .plot .p > circle, .plot .p > rect { fill: none; pointer-events: all; }
.plot .p:focus > circle, .plot .p:focus > rect, .plot .p:hover > circle, .plot .p:hover > rect {
  stroke: var(--ink); stroke-width: 2.5; }
.plot .tip { visibility: hidden; pointer-events: none; }
.plot .tip rect { fill: var(--card); stroke: var(--soft); } .plot .tip text { fill: var(--ink); }
.plot .p:focus .tip, .plot .p:hover .tip { visibility: visible; }
)";
}

std::string plot_svg(const LadderRecord& ladder, bool alone) {
    const PlotLayout plot = layout_of(ladder);
    const Metric& metric = ladder.metrics[ladder.primary];
    std::string svg = fmt::format(
        "<svg class=\"plot\" viewBox=\"0 0 {:g} {:g}\"{} role=\"group\" aria-label=\"{}\">\n",
        plot.width, plot.height,
        alone ? fmt::format(" xmlns=\"http://www.w3.org/2000/svg\" width=\"{:g}\" height=\"{:g}\"",
                            plot.width, plot.height)
              : std::string(),
        html_escaped(ladder.title + ": error against time"));
    if (alone)
        svg += "<style>" + plot_style() + "</style>\n<rect width=\"100%\" height=\"100%\" " +
               "style=\"fill: var(--card)\"/>\n";
    for (const PlotTick& t : plot.x_ticks)
        svg += fmt::format(
            "<line class=\"rule\" x1=\"{0:.2f}\" x2=\"{0:.2f}\" y1=\"{1:g}\" "
            "y2=\"{2:g}\"/><text class=\"x-tick\" x=\"{0:.2f}\" y=\"{3:g}\" "
            "text-anchor=\"middle\">{4}</text>\n",
            t.at, plot.top, plot.bottom, plot.bottom + 16, t.text);
    for (const PlotTick& t : plot.y_ticks)
        svg += fmt::format(
            "<line class=\"rule\" x1=\"{0:g}\" x2=\"{1:g}\" y1=\"{2:.2f}\" "
            "y2=\"{2:.2f}\"/><text class=\"y-tick\" x=\"{3:g}\" y=\"{4:.2f}\" "
            "text-anchor=\"end\">{5}</text>\n",
            plot.left, plot.right, t.at, plot.left - 6, t.at + 4, t.text);
    if (plot.lane > 0)
        svg += fmt::format(
            "<line class=\"rule\" x1=\"{0:g}\" x2=\"{1:g}\" y1=\"{2:g}\" "
            "y2=\"{2:g}\"/><text x=\"{3:g}\" y=\"{4:g}\" "
            "text-anchor=\"end\">{5}</text>\n",
            plot.left, plot.right, plot.lane - 14, plot.left - 6, plot.lane + 4,
            lane_text(ladder, plot));
    svg += fmt::format(
        "<rect class=\"frame\" x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\"/>\n", plot.left,
        plot.top, plot.right - plot.left, plot.bottom - plot.top);
    svg += fmt::format("<text x=\"{:g}\" y=\"{:g}\" text-anchor=\"middle\">milliseconds</text>\n",
                       (plot.left + plot.right) / 2, plot.bottom + 34);
    std::string axis = "error: " + metric.name;
    if (!metric.unit.empty()) axis += " (" + metric.unit + ")";
    svg += fmt::format(
        "<text transform=\"translate(11 {:g}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>\n",
        (plot.top + plot.bottom) / 2, html_escaped(axis));
    if (plot.floor > 0)
        svg += fmt::format(
            "<line class=\"floor\" x1=\"{0:g}\" x2=\"{1:g}\" y1=\"{2:.2f}\" "
            "y2=\"{2:.2f}\"><title>{3}</title></line>\n",
            plot.left, plot.right, plot.floor, html_escaped(ladder.floor_text));
    svg += series_lines(ladder, plot);
    svg += front_line(ladder, plot);
    svg += labels(ladder, plot);
    for (const PlotPoint& p : plot.points) {
        const std::string kind = point_class(ladder.rungs[p.rung]);
        svg += fmt::format(
            "<g class=\"mark {}\"><line class=\"interval\" x1=\"{:.2f}\" x2=\"{:.2f}\" "
            "y1=\"{:.2f}\" y2=\"{:.2f}\"/>{}</g>\n",
            kind, p.low_x, p.high_x, p.y, p.y, mark(p, kind));
    }
    // What is pointed at, and its tooltip, after all marks: none lies above a tooltip.
    for (const PlotPoint& p : plot.points) {
        const RungRecord& rung = ladder.rungs[p.rung];
        const std::string kind = point_class(rung);
        svg += fmt::format(
            "<g class=\"p {}\" tabindex=\"0\" role=\"img\" data-rung=\"{}\" aria-label=\"{}, {}, "
            "error {}, {}\">{}{}</g>\n",
            kind, p.rung, html_escaped(rung.name), short_time(rung.time.value),
            short_number(rung.errors[ladder.primary]), html_escaped(standing_text(ladder, rung)),
            mark(p, kind), tooltip(ladder, plot, p, !alone));
    }
    return svg + "</svg>\n";
}

}  // namespace cost
