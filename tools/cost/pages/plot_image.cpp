#include "cost/pages/plot_image.h"

#include <algorithm>
#include <string>

#include "sheets/canvas.h"

namespace cost {
namespace {

using report::Align;
using report::Color;
using report::rgb;

// Those of plot_style(), light.
constexpr Color ink = rgb(0x111827), soft = rgb(0x4b5563), rule = rgb(0xe2e6ec),
                card = rgb(0xffffff), good = rgb(0x1d4ed8), poor = rgb(0xb45309),
                tie = rgb(0x6b7280), sure = rgb(0x047857);

// A canvas in the layout's units.
class ScaledPlot {
  public:
    ScaledPlot(const PlotLayout& plot, int scale)
        : scale_(scale),
          canvas_(std::uint32_t(plot.width * scale), std::uint32_t(plot.height * scale), card) {}

    void line(double x0, double y0, double x1, double y1, Color color, double width = 1) {
        canvas_.line(x0 * scale_, y0 * scale_, x1 * scale_, y1 * scale_, color, width * scale_);
    }
    void text(double x, double y, const std::string& words, Color color, const char* anchor,
              double size = 12) {
        const std::string end = anchor;
        canvas_.text(x * scale_, y * scale_, words,
                     {size * scale_, color, false,
                      end == "start" ? Align::left
                      : end == "end" ? Align::right
                                     : Align::center});
    }
    void dot(double x, double y, double radius, Color color) {
        line(x, y, x, y, color, 2 * radius);
    }
    void square(double x, double y, double side, Color color) {
        canvas_.fill(
            {(x - side / 2) * scale_, (y - side / 2) * scale_, side * scale_, side * scale_},
            color);
    }
    const prep::Image& image() const { return canvas_.image(); }

  private:
    double scale_;
    report::Canvas canvas_;
};

void draw_frame(ScaledPlot& to, const LadderRecord& ladder, const PlotLayout& plot) {
    for (const PlotTick& t : plot.x_ticks) {
        to.line(t.at, plot.top, t.at, plot.bottom, rule);
        to.text(t.at, plot.bottom + 16, t.text, soft, "middle");
    }
    for (const PlotTick& t : plot.y_ticks) {
        to.line(plot.left, t.at, plot.right, t.at, rule);
        to.text(plot.left - 6, t.at + 4, t.text, soft, "end");
    }
    if (plot.lane > 0) {
        to.line(plot.left, plot.lane - 14, plot.right, plot.lane - 14, rule);
        to.text(plot.left - 6, plot.lane + 4, lane_text(ladder, plot), soft, "end");
    }
    to.line(plot.left, plot.top, plot.right, plot.top, soft);
    to.line(plot.left, plot.bottom, plot.right, plot.bottom, soft);
    to.line(plot.left, plot.top, plot.left, plot.bottom, soft);
    to.line(plot.right, plot.top, plot.right, plot.bottom, soft);
    // The typeface does not turn: what the heights are stands beside what the widths are.
    const Metric& metric = ladder.metrics[ladder.primary];
    to.text((plot.left + plot.right) / 2, plot.bottom + 34,
            "error: " + metric.name + (metric.unit.empty() ? "" : " (" + metric.unit + ")") +
                " over milliseconds",
            soft, "middle");
}

void draw_point(ScaledPlot& to, const RungRecord& rung, const PlotPoint& p) {
    const bool ring = !rung.exact && rung.verdict.standing != Standing::front;
    const Color color = rung.exact                                ? sure
                        : !ring                                   ? good
                        : rung.verdict.standing == Standing::tied ? tie
                                                                  : poor;
    to.line(p.low_x, p.y, p.high_x, p.y, color, 1.5);
    if (rung.exact) return to.square(p.x, p.y, 9, color);
    to.dot(p.x, p.y, ring ? 6 : 5, color);
    if (ring) to.dot(p.x, p.y, 4, card);
}

}  // namespace

prep::Image plot_image(const LadderRecord& ladder, int scale) {
    const PlotLayout plot = layout_of(ladder);
    ScaledPlot to(plot, scale);
    draw_frame(to, ladder, plot);
    if (plot.floor > 0)
        for (double x = plot.left; x < plot.right; x += 9)
            to.line(x, plot.floor, std::min(x + 5, plot.right), plot.floor, sure);
    const auto series = series_points(ladder, plot);
    for (std::size_t s = 0; s < series.size(); ++s)
        for (std::size_t i = 1; i < series[s].size(); ++i)
            to.line(series[s][i - 1]->x, series[s][i - 1]->y, series[s][i]->x, series[s][i]->y,
                    rgb(series_colour(s), 0.7f), 1.2);
    const std::vector<const PlotPoint*> front = front_points(ladder, plot);
    for (std::size_t i = 1; i < front.size(); ++i) {
        const PlotPoint &a = *front[i - 1], &b = *front[i];
        to.line(a.x, a.y, b.x, a.y, rgb(0x1d4ed8, 0.55f), 1.5);
        to.line(b.x, a.y, b.x, b.y, rgb(0x1d4ed8, 0.55f), 1.5);
    }
    for (const PlotName& name : names_in(ladder, plot))
        to.text(name.x, name.y, name.text, ink, name.anchor, 11);
    for (const PlotPoint& p : plot.points) draw_point(to, ladder.rungs[p.rung], p);
    return to.image();
}

}  // namespace cost
