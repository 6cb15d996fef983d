#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <cstring>
#include <exception>
#include <sstream>

#include "foreign_files.h"
#include "prep/io.h"

namespace prep::detail {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    typedef OpenMesh::Vec3d Point;
    typedef OpenMesh::Vec3d Normal;
};
using HalfEdgeMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// OpenMesh reserves what the header announces: it is held against the file's size first. A vertex
// takes 12 bytes (three floats), a face at least one.
std::string header_problem(std::span<const std::byte> bytes) {
    if (bytes.size() < 16) return "the file is shorter than an OM header";
    const auto at = [&](std::size_t i) { return std::to_integer<unsigned char>(bytes[i]); };
    if (at(0) != 'O' || at(1) != 'M') return "expected \"OM\" at the beginning: not an OM file";
    std::uint32_t counts[3];
    std::memcpy(counts, bytes.data() + 4, sizeof counts);
    if (counts[0] > bytes.size() / 12 || counts[1] > bytes.size() || counts[2] > bytes.size())
        return "the header announces " + std::to_string(counts[0]) + " vertices and " +
               std::to_string(counts[1]) + " faces, more than the file has room for";
    return {};
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
    return mesh;
}

}  // namespace

Result<Scene> load_om(std::span<const std::byte> bytes, const std::filesystem::path& path) {
    if (std::string problem = header_problem(bytes); !problem.empty())
        return Error{ErrorCode::syntax, problem, path.string()};
    try {
        HalfEdgeMesh mesh;
        mesh.request_vertex_normals();
        mesh.request_vertex_texcoords2D();
        OpenMesh::IO::Options options;
        options += OpenMesh::IO::Options::VertexNormal;
        options += OpenMesh::IO::Options::VertexTexCoord;
        std::istringstream stream(
            std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
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
                         "OpenMesh cannot read the file: it is cut short or broken", path.string()};
        for (const auto h : mesh.halfedges())
            if (!mesh.is_valid_handle(mesh.to_vertex_handle(h)))
                return Error{ErrorCode::invalid, "a vertex index is out of range", path.string()};
        Scene scene;
        scene.name = path.filename().string();
        scene.meshes.push_back(convert(mesh, path.stem().string(), options));
        instance_unused_meshes(scene);
        return scene;
    } catch (const std::exception& e) {
        return Error{ErrorCode::syntax, std::string("OpenMesh: ") + e.what(), path.string()};
    }
}

}  // namespace prep::detail
