// Largest angular error of corner normals on the hard cases of the tests, ours at every precision
// beside OpenMesh and Assimp, as the table of docs/stability.md. Everyone against the truth of the
// same weighting: both peers weight all faces alike. No ladder of `meshprep cost` has these: theirs
// is one everyday mesh or a given one, the default weight, times, and no peer.
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>

#include "hard_cases.h"
#include "normal_oracle.h"
#include "prep/corner_normals.h"

namespace {

using prep::Mesh;
using prep::MeshView;
using prep::NormalWeight;
using prep::Precision;

// What a tool returned, over all corners of triangle meshes.
struct Outcome {
    double worst = 0;  // degrees, of those that are finite and not zero
    int bad = 0;       // NaN, infinite or not of unit length within 1e-4
    bool refused = false;
};

struct Truth {
    std::vector<std::vector<std::uint32_t>> fans;  // some of them; the others empty
    std::vector<exact::NormalSum> uniform;
};

prep::CornerNormals ours(const Mesh& mesh, NormalWeight weight, Precision precision) {
    const MeshView view(mesh);
    const prep::Topology topology = prep::build_topology(view);
    const prep::FaceNormals faces = prep::face_normals(view, precision);
    prep::HardEdgeOptions edges;
    edges.angle_degrees.reset();
    const auto hard = prep::hard_edges(view, topology, faces, edges);
    prep::NormalOptions options;
    options.weight = weight;
    options.precision = precision;
    return *prep::corner_normals(view, topology, faces, *hard, options);
}

Truth truth_of(const Mesh& mesh) {
    const prep::CornerNormals n = ours(mesh, NormalWeight::area, Precision::accurate);
    Truth truth;
    truth.fans.resize(n.normals.values.size());
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        truth.fans[n.normals.indices[c]].push_back(c);
    const std::size_t stride = 1 + truth.fans.size() / 200;
    const exact::NormalOracle oracle(mesh);
    truth.uniform.resize(truth.fans.size());
    for (std::size_t i = 0; i < truth.fans.size(); ++i) {
        if (i % stride != 0) {
            truth.fans[i].clear();
            continue;
        }
        const auto sums = oracle.sums(truth.fans[i], false);
        truth.uniform[i] = sums[std::size_t(NormalWeight::uniform)];
    }
    return truth;
}

// `at(corner)` is the tool's normal there.
template <class At>
Outcome judge(const Truth& truth, const At& at) {
    const std::vector<exact::NormalSum>& sums = truth.uniform;
    Outcome outcome;
    for (std::size_t i = 0; i < truth.fans.size(); ++i) {
        if (truth.fans[i].empty() || !sums[i].determined) continue;
        const glm::dvec3 n = at(truth.fans[i].front());
        const double length = glm::length(n);
        if (!(std::abs(length - 1) <= 1e-4)) ++outcome.bad;
        if (!std::isfinite(length) || length == 0) continue;
        outcome.worst = std::max(outcome.worst, exact::angle_between(sums[i], n) * 180 / M_PI);
    }
    return outcome;
}

Outcome openmesh(const Mesh& mesh, const Truth& truth) {
    using Halfedges = OpenMesh::TriMesh_ArrayKernelT<>;
    Halfedges m;
    m.request_face_normals();
    m.request_vertex_normals();
    std::vector<Halfedges::VertexHandle> vertices;
    for (const glm::vec3& p : mesh.positions) vertices.push_back(m.add_vertex({p.x, p.y, p.z}));
    for (std::size_t c = 0; c < mesh.corner_count(); c += 3)
        if (!m.add_face(vertices[mesh.corner_vertices[c]], vertices[mesh.corner_vertices[c + 1]],
                        vertices[mesh.corner_vertices[c + 2]])
                 .is_valid())
            return {0, 0, true};
    m.update_normals();
    return judge(truth, [&](std::uint32_t c) {
        const auto n = m.normal(vertices[mesh.corner_vertices[c]]);
        return glm::dvec3(n[0], n[1], n[2]);
    });
}

// As a binary STL in memory, which keeps every bit.
Outcome assimp(const Mesh& mesh, const Truth& truth) {
    static_assert(std::endian::native == std::endian::little);
    std::string stl(80, ' ');
    const auto append = [&](const void* data, std::size_t size) {
        stl.append(static_cast<const char*>(data), size);
    };
    const std::uint32_t count = std::uint32_t(mesh.face_count());
    append(&count, 4);
    for (std::uint32_t c = 0; c < mesh.corner_count(); c += 3) {
        stl.append(12, '\0');  // the facet's normal: made anew
        for (int k = 0; k < 3; ++k) append(&mesh.positions[mesh.corner_vertices[c + k]], 12);
        stl.append(2, '\0');
    }
    Assimp::Importer importer;
    importer.SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 175.0f);
    const aiScene* scene = importer.ReadFileFromMemory(
        stl.data(), stl.size(), aiProcess_ForceGenNormals | aiProcess_GenSmoothNormals, "stl");
    if (!scene || scene->mNumMeshes != 1 || !scene->mMeshes[0]->mNormals ||
        scene->mMeshes[0]->mNumFaces != mesh.face_count())
        return {0, 0, true};
    const aiMesh& m = *scene->mMeshes[0];
    return judge(truth, [&](std::uint32_t c) {
        const aiVector3D n = m.mNormals[m.mFaces[c / 3].mIndices[c % 3]];
        return glm::dvec3(n.x, n.y, n.z);
    });
}

std::string cell(const Outcome& o) {
    if (o.refused) return "refused";
    char text[64];
    if (o.bad > 0)
        std::snprintf(text, sizeof text, "%.1e, %d not unit", o.worst, o.bad);
    else
        std::snprintf(text, sizeof text, "%.1e", o.worst);
    return text;
}

}  // namespace

int main() {
    std::printf(
        "| case | value | OpenMesh | Assimp | fast | accurate | exact |\n"
        "|---|---|---|---|---|---|---|\n");
    for (const hard_cases::Case& c : hard_cases::measured()) {
        if (c.mesh.corner_count() != 3 * c.mesh.face_count()) continue;  // the peers cut polygons
        const Truth truth = truth_of(c.mesh);
        const auto mine = [&](Precision p) {
            const prep::CornerNormals n = ours(c.mesh, NormalWeight::uniform, p);
            return cell(judge(truth, [&](std::uint32_t k) {
                return glm::dvec3(n.normals.values[n.normals.indices[k]]);
            }));
        };
        std::printf("| %s | %g | %s | %s | %s | %s | %s |\n", c.axis.c_str(), c.value,
                    cell(openmesh(c.mesh, truth)).c_str(), cell(assimp(c.mesh, truth)).c_str(),
                    mine(Precision::fast).c_str(), mine(Precision::accurate).c_str(),
                    mine(Precision::exact).c_str());
        std::fflush(stdout);
    }
}
