#include <algorithm>

#include "base/srgb.h"
#include "formats/face_colors.h"
#include "formats/loose_points.h"
#include "formats/off/off.h"
#include "prep/mesh.h"
#include "text/line_ends.h"
#include "text/scan.h"

namespace prep {
namespace {

using detail::LineScanner;

// Lines that hold something, comments cut off.
class Lines {
  public:
    explicit Lines(std::string_view text) : text_(text) {}
    bool next(std::string_view& line) {
        while (!text_.empty()) {
            const std::size_t end = std::min(text_.find('\n'), text_.size());
            line = text_.substr(0, end);
            text_.remove_prefix(std::min(end + 1, text_.size()));
            ++number_;
            line = line.substr(0, std::min(line.find('#'), line.size()));
            if (!LineScanner(line).at_end()) return true;
        }
        return false;
    }
    std::size_t number() const { return number_; }
    // Geomview reads numbers wherever lines end: where another is due, the next line may have it.
    // `line` is then that one.
    bool goes_on(LineScanner& scan, std::string_view& line) {
        if (!scan.at_end()) return true;
        if (!next(line)) return false;
        scan = LineScanner(line);
        if (!first_wrapped_) first_wrapped_ = number_;
        return true;
    }
    // The first line that began amid the numbers of a vertex or a face; 0: none did.
    std::size_t first_wrapped() const { return first_wrapped_; }
    std::size_t bytes_left() const { return text_.size(); }

  private:
    std::string_view text_;
    std::size_t number_ = 0, first_wrapped_ = 0;
};

struct Header {
    bool st = false, c = false, n = false, four = false;
    std::int64_t vertices = 0, faces = 0;
};

class OffParser {
  public:
    OffParser(std::string_view text, const std::string& name) : lines_(text), name_(name) {}

    Result<Scene> run() {
        if (auto done = header(); !done) return std::move(done).error();
        scene_.name = name_;
        scene_.meshes.emplace_back();
        Mesh& mesh = scene_.meshes.back();
        mesh.name = std::filesystem::path(name_).stem().string();
        if (auto done = vertices(mesh); !done) return std::move(done).error();
        if (auto done = faces(mesh); !done) return std::move(done).error();
        if (header_.c) colors(mesh);
        instance_unused_meshes(scene_);
        return std::move(scene_);
    }

  private:
    Error fail(const std::string& what, std::string_view line,
               ErrorCode code = ErrorCode::syntax) const {
        return {code, what + (line.empty() ? "" : " in " + detail::quoted_line(line)),
                name_ + ":" + std::to_string(lines_.number())};
    }

    Result<void> header() {
        std::string_view line;
        if (!lines_.next(line)) return fail("the file is empty", "");
        LineScanner scan(line);
        LineScanner probe = scan;
        std::string_view magic = probe.word();
        if (magic.ends_with("OFF")) {
            scan = probe;
            magic.remove_suffix(3);
            if (magic.starts_with("ST")) header_.st = true, magic.remove_prefix(2);
            if (magic.starts_with("C")) header_.c = true, magic.remove_prefix(1);
            if (magic.starts_with("N")) header_.n = true, magic.remove_prefix(1);
            if (magic.starts_with("4")) header_.four = true, magic.remove_prefix(1);
            if (!magic.empty())
                return fail("only the prefixes ST, C, N and 4 of OFF are supported", line,
                            ErrorCode::unsupported);
            LineScanner after = scan;
            if (after.word() == "BINARY")
                return fail("binary OFF is not supported: save it as text", line,
                            ErrorCode::unsupported);
            if (scan.at_end()) {
                if (!lines_.next(line)) return fail("the file ends after its first line", "");
                scan = LineScanner(line);
            }
        }
        std::int64_t edges = 0;
        scan.skip_blanks();
        bool good = scan.integer(header_.vertices) && lines_.goes_on(scan, line) &&
                    scan.integer(header_.faces);
        // The number of edges may be missing; alone in a line, it is no vertex.
        const Lines before = lines_;
        const bool one_line = !lines_.first_wrapped();
        if (good && !scan.at_end())
            good = scan.integer(edges);
        else if (good && !one_line && lines_.goes_on(scan, line) &&
                 !(scan.integer(edges) && scan.at_end()))
            lines_ = before;
        if (!good || header_.vertices < 0 || header_.faces < 0)
            return fail("expected OFF and the numbers of vertices, faces and edges", line);
        // A vertex takes at least 6 bytes of text ("0 0 0\n"), a face 2.
        const std::size_t left = lines_.bytes_left() + 1;
        if (std::size_t(header_.vertices) > left / 6 + 1 ||
            std::size_t(header_.faces) > left / 2 + 1)
            return fail("the header announces " + std::to_string(header_.vertices) +
                            " vertices and " + std::to_string(header_.faces) +
                            " faces, more than the file has room for",
                        "");
        if (std::size_t(header_.vertices) >= no_index)
            return fail("more than 2^32 - 2 vertices", "", ErrorCode::limit);
        return {};
    }

    Result<void> vertices(Mesh& mesh) {
        std::vector<glm::dvec3> positions;
        positions.reserve(std::size_t(header_.vertices));
        std::string_view line;
        bool beyond = false;
        for (std::int64_t v = 0; v < header_.vertices; ++v) {
            if (!lines_.next(line))
                return fail("the file ends after " + std::to_string(v) + " of " +
                                std::to_string(header_.vertices) + " vertices",
                            "");
            LineScanner scan(line);
            glm::dvec3 p, n(0.0);
            double w = 1;
            const std::size_t began = lines_.number();
            const auto number = [&](double& to) {
                return lines_.goes_on(scan, line) && scan.number(to);
            };
            bool good = number(p.x) && number(p.y) && number(p.z);
            if (good && header_.four) {
                good = number(w);
                if (good && w != 0 && w != 1) p /= w;
            }
            if (good && header_.n) {
                good = number(n.x) && number(n.y) && number(n.z);
                normals_.push_back(glm::vec3(n));
            }
            // A vertex that has too few must not take of the next one's.
            const bool wrapped = lines_.number() != began;
            if (!good) return fail("expected coordinates", line);
            int of_color = 0;
            if (header_.c) of_color = color(scan, header_.st ? 2 : 0, colors_.emplace_back());
            glm::dvec2 uv(0.0);
            if (header_.st && !scan.at_end()) {
                if (!scan.number(uv.x) || !scan.number(uv.y))
                    return fail("expected texture coordinates", line);
            }
            if (wrapped && (!scan.at_end() || of_color == 1 || of_color == 2))
                return fail("expected coordinates", line);
            if (header_.st) uvs_.push_back({float(uv.x), float(1.0 - uv.y)});
            beyond |= !scan.at_end();
            positions.push_back(p);
        }
        if (beyond)
            scene_.warnings.push_back(
                name_ +
                ": what stands behind the values of vertices was left out: colours are of "
                "COFF files, normals of NOFF, UVs of STOFF");
        set_positions(mesh, positions);
        return {};
    }

    static int words_left(LineScanner scan) {
        int words = 0;
        for (; !scan.at_end(); scan.word()) ++words;
        return words;
    }

    // As it stands in the file.
    struct Color {
        glm::vec4 values{1.0f};
        int count = 0;
        bool whole = false;  // whole numbers
    };

    // Three or four numbers before the last `others`. Says how many there were.
    static int color(LineScanner& scan, int others, Color& to) {
        const int most = std::clamp(words_left(scan) - others, 0, 4);
        bool whole = true;
        while (to.count < most) {
            LineScanner probe = scan;
            double value = 0;
            if (!scan.number(value)) break;
            to.values[to.count++] = float(value);
            whole =
                whole && probe.word().find_first_not_of("+0123456789") == std::string_view::npos;
        }
        to.whole = whole && to.count > 0;
        return to.count;
    }

    // Whole numbers are 0 … 255 where one of the list is above 1. Else they are what programs write
    // of 0.0 and 1.0.
    static std::vector<glm::vec4> linear(const std::vector<Color>& colors) {
        const bool bytes = std::any_of(colors.begin(), colors.end(), [](const Color& color) {
            const glm::vec4& c = color.values;
            return color.whole && std::max({c.r, c.g, c.b, c.a}) > 1;
        });
        std::vector<glm::vec4> out;
        out.reserve(colors.size());
        for (const Color& color : colors) {
            glm::dvec4 c(color.values);
            if (bytes && color.whole) {
                for (int k = 0; k < std::min(color.count, 3); ++k)
                    c[k] = detail::srgb_to_linear(c[k] / 255);
                if (color.count == 4) c.a /= 255;
            }
            out.emplace_back(c);
        }
        return out;
    }

    Result<void> faces(Mesh& mesh) {
        std::string_view line;
        for (std::int64_t f = 0; f < header_.faces; ++f) {
            if (!lines_.next(line))
                return fail("the file ends after " + std::to_string(f) + " of " +
                                std::to_string(header_.faces) + " faces" +
                                (lines_.first_wrapped()
                                     ? "; line " + std::to_string(lines_.first_wrapped()) +
                                           " was read as the rest of the one before"
                                     : ""),
                            "");
            if (auto done = face(mesh, line); !done) return done;
        }
        if (lines_.first_wrapped() && lines_.next(line))
            return fail("the file goes on after its faces; line " +
                            std::to_string(lines_.first_wrapped()) +
                            " was read as the rest of the one before",
                        line);
        tell_of_faces();
        if (!face_colors_.empty()) detail::set_face_colors(mesh, linear(face_colors_));
        attach_vertex_values(mesh);
        return {};
    }

    // Of two corners: a line; of fewer: nothing.
    Result<void> face(Mesh& mesh, std::string_view line) {
        LineScanner scan(line);
        scan.skip_blanks();
        std::int64_t corners = 0;
        if (!scan.integer(corners) || corners < 0)
            return fail("expected a number of corners", line);
        const std::size_t first = mesh.corner_vertices.size(), began = lines_.number();
        if (auto done = face_vertices(mesh, corners, scan, line); !done) return done;
        // One number alone would be an index into a list that is not in the file.
        Color face_color;
        const bool more = !scan.at_end();
        // A face that has too few may have taken of the next one's.
        if (more && lines_.number() != began && doubtful_face_ == 0)
            doubtful_face_ = lines_.number();
        const bool colored = more && !header_.c && corners >= 3 && color(scan, 0, face_color) >= 3;
        skipped_face_values_ |= more && !colored;
        if (mesh.corner_vertices.size() >= no_index)
            return fail("more than 2^32 - 2 corners", "", ErrorCode::limit);
        if (corners == 2) {
            for (std::size_t k = first; k < first + 2; ++k)
                mesh.line_vertices.push_back(mesh.corner_vertices[k]);
            mesh.line_offsets.push_back(std::uint32_t(mesh.line_vertices.size()));
        }
        if (corners < 3) {
            short_faces_ += corners != 2;
            mesh.corner_vertices.resize(first);
            return {};
        }
        if (colored) {
            face_colors_.resize(mesh.face_count());
            face_colors_.push_back(face_color);
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        return {};
    }

    Result<void> face_vertices(Mesh& mesh, std::int64_t corners, LineScanner& scan,
                               std::string_view& line) {
        for (std::int64_t k = 0; k < corners; ++k) {
            std::int64_t v = 0;
            if (!lines_.goes_on(scan, line) || !scan.integer(v))
                return fail("expected " + std::to_string(corners) + " vertex indices", line);
            if (v < 0 || v >= header_.vertices)
                return fail("vertex index " + std::to_string(v) +
                                " is out of range: the file has " +
                                std::to_string(header_.vertices),
                            line, ErrorCode::invalid);
            mesh.corner_vertices.push_back(std::uint32_t(v));
        }
        return {};
    }

    void tell_of_faces() {
        if (doubtful_face_ > 0)
            scene_.warnings.push_back(name_ + ":" + std::to_string(doubtful_face_) +
                                      ": read as the rest of the face before, and what is left of "
                                      "it as its colour");
        if (short_faces_)
            scene_.warnings.push_back(name_ + ": " + std::to_string(short_faces_) +
                                      " faces with fewer than two corners were dropped");
        if (skipped_face_values_)
            scene_.warnings.push_back(
                name_ + (header_.c ? ": colours of faces were skipped: vertices have their own"
                                   : ": colours that are numbers of a list, or of lines, were "
                                     "skipped"));
    }

    void attach_vertex_values(Mesh& mesh) {
        if (mesh.face_count() == 0) {  // nothing to hang normals and UVs on
            if ((header_.n || header_.st) && !mesh.positions.empty())
                scene_.warnings.push_back(name_ +
                                          detail::values_of_points_left_out(header_.n, header_.st));
            if (mesh.line_vertices.empty())
                for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) mesh.points.push_back(v);
            return;
        }
        if (header_.n) {
            mesh.normals.values = std::move(normals_);
            mesh.normals.indices = mesh.corner_vertices;
        }
        if (header_.st) {
            mesh.uvs.emplace_back();
            mesh.uvs[0].values = std::move(uvs_);
            mesh.uvs[0].indices = mesh.corner_vertices;
        }
    }

    void colors(Mesh& mesh) {
        std::vector<glm::vec4> values = linear(colors_);
        if (mesh.corner_count() == 0 || !mesh.line_vertices.empty()) mesh.vertex_colors = values;
        if (mesh.corner_count() == 0) return;
        mesh.colors.emplace_back();
        mesh.colors[0].values = std::move(values);
        mesh.colors[0].indices = mesh.corner_vertices;
    }

    Lines lines_;
    const std::string& name_;
    Header header_;
    Scene scene_;
    std::vector<glm::vec3> normals_;
    std::vector<glm::vec2> uvs_;
    std::vector<Color> colors_;
    std::vector<Color> face_colors_;  // empty, or of the faces up to the last with one
    bool skipped_face_values_ = false;
    std::uint64_t short_faces_ = 0;
    std::size_t doubtful_face_ = 0;  // a line
};

}  // namespace

Result<Scene> parse_off(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text = detail::without_byte_order_mark(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (detail::ends_lines_with_cr(text))
        return OffParser(detail::with_line_feeds(text), name).run();
    return OffParser(text, name).run();
}

}  // namespace prep
