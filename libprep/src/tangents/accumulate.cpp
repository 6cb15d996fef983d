#include "tangents/accumulate.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <deque>
#include <memory>

#include "base/parallel.h"
#include "tangents/fan_writer.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// What is noted for shared vertices is sorted into that many parts by vertex, added at once.
constexpr int part_bits = 4;
constexpr std::size_t parts = std::size_t(1) << part_bits;
// After so many triangles of a range it is looked whether lists are the better way.
constexpr std::size_t trial = 4096;
// Contributions of all triangles are kept up to so many: to compute again what later groups need
// takes longer (bench_tangents, 10,000 triangles: 1.2 times the whole).
constexpr std::size_t few_triangles = 65536;
// Corners of a block of contributions: so many vertices may be opened, and be done with, by one.
constexpr std::size_t block_corners = 3 * TriangleBlock::size;

struct Note {
    float x, y, z;
    Index code, member;  // four times the triangle plus 0, 1 or 2
};

// Lists may be written to up to a vector behind their end.
constexpr std::size_t most_lanes = 16;

struct RangeWork {
    VertexPool pool;
    AccumulateLists lists;
    std::deque<Note> notes[parts];
    TriangleCounts counts;
};

class Accumulation {
  public:
    Accumulation(const CornerReader& read, const TangentTriangles& triangles,
                 std::span<const Index> vertices, const BlockContributions& contributions,
                 const FanOptions& fans, SimdLevel simd, Valences& valences,
                 ContributionStore& store, std::span<glm::vec4> values)
        : input_{vertices.data(), triangles.implicit() ? nullptr : triangles.corners.data(),
                 read.in.normals.indices.data(), read.in.uv.indices.data()},
          add_(accumulate_kernel(simd)),
          vertices_(vertices.data()),
          words_(valences.words.data()),
          contributions_(contributions),
          valences_(valences),
          store_(store),
          writer_(read, fans, simd, valences, values),
          part_shift_(std::max(0, int(std::bit_width(valences.words.size())) - part_bits)),
          first_uses_(valences.listed_corners > 0 ? valences.words.size() : 0),
          work_(valences.ranges.size()) {}

    bool run(std::size_t triangles, int threads) {
        store_.triangle_flags = ScratchBuffer<std::uint8_t>(triangles);
        // Likewise where many corners will be listed.
        store_.complete = (triangles <= few_triangles && few_notes()) ||
                          8 * valences_.listed_corners > 3 * triangles;
        if (store_.complete)
            for (auto& plane : store_.planes) plane = ScratchBuffer<Contribution>(triangles);
        parallel_blocks(work_.size(), 1, threads, [&](std::size_t r, std::size_t) {
            go_through(r);
            work_[r].pool = {};
        });
        store_.counts = {};
        for (const RangeWork& work : work_) store_.counts.add(work.counts);
        if (store_.counts.nan) given_up_ = true;
        if (work_.size() > 1 && !given_up_)
            parallel_blocks(parts, 1, threads,
                            [&](std::size_t part, std::size_t) { add_notes(part); });
        // A listed vertex that met nothing has degenerate triangles alone.
        if (!first_uses_.empty() && std::memchr(valences_.states.data(), pending_vertex,
                                                valences_.states.size()) != nullptr)
            given_up_ = true;
        store_.complete &= !given_up_;
        if (given_up_) return false;
        writer_.list_neighbours({vertices_, 3 * triangles}, threads);
        return true;
    }

  private:
    // Of what several ranges share: in an order without neighbours they take the memory.
    bool few_notes() const {
        std::size_t shared = 0;
        for (const std::uint64_t word : valences_.shared)
            shared += std::size_t(std::popcount(word));
        return shared <= valences_.words.size() / 4;
    }

    void go_through(std::size_t r) {
        const Valences::Range& range = valences_.ranges[r];
        RangeWork& work = work_[r];
        const auto scratch = std::make_unique<BlockContributions::Scratch>();
        const std::size_t trial_end = std::min(range.end, range.begin + trial);
        bool tried = range.end - range.begin < trial;
        std::uint8_t* const triangle_flags = store_.triangle_flags.data();
        std::vector<Index> done_vertices(ring_batch + most_lanes), done_words(done_vertices.size());
        std::size_t done = 0;
        const auto flush = [&] {
            if (!writer_.finish(work.pool, {done_vertices.data(), done}, done_words.data()))
                given_up_ = true;
            done = 0;
        };
        for (std::size_t t = range.begin; t < range.end && !given_up_;) {
            const std::uint64_t degenerate = work.counts.degenerate;
            const std::size_t n = contributions_.run(t, range.end, *scratch, work.counts);
            const bool any_degenerate = work.counts.degenerate != degenerate;
            for (std::size_t i = 0; i < n; ++i)
                triangle_flags[t + i] =
                    std::uint8_t(scratch->planes[0][i].code >> triangle_flags_shift);
            if (store_.complete)
                for (std::size_t k = 0; k < 3; ++k)
                    std::copy_n(scratch->planes[k], n, store_.planes[k].data() + t);
            if (done > ring_batch - block_corners) flush();
            if (!work.pool.ensure(block_corners, valences_.words.size())) {
                given_up_ = true;
                return;
            }
            // Likewise where most vertices are at work at once.
            if (store_.complete && work_.size() == 1 &&
                work.pool.sums.size() > valences_.words.size() / 2 + block_corners) {
                store_.complete = false;
                for (auto& plane : store_.planes) plane = {};
            }
            done = add_block(t, n, any_degenerate, *scratch, work, done_vertices.data(),
                             done_words.data(), done);
            t += n;
            if (!tried && t >= trial_end) {
                tried = true;
                flush();
                if (lists_are_better(range.begin, t)) given_up_ = true;
            }
        }
        flush();
    }

    // Adds the contributions of n triangles from t on; gives the number of vertices that are done
    // with.
    std::size_t add_block(std::size_t t, std::size_t n, bool any_degenerate,
                          const BlockContributions::Scratch& scratch, RangeWork& work,
                          Index* done_vertices, Index* done_words, std::size_t done) {
        const Contribution* const planes[3] = {scratch.planes[0], scratch.planes[1],
                                               scratch.planes[2]};
        VertexPool& pool = work.pool;
        AccumulateState state{
            words_,          pool.sums.data(), pool.rings.data(), pool.free.data(),
            pool.free_count, done_vertices,    done_words,        done};
        AccumulateLists& lists = work.lists;
        add_(input_, t, n, any_degenerate, planes, state, lists);
        pool.free_count = state.free_count;
        for (std::size_t i = 0; i < lists.different_count; ++i) {
            const std::size_t member = 4 * t + lists.different[i];
            VertexSum& sum = pool.sums[VertexWord::slot(words_[vertex(member)])];
            sum.split |= !same_values(corner(member), sum);
        }
        for (std::size_t i = 0; i < lists.left_count; ++i) {
            const std::size_t member = 4 * t + lists.left[i];
            const Index v = vertex(member);
            if (words_[v] == VertexWord::listed)
                look_at_use(v, corner(member));
            else
                note(v, member, planes[member & 3][lists.left[i] >> 2], work);
        }
        return state.done_count;
    }

    Index vertex(std::size_t member) const { return vertices_[3 * (member >> 2) + (member & 3)]; }
    std::size_t corner(std::size_t member) const {
        const std::size_t at = 3 * (member >> 2) + (member & 3);
        return input_.corners == nullptr ? at : input_.corners[at];
    }
    // Other indices may have the same values.
    bool same_values(std::size_t corner, const VertexSum& first) const {
        return writer_.same_values(input_.normals[corner], input_.uvs[corner], first.normal,
                                   first.uv);
    }
    void note(Index v, std::size_t member, const Contribution& contribution,
              RangeWork& work) const {
        work.notes[v >> part_shift_].push_back(
            {contribution.x, contribution.y, contribution.z, contribution.code, Index(member)});
    }

    // Of a listed vertex: has it several normals or UVs?
    void look_at_use(Index v, std::size_t corner) {
        const Index normal = input_.normals[corner], uv = input_.uvs[corner];
        if (valences_.states[v] == pending_vertex) {
            valences_.states[v] = worklist_vertex;
            first_uses_[v] = {normal, uv};
        } else if (!writer_.same_values(normal, uv, first_uses_[v].normal, first_uses_[v].uv)) {
            valences_.states[v] = split_vertex;
            writer_.note_large_split();
        }
    }

    // More than half of the corners at vertices that are done with are at split ones.
    bool lists_are_better(std::size_t begin, std::size_t end) const {
        std::size_t done = 0, split = 0;
        for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
            const Index v = vertices_[i];
            if (words_[v] & (VertexWord::apart | VertexWord::to_come)) continue;
            ++done;
            split += valences_.states[v] == split_vertex;
        }
        return split > done / 2;
    }

    // The shared vertices of a part.
    void add_notes(std::size_t part) {
        VertexPool pool;
        for (RangeWork& work : work_) {
            for (const Note& note : work.notes[part]) {
                if (!pool.ensure(1, valences_.words.size())) {
                    given_up_ = true;
                    return;
                }
                add_note(pool, note);
            }
            work.notes[part] = {};
        }
        const std::size_t count = valences_.words.size();
        const std::size_t end = std::min(count, (part + 1) << part_shift_);
        std::vector<Index> done, words;
        const auto flush = [&] {
            words.clear();
            for (const Index v : done) words.push_back(words_[v]);
            if (!writer_.finish(pool, done, words.data())) given_up_ = true;
            done.clear();
        };
        for (std::size_t v = std::min(count, part << part_shift_); v < end; ++v) {
            const std::uint64_t word = valences_.shared[v / 64] >> (v % 64);
            if (word == 0) {
                v |= 63;  // the last of the word
                continue;
            }
            v += std::size_t(std::countr_zero(word));
            if (v >= end) break;
            done.push_back(Index(v));
            if (done.size() == ring_batch) flush();
        }
        flush();
    }

    void add_note(VertexPool& pool, const Note& note) {
        const std::size_t triangle = note.member >> 2, k = note.member & 3;
        const Index v = vertex(note.member);
        Index& word = words_[v];
        const Index met = VertexWord::met(word);
        if (met == 0) word |= pool.free[--pool.free_count];
        const Index slot = VertexWord::slot(word);
        VertexSum& sum = pool.sums[slot];
        if (add_contribution(input_, triangle, k, {note.x, note.y, note.z, note.code}, met, sum,
                             pool.rings[slot]))
            sum.split |= !same_values(corner(note.member), sum);
        if (met <= most_ring_members) ++word;
    }

    const AccumulateInput input_;
    const AccumulateKernel add_;
    const Index* vertices_;
    Index* words_;
    const BlockContributions& contributions_;
    Valences& valences_;
    ContributionStore& store_;
    FanWriter writer_;
    int part_shift_;
    struct Use {
        Index normal, uv;
    };
    ScratchBuffer<Use> first_uses_;  // of listed vertices
    std::vector<RangeWork> work_;
    std::atomic<bool> given_up_ = false;
};

}  // namespace

bool accumulate(const CornerReader& read, const TangentTriangles& triangles,
                std::span<const Index> vertices, const BlockContributions& contributions,
                const FanOptions& fans, const TangentOptions& options, Valences& valences,
                ContributionStore& store, std::span<glm::vec4> values) {
    return Accumulation(read, triangles, vertices, contributions, fans, options.simd, valences,
                        store, values)
        .run(triangles.count, options.threads);
}

}  // namespace prep::detail
