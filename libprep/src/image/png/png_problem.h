// What libpng complained of. It leaves by longjmp(), past destructors: functions that call setjmp()
// have no objects of their own, and what they fill lives in their callers.
#pragma once

#include <png.h>

#include <csetjmp>
#include <cstring>

namespace prep::detail {

struct PngProblem {
    char reason[256] = "no reason given";
};

// Handlers of a structure whose error pointer is a PngProblem.
inline void remember_problem(png_structp png, png_const_charp text) {
    PngProblem& problem = *static_cast<PngProblem*>(png_get_error_ptr(png));
    std::strncpy(problem.reason, text, sizeof(problem.reason) - 1);
    png_longjmp(png, 1);
}
inline void ignore_warning(png_structp, png_const_charp) {}

}  // namespace prep::detail
