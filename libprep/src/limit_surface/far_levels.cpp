#include "limit_surface/far_levels.h"

namespace Osd = OpenSubdiv::OPENSUBDIV_VERSION;

namespace prep::detail {
namespace Far = Osd::Far;
namespace Sdc = Osd::Sdc;
namespace {

bool is_semi_sharp(float sharpness) {
    return sharpness > 0 && sharpness < infinitely_sharp;
}

std::uint8_t flags_of(const FarLevel& level, int v, bool triangles) {
    std::uint8_t flags = 0;
    const auto faces = level.GetVertexFaces(v);
    const auto edges = level.GetVertexEdges(v);
    bool sharp_edge = false;
    if (level.GetVertexSharpness(v) > 0) flags |= VertexFlags::own_sharpness;
    if (is_semi_sharp(level.GetVertexSharpness(v))) flags |= VertexFlags::semi_sharp;
    for (int k = 0; k < edges.size(); ++k) {
        const float s = level.GetEdgeSharpness(edges[k]);
        if (is_semi_sharp(s)) flags |= VertexFlags::semi_sharp;
        sharp_edge |= s >= infinitely_sharp;
    }
    const Sdc::Crease::Rule rule = level.GetVertexRule(v);
    if (rule == Sdc::Crease::RULE_CORNER) flags |= VertexFlags::corner_rule;
    if (rule == Sdc::Crease::RULE_DART) flags |= VertexFlags::dart_rule;
    if (level.IsVertexBoundary(v)) flags |= VertexFlags::border;
    const int valence = triangles ? 6 : 4;
    bool simple = rule == Sdc::Crease::RULE_SMOOTH && !sharp_edge && flags == 0 &&
                  !level.IsVertexNonManifold(v) && faces.size() == valence &&
                  edges.size() == valence;
    for (int k = 0; simple && k < faces.size(); ++k)
        simple = level.GetFaceVertices(faces[k]).size() == (triangles ? 3 : 4);
    if (simple) flags |= VertexFlags::simple;
    return flags;
}

// Of an edge of two faces that run along it in opposite directions.
void set_opposites(const FarLevel& level, const std::vector<std::uint32_t>& edges,
                   const std::vector<std::uint32_t>& corner_faces, RefinedLevel& out) {
    std::vector<std::uint32_t> first(std::size_t(level.GetNumEdges()), no_index);
    out.opposite.assign(edges.size(), no_index);
    for (std::uint32_t h = 0; h < edges.size(); ++h) {
        std::uint32_t& other = first[edges[h]];
        if (other == no_index) {
            other = h;
            continue;
        }
        const int e = int(edges[h]);
        if (level.GetEdgeFaces(e).size() != 2 || level.IsEdgeNonManifold(e) ||
            corner_faces[h] == corner_faces[other] ||
            out.corner_vertices[h] == out.corner_vertices[other])
            continue;
        out.opposite[h] = other;
        out.opposite[other] = h;
    }
}

}  // namespace

RefinedLevel copied_level(const FarLevel& level, int depth, bool triangles) {
    RefinedLevel out;
    const int faces = level.GetNumFaces();
    const auto corners = std::size_t(level.GetNumFaceVertices());
    out.vertex_count = std::uint32_t(level.GetNumVertices());
    if (depth == 0) {
        out.face_offsets.reserve(std::size_t(faces) + 1);
        out.face_offsets.push_back(0);
    }
    std::vector<std::uint32_t> edges, corner_faces;
    out.corner_vertices.reserve(corners);
    edges.reserve(corners);
    corner_faces.reserve(corners);
    for (int f = 0; f < faces; ++f) {
        const auto vertices = level.GetFaceVertices(f);
        const auto face_edges = level.GetFaceEdges(f);
        for (int c = 0; c < vertices.size(); ++c) {
            out.corner_vertices.push_back(std::uint32_t(vertices[c]));
            edges.push_back(std::uint32_t(face_edges[c]));
            corner_faces.push_back(std::uint32_t(f));
        }
        if (depth == 0) out.face_offsets.push_back(std::uint32_t(edges.size()));
    }
    set_opposites(level, edges, corner_faces, out);
    bool semi_sharp = false;
    for (int e = 0; e < level.GetNumEdges(); ++e)
        semi_sharp |= level.GetEdgeSharpness(e) > 0 && level.GetEdgeSharpness(e) < infinitely_sharp;
    out.sharp.resize(edges.size());
    if (semi_sharp) out.sharpness.resize(edges.size());
    for (std::size_t h = 0; h < edges.size(); ++h) {
        const float sharpness = level.GetEdgeSharpness(int(edges[h]));
        out.sharp[h] = sharpness >= infinitely_sharp || out.opposite[h] == no_index;
        if (semi_sharp) out.sharpness[h] = sharpness;
    }
    out.vertex_flags.resize(out.vertex_count);
    for (int v = 0; v < level.GetNumVertices(); ++v)
        out.vertex_flags[std::size_t(v)] = flags_of(level, v, triangles);
    out.first_child.assign(std::size_t(faces), no_index);
    if (depth == 0) out.edges = std::move(edges);
    return out;
}

std::uint32_t first_child(const FarLevel& level, int face) {
    const auto children = level.GetFaceChildFaces(face);
    for (int c = 0; c < children.size(); ++c)
        if (!Osd::Vtr::IndexIsValid(children[c]) || children[c] != children[0] + c) return no_index;
    return children.size() > 0 ? std::uint32_t(children[0]) : no_index;
}

void append(RefinedLevel& level, const RefinedLevel& more) {
    const auto half_edges = std::uint32_t(level.corner_vertices.size());
    if (!level.sharpness.empty() || !more.sharpness.empty()) {
        level.sharpness.resize(half_edges, 0.0F);
        level.sharpness.insert(level.sharpness.end(), more.sharpness.begin(), more.sharpness.end());
        level.sharpness.resize(half_edges + more.corner_vertices.size(), 0.0F);
    }
    for (const std::uint32_t v : more.corner_vertices)
        level.corner_vertices.push_back(level.vertex_count + v);
    for (const std::uint32_t h : more.opposite)
        level.opposite.push_back(h == no_index ? no_index : half_edges + h);
    level.sharp.insert(level.sharp.end(), more.sharp.begin(), more.sharp.end());
    level.vertex_flags.insert(level.vertex_flags.end(), more.vertex_flags.begin(),
                              more.vertex_flags.end());
    level.first_child.insert(level.first_child.end(), more.first_child.begin(),
                             more.first_child.end());
    level.vertex_count += more.vertex_count;
}

SharpValues sharp_children(const FarLevel& level, const FarLevel& next, const SharpValues& sharp,
                           std::uint32_t corners_per_face) {
    SharpValues children(std::size_t(next.GetNumFVarValues(0)), 0);
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        const auto values = level.GetFaceFVarValues(f, 0);
        const auto faces = level.GetFaceChildFaces(f);
        const bool whole = values.size() == int(corners_per_face);
        for (int c = 0; c < values.size() && c < faces.size(); ++c)
            if (Osd::Vtr::IndexIsValid(faces[c])) {
                const int child = next.GetFaceFVarValues(faces[c], 0)[whole ? c : 0];
                children[std::size_t(child)] = sharp[std::size_t(values[c])];
            }
    }
    return children;
}

void take_values(const FarLevel& level, const SharpValues& sharp, RefinedLevel& out) {
    const std::vector<std::uint32_t> vertices = std::move(out.corner_vertices);
    const std::vector<std::uint8_t> vertex_flags = std::move(out.vertex_flags);
    std::vector<std::uint32_t> next(vertices.size());
    out.corner_vertices.clear();
    out.corner_vertices.reserve(vertices.size());
    for (int f = 0; f < level.GetNumFaces(); ++f) {
        const auto first = std::uint32_t(out.corner_vertices.size());
        for (const int value : level.GetFaceFVarValues(f, 0)) {
            next[out.corner_vertices.size()] = std::uint32_t(out.corner_vertices.size() + 1);
            out.corner_vertices.push_back(std::uint32_t(value));
        }
        next[out.corner_vertices.size() - 1] = first;
    }
    out.vertex_count = std::uint32_t(level.GetNumFVarValues(0));
    for (std::uint32_t h = 0; h < next.size(); ++h) {
        const std::uint32_t o = out.opposite[h];
        if (o == no_index || (out.corner_vertices[h] == out.corner_vertices[next[o]] &&
                              out.corner_vertices[next[h]] == out.corner_vertices[o]))
            continue;
        for (const std::uint32_t side : {h, o}) {
            out.opposite[side] = no_index;
            out.sharp[side] = 1;
            if (!out.sharpness.empty()) out.sharpness[side] = infinitely_sharp;
        }
    }
    // A vertex is semi-sharp to all its values, as sides of a seam may depend on each other, by
    // itself and by its edges that are no seams.
    std::vector<std::uint8_t> semi_sharp(vertex_flags.size(), 0);
    for (std::uint32_t h = 0; h < next.size() && !out.sharpness.empty(); ++h)
        if (is_semi_sharp(out.sharpness[h]))
            semi_sharp[vertices[h]] = semi_sharp[vertices[next[h]]] = 1;
    out.vertex_flags.assign(out.vertex_count, 0);
    for (std::uint32_t h = 0; h < next.size(); ++h) {
        const std::uint32_t v = vertices[h], value = out.corner_vertices[h];
        if (level.DoesVertexFVarTopologyMatch(int(v), 0)) {
            out.vertex_flags[value] = vertex_flags[v];
            continue;
        }
        std::uint8_t flags = VertexFlags::border;
        if (level.GetVertexSharpness(int(v)) > 0) flags |= VertexFlags::own_sharpness;
        if (semi_sharp[v] || is_semi_sharp(level.GetVertexSharpness(int(v))))
            flags |= VertexFlags::semi_sharp;
        if (sharp[value]) flags |= VertexFlags::corner_rule;
        out.vertex_flags[value] = flags;
    }
}

bool can_be_summed(const Far::TopologyRefiner& refiner, bool triangles) {
    const auto refined = [&](const FarLevel& level, const Far::ConstIndexArray& faces) {
        bool all = true;
        for (int k = 0; k < faces.size(); ++k)
            all &= triangles || Osd::Vtr::IndexIsValid(level.GetFaceChildVertex(faces[k]));
        return all;
    };
    const auto smooth = [](const FarLevel& level, int v) {
        const Sdc::Crease::Rule rule = level.GetVertexRule(v);
        return rule == Sdc::Crease::RULE_SMOOTH || rule == Sdc::Crease::RULE_DART;
    };
    for (int l = 0; l + 1 < refiner.GetNumLevels(); ++l) {
        const FarLevel& level = refiner.GetLevel(l);
        for (int v = 0; v < level.GetNumVertices(); ++v) {
            const int child = level.GetVertexChildVertex(v);
            if (!Osd::Vtr::IndexIsValid(child) ||
                !(smooth(level, v) || smooth(refiner.GetLevel(l + 1), child)))
                continue;
            const auto faces = level.GetVertexFaces(v);
            if (faces.size() != level.GetVertexEdges(v).size() || !refined(level, faces))
                return false;
        }
        for (int e = 0; e < level.GetNumEdges(); ++e)
            if (Osd::Vtr::IndexIsValid(level.GetEdgeChildVertex(e)) &&
                level.GetEdgeSharpness(e) < 1 && !refined(level, level.GetEdgeFaces(e)))
                return false;
    }
    return true;
}

}  // namespace prep::detail
