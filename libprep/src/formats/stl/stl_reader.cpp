#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstring>
#include <string_view>

#include "base/parallel.h"
#include "formats/stl/stl.h"
#include "prep/mesh.h"
#include "text/line_ends.h"
#include "text/lower_case.h"
#include "text/scan.h"

namespace prep {
namespace {

using detail::LineScanner;

constexpr std::size_t header_size = 84, facet_size = 50;
constexpr std::size_t max_facets = (std::size_t(no_index) - 1) / 3;

// A mesh whose triangles have corners of their own, one after the other.
Mesh& add_mesh(Scene& scene, const std::string& name) {
    scene.name = name;
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.name = std::filesystem::path(name).stem().string();
    return mesh;
}

void number_corners(Mesh& mesh, int threads) {
    const std::size_t corners = mesh.positions.size();
    mesh.corner_vertices.resize(corners);
    mesh.face_offsets.resize(corners / 3 + 1);
    constexpr std::size_t block = 1 << 16;
    detail::parallel_blocks(corners / 3, block, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = 3 * begin; c < 3 * end; ++c)
            mesh.corner_vertices[c] = std::uint32_t(c);
        for (std::size_t f = begin; f < end; ++f)
            mesh.face_offsets[f + 1] = std::uint32_t(3 * f + 3);
    });
}

Result<Scene> parse_binary(std::span<const std::byte> bytes, const std::string& name,
                           std::uint32_t count, int threads) {
    if (count > max_facets)
        return Error{ErrorCode::limit, "more than 2^32 - 2 corners: cut the file into pieces",
                     name};
    Scene scene;
    Mesh& mesh = add_mesh(scene, name);
    // Floats as they are: their origin is zero (set_positions).
    mesh.positions.resize(std::size_t(count) * 3);
    std::atomic<std::size_t> attributes = 0;
    constexpr std::size_t block = 1 << 14;
    detail::parallel_blocks(count, block, threads, [&](std::size_t begin, std::size_t end) {
        std::size_t with_attributes = 0;
        for (std::size_t f = begin; f < end; ++f) {
            const std::byte* const facet = bytes.data() + header_size + f * facet_size;
            // The format is little-endian, as is every machine this runs on (x86-64).
            std::array<glm::vec3, 4> normal_and_corners;
            std::memcpy(normal_and_corners.data(), facet, sizeof normal_and_corners);
            std::copy(normal_and_corners.begin() + 1, normal_and_corners.end(),
                      mesh.positions.begin() + std::ptrdiff_t(3 * f));
            with_attributes += facet[48] != std::byte(0) || facet[49] != std::byte(0);
        }
        attributes += with_attributes;
    });
    number_corners(mesh, threads);
    instance_unused_meshes(scene);
    const std::size_t extra = bytes.size() - header_size - std::size_t(count) * facet_size;
    if (extra > 0)
        scene.warnings.push_back(name + ": " + std::to_string(extra) +
                                 " bytes after the last facet were ignored");
    if (attributes > 0)
        scene.warnings.push_back(name + ": the attribute bytes of " + std::to_string(attributes) +
                                 " facets (some programs' colours) were not taken");
    return scene;
}

// Words of a text, whatever white space stands between them. Keywords are in any case.
class Words {
  public:
    explicit Words(std::string_view text) : text_(text) {}

    // The next word; empty at the end of the text.
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) {
            if (text_[at_] == '\n') {
                ++line_;
                line_begin_ = true;
            }
            ++at_;
        }
        // The last line's end begins no other line.
        if (at_ == text_.size() && line_begin_ && line_ > 1 && text_.back() == '\n' && !ended_) {
            --line_;
            ended_ = true;
        }
        begin_ = at_;
        first_of_line_ = line_begin_;
        line_begin_ = false;
        while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        return text_.substr(begin_, at_ - begin_);
    }
    void back() {  // over the last word, which is read again
        at_ = begin_;
        line_begin_ = first_of_line_;
    }
    bool first_of_line() const { return first_of_line_; }
    std::size_t line() const { return line_; }
    std::string_view rest_of_line() const { return text_.substr(at_, line_end() - at_); }
    std::string_view from_word() const { return text_.substr(begin_, line_end() - begin_); }

    // Where the line's next "facet" begins; npos where it has none.
    std::size_t facet_in_line() const {
        if (facet_ == unknown || facet_ < at_) {
            facet_ = at_;
            for (; facet_ < text_.size(); ++facet_) {
                const bool alone = (facet_ == 0 || is_space(text_[facet_ - 1])) &&
                                   (facet_ + 5 >= text_.size() || is_space(text_[facet_ + 5]));
                if (alone && lower_case(text_.substr(facet_, 5)) == "facet" &&
                    begins_facet(facet_ + 5))
                    break;
            }
        }
        return facet_ < line_end() ? facet_ : std::string_view::npos;
    }
    // A name may hold the word too: what follows it tells.
    bool begins_facet(std::size_t after) const {
        while (after < text_.size() && is_space(text_[after])) ++after;
        std::size_t end = after;
        while (end < text_.size() && !is_space(text_[end])) ++end;
        const std::string next = lower_case(text_.substr(after, end - after));
        return next == "normal" || next == "outer" || next == "vertex";
    }
    std::size_t at() const { return at_; }
    void go_to(std::size_t at) { at_ = at; }

    static bool is_space(char c) { return c == '\n' || detail::is_blank(c); }

  private:
    // Both places are kept: a file may be one line, with very many solids in it.
    std::size_t line_end() const {
        if (line_end_ == unknown || line_end_ < at_)
            line_end_ = std::min(text_.find('\n', at_), text_.size());
        return line_end_;
    }

    static constexpr std::size_t unknown = std::string_view::npos;
    std::string_view text_;
    std::size_t at_ = 0, begin_ = 0, line_ = 1;
    bool line_begin_ = true, first_of_line_ = true, ended_ = false;
    mutable std::size_t line_end_ = unknown, facet_ = unknown;
};

class AsciiParser {
  public:
    AsciiParser(std::string_view text, const std::string& name) : words_(text), name_(name) {}

    Result<Scene> run() {
        for (;;) {
            const std::string_view word = words_.next();
            if (word.empty()) break;
            const std::string key = lower_case(word);
            if (auto done = statement(key); !done) return std::move(done).error();
            skip_to_keyword();
        }
        if (facet_) return fail("the file ends inside a facet");
        if (odd_facets_ > 0 && positions_.empty())
            return Error{ErrorCode::invalid,
                         "none of the " + std::to_string(odd_facets_) +
                             " facets has exactly three corners: there is no triangle to read",
                         name_};
        Scene scene;
        Mesh& mesh = add_mesh(scene, name_);
        set_positions(mesh, positions_);
        number_corners(mesh, 1);
        if (part_names_.size() > 1) {
            mesh.face_parts = std::move(parts_);
            mesh.parts = std::move(part_names_);
        } else if (part_names_.size() == 1 && !part_names_[0].empty()) {
            mesh.name = std::move(part_names_[0]);
        }
        instance_unused_meshes(scene);
        if (odd_facets_ > 0)
            scene.warnings.push_back(name_ + ": " + std::to_string(odd_facets_) +
                                     " facets without exactly three corners were dropped");
        return scene;
    }

  private:
    Error fail(const std::string& what) const {
        return {ErrorCode::syntax, what + " in " + detail::quoted_line(words_.from_word()),
                name_ + ":" + std::to_string(words_.line())};
    }

    static bool is_keyword(const std::string& key) {
        static constexpr std::string_view keys[] = {"solid",   "facet",    "normal",
                                                    "outer",   "loop",     "vertex",
                                                    "endloop", "endfacet", "endsolid"};
        return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
    }

    // What else stands in a statement's line.
    void skip_to_keyword() {
        for (;;) {
            const std::string_view word = words_.next();
            if (word.empty()) return;
            if (words_.first_of_line() || is_keyword(lower_case(word))) return words_.back();
        }
    }

    Result<void> statement(const std::string& key) {
        if (key == "outer" || key == "loop" || key == "endloop") return {};
        if (key == "solid") return solid();
        if (key == "endsolid") return end_solid();
        if (key == "normal") return normal();
        if (key == "vertex") return vertex();
        if (key == "facet") {
            if (facet_) return fail("a facet inside a facet");
            facet_ = true;
            in_facet_ = 0;
            return {};
        }
        if (key == "endfacet") return end_facet();
        return fail("expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid");
    }

    // The name goes to the line's end, or to the first facet in that line.
    Result<void> solid() {
        const std::size_t facet = words_.facet_in_line();
        std::string_view name = words_.rest_of_line();
        if (facet != std::string_view::npos) name = name.substr(0, facet - words_.at());
        words_.go_to(words_.at() + name.size());
        part_names_.push_back(std::string(LineScanner(name).rest()));
        return {};
    }

    // The name again, which may hold any word; but where a facet follows in the line, so does the
    // solid that it is in.
    Result<void> end_solid() {
        const std::size_t facet = words_.facet_in_line();
        if (facet == std::string_view::npos) {
            words_.go_to(words_.at() + words_.rest_of_line().size());
            return {};
        }
        while (words_.at() < facet) {
            const std::string key = lower_case(words_.next());
            if (key == "solid" || key == "facet") {
                words_.back();
                break;
            }
        }
        return {};
    }

    Result<void> normal() {  // the corners say it better
        for (int k = 0; k < 3; ++k)
            if (is_keyword(lower_case(words_.next()))) {
                words_.back();
                break;
            }
        return {};
    }

    Result<void> vertex() {
        if (!facet_) return fail("a vertex outside a facet");
        const Words keyword = words_;  // for a message that shows the whole statement
        glm::dvec3 p(0.0);
        for (int k = 0; k < 3; ++k)
            if (!LineScanner(words_.next()).number(p[k])) {
                words_ = keyword;
                return fail("expected three coordinates");
            }
        if (in_facet_ < 3) positions_.push_back(p);
        ++in_facet_;
        return {};
    }

    Result<void> end_facet() {
        if (!facet_) return fail("an endfacet without its facet");
        facet_ = false;
        if (in_facet_ != 3) {
            ++odd_facets_;
            positions_.resize(positions_.size() - std::min<std::size_t>(in_facet_, 3));
            return {};
        }
        if (positions_.size() >= no_index)
            return Error{ErrorCode::limit, "more than 2^32 - 2 corners", name_};
        parts_.push_back(part_names_.empty() ? 0 : std::uint32_t(part_names_.size() - 1));
        return {};
    }

    Words words_;
    const std::string& name_;
    std::vector<glm::dvec3> positions_;
    std::vector<std::uint32_t> parts_;
    std::vector<std::string> part_names_;
    std::size_t in_facet_ = 0, odd_facets_ = 0;
    bool facet_ = false;
};

}  // namespace

Result<Scene> parse_stl(std::span<const std::byte> bytes, const std::string& name) {
    return parse_stl(bytes, name, 0);
}

bool detail::says_solid(std::string_view text) {
    constexpr std::string_view solid = "solid";
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    const std::string_view word = text.substr(std::min(begin, text.size()), solid.size());
    return std::equal(word.begin(), word.end(), solid.begin(), solid.end(),
                      [](char a, char b) { return lower_case(a) == b; });
}

Result<Scene> parse_stl(std::span<const std::byte> bytes, const std::string& name, int threads) {
    const std::string_view text = detail::without_byte_order_mark(
        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const bool says_solid = detail::says_solid(text);
    // Text has no zero bytes; a binary header that begins with "solid" is followed by some.
    const bool text_like = says_solid && text.find('\0') == std::string_view::npos;
    if (bytes.size() >= header_size) {
        std::uint32_t count;
        std::memcpy(&count, bytes.data() + 80, 4);
        const std::size_t room = (bytes.size() - header_size) / facet_size;
        const bool exact = bytes.size() == header_size + std::size_t(count) * facet_size;
        if (exact || (!text_like && count <= room))
            return parse_binary(bytes, name, count, threads);
        if (!text_like)
            return Error{ErrorCode::syntax,
                         "the header announces " + std::to_string(count) +
                             " facets, but there is room for " + std::to_string(room) +
                             ": the file is cut short or not STL",
                         name + ", byte 80"};
    }
    if (says_solid && detail::ends_lines_with_cr(text))
        return AsciiParser(detail::with_line_feeds(text), name).run();
    if (says_solid) return AsciiParser(text, name).run();
    return Error{ErrorCode::syntax,
                 "neither \"solid\" at the beginning nor a binary header of 84 bytes: not STL",
                 name};
}

}  // namespace prep
