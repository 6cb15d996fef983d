// The drawing surface of report sheets: pixels, letters and the sheet's arrangement.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "prep/image.h"
#include "sheets/canvas.h"
#include "sheets/sheet.h"
#include "sheets/stroke_font.h"
#include "sheets/test_patterns.h"

namespace {

using report::Canvas;
using report::rgb;

constexpr report::Color white = rgb(0xffffff), black = rgb(0x000000);

// How much of a pixel is drawn in black on white.
double ink(const prep::Image& image, std::uint32_t x, std::uint32_t y) {
    return 1 - double(image.at(x, y)[1]);
}
double ink(const prep::Image& image) {
    double sum = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) sum += ink(image, x, y);
    return sum;
}

TEST(Canvas, RectanglesCoverTheirAreaAndNothingElse) {
    Canvas canvas(20, 10, white);
    canvas.fill({3, 2, 10, 5}, black);
    for (std::uint32_t y = 0; y < 10; ++y)
        for (std::uint32_t x = 0; x < 20; ++x)
            EXPECT_EQ(ink(canvas.image(), x, y), x >= 3 && x < 13 && y >= 2 && y < 7 ? 1.0 : 0.0)
                << x << " " << y;
    Canvas half(6, 4, white);
    half.fill({1.5, 1, 3, 2}, black);
    EXPECT_NEAR(ink(half.image(), 1, 1), 0.5, 1e-6);
    EXPECT_NEAR(ink(half.image(), 2, 1), 1, 1e-6);
    EXPECT_NEAR(ink(half.image(), 4, 1), 0.5, 1e-6);
    // Half of the colour where the colour lets half through; outside nothing is touched.
    Canvas clear(4, 4, white);
    clear.fill({-5, -5, 7, 7}, rgb(0x000000, 0.5f));
    EXPECT_NEAR(ink(clear.image(), 1, 1), 0.5, 1e-6);
    EXPECT_EQ(ink(clear.image(), 2, 2), 0.0);
    // A disc of radius 8.
    Canvas round(20, 20, white);
    round.fill({2, 2, 16, 16}, black, 8);
    EXPECT_NEAR(ink(round.image()), 3.14159265 * 64, 1);
    EXPECT_EQ(ink(round.image(), 3, 3), 0.0);
    // A frame of two pixels lies within its rectangle.
    Canvas frame(12, 12, white);
    frame.frame({1, 1, 10, 10}, black, 2);
    EXPECT_NEAR(ink(frame.image()), 100 - 36, 1);
    EXPECT_EQ(ink(frame.image(), 0, 5), 0.0);
    EXPECT_EQ(ink(frame.image(), 5, 5), 0.0);
}

TEST(Canvas, LinesAreAsLongAndWideAsTheyAreMeant) {
    Canvas canvas(40, 40, white);
    canvas.line(10, 10.5, 30, 10.5, black, 3);
    EXPECT_NEAR(ink(canvas.image(), 20, 10), 1, 1e-6);
    EXPECT_NEAR(ink(canvas.image(), 20, 9), 1, 1e-6);
    EXPECT_NEAR(ink(canvas.image(), 20, 11), 1, 1e-6);
    EXPECT_NEAR(ink(canvas.image(), 20, 12), 0, 1e-6);
    // 20 × 3, and round ends of radius 1.5.
    EXPECT_NEAR(ink(canvas.image()), 60 + 3.14159265 * 2.25, 0.7);
    Canvas slanted(40, 40, white);
    slanted.line(8, 8, 32, 26, black, 2);  // 30 long
    EXPECT_NEAR(ink(slanted.image()), 60 + 3.14159265, 1.5);
}

TEST(Canvas, PicturesAreCopiedWithTheirAlpha) {
    Canvas canvas(8, 8, white);
    canvas.picture({2, 1, 4, {1, 0, 0, 1, 0, 0, 1, 0.25f}, true}, 3, 4);
    const float* red = canvas.image().at(3, 4);
    EXPECT_EQ(red[0], 1.0f);
    EXPECT_EQ(red[1], 0.0f);
    const float* blue = canvas.image().at(4, 4);
    EXPECT_NEAR(blue[0], 0.75f, 1e-6f);
    EXPECT_EQ(blue[2], 1.0f);
    EXPECT_EQ(ink(canvas.image(), 5, 4), 0.0);
    canvas.picture({1, 1, 1, {0.5f}, true}, 0, 0);
    EXPECT_EQ(canvas.image().at(0, 0)[0], 0.5f);
    EXPECT_EQ(canvas.image().at(0, 0)[2], 0.5f);
    canvas.picture({2, 2, 3, std::vector<float>(12, 0.0f), true}, 7, -1);  // mostly outside
    EXPECT_EQ(ink(canvas.image(), 7, 0), 1.0);
}

struct Box {
    std::uint32_t left = 1u << 30, right = 0, top = 1u << 30, bottom = 0;
};
Box box_of(const prep::Image& image) {
    Box box;
    for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
            if (ink(image, x, y) < 0.5) continue;
            box.left = std::min(box.left, x), box.right = std::max(box.right, x);
            box.top = std::min(box.top, y), box.bottom = std::max(box.bottom, y);
        }
    return box;
}
Box letters(const char* text, report::Align align, double x = 100) {
    Canvas canvas(200, 80, white);
    report::TextStyle style;
    style.size = 28;  // capitals of 20 pixels
    style.align = align;
    canvas.text(x, 50, text, style);
    return box_of(canvas.image());
}

TEST(CanvasText, StandsOnItsBaselineAndWhereItIsAligned) {
    using report::Align;
    const Box h = letters("H", Align::left);
    EXPECT_EQ(h.bottom, 49u);
    EXPECT_NEAR(double(h.top), 30, 2.5);  // capitals: size / 1.4, and the stroke's width of 2.3
    EXPECT_NEAR(double(h.left), 100, 1);
    const Box x = letters("x", Align::left), p = letters("p", Align::left);
    EXPECT_NEAR(double(x.top), 50 - 20 * 10.0 / 14, 2.5);  // small letters: 10 of 14
    EXPECT_GT(p.bottom, x.bottom + 3);                     // goes below
    report::TextStyle style;
    style.size = 28;
    const double width = report::text_width("HHHH", style);
    const Box left = letters("HHHH", Align::left), middle = letters("HHHH", Align::center),
              right = letters("HHHH", Align::right);
    EXPECT_NEAR(double(left.right + 1 - left.left), width, 1.5);
    EXPECT_NEAR(double(middle.left), 100 - width / 2, 1);
    EXPECT_NEAR(double(right.right), 100, 1.5);
    EXPECT_NEAR(double(right.left), 100 - width, 1);
    EXPECT_EQ(report::text_width("", style), 0.0);
    style.bold = true;
    EXPECT_GT(report::text_width("HHHH", style), width);
}

TEST(CanvasText, IsShortenedWhereItDoesNotFit) {
    report::TextStyle style;
    const std::string text = "a long name of a file.obj";
    const double whole = report::text_width(text, style);
    EXPECT_EQ(report::fit_text(text, whole, style), text);
    for (const double share : {0.3, 0.6, 0.9}) {
        const std::string end = report::fit_text(text, whole * share, style);
        EXPECT_LE(report::text_width(end, style), whole * share);
        EXPECT_EQ(end.substr(end.size() - 3), "…");
        EXPECT_EQ(end.substr(0, end.size() - 3), text.substr(0, end.size() - 3));
        // Not shorter than it must be.
        EXPECT_GT(report::text_width(text.substr(0, end.size() - 2) + "…", style), whole * share);
    }
    const std::string both = report::fit_text(text, whole * 0.6, style, true);
    const std::size_t gap = both.find("…");
    EXPECT_EQ(both.substr(0, gap), text.substr(0, gap));
    const std::string tail = both.substr(gap + 3);
    EXPECT_GE(tail.size(), 3u);
    EXPECT_EQ(tail, text.substr(text.size() - tail.size()));
    EXPECT_EQ(report::fit_text(text, 0, style), "…");
    EXPECT_EQ(report::fit_text("äöüäöü", report::text_width("äöü…", style), style), "äöü…");
}

std::string code_points(std::string text) {
    std::string out;
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t before = rest.size();
        const char32_t code = report::next_code_point(rest);
        out +=
            std::to_string(std::uint32_t(code)) + "/" + std::to_string(before - rest.size()) + " ";
    }
    return out;
}

TEST(StrokeFont, ReadsUtf8AndNothingThatIsNone) {
    EXPECT_EQ(code_points("a\xC3\xA4\xE2\x86\x92\xF0\x9F\x98\x80"), "97/1 228/2 8594/3 128512/4 ");
    const std::string bad = "65533/1 ";
    EXPECT_EQ(code_points("\x80z"), bad + "122/1 ");
    EXPECT_EQ(code_points("\xC3"), bad);  // cut off
    EXPECT_EQ(code_points("\xE2\x86"), bad + bad);
    EXPECT_EQ(code_points("\xC3z"), bad + "122/1 ");
    EXPECT_EQ(code_points("\xC1\x81"), bad + bad);                      // A in two bytes
    EXPECT_EQ(code_points("\xF5\x80\x80\x80"), bad + bad + bad + bad);  // beyond U+10FFFF
}

TEST(StrokeFont, ShapesAreThoseOfTheirLetters) {
    const auto extent = [](char32_t code, int axis) {
        double low = 1e9, high = -1e9;
        for (const auto& stroke : report::glyph(code).strokes)
            for (const report::GlyphPoint& p : stroke) {
                const double v = axis == 0 ? double(p.x) : double(p.y);
                low = std::min(low, v), high = std::max(high, v);
            }
        return std::pair(low, high);
    };
    // O is an oval from the baseline to the height of capitals, as wide as it says.
    EXPECT_NEAR(extent(U'O', 1).first, 0, 1e-5);
    EXPECT_NEAR(extent(U'O', 1).second, report::font_capital_height, 1e-5);
    EXPECT_NEAR(extent(U'O', 0).second, double(report::glyph(U'O').width), 1e-4);
    EXPECT_EQ(report::glyph(U'T').strokes.size(), 2u);
    EXPECT_TRUE(report::glyph(U' ').strokes.empty());
    EXPECT_GT(report::glyph(U' ').width, 0.0f);
    // Marks stand above their letter or below, and take the place of a dot.
    EXPECT_GT(extent(U'é', 1).second, extent(U'e', 1).second + 1);
    EXPECT_GT(extent(U'É', 1).second, extent(U'E', 1).second + 1);
    EXPECT_LT(extent(U'ç', 1).first, extent(U'c', 1).first - 1);
    EXPECT_EQ(report::glyph(U'ä').strokes.size(), report::glyph(U'a').strokes.size() + 2);
    EXPECT_EQ(report::glyph(U'í').strokes.size(), report::glyph(U'i').strokes.size());
    EXPECT_EQ(report::glyph(U'é').width, report::glyph(U'e').width);
    // What the font has not is a box.
    EXPECT_EQ(report::glyph(0x4E2D).strokes.size(), 1u);
    EXPECT_EQ(report::glyph(0x4E2D).strokes[0].size(), 5u);
    EXPECT_EQ(&report::glyph(0xA0), &report::glyph(U' '));
}

// Solid panels: where they stand is where their colour is.
TEST(Sheet, FourPanelsARowAndTheFiguresBesideTheLast) {
    report::Sheet sheet;
    sheet.title = "title";
    const std::uint32_t size = 96;
    for (std::uint32_t i = 0; i < 5; ++i) {
        report::Panel panel;
        panel.title = "p";
        prep::Image picture{size, size, 4, {}, true};
        for (std::uint32_t k = 0; k < size * size; ++k)
            picture.pixels.insert(picture.pixels.end(), {float(i + 1) / 8, 0, 1, 1});
        panel.picture = picture;
        sheet.panels.push_back(panel);
    }
    sheet.groups = {{"group", {{"name", "value", false}, {"bad", "very", false}}}};
    const auto find = [&](const prep::Image& image, std::uint32_t i) {
        Box box;
        for (std::uint32_t y = 0; y < image.height; ++y)
            for (std::uint32_t x = 0; x < image.width; ++x) {
                const float* p = image.at(x, y);
                if (p[0] != float(i + 1) / 8 || p[1] != 0 || p[2] != 1) continue;
                box.left = std::min(box.left, x), box.right = std::max(box.right, x);
                box.top = std::min(box.top, y), box.bottom = std::max(box.bottom, y);
            }
        return box;
    };
    const prep::Image image = report::draw_sheet(sheet, size);
    Box boxes[5];
    for (std::uint32_t i = 0; i < 5; ++i) {
        boxes[i] = find(image, i);
        EXPECT_EQ(boxes[i].right - boxes[i].left + 1, size) << i;
        EXPECT_EQ(boxes[i].bottom - boxes[i].top + 1, size) << i;
    }
    for (std::uint32_t i = 1; i < 4; ++i) {
        EXPECT_EQ(boxes[i].top, boxes[0].top);
        EXPECT_GT(boxes[i].left, boxes[i - 1].right);
        EXPECT_NEAR(double(boxes[i].left - boxes[i - 1].left),
                    double(boxes[1].left - boxes[0].left), 1);
    }
    EXPECT_EQ(boxes[4].left, boxes[0].left);
    EXPECT_GT(boxes[4].top, boxes[0].bottom + 20);  // below the title of the first
    EXPECT_NEAR(double(image.width - boxes[3].right), double(boxes[0].left), 2);
    // Rows below the picture of the second row are within the sheet, too.
    EXPECT_GT(image.height, boxes[4].bottom + 20);
    // The figures: dark pixels under the second panel, none where nothing is.
    const auto dark = [&](const prep::Image& of, std::uint32_t left, std::uint32_t right) {
        int count = 0;
        for (std::uint32_t y = boxes[4].top; y < of.height; ++y)
            for (std::uint32_t x = left; x < right; ++x) count += of.at(x, y)[0] < 0.5f;
        return count;
    };
    EXPECT_GT(dark(image, boxes[1].left, boxes[1].right), 50);
    EXPECT_EQ(dark(image, boxes[2].left, boxes[3].right), 0);
    // What needs attention is seen, in a colour of its own.
    const auto orange = [](const prep::Image& of) {
        int count = 0;
        for (std::size_t i = 0; i < of.pixels.size(); i += 3)
            count += of.pixels[i] > 0.6f && of.pixels[i + 2] < 0.2f;
        return count;
    };
    EXPECT_EQ(orange(image), 0);
    sheet.groups[0].figures[1].attention = true;
    EXPECT_GT(orange(report::draw_sheet(sheet, size)), 10);
    // A panel without a picture says why; a legend lies over the picture.
    sheet.panels[4].picture.reset();
    sheet.panels[4].note = "not drawn";
    sheet.panels[0].legend = {{rgb(0x00ff00), "green"}};
    const prep::Image noted = report::draw_sheet(sheet, size);
    EXPECT_GT(dark(noted, boxes[4].left, boxes[4].right),
              dark(image, boxes[4].left, boxes[4].right));
    int green = 0;
    for (std::uint32_t y = boxes[0].top; y < boxes[0].bottom; ++y)
        for (std::uint32_t x = boxes[0].left; x < boxes[0].right; ++x)
            green += noted.at(x, y)[1] > noted.at(x, y)[2] + 0.3f;
    EXPECT_GT(green, 2);
}

prep::Image decoded(const prep::Result<prep::ImageRef>& ref) {
    EXPECT_TRUE(ref);
    const auto image = prep::load_image(*ref);
    EXPECT_TRUE(image);
    return image ? *image : prep::Image{};
}

// Normals of spherical caps: out of the middle to all sides, green up as glTF has it.
TEST(TestPatterns, BumpsLeanAwayFromTheirMiddle) {
    const prep::Image map = decoded(report::bump_normal_map());
    ASSERT_EQ(map.width, 512u);
    const double cell = 512.0 / 6;
    int on_bumps = 0;
    for (std::uint32_t y = 0; y < 512; y += 3)
        for (std::uint32_t x = 0; x < 512; x += 3) {
            const float* p = map.at(x, y);
            const glm::dvec3 n(2 * double(p[0]) - 1, 2 * double(p[1]) - 1, 2 * double(p[2]) - 1);
            EXPECT_NEAR(glm::length(n), 1, 0.01);
            const double dx = std::fmod(x + 0.5, cell) - cell / 2;
            const double up = cell / 2 - std::fmod(y + 0.5, cell);
            const double r = std::hypot(dx, up) / (0.38 * cell);
            EXPECT_TRUE(r < 1.02 || n.z > 0.99) << x << " " << y;
            if (r < 0.1 || r > 0.98) continue;
            ++on_bumps;
            EXPECT_GT(n.x * dx + n.y * up, 0);
            EXPECT_NEAR(std::hypot(n.x, n.y), 0.766 * r, 0.02);
        }
    EXPECT_GT(on_bumps, 3000);
}

TEST(TestPatterns, CheckerCellsAlternateAndHueRunsAcross) {
    const prep::Image map = decoded(report::uv_checker());
    ASSERT_EQ(map.width, 1024u);
    ASSERT_EQ(map.height, 1024u);
    for (std::uint32_t j = 0; j < 8; ++j)
        for (std::uint32_t i = 0; i < 8; ++i) {
            const float* p = map.at(i * 128 + 5, j * 128 + 5);  // beside the letters
            const float most = std::max({p[0], p[1], p[2]}), least = std::min({p[0], p[1], p[2]});
            const bool dark = (i + j) % 2 == 1;
            EXPECT_NEAR(most, dark ? 0.62f : 0.97f, 0.003f) << i << " " << j;
            EXPECT_NEAR(1 - least / most, dark ? 0.55f : 0.16f, 0.01f);
        }
    // Red at column 0, and complements half a row apart: cyan at column 4.
    const float *red = map.at(133 - 128, 5 + 128), *cyan = map.at(4 * 128 + 5, 128 + 5);
    EXPECT_GT(red[0], red[1] + 0.2f);
    EXPECT_NEAR(red[1], red[2], 0.003f);
    EXPECT_LT(cyan[0], cyan[1] - 0.2f);
    EXPECT_NEAR(cyan[1], cyan[2], 0.003f);
    // Hue 1/4 (column 2) is between yellow and green, hue 3/4 between blue and magenta.
    const float *green = map.at(2 * 128 + 5, 128 + 5), *violet = map.at(6 * 128 + 5, 128 + 5);
    EXPECT_GT(green[1], green[0]);
    EXPECT_GT(green[0], green[2]);
    EXPECT_GT(violet[2], violet[0]);
    EXPECT_GT(violet[0], violet[1]);
}

}  // namespace
