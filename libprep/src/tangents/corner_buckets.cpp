#include "tangents/corner_buckets.h"

#include <algorithm>
#include <bit>

#include "surface/block_places.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Of vertices in a block, as powers of two. At 96 bytes each 4096 take 400 kB; smaller ones only so
// that what threads work in is little beside the records. The last is what a record has room for.
constexpr int least_shift = 8, usual_shift = 12, most_shift = 32 - CornerRecord::code_bits;
// More blocks than that only where the last shift asks for it: each is a place to write to.
constexpr int usual_block_bits = 10;
constexpr std::size_t triangles_of_vertex = 12;  // at least, for the blocks at work

int shift_of(std::size_t triangles, std::size_t vertices, std::size_t workers) {
    const std::size_t size = triangles / (triangles_of_vertex * workers);
    const int wanted = std::clamp(int(std::bit_width(size)) - 1, least_shift, usual_shift);
    return std::min(std::max(wanted, int(std::bit_width(vertices)) - usual_block_bits), most_shift);
}

}  // namespace

CornerBuckets::CornerBuckets(std::span<const Index> vertices,
                             std::span<const Valences::Range> ranges, std::size_t count,
                             std::size_t workers, int threads)
    : shift_(shift_of(vertices.size() / 3, count, workers)),
      blocks_((count + block_size() - 1) >> shift_),
      records_(vertices.size()) {
    std::vector<std::size_t> ends;
    for (const Valences::Range& range : ranges) ends.push_back(3 * range.end);
    starts_ = block_places(vertices, shift_, blocks_, ends, threads);
    cursors_ = starts_;
}

void CornerBuckets::add(std::size_t r, const AccumulateInput& in, std::size_t first,
                        std::size_t count, bool any_degenerate,
                        const Contribution* const planes[3]) {
    // Local copies of all pointers: writing records could change what is reached through others.
    std::size_t* const cursors = cursors_.data() + r * blocks_;
    CornerRecord* const records = records_.data();
    const Index *const corners = in.corners, *const normals = in.normals, *const uvs = in.uvs;
    const int shift = shift_;
    const Index within = Index(block_size() - 1);
    for (std::size_t i = 0; i < count; ++i) {
        if (any_degenerate && (planes[0][i].code & degenerate_triangle)) continue;
        const std::size_t at = 3 * (first + i);
        const Index* const v = in.vertices + at;
        const auto write = [&](std::size_t k, Index next, Index previous) {
            const std::size_t c = corners == nullptr ? at + k : corners[at + k];
            const Contribution& from = planes[k][i];
            records[cursors[v[k] >> shift]++] = {
                from.x,
                from.y,
                from.z,
                (from.code & CornerRecord::code_mask) | (v[k] & within) << CornerRecord::code_bits,
                next,
                previous,
                normals[c],
                uvs[c]};
        };
        write(0, v[1], v[2]);
        write(1, v[2], v[0]);
        write(2, v[0], v[1]);
    }
}

std::span<const CornerRecord> CornerBuckets::records(std::size_t block, std::size_t r) const {
    const std::size_t at = r * blocks_ + block;
    return {records_.data() + starts_[at], cursors_[at] - starts_[at]};
}

}  // namespace prep::detail
