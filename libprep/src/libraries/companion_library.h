// Libraries of this build that are loaded when they are first needed: what they bring along takes
// longer to load than many a command takes in all.
#pragma once

#include "prep/result.h"

namespace prep::detail {

struct CompanionLibrary {
    const char* file;    // "libprep_images.so"
    const char* symbol;  // carries the build, so that no library of another is taken for this one's
    const char* purpose;  // "the library for pictures", in messages
};

// That symbol of the library, which is never unloaded. Errors: io (it is not there, or of another
// build).
Result<void*> companion_symbol(const CompanionLibrary& library);

// What the library offers: the symbol is a function that gives it.
template <class Backend>
Result<const Backend*> open_companion(const CompanionLibrary& library) {
    const auto symbol = companion_symbol(library);
    if (!symbol) return symbol.error();
    return reinterpret_cast<const Backend* (*)()>(*symbol)();
}

}  // namespace prep::detail
