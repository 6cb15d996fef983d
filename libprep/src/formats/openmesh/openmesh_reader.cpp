#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <exception>
#include <sstream>

#include "base/srgb.h"
#include "formats/openmesh/om_structure.h"
#include "formats/reader_backend.h"
#include "prep/mesh.h"

namespace prep::detail {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
using HalfEdgeMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// Whether the half-edges form closed loops of at least three, each round one face or none: what
// the circulators take for granted. Indices are in range by now.
bool loops_close(const HalfEdgeMesh& mesh) {
    for (const auto h : mesh.halfedges()) {
        const auto next = mesh.next_halfedge_handle(h);
        if (!mesh.is_valid_handle(next) || mesh.prev_halfedge_handle(next) != h ||
            mesh.face_handle(next) != mesh.face_handle(h) ||
            mesh.from_vertex_handle(next) != mesh.to_vertex_handle(h))
            return false;
    }
    for (const auto f : mesh.faces()) {
        const auto h = mesh.halfedge_handle(f);
        if (!mesh.is_valid_handle(h) || mesh.face_handle(h) != f) return false;
        const auto second = mesh.next_halfedge_handle(h);
        if (second == h || mesh.next_halfedge_handle(second) == h) return false;
    }
    return true;
}

Mesh convert(HalfEdgeMesh& from, const std::string& name, const OpenMesh::IO::Options& has) {
    Mesh mesh;
    mesh.name = name;
    std::vector<glm::dvec3> positions;
    positions.reserve(from.n_vertices());
    for (const auto v : from.vertices()) {
        const auto& p = from.point(v);
        positions.push_back({p[0], p[1], p[2]});
    }
    set_positions(mesh, positions);
    for (const auto f : from.faces()) {
        for (const auto v : from.fv_ccw_range(f))
            mesh.corner_vertices.push_back(std::uint32_t(v.idx()));
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    if (has.vertex_has_normal()) {
        for (const auto v : from.vertices()) {
            const auto& n = from.normal(v);
            mesh.normals.values.push_back({float(n[0]), float(n[1]), float(n[2])});
        }
        mesh.normals.indices = mesh.corner_vertices;
    }
    if (has.vertex_has_texcoord()) {
        auto& layer = mesh.uvs.emplace_back();
        for (const auto v : from.vertices()) {
            const auto& t = from.texcoord2D(v);
            layer.values.push_back({t[0], float(1.0 - double(t[1]))});
        }
        layer.indices = mesh.corner_vertices;
    }
    if (has.vertex_has_color()) {
        auto& layer = mesh.colors.emplace_back();
        for (const auto v : from.vertices()) {
            const auto& c = from.color(v);
            const auto linear = [](int byte) { return float(srgb_to_linear(byte / 255.0)); };
            layer.values.push_back({linear(c[0]), linear(c[1]), linear(c[2]), 1});
        }
        layer.indices = mesh.corner_vertices;
    }
    return mesh;
}

}  // namespace

Result<Scene> read_om(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    const std::string name = path.filename().string();
    auto checked = checked_om(bytes, name);
    if (!checked) return std::move(checked).error();
    try {
        HalfEdgeMesh mesh;
        mesh.request_vertex_normals();
        mesh.request_vertex_texcoords2D();
        mesh.request_vertex_colors();
        OpenMesh::IO::Options options;
        options += OpenMesh::IO::Options::VertexNormal;
        options += OpenMesh::IO::Options::VertexTexCoord;
        options += OpenMesh::IO::Options::VertexColor;
        std::istringstream stream(std::move(checked->bytes));
        // OpenMesh reports trouble on its own streams; a library stays silent.
        omlog().disable();
        omerr().disable();
        omout().disable();
        const bool good = OpenMesh::IO::read_mesh(mesh, stream, ".om", options);
        omerr().enable();
        omlog().enable();
        omout().enable();
        if (!good || !stream.good())
            return Error{ErrorCode::syntax,
                         "OpenMesh cannot read the file: it is cut short or broken", name};
        if (!loops_close(mesh))
            return Error{ErrorCode::invalid, "the half-edges do not form closed faces", name};
        Scene scene;
        scene.name = name;
        scene.meshes.push_back(convert(mesh, path.stem().string(), options));
        if (!checked->left_out.empty())
            scene.warnings.push_back(name + ": what was not taken: " + checked->left_out.text());
        instance_unused_meshes(scene);
        return scene;
    } catch (const std::exception& e) {
        return Error{ErrorCode::syntax, std::string("OpenMesh: ") + e.what(), name};
    }
}

}  // namespace prep::detail
