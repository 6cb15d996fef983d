#include "formats/obj/statement_names.h"

#include <algorithm>

#include "text/scan.h"

namespace prep::detail {

std::string statement_name(std::string name) {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    std::string out(LineScanner(name).rest());
    if (out.ends_with('\\')) out.back() = '_';
    return out;
}

std::string UniqueNames::unique(const std::string& name, bool own) {
    std::string tried = name;
    if (own ? used_.contains(tried) : kept_.contains(tried) || used_.contains(tried)) {
        std::uint32_t& number = numbers_.try_emplace(name, 2).first->second;
        do tried = name + "_" + std::to_string(number++);
        while (kept_.contains(tried) || used_.contains(tried));
    }
    used_.insert(tried);
    return tried;
}

}  // namespace prep::detail
