// The mesh types: Mesh (polygons, attributes per corner), MeshView (the same, not owning) and
// VertexMesh (triangles with one index, what a GPU or librast reads).
//
// Conventions (docs/conventions.md): counter-clockwise front faces, right-handed, UV origin at the
// top left, indices 32-bit, `no_index` for "none".
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace prep {

inline constexpr std::uint32_t no_index = std::numeric_limits<std::uint32_t>::max();

// An attribute per corner: corner c has values[indices[c]], or none where indices[c] is no_index.
// The layer is absent when `indices` is empty; otherwise it has one index per corner.
template <class T>
struct CornerLayer {
    std::vector<T> values;
    std::vector<std::uint32_t> indices;
    bool empty() const { return indices.empty(); }
};

template <class T>
struct CornerLayerView {
    std::span<const T> values;
    std::span<const std::uint32_t> indices;
    CornerLayerView() = default;
    CornerLayerView(std::span<const T> v, std::span<const std::uint32_t> i)
        : values(v), indices(i) {}
    CornerLayerView(const CornerLayer<T>& layer) : values(layer.values), indices(layer.indices) {}
    bool empty() const { return indices.empty(); }
};

// How two faces' smoothing values are compared (0 is never smooth with anything).
enum class SmoothingKind : std::uint8_t {
    group_number,  // OBJ: smooth when equal
    bit_mask,      // 3DS, ASE: smooth when the masks intersect
};

struct EdgeMark {  // an edge by its two vertices, in either order
    std::uint32_t v0 = 0, v1 = 0;
    float sharpness = 0;  // OpenSubdiv's scale; 10 and above is infinitely sharp
};

struct VertexMark {
    std::uint32_t vertex = 0;
    float sharpness = 0;
};

// Subdivision tags as the file gives them (OBJ "t" lines, glTF-independent); read by subdivision
// only.
struct SubdivisionTags {
    std::vector<EdgeMark> creases;
    std::vector<VertexMark> corners;
    std::vector<std::uint32_t> holes;  // faces
    int interpolate_boundary = 1;      // 0 none, 1 edge and corner, 2 edge only (as in RenderMan)
    int face_varying_boundary = 1;     // "facevaryinginterpolateboundary"
    bool operator==(const SubdivisionTags&) const = default;
};
inline bool operator==(const EdgeMark& a, const EdgeMark& b) {
    return a.v0 == b.v0 && a.v1 == b.v1 && a.sharpness == b.sharpness;
}
inline bool operator==(const VertexMark& a, const VertexMark& b) {
    return a.vertex == b.vertex && a.sharpness == b.sharpness;
}

// Differences at file vertices `first_vertex`, `first_vertex` + 1, …; several targets, or several
// meshes, may share the values.
struct VertexDeltas {
    std::uint32_t first_vertex = 0;
    std::shared_ptr<const std::vector<glm::vec3>> values;
};

// What a morph target adds at weight 1. Runs ascend and do not overlap; vertices in none of them
// stay as they are. Normals and tangents without a run are those of the mesh.
struct MorphTarget {
    std::vector<VertexDeltas> positions, normals, tangents;
    std::string name = {};
    float weight = 0;  // at rest
};

// Four joints that move a vertex, by file vertex; several sets add up. Weights need not be
// normalised.
struct SkinInfluences {
    std::vector<glm::vec<4, std::uint16_t>> joints;  // into Skin::joints
    std::vector<glm::vec4> weights;
};

// Numbers of a meaning that only the file's author knows ("_TEMPERATURE"), by file vertex.
struct VertexAttribute {
    std::string name;
    std::uint32_t width = 1;    // numbers to a vertex
    std::vector<float> values;  // empty: faces have none of them
};

// A polygon mesh. Face f has the corners face_offsets[f] .. face_offsets[f+1]-1; corner c is at
// vertex corner_vertices[c]. Loaders guarantee: every index in range, offsets ascending, every face
// has at least 3 corners, layer sizes as stated. They do not guarantee finite values, manifoldness
// or non-degenerate faces: check() finds those.
struct Mesh {
    std::string name;
    glm::dvec3 origin{0.0};            // positions are relative to this point
    std::vector<glm::vec3> positions;  // one per vertex
    // Per vertex, the vertex of the file that it comes from; empty: each is itself. Skins and
    // targets are by file vertex: welding, repairing and splitting renumber this list alone.
    std::vector<std::uint32_t> file_vertices;
    std::vector<std::uint32_t> face_offsets{0};  // faces + 1
    std::vector<std::uint32_t> corner_vertices;  // one per corner
    // Per corner, the vertex of the file whose attributes it has; empty: its vertex' own. Welding
    // makes one vertex of several that differ in them.
    std::vector<std::uint32_t> corner_file_vertices;

    CornerLayer<glm::vec3> normals;
    CornerLayer<glm::vec4> tangents;             // xyz, w = bitangent sign: B = w · cross(N, T)
    std::vector<CornerLayer<glm::vec2>> uvs;     // one layer per UV set
    std::vector<CornerLayer<glm::vec4>> colors;  // linear RGBA

    std::vector<std::uint32_t> face_materials;  // one per face into Scene::materials, or empty
    // Others that the file may put in their place (KHR_materials_variants), ascending.
    std::vector<std::uint32_t> variant_materials;
    std::vector<std::uint32_t> face_smoothing;  // one per face, or empty: no smoothing information
    SmoothingKind smoothing_kind = SmoothingKind::group_number;
    std::vector<std::uint32_t> face_parts;  // one per face into `parts`, or empty
    std::vector<std::string>
        parts;  // OBJ objects/groups ("object" or "object/group"), glTF primitives

    // By file vertex. Positions of targets and influences belong to a vertex; the targets' normals
    // and tangents and the attributes to each of its corners.
    std::vector<MorphTarget> morph_targets;
    std::vector<SkinInfluences> skin_influences;
    std::vector<VertexAttribute> vertex_attributes;

    // Every corner's attributes are those of its vertex, so that the file repeats a point at each
    // seam, whatever attributes there are.
    bool indexed_by_vertex = false;
    // The file is written back with only the prepared attributes changed: vertices are not shared
    // for good, and parts keep vertices of their own.
    bool tied_to_file = false;

    std::vector<glm::uvec2> hard_marks;  // edges marked hard, by vertices
    SubdivisionTags subdivision;

    // What is not a face: polylines (offsets like face_offsets) and points, by vertex.
    std::vector<std::uint32_t> line_offsets{0};
    std::vector<std::uint32_t> line_vertices;
    std::vector<std::uint32_t> points;
    // Colours of vertices that no face uses (of points and lines): one per vertex, or empty.
    std::vector<glm::vec4> vertex_colors;
    // Parts of lines or points with normals, UVs or a material, for which there is no place here.
    std::uint32_t loose_parts_with_attributes = 0;

    std::size_t vertex_count() const { return positions.size(); }
    std::size_t face_count() const { return face_offsets.empty() ? 0 : face_offsets.size() - 1; }
    std::size_t corner_count() const { return corner_vertices.size(); }
    std::uint32_t file_vertex(std::uint32_t vertex) const {
        return file_vertices.empty() ? vertex : file_vertices[vertex];
    }
    std::uint32_t corner_file_vertex(std::uint32_t corner) const {
        return corner_file_vertices.empty() ? file_vertex(corner_vertices[corner])
                                            : corner_file_vertices[corner];
    }
};

// Positions parsed in double → mesh.positions (float, about mesh.origin). The origin is the centre
// of the bounding box, rounded to a power of two of 1/32 to 1/16 of the box's diagonal (so that
// writing and reading again keeps every bit), when its distance from zero is more than 8× the box's
// diagonal and at least one coordinate is not exactly a float that survives unharmed; otherwise
// zero, so that float input keeps its exact bits. Non-finite coordinates do not take part in the
// box and are kept.
void set_positions(Mesh& mesh, std::span<const glm::dvec3> positions);

// The non-owning form that the algorithms take. Spans must outlive the call.
struct MeshView {
    std::span<const glm::vec3> positions;
    std::span<const std::uint32_t> face_offsets;
    std::span<const std::uint32_t> corner_vertices;
    CornerLayerView<glm::vec3> normals;
    CornerLayerView<glm::vec2> uv;  // the UV set that tangents and UV borders use
    std::span<const std::uint32_t> face_materials;
    std::span<const std::uint32_t> face_smoothing;
    SmoothingKind smoothing_kind = SmoothingKind::group_number;
    std::span<const glm::uvec2> hard_marks;
    std::span<const EdgeMark> creases;

    MeshView() = default;
    explicit MeshView(const Mesh& mesh, std::size_t uv_set = 0);
    std::size_t face_count() const { return face_offsets.empty() ? 0 : face_offsets.size() - 1; }
    std::size_t corner_count() const { return corner_vertices.size(); }
};

// Why a vertex of a VertexMesh is not shared with another corner at the same source vertex.
enum class SplitReason : std::uint8_t {
    none = 0,
    hard_edge = 1,        // normals differ across an edge over the angle threshold, border or mark
    smoothing_group = 2,  // normals differ because of smoothing groups
    authored_normal = 4,  // normals differ because the file says so
    uv_seam = 8,          // UVs differ
    mirrored_uv = 16,     // tangent signs differ
    tangent = 32,         // tangents differ though signs agree
    color = 64,           // colours differ
    material = 128,       // used by primitives of different material or part
};
using SplitReasons = std::uint8_t;  // bits of SplitReason

// What must stay where a part's triangles and vertices are put in another order: nothing, the order
// of its triangles, or also that of its vertices among themselves (where no other part has them).
enum class KeptOrder : std::uint8_t { none, triangles, all };

// Triangles, one index per corner into vertices that carry every attribute.
struct VertexMesh {
    glm::dvec3 origin{0.0};
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;              // empty or one per vertex
    std::vector<glm::vec4> tangents;             // empty or one per vertex
    std::vector<std::vector<glm::vec2>> uvs;     // per set: one per vertex; none: not there
    std::vector<std::vector<glm::vec4>> colors;  // per set: one per vertex

    std::vector<std::uint32_t> indices;         // three per triangle
    std::vector<std::uint32_t> triangle_faces;  // source face of each triangle

    std::vector<std::uint32_t> source_vertices;  // per vertex: the source mesh's vertex
    std::vector<std::uint32_t> source_corners;   // per vertex: its first source corner, or no_index
    std::vector<SplitReasons> split_reasons;  // per vertex: why it is not its vertex's first copy
    std::vector<std::uint32_t>
        corner_vertices;  // per source corner: its vertex here (the way back)

    struct Range {  // triangles of one material and part, contiguous
        std::uint32_t first_triangle = 0, triangle_count = 0;
        std::uint32_t material = no_index, part = no_index;
    };
    std::vector<Range> ranges;

    std::vector<std::uint32_t> lines;   // two per segment
    std::vector<std::uint32_t> points;  // vertices

    std::size_t vertex_count() const { return positions.size(); }
    std::size_t triangle_count() const { return indices.size() / 3; }
};

}  // namespace prep
