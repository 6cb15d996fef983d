#include "formats/obj/blocks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>

#include "base/finite.h"
#include "base/parallel.h"
#include "text/digits.h"
#include "text/scan.h"

namespace prep::detail {
namespace {

// Small enough that a block's text and indices stay in a core's cache and two threads share a
// 10 MB file evenly; large enough that merging costs nothing.
constexpr std::size_t block_size = std::size_t(1) << 20;

// What a thread parses into, block after block: memory that has been touched is not given back
// before all is done. A corner takes at least two characters, so nothing needs to grow.
struct Scratch {
    std::unique_ptr<char[]> text;
    std::unique_ptr<ObjIndex[]> v, t, n;
    std::size_t capacity = 0;

    void reserve(std::size_t bytes) {
        if (bytes <= capacity) return;
        capacity = bytes;
        // Not set to zero: memory that is not used is not touched.
        text.reset(new char[bytes + padding]);
        for (auto* list : {&v, &t, &n}) list->reset(new ObjIndex[bytes / 2 + 1]);
    }
    // A line end behind the last line, and what digit_run() may look at.
    static constexpr std::size_t padding = 32;
};

class ScratchPool {
  public:
    std::unique_ptr<Scratch> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) return std::make_unique<Scratch>();
        auto scratch = std::move(free_.back());
        free_.pop_back();
        return scratch;
    }
    void give(std::unique_ptr<Scratch> scratch) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(scratch));
    }

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<Scratch>> free_;
};

class BlockParser {
  public:
    BlockParser(Scratch& scratch, std::size_t size, const glm::dvec3& origin, ObjBlock& block)
        : scratch_(scratch), size_(size), origin_(origin), block_(block) {}

    void run() {
        std::memset(scratch_.text.get() + size_, 0, Scratch::padding);
        scratch_.text[size_] = '\n';
        const char* at = scratch_.text.get();
        const char* const end = at + size_;
        // Lines of one kind come together; memory that is only reserved costs nothing.
        if (size_ > 1 && at[0] == 'v') {
            if (at[1] == ' ') block_.positions.reserve(size_ / 24);
            if (at[1] == 't') block_.uvs.reserve(size_ / 20);
            if (at[1] == 'n') block_.normals.reserve(size_ / 24);
        }
        while (at < end && !block_.failure) {
            line_number_ = ++block_.lines;
            if (!usual(at)) at = any_line(at, end);
        }
        take_corners();
    }

  private:
    // Lines as nearly all are, read without looking for their ends first. False, with nothing
    // changed, for all others.
    bool usual(const char*& at) {
        switch (at[0]) {
            case 'f':
                return at[1] == ' ' && usual_face(at);
            case 'v':
                if (at[1] == ' ') return usual_position(at);
                if (at[1] == 't' && at[2] == ' ') return usual_texture(at);
                if (at[1] == 'n' && at[2] == ' ') return usual_normal(at);
                return false;
            default:
                return false;
        }
    }

    static bool line_ends(const char*& at) {
        while (*at == ' ') ++at;
        if (at[0] == '\r' && at[1] == '\n') ++at;
        if (*at != '\n') return false;
        ++at;
        return true;
    }

    template <int count>
    static bool usual_numbers(const char*& at, double (&x)[count]) {
        for (double& value : x) {
            if (*at != ' ') return false;
            while (*at == ' ') ++at;
            if (!plain_decimal(at, value)) return false;
        }
        return line_ends(at);
    }

    bool usual_position(const char*& at) {
        const char* p = at + 1;
        double x[3];
        if (!usual_numbers(p, x)) return false;
        at = p;
        add_position({x[0], x[1], x[2]});
        if (!block_.colors.empty()) block_.colors.push_back(no_color);
        return true;
    }

    bool usual_texture(const char*& at) {
        const char* p = at + 2;
        double x[2];
        if (!usual_numbers(p, x)) return false;
        at = p;
        block_.uvs.push_back({float(x[0]), float(1.0 - x[1])});
        return true;
    }

    bool usual_normal(const char*& at) {
        const char* p = at + 2;
        double x[3];
        if (!usual_numbers(p, x)) return false;
        at = p;
        block_.normals.push_back({float(x[0]), float(x[1]), float(x[2])});
        return true;
    }

    // Positive indices, blanks between them, at least three corners.
    bool usual_face(const char*& at) {
        ObjIndex* const v = scratch_.v.get();
        ObjIndex* const t = scratch_.t.get();
        ObjIndex* const n = scratch_.n.get();
        std::size_t corner = corners_;
        std::uint32_t any_t = 0, any_n = 0;
        const char* p = at + 1;
        for (;;) {
            const bool blank = *p == ' ';
            if (line_ends(p)) break;
            const std::uint32_t index = blank ? positive_integer(p, max_obj_index) : 0;
            if (index == 0) return false;
            std::uint32_t texture = 0, normal = 0;
            if (*p == '/') {
                ++p;
                if (*p != '/' && (texture = positive_integer(p, max_obj_index)) == 0) return false;
                if (*p == '/' && (normal = positive_integer(++p, max_obj_index)) == 0) return false;
            }
            v[corner] = ObjIndex(index);
            t[corner] = ObjIndex(texture);
            n[corner] = ObjIndex(normal);
            any_t |= texture;
            any_n |= normal;
            ++corner;
        }
        if (corner - corners_ < 3) return false;
        block_.faces.close(std::uint32_t(corner - corners_), line_number_);
        corners_ = corner;
        any_t_ |= any_t != 0;
        any_n_ |= any_n != 0;
        at = p;
        return true;
    }

    void take_corners() {
        ObjElements& faces = block_.faces;
        faces.v.assign(scratch_.v.get(), scratch_.v.get() + corners_);
        if (any_t_) faces.t.assign(scratch_.t.get(), scratch_.t.get() + corners_);
        if (any_n_) faces.n.assign(scratch_.n.get(), scratch_.n.get() + corners_);
    }

    const char* any_line(const char* at, const char* end) {
        const char* line_end = find_line_end(at, end);
        const char* last = line_end;
        if (last != at && last[-1] == '\r') --last;
        if (last != at && last[-1] == '\\' && !is_comment(at, last)) {
            const char* next = join_continued(at, end);
            statement(joined_.data(), joined_.data() + joined_.size());
            return next;
        }
        statement(at, last);
        return line_end == end ? end : line_end + 1;
    }

    // A path at its end ("# exported to C:\\") joins no line.
    static bool is_comment(const char* at, const char* end) {
        while (at != end && is_blank(*at)) ++at;
        return at != end && *at == '#';
    }

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
        LineScanner named(begin, end);
        named.skip_blanks();
        if (named.at_end() || named.peek() == '#') return;
        const std::string_view word = named.word();
        if (word == "usemtl") return event(ObjEvent::Kind::material, named);
        if (word == "g") return event(ObjEvent::Kind::group, named);
        if (word == "o") return event(ObjEvent::Kind::object, named);
        if (word == "mtllib") return event(ObjEvent::Kind::library, named);
        numbers(word.substr(0, word.find('#')), begin, end);
    }

    static const char* comment_begin(const char* begin, const char* end) {
        const char* at = std::find(begin, end, '#');
        while (at != end && at != begin && at[-1] == '.' &&
               names_no_number({at, std::size_t(end - at)}))
            at = std::find(at + 1, end, '#');
        return at;
    }

    // A comment runs from # to the end of any line, but for that of "1.#QNAN". Only names go to the
    // end of their line with every #: exporters write such ("Material #25"), and the reader of
    // names looks for the one without the comment where that with it is unknown.
    void numbers(std::string_view word, const char* begin, const char* end) {
        LineScanner scan(begin, comment_begin(begin, end));
        scan.word();
        if (word == "v") return position(scan, begin, end);
        if (word == "vt") return texture(scan, begin, end);
        if (word == "vn") return normal(scan, begin, end);
        if (word == "f" || word == "fo") return face(scan, begin, end);
        if (word == "l") return element(scan, begin, end, block_.polylines, 2);
        if (word == "p") return element(scan, begin, end, block_.points, 1);
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
        static constexpr std::string_view ignored[] = {
            "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj", "maplib", "usemap"};
        if (std::find(std::begin(free_form), std::end(free_form), word) != std::end(free_form)) {
            block_.free_form.note(line_number_);
        } else if (std::find(std::begin(ignored), std::end(ignored), word) == std::end(ignored)) {
            if (word.find('\0') != std::string_view::npos)
                return fail("a zero byte: this is no OBJ text (binary, or UTF-16)", word.data(),
                            word.data() + word.size());
            if (block_.unknown.count == 0) block_.unknown_word = quoted_line(word.substr(0, 24));
            block_.unknown.note(line_number_);
        }
    }

    void note_finite(bool finite) {
        if (!finite) block_.non_finite.note(line_number_);
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
        note_finite(is_finite(p));
        add_position(p);
        if (count >= 6) {
            const double* c = x + (count == 7 ? 4 : 3);
            block_.colors.resize(block_.positions.size() - 1, no_color);
            block_.colors.push_back(glm::vec4(glm::vec3(glm::dvec3(c[0], c[1], c[2])), 1.0f));
        } else if (!block_.colors.empty()) {
            block_.colors.push_back(no_color);
        }
    }

    void add_position(const glm::dvec3& p) {
        block_.bounds.add(p);
        block_.positions.push_back(glm::vec3(p - origin_));
    }

    void texture(LineScanner& scan, const char* begin, const char* end) {
        double u = 0, v = 0;
        if (!scan.number(u)) return fail("expected a number", begin, end);
        if (!scan.at_end() && !scan.number(v)) return fail("expected a number", begin, end);
        note_finite(std::isfinite(u) && std::isfinite(v));
        double w = 0;
        if (scan.number(w) && w != 0) block_.third_uvs.note(line_number_);
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

    struct Corner {
        ObjIndex v = 0, t = 0, n = 0;
    };

    // The line's corners into line_corners_; false after a failure or a drop.
    bool corners(LineScanner& scan, const char* begin, const char* end, std::size_t least) {
        line_corners_.clear();
        while (!scan.at_end()) {
            Corner corner;
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
            if (!good || (scan.peek() != '\0' && !is_blank(scan.peek()))) {
                fail(
                    "expected v, v/vt, v//vn or v/vt/vn with indices from 1 to 2^30 - 1 "
                    "(or negative, counting back)",
                    begin, end);
                return false;
            }
            line_corners_.push_back(corner);
        }
        if (line_corners_.size() >= least) return true;
        block_.short_faces.note(line_number_);
        return false;
    }

    void face(LineScanner& scan, const char* begin, const char* end) {
        if (!corners(scan, begin, end, 3)) return;
        for (const Corner& corner : line_corners_) {
            scratch_.v[corners_] = corner.v;
            scratch_.t[corners_] = corner.t;
            scratch_.n[corners_] = corner.n;
            ++corners_;
            any_t_ |= corner.t != 0;
            any_n_ |= corner.n != 0;
            block_.faces.relative |= corner.v < 0 || corner.t < 0 || corner.n < 0;
        }
        block_.faces.close(std::uint32_t(line_corners_.size()), line_number_);
    }

    void element(LineScanner& scan, const char* begin, const char* end, ObjElements& to,
                 std::size_t least) {
        if (!corners(scan, begin, end, least)) return;
        bool uvs = false;
        for (const Corner& corner : line_corners_) {
            to.v.push_back(corner.v);
            uvs |= corner.t != 0;
        }
        if (uvs) block_.loose_uvs.note(line_number_);
        (block_.any_material ? block_.loose_materials : block_.loose_before).note(line_number_);
        to.close(std::uint32_t(line_corners_.size()), line_number_);
    }

    void event(ObjEvent::Kind kind, LineScanner& scan) {
        block_.any_material |= kind == ObjEvent::Kind::material;
        block_.events.push_back(
            {kind, block_.faces.count, line_number_, std::string(scan.rest()), 0});
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
        block_.events.push_back(
            {ObjEvent::Kind::smoothing, block_.faces.count, line_number_, {}, group});
    }

    Scratch& scratch_;
    std::size_t size_;
    glm::dvec3 origin_;
    ObjBlock& block_;
    std::uint32_t line_number_ = 0;
    std::size_t corners_ = 0;  // of faces, in the scratch
    bool any_t_ = false, any_n_ = false;
    std::string joined_;
    std::vector<Corner> line_corners_;
};

// Where each block begins: behind the first line end after a multiple of the block size that no
// continuation joins to the next line. One more than there are blocks. Empty when reading failed.
std::vector<std::size_t> block_starts(const ObjSource& source) {
    constexpr std::size_t piece = 4096;
    const std::size_t size = source.size();
    char text[piece + 2];
    std::vector<std::size_t> starts{0};
    if (size >= 3) {
        if (!source.read(0, 3, text)) return {};
        if (std::string_view(text, 3) == "\xef\xbb\xbf") starts[0] = 3;  // byte order mark
    }
    for (std::size_t at = starts[0] + block_size; at < size;) {
        // Two characters more in front, to see a continuation.
        const std::size_t from = at - 2, to = std::min(size, at + piece);
        if (!source.read(from, to, text)) return {};
        std::size_t found = 0;
        for (std::size_t i = 2; i < to - from && !found; ++i) {
            if (text[i] != '\n') continue;
            const char before = text[i - 1] == '\r' ? text[i - 2] : text[i - 1];
            if (before != '\\') found = from + i + 1;
        }
        if (found == 0) {
            at = to;
        } else {
            if (found < size) starts.push_back(found);
            at = found + block_size;
        }
    }
    starts.push_back(size);
    return starts;
}

}  // namespace

std::uint32_t ObjElements::line_of_corner(std::size_t corner) const {
    std::size_t element = 0;
    for (std::size_t r = 0; r < sizes.size(); ++r) {
        const std::size_t end = r + 1 < sizes.size() ? sizes[r + 1].element : count;
        const std::size_t corners = (end - sizes[r].element) * sizes[r].value;
        if (corner < corners) {
            element = sizes[r].element + corner / sizes[r].value;
            break;
        }
        corner -= corners;
    }
    const auto after =
        std::upper_bound(lines.begin(), lines.end(), element,
                         [](std::size_t e, const Run& run) { return e < run.element; });
    const Run& run = after[-1];
    return run.value + std::uint32_t(element - run.element);
}

Result<std::vector<ObjBlock>> parse_obj_blocks(const ObjSource& source, const std::string& name,
                                               int threads, const glm::dvec3& origin) {
    const Error unreadable{ErrorCode::io, "cannot read the file to its end", name};
    const std::vector<std::size_t> starts = block_starts(source);
    if (starts.empty()) return unreadable;
    std::vector<ObjBlock> blocks(starts.size() - 1);
    std::vector<char> unread(blocks.size(), 0);
    ScratchPool pool;
    parallel_blocks(blocks.size(), 1, threads, [&](std::size_t b, std::size_t) {
        const std::size_t size = starts[b + 1] - starts[b];
        auto scratch = pool.take();
        scratch->reserve(std::max(size, block_size + block_size / 16));
        if (source.read(starts[b], starts[b + 1], scratch->text.get()))
            BlockParser(*scratch, size, origin, blocks[b]).run();
        else
            unread[b] = 1;
        pool.give(std::move(scratch));
    });
    if (std::find(unread.begin(), unread.end(), 1) != unread.end()) return unreadable;
    return blocks;
}

}  // namespace prep::detail
