#include "prep/result.h"

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

}  // namespace prep
