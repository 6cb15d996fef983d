#include "sheets/stroke_font.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>

namespace report {
namespace {

// Path language: "m x y" lifts the pen and sets it down, "l x y" draws a line, "e cx cy rx ry a b"
// draws an elliptical arc from angle a to b (degrees, counter-clockwise positive) and joins it to
// what is drawn so far unless the pen was lifted ("m" before it, without a line, is dropped).
struct Drawing {
    char32_t code;
    float width;
    const char* path;
};

constexpr Drawing drawings[] = {
    {U' ', 2.6f, ""},
    {U'!', 0, "m 0 14 l 0 4.5 m 0 .3 l 0 .3"},
    {U'"', 4, "m 0 14 l 0 10 m 4 14 l 4 10"},
    {U'#', 10, "m 3.4 13 l 1.6 1 m 8.4 13 l 6.6 1 m .6 9.4 l 10 9.4 m 0 4.6 l 9.4 4.6"},
    {U'$', 9, "m 8 12 e 4.5 10.1 4.2 2.9 40 270 e 4.5 3.9 4.5 3.3 90 -145 m 4.5 15.4 l 4.5 -1.4"},
    {U'%', 12, "e 2.7 10.9 2.7 3.1 0 360 m 10.6 14 l 1.4 0 e 9.3 3.1 2.7 3.1 0 360"},
    {U'&', 11,
     "m 11 0 l 2.3 9.2 e 4.6 11.1 2.8 2.9 215 -55 l 2.6 7.4 e 4.3 3.8 4.3 3.8 140 325 "
     "l 10.4 7.4"},
    {U'\'', 0, "m 0 14 l 0 10"},
    {U'(', 3.4f, "e 6 5.6 6 9.8 112 248"},
    {U')', 3.4f, "e -2.6 5.6 6 9.8 68 -68"},
    {U'*', 6, "m 3 14 l 3 7.4 m .2 12.4 l 5.8 9 m 5.8 12.4 l .2 9"},
    {U'+', 8.4f, "m 4.2 10.6 l 4.2 2.2 m 0 6.4 l 8.4 6.4"},
    {U',', 1.4f, "m 1.2 .4 l 0 -2.8"},
    {U'-', 5, "m 0 5.2 l 5 5.2"},
    {U'.', 0, "m 0 .3 l 0 .3"},
    {U'/', 6, "m 6 15 l 0 -2"},
    {U'0', 8.4f, "e 4.2 7 4.2 7 0 360"},
    {U'1', 8.4f, "m 1.6 11.2 l 5 14 l 5 0"},
    {U'2', 8.4f, "e 4.2 10 4 4 165 -38 l .3 0 l 8.4 0"},
    {U'3', 8.4f, "e 4 10.5 3.8 3.5 150 -90 m 2.6 7 l 4 7 e 4 3.5 4.3 3.5 90 -150"},
    {U'4', 8.4f, "m 6.3 0 l 6.3 14 l 0 4 l 8.6 4"},
    {U'5', 8.4f, "m 7.6 14 l 1.2 14 l .7 7.6 e 4 4.5 4.4 4.5 138 -145"},
    {U'6', 8.4f, "e 4.2 4.4 4.2 4.4 0 360 e 7.4 4.4 7.4 9.6 180 97"},
    {U'7', 8.4f, "m 0 14 l 8.3 14 l 3 0"},
    {U'8', 8.4f, "e 4.2 10.6 3.6 3.4 -90 270 e 4.2 3.6 4.2 3.6 90 450"},
    {U'9', 8.4f, "e 4.2 9.6 4.2 4.4 0 360 e 1 9.6 7.4 9.6 0 -83"},
    {U':', 0, "m 0 8 l 0 8 m 0 .3 l 0 .3"},
    {U';', 1.4f, "m 1 8 l 1 8 m 1.2 .4 l 0 -2.8"},
    {U'<', 7.4f, "m 7.4 11 l 0 6.4 l 7.4 1.8"},
    {U'=', 8.4f, "m 0 8.6 l 8.4 8.6 m 0 4.2 l 8.4 4.2"},
    {U'>', 7.4f, "m 0 11 l 7.4 6.4 l 0 1.8"},
    {U'?', 7, "e 3.4 10.3 3.4 3.7 165 -50 e 6.6 4.4 3.2 3.4 110 180 m 3.4 .3 l 3.4 .3"},
    {U'@', 14,
     "m 10 8.6 e 7 5.6 2.9 3.3 0 360 m 9.9 9 l 9.9 4.4 e 11.9 4.4 2 2 180 290 "
     "e 7 5.6 7 7.6 -20 320"},
    {U'A', 11, "m 0 0 l 5.5 14 l 11 0 m 1.9 4.8 l 9.1 4.8"},
    {U'B', 9.2f,
     "m 0 7.4 l 5 7.4 e 5 10.7 3.6 3.3 -90 90 l 0 14 l 0 0 l 5 0 e 5 3.7 4.2 3.7 -90 90"},
    {U'C', 9.8f, "e 5.7 7 5.7 7 45 315"},
    {U'D', 10, "m 0 0 l 0 14 l 3.6 14 e 3.6 7 6.4 7 90 -90 l 0 0"},
    {U'E', 8, "m 8 14 l 0 14 l 0 0 l 8 0 m 0 7.3 l 7 7.3"},
    {U'F', 7.8f, "m 7.8 14 l 0 14 l 0 0 m 0 7.1 l 6.8 7.1"},
    {U'G', 10.8f, "e 5.7 7 5.7 7 47 315 l 10.2 6.6 l 6 6.6"},
    {U'H', 9.6f, "m 0 0 l 0 14 m 9.6 0 l 9.6 14 m 0 7.3 l 9.6 7.3"},
    {U'I', 0, "m 0 0 l 0 14"},
    {U'J', 6.4f, "m 6.4 14 l 6.4 4 e 3 4 3.4 4 0 -150"},
    {U'K', 9.4f, "m 0 0 l 0 14 m 9 14 l 0 5 m 3.3 8.3 l 9.4 0"},
    {U'L', 7.4f, "m 0 14 l 0 0 l 7.4 0"},
    {U'M', 12, "m 0 0 l 0 14 l 6 4 l 12 14 l 12 0"},
    {U'N', 9.6f, "m 0 0 l 0 14 l 9.6 0 l 9.6 14"},
    {U'O', 11.6f, "e 5.8 7 5.8 7 0 360"},
    {U'P', 9, "m 0 0 l 0 14 l 5 14 e 5 10.3 4 3.7 90 -90 l 0 6.6"},
    {U'Q', 11.8f, "e 5.8 7 5.8 7 0 360 m 7.6 3.8 l 11.8 -1"},
    {U'R', 9.4f, "m 0 0 l 0 14 l 5 14 e 5 10.3 4 3.7 90 -90 l 0 6.6 m 4.6 6.6 l 9.4 0"},
    {U'S', 9, "e 4.6 10.4 4.2 3.6 38 270 e 4.5 3.4 4.5 3.4 90 -145"},
    {U'T', 10, "m 0 14 l 10 14 m 5 14 l 5 0"},
    {U'U', 9.6f, "m 0 14 l 0 4.8 e 4.8 4.8 4.8 4.8 180 360 l 9.6 14"},
    {U'V', 10.6f, "m 0 14 l 5.3 0 l 10.6 14"},
    {U'W', 15.2f, "m 0 14 l 3.8 0 l 7.6 13.4 l 11.4 0 l 15.2 14"},
    {U'X', 9.6f, "m 0 14 l 9.6 0 m 9.6 14 l 0 0"},
    {U'Y', 10, "m 0 14 l 5 6.8 l 10 14 m 5 6.8 l 5 0"},
    {U'Z', 9, "m 0 14 l 9 14 l 0 0 l 9 0"},
    {U'[', 3, "m 3 15 l 0 15 l 0 -3 l 3 -3"},
    {U'\\', 6, "m 0 15 l 6 -2"},
    {U']', 3, "m 0 15 l 3 15 l 3 -3 l 0 -3"},
    {U'^', 7, "m 0 9.6 l 3.5 14 l 7 9.6"},
    {U'_', 8, "m 0 -2.4 l 8 -2.4"},
    {U'`', 3, "m 0 14 l 3 11.6"},
    {U'a', 8, "e 4 5 4 5 0 360 m 8 10 l 8 0"},
    {U'b', 8, "m 0 14 l 0 0 e 4 5 4 5 180 540"},
    {U'c', 7.2f, "e 4.2 5 4.2 5 45 315"},
    {U'd', 8, "e 4 5 4 5 0 360 m 8 14 l 8 0"},
    {U'e', 8.2f, "m .1 5.2 l 8.2 5.2 e 4.1 5 4.1 5 2 318"},
    {U'f', 4.8f, "m 2 0 l 2 10.8 e 5.2 10.8 3.2 3.2 180 95 m 0 9.6 l 4.8 9.6"},
    {U'g', 8, "e 4 5 4 5 0 360 m 8 10 l 8 .2 e 4 .2 4 4.2 0 -150"},
    {U'h', 7.8f, "m 0 14 l 0 0 m 0 6 l 0 6.1 e 3.9 6.1 3.9 3.9 180 0 l 7.8 0"},
    {U'i', 0, "m 0 10 l 0 0 m 0 13.7 l 0 13.7"},
    {U'j', 2, "m 2 10 l 2 -1 e -1.2 -1 3.2 3.2 0 -75 m 2 13.7 l 2 13.7"},
    {U'k', 7.4f, "m 0 14 l 0 0 m 7 10 l 0 3.4 m 2.7 6 l 7.4 0"},
    {U'l', 2, "m 0 14 l 0 2.4 e 2.4 2.4 2.4 2.4 180 262"},
    {U'm', 12.8f,
     "m 0 10 l 0 0 m 0 6.6 l 0 6.8 e 3.2 6.8 3.2 3.2 180 0 l 6.4 0 m 6.4 6.6 l 6.4 6.8 "
     "e 9.6 6.8 3.2 3.2 180 0 l 12.8 0"},
    {U'n', 7.8f, "m 0 10 l 0 0 m 0 6 l 0 6.1 e 3.9 6.1 3.9 3.9 180 0 l 7.8 0"},
    {U'o', 8.4f, "e 4.2 5 4.2 5 0 360"},
    {U'p', 8, "m 0 10 l 0 -4 m 0 5 e 4 5 4 5 180 540"},
    {U'q', 8, "e 4 5 4 5 0 360 m 8 10 l 8 -4"},
    {U'r', 5, "m 0 10 l 0 0 m 0 5.6 l 0 5.8 e 4.2 5.8 4.2 4.2 180 80"},
    {U's', 7, "e 3.5 7.5 3.2 2.5 35 270 e 3.5 2.5 3.5 2.5 90 -145"},
    {U't', 5, "m 2 13 l 2 3 e 5 3 3 3 180 268 m 0 9.6 l 5 9.6"},
    {U'u', 7.8f, "m 0 10 l 0 3.9 e 3.9 3.9 3.9 3.9 180 360 m 7.8 10 l 7.8 0"},
    {U'v', 8, "m 0 10 l 4 0 l 8 10"},
    {U'w', 12, "m 0 10 l 3 0 l 6 9.4 l 9 0 l 12 10"},
    {U'x', 7.8f, "m 0 10 l 7.8 0 m 7.8 10 l 0 0"},
    {U'y', 8, "m 0 10 l 4.1 .2 m 8 10 l 3.4 -1.8 e 1 -1 2.6 3 -15 -95"},
    {U'z', 7.2f, "m 0 10 l 7.2 10 l 0 0 l 7.2 0"},
    {U'{', 4,
     "m 4 15 e 4 13 2.2 2 90 180 l 1.8 8 e 0 8 1.8 2 0 -90 e 0 4 1.8 2 90 0 l 1.8 -1 "
     "e 4 -1 2.2 2 180 270"},
    {U'|', 0, "m 0 15 l 0 -3"},
    {U'}', 4,
     "m 0 15 e 0 13 2.2 2 90 0 l 2.2 8 e 4 8 1.8 2 180 270 e 4 4 1.8 2 90 180 l 2.2 -1 "
     "e 0 -1 2.2 2 0 -90"},
    {U'~', 8.4f, "m 0 5 e 2.3 5 2.3 2.2 180 30 l 4.2 6 e 6.1 6.2 2.3 2.2 210 360"},
    {U'°', 4.4f, "e 2.2 11.8 2.2 2.2 0 360"},
    {U'±', 8.4f, "m 4.2 11.4 l 4.2 4 m 0 7.7 l 8.4 7.7 m 0 .6 l 8.4 .6"},
    {U'²', 4.8f, "e 2.4 11.8 2.2 2.2 165 -38 l .2 7 l 4.8 7"},
    {U'³', 4.6f, "e 2.2 12.2 2 1.8 150 -90 e 2.2 8.6 2.3 1.8 90 -150"},
    {U'µ', 7.8f, "m 0 10 l 0 -4 m 0 3.9 e 3.9 3.9 3.9 3.9 180 360 m 7.8 10 l 7.8 0"},
    {U'μ', 7.8f, "m 0 10 l 0 -4 m 0 3.9 e 3.9 3.9 3.9 3.9 180 360 m 7.8 10 l 7.8 0"},
    {U'·', 0, "m 0 6.2 l 0 6.2"},
    {U'×', 7, "m 0 9.8 l 7 2.8 m 7 9.8 l 0 2.8"},
    {U'ß', 7.6f, "m 0 0 l 0 10.2 e 3.4 10.2 3.4 3.8 180 -40 l 3.4 7.8 e 3.2 3.9 4.2 3.9 80 -105"},
    {U'α', 9, "e 4 5 4 5 30 330 m 8.8 10 l 7.46 7.5 l 7.1 5 l 7.46 2.5 l 9 0"},
    {U'σ', 8.8f, "e 4.2 4.6 4.2 4.6 0 360 m 4.2 9.2 l 9 9.2"},
    {U'–', 7, "m 0 5.2 l 7 5.2"},
    {U'—', 13, "m 0 5.2 l 13 5.2"},
    {U'−', 8.4f, "m 0 6.4 l 8.4 6.4"},
    {U'‘', 1.4f, "m 1.2 14 l 0 11"},
    {U'’', 1.4f, "m 1.2 14 l 0 11"},
    {U'“', 4.6f, "m 1.2 14 l 0 11 m 4.4 14 l 3.2 11"},
    {U'”', 4.6f, "m 1.2 14 l 0 11 m 4.4 14 l 3.2 11"},
    {U'…', 8, "m 0 .3 l 0 .3 m 4 .3 l 4 .3 m 8 .3 l 8 .3"},
    {U'→', 12, "m 0 5.6 l 12 5.6 m 8.4 9.4 l 12 5.6 l 8.4 1.8"},
    {U'≤', 8, "m 8 11.6 l 0 7.8 l 8 4 m 0 .6 l 8 .6"},
    {U'≥', 8, "m 0 11.6 l 8 7.8 l 0 4 m 0 .6 l 8 .6"},
    {U'≈', 8.4f,
     "e 2.3 7.4 2.3 1.8 180 30 e 6.1 8.4 2.3 1.8 210 360 "
     "m 0 3 e 2.3 3 2.3 1.8 180 30 e 6.1 4 2.3 1.8 210 360"},
    {U'√', 9, "m 0 6 l 1.6 6.8 l 4 0 l 7.4 15 l 9 15"},
    {0xFFFD, 8, "m 0 0 l 8 0 l 8 14 l 0 14 l 0 0"},
};

// Letters made of a base letter and a mark.
struct Composite {
    char32_t code, base;
    char mark;  // ':' diaeresis, '\'' acute, '`' grave, '^' circumflex, 'o' ring, ',' cedilla, '~'
};
constexpr Composite composites[] = {
    {U'ä', U'a', ':'},  {U'ö', U'o', ':'},  {U'ü', U'u', ':'},  {U'Ä', U'A', ':'},
    {U'Ö', U'O', ':'},  {U'Ü', U'U', ':'},  {U'é', U'e', '\''}, {U'á', U'a', '\''},
    {U'í', U'i', '\''}, {U'ó', U'o', '\''}, {U'ú', U'u', '\''}, {U'É', U'E', '\''},
    {U'è', U'e', '`'},  {U'à', U'a', '`'},  {U'ù', U'u', '`'},  {U'ê', U'e', '^'},
    {U'â', U'a', '^'},  {U'î', U'i', '^'},  {U'ô', U'o', '^'},  {U'û', U'u', '^'},
    {U'å', U'a', 'o'},  {U'Å', U'A', 'o'},  {U'ç', U'c', ','},  {U'Ç', U'C', ','},
    {U'ñ', U'n', '~'},  {U'ë', U'e', ':'},  {U'ï', U'i', ':'},
};

class Pen {
  public:
    explicit Pen(Glyph& out) : out_(out) {}

    void draw(const char* path) {
        const char* at = path;
        while (*at != '\0') {
            const char command = *at++;
            if (command == ' ') continue;
            double a[6];
            const int count = command == 'e' ? 6 : 2;
            for (int i = 0; i < count; ++i) {
                char* end = nullptr;
                a[i] = std::strtod(at, &end);
                at = end;
            }
            if (command == 'm') lift();
            if (command == 'e')
                arc(a);
            else
                add(a[0], a[1]);
        }
        lift();
    }

  private:
    void add(double x, double y) {
        stroke_.push_back({static_cast<float>(x), static_cast<float>(y)});
    }
    void arc(const double* a) {
        constexpr double radians = std::numbers::pi / 180;
        // A step of 7.5° leaves a chord error of 0.2 % of the radius: 0.03 px at 16 px.
        const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(a[5] - a[4]) / 7.5)));
        const double x0 = a[0] + a[2] * std::cos(a[4] * radians);
        const double y0 = a[1] + a[3] * std::sin(a[4] * radians);
        // Far from what is drawn so far: a stroke of its own.
        if (!stroke_.empty() && std::hypot(stroke_.back().x - x0, stroke_.back().y - y0) > 1.2)
            lift();
        for (int i = 0; i <= steps; ++i) {
            const double angle = (a[4] + (a[5] - a[4]) * i / steps) * radians;
            add(a[0] + a[2] * std::cos(angle), a[1] + a[3] * std::sin(angle));
        }
    }
    void lift() {
        if (stroke_.size() > 1) out_.strokes.push_back(stroke_);
        stroke_.clear();
    }
    Glyph& out_;
    std::vector<GlyphPoint> stroke_;
};

void add_mark(Glyph& glyph, char mark, bool capital) {
    const double x = glyph.width / 2, y = capital ? 17.2 : 13.4;
    const auto path = [&](const std::string& text) { Pen(glyph).draw(text.c_str()); };
    const auto at = [&](const char* command, double dx, double dy) {
        return std::string(command) + " " + std::to_string(x + dx) + " " + std::to_string(y + dy) +
               " ";
    };
    switch (mark) {
        case ':':
            path(at("m", -2, 0) + at("l", -2, 0) + at("m", 2, 0) + at("l", 2, 0));
            break;
        case '\'':
            path(at("m", -.6, -.8) + at("l", 1.4, 1.2));
            break;
        case '`':
            path(at("m", .6, -.8) + at("l", -1.4, 1.2));
            break;
        case '^':
            path(at("m", -2.2, -.8) + at("l", 0, 1.2) + at("l", 2.2, -.8));
            break;
        case 'o':
            path("e " + std::to_string(x) + " " + std::to_string(y + .4) + " 1.7 1.7 0 360");
            break;
        case ',':
            path("m " + std::to_string(x + .6) + " -1 l " + std::to_string(x) + " -3.6");
            break;
        default:
            path(at("m", -2.4, -.6) + at("l", -.9, .5) + at("l", .9, -.5) + at("l", 2.4, .6));
            break;
    }
}

std::map<char32_t, Glyph> make_font() {
    std::map<char32_t, Glyph> font;
    for (const Drawing& drawing : drawings) {
        Glyph& glyph = font[drawing.code];
        glyph.width = drawing.width;
        Pen(glyph).draw(drawing.path);
    }
    for (const Composite& composite : composites) {
        Glyph glyph = font[composite.base];
        if (composite.base == U'i') glyph.strokes.pop_back();  // the accent takes the dot's place
        add_mark(glyph, composite.mark, composite.base < U'a');
        font[composite.code] = std::move(glyph);
    }
    return font;
}

}  // namespace

const Glyph& glyph(char32_t code) {
    static const std::map<char32_t, Glyph> font = make_font();
    const auto found = font.find(code);
    if (found != font.end()) return found->second;
    if (code == 0xA0 || code == U'\t') return font.at(U' ');
    return font.at(0xFFFD);
}

char32_t next_code_point(std::string_view& utf8) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(utf8[i]); };
    const unsigned char first = byte(0);
    std::size_t length = 1;
    char32_t code = 0xFFFD;
    if (first < 0x80) {
        code = first;
    } else {
        const std::size_t expected = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
        bool good = expected > 0 && expected <= utf8.size() && first < 0xF5;
        for (std::size_t i = 1; good && i < expected; ++i) good = (byte(i) & 0xC0) == 0x80;
        if (good) {
            length = expected;
            code = first & (expected == 2 ? 0x1F : expected == 3 ? 0x0F : 0x07);
            for (std::size_t i = 1; i < expected; ++i) code = (code << 6) | (byte(i) & 0x3F);
        }
    }
    utf8.remove_prefix(length);
    return code;
}

}  // namespace report
