// Work-precision plots: error over time, both in powers of ten, a point for each rung.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cost/pages/cost_table.h"

namespace cost {

struct PlotPoint {
    std::size_t rung = 0;
    double x = 0, y = 0;           // in the plot's units, y down
    double low_x = 0, high_x = 0;  // of the time's interval
    bool on_lane = false;          // exact, or without error: no place on a scale of powers
};

struct PlotTick {
    double value = 0, at = 0;
    std::string text;
};

// Where everything stands, before anything is drawn.
struct PlotLayout {
    double width = 400, height = 330;
    double left = 66, right = 388, top = 12, bottom = 288;  // of the frame
    double lane = 0;  // y of the lane for exact rungs; 0: there is none
    std::vector<PlotTick> x_ticks, y_ticks;
    std::vector<PlotPoint> points;  // by rung; those whose error is not finite are left out
    double floor = 0;               // y; 0: none, or not within the frame
    // Time in milliseconds ↔ x, error ↔ y, as the points are placed.
    double x_of(double milliseconds) const;
    double y_of(double error) const;
    double x_low = 0, x_high = 1, y_low = 0, y_high = 1;  // decimal logarithms at the frame
};

PlotLayout layout_of(const LadderRecord& ladder);

// The rungs of the front that are not on the lane, by time: a line steps through them.
std::vector<const PlotPoint*> front_points(const LadderRecord& ladder, const PlotLayout& plot);

// What stands on the lane: rungs that are exact, rungs without error, or both.
std::string lane_text(const LadderRecord& ladder, const PlotLayout& plot);

// Of grids, for each value of the first setting its points off the lane, by the values of the
// second: a line joins them.
std::vector<std::vector<const PlotPoint*>> series_points(const LadderRecord& ladder,
                                                         const PlotLayout& plot);
// The line's colour, 0xRRGGBB, on light and dark alike; they come again after `series_colours`.
inline constexpr std::size_t series_colours = 6;
std::uint32_t series_colour(std::size_t series);

// A place for each name beside its point where it covers nothing; none left: no name, the tooltip
// and the table have it. Of a grid's series one point has the whole name, the others only the value
// of the second setting.
struct PlotName {
    std::string text;
    std::size_t rung = 0;
    double x = 0, y = 0;      // of its baseline
    const char* anchor = "";  // which end is there, as SVG says it
};
std::vector<PlotName> names_in(const LadderRecord& ladder, const PlotLayout& plot);

// An <svg> element. As a file of its own (`alone`) it brings its colours along, light and dark by
// the reader's preference; on a page the page's style sheet has them. Points can be reached with
// Tab and say what they are; on a page those that draw show a part of what they draw, and its
// error.
std::string plot_svg(const LadderRecord& ladder, bool alone);

// The rules that both forms share.
std::string plot_style();

}  // namespace cost
