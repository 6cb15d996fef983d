// Result<T>: a value, or an Error that says what, where and what to do next. The interface is that
// of C++23's std::expected<T, Error>, with two differences: a value and an Error convert by
// themselves (no std::unexpected), and access is always checked: asking an error for its value, or
// a value for its error, is the caller's bug and ends the program with the error's text, in release
// builds as well.
//
// No function of libprep or librast throws (std::bad_alloc aside), prints or exits. Whatever the
// outside world can get wrong comes back as an Error; what only a caller's bug can cause is
// asserted.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace prep {

enum class ErrorCode {
    io,           // the file cannot be opened, read or written
    syntax,       // the bytes are not what the format asks for
    invalid,      // well-formed, but the content contradicts itself
    unsupported,  // valid, but needs something that this build cannot do
    limit,        // larger than the stated limits (32-bit indices, memory guards)
};

std::string_view to_string(ErrorCode code);

struct Error {
    ErrorCode code = ErrorCode::invalid;
    std::string text;   // what is wrong: found against expected, and what to do next
    std::string place;  // where: "file.obj:12", "scene.gltf#/accessors/3/count", "mesh 'a', face 7"
};

// "place: text", or only the text where the place is empty.
std::string to_string(const Error& error);

namespace detail {
[[noreturn]] void no_value(const Error& error);
[[noreturn]] void no_error();
}  // namespace detail

template <class T>
class [[nodiscard]] Result {
  public:
    using value_type = T;
    using error_type = Error;

    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    explicit operator bool() const noexcept { return has_value(); }
    bool has_value() const noexcept { return state_.index() == 0; }

    T& value() & { return of(*this); }
    const T& value() const& { return of(*this); }
    T&& value() && { return std::move(of(*this)); }
    T& operator*() & { return of(*this); }
    const T& operator*() const& { return of(*this); }
    T&& operator*() && { return std::move(of(*this)); }
    T* operator->() { return &of(*this); }
    const T* operator->() const { return &of(*this); }

    Error& error() & { return error_of(*this); }
    const Error& error() const& { return error_of(*this); }
    Error&& error() && { return std::move(error_of(*this)); }

    template <class U>
    T value_or(U&& other) const& {
        return has_value() ? **this : static_cast<T>(std::forward<U>(other));
    }
    template <class U>
    T value_or(U&& other) && {
        return has_value() ? *std::move(*this) : static_cast<T>(std::forward<U>(other));
    }

    // f(value), itself a Result; an error passes by.
    template <class F>
    auto and_then(F&& f) const& -> std::invoke_result_t<F, const T&> {
        if (!has_value()) return error();
        return std::invoke(std::forward<F>(f), **this);
    }
    template <class F>
    auto and_then(F&& f) && -> std::invoke_result_t<F, T&&> {
        if (!has_value()) return std::move(*this).error();
        return std::invoke(std::forward<F>(f), *std::move(*this));
    }
    // The Result of what f makes of the value; an error passes by.
    template <class F>
    auto transform(F&& f) const& -> Result<std::invoke_result_t<F, const T&>> {
        if (!has_value()) return error();
        return std::invoke(std::forward<F>(f), **this);
    }
    template <class F>
    auto transform(F&& f) && -> Result<std::invoke_result_t<F, T&&>> {
        if (!has_value()) return std::move(*this).error();
        return std::invoke(std::forward<F>(f), *std::move(*this));
    }
    // f(error), a Result of the same kind; a value passes by.
    template <class F>
    Result or_else(F&& f) const& {
        return has_value() ? *this : Result(std::invoke(std::forward<F>(f), error()));
    }
    // The same with the error that f makes of it.
    template <class F>
    Result transform_error(F&& f) const& {
        return has_value() ? *this : Result(Error(std::invoke(std::forward<F>(f), error())));
    }

  private:
    template <class Self>
    static auto& of(Self& self) {
        auto* const value = std::get_if<0>(&self.state_);
        if (!value) detail::no_value(*std::get_if<1>(&self.state_));
        return *value;
    }
    template <class Self>
    static auto& error_of(Self& self) {
        auto* const error = std::get_if<1>(&self.state_);
        if (!error) detail::no_error();
        return *error;
    }
    std::variant<T, Error> state_;
};

// Done, or an Error.
template <>
class [[nodiscard]] Result<void> {
  public:
    using value_type = void;
    using error_type = Error;

    Result() : state_(std::monostate{}) {}
    Result(Error error) : state_(std::move(error)) {}

    explicit operator bool() const noexcept { return has_value(); }
    bool has_value() const noexcept { return state_.has_value(); }
    void value() const { static_cast<void>(state_.value()); }
    void operator*() const { value(); }
    Error& error() & { return state_.error(); }
    const Error& error() const& { return state_.error(); }
    Error&& error() && { return std::move(state_).error(); }

    template <class F>
    auto and_then(F&& f) const -> std::invoke_result_t<F> {
        if (!has_value()) return error();
        return std::invoke(std::forward<F>(f));
    }
    template <class F>
    Result or_else(F&& f) const {
        return has_value() ? *this : Result(std::invoke(std::forward<F>(f), error()));
    }

  private:
    Result<std::monostate> state_;
};

}  // namespace prep
