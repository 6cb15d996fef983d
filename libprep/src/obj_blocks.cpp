#include "obj_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "text_scan.h"

namespace prep::detail {
namespace {

// Small enough that two threads share a 10 MB file evenly, large enough that merging costs nothing.
constexpr std::size_t block_size = std::size_t(1) << 21;

class BlockParser {
  public:
    BlockParser(std::string_view text, ObjBlock& block) : text_(text), block_(block) {}

    void run() {
        block_.positions.reserve(text_.size() / 96);
        const char* at = text_.data();
        const char* const end = at + text_.size();
        while (at != end && !block_.failure) {
            const char* line_end = find_line_end(at, end);
            const char* next = line_end == end ? end : line_end + 1;
            ++block_.lines;
            line_number_ = block_.lines;
            const char* last = line_end;
            if (last != at && last[-1] == '\r') --last;
            if (last != at && last[-1] == '\\') {
                next = join_continued(at, end);
                statement(joined_.data(), joined_.data() + joined_.size());
            } else {
                statement(at, last);
            }
            at = next;
        }
    }

  private:
    static const char* find_line_end(const char* at, const char* end) {
        const void* found = std::memchr(at, '\n', std::size_t(end - at));
        return found ? static_cast<const char*>(found) : end;
    }

    const char* join_continued(const char* at, const char* end) {
        joined_.clear();
        for (;;) {
            const char* line_end = find_line_end(at, end);
            const char* last = line_end;
            if (last != at && last[-1] == '\r') --last;
            const bool continued = last != at && last[-1] == '\\';
            joined_.append(at, continued ? last - 1 : last);
            const char* next = line_end == end ? end : line_end + 1;
            if (!continued || next == end) return next;
            joined_ += ' ';
            at = next;
            ++block_.lines;
        }
    }

    void fail(std::string text, const char* begin, const char* end) {
        block_.failure =
            ObjBlock::Failure{line_number_, std::move(text) + " in " +
                                                quoted_line({begin, std::size_t(end - begin)})};
    }

    void statement(const char* begin, const char* end) {
        LineScanner scan(begin, end);
        scan.skip_blanks();
        const char first = scan.peek();
        if (first == '\0' || first == '#') return;
        const std::string_view word = scan.word();
        if (word == "v") return position(scan, begin, end);
        if (word == "vt") return texture(scan, begin, end);
        if (word == "vn") return normal(scan, begin, end);
        if (word == "f" || word == "fo") return element(scan, begin, end, block_.faces, 3);
        if (word == "l") return element(scan, begin, end, block_.polylines, 2);
        if (word == "p") return element(scan, begin, end, block_.points, 1);
        if (word == "usemtl") return event(ObjEvent::Kind::material, scan);
        if (word == "g") return event(ObjEvent::Kind::group, scan);
        if (word == "o") return event(ObjEvent::Kind::object, scan);
        if (word == "mtllib") return event(ObjEvent::Kind::library, scan);
        if (word == "s") return smoothing(scan, begin, end);
        if (word == "t") {
            block_.tags.push_back({line_number_, std::string(scan.rest())});
            return;
        }
        other(word);
    }

    // Statements of the format that have no place in a polygon mesh, and words that are none of it.
    void other(std::string_view word) {
        static constexpr std::string_view free_form[] = {
            "vp",   "deg",  "bmat", "step", "cstype", "curv",  "curv2", "surf",  "parm", "trim",
            "hole", "scrv", "sp",   "end",  "con",    "bevel", "mg",    "ctech", "stech"};
        static constexpr std::string_view ignored[] = {"c_interp",   "d_interp",  "lod",
                                                       "shadow_obj", "trace_obj", "maplib",
                                                       "usemap",     "call",      "csh"};
        if (std::find(std::begin(free_form), std::end(free_form), word) != std::end(free_form)) {
            if (block_.free_form++ == 0) block_.free_form_line = line_number_;
        } else if (std::find(std::begin(ignored), std::end(ignored), word) == std::end(ignored)) {
            if (block_.unknown++ == 0) {
                block_.unknown_line = line_number_;
                block_.unknown_word = quoted_line(word.substr(0, 24));
            }
        }
    }

    void note_finite(bool finite) {
        if (!finite && block_.non_finite++ == 0) block_.non_finite_line = line_number_;
    }

    void position(LineScanner& scan, const char* begin, const char* end) {
        double x[7];
        int count = 0;
        while (count < 7 && !scan.at_end()) {
            if (!scan.number(x[count]))
                return fail("expected a number (coordinate " + std::to_string(count + 1) + ")",
                            begin, end);
            ++count;
        }
        if (count < 3) return fail("expected three coordinates", begin, end);
        glm::dvec3 p(x[0], x[1], x[2]);
        // 3: xyz, 4: xyzw, 6: xyz rgb, 7: xyzw rgb. Rational weights divide.
        if ((count == 4 || count == 7) && x[3] != 0 && x[3] != 1) p /= x[3];
        note_finite(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
        block_.positions.push_back(p);
        if (count >= 6) {
            const double* c = x + (count == 7 ? 4 : 3);
            block_.colors.resize(block_.positions.size() - 1, glm::vec4(1.0f));
            block_.colors.push_back(glm::vec4(glm::vec3(glm::dvec3(c[0], c[1], c[2])), 1.0f));
        } else if (!block_.colors.empty()) {
            block_.colors.push_back(glm::vec4(1.0f));
        }
    }

    void texture(LineScanner& scan, const char* begin, const char* end) {
        double u = 0, v = 0;
        if (!scan.number(u)) return fail("expected a number", begin, end);
        if (!scan.at_end() && !scan.number(v)) return fail("expected a number", begin, end);
        note_finite(std::isfinite(u) && std::isfinite(v));
        block_.uvs.push_back({float(u), float(1.0 - v)});
    }

    void normal(LineScanner& scan, const char* begin, const char* end) {
        double x = 0, y = 0, z = 0;
        if (!scan.number(x) || !scan.number(y) || !scan.number(z))
            return fail("expected three numbers", begin, end);
        block_.normals.push_back({float(x), float(y), float(z)});
    }

    bool index(LineScanner& scan, std::size_t local_count, ObjIndex& out) {
        std::int64_t value = 0;
        if (!scan.integer(value)) return false;
        if (value == 0 || value > max_obj_index || value < -max_obj_index) return false;
        out = value > 0 ? ObjIndex(value)
                        : ObjIndex(-(std::int64_t(local_count) + value + relative_bias));
        return true;
    }

    void element(LineScanner& scan, const char* begin, const char* end, ObjElements& to,
                 std::size_t least) {
        const std::size_t first = to.corners.size();
        while (!scan.at_end()) {
            if (scan.peek() == '#') break;
            ObjCorner corner;
            bool good = index(scan, block_.positions.size(), corner.v);
            if (good && scan.peek() == '/') {
                scan.advance();
                if (scan.peek() != '/' && scan.peek() != '\0' && !is_blank(scan.peek()))
                    good = index(scan, block_.uvs.size(), corner.t);
                if (good && scan.peek() == '/') {
                    scan.advance();
                    if (scan.peek() != '\0' && !is_blank(scan.peek()))
                        good = index(scan, block_.normals.size(), corner.n);
                }
            }
            if (!good || (scan.peek() != '\0' && !is_blank(scan.peek())))
                return fail(
                    "expected v, v/vt, v//vn or v/vt/vn with indices from 1 to 2^30 - 1 "
                    "(or negative, counting back)",
                    begin, end);
            to.corners.push_back(corner);
        }
        if (to.corners.size() - first < least) {
            to.corners.resize(first);
            if (block_.short_faces++ == 0) block_.short_face_line = line_number_;
            return;
        }
        to.ends.push_back(std::uint32_t(to.corners.size()));
        to.lines.push_back(line_number_);
    }

    void event(ObjEvent::Kind kind, LineScanner& scan) {
        block_.events.push_back({kind, std::uint32_t(block_.faces.ends.size()), line_number_,
                                 std::string(scan.rest()), 0});
    }

    void smoothing(LineScanner& scan, const char* begin, const char* end) {
        const std::string_view word = scan.word();
        std::uint32_t group = 0;
        if (word == "on") {
            group = 1;
        } else if (word != "off" && !word.empty()) {
            const auto [after, error] =
                std::from_chars(word.data(), word.data() + word.size(), group);
            if (error != std::errc{} || after != word.data() + word.size())
                return fail("expected a smoothing group number, on or off", begin, end);
        }
        block_.events.push_back({ObjEvent::Kind::smoothing,
                                 std::uint32_t(block_.faces.ends.size()),
                                 line_number_,
                                 {},
                                 group});
    }

    std::string_view text_;
    ObjBlock& block_;
    std::uint32_t line_number_ = 0;
    std::string joined_;
};

}  // namespace

std::vector<std::size_t> obj_block_starts(std::string_view text) {
    std::vector<std::size_t> starts{0};
    for (;;) {
        const std::size_t at = starts.back() + block_size;
        std::size_t line_end = at < text.size() ? text.find('\n', at) : std::string_view::npos;
        while (line_end != std::string_view::npos) {
            std::size_t last = line_end;
            if (last > 0 && text[last - 1] == '\r') --last;
            if (last == 0 || text[last - 1] != '\\') break;
            line_end = text.find('\n', line_end + 1);
        }
        if (line_end == std::string_view::npos || line_end + 1 >= text.size()) break;
        starts.push_back(line_end + 1);
    }
    return starts;
}

ObjBlock parse_obj_block(std::string_view text) {
    ObjBlock block;
    BlockParser(text, block).run();
    return block;
}

}  // namespace prep::detail
