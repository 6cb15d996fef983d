// Included by the sources that scripts/mutate has planted faults in; never by the project itself.
// MESHPREP_FAULT(n) is true in a process whose environment variable MESHPREP_FAULT is n. With
// MESHPREP_FAULT_MAP naming a file of one byte a fault, each fault that is reached sets its byte.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

// Both sides of a planted choice need not agree to the letter.
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wparentheses"
#pragma GCC diagnostic ignored "-Wunused-variable"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-but-set-variable"
#pragma GCC diagnostic ignored "-Wunused-value"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Warray-bounds"
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Wdangling-pointer"

namespace meshprep_planted {

struct Choice {
    int number = -1;
    unsigned char* reached = nullptr;  // shared with the other processes of the same test
    long size = 0;
    Choice() {
        if (const char* text = std::getenv("MESHPREP_FAULT")) number = std::atoi(text);
        const char* map = std::getenv("MESHPREP_FAULT_MAP");
        const int file = map ? ::open(map, O_RDWR | O_CLOEXEC) : -1;
        struct stat about = {};
        if (file >= 0 && ::fstat(file, &about) == 0 && about.st_size > 0) {
            size = static_cast<long>(about.st_size);
            void* memory = ::mmap(nullptr, static_cast<unsigned long>(size), PROT_READ | PROT_WRITE,
                                  MAP_SHARED, file, 0);
            reached = memory == MAP_FAILED ? nullptr : static_cast<unsigned char*>(memory);
        }
        if (file >= 0) ::close(file);
    }
};
inline const Choice choice;

constexpr bool on(int n) {
    if (__builtin_is_constant_evaluated()) return false;
    if (choice.reached && n < choice.size && !choice.reached[n]) choice.reached[n] = 1;
    return choice.number == n;
}

}  // namespace meshprep_planted

#define MESHPREP_FAULT(n) (::meshprep_planted::on(n))
