#include "formats/obj/tags.h"

#include <vector>

#include "text/scan.h"

namespace prep::detail {
namespace {

struct Tag {
    std::string_view name;
    std::vector<std::int64_t> ints;
    std::vector<double> floats;
};

// Counts that a line cannot hold are refused before anything is reserved for them.
std::string scan_tag(std::string_view text, Tag& tag) {
    LineScanner scan(text);
    tag.name = scan.word();
    scan.skip_blanks();
    std::int64_t counts[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k) {
        if (k > 0) {
            if (scan.peek() != '/') break;
            scan.advance();
        }
        if (!scan.integer(counts[k]) || counts[k] < 0 || counts[k] > std::int64_t(text.size()))
            return "expected counts such as 2/1/0 in the tag " + quoted_line(text);
    }
    for (std::int64_t k = 0; k < counts[0]; ++k) {
        std::int64_t value = 0;
        scan.skip_blanks();
        if (!scan.integer(value))
            return "expected " + std::to_string(counts[0]) + " integers in the tag " +
                   quoted_line(text);
        tag.ints.push_back(value);
    }
    for (std::int64_t k = 0; k < counts[1]; ++k) {
        double value = 0;
        if (!scan.number(value))
            return "expected " + std::to_string(counts[1]) + " numbers in the tag " +
                   quoted_line(text);
        tag.floats.push_back(value);
    }
    return {};
}

std::string out_of_range(const char* what, std::int64_t index, std::size_t count) {
    return std::string("the tag's ") + what + " " + std::to_string(index) +
           " is out of range: there are " + std::to_string(count);
}

}  // namespace

std::string read_obj_tag(std::string_view text, Mesh& mesh) {
    Tag tag;
    if (std::string problem = scan_tag(text, tag); !problem.empty()) return problem;
    SubdivisionTags& tags = mesh.subdivision;
    const auto sharpness = [&](std::size_t k) {
        return float(tag.floats[tag.floats.size() == 1 ? 0 : k]);
    };
    const auto check_vertices = [&]() -> std::string {
        for (const std::int64_t v : tag.ints)
            if (v < 0 || v >= std::int64_t(mesh.vertex_count()))
                return out_of_range("vertex", v, mesh.vertex_count());
        return {};
    };
    if (tag.name == "crease") {
        if (tag.ints.size() < 2 || tag.floats.empty())
            return "a crease needs two vertices and a sharpness, found " + quoted_line(text);
        if (std::string problem = check_vertices(); !problem.empty()) return problem;
        for (std::size_t k = 0; k + 1 < tag.ints.size(); ++k) {
            if (tag.floats.size() != 1 && k >= tag.floats.size()) break;
            tags.creases.push_back(
                {std::uint32_t(tag.ints[k]), std::uint32_t(tag.ints[k + 1]), sharpness(k)});
        }
    } else if (tag.name == "corner") {
        if (tag.ints.empty() || tag.floats.empty())
            return "a corner needs a vertex and a sharpness, found " + quoted_line(text);
        if (std::string problem = check_vertices(); !problem.empty()) return problem;
        for (std::size_t k = 0; k < tag.ints.size(); ++k) {
            if (tag.floats.size() != 1 && k >= tag.floats.size()) break;
            tags.corners.push_back({std::uint32_t(tag.ints[k]), sharpness(k)});
        }
    } else if (tag.name == "hole") {
        for (const std::int64_t f : tag.ints) {
            if (f < 0 || f >= std::int64_t(mesh.face_count()))
                return out_of_range("face", f, mesh.face_count());
            tags.holes.push_back(std::uint32_t(f));
        }
    } else if (tag.name == "interpolateboundary" && !tag.ints.empty()) {
        tags.interpolate_boundary = int(tag.ints[0]);
    } else if (tag.name == "facevaryinginterpolateboundary" && !tag.ints.empty()) {
        tags.face_varying_boundary = int(tag.ints[0]);
    }
    return {};
}

}  // namespace prep::detail
