// What libpng complained of. It leaves by longjmp(): functions that call setjmp() have nothing with
// a destructor, and read nothing afterwards that they have changed in between; what they fill lives
// in their callers.
#pragma once

#include <png.h>

#include <csetjmp>
#include <cstdlib>
#include <cstring>

namespace prep::detail {

struct PngProblem {
    char reason[256] = "no reason given";
    bool out_of_memory = false;  // at some time: libpng can do without some of it
};

// Handlers of a structure whose pointers for errors and for memory are those of a PngProblem.
inline void remember_problem(png_structp png, png_const_charp text) {
    PngProblem& problem = *static_cast<PngProblem*>(png_get_error_ptr(png));
    std::strncpy(problem.reason, text, sizeof(problem.reason) - 1);
    png_longjmp(png, 1);
}
inline void ignore_warning(png_structp, png_const_charp) {}
inline png_voidp take_memory(png_structp png, png_alloc_size_t size) {
    void* const memory = std::malloc(size);
    if (!memory) static_cast<PngProblem*>(png_get_mem_ptr(png))->out_of_memory = true;
    return memory;
}
inline void give_memory_back(png_structp, png_voidp memory) {
    std::free(memory);
}

}  // namespace prep::detail
