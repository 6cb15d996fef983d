// What `meshprep cost` shows: plots, page, values and JSON say the same numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <regex>

#include "cost/pages/page.h"
#include "cost/pages/plot.h"
#include "cost/pages/plot_image.h"
#include "meshprep/output/cost_json.h"
#include "prep/image.h"
#include "sheets/page.h"

namespace {

using cost::CostTable;
using cost::LadderRecord;
using cost::RungRecord;

RungRecord rung(const std::string& name, double error, double seconds, bool exact = false) {
    RungRecord r;
    r.name = name;
    r.command = "prepare --as \"" + name + "\"";
    r.exact = exact;
    r.errors = {error, error / 2};
    // Eight rounds that scatter by 1 %, each rung's in its own way.
    for (int i = 0; i < 8; ++i)
        r.seconds.push_back(seconds * (1 + 0.01 * std::sin(7.0 * i + double(name.size()))));
    return r;
}

CostTable table_of_two() {
    CostTable table;
    table.version = "1.2.3";
    table.processor = "A <processor> & more";
    LadderRecord a;
    a.name = "first";
    a.title = "First & foremost";
    a.setting = "s";
    a.subject = "a mesh, \"quoted\"";
    a.oracle = "o";
    a.timed = {"one", "two"};
    a.metrics = {{"largest", "°", "somewhere"}, {"mean", "°", ""}};
    a.floor = 1e-6;
    a.floor_text = "floats";
    a.rungs = {rung("fast", 1e-3, 0.001),
               rung("worse", 5e-3, 0.004),
               rung("fine", 1e-5, 0.01),
               rung("truth", 0, 1.5, true),
               rung("as fast", 2e-3, 0.001),
               rung("nothing", std::numeric_limits<double>::infinity(), 0.002)};
    a.control = a.rungs[0].seconds;
    a.narrow = true;
    a.wall = a.cpu = 1;
    LadderRecord b = a;
    b.name = "second";
    b.floor.reset();
    b.primary = 1;
    b.rungs = {rung("only", 0.25, 3e-5)};
    b.control = b.rungs[0].seconds;
    b.cpu = 0.5;
    b.narrow = false;
    table.ladders = {a, b};
    cost::derive(table);
    return table;
}

struct Tick {
    double at, value;
};
std::vector<Tick> ticks(const std::string& svg, const std::string& kind, const std::string& axis) {
    std::vector<Tick> found;
    const std::regex pattern("class=\"" + kind + "\"[^>]* " + axis +
                             "=\"([0-9.]+)\"[^>]*>([^<]*)<");
    for (std::sregex_iterator i(svg.begin(), svg.end(), pattern), end; i != end; ++i)
        found.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
    return found;
}

// What stands at a coordinate of an axis in powers, by two of its ticks.
double read_off(const std::vector<Tick>& t, double at) {
    const double slope =
        (std::log10(t.back().value) - std::log10(t.front().value)) / (t.back().at - t.front().at);
    return std::pow(10.0, std::log10(t.front().value) + (at - t.front().at) * slope);
}
// The coordinate of a value there.
double placed(const std::vector<Tick>& t, double value) {
    const double slope =
        (t.back().at - t.front().at) / (std::log10(t.back().value) - std::log10(t.front().value));
    return t.front().at + (std::log10(value) - std::log10(t.front().value)) * slope;
}

// Points are read off the drawing as a person would: by the ticks' texts.
TEST(CostPlot, PointsStandWhereTheirNumbersSayToHalfAPixel) {
    const CostTable table = table_of_two();
    const LadderRecord& ladder = table.ladders[0];
    for (const bool alone : {false, true}) {
        const std::string svg = cost::plot_svg(ladder, alone);
        const auto x = ticks(svg, "x-tick", "x"), y = ticks(svg, "y-tick", "y");
        ASSERT_GE(x.size(), 2u);
        ASSERT_GE(y.size(), 2u);
        EXPECT_EQ(y.front().at > y.back().at, y.front().value < y.back().value);  // less is lower
        EXPECT_EQ(x.front().at < x.back().at, x.front().value < x.back().value);
        const std::regex point(
            "data-rung=\"([0-9]+)\".*?<(circle|rect)[^>]*?(?:cx|x)=\"([0-9.]+)\" "
            "(?:cy|y)=\"([0-9.]+)\"");
        std::size_t points = 0;
        for (std::sregex_iterator i(svg.begin(), svg.end(), point), end; i != end; ++i, ++points) {
            const RungRecord& r = ladder.rungs[std::stoul((*i)[1])];
            const bool square = (*i)[2] == "rect";
            const double px = std::stod((*i)[3]) + (square ? 4.5 : 0);
            EXPECT_NEAR(px, placed(x, r.time.value * 1e3), 0.5) << r.name;
            EXPECT_NEAR(read_off(x, px) / (r.time.value * 1e3), 1, 0.02) << r.name;
            EXPECT_EQ(square, r.exact) << r.name;
            // Ticks' texts stand 4 below their lines.
            if (!square) {
                EXPECT_NEAR(std::stod((*i)[4]) + 4, placed(y, r.errors[0]), 0.5) << r.name;
            }
        }
        EXPECT_EQ(points, 5u);  // an infinite error has no place
        EXPECT_NE(svg.find("class=\"floor\""), std::string::npos);
        EXPECT_EQ(svg.find("xmlns") != std::string::npos, alone);
    }
}

TEST(CostPlot, MarksSayWhereRungsStand) {
    const CostTable table = table_of_two();
    const LadderRecord& ladder = table.ladders[0];
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[0]), "front");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[1]), "dominated by fast");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[2]), "front");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[3]), "exact");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[4]), "tied with fast");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[5]), "dominated by fast");
    const std::string svg = cost::plot_svg(ladder, false);
    const auto kind_of = [&](const std::string& number) {
        std::smatch found;
        const std::regex kind("class=\"p ([a-z]+)\" tabindex=\"0\" role=\"img\" data-rung=\"" +
                              number + "\"");
        return std::regex_search(svg, found, kind) ? found[1].str() : "";
    };
    EXPECT_EQ(kind_of("0"), "front");
    EXPECT_EQ(kind_of("1"), "dominated");
    EXPECT_EQ(kind_of("3"), "exact");
    EXPECT_EQ(kind_of("4"), "tied");
}

// What is meant as the truth is no choice: as fast and without error, it leaves the others where
// they are.
TEST(CostPlot, ExactRungsAreOnNoFront) {
    CostTable table = table_of_two();
    table.ladders.resize(1);
    LadderRecord& ladder = table.ladders[0];
    ladder.rungs[3] = rung("truth", 0, 0.0001, true);
    cost::derive(table);
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[3]), "exact");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[0]), "front");
    EXPECT_EQ(cost::standing_text(ladder, ladder.rungs[1]), "dominated by fast");
}

// Rungs without error that are settings like others keep their standing, on the lane.
TEST(CostPlot, NoErrorIsNotExact) {
    CostTable table = table_of_two();
    table.ladders.resize(1);
    LadderRecord& ladder = table.ladders[0];
    ladder.rungs[2].errors[0] = 0;
    cost::derive(table);
    std::string svg = cost::plot_svg(ladder, false);
    EXPECT_NE(svg.find("class=\"p front\" tabindex=\"0\" role=\"img\" data-rung=\"2\""),
              std::string::npos);
    EXPECT_NE(svg.find(">exact, 0<"), std::string::npos);
    ladder.rungs[3].exact = false;
    cost::derive(table);
    svg = cost::plot_svg(ladder, false);
    EXPECT_EQ(svg.find("exact"), std::string::npos);
    EXPECT_NE(svg.find(">0</text>"), std::string::npos);
}

// Found in the pixels as a person would: the colours of marks stand where the layout says.
TEST(CostPlot, PicturesHaveTheirPointsWhereTheDrawingHasThem) {
    const CostTable table = table_of_two();
    for (const LadderRecord& ladder : table.ladders) {
        const cost::PlotLayout plot = cost::layout_of(ladder);
        const prep::Image image = cost::plot_image(ladder, 3);
        EXPECT_EQ(image.width, std::uint32_t(3 * plot.width));
        EXPECT_EQ(image.height, std::uint32_t(3 * plot.height));
        const auto is = [&](double x, double y, std::uint32_t color) {
            const float* const p = image.at(std::uint32_t(3 * x), std::uint32_t(3 * y));
            for (int k = 0; k < 3; ++k)
                if (std::abs(p[k] * 255 - float((color >> (16 - 8 * k)) & 255)) > 2) return false;
            return true;
        };
        for (const cost::PlotPoint& p : plot.points) {
            const RungRecord& r = ladder.rungs[p.rung];
            const bool front = r.verdict.standing == cost::Standing::front;
            EXPECT_TRUE(is(p.x, p.y, r.exact ? 0x047857 : front ? 0x1d4ed8 : 0xffffff)) << r.name;
            if (!r.exact && !front) {
                EXPECT_TRUE(is(p.x + 5, p.y - 0.2,
                               r.verdict.standing == cost::Standing::tied ? 0x6b7280 : 0xb45309))
                    << r.name;
            }
            EXPECT_FALSE(is(p.x, p.y + 8, r.exact ? 0x047857 : 0x1d4ed8)) << r.name;
        }
        if (plot.floor > 0) {
            EXPECT_TRUE(is(plot.left + 2, plot.floor, 0x047857));
        }
        EXPECT_EQ(image.pixels, cost::plot_image(ladder, 3).pixels);
    }
}

// 2 × 3 rungs: small takes less and has more error, and so does coarse.
CostTable table_of_a_grid() {
    CostTable table = table_of_two();
    table.ladders.resize(1);
    LadderRecord& grid = table.ladders[0];
    grid.name = "a-by-b";
    grid.grid = {{"size, of it", {"small", "large"}}, {"fineness", {"coarse", "fine", "<finest>"}}};
    grid.rungs.clear();
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 3; ++j)
            grid.rungs.push_back(rung(
                grid.grid[0].values[std::size_t(i)] + ", " + grid.grid[1].values[std::size_t(j)],
                (i == 0 ? 1e-2 : 3e-4) / std::pow(8, j), 0.001 * (1 + 5 * i) * std::pow(3, j)));
    grid.reference = 4;
    grid.control = grid.rungs[4].seconds;
    cost::derive(table);
    return table;
}

// Both settings have a column each, in every form, and lines join the values of the second.
TEST(CostGrid, BothSettingsStandInEveryForm) {
    const CostTable table = table_of_a_grid();
    const LadderRecord& grid = table.ladders[0];
    const auto rows = cost::cost_rows(grid);
    EXPECT_EQ(rows[0][0], "size, of it");
    EXPECT_EQ(rows[0][1], "fineness");
    EXPECT_EQ(rows[1][0], "small");
    EXPECT_EQ(rows[1][1], "coarse");
    EXPECT_EQ(rows[5][0], "large");
    EXPECT_EQ(rows[5][1], "fine (default)");
    const std::string csv = cost::cost_csv(table), page = cost::cost_page(table);
    EXPECT_NE(csv.find(",\"size, of it\",large,fineness,<finest>\r\n"), std::string::npos);
    EXPECT_NE(csv.find("a-by-b,\"a mesh, \"\"quoted\"\"\",\"large, fine\""), std::string::npos);
    EXPECT_NE(cost::cost_csv(table_of_two()).find(",front,,,,\r\n"), std::string::npos);
    EXPECT_NE(page.find("<th>size, of it</th><th>fineness</th>"), std::string::npos);
    EXPECT_NE(page.find("<tr><td>large</td><td>fine (default)</td>"), std::string::npos);
    EXPECT_NE(page.find("<td>&lt;finest&gt;</td>"), std::string::npos);
    EXPECT_NE(page.find("for each of the other, size, of it"), std::string::npos);
    // Each line goes through its points, in the order of the second setting.
    for (const bool alone : {false, true}) {
        const std::string svg = cost::plot_svg(grid, alone);
        const std::regex line("class=\"series\" data-series=\"([0-9])\"[^>]* d=\"M([^\"]*)\"");
        const cost::PlotLayout plot = cost::layout_of(grid);
        std::size_t lines = 0;
        for (std::sregex_iterator i(svg.begin(), svg.end(), line), end; i != end; ++i, ++lines) {
            std::string expected;
            for (std::size_t j = 0; j < 3; ++j) {
                const cost::PlotPoint& p = plot.points[3 * std::stoul((*i)[1]) + j];
                char text[64];
                std::snprintf(text, sizeof text, "%s%.2f %.2f", j > 0 ? " L" : "", p.x, p.y);
                expected += text;
            }
            EXPECT_EQ((*i)[2], expected);
        }
        EXPECT_EQ(lines, 2u);
        EXPECT_NE(svg.find(">large, &lt;finest&gt;</text>"), std::string::npos);
        EXPECT_NE(svg.find(">coarse</text>"), std::string::npos);
        EXPECT_EQ(cost::plot_svg(table_of_two().ladders[0], alone).find("\"series\""),
                  std::string::npos);
    }
    // In pixels: half way between two points of a series its colour is there.
    const cost::PlotLayout plot = cost::layout_of(grid);
    const prep::Image image = cost::plot_image(grid, 4);
    const auto a = plot.points[0], b = plot.points[1];
    const float* const p = image.at(std::uint32_t(2 * (a.x + b.x)), std::uint32_t(2 * (a.y + b.y)));
    const std::uint32_t colour = cost::series_colour(0);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(p[k], 0.3f + 0.7f * float((colour >> (16 - 8 * k)) & 255) / 255, 0.03f);
}

TEST(CostGrid, ComesBackFromJsonAndIsCheckedThere) {
    const CostTable table = table_of_a_grid();
    const meshprep::Json whole = meshprep::to_json(table);
    const auto again = meshprep::cost_table_from(meshprep::json_text(whole));
    ASSERT_TRUE(again) << to_string(again.error());
    EXPECT_EQ(cost::cost_page(*again), cost::cost_page(table));
    EXPECT_EQ(cost::cost_csv(*again), cost::cost_csv(table));
    EXPECT_EQ(meshprep::json_text(meshprep::to_json(*again)), meshprep::json_text(whole));
    EXPECT_FALSE(meshprep::to_json(table_of_two())["ladders"][0].contains("grid"));
    std::vector<meshprep::Json> wrong(5, whole);
    wrong[0]["ladders"][0]["grid"].erase(0);
    wrong[1]["ladders"][0]["grid"][1]["values"].erase(0);
    wrong[2]["ladders"][0]["grid"][0]["values"] = meshprep::Json::array();
    wrong[3]["ladders"][0]["grid"][0]["values"][1] = 7;
    wrong[4]["ladders"][0]["rungs"].erase(5);
    for (const meshprep::Json& json : wrong) {
        const auto read = meshprep::cost_table_from(meshprep::json_text(json));
        ASSERT_FALSE(read);
        EXPECT_NE(to_string(read.error()).find("/ladders/0/grid"), std::string::npos)
            << to_string(read.error());
    }
}

// What is dominated is named, with the reason that its ladder gives, on the page, in the terminal's
// words and through JSON; a front and its ties are not.
TEST(CostPage, SaysWhereMoreTimeBuysNoLessErrorAndWhy) {
    CostTable table = table_of_two();
    table.ladders[0].rungs[1].because = "it is <wide>";
    const std::vector<std::string> sentences = cost::rises(table.ladders[0]);
    ASSERT_EQ(sentences.size(), 2u);
    EXPECT_EQ(sentences[0], "worse, dominated by fast: it is <wide>");
    EXPECT_EQ(
        sentences[1],
        "nothing, dominated by fast: no reason is known beforehand; so it was on this machine");
    const std::string page = cost::cost_page(table);
    EXPECT_NE(page.find("<li>worse, dominated by fast: it is &lt;wide&gt;.</li>"),
              std::string::npos);
    const auto again = meshprep::cost_table_from(meshprep::json_text(meshprep::to_json(table)));
    ASSERT_TRUE(again);
    EXPECT_EQ(cost::cost_page(*again), page);
    EXPECT_TRUE(cost::rises(table.ladders[1]).empty());
    table.ladders = {table.ladders[1]};
    EXPECT_EQ(cost::cost_page(table).find("Where more time buys"), std::string::npos);
}

TEST(CostPage, SaysWhichLineIsDrawn) {
    CostTable table = table_of_two();
    table.ladders.resize(1);
    EXPECT_NE(cost::cost_page(table).find("Dashed line at 1e-06"), std::string::npos);
    table.ladders[0].floor = 1e-30;
    EXPECT_EQ(cost::cost_page(table).find("Dashed line"), std::string::npos);
    EXPECT_NE(cost::cost_page(table).find("Floor, far from what is plotted: 1e-30"),
              std::string::npos);
}

TEST(CostPage, OnlyADefaultIsCalledOne) {
    CostTable table = table_of_two();
    EXPECT_EQ(cost::marked_name(table.ladders[0], 0), "fast (default)");
    EXPECT_EQ(cost::marked_name(table.ladders[0], 1), "worse");
    for (LadderRecord& ladder : table.ladders) ladder.reference_is_default = false;
    EXPECT_EQ(cost::marked_name(table.ladders[0], 0), "fast (reference)");
    EXPECT_EQ(cost::cost_rows(table.ladders[0])[0][3], "to the reference");
    std::string page = cost::cost_page(table);
    page.erase(page.find("cursor: default"), 15);
    EXPECT_EQ(page.find("default"), std::string::npos);
}

TEST(CostPage, SaysThatOtherWorkTookProcessors) {
    EXPECT_EQ(cost::share_taken(1, 2, 4), 0);  // there was room
    EXPECT_DOUBLE_EQ(cost::share_taken(3, 2, 4), 0.5);
    EXPECT_DOUBLE_EQ(cost::share_taken(0.5, 2, 2), 0.25);
    EXPECT_EQ(cost::share_taken(9, 2, 2), 1);
    CostTable table = table_of_two();
    table.threads = 2;
    table.ladders[0].taken = 0.25;
    cost::derive(table);
    EXPECT_NE(cost::cost_page(table).find("other work had 25 % of these threads"),
              std::string::npos);
}

TEST(CostPage, SaysThatRoundsAreTooFew) {
    CostTable table = table_of_two();
    table.ladders.resize(1);
    LadderRecord& ladder = table.ladders[0];
    for (RungRecord& r : ladder.rungs) r.seconds.resize(7);
    ladder.control.resize(7);
    cost::derive(table);
    EXPECT_NE(cost::cost_page(table).find("7 rounds are too few"), std::string::npos);
    for (const RungRecord& r : ladder.rungs)
        EXPECT_EQ(cost::standing_text(ladder, r).find("dominated"), std::string::npos) << r.name;
}

TEST(CostPlot, OneRungAloneHasAPlot) {
    const CostTable table = table_of_two();
    const std::string svg = cost::plot_svg(table.ladders[1], true);
    EXPECT_NE(svg.find("data-rung=\"0\""), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(CostPage, HoldsEverythingAndAsksForNothing) {
    const CostTable table = table_of_two();
    const std::string page = cost::cost_page(table);
    for (const char* none : {"<script", "http:", "https:", "url(", "@import", "src="})
        EXPECT_EQ(page.find(none), std::string::npos) << none;
    EXPECT_NE(page.find("A &lt;processor&gt; &amp; more"), std::string::npos);
    EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
    EXPECT_NE(page.find("width=device-width"), std::string::npos);
    for (const LadderRecord& ladder : table.ladders)
        for (const RungRecord& r : ladder.rungs) {
            EXPECT_NE(page.find(">" + cost::short_time(r.time.value) + "<"), std::string::npos);
            for (const double e : r.errors)
                EXPECT_NE(page.find(">" + cost::short_number(e) + "<"), std::string::npos);
        }
    EXPECT_NE(page.find("the machine was busy: 50 %"), std::string::npos);
    EXPECT_NE(page.find("before every ratio was known"), std::string::npos);
}

std::string small_png(float grey) {
    prep::Image image;
    image.width = 2;
    image.height = 1;
    image.channels = 1;
    image.pixels = {grey, 1 - grey};
    return report::base64(*prep::encode_png(image));
}

// Marks that come after a tooltip would be drawn over it; what is pointed at there is not painted.
TEST(CostPage, NoMarkLiesAboveATooltip) {
    for (const LadderRecord& ladder : table_of_two().ladders) {
        const std::string svg = cost::plot_svg(ladder, false);
        ASSERT_NE(svg.find("class=\"mark "), std::string::npos);
        EXPECT_LT(svg.rfind("class=\"mark "), svg.find("class=\"tip\""));
    }
    const std::string style = cost::plot_style();
    EXPECT_NE(style.find(".p > circle, .plot .p > rect { fill: none;"), std::string::npos);
    EXPECT_EQ(style.find(".p.dominated"), std::string::npos);
}

// Rungs that draw show what, and how far it is off, where they are pointed at, reached by Tab or
// tapped: within their tooltip, on the page alone, and within the plot.
TEST(CostPage, LooksStandInTheTooltipsOfTheirRungs) {
    CostTable table = table_of_two();
    table.ladders[0].rungs[1].picture = small_png(0.25f);
    table.ladders[0].rungs[1].difference = small_png(0.75f);
    const std::string plain = cost::cost_page(table_of_two()), page = cost::cost_page(table);
    EXPECT_EQ(plain.find("<image"), std::string::npos);
    const std::string alone = cost::plot_svg(table.ladders[0], true);
    EXPECT_EQ(alone, cost::plot_svg(table_of_two().ladders[0], true));
    const std::string svg = cost::plot_svg(table.ladders[0], false);
    const std::size_t point = svg.find("data-rung=\"1\""), next = svg.find("data-rung=\"2\"");
    const std::size_t first = svg.find("<image"), second = svg.find("<image", first + 1);
    ASSERT_NE(second, std::string::npos);
    EXPECT_EQ(svg.find("<image", second + 1), std::string::npos);
    EXPECT_GT(first, svg.find("class=\"tip\"", point));
    EXPECT_LT(second, next);
    EXPECT_EQ(svg.substr(first, second - first).find(table.ladders[0].rungs[1].difference),
              std::string::npos);
    EXPECT_NE(svg.find(table.ladders[0].rungs[1].picture, first), std::string::npos);
    EXPECT_NE(svg.find(table.ladders[0].rungs[1].difference, second), std::string::npos);
    const std::regex box("<image x=\"([0-9.]+)\" y=\"([0-9.]+)\" width=\"96\" height=\"72\"");
    const cost::PlotLayout plot = cost::layout_of(table.ladders[0]);
    for (std::sregex_iterator i(svg.begin(), svg.end(), box), end; i != end; ++i) {
        EXPECT_GE(std::stod((*i)[1]), 0);
        EXPECT_LE(std::stod((*i)[1]) + 96, plot.width);
        EXPECT_GE(std::stod((*i)[2]), 0);
        EXPECT_LE(std::stod((*i)[2]) + 72, plot.height);
    }
    // Through JSON, to the byte; what is no PNG file comes on no page.
    const meshprep::Json json = meshprep::to_json(table);
    const auto again = meshprep::cost_table_from(meshprep::json_text(json));
    ASSERT_TRUE(again);
    EXPECT_EQ(cost::cost_page(*again), page);
    const std::string good = table.ladders[0].rungs[1].picture;
    for (const meshprep::Json& wrong : {meshprep::Json("x"), meshprep::Json(7), meshprep::Json(""),
                                        meshprep::Json(good + "\"/><script>"),
                                        meshprep::Json(good + std::string(1 << 17, 'A'))}) {
        meshprep::Json changed = json;
        changed["ladders"][0]["rungs"][1]["looks"][1] = wrong;
        const auto read = meshprep::cost_table_from(meshprep::json_text(changed));
        ASSERT_FALSE(read) << wrong;
        EXPECT_EQ(read.error().place, "#/ladders/0/rungs/1/looks/1");
    }
    meshprep::Json one = json;
    one["ladders"][0]["rungs"][1]["looks"].erase(1);
    EXPECT_FALSE(meshprep::cost_table_from(meshprep::json_text(one)));
}

TEST(CostPage, TerminalAndValuesSayTheSame) {
    const CostTable table = table_of_two();
    const auto rows = cost::cost_rows(table.ladders[0]);
    ASSERT_EQ(rows.size(), 7u);
    for (std::size_t i = 0; i < 6; ++i) {
        const RungRecord& r = table.ladders[0].rungs[i];
        EXPECT_EQ(rows[i + 1][1], cost::standing_text(table.ladders[0], r));
        EXPECT_EQ(rows[i + 1][2], cost::short_time(r.time.value));
        EXPECT_EQ(rows[i + 1][4], cost::short_number(r.errors[0]));
    }
    EXPECT_EQ(rows[1][0], "fast (default)");
    const std::string csv = cost::cost_csv(table);
    std::size_t lines = 0;
    for (const char c : csv) lines += c == '\n';
    EXPECT_EQ(lines, 1u + 6 * 2 + 2);
    EXPECT_NE(csv.find("\"a mesh, \"\"quoted\"\"\""), std::string::npos);
    EXPECT_NE(csv.find(",0.001,"), std::string::npos);
}

TEST(CostJson, ReadBackItGivesTheSamePage) {
    const CostTable table = table_of_two();
    const std::string text = meshprep::json_text(meshprep::to_json(table));
    const auto again = meshprep::cost_table_from(text);
    ASSERT_TRUE(again) << to_string(again.error());
    EXPECT_EQ(cost::cost_page(*again), cost::cost_page(table));
    EXPECT_EQ(cost::cost_csv(*again), cost::cost_csv(table));
    EXPECT_EQ(meshprep::json_text(meshprep::to_json(*again)), text);
}

// Every number, word and list of the document in turn is replaced by something else, and every text
// is cut short somewhere: an error with the place, never a crash, never a table with holes.
TEST(CostJson, DamagedDocumentsAreErrors) {
    const meshprep::Json whole = meshprep::to_json(table_of_two());
    const std::string text = meshprep::json_text(whole);
    for (std::size_t end = 0; end < text.size(); end += 97)
        EXPECT_FALSE(meshprep::cost_table_from(text.substr(0, end))) << end;
    const meshprep::Json flat = whole.flatten();
    int errors = 0, kept = 0;
    for (const auto& [pointer, value] : flat.items()) {
        for (const meshprep::Json& wrong :
             {meshprep::Json(nullptr), meshprep::Json(-7), meshprep::Json("x"),
              meshprep::Json::array(), meshprep::Json::object(), meshprep::Json(true),
              meshprep::Json(1e308), meshprep::Json(4000000000u)}) {
            meshprep::Json changed = whole;
            changed[meshprep::Json::json_pointer(pointer)] = wrong;
            const auto read = meshprep::cost_table_from(meshprep::json_text(changed));
            if (read) {
                ++kept;
                EXPECT_FALSE(cost::cost_page(*read).empty());
                continue;
            }
            ++errors;
            EXPECT_EQ(read.error().place[0], '#');
        }
    }
    EXPECT_GT(errors, 500);
    EXPECT_GT(kept, 50);  // texts and other numbers are as good as what was there
    const auto error = [](const std::string& other) {
        const auto read = meshprep::cost_table_from(other);
        return read ? std::string() : to_string(read.error());
    };
    EXPECT_NE(error("{").find("no JSON"), std::string::npos);
    EXPECT_NE(error("{\"command\":\"diff\"}").find("/command"), std::string::npos);
    meshprep::Json shorter = whole;
    shorter["ladders"][0]["rungs"][2]["seconds"].erase(0);
    EXPECT_NE(error(meshprep::json_text(shorter)).find("/ladders/0/rungs/2/seconds"),
              std::string::npos);
    meshprep::Json fewer = whole;
    fewer["ladders"][0]["rungs"][2]["errors"].erase(1);
    EXPECT_NE(error(meshprep::json_text(fewer)).find("/ladders/0/rungs/2/errors"),
              std::string::npos);
    // All of one ladder's times a round shorter is another table, none of them is not.
    meshprep::Json none = whole;
    for (meshprep::Json& r : none["ladders"][1]["rungs"]) r["seconds"] = meshprep::Json::array();
    none["ladders"][1]["control_seconds"] = meshprep::Json::array();
    EXPECT_NE(error(meshprep::json_text(none)), "");
    meshprep::Json beyond = whole;
    beyond["ladders"][0]["primary"] = 2u;
    EXPECT_NE(error(meshprep::json_text(beyond)).find("/ladders/0/primary"), std::string::npos);
    beyond = whole;
    beyond["ladders"][0]["reference"] = 6u;
    EXPECT_NE(error(meshprep::json_text(beyond)).find("/ladders/0/reference"), std::string::npos);
    // Numbers that no run gives, where they would be drawn or take long.
    for (const meshprep::Json& wrong : {meshprep::Json(0.0), meshprep::Json(1e-13),
                                        meshprep::Json(1e10), meshprep::Json("inf")}) {
        meshprep::Json timed = whole;
        timed["ladders"][0]["rungs"][0]["seconds"][0] = wrong;
        EXPECT_NE(error(meshprep::json_text(timed)).find("/ladders/0/rungs/0/seconds/0"),
                  std::string::npos)
            << wrong;
    }
    meshprep::Json many = whole;
    for (int i = 0; i < 64; ++i)
        many["ladders"][0]["rungs"].push_back(many["ladders"][0]["rungs"][0]);
    EXPECT_NE(error(meshprep::json_text(many)).find("more than 64"), std::string::npos);
    many = whole;
    for (int i = 0; i < 1000; ++i) many["ladders"][0]["control_seconds"].push_back(0.001);
    EXPECT_NE(error(meshprep::json_text(many)).find("more than 1000"), std::string::npos);
    // A PSNR may be minus infinity; a share of time may be nothing of the kind.
    meshprep::Json low = whole;
    low["ladders"][0]["rungs"][0]["errors"][1] = "-inf";
    const auto again = meshprep::cost_table_from(meshprep::json_text(low));
    ASSERT_TRUE(again) << to_string(again.error());
    EXPECT_EQ(again->ladders[0].rungs[0].errors[1], -std::numeric_limits<double>::infinity());
    for (const char* name : {"floor", "wall_seconds", "taken_by_others"}) {
        low = whole;
        low["ladders"][0][name] = "nan";
        EXPECT_NE(error(meshprep::json_text(low)).find(name), std::string::npos) << name;
    }
    for (const char* name : {"../first", "", "a/b", "A b"}) {  // it becomes a file's
        meshprep::Json named = whole;
        named["ladders"][0]["name"] = name;
        EXPECT_NE(error(meshprep::json_text(named)).find("/ladders/0/name"), std::string::npos);
    }
}

}  // namespace
