#include "prep/split_vertices.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "base/parallel.h"
#include "base/step_count.h"
#include "prep/triangulate.h"
#include "surface/corner_steps.h"
#include "surface/vertex_corners.h"

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

// One attribute layer, read by corner.
template <class T>
class Layer {
  public:
    Layer(const CornerLayer<T>& layer, const T& missing) : layer_(&layer), missing_(missing) {}
    T at(Index corner) const {
        const Index i = layer_->indices[corner];
        return i == no_index ? missing_ : layer_->values[i];
    }
    bool same(Index a, Index b) const {
        if (layer_->indices[a] == layer_->indices[b]) return true;
        const T x = at(a), y = at(b);
        return std::memcmp(&x, &y, sizeof(T)) == 0;
    }
    void hash(Index corner, std::uint64_t& h) const {
        const T x = at(corner);
        std::uint32_t words[sizeof(T) / 4];
        std::memcpy(words, &x, sizeof(T));
        for (const std::uint32_t w : words) h = (h ^ w) * 0x9e3779b97f4a7c15u, h ^= h >> 29;
    }

  private:
    const CornerLayer<T>* layer_;
    T missing_;
};

// All that decides whether two corners at one source vertex can share a vertex.
class Attributes {
  public:
    Attributes(const Mesh& mesh, const HardEdges* hard, const SplitOptions& options)
        : mesh_(mesh), hard_(hard) {
        if (!mesh.normals.empty()) normals_.emplace_back(mesh.normals, missing_normal);
        if (!mesh.tangents.empty()) tangents_.emplace_back(mesh.tangents, missing_tangent);
        for (const auto& layer : mesh.uvs)
            if (!layer.empty()) uvs_.emplace_back(layer, missing_uv);
        for (const auto& layer : mesh.colors)
            if (!layer.empty()) colors_.emplace_back(layer, missing_color);
        if (!mesh.corner_file_vertices.empty() &&
            !(mesh.morph_targets.empty() && mesh.vertex_attributes.empty()))
            file_vertices_ = mesh.corner_file_vertices.data();
        parts_apart_ = options.parts_apart && !uniform(mesh.face_parts);
        materials_apart_ = !uniform(mesh.face_materials);
        triangles_ = detail::all_triangles(MeshView(mesh));
        if ((parts_apart_ || materials_apart_ || hard) && !triangles_) {
            corner_faces_.resize(mesh.corner_count());
            for (Index f = 0; f < mesh.face_count(); ++f)
                for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
                    corner_faces_[c] = f;
        }
    }

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
        if (file_vertices_) h = (h ^ file_vertices_[c]) * 0x9e3779b97f4a7c15u;
        return h;
    }

    // Why corner c cannot share the vertex of corner `first`.
    SplitReasons reasons(Index first, Index c) const {
        unsigned bits = 0;
        const auto add = [&](SplitReason r) { bits |= unsigned(r); };
        for (const auto& l : normals_) {
            if (l.same(first, c)) continue;
            if (!hard_) {
                add(SplitReason::authored_normal);
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
    static bool uniform(const std::vector<Index>& v) {
        return std::all_of(v.begin(), v.end(), [&](Index x) { return x == v.front(); });
    }
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
    const Index* file_vertices_ = nullptr;
    bool parts_apart_ = false, materials_apart_ = false, triangles_ = false;
    std::vector<Layer<glm::vec3>> normals_;
    std::vector<Layer<glm::vec4>> tangents_;
    std::vector<Layer<glm::vec2>> uvs_;
    std::vector<Layer<glm::vec4>> colors_;
    std::vector<Index> corner_faces_;
};

struct Block {                         // the vertices made from one block of source vertices
    std::vector<Index> first_corners;  // no_index: a vertex that only lines or points use
    std::vector<Index> sources;
    std::vector<SplitReasons> reasons;
};

class VertexSplitter {
  public:
    VertexSplitter(const Attributes& attributes, Block& block, std::vector<Index>& corner_out)
        : attributes_(attributes), block_(block), corner_out_(corner_out) {}

    ~VertexSplitter() { detail::count_steps(steps_); }
    VertexSplitter(const VertexSplitter&) = delete;
    VertexSplitter& operator=(const VertexSplitter&) = delete;

    // `corner_out` gets numbers within the block.
    void split(Index v, std::span<const Index> corners) {
        first_copy_ = block_.first_corners.size();
        if (!by_hash_.empty()) by_hash_.clear();
        for (const Index c : corners) {
            const bool hashed = block_.first_corners.size() - first_copy_ > linear_search_limit;
            Index found = hashed ? find_by_hash(c) : find(c);
            if (found == no_index) {
                found = Index(block_.first_corners.size());
                block_.reasons.push_back(
                    found == first_copy_
                        ? SplitReasons(0)
                        : attributes_.reasons(block_.first_corners[first_copy_], c));
                block_.first_corners.push_back(c);
                block_.sources.push_back(v);
                if (hashed) by_hash_.emplace(attributes_.hash(c), found);
            }
            corner_out_[c] = found;
        }
    }

  private:
    Index find(Index c) {
        for (std::size_t k = first_copy_; k < block_.first_corners.size(); ++k, ++steps_)
            if (attributes_.same(block_.first_corners[k], c)) return Index(k);
        return no_index;
    }
    Index find_by_hash(Index c) {
        if (by_hash_.empty())
            for (std::size_t k = first_copy_; k < block_.first_corners.size(); ++k)
                by_hash_.emplace(attributes_.hash(block_.first_corners[k]), Index(k));
        const auto [begin, end] = by_hash_.equal_range(attributes_.hash(c));
        for (auto it = begin; it != end; ++it, ++steps_)
            if (attributes_.same(block_.first_corners[it->second], c)) return it->second;
        return no_index;
    }

    const Attributes& attributes_;
    Block& block_;
    std::vector<Index>& corner_out_;
    std::size_t first_copy_ = 0;
    std::size_t steps_ = 0;  // comparisons of corners that differ
    std::unordered_multimap<std::uint64_t, Index> by_hash_;
};

// Triangles sorted by (part, material), source order within.
class RangeMaker {
  public:
    RangeMaker(const Mesh& mesh, const SplitOptions& options, VertexMesh& out)
        : mesh_(mesh),
          threads_(options.threads),
          by_part_(options.parts_apart && !mesh.face_parts.empty()),
          out_(out) {}

    void run() {
        const MeshView view(mesh_);
        triangles_ = view.corner_count() - 2 * view.face_count();
        if (!detail::all_triangles(view)) cut_ = triangulate(view, threads_);
        out_.indices.resize(triangles_ * 3);
        out_.triangle_faces.resize(triangles_);
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
        if (!keyed()) {
            out_.ranges.push_back({0, Index(triangles_), no_index, no_index});
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
    bool keyed() const { return by_part_ || !mesh_.face_materials.empty(); }
    std::uint64_t key_of(Index f) const {
        const Index part = by_part_ ? mesh_.face_parts[f] : no_index;
        const Index material = mesh_.face_materials.empty() ? no_index : mesh_.face_materials[f];
        return std::uint64_t(part) << 32 | material;
    }
    // Empty where the source order is the right one.
    std::vector<Index> sorted_order() const {
        if (!keyed()) return {};
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
    bool by_part_;
    VertexMesh& out_;
    std::size_t triangles_ = 0;
    Triangulation cut_;  // empty where every face is a triangle
};

}  // namespace

Result<VertexMesh> split(const Mesh& mesh, const HardEdges* hard, const SplitOptions& options) {
    const std::size_t sources = mesh.vertex_count();
    if (mesh.corner_count() + sources >= no_index)
        return Error{ErrorCode::limit,
                     "more than 2^32 - 2 corners and vertices: cut the mesh into pieces",
                     mesh.name};
    const Attributes attributes(mesh, hard, options);
    const detail::VertexCorners at =
        detail::corners_by_vertex(mesh.corner_vertices, sources, options.threads);
    std::vector<bool> loose(sources, false);
    for (const Index v : mesh.line_vertices) loose[v] = true;
    for (const Index v : mesh.points) loose[v] = true;

    VertexMesh out;
    out.origin = mesh.origin;
    out.corner_vertices.resize(mesh.corner_count());
    std::vector<Block> blocks((sources + vertex_grain - 1) / vertex_grain);
    detail::parallel_blocks(
        sources, vertex_grain, options.threads, [&](std::size_t begin, std::size_t end) {
            Block& block = blocks[begin / vertex_grain];
            const std::size_t likely = (end - begin) + (end - begin) / 8;
            block.first_corners.reserve(likely);
            block.sources.reserve(likely);
            block.reasons.reserve(likely);
            VertexSplitter splitter(attributes, block, out.corner_vertices);
            for (std::size_t v = begin; v < end; ++v) {
                const std::span<const Index> corners(at.corners.data() + at.offsets[v],
                                                     at.offsets[v + 1] - at.offsets[v]);
                if (!corners.empty()) {
                    splitter.split(Index(v), corners);
                } else if (loose[v]) {
                    block.first_corners.push_back(no_index);
                    block.sources.push_back(Index(v));
                    block.reasons.push_back(0);
                }
            }
        });

    std::vector<Index> bases(blocks.size() + 1, 0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        bases[b + 1] = bases[b] + Index(blocks[b].sources.size());
    detail::parallel_blocks(mesh.corner_count(), 3 * triangle_grain, options.threads,
                            [&](std::size_t begin, std::size_t end) {
                                for (std::size_t c = begin; c < end; ++c)
                                    out.corner_vertices[c] +=
                                        bases[mesh.corner_vertices[c] / vertex_grain];
                            });
    const std::size_t vertices = bases.back();
    out.positions.resize(vertices);
    out.source_vertices.resize(vertices);
    out.source_corners.resize(vertices);
    out.split_reasons.resize(vertices);
    if (!mesh.normals.empty()) out.normals.resize(vertices);
    if (!mesh.tangents.empty()) out.tangents.resize(vertices);
    out.uvs.resize(mesh.uvs.size());
    for (auto& set : out.uvs) set.resize(vertices, missing_uv);
    // Loose vertices bring colours of their own where no face layer exists.
    const std::size_t color_sets =
        std::max<std::size_t>(mesh.colors.size(), mesh.vertex_colors.empty() ? 0 : 1);
    out.colors.resize(color_sets);
    for (auto& set : out.colors) set.resize(vertices, missing_color);

    const Layer<glm::vec3> normals(mesh.normals, missing_normal);
    const Layer<glm::vec4> tangents(mesh.tangents, missing_tangent);
    detail::parallel_blocks(
        sources, vertex_grain, options.threads, [&](std::size_t begin, std::size_t) {
            const Block& block = blocks[begin / vertex_grain];
            const Index base = bases[begin / vertex_grain];
            for (std::size_t k = 0; k < block.sources.size(); ++k) {
                const std::size_t i = base + k;
                const Index c = block.first_corners[k], v = block.sources[k];
                out.positions[i] = mesh.positions[v];
                out.source_vertices[i] = v;
                out.source_corners[i] = c;
                out.split_reasons[i] = block.reasons[k];
                const bool on_face = c != no_index;
                if (!out.normals.empty()) out.normals[i] = on_face ? normals.at(c) : missing_normal;
                if (!out.tangents.empty())
                    out.tangents[i] = on_face ? tangents.at(c) : missing_tangent;
                for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
                    if (on_face && !mesh.uvs[s].empty())
                        out.uvs[s][i] = Layer<glm::vec2>(mesh.uvs[s], missing_uv).at(c);
                for (std::size_t s = 0; s < mesh.colors.size(); ++s)
                    if (on_face && !mesh.colors[s].empty())
                        out.colors[s][i] = Layer<glm::vec4>(mesh.colors[s], missing_color).at(c);
                if (!on_face && !mesh.vertex_colors.empty())
                    out.colors[0][i] = mesh.vertex_colors[v];
            }
        });

    RangeMaker(mesh, options, out).run();

    if (!mesh.line_vertices.empty() || !mesh.points.empty()) {
        std::vector<Index> first_vertex(sources, no_index);
        for (Index i = Index(vertices); i-- > 0;) first_vertex[out.source_vertices[i]] = i;
        for (std::size_t l = 0; l + 1 < mesh.line_offsets.size(); ++l)
            for (Index k = mesh.line_offsets[l]; k + 1 < mesh.line_offsets[l + 1]; ++k) {
                out.lines.push_back(first_vertex[mesh.line_vertices[k]]);
                out.lines.push_back(first_vertex[mesh.line_vertices[k + 1]]);
            }
        for (const Index v : mesh.points) out.points.push_back(first_vertex[v]);
    }
    return out;
}

}  // namespace prep
