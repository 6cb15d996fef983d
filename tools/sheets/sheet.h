// What a report sheet shows, and its two forms: one PNG, and a section of an HTML page.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "prep/image.h"
#include "sheets/canvas.h"

namespace report {

struct LegendItem {
    Color color;
    std::string text;
};

struct Panel {
    std::string id;                      // "flat": for file names and anchors
    std::string title;                   // "Flat"
    std::string caption;                 // one or two lines, with the figure that matters
    std::string alt;                     // what a reader who sees no picture must know
    std::optional<prep::Image> picture;  // RGBA
    std::string note;                    // why there is no picture
    std::vector<LegendItem> legend;
};

struct Figure {
    std::string name, value;
    bool attention = false;  // drawn so that it is seen
};

struct FigureGroup {
    std::string title;
    std::vector<Figure> figures;
};

struct Sheet {
    std::string title, subtitle;
    std::vector<Panel> panels;  // all pictures are squares of one size
    std::vector<FigureGroup> groups;
    std::string footer;
};

// "12,345".
std::string with_commas(std::uint64_t value);
// "1 face", "2 faces": `plural` only where it is not an added s.
std::string count_of(std::uint64_t value, const std::string& singular,
                     const std::string& plural = {});

// The whole sheet as one picture: four panels a row, the figures beside the last row's. `panel` is
// the pictures' size in pixels.
prep::Image draw_sheet(const Sheet& sheet, std::uint32_t panel);

}  // namespace report
