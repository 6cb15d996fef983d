// Names as OBJ and MTL can hold them: each takes the rest of its line, and is all that tells two
// things apart.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace prep::detail {

// `name` in one line, without blanks around it, which readers leave out, and with '_' for a '\' at
// its end, which would join the next line. May be empty.
std::string statement_name(std::string name);
// The note of names that it changed.
inline constexpr const char* changed_names =
    "OBJ ends names with their line: blanks around them were left out, line ends and a last '\\' "
    "replaced";

// Gives each a name of its own: the second "a" is "a_2".
class UniqueNames {
  public:
    // Names that nothing else shall get; their own first bearer has them.
    void keep_free(const std::string& name) { kept_.insert(name); }
    // `own`: one of those names is this one's.
    std::string unique(const std::string& name, bool own);

  private:
    std::unordered_set<std::string> kept_, used_;
    std::unordered_map<std::string, std::uint32_t> numbers_;  // by name the first that may be free
};

}  // namespace prep::detail
