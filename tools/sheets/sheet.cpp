#include "sheets/sheet.h"

#include <algorithm>
#include <cmath>

namespace report {
namespace {

constexpr Color page = rgb(0xffffff);
constexpr Color card = rgb(0xeef1f5);
constexpr Color rule = rgb(0xd5dae1);
constexpr Color text_dark = rgb(0x111827);
constexpr Color text_soft = rgb(0x4b5563);
constexpr Color text_attention = rgb(0xb45309);

constexpr double margin = 48, gap = 24;
constexpr std::size_t columns = 4;

std::vector<std::string> wrapped(const std::string& text, double width, const TextStyle& style,
                                 std::size_t most) {
    std::vector<std::string> lines;
    std::string line, word;
    const auto flush_word = [&] {
        if (word.empty()) return;
        const std::string longer = line.empty() ? word : line + " " + word;
        if (!line.empty() && text_width(longer, style) > width) {
            lines.push_back(line);
            line = word;
        } else {
            line = longer;
        }
        word.clear();
    };
    for (const char c : text) {
        if (c == ' ')
            flush_word();
        else
            word += c;
    }
    flush_word();
    if (!line.empty()) lines.push_back(line);
    if (lines.size() > most) {
        lines.resize(most);
        lines.back() += " …";
    }
    for (std::string& l : lines) l = fit_text(l, width, style);
    return lines;
}

class Layout {
  public:
    Layout(const Sheet& sheet, double panel) : sheet_(sheet), panel_(panel) {
        scale_ = std::max(panel / 480, 0.35);
        caption_ = 82 * scale_;
        // Below 480 pixels the text keeps a legible size longer than the pictures do.
        rows_ = (sheet.panels.size() + columns - 1) / columns;
        header_ = 118 * scale_;
        footer_ = sheet.footer.empty() ? 0 : 34 * scale_;
    }

    prep::Image draw() {
        place_figures(nullptr);
        const double width = 2 * m() + columns * panel_ + (columns - 1) * g();
        const double height = std::max(panels_bottom(), figures_bottom_) + footer_ + m();
        Canvas canvas(static_cast<std::uint32_t>(std::ceil(width)),
                      static_cast<std::uint32_t>(std::ceil(height)), page);
        draw_header(canvas);
        for (std::size_t i = 0; i < sheet_.panels.size(); ++i)
            draw_panel(canvas, sheet_.panels[i], panel_x(i % columns), panel_y(i / columns));
        place_figures(&canvas);
        if (footer_ > 0) canvas.text(m(), height - m() * 0.7, sheet_.footer, style(14, text_soft));
        return canvas.image();
    }

  private:
    double m() const { return margin * scale_; }
    double g() const { return gap * scale_; }
    TextStyle style(double size, Color color, bool bold = false, Align align = Align::left) const {
        TextStyle s;
        s.size = size * scale_;
        s.color = color;
        s.bold = bold;
        s.align = align;
        return s;
    }
    double panel_x(std::size_t column) const {
        return std::round(m() + static_cast<double>(column) * (panel_ + g()));
    }
    double panel_y(std::size_t row) const {
        return std::round(header_ + static_cast<double>(row) * (panel_ + caption_ + g()));
    }
    double panels_bottom() const { return panel_y(rows_) - g(); }

    void draw_header(Canvas& canvas) const {
        const double width = canvas.width() - 2 * m();
        const TextStyle title = style(36, text_dark, true);
        canvas.text(m(), 66 * scale_, fit_text(sheet_.title, width, title, true), title);
        const TextStyle soft = style(19, text_soft);
        canvas.text(m(), 98 * scale_, fit_text(sheet_.subtitle, width, soft), soft);
    }

    void draw_panel(Canvas& canvas, const Panel& p, double x, double y) const {
        canvas.fill({x, y, panel_, panel_}, card, 10 * scale_);
        if (p.picture) {
            canvas.picture(*p.picture, static_cast<std::int64_t>(x), static_cast<std::int64_t>(y),
                           10 * scale_);
        } else {
            const TextStyle note = style(19, text_soft, false, Align::center);
            const auto lines = wrapped(p.note, panel_ - 80 * scale_, note, 4);
            double line_y =
                y + panel_ / 2 - 14 * scale_ * (static_cast<double>(lines.size()) - 1.6);
            for (const std::string& line : lines) {
                canvas.text(x + panel_ / 2, line_y, line, note);
                line_y += 28 * scale_;
            }
        }
        draw_legend(canvas, p, x, y);
        canvas.text(x, y + panel_ + 27 * scale_, p.title, style(20, text_dark, true));
        const TextStyle soft = style(15.5, text_soft);
        double line_y = y + panel_ + 50 * scale_;
        for (const std::string& line : wrapped(p.caption, panel_, soft, 2)) {
            canvas.text(x, line_y, line, soft);
            line_y += 21 * scale_;
        }
    }

    void draw_legend(Canvas& canvas, const Panel& p, double x, double y) const {
        if (p.legend.empty()) return;
        const TextStyle small = style(14.5, text_dark);
        double widest = 0;
        for (const LegendItem& item : p.legend)
            widest = std::max(widest, text_width(item.text, small));
        const double line = 22 * scale_, pad = 10 * scale_;
        const Rect box{x + 10 * scale_, y + 10 * scale_,
                       widest + 34 * scale_ + 2 * pad - 8 * scale_,
                       line * static_cast<double>(p.legend.size()) + pad};
        canvas.fill(box, {1, 1, 1, 0.86f}, 6 * scale_);
        double line_y = box.y + pad / 2;
        for (const LegendItem& item : p.legend) {
            canvas.line(box.x + pad, line_y + line / 2, box.x + pad + 16 * scale_,
                        line_y + line / 2, item.color, 3 * scale_);
            canvas.text(box.x + pad + 26 * scale_, line_y + line * 0.72, item.text, small);
            line_y += line;
        }
    }

    // The figures fill what is free of the last row, in columns as wide as a panel; where nothing
    // is free, or it does not suffice, they go on below. Without a canvas only the extent is found.
    void place_figures(Canvas* canvas) {
        const std::size_t used = sheet_.panels.size() % columns;
        const bool beside = used != 0;
        const std::size_t first = beside ? used : 0;
        const std::size_t free = columns - first;
        const double top = beside ? panel_y(rows_ - 1) : panel_y(rows_);
        std::vector<double> ends(free, top);
        // Each group goes where there is most room: reading order within a column is kept.
        for (const FigureGroup& group : sheet_.groups) {
            const auto at = std::min_element(ends.begin(), ends.end()) - ends.begin();
            const auto c = static_cast<std::size_t>(at);
            ends[c] = draw_group(canvas, group, panel_x(first + c), ends[c]) + 22 * scale_;
        }
        figures_bottom_ = *std::max_element(ends.begin(), ends.end()) - 22 * scale_;
    }

    double draw_group(Canvas* canvas, const FigureGroup& group, double x, double y) const {
        const double line = 25 * scale_;
        y += 20 * scale_;
        if (canvas) {
            canvas->text(x, y, group.title, style(19, text_dark, true));
            canvas->fill({x, y + 9 * scale_, panel_, std::max(1.0, std::round(scale_))}, rule);
        }
        y += 12 * scale_;
        for (const Figure& f : group.figures) {
            y += line;
            if (!canvas) continue;
            const TextStyle name = style(15.5, text_soft);
            const TextStyle value =
                style(15.5, f.attention ? text_attention : text_dark, f.attention, Align::right);
            const double name_width = std::min(text_width(f.name, name), panel_ * 0.62);
            canvas->text(x, y, fit_text(f.name, name_width, name), name);
            canvas->text(x + panel_, y, fit_text(f.value, panel_ - name_width - 16 * scale_, value),
                         value);
        }
        return y + 6 * scale_;
    }

    const Sheet& sheet_;
    double panel_, scale_ = 1, caption_ = 0, header_ = 0, footer_ = 0, figures_bottom_ = 0;
    std::size_t rows_ = 0;
};

}  // namespace

std::string with_commas(std::uint64_t value) {
    std::string digits = std::to_string(value);
    for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
    return digits;
}

std::string count_of(std::uint64_t value, const std::string& singular, const std::string& plural) {
    return with_commas(value) + " " +
           (value == 1       ? singular
            : plural.empty() ? singular + "s"
                             : plural);
}

prep::Image draw_sheet(const Sheet& sheet, std::uint32_t panel) {
    return Layout(sheet, panel).draw();
}

}  // namespace report
