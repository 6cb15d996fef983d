// A whole mesh: counts, then its channels one after the other, then what faces and edges carry.
#include "prep/subdivide.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/finite.h"
#include "limit_surface/face_varying.h"
#include "model/partial_layers.h"
#include "prep/topology.h"
#include "subdivision/refined_positions.h"
#include "subdivision/refined_skins.h"

namespace prep {
namespace detail {
namespace {

std::string place_of(const Mesh& mesh) {
    return mesh.name.empty() ? std::string() : fmt::format("mesh '{}'", mesh.name);
}

// Before anything is allocated.
Result<void> check_counts(const Mesh& mesh, const SubdivideOptions& options) {
    if (options.level < 0 || options.level > max_subdivision_level)
        return Error{ErrorCode::limit,
                     fmt::format("subdivision level {} is asked for; 0 to {} can be had",
                                 options.level, max_subdivision_level),
                     place_of(mesh)};
    std::uint64_t faces = 0, corners = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const FacePieces pieces =
            pieces_of(mesh.face_offsets[f + 1] - mesh.face_offsets[f], options.level,
                      options.scheme == SubdivisionScheme::loop);
        faces += pieces.faces;
        corners += pieces.corners();
    }
    const std::uint64_t most = std::min<std::uint64_t>(options.max_faces, (no_index - 1ULL) / 4);
    if (faces > most || corners >= no_index)
        return Error{
            ErrorCode::limit,
            fmt::format(
                "level {} would make {} faces with {} corners; the limits are {} faces and {} "
                "corners: ask for a lower level",
                options.level, faces, corners, most, no_index - 1),
            place_of(mesh)};
    return {};
}

// What would spread to all neighbours.
Result<void> check_finite(const Mesh& mesh) {
    for (const MorphTarget& target : mesh.morph_targets)
        for (const VertexDeltas& run : target.positions)
            for (std::size_t k = 0; k < run.values->size(); ++k)
                if (!is_finite((*run.values)[k]))
                    return Error{ErrorCode::invalid,
                                 fmt::format("morph target '{}' moves vertex {} by a number that "
                                             "is not finite",
                                             target.name, run.first_vertex + k),
                                 place_of(mesh)};
    for (const SkinInfluences& set : mesh.skin_influences)
        for (std::size_t v = 0; v < set.weights.size(); ++v)
            if (!is_finite(set.weights[v]))
                return Error{ErrorCode::invalid,
                             fmt::format("a skin weight of vertex {} is not finite", v),
                             place_of(mesh)};
    return {};
}

// Numbers that name things: between two of them lies none.
bool is_name(const VertexAttribute& attribute) {
    return attribute.name.starts_with("_FEATURE_ID_") || attribute.name == "_BATCHID";
}

class Subdivision {
  public:
    Subdivision(const Mesh& mesh, const SubdivideOptions& options)
        : mesh_(mesh), options_(options) {}

    Result<SubdividedMesh> run() {
        if (Result<void> counts = check_counts(mesh_, options_); !counts) return counts.error();
        if (Result<void> finite = check_finite(mesh_); !finite) return finite.error();
        Result<FaceVaryingRule> rule = face_varying_rule(mesh_, options_);
        if (!rule) return rule.error();
        rule_ = *rule;
        Result<SurfaceCage> cage = position_cage(mesh_, options_);
        if (!cage) return cage.error();
        cage_ = std::move(*cage);
        const TargetDeltas targets = target_deltas(mesh_);
        Result<ChannelSurface> surface = position_surface();
        if (!surface) return surface.error();
        const UniformRefinement refinement(mesh_, options_, cage_, surface->cage, surface->tree);
        const NumberedTopology topology =
            refinement.topology(cage_.corner_vertices, cage_.vertex_count);
        const GridNumbering numbering = refinement.numbering(topology);
        RefinedPositions positions = refined_positions(refinement, *surface, numbering);
        Mesh& out = out_.mesh;
        out.positions = std::move(positions.positions);
        out.corner_vertices = std::move(positions.corner_vertices);
        out.normals = std::move(positions.normals);
        out_.fallback_normals = positions.fallback_normals;
        if (!mesh_.skin_influences.empty()) {
            RefinedSkins skins = refined_skins(refinement, *surface, numbering);
            out.skin_influences = std::move(skins.sets);
            out_.largest_dropped_weight = skins.largest_dropped;
        }
        if (Result<void> done = face_varying_layers(refinement); !done) return done.error();
        vertices(numbering);
        faces(refinement);
        edges(refinement, topology, numbering);
        loose_vertices(numbering);
        if (Result<void> done = attributes(refinement); !done) return done.error();
        morph_targets(targets, refined_targets(refinement, *surface, numbering, targets));
        return std::move(out_);
    }

  private:
    Result<ChannelSurface> position_surface() const {
        std::vector<double> numbers;
        numbers.reserve(3 * mesh_.vertex_count());
        for (const glm::vec3& p : mesh_.positions) numbers.insert(numbers.end(), {p.x, p.y, p.z});
        return ChannelSurface::make(cage_, numbers, 3, true, options_.level, options_.threads);
    }

    // An error of one channel, with its name.
    Error of_channel(Error error, const std::string& name) const {
        const std::string mesh = place_of(mesh_);
        error.place = mesh.empty() ? name : mesh + ", " + name;
        return error;
    }

    // A layer that some faces lack: those have a value of their own in all corners, so that seams
    // part them from the others, and none in the end.
    template <class T>
    Result<void> layer(const UniformRefinement& refinement, const CornerLayer<T>& given,
                       const std::string& name, std::vector<CornerLayer<T>>& out,
                       std::uint64_t& left_out) {
        constexpr std::uint32_t width = T::length();
        const PartialFaces faces = given.empty() ? PartialFaces() : partial_faces(mesh_, given);
        left_out += faces.torn;
        if (faces.all()) {
            out.emplace_back();
            return {};
        }
        CornerLayer<T> whole;
        const bool partial = faces.any();
        if (partial) {
            whole = given;
            for (std::uint32_t f = 0; f < mesh_.face_count(); ++f)
                for (std::uint32_t c = mesh_.face_offsets[f];
                     faces.without[f] && c < mesh_.face_offsets[f + 1]; ++c)
                    whole.indices[c] = std::uint32_t(whole.values.size());
            whole.values.push_back(T(0.0f));
        }
        const CornerLayer<T>& in = partial ? whole : given;
        const std::vector<std::uint32_t> corner_values = corner_classes(in.values, in.indices);
        const FaceVaryingCage channel =
            face_varying_cage(cage_, refinement.refined, corner_values, rule_);
        std::vector<double> numbers;
        for (const std::uint32_t corner : channel.first_corner)
            for (std::uint32_t d = 0; d < width; ++d)
                numbers.push_back(in.values[in.indices[corner]][int(d)]);
        std::vector<float> values;
        CornerLayer<T> made;
        const Result<bool> approximate =
            refinement.refine_channel(channel.cage, numbers, width, values, made.indices);
        if (!approximate) return of_channel(approximate.error(), name);
        out_.approximate_seams += *approximate;
        made.values.resize(values.size() / width);
        for (std::size_t k = 0; k < made.values.size(); ++k)
            for (std::uint32_t d = 0; d < width; ++d)
                made.values[k][int(d)] = values[k * width + d];
        if (partial) take_away(refinement, faces.without, made);
        out.push_back(std::move(made));
        return {};
    }

    // The corners of what became of these faces, and the values that no other has.
    template <class T>
    void take_away(const UniformRefinement& refinement, const std::vector<bool>& faces,
                   CornerLayer<T>& layer) const {
        std::size_t corner = 0;
        for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
            if (!refinement.refined.has_surface[f]) continue;
            const FacePieces pieces =
                pieces_of(cage_.face_size(f), options_.level, refinement.triangles());
            const std::size_t end = corner + std::size_t(pieces.faces * pieces.size);
            if (faces[f])
                std::fill(layer.indices.begin() + std::ptrdiff_t(corner),
                          layer.indices.begin() + std::ptrdiff_t(end), no_index);
            corner = end;
        }
        drop_unused_values(layer);
    }

    Result<void> face_varying_layers(const UniformRefinement& refinement) {
        for (std::size_t k = 0; k < mesh_.uvs.size(); ++k)
            if (Result<void> done = layer(refinement, mesh_.uvs[k], fmt::format("UV set {}", k),
                                          out_.mesh.uvs, out_.uv_sets_left_out);
                !done)
                return done.error();
        for (std::size_t k = 0; k < mesh_.colors.size(); ++k)
            if (Result<void> done =
                    layer(refinement, mesh_.colors[k], fmt::format("colour set {}", k),
                          out_.mesh.colors, out_.color_sets_left_out);
                !done)
                return done.error();
        return {};
    }

    void vertices(const GridNumbering& numbering) {
        out_.mesh.name = mesh_.name;
        out_.mesh.origin = mesh_.origin;
        out_.cage_vertices.assign(out_.mesh.vertex_count(), no_index);
        for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v)
            if (numbering.vertex(v) != no_index) out_.cage_vertices[numbering.vertex(v)] = v;
    }

    void faces(const UniformRefinement& refinement) {
        Mesh& out = out_.mesh;
        out.face_offsets.reserve(refinement.face_count + 1);
        out_.cage_faces.reserve(refinement.face_count);
        for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
            if (!refinement.refined.has_surface[f]) {
                ++out_.holes;
                continue;
            }
            const FacePieces pieces =
                pieces_of(cage_.face_size(f), options_.level, refinement.triangles());
            for (std::uint64_t k = 0; k < pieces.faces; ++k)
                out.face_offsets.push_back(out.face_offsets.back() + std::uint32_t(pieces.size));
            out_.cage_faces.insert(out_.cage_faces.end(), pieces.faces, f);
        }
        const auto inherit = [&](const std::vector<std::uint32_t>& from,
                                 std::vector<std::uint32_t>& to) {
            if (from.empty()) return;
            to.reserve(out_.cage_faces.size());
            for (const std::uint32_t f : out_.cage_faces) to.push_back(from[f]);
        };
        inherit(mesh_.face_materials, out.face_materials);
        inherit(mesh_.face_smoothing, out.face_smoothing);
        inherit(mesh_.face_parts, out.face_parts);
        out.variant_materials = mesh_.variant_materials;
        out.smoothing_kind = mesh_.smoothing_kind;
        out.parts = mesh_.parts;
        out.subdivision.interpolate_boundary = mesh_.subdivision.interpolate_boundary;
        out.subdivision.face_varying_boundary = mesh_.subdivision.face_varying_boundary;
    }

    // Hard edges are those of the cage: its marks and its infinitely sharp creases, cut.
    void edges(const UniformRefinement& refinement, const NumberedTopology& topology,
               const GridNumbering& numbering) {
        const RefinedLevel& base = refinement.refined.levels[0];
        std::vector<std::pair<std::uint32_t, std::uint32_t>> marked;
        for (const glm::uvec2& mark : mesh_.hard_marks)
            marked.push_back(std::minmax(mark.x, mark.y));
        std::sort(marked.begin(), marked.end());
        std::vector<std::uint8_t> done(topology.edge_count, 0);
        const std::uint32_t segments = 1U << options_.level;
        for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
            if (!refinement.refined.has_surface[f]) continue;
            for (std::uint32_t c = mesh_.face_offsets[f]; c < mesh_.face_offsets[f + 1]; ++c) {
                const std::uint32_t to = next_corner(mesh_.face_offsets, f, c);
                const std::uint32_t edge = topology.corner_edges[c];
                const std::pair<std::uint32_t, std::uint32_t> ends =
                    std::minmax(mesh_.corner_vertices[c], mesh_.corner_vertices[to]);
                const bool crease = base.sharp[c] && base.opposite[c] != no_index;
                if (done[edge] ||
                    (!crease && !std::binary_search(marked.begin(), marked.end(), ends)))
                    continue;
                done[edge] = 1;
                std::uint32_t last = numbering.vertex(ends.first);
                for (std::uint32_t k = 1; k <= segments; ++k) {
                    const std::uint32_t next = k < segments ? numbering.edge_point(edge, k)
                                                            : numbering.vertex(ends.second);
                    out_.mesh.hard_marks.push_back({last, next});
                    last = next;
                }
            }
        }
    }

    // The largest of a loose vertex' influences, as for those of the surface.
    void loose_influences(std::uint32_t v) {
        std::vector<SkinInfluences>& sets = out_.mesh.skin_influences;
        if (sets.empty()) return;
        for (SkinInfluences& set : sets) {
            set.joints.emplace_back(std::uint16_t(0));
            set.weights.emplace_back(0.0F);
        }
        const std::uint32_t file = mesh_.file_vertex(v);
        std::vector<std::pair<double, std::uint32_t>> influences;
        double sum = 0;
        for (const SkinInfluences& set : mesh_.skin_influences)
            for (int k = 0; file < set.weights.size() && k < 4; ++k)
                if (const double weight = set.weights[file][k]; weight != 0) {
                    influences.emplace_back(weight, set.joints[file][k]);
                    sum += weight;
                }
        const std::size_t most =
            options_.max_influences > 0 ? std::size_t(options_.max_influences) : 4 * sets.size();
        const float lost = keep_largest(influences, sum, most, sets, sets[0].weights.size() - 1);
        out_.largest_dropped_weight = std::max(out_.largest_dropped_weight, lost);
    }

    // Lines and points keep their vertices as they are, where no face gives them a limit.
    void loose_vertices(const GridNumbering& numbering) {
        Mesh& out = out_.mesh;
        std::vector<std::uint32_t> appended(mesh_.vertex_count(), no_index);
        const auto vertex = [&](std::uint32_t v) {
            if (numbering.vertex(v) != no_index) return numbering.vertex(v);
            if (appended[v] == no_index) {
                appended[v] = std::uint32_t(out.positions.size());
                out.positions.push_back(mesh_.positions[v]);
                out_.cage_vertices.push_back(v);
                loose_.push_back(v);
                loose_influences(v);
            }
            return appended[v];
        };
        out.line_offsets = mesh_.line_offsets;
        for (const std::uint32_t v : mesh_.line_vertices) out.line_vertices.push_back(vertex(v));
        for (const std::uint32_t v : mesh_.points) out.points.push_back(vertex(v));
        out.loose_parts_with_attributes = mesh_.loose_parts_with_attributes;
        if (mesh_.vertex_colors.empty()) return;
        out.vertex_colors.assign(out.vertex_count(), glm::vec4(1.0F));
        for (std::size_t v = 0; v < out.vertex_count(); ++v)
            if (out_.cage_vertices[v] != no_index)
                out.vertex_colors[v] = mesh_.vertex_colors[out_.cage_vertices[v]];
    }

    // The file's own attributes, a channel over its vertices; where several of its vertices are one
    // point of the surface, the output's file vertices are that channel's values.
    Result<void> attributes(const UniformRefinement& refinement);
    template <class Numbers>
    std::vector<std::uint32_t> attribute_classes(std::uint32_t width,
                                                 const Numbers& numbers_of) const;
    void morph_targets(const TargetDeltas& targets, std::vector<std::vector<glm::vec3>> deltas);
    template <class T>
    void by_file_vertex(std::vector<T>& values) const {
        if (file_sources_.empty() || values.empty()) return;
        std::vector<T> moved(file_sources_.size());
        for (std::size_t k = 0; k < moved.size(); ++k) moved[k] = values[file_sources_[k]];
        values = std::move(moved);
    }

    const Mesh& mesh_;
    const SubdivideOptions& options_;
    FaceVaryingRule rule_ = FaceVaryingRule::corners_only;
    SurfaceCage cage_;
    SubdividedMesh out_;
    std::vector<std::uint32_t> loose_;         // cage vertices appended as they are
    std::vector<std::uint32_t> file_sources_;  // per output file vertex its vertex; empty: itself
};

// Per corner a number of its file vertex' values; equal numbers, equal values: a seam is where
// values differ.
template <class Numbers>
std::vector<std::uint32_t> Subdivision::attribute_classes(std::uint32_t width,
                                                          const Numbers& numbers_of) const {
    std::vector<std::uint32_t> corners, order;
    for (std::uint32_t c = 0; c < mesh_.corner_count(); ++c)
        corners.push_back(mesh_.corner_file_vertex(c));
    const std::uint32_t files = 1 + *std::max_element(corners.begin(), corners.end());
    std::vector<double> numbers;
    numbers.reserve(std::size_t(files) * width);
    for (std::uint32_t file = 0; file < files; ++file) {
        numbers_of(file, numbers);
        order.push_back(file);
    }
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const double *p = numbers.data() + std::size_t(a) * width,
                     *q = numbers.data() + std::size_t(b) * width;
        return std::lexicographical_compare(p, p + width, q, q + width);
    };
    std::sort(order.begin(), order.end(), less);
    std::vector<std::uint32_t> classes(files, 0);
    for (std::size_t k = 1; k < order.size(); ++k)
        classes[order[k]] = classes[order[k - 1]] + (less(order[k - 1], order[k]) ? 1 : 0);
    for (std::uint32_t& corner : corners) corner = classes[corner];
    return corners;
}

Result<void> Subdivision::attributes(const UniformRefinement& refinement) {
    Mesh& out = out_.mesh;
    std::vector<const VertexAttribute*> present;
    std::vector<std::size_t> places;  // of those, among the mesh's
    std::uint32_t width = 0;
    for (const VertexAttribute& attribute : mesh_.vertex_attributes) {
        out.vertex_attributes.push_back({attribute.name, attribute.width, {}});
        if (attribute.values.empty() || is_name(attribute)) continue;
        if (!std::all_of(attribute.values.begin(), attribute.values.end(),
                         [](float value) { return std::isfinite(value); })) {
            ++out_.attributes_left_out;
            continue;
        }
        present.push_back(&attribute);
        places.push_back(out.vertex_attributes.size() - 1);
        width += attribute.width;
    }
    if (present.empty()) return {};
    const auto numbers_of = [&](std::uint32_t file, std::vector<double>& numbers) {
        for (const VertexAttribute* attribute : present)
            for (std::uint32_t d = 0; d < attribute->width; ++d) {
                const std::size_t at = std::size_t(file) * attribute->width + d;
                numbers.push_back(at < attribute->values.size() ? attribute->values[at] : 0);
            }
    };
    std::vector<double> numbers;
    std::vector<float> values;
    std::vector<std::uint32_t> corners;
    if (mesh_.corner_count() > 0) {
        const FaceVaryingCage channel = face_varying_cage(
            cage_, refinement.refined, attribute_classes(width, numbers_of), rule_);
        for (const std::uint32_t corner : channel.first_corner)
            numbers_of(mesh_.corner_file_vertex(corner), numbers);
        const Result<bool> approximate =
            refinement.refine_channel(channel.cage, numbers, width, values, corners);
        if (!approximate) return of_channel(approximate.error(), "vertex attributes");
        out_.approximate_seams += *approximate;
    }
    // File vertices are this channel's values; appended vertices follow.
    const std::size_t count = values.size() / width;
    file_sources_.assign(count, no_index);
    out.file_vertices.assign(out.vertex_count(), no_index);
    for (std::size_t c = 0; c < corners.size(); ++c) {
        file_sources_[corners[c]] = out.corner_vertices[c];
        std::uint32_t& first = out.file_vertices[out.corner_vertices[c]];
        first = std::min(first, corners[c]);
    }
    numbers.clear();
    for (const std::uint32_t v : loose_) {
        const std::size_t vertex =
            out.vertex_count() - loose_.size() + (file_sources_.size() - count);
        out.file_vertices[vertex] = std::uint32_t(file_sources_.size());
        file_sources_.push_back(std::uint32_t(vertex));
        numbers_of(mesh_.file_vertex(v), numbers);
    }
    for (const double number : numbers) values.push_back(float(number));
    out.corner_file_vertices = std::move(corners);
    std::uint32_t first = 0;
    for (const std::size_t place : places) {
        VertexAttribute& attribute = out.vertex_attributes[place];
        for (std::size_t k = 0; k < file_sources_.size(); ++k)
            for (std::uint32_t d = 0; d < attribute.width; ++d)
                attribute.values.push_back(values[k * width + first + d]);
        first += attribute.width;
    }
    for (SkinInfluences& set : out.skin_influences) {
        by_file_vertex(set.joints);
        by_file_vertex(set.weights);
    }
    return {};
}

void Subdivision::morph_targets(const TargetDeltas& targets,
                                std::vector<std::vector<glm::vec3>> deltas) {
    for (const MorphTarget& target : mesh_.morph_targets)
        out_.mesh.morph_targets.push_back({{}, {}, {}, target.name, target.weight});
    for (std::size_t k = 0; k < targets.targets.size(); ++k) {
        for (const std::uint32_t v : loose_) deltas[k].push_back(targets.deltas[k][v]);
        by_file_vertex(deltas[k]);
        out_.mesh.morph_targets[targets.targets[k]].positions.push_back(
            {0, std::make_shared<const std::vector<glm::vec3>>(std::move(deltas[k]))});
    }
}

}  // namespace
}  // namespace detail

Result<SubdividedMesh> subdivide(const Mesh& cage, const SubdivideOptions& options) {
    if (cage.face_offsets.empty()) {  // one that was moved from
        Mesh without_faces = cage;
        without_faces.face_offsets = {0};
        return subdivide(without_faces, options);
    }
    return detail::Subdivision(cage, options).run();
}

}  // namespace prep
