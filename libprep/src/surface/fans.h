// Walking around a point from face to face.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prep/mesh.h"
#include "prep/topology.h"
#include "surface/corner_steps.h"

namespace prep::detail {

// A corner's fan: the corners at its point that can be reached over edges of two faces, hard ones
// excepted where `hard` (one byte per half-edge, not zero: hard) is given.
template <class Steps>
class FanWalker {
  public:
    FanWalker(const Steps& steps, const Topology& topology, std::span<const std::uint8_t> hard = {})
        : steps_(steps), topology_(topology), hard_(hard) {}

    // All corners of the fan that `start` is in, each once, in no particular order. O(fan).
    void collect(std::uint32_t start, std::vector<std::uint32_t>& corners) const {
        corners.clear();
        corners.push_back(start);
        for (std::uint32_t c = across_outgoing(start); c != no_index; c = across_outgoing(c)) {
            if (c == start) return;  // once around
            corners.push_back(c);
        }
        for (std::uint32_t c = across_incoming(start); c != no_index; c = across_incoming(c))
            corners.push_back(c);
    }

    // The next corner at the same point, over the edge that leaves this one; no_index at the fan's
    // end. A degenerate edge leads to its other end, which is the same point.
    std::uint32_t across_outgoing(std::uint32_t c) const {
        const std::uint32_t other = topology_.opposite[c];
        if (other == no_index)
            return topology_.kinds[c] == EdgeKind::degenerate ? steps_.next(c) : no_index;
        return is_hard(c) ? no_index : steps_.next(other);
    }
    std::uint32_t across_incoming(std::uint32_t c) const {
        const std::uint32_t incoming = steps_.previous(c);
        const std::uint32_t other = topology_.opposite[incoming];
        if (other == no_index)
            return topology_.kinds[incoming] == EdgeKind::degenerate ? incoming : no_index;
        return is_hard(incoming) ? no_index : other;
    }

  private:
    bool is_hard(std::uint32_t c) const { return !hard_.empty() && hard_[c] != 0; }

    Steps steps_;
    const Topology& topology_;
    std::span<const std::uint8_t> hard_;
};

}  // namespace prep::detail
