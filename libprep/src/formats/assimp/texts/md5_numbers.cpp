#include "formats/assimp/texts/md5_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

namespace prep::detail {
namespace {

// Words with their places; what stands in quotation marks or behind "//" is none of them.
class Md5Words {
  public:
    explicit Md5Words(std::string_view text) : text_(text) {}

    // Empty at the end.
    std::string_view next() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"') {
                at_ = std::min(text_.find_first_of("\"\r\n", at_ + 1), text_.size());
                at_ += at_ < text_.size() && text_[at_] == '"';
            } else if (text_.substr(at_).starts_with("//")) {
                at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
            } else if (apart.find(c) != std::string_view::npos) {
                line_ += c == '\n' || (c == '\r' && !text_.substr(at_ + 1).starts_with('\n'));
                ++at_;
            } else {
                const std::size_t begin = at_;
                at_ = std::min(text_.find_first_of(ends, at_), text_.size());
                return text_.substr(begin, at_ - begin);
            }
        }
        return {};
    }
    std::size_t line() const { return line_; }

  private:
    static constexpr std::string_view ends{"\" \t\r\n\f\v\0{}()", 12};
    static constexpr std::string_view apart = ends.substr(1);
    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

// What a statement's numbers are: integers, and other ones that are passed over.
struct Statement {
    std::string_view word, numbers;
};
constexpr std::array<Statement, 8> statements{{{"vert", "i..ii"},
                                               {"tri", "iiii"},
                                               {"weight", "ii"},
                                               {"numverts", "i"},
                                               {"numtris", "i"},
                                               {"numweights", "i"},
                                               {"numJoints", "i"},
                                               {"numMeshes", "i"}}};

bool is_beyond(std::string_view number, std::uint64_t most) {
    std::uint64_t value = 0;
    const auto [end, failure] =
        std::from_chars(number.data(), number.data() + number.size(), value);
    return failure == std::errc::result_out_of_range || (failure == std::errc() && value > most);
}

}  // namespace

std::optional<Md5Excess> md5_excess(std::string_view text) {
    Md5Words words(text);
    std::string said;          // of the statement that the words are in
    std::string_view numbers;  // that are to come
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
        const auto statement = std::find_if(statements.begin(), statements.end(),
                                            [&](const Statement& s) { return s.word == word; });
        if (statement != statements.end()) {
            said = word;
            numbers = statement->numbers;
        } else if (!numbers.empty()) {
            said += ' ';
            said += word;
            if (numbers.front() == 'i' && is_beyond(word, text.size()))
                return Md5Excess{words.line(), std::move(said)};
            numbers.remove_prefix(1);
        }
    }
    return std::nullopt;
}

}  // namespace prep::detail
