// Result<T>: a value, or an Error that says what, where and what to do next.
//
// No function of libprep or librast throws (std::bad_alloc aside), prints or exits. Whatever the
// outside world can get wrong comes back as an Error; what only a caller's bug can cause is
// asserted.
#pragma once

#include <cassert>
#include <string>
#include <string_view>
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

template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    explicit operator bool() const { return state_.index() == 0; }
    bool has_value() const { return state_.index() == 0; }

    T& value() & { return assert(has_value()), *std::get_if<0>(&state_); }
    const T& value() const& { return assert(has_value()), *std::get_if<0>(&state_); }
    T&& value() && { return assert(has_value()), std::move(*std::get_if<0>(&state_)); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    Error& error() & { return assert(!has_value()), *std::get_if<1>(&state_); }
    const Error& error() const& { return assert(!has_value()), *std::get_if<1>(&state_); }
    Error&& error() && { return assert(!has_value()), std::move(*std::get_if<1>(&state_)); }

  private:
    std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> : public Result<std::monostate> {
  public:
    Result() : Result<std::monostate>(std::monostate{}) {}
    Result(Error error) : Result<std::monostate>(std::move(error)) {}
};

}  // namespace prep
