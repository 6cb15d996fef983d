// What differs between two materials as they look: names do not count.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "prep/scene.h"

namespace judge {

// Pictures' values that differ by no more are the same: half a level of 8 bits. Materials' numbers
// are floats in files, linear ones among them, of which half a level can be seen: by no more than
// this, and of large ones by this part.
inline constexpr double same_value = 1.0 / 510, same_number = 1e-5;

// Compares materials of two scenes, which must outlive it; pictures by their bytes, those that
// differ by their pixels. What cannot be read is told once in warnings().
class MaterialLooks {
  public:
    MaterialLooks(const prep::Scene& a, const prep::Scene& b) : a_(a), b_(b) {}

    // "base colour 0.8 0 0 1 → 0 0 0.8 1", …; none where they look alike. no_index: a material of
    // defaults.
    const std::vector<std::string>& differences(std::uint32_t of_a, std::uint32_t of_b);
    // Another of a's materials that looks as this one of b, or no_index.
    std::uint32_t twin_in_a(std::uint32_t of_b);
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    bool same_picture(std::uint32_t of_a, std::uint32_t of_b);

    const prep::Scene &a_, &b_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::string>> known_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, bool> pictures_;
    std::vector<std::string> warnings_;
};

}  // namespace judge
