// Values as bytes and back, over the lists of scene_fields.h. The bytes that are read may be
// anything.
#pragma once

#include <cstddef>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "contained/scene_fields.h"
#include "prep/result.h"

namespace prep::detail {

// Numbers, and groups of them without anything between: any bytes are a value.
template <class T>
inline constexpr bool plain = std::is_arithmetic_v<T> || std::is_same_v<T, std::byte>;
template <>
inline constexpr bool plain<bool> = false;
template <glm::length_t L, class V, glm::qualifier Q>
inline constexpr bool plain<glm::vec<L, V, Q>> = sizeof(glm::vec<L, V, Q>) == L * sizeof(V);
template <glm::length_t C, glm::length_t R, class V, glm::qualifier Q>
inline constexpr bool plain<glm::mat<C, R, V, Q>> = sizeof(glm::mat<C, R, V, Q>) == C* R *
                                                                                        sizeof(V);
template <class V, glm::qualifier Q>
inline constexpr bool plain<glm::qua<V, Q>> = sizeof(glm::qua<V, Q>) == 4 * sizeof(V);

// Enums without a table of names: their last value.
constexpr auto last_of(SmoothingKind) {
    return SmoothingKind::bit_mask;
}
constexpr auto last_of(Interpolation) {
    return Interpolation::cubic_spline;
}
constexpr auto last_of(AnimationPath) {
    return AnimationPath::other;
}
constexpr auto last_of(ErrorCode) {
    return ErrorCode::limit;
}

template <class E>
bool is_value_of(std::underlying_type_t<E> number) {
    if constexpr (requires { names_of(E{}); }) {
        for (const auto& entry : names_of(E{}))
            if (entry.value == E(number)) return true;
        return false;
    } else {
        return number >= 0 && number <= std::underlying_type_t<E>(last_of(E{}));
    }
}

class ByteWriter {
  public:
    std::vector<std::byte> take() { return std::move(bytes_); }

    template <class T>
    void operator()(const T& value) {
        if constexpr (plain<T>) {
            raw(&value, sizeof value);
        } else if constexpr (std::is_enum_v<T>) {
            (*this)(std::underlying_type_t<T>(value));
        } else {
            fields(*this, value);
        }
    }
    void operator()(bool value) { (*this)(std::uint8_t(value)); }
    void operator()(LeftOut) {}
    void operator()(const std::string& text) {
        count(text.size());
        raw(text.data(), text.size());
    }
    void operator()(const std::filesystem::path& path) { (*this)(path.native()); }
    template <class T>
    void operator()(const std::vector<T>& list) {
        count(list.size());
        if constexpr (plain<T>)
            raw(list.data(), list.size() * sizeof(T));
        else
            for (const T& value : list) (*this)(value);
    }
    template <class T>
    void operator()(const std::optional<T>& value) {
        (*this)(value.has_value());
        if (value) (*this)(*value);
    }
    // The number of the list: the next one where it is new, and then its values follow.
    template <class T>
    void operator()(const std::shared_ptr<const std::vector<T>>& list) {
        if (!list) return (*this)(no_index);
        const auto [at, fresh] = shared_.try_emplace(list.get(), std::uint32_t(shared_.size()));
        (*this)(at->second);
        if (fresh) (*this)(*list);
    }
    // Others are written wherever they are named.
    template <class T>
    void operator()(const std::shared_ptr<const T>& value) {
        (*this)(bool(value));
        if (value) (*this)(*value);
    }

  private:
    void count(std::size_t n) { (*this)(std::uint64_t(n)); }
    void raw(const void* from, std::size_t size) {
        if (size == 0) return;
        const std::size_t at = bytes_.size();
        bytes_.resize(at + size);
        std::memcpy(bytes_.data() + at, from, size);
    }

    std::vector<std::byte> bytes_;
    std::map<const void*, std::uint32_t> shared_;
};

class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes) : rest_(bytes) {}
    bool good() const { return good_; }
    bool at_end() const { return rest_.empty(); }

    template <class T>
    void operator()(T& value) {
        if constexpr (plain<T>) {
            raw(&value, sizeof value);
        } else if constexpr (std::is_enum_v<T>) {
            std::underlying_type_t<T> number{};
            (*this)(number);
            if (is_value_of<T>(number))
                value = T(number);
            else
                good_ = false;
        } else {
            fields(*this, value);
        }
    }
    void operator()(bool& value) {
        std::uint8_t number = 0;
        (*this)(number);
        good_ = good_ && number <= 1;
        value = number == 1;
    }
    void operator()(LeftOut) {}
    void operator()(std::string& text) {
        if (const std::size_t n = count(1); n > 0) {
            text.resize(n);
            raw(text.data(), n);
        }
    }
    void operator()(std::filesystem::path& path) {
        std::string text;
        (*this)(text);
        path = std::move(text);
    }
    template <class T>
    void operator()(std::vector<T>& list) {
        list.clear();  // members may begin with something
        if constexpr (plain<T>) {
            if (const std::size_t n = count(sizeof(T)); n > 0) {
                list.resize(n);
                raw(list.data(), n * sizeof(T));
            }
        } else {
            // Each takes a byte at least, but more memory than that: the list grows as they come.
            const std::size_t n = count(1);
            for (std::size_t i = 0; i < n && good_; ++i) (*this)(list.emplace_back());
        }
    }
    template <class T>
    void operator()(std::optional<T>& value) {
        bool there = false;
        (*this)(there);
        if (there) (*this)(value.emplace());
    }
    template <class T>
    void operator()(std::shared_ptr<const std::vector<T>>& list) {
        std::uint32_t number = no_index;
        (*this)(number);
        if (!good_ || number == no_index) return;
        auto& known = shared<T>();
        if (number == shared_count_) {
            auto values = std::make_shared<std::vector<T>>();
            (*this)(*values);
            list = std::move(values);
            known.emplace(number, list);
            ++shared_count_;
        } else if (const auto at = known.find(number); at != known.end()) {
            list = at->second;
        } else {
            good_ = false;
        }
    }
    template <class T>
    void operator()(std::shared_ptr<const T>& value) {
        constexpr int deepest = 8;  // pictures put together from pictures put together
        bool there = false;
        (*this)(there);
        if (!there) return;
        good_ = good_ && ++depth_ <= deepest;
        auto read = std::make_shared<T>();
        if (good_) (*this)(*read);
        --depth_;
        value = std::move(read);
    }

  private:
    int depth_ = 0;
    // 0 where that many cannot follow.
    std::size_t count(std::size_t least_bytes) {
        std::uint64_t n = 0;
        (*this)(n);
        if (good_ && n <= rest_.size() / least_bytes) return std::size_t(n);
        good_ = false;
        return 0;
    }
    void raw(void* to, std::size_t size) {
        if (!good_ || size > rest_.size()) {
            good_ = false;
            return;
        }
        std::memcpy(to, rest_.data(), size);
        rest_ = rest_.subspan(size);
    }
    template <class T>
    auto& shared() {
        if constexpr (std::is_same_v<T, float>)
            return numbers_;
        else
            return vectors_;
    }

    template <class T>
    using SharedLists = std::map<std::uint32_t, std::shared_ptr<const std::vector<T>>>;
    std::span<const std::byte> rest_;
    bool good_ = true;
    std::uint32_t shared_count_ = 0;
    SharedLists<float> numbers_;
    SharedLists<glm::vec3> vectors_;
};

}  // namespace prep::detail
