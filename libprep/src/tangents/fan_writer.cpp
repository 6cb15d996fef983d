#include "tangents/fan_writer.h"

#include <bit>
#include <limits>

#include "tangents/math.h"
#include "tangents/one_rings.h"

namespace prep::detail {

using Index = std::uint32_t;

FanWriter::FanWriter(const CornerReader& read, const FanOptions& fans, SimdLevel simd,
                     Valences& valences, std::span<glm::vec4> values)
    : read_(read),
      classify_(fan_kernel(simd)),
      fans_(fans),
      valences_(valences),
      values_(values),
      split_neighbours_(valences.states.size() / 64 + 1) {}

bool FanWriter::finish(VertexPool& pool, std::span<const Index> vertices, const Index* words) {
    if (vertices.empty()) return true;
    RingBatch& batch = *pool.batch;
    batch.count = vertices.size();
    std::copy(vertices.begin(), vertices.end(), batch.vertices);
    // Apart from what follows: compilers make vectors of it.
    Index none_met = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Index word = words[i], members = VertexWord::met(word);
        batch.members[i] = members;
        batch.slots[i] = VertexWord::slot(word);
        none_met |= Index(members == 0);
    }
    if (none_met != 0) return false;
    // Those that met none have no slot to give back.
    Index* const free = pool.free.data() + pool.free_count;
    for (std::size_t i = 0; i < vertices.size(); ++i)
        free[i] = batch.slots[i] * VertexWord::slot_one;
    Index split[ring_batch];
    std::size_t split_count = 0;
    VertexSum* const sums = pool.sums.data();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        VertexSum& sum = sums[batch.slots[i]];
        batch.sums[i] = {sum.x, sum.y, sum.z, 0};
        batch.codes[i] = sum.code;
        batch.normals[i] = sum.normal;
        if (sum.split) split[split_count++] = Index(i);
        sum = VertexSum();
    }
    for (std::size_t k = 0; k < split_count; ++k) batch.codes[split[k]] = 0;
    pool.free_count += vertices.size();
    write_fans(pool.rings.data(), batch);
    for (std::size_t k = 0; k < split_count; ++k) {
        const Index i = split[k];
        valences_.states[batch.vertices[i]] = split_vertex;
        note_neighbours(pool.rings[batch.slots[i]], batch.members[i]);
    }
    return true;
}

bool FanWriter::same_values(Index normal, Index uv, Index other_normal, Index other_uv) const {
    if (normal == other_normal && uv == other_uv) return true;
    if (normal == no_index || uv == no_index || other_normal == no_index || other_uv == no_index)
        return false;
    return read_.in.normals.values[normal] == read_.in.normals.values[other_normal] &&
           read_.in.uv.values[uv] == read_.in.uv.values[other_uv];
}

// Writes the tangents of fans, and all the batch's vertices' states.
void FanWriter::write_fans(const VertexRing* rings, RingBatch& batch) {
    const auto& normals = read_.in.normals.values;
    // Vectors hold indices of floats as signed numbers.
    const bool look = fans_.review && 3 * normals.size() <= std::numeric_limits<int>::max();
    classify_(rings, look ? normals : std::span<const glm::vec3>{}, batch);
    const Index needed = sum_is_fan | (fans_.review ? sum_has_frame : 0);
    const Index* const places = valences_.places.empty() ? nullptr : valences_.places.data();
    for (std::size_t i = 0; i < batch.count; ++i) {
        const FanSum& sum = batch.sums[i];
        const Index v = batch.vertices[i];
        const bool fan = (sum.code & needed) == needed ||
                         (sum.code != 0 &&
                          is_frame(read_.usable(batch.normals[i]), glm::vec3(sum.x, sum.y, sum.z)));
        valences_.states[v] = fan ? fan_vertex : worklist_vertex;
        if (!fan) continue;
        const float sign = (sum.code & orientation_preserving) ? 1.0f : -1.0f;
        values_[places == nullptr ? v : places[v]] =
            glm::vec4(sum.x, sum.y, sum.z, sign * fans_.positive);
    }
}

// Over edges to a split vertex triangles may part.
void FanWriter::note_neighbours(const VertexRing& ring, std::size_t count) {
    if (count > most_ring_members) {
        large_split_ = true;
        return;
    }
    const auto note_one = [&](Index v) {
        const std::uint64_t bit = std::uint64_t(1) << (v % 64);
        const std::atomic_ref word(split_neighbours_[v / 64]);
        if (!(word.load(std::memory_order_relaxed) & bit))
            word.fetch_or(bit, std::memory_order_relaxed);
    };
    for (std::size_t i = 0; i < count; ++i) {
        note_one(ring.members[i].previous);
        note_one(ring.members[i].next);
    }
}

void FanWriter::list_neighbours(std::span<const Index> vertices, int threads) {
    if (large_split_) {
        list_split_neighbours(vertices, threads, valences_.states);
        return;
    }
    for (std::size_t w = 0; w < split_neighbours_.size(); ++w) {
        for (std::uint64_t rest = split_neighbours_[w]; rest != 0; rest &= rest - 1) {
            std::uint8_t& state = valences_.states[64 * w + std::size_t(std::countr_zero(rest))];
            if (state == fan_vertex) state = worklist_vertex;
        }
    }
}

}  // namespace prep::detail
