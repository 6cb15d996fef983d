#include "tangents/accumulate.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <deque>
#include <memory>

#include "base/parallel.h"
#include "tangents/adding.h"
#include "tangents/worklist.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// What is noted for shared vertices is sorted into that many parts by vertex, added at once.
constexpr int part_bits = 4;
constexpr std::size_t parts = std::size_t(1) << part_bits;
// After so many triangles of a range it is looked whether lists are the better way.
constexpr std::size_t trial = 4096;
// Terms of all triangles are kept up to so many, where notes do not take the memory, and where more
// than an eighth of the corners are at vertices that will be listed: to make them again would take
// longer.
constexpr std::size_t few_triangles = 65536;
// Corners of a block of terms: so many vertices may be opened, and be done with, by one.
constexpr std::size_t block_corners = 3 * TermBlock::size;

struct Note {
    float x, y, z;
    Index code, member;  // four times the triangle plus 0, 1 or 2
};

// Room for vertices that are not done with.
class Pool {
  public:
    VertexSum* sums() { return sums_.data(); }
    VertexRing* rings() { return rings_.data(); }
    Index* free() { return free_.data(); }  // as in AddState
    std::size_t& free_count() { return free_count_; }
    RingBatch& batch() {
        if (!batch_) batch_ = std::make_unique<RingBatch>();
        return *batch_;
    }

    std::size_t size() const { return sums_.size(); }

    // Makes that many slots free, where no more than `most` are ever in use; false where there are
    // too many.
    bool ensure(std::size_t wanted, std::size_t most) {
        return free_count_ >= wanted || grow(wanted, most + wanted);
    }

  private:
    template <class T>
    static void enlarge(ScratchBuffer<T>& buffer, std::size_t size) {
        ScratchBuffer<T> larger(size);
        std::copy_n(buffer.data(), buffer.size(), larger.data());
        buffer = std::move(larger);
    }
    bool grow(std::size_t wanted, std::size_t most) {
        const std::size_t old = sums_.size(),
                          size = std::max(std::min(2 * old, most), old + wanted);
        if (size > VertexWord::most_slots) return false;
        enlarge(sums_, size);
        enlarge(rings_, size);
        enlarge(free_, size);
        // The lowest on top: those are used again and again.
        for (std::size_t slot = size; slot-- > old;) {
            sums_[slot] = VertexSum();
            free_[free_count_++] = Index(slot) * VertexWord::slot_one;
        }
        return true;
    }

    ScratchBuffer<VertexSum> sums_;
    ScratchBuffer<VertexRing> rings_;
    ScratchBuffer<Index> free_;
    std::size_t free_count_ = 0;
    std::unique_ptr<RingBatch> batch_;
};

// Lists may be written to up to a vector behind their end.
constexpr std::size_t most_lanes = 16;

struct RangeWork {
    Pool pool;
    AddLists lists;
    std::deque<Note> notes[parts];
    TermCounts counts;
};

class Adder {
  public:
    Adder(const TangentInput& in, const TangentTriangles& triangles,
          std::span<const Index> vertices, const TermMaker& maker, const FanMaker& fans,
          VertexCounts& counts, Terms& terms, std::span<glm::vec4> values, SimdLevel simd)
        : in_(in),
          adding_{vertices.data(), triangles.implicit() ? nullptr : triangles.corners.data(),
                  in.normals.indices.data(), in.uv.indices.data()},
          add_(add_kernel(simd)),
          vertices_(vertices.data()),
          words_(counts.words.data()),
          maker_(maker),
          fans_(fans),
          counts_(counts),
          terms_(terms),
          values_(values),
          part_shift_(std::max(0, int(std::bit_width(counts.words.size())) - part_bits)),
          first_uses_(counts.listed_corners > 0 ? counts.words.size() : 0),
          work_(counts.ranges.size()),
          split_neighbours_(counts.words.size() / 64 + 1) {}

    bool run(std::size_t triangles, int threads) {
        terms_.triangle_flags = ScratchBuffer<std::uint8_t>(triangles);
        terms_.complete = (triangles <= few_triangles && few_notes()) ||
                          8 * counts_.listed_corners > 3 * triangles;
        if (terms_.complete)
            for (auto& plane : terms_.planes) plane = ScratchBuffer<CornerTerm>(triangles);
        parallel_blocks(work_.size(), 1, threads, [&](std::size_t r, std::size_t) {
            go_through(r);
            work_[r].pool = {};
        });
        terms_.counts = {};
        for (const RangeWork& work : work_) terms_.counts.add(work.counts);
        if (terms_.counts.nan) given_up_ = true;
        if (work_.size() > 1 && !given_up_)
            parallel_blocks(parts, 1, threads,
                            [&](std::size_t part, std::size_t) { add_notes(part); });
        // A listed vertex that met nothing has degenerate triangles alone.
        if (!first_uses_.empty() &&
            std::memchr(counts_.states.data(), pending_vertex, counts_.states.size()) != nullptr)
            given_up_ = true;
        terms_.complete &= !given_up_;
        if (given_up_) return false;
        if (large_split_)
            list_split_neighbours({vertices_, 3 * triangles}, threads, counts_.states);
        else
            list_neighbours();
        return true;
    }

  private:
    // Of what several ranges share.
    bool few_notes() const {
        std::size_t shared = 0;
        for (const std::uint64_t word : counts_.shared) shared += std::size_t(std::popcount(word));
        return shared <= counts_.words.size() / 4;
    }

    void go_through(std::size_t r) {
        const VertexCounts::Range& range = counts_.ranges[r];
        RangeWork& work = work_[r];
        const auto room = std::make_unique<TermMaker::Room>();
        const std::size_t trial_end = std::min(range.end, range.begin + trial);
        bool tried = range.end - range.begin < trial;
        std::uint8_t* const triangle_flags = terms_.triangle_flags.data();
        std::vector<Index> done_vertices(ring_batch + most_lanes), done_words(done_vertices.size());
        std::size_t done = 0;
        const auto flush = [&] {
            finish(work.pool, {done_vertices.data(), done}, done_words.data());
            done = 0;
        };
        for (std::size_t t = range.begin; t < range.end && !given_up_;) {
            const std::uint64_t degenerate = work.counts.degenerate;
            const std::size_t n = maker_.run(t, range.end, *room, work.counts);
            const bool any_degenerate = work.counts.degenerate != degenerate;
            for (std::size_t i = 0; i < n; ++i)
                triangle_flags[t + i] =
                    std::uint8_t(room->planes[0][i].code >> triangle_flags_shift);
            if (terms_.complete)
                for (std::size_t k = 0; k < 3; ++k)
                    std::copy_n(room->planes[k], n, terms_.planes[k].data() + t);
            if (done > ring_batch - block_corners) flush();
            if (!work.pool.ensure(block_corners, counts_.words.size())) {
                given_up_ = true;
                return;
            }
            if (terms_.complete && work_.size() == 1 &&
                work.pool.size() > counts_.words.size() / 2 + block_corners)
                forget_terms();
            done = add_block(t, n, any_degenerate, *room, work, done_vertices.data(),
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

    // In an order without neighbours most vertices are at work at once: both would be too much.
    void forget_terms() {
        terms_.complete = false;
        for (auto& plane : terms_.planes) plane = {};
    }

    // Adds the terms of n triangles from t on; gives the number of vertices that are done with.
    std::size_t add_block(std::size_t t, std::size_t n, bool any_degenerate,
                          const TermMaker::Room& room, RangeWork& work, Index* done_vertices,
                          Index* done_words, std::size_t done) {
        const CornerTerm* const planes[3] = {room.planes[0], room.planes[1], room.planes[2]};
        Pool& pool = work.pool;
        AddState state{words_,        pool.sums(), pool.rings(), pool.free(), pool.free_count(),
                       done_vertices, done_words,  done};
        AddLists& lists = work.lists;
        add_(adding_, t, n, any_degenerate, planes, state, lists);
        pool.free_count() = state.free_count;
        for (std::size_t i = 0; i < lists.different_count; ++i) {
            const std::size_t member = 4 * t + lists.different[i];
            VertexSum& sum = pool.sums()[VertexWord::slot(words_[vertex(member)])];
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
        return adding_.corners == nullptr ? at : adding_.corners[at];
    }
    // Other indices may have the same values.
    bool same_values(std::size_t corner, const VertexSum& first) const {
        return same_values(adding_.normals[corner], adding_.uvs[corner], first.normal, first.uv);
    }
    bool same_values(Index normal, Index uv, Index other_normal, Index other_uv) const {
        if (normal == other_normal && uv == other_uv) return true;
        if (normal == no_index || uv == no_index || other_normal == no_index ||
            other_uv == no_index)
            return false;
        return in_.normals.values[normal] == in_.normals.values[other_normal] &&
               in_.uv.values[uv] == in_.uv.values[other_uv];
    }

    void note(Index v, std::size_t member, const CornerTerm& term, RangeWork& work) const {
        work.notes[v >> part_shift_].push_back({term.x, term.y, term.z, term.code, Index(member)});
    }

    // Of a listed vertex: has it several normals or UVs?
    void look_at_use(Index v, std::size_t corner) {
        const Index normal = adding_.normals[corner], uv = adding_.uvs[corner];
        if (counts_.states[v] == pending_vertex) {
            counts_.states[v] = listed_vertex;
            first_uses_[v] = {normal, uv};
        } else if (!same_values(normal, uv, first_uses_[v].normal, first_uses_[v].uv)) {
            counts_.states[v] = split_vertex;
            large_split_ = true;
        }
    }

    // More than half of the corners at vertices that are done with are at split ones.
    bool lists_are_better(std::size_t begin, std::size_t end) const {
        std::size_t done = 0, split = 0;
        for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
            const Index v = vertices_[i];
            if (words_[v] & (VertexWord::apart | VertexWord::to_come)) continue;
            ++done;
            split += counts_.states[v] == split_vertex;
        }
        return split > done / 2;
    }

    // Up to ring_batch vertices that have met all their triangles, and their words: their slots
    // become free.
    void finish(Pool& pool, std::span<const Index> vertices, const Index* words) {
        if (vertices.empty()) return;
        RingBatch& batch = pool.batch();
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
        if (none_met != 0) {
            given_up_ = true;
            return;
        }
        // Those that met none have no slot to give back.
        Index* const free = pool.free() + pool.free_count();
        for (std::size_t i = 0; i < vertices.size(); ++i)
            free[i] = batch.slots[i] * VertexWord::slot_one;
        Index split[ring_batch];
        std::size_t split_count = 0;
        VertexSum* const sums = pool.sums();
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            VertexSum& sum = sums[batch.slots[i]];
            batch.stars[i] = {sum.x, sum.y, sum.z, 0};
            batch.codes[i] = sum.code;
            batch.normals[i] = sum.normal;
            if (sum.split) split[split_count++] = Index(i);
            sum = VertexSum();
        }
        for (std::size_t k = 0; k < split_count; ++k) batch.codes[split[k]] = 0;
        pool.free_count() += vertices.size();
        fans_.make(pool.rings(), batch, counts_.places, values_, counts_.states);
        for (std::size_t k = 0; k < split_count; ++k) {
            const Index i = split[k];
            counts_.states[batch.vertices[i]] = split_vertex;
            note_neighbours(pool.rings()[batch.slots[i]], batch.members[i]);
        }
    }

    // Over edges to a split vertex triangles may part.
    void note_neighbours(const VertexRing& ring, std::size_t count) {
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

    void list_neighbours() {
        for (std::size_t w = 0; w < split_neighbours_.size(); ++w) {
            for (std::uint64_t rest = split_neighbours_[w]; rest != 0; rest &= rest - 1) {
                std::uint8_t& state = counts_.states[64 * w + std::size_t(std::countr_zero(rest))];
                if (state == fan_vertex) state = listed_vertex;
            }
        }
    }

    // The shared vertices of a part.
    void add_notes(std::size_t part) {
        Pool pool;
        for (RangeWork& work : work_) {
            for (const Note& note : work.notes[part]) {
                if (!pool.ensure(1, counts_.words.size())) {
                    given_up_ = true;
                    return;
                }
                add_note(pool, note);
            }
            work.notes[part] = {};
        }
        const std::size_t count = counts_.words.size();
        const std::size_t end = std::min(count, (part + 1) << part_shift_);
        std::vector<Index> done, words;
        const auto flush = [&] {
            words.clear();
            for (const Index v : done) words.push_back(words_[v]);
            finish(pool, done, words.data());
            done.clear();
        };
        for (std::size_t v = std::min(count, part << part_shift_); v < end; ++v) {
            const std::uint64_t word = counts_.shared[v / 64] >> (v % 64);
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

    void add_note(Pool& pool, const Note& note) {
        const std::size_t triangle = note.member >> 2, k = note.member & 3;
        const Index v = vertex(note.member);
        Index& word = words_[v];
        const Index met = VertexWord::met(word);
        if (met == 0) word |= pool.free()[--pool.free_count()];
        const Index slot = VertexWord::slot(word);
        VertexSum& sum = pool.sums()[slot];
        if (add_term(adding_, triangle, k, {note.x, note.y, note.z, note.code}, met, sum,
                     pool.rings()[slot]))
            sum.split |= !same_values(corner(note.member), sum);
        if (met <= most_ring_members) ++word;
    }

    const TangentInput& in_;
    const AddInput adding_;
    const AddKernel add_;
    const Index* vertices_;
    Index* words_;
    const TermMaker& maker_;
    const FanMaker& fans_;
    VertexCounts& counts_;
    Terms& terms_;
    std::span<glm::vec4> values_;
    int part_shift_;
    struct Use {
        Index normal, uv;
    };
    ScratchBuffer<Use> first_uses_;  // of listed vertices
    std::vector<RangeWork> work_;
    // A bit for each vertex that shares a triangle with a split one, but for split ones of large
    // stars: is there any such?
    std::vector<std::uint64_t> split_neighbours_;
    std::atomic<bool> large_split_ = false;
    std::atomic<bool> given_up_ = false;
};

}  // namespace

bool add_up_vertices(const TangentInput& input, const TangentTriangles& triangles,
                     std::span<const Index> vertices, const TermMaker& maker, const FanMaker& fans,
                     const TangentOptions& options, VertexCounts& counts, Terms& terms,
                     std::span<glm::vec4> values) {
    return Adder(input, triangles, vertices, maker, fans, counts, terms, values, options.simd)
        .run(triangles.count, options.threads);
}

}  // namespace prep::detail
