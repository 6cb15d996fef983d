#include "prep/result.h"

#include <cstdio>
#include <cstdlib>

namespace prep {

std::string_view to_string(ErrorCode code) {
    switch (code) {
        case ErrorCode::io:
            return "io";
        case ErrorCode::syntax:
            return "syntax";
        case ErrorCode::invalid:
            return "invalid";
        case ErrorCode::unsupported:
            return "unsupported";
        case ErrorCode::limit:
            return "limit";
    }
    return "unknown";
}

std::string to_string(const Error& error) {
    return error.place.empty() ? error.text : error.place + ": " + error.text;
}

namespace detail {

// The one place where a library prints: what comes next is the end of the program.
void no_value(const Error& error) {
    std::fprintf(stderr, "prep::Result: the value of an error was asked for: %s\n",
                 to_string(error).c_str());
    std::abort();
}

void no_error() {
    std::fputs("prep::Result: the error of a value was asked for\n", stderr);
    std::abort();
}

}  // namespace detail
}  // namespace prep
