// Whether this is built under sanitizers, where everything takes several times as long: tests with
// many cases look at a part of them.
#pragma once

// GCC defines macros, Clang has features.
#if defined(__has_feature)
#define MESHPREP_TEST_FEATURE(name) __has_feature(name)
#else
#define MESHPREP_TEST_FEATURE(name) 0
#endif

namespace test {

#if defined(__SANITIZE_THREAD__) || MESHPREP_TEST_FEATURE(thread_sanitizer)
inline constexpr bool thread_sanitized = true;
#else
inline constexpr bool thread_sanitized = false;
#endif

#if defined(__SANITIZE_ADDRESS__) || MESHPREP_TEST_FEATURE(address_sanitizer)
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = thread_sanitized;
#endif

}  // namespace test
