#include "vertices/split_vertices.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "base/parallel.h"
#include "base/scratch_buffer.h"
#include "base/step_count.h"
#include "base/uniform.h"
#include "prep/triangulate.h"
#include "surface/corner_steps.h"
#include "vertices/source_corners.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t vertex_grain = 8192;
constexpr std::size_t triangle_grain = 65536;
// Up to this many copies of one vertex are searched one by one, beyond it by hash: a flat-shaded
// pole of valence 100,000 stays linear.
constexpr std::size_t linear_search_limit = 12;

constexpr glm::vec3 missing_normal{0, 0, 1};
constexpr glm::vec4 missing_tangent{1, 0, 0, 1};
constexpr glm::vec2 missing_uv{0, 0};
constexpr glm::vec4 missing_color{1, 1, 1, 1};

// Whether entries have their vertices' numbers, as smooth normals and tangents mostly do: then no
// two corners of a vertex differ.
bool follow_vertices(std::span<const Index> indices, std::span<const Index> corner_vertices,
                     int threads) {
    std::atomic<bool> follow = true;
    detail::parallel_blocks(indices.size(), 3 * triangle_grain, threads,
                            [&](std::size_t begin, std::size_t end) {
                                if (follow.load(std::memory_order_relaxed) &&
                                    !std::equal(indices.begin() + begin, indices.begin() + end,
                                                corner_vertices.begin() + begin))
                                    follow = false;
                            });
    return follow;
}

// One attribute layer, read by corner.
template <class T>
class Layer {
  public:
    // set: its number among the mesh's.
    Layer(const CornerLayer<T>& layer, const T& missing, const Mesh& mesh, int threads,
          std::size_t set = 0)
        : layer_(&layer),
          missing_(missing),
          set_(set),
          follows_(follow_vertices(layer.indices, mesh.corner_vertices, threads)) {}
    T at(Index corner) const { return value(layer_->indices[corner]); }
    // The same of a vertex' corner; first: of its first, after set_firsts().
    T of(Index vertex, Index corner, bool first) const {
        if (follows_) return layer_->values[vertex];
        return first ? value(firsts_[vertex]) : at(corner);
    }
    // By vertex the entry of its first corner; not where they follow vertices.
    void set_firsts(const Index* firsts) { firsts_ = firsts; }
    bool follows() const { return follows_; }
    std::size_t set() const { return set_; }
    bool same(Index a, Index b) const {
        if (layer_->indices[a] == layer_->indices[b]) return true;
        const T x = at(a), y = at(b);
        return std::memcmp(&x, &y, sizeof(T)) == 0;
    }
    const Index* indices() const { return layer_->indices.data(); }
    void hash(Index corner, std::uint64_t& h) const {
        const T x = at(corner);
        std::uint32_t words[sizeof(T) / 4];
        std::memcpy(words, &x, sizeof(T));
        for (const std::uint32_t w : words) h = (h ^ w) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    }

  private:
    T value(Index i) const { return i == no_index ? missing_ : layer_->values[i]; }

    const CornerLayer<T>* layer_;
    T missing_;
    std::size_t set_;
    bool follows_;
    const Index* firsts_ = nullptr;
};

// All that decides whether two corners at one source vertex can share a vertex.
class Attributes {
  public:
    Attributes(const Mesh& mesh, const HardEdges* hard, const std::vector<bool>* computed,
               SplitReason unmarked, const SplitOptions& options)
        : mesh_(mesh),
          hard_(hard),
          computed_(computed),
          unmarked_(unmarked),
          threads_(options.threads) {
        const int threads = threads_;
        if (!mesh.normals.empty())
            normals_.emplace_back(mesh.normals, missing_normal, mesh, threads);
        if (!mesh.tangents.empty())
            tangents_.emplace_back(mesh.tangents, missing_tangent, mesh, threads);
        for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
            if (!mesh.uvs[s].empty()) uvs_.emplace_back(mesh.uvs[s], missing_uv, mesh, threads, s);
        for (std::size_t s = 0; s < mesh.colors.size(); ++s)
            if (!mesh.colors[s].empty())
                colors_.emplace_back(mesh.colors[s], missing_color, mesh, threads, s);
        if (!mesh.corner_file_vertices.empty() &&
            !(mesh.morph_targets.empty() && mesh.vertex_attributes.empty()))
            file_vertices_ = mesh.corner_file_vertices.data();
        const auto list = [&](const auto& layers) {
            for (const auto& l : layers)
                if (!l.follows()) lists_.push_back({l.indices(), {}});
        };
        list(normals_);
        list(tangents_);
        list(uvs_);
        list(colors_);
        if (file_vertices_) lists_.push_back({file_vertices_, {}});
        parts_apart_ = options.parts_apart && !detail::is_uniform<Index>(mesh.face_parts);
        materials_apart_ = !detail::is_uniform<Index>(mesh.face_materials);
        triangles_ = detail::all_triangles(MeshView(mesh));
        if ((parts_apart_ || materials_apart_ || hard) && !triangles_) {
            corner_faces_.resize(mesh.corner_count());
            for (Index f = 0; f < mesh.face_count(); ++f)
                for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
                    corner_faces_[c] = f;
        }
    }

    // What is looked up below by vertex. Corners of a vertex may lie anywhere: to go to each from
    // the vertex would read the layers in no order, while going through corners in theirs reads but
    // what there is of each vertex in no order.
    void compare(const detail::SourceCorners& corners) {
        const std::size_t vertices = mesh_.vertex_count();
        differ_ = detail::ScratchBuffer<std::uint8_t>(vertices);
        std::memset(differ_.data(), 0, vertices);
        for (List& list : lists_) {
            list.firsts = detail::ScratchBuffer<Index>(vertices);
            detail::parallel_blocks(vertices, vertex_grain, threads_,
                                    [&](std::size_t begin, std::size_t end) {
                                        for (std::size_t v = begin; v < end; ++v)
                                            if (corners.is_used(v))
                                                list.firsts[v] = list.indices[corners.first(v)];
                                    });
        }
        const bool groups = parts_apart_ || materials_apart_;
        detail::parallel_blocks(
            mesh_.corner_count(), 3 * triangle_grain, threads_,
            [&](std::size_t begin, std::size_t end) {
                const auto differs = [&](Index v) {
                    std::atomic_ref(differ_[v]).store(1, std::memory_order_relaxed);
                };
                for (const List& list : lists_)
                    for (std::size_t c = begin; c < end; ++c)
                        if (const Index v = mesh_.corner_vertices[c];
                            list.indices[c] != list.firsts[v])
                            differs(v);
                for (std::size_t c = begin; groups && c < end; ++c)
                    if (const Index v = mesh_.corner_vertices[c];
                        !same_group(corners.first(v), Index(c)))
                        differs(v);
            });
        std::size_t list = 0;
        const auto hand_out = [&](auto& layers) {
            for (auto& l : layers)
                if (!l.follows()) l.set_firsts(lists_[list++].firsts.data());
        };
        hand_out(normals_);
        hand_out(tangents_);
        hand_out(uvs_);
        hand_out(colors_);
    }

    // Gives the values of a vertex' corner to `to`: normal(), tangent(), and for each set uv() and
    // color(). first: it is the vertex' first.
    template <class To>
    void values(Index vertex, Index corner, bool first, const To& to) const {
        for (const auto& l : normals_) to.normal(l.of(vertex, corner, first));
        for (const auto& l : tangents_) to.tangent(l.of(vertex, corner, first));
        for (const auto& l : uvs_) to.uv(l.set(), l.of(vertex, corner, first));
        for (const auto& l : colors_) to.color(l.set(), l.of(vertex, corner, first));
    }

    // By vertex: not 0 where its corners have different entries of a layer, or are of different
    // groups. They may have the same values still.
    std::span<const std::uint8_t> differ() const { return differ_; }

    bool same(Index a, Index b) const {
        for (const auto& l : normals_)
            if (!l.same(a, b)) return false;
        for (const auto& l : uvs_)
            if (!l.same(a, b)) return false;
        for (const auto& l : tangents_)
            if (!l.same(a, b)) return false;
        for (const auto& l : colors_)
            if (!l.same(a, b)) return false;
        if (file_vertices_ && file_vertices_[a] != file_vertices_[b]) return false;
        return same_group(a, b);
    }

    std::uint64_t hash(Index c) const {
        std::uint64_t h = 0x243f6a8885a308d3u;
        for (const auto& l : normals_) l.hash(c, h);
        for (const auto& l : uvs_) l.hash(c, h);
        for (const auto& l : tangents_) l.hash(c, h);
        for (const auto& l : colors_) l.hash(c, h);
        const auto add = [&h](Index i) { h = (h ^ i) * 0x9e3779b97f4a7c15u, h ^= h >> 29; };
        if (file_vertices_) add(file_vertices_[c]);
        if (parts_apart_) add(mesh_.face_parts[face_of(c)]);
        if (materials_apart_) add(mesh_.face_materials[face_of(c)]);
        return h;
    }

    // Why corner c cannot share the vertex of corner `first`.
    SplitReasons reasons(Index first, Index c) const {
        unsigned bits = 0;
        const auto add = [&](SplitReason r) { bits |= unsigned(r); };
        for (const auto& l : normals_) {
            if (l.same(first, c)) continue;
            if (!hard_ || (computed_ && !((*computed_)[first] && (*computed_)[c]))) {
                add(unmarked_);
                continue;
            }
            // Computed normals differ because of the edges at either corner; a border only where
            // there is nothing else.
            const unsigned around =
                unsigned(edge_reasons(first) | edge_reasons(c)) & ~unsigned(hard_border);
            if (around & hard_smoothing_group) add(SplitReason::smoothing_group);
            if (around != hard_smoothing_group) add(SplitReason::hard_edge);
        }
        for (const auto& l : uvs_)
            if (!l.same(first, c)) add(SplitReason::uv_seam);
        for (const auto& l : tangents_) {
            if (l.same(first, c)) continue;
            if (l.at(first).w != l.at(c).w)
                add(SplitReason::mirrored_uv);
            else if (bits == 0)
                add(SplitReason::tangent);
        }
        for (const auto& l : colors_)
            if (!l.same(first, c)) add(SplitReason::color);
        if (!same_group(first, c)) add(SplitReason::material);
        return SplitReasons(bits);
    }

  private:
    bool same_group(Index a, Index b) const {
        if (!parts_apart_ && !materials_apart_) return true;
        const Index f = face_of(a), g = face_of(b);
        return (!parts_apart_ || mesh_.face_parts[f] == mesh_.face_parts[g]) &&
               (!materials_apart_ || mesh_.face_materials[f] == mesh_.face_materials[g]);
    }
    Index face_of(Index c) const { return triangles_ ? c / 3 : corner_faces_[c]; }
    std::uint8_t edge_reasons(Index c) const {
        const Index f = face_of(c);
        const Index begin = mesh_.face_offsets[f], end = mesh_.face_offsets[f + 1];
        return hard_->reasons[c] | hard_->reasons[c == begin ? end - 1 : c - 1];
    }

    const Mesh& mesh_;
    const HardEdges* hard_;
    const std::vector<bool>* computed_;
    SplitReason unmarked_;
    const Index* file_vertices_ = nullptr;
    bool parts_apart_ = false, materials_apart_ = false, triangles_ = false;
    std::vector<Layer<glm::vec3>> normals_;
    std::vector<Layer<glm::vec4>> tangents_;
    std::vector<Layer<glm::vec2>> uvs_;
    std::vector<Layer<glm::vec4>> colors_;
    int threads_;
    // All entries that corners of a vertex may differ in, and by vertex its first corner's.
    struct List {
        const Index* indices;
        detail::ScratchBuffer<Index> firsts;
    };
    std::vector<List> lists_;
    detail::ScratchBuffer<std::uint8_t> differ_;  // by vertex: do they?
    std::vector<Index> corner_faces_;
};

// What a block of source vertices makes beside the first vertex of each.
struct Block {
    struct Copy {  // a further vertex of one, and why
        Index source, first_corner;
        SplitReasons reasons;
    };
    struct Place {  // a corner of such a vertex: the how many-th of its source
        Index corner, copy;
    };
    std::vector<Copy> copies;
    std::vector<Place> places;
    Index sources = 0;  // that are used
    std::size_t vertices() const { return sources + copies.size(); }
};

class VertexSplitter {
  public:
    VertexSplitter(const Attributes& attributes, Block& block)
        : attributes_(attributes), block_(block) {}

    ~VertexSplitter() { detail::count_steps(steps_); }
    VertexSplitter(const VertexSplitter&) = delete;
    VertexSplitter& operator=(const VertexSplitter&) = delete;

    void split(Index v, std::span<const Index> corners) {
        firsts_.clear();
        if (!by_hash_.empty()) by_hash_.clear();
        for (const Index c : corners) {
            const bool hashed = firsts_.size() > linear_search_limit;
            Index found = hashed ? find_by_hash(c) : find(c);
            if (found == no_index) {
                found = Index(firsts_.size());
                if (found > 0) block_.copies.push_back({v, c, attributes_.reasons(firsts_[0], c)});
                firsts_.push_back(c);
                if (hashed) by_hash_.emplace(attributes_.hash(c), found);
            }
            if (found > 0) block_.places.push_back({c, found});
        }
    }

  private:
    Index find(Index c) {
        for (std::size_t k = 0; k < firsts_.size(); ++k, ++steps_)
            if (attributes_.same(firsts_[k], c)) return Index(k);
        return no_index;
    }
    Index find_by_hash(Index c) {
        if (by_hash_.empty())
            for (std::size_t k = 0; k < firsts_.size(); ++k)
                by_hash_.emplace(attributes_.hash(firsts_[k]), Index(k));
        const auto [begin, end] = by_hash_.equal_range(attributes_.hash(c));
        for (auto it = begin; it != end; ++it, ++steps_)
            if (attributes_.same(firsts_[it->second], c)) return it->second;
        return no_index;
    }

    const Attributes& attributes_;
    Block& block_;
    std::vector<Index> firsts_;  // per copy of the vertex its first corner
    std::size_t steps_ = 0;      // comparisons of corners that differ
    std::unordered_multimap<std::uint64_t, Index> by_hash_;
};

// Triangles sorted by (part, material), source order within.
class RangeMaker {
  public:
    RangeMaker(const Mesh& mesh, const SplitOptions& options, VertexMesh& out)
        : mesh_(mesh),
          threads_(options.threads),
          by_part_(options.parts_apart && !mesh.face_parts.empty()),
          one_range_(detail::is_uniform<Index>(mesh.face_materials) &&
                     (!by_part_ || detail::is_uniform<Index>(mesh.face_parts))),
          out_(out) {}

    void run() {
        const MeshView view(mesh_);
        triangles_ = view.corner_count() - 2 * view.face_count();
        if (!detail::all_triangles(view)) cut_ = triangulate(view, threads_);
        const std::vector<Index> order = sorted_order();
        const bool whole = cut_.corners.empty();
        detail::parallel_blocks(
            triangles_, triangle_grain, threads_, [&](std::size_t begin, std::size_t end) {
                for (std::size_t t = begin; t < end; ++t) {
                    const std::size_t s = order.empty() ? t : order[t];
                    out_.triangle_faces[t] = face(s);
                    for (std::size_t k = 3 * t, c = 3 * s; c < 3 * s + 3; ++k, ++c)
                        out_.indices[k] = out_.corner_vertices[whole ? c : cut_.corners[c]];
                }
            });
        if (triangles_ == 0) return;
        if (one_range_) {
            const std::uint64_t key = key_of(0);
            out_.ranges.push_back({0, Index(triangles_), Index(key), Index(key >> 32)});
            return;
        }
        for (std::size_t t = 0; t < triangles_; ++t) {
            const std::uint64_t key = key_of(out_.triangle_faces[t]);
            const Index part = Index(key >> 32), material = Index(key);
            if (out_.ranges.empty() || out_.ranges.back().part != part ||
                out_.ranges.back().material != material)
                out_.ranges.push_back({Index(t), 0, material, part});
            ++out_.ranges.back().triangle_count;
        }
    }

  private:
    Index face(std::size_t t) const {
        return cut_.corners.empty() ? Index(t) : cut_.triangle_faces[t];
    }
    std::uint64_t key_of(Index f) const {
        const Index part = by_part_ ? mesh_.face_parts[f] : no_index;
        const Index material = mesh_.face_materials.empty() ? no_index : mesh_.face_materials[f];
        return std::uint64_t(part) << 32 | material;
    }
    // Empty where the source order is the right one.
    std::vector<Index> sorted_order() const {
        if (one_range_) return {};
        bool sorted = true;
        for (std::size_t t = 1; t < triangles_ && sorted; ++t)
            sorted = key_of(face(t - 1)) <= key_of(face(t));
        if (sorted) return {};
        std::vector<Index> order(triangles_);
        for (Index t = 0; t < triangles_; ++t) order[t] = t;
        std::stable_sort(order.begin(), order.end(),
                         [&](Index a, Index b) { return key_of(face(a)) < key_of(face(b)); });
        return order;
    }

    const Mesh& mesh_;
    int threads_;
    bool by_part_, one_range_;
    VertexMesh& out_;
    std::size_t triangles_ = 0;
    Triangulation cut_;  // empty where every face is a triangle
};

// The mesh's vertices, once their number is known.
class VertexMaker {
  public:
    VertexMaker(const Mesh& mesh, const Attributes& attributes, std::span<const Block> blocks,
                int threads, VertexMesh& out)
        : mesh_(mesh),
          attributes_(attributes),
          blocks_(blocks),
          threads_(threads),
          out_(out),
          bases_(blocks.size() + 1, 0) {
        for (std::size_t b = 0; b < blocks.size(); ++b)
            bases_[b + 1] = bases_[b] + Index(blocks[b].vertices());
    }

    std::size_t vertices() const { return bases_.back(); }

    // All lists at their full size: memory is first touched here, by several threads.
    void make_room() {
        const std::size_t n = vertices(), corners = mesh_.corner_count();
        const std::size_t triangles = corners - 2 * mesh_.face_count();
        std::size_t uv_sets = mesh_.uvs.size();
        while (uv_sets > 0 && mesh_.uvs[uv_sets - 1].empty()) --uv_sets;
        out_.uvs.resize(uv_sets);
        // Loose vertices bring colours of their own where no face layer exists.
        out_.colors.resize(
            std::max<std::size_t>(mesh_.colors.size(), mesh_.vertex_colors.empty() ? 0 : 1));
        constexpr std::size_t lists = 9;
        detail::parallel_tasks(
            lists + out_.uvs.size() + out_.colors.size(), threads_, [&](std::size_t list) {
                if (list == 0) out_.corner_vertices.resize(corners);
                if (list == 1) out_.indices.resize(3 * triangles);
                if (list == 2 && !mesh_.tangents.empty()) out_.tangents.resize(n);
                if (list == 3 && !mesh_.normals.empty()) out_.normals.resize(n);
                if (list == 4) out_.positions.resize(n);
                if (list == 5) out_.triangle_faces.resize(triangles);
                if (list == 6) out_.source_vertices.resize(n);
                if (list == 7) out_.source_corners.resize(n);
                if (list == 8) out_.split_reasons.resize(n);
                if (list < lists) return;
                list -= lists;
                if (list < out_.uvs.size())
                    out_.uvs[list].resize(mesh_.uvs[list].empty() ? 0 : n, missing_uv);
                else
                    out_.colors[list - out_.uvs.size()].resize(n, missing_color);
            });
    }

    // `loose`: source vertices that lines or points use.
    void fill(const detail::SourceCorners& corners, const std::vector<bool>& loose) {
        const std::size_t sources = mesh_.vertex_count();
        detail::ScratchBuffer<Index> numbers(sources);
        detail::parallel_blocks(
            sources, vertex_grain, threads_, [&](std::size_t begin, std::size_t end) {
                const Block& block = blocks_[begin / vertex_grain];
                Index number = bases_[begin / vertex_grain];
                auto copy = block.copies.begin();
                for (Index v = Index(begin); v < end; ++v) {
                    numbers[v] = number;
                    if (!corners.is_used(v)) {
                        if (loose[v]) fill_loose(number++, v);
                        continue;
                    }
                    fill_vertex(number++, v, corners.first(v), 0, true);
                    for (; copy != block.copies.end() && copy->source == v; ++copy)
                        fill_vertex(number++, v, copy->first_corner, copy->reasons, false);
                }
            });
        detail::parallel_blocks(mesh_.corner_count(), 3 * triangle_grain, threads_,
                                [&](std::size_t begin, std::size_t end) {
                                    for (std::size_t c = begin; c < end; ++c)
                                        out_.corner_vertices[c] = numbers[mesh_.corner_vertices[c]];
                                });
        detail::parallel_blocks(blocks_.size(), 1, threads_, [&](std::size_t b, std::size_t) {
            for (const Block::Place& place : blocks_[b].places)
                out_.corner_vertices[place.corner] += place.copy;
        });
    }

  private:
    void fill_vertex(std::size_t i, Index source, Index corner, SplitReasons reasons, bool first) {
        out_.positions[i] = mesh_.positions[source];
        out_.source_vertices[i] = source;
        out_.source_corners[i] = corner;
        out_.split_reasons[i] = reasons;
        attributes_.values(source, corner, first, Values{out_, i});
    }
    struct Values {
        VertexMesh& out;
        std::size_t i;
        void normal(const glm::vec3& n) const { out.normals[i] = n; }
        void tangent(const glm::vec4& t) const { out.tangents[i] = t; }
        void uv(std::size_t set, const glm::vec2& uv) const { out.uvs[set][i] = uv; }
        void color(std::size_t set, const glm::vec4& c) const { out.colors[set][i] = c; }
    };
    void fill_loose(std::size_t i, Index source) {
        out_.positions[i] = mesh_.positions[source];
        out_.source_vertices[i] = source;
        out_.source_corners[i] = no_index;
        if (!out_.normals.empty()) out_.normals[i] = missing_normal;
        if (!out_.tangents.empty()) out_.tangents[i] = missing_tangent;
        if (!mesh_.vertex_colors.empty()) out_.colors[0][i] = mesh_.vertex_colors[source];
    }

    const Mesh& mesh_;
    const Attributes& attributes_;
    std::span<const Block> blocks_;
    int threads_;
    VertexMesh& out_;
    std::vector<Index> bases_;  // per block its first vertex, and their number
};

}  // namespace

namespace detail {

Result<VertexMesh> split_vertices(const Mesh& mesh, const HardEdges* hard,
                                  const VertexCorners* around, const SplitOptions& options,
                                  const std::vector<bool>* computed, SplitReason unmarked) {
    const std::size_t sources = mesh.vertex_count();
    if (mesh.corner_count() + sources >= no_index)
        return Error{ErrorCode::limit,
                     "more than 2^32 - 2 corners and vertices: cut the mesh into pieces",
                     mesh.name};
    std::optional<SourceCorners> corners(std::in_place, mesh.corner_vertices, sources, around,
                                         options.threads);
    Attributes attributes(mesh, hard, computed, unmarked, options);
    attributes.compare(*corners);
    const std::span<const std::uint8_t> differ = attributes.differ();
    corners->make_lists(differ);
    std::vector<bool> loose(sources, false);
    for (const Index v : mesh.line_vertices) loose[v] = true;
    for (const Index v : mesh.points) loose[v] = true;

    std::vector<Block> blocks((sources + vertex_grain - 1) / vertex_grain);
    parallel_blocks(sources, vertex_grain, options.threads,
                    [&](std::size_t begin, std::size_t end) {
                        Block& block = blocks[begin / vertex_grain];
                        VertexSplitter splitter(attributes, block);
                        for (std::size_t v = begin; v < end; ++v) {
                            if (differ[v] != 0) splitter.split(Index(v), corners->of(v));
                            block.sources += corners->is_used(v) || loose[v];
                        }
                    });
    VertexMesh out;
    out.origin = mesh.origin;
    VertexMaker maker(mesh, attributes, blocks, options.threads, out);
    maker.make_room();
    maker.fill(*corners, loose);
    corners.reset();
    RangeMaker(mesh, options, out).run();

    if (!mesh.line_vertices.empty() || !mesh.points.empty()) {
        std::vector<Index> first_vertex(sources, no_index);
        for (Index i = Index(out.vertex_count()); i-- > 0;)
            first_vertex[out.source_vertices[i]] = i;
        for (std::size_t l = 0; l + 1 < mesh.line_offsets.size(); ++l)
            for (Index k = mesh.line_offsets[l]; k + 1 < mesh.line_offsets[l + 1]; ++k) {
                out.lines.push_back(first_vertex[mesh.line_vertices[k]]);
                out.lines.push_back(first_vertex[mesh.line_vertices[k + 1]]);
            }
        for (const Index v : mesh.points) out.points.push_back(first_vertex[v]);
    }
    return out;
}

}  // namespace detail

Result<VertexMesh> split(const Mesh& mesh, const HardEdges* hard, const SplitOptions& options) {
    return detail::split_vertices(mesh, hard, nullptr, options);
}

}  // namespace prep
