#include <array>
#include <cstdio>
#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "repeatable.h"
#include "sample_files.h"

namespace samples {
namespace {

using Point = glm::dvec3;
using Ring = std::vector<Point>;

constexpr int sectors = 6;  // one bolt hole each
constexpr int arc = 8;      // segments of a sector's arc
constexpr int side = 4;     // segments of a sector's straight side
constexpr int round = sectors * arc;
constexpr int hole_round = 2 * arc + 2 * side;  // one point of the hole per point of its sector

constexpr double flange_radius = 2.0, flange_height = 0.4, chamfer = 0.08;
constexpr double boss_radius = 0.9, boss_height = 1.3, fillet = 0.25;
constexpr double bore_radius = 0.5;
constexpr double hole_radius = 0.17, hole_circle = 1.54;

// Writes OBJ text; points that agree to the printed digits are one vertex.
class ObjText {
  public:
    void line(const std::string& text) { faces_ += text + "\n"; }

    void face(const Ring& points) {
        faces_ += "f";
        for (const Point& p : points) faces_ += " " + std::to_string(vertex(p));
        faces_ += "\n";
    }

    // Quads between two closed rings, facing outwards when `a` runs counter-clockwise below `b`.
    void band(const Ring& a, const Ring& b) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            const std::size_t j = (i + 1) % a.size();
            face({a[i], a[j], b[j], b[i]});
        }
    }

    std::string text() const { return vertices_ + faces_; }

  private:
    int vertex(const Point& p) {
        char text[96];
        std::snprintf(text, sizeof text, "v %.5f %.5f %.5f\n", p.x + 0.0, p.y + 0.0, p.z + 0.0);
        const auto [at, added] = index_.try_emplace(text, int(index_.size()) + 1);
        if (added) vertices_ += text;
        return at->second;
    }

    std::map<std::string, int> index_;
    std::string vertices_, faces_;
};

// Grid coordinates are rounded so that −0.00000 is never printed.
double tidy(double x) {
    const double scaled = std::floor(x * 1e5 + 0.5) / 1e5;
    return scaled == 0 ? 0.0 : scaled;
}

// The axis of the part is y (up); angles run counter-clockwise seen from above.
Point polar(double radius, double angle, double height, Point centre = {}) {
    return {tidy(centre.x + radius * cosine(angle)), tidy(height),
            tidy(centre.z - radius * sine(angle))};
}

Ring circle(double radius, double height, int count = round, Point centre = {}, double start = 0) {
    Ring ring;
    for (int i = 0; i < count; ++i)
        ring.push_back(polar(radius, start + 2 * pi * i / count, height, centre));
    return ring;
}

double sector_middle(int sector) {
    return 2 * pi * (sector + 0.5) / sectors;
}

Point hole_centre(int sector) {
    return polar(hole_circle, sector_middle(sector), 0);
}

// Counter-clockwise from the point straight outwards.
Ring hole(int sector, double height) {
    return circle(hole_radius, height, hole_round, hole_centre(sector), sector_middle(sector));
}

// The sector's outline, counter-clockwise from the middle of its outer arc: as many points as the
// hole has, so that quads can join the two.
Ring sector_outline(int sector, double inner, double outer, double height) {
    const double from = 2 * pi * sector / sectors, step = 2 * pi / round;
    Ring ring;
    for (int i = arc / 2; i < arc; ++i) ring.push_back(polar(outer, from + i * step, height));
    for (int i = 0; i < side; ++i)
        ring.push_back(polar(mix(outer, inner, double(i) / side), from + arc * step, height));
    for (int i = arc; i > 0; --i) ring.push_back(polar(inner, from + i * step, height));
    for (int i = 0; i < side; ++i)
        ring.push_back(polar(mix(inner, outer, double(i) / side), from, height));
    for (int i = 0; i < arc / 2; ++i) ring.push_back(polar(outer, from + i * step, height));
    return ring;
}

void flange(ObjText& obj) {
    const double r = flange_radius, h = flange_height;
    obj.line("g flange\nusemtl steel\ns off");
    for (int s = 0; s < sectors; ++s)
        obj.band(sector_outline(s, boss_radius + fillet, r - chamfer, h), hole(s, h));

    // The underside: two concave polygons a sector, each around half of the hole.
    for (int s = 0; s < sectors; ++s) {
        const Ring outline = sector_outline(s, bore_radius + chamfer, r - chamfer, 0);
        const Ring around = hole(s, 0);
        // The straight sides lie between two polygons of one plane and need no points between.
        const auto corner_to_corner = [&](int first, int last) {
            Ring points;
            for (int i = first; i <= last; ++i) {
                const int k = i % hole_round;
                const bool on_side = (k > arc / 2 && k < arc / 2 + side) ||
                                     (k > hole_round - arc / 2 - side && k < hole_round - arc / 2);
                if (!on_side) points.push_back(outline[std::size_t(k)]);
            }
            return points;
        };
        for (int half = 0; half < 2; ++half) {
            const int first = half * hole_round / 2, last = first + hole_round / 2;
            Ring polygon = corner_to_corner(first, last);
            for (int i = last; i >= first; --i)
                polygon.push_back(around[std::size_t(i % hole_round)]);
            obj.face(Ring(polygon.rbegin(), polygon.rend()));  // seen from below
        }
    }
    obj.line("s 1");
    obj.band(circle(r, chamfer), circle(r, h - chamfer));
    obj.line("s 2");
    obj.band(circle(r - chamfer, 0), circle(r, chamfer));
    obj.line("s 3");
    obj.band(circle(r, h - chamfer), circle(r - chamfer, h));
    for (int s = 0; s < sectors; ++s) {
        obj.line("s " + std::to_string(10 + s));
        obj.band(hole(s, h), hole(s, 0));  // seen from inside
    }
}

void boss(ObjText& obj) {
    const double top = boss_height;
    obj.line("g boss\ns 4");  // the fillet runs into the wall without an edge
    constexpr int steps = 4;
    Ring below = circle(boss_radius + fillet, flange_height);
    for (int i = 1; i <= steps; ++i) {
        const double angle = pi / 2 * i / steps;
        const Ring above = circle(boss_radius + fillet * (1 - sine(angle)),
                                  flange_height + fillet * (1 - cosine(angle)));
        obj.band(below, above);
        below = above;
    }
    obj.band(below, circle(boss_radius, top - chamfer));
    obj.line("s 5");
    obj.band(circle(boss_radius, top - chamfer), circle(boss_radius - chamfer, top));
    obj.line("s off");
    obj.band(circle(boss_radius - chamfer, top), circle(bore_radius + chamfer, top));
    obj.line("g bore\ns 6");
    obj.band(circle(bore_radius + chamfer, top), circle(bore_radius, top - chamfer));
    obj.line("s 7");
    obj.band(circle(bore_radius, top - chamfer), circle(bore_radius, chamfer));
    obj.line("s 8");
    obj.band(circle(bore_radius, chamfer), circle(bore_radius + chamfer, 0));
}

// A solid of its own: a round washer under a hexagonal head with a bevelled top.
void bolt(ObjText& obj, int sector) {
    constexpr int washer_round = 24, per_side = washer_round / 6;
    const Point centre = hole_centre(sector);
    const double start = sector_middle(sector), low = flange_height + 0.01;
    const double washer_top = low + 0.05, head_top = washer_top + 0.22, bevel = 0.03;
    const auto ring = [&](double radius, double height, int count) {
        return circle(radius, height, count, centre, start);
    };
    obj.line("g bolt" + std::to_string(sector / 2 + 1) + "\nusemtl brass\ns off");
    const Ring bottom = ring(0.30, low, washer_round), rim = ring(0.30, washer_top, washer_round);
    obj.face(Ring(bottom.rbegin(), bottom.rend()));
    obj.line("s " + std::to_string(20 + sector));
    obj.band(bottom, rim);
    obj.line("s off");
    const Ring foot = ring(0.25, washer_top, 6), shoulder = ring(0.25, head_top - bevel, 6);
    const Ring crown = ring(0.25 - bevel, head_top, 6);
    for (int i = 0; i < 6; ++i) {  // what shows of the washer: heptagons
        Ring polygon{foot[std::size_t((i + 1) % 6)], foot[std::size_t(i)]};
        for (int k = 0; k <= per_side; ++k)
            polygon.push_back(rim[std::size_t((i * per_side + k) % washer_round)]);
        obj.face(polygon);
    }
    obj.band(foot, shoulder);
    obj.band(shoulder, crown);
    obj.face(crown);
}

}  // namespace

std::vector<File> machine_part() {
    ObjText obj;
    obj.line("o machine_part");
    flange(obj);
    boss(obj);
    for (int sector = 0; sector < sectors; sector += 2) bolt(obj, sector);
    const std::string mtl =
        "newmtl steel\nKa 1 1 1\nKd 0.36 0.39 0.43\nKs 0.55 0.55 0.55\nNs 60\nillum 2\n\n"
        "newmtl brass\nKa 1 1 1\nKd 0.62 0.43 0.14\nKs 0.70 0.55 0.25\nNs 90\nillum 2\n";
    return {{"machine_part/machine_part.obj",
             "# A flanged hub with three bolts; made by samples/generate_samples.\n"
             "mtllib machine_part.mtl\n" +
                 obj.text()},
            {"machine_part/machine_part.mtl", mtl}};
}

}  // namespace samples
