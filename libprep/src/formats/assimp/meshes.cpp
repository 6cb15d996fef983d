// Meshes as join_split_meshes() leaves them, and their morph targets: nothing is triangulated.
#include <algorithm>
#include <cmath>
#include <span>

#include "base/srgb.h"
#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class MeshImport {
  public:
    explicit MeshImport(AssimpImport& import)
        : import_(import), path_(import.path), scene_(import.scene) {}

    // `parts`: those of mesh `in`, if it was joined.
    Result<void> mesh(const aiMesh& in, std::span<const MeshPart> parts) {
        Mesh out;
        out.name = text(in.mName);
        std::vector<glm::dvec3> positions(in.mNumVertices);
        for (unsigned v = 0; v < in.mNumVertices; ++v) positions[v] = vector(in.mVertices[v]);
        set_positions(out, positions);
        for (unsigned f = 0; f < in.mNumFaces; ++f) {
            const aiFace& face = in.mFaces[f];
            for (unsigned k = 0; k < face.mNumIndices; ++k)
                if (face.mIndices[k] >= in.mNumVertices)
                    return Error{ErrorCode::invalid, "a vertex index is out of range",
                                 path_.string() + ", mesh '" + out.name + "'"};
            const auto append = [&](std::vector<Index>& to) {
                to.insert(to.end(), face.mIndices, face.mIndices + face.mNumIndices);
            };
            if (face.mNumIndices >= 3) {
                append(out.corner_vertices);
                out.face_offsets.push_back(Index(out.corner_vertices.size()));
            } else if (face.mNumIndices == 2) {
                append(out.line_vertices);
                out.line_offsets.push_back(Index(out.line_vertices.size()));
            } else {
                append(out.points);
            }
        }
        materials(in, parts, out);
        if (in.HasNormals() && out.corner_count() > 0) {
            for (unsigned v = 0; v < in.mNumVertices; ++v)
                out.normals.values.push_back(
                    {in.mNormals[v].x, in.mNormals[v].y, in.mNormals[v].z});
            out.normals.indices = out.corner_vertices;
        }
        tangents(in, out);
        loose_parts(in, parts, out);
        for (unsigned s = 0; out.corner_count() > 0 && s < uv_sets(in); ++s) {
            auto& layer = out.uvs.emplace_back();
            for (unsigned v = 0; v < in.mNumVertices; ++v)
                layer.values.push_back(
                    {in.mTextureCoords[s][v].x, float(1.0 - double(in.mTextureCoords[s][v].y))});
            layer.indices = out.corner_vertices;
        }
        for (unsigned s = 0; out.corner_count() > 0 && s < color_sets(in); ++s) {
            out.colors.push_back({colors(in, s), out.corner_vertices});
            if (import_.is_by("Blender")) scale_bytes(out.colors.back().values);
        }
        leave_out(parts, out);
        for (unsigned t = 0; t < in.mNumAnimMeshes; ++t) target(in, *in.mAnimMeshes[t], out);
        // What moves by vertex stays as it is: equal positions are one point for adjacency only.
        out.indexed_by_vertex = !out.morph_targets.empty() || in.mNumBones > 0;
        scene_.meshes.push_back(std::move(out));
        return {};
    }

    void warn() {
        import_.warn(other_counts_, "morph target", "morph targets",
                     "left empty: as Assimp reads them, their vertices are not those of the mesh");
        import_.warn(other_attributes_, "morph target", "morph targets",
                     "of UVs, colours or tangents: those stay as in the mesh, or are computed");
        import_.warn(tangents_without_sign_, "tangent", "tangents",
                     "not kept: without normals and bitangents to tell their sign");
        import_.warn(not_finite_, "vertex", "vertices",
                     "of morph targets not finite: they stay where the mesh has them");
        import_.warn(unknown_weights_, "morph target", "morph targets",
                     "whose weight at rest Assimp does not read (FBX, DAE): taken for 0; "
                     "animated weights are there");
    }

  private:
    static const MeshPart& part_of(std::span<const MeshPart> parts, Index vertex) {
        const auto after =
            std::upper_bound(parts.begin(), parts.end(), vertex,
                             [](Index v, const MeshPart& part) { return v < part.first_vertex; });
        return after[-1];
    }

    static void materials(const aiMesh& in, std::span<const MeshPart> parts, Mesh& out) {
        out.face_materials.assign(out.face_count(), in.mMaterialIndex);
        if (parts.empty()) return;
        for (std::size_t f = 0; f < out.face_count(); ++f)
            out.face_materials[f] =
                part_of(parts, out.corner_vertices[out.face_offsets[f]]).material;
    }

    // Values that stand for those that a part has not.
    static void leave_out(std::span<const MeshPart> parts, Mesh& out) {
        if (parts.empty()) return;
        for (std::size_t c = 0; c < out.corner_count(); ++c) {
            const MeshPart& part = part_of(parts, out.corner_vertices[c]);
            if (!part.normals && !out.normals.empty()) out.normals.indices[c] = no_index;
            if (!part.tangents && !out.tangents.empty()) out.tangents.indices[c] = no_index;
            for (std::size_t s = 0; s < out.uvs.size(); ++s)
                if ((part.uv_sets >> s & 1) == 0) out.uvs[s].indices[c] = no_index;
            for (std::size_t s = 0; s < out.colors.size(); ++s)
                if ((part.color_sets >> s & 1) == 0) out.colors[s].indices[c] = no_index;
        }
    }

    static bool finite(const glm::vec3& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    }

    static unsigned uv_sets(const aiMesh& in) {
        unsigned count = 0;
        while (count < AI_MAX_NUMBER_OF_TEXTURECOORDS && in.HasTextureCoords(count)) ++count;
        return count;
    }
    static unsigned color_sets(const aiMesh& in) {
        unsigned count = 0;
        while (count < AI_MAX_NUMBER_OF_COLOR_SETS && in.HasVertexColors(count)) ++count;
        return count;
    }
    static std::vector<glm::vec4> colors(const aiMesh& in, unsigned set) {
        std::vector<glm::vec4> values;
        values.reserve(in.mNumVertices);
        for (unsigned v = 0; v < in.mNumVertices; ++v) {
            const aiColor4D& c = in.mColors[set][v];
            values.push_back({c.r, c.g, c.b, c.a});
        }
        return values;
    }
    // Blender's older files: bytes, which Assimp 5.2 gives as signed ones.
    static void scale_bytes(std::vector<glm::vec4>& colors) {
        bool beyond = false;
        for (const glm::vec4& c : colors)
            for (int k = 0; k < 4; ++k) {
                if (!(c[k] >= -128 && c[k] <= 127 && c[k] == std::floor(c[k]))) return;
                beyond |= c[k] < 0 || c[k] > 1;
            }
        for (glm::vec4& c : colors)
            for (int k = 0; beyond && k < 4; ++k) {
                const double byte = c[k] < 0 ? double(c[k]) + 256 : double(c[k]);
                c[k] = float(k < 3 ? srgb_to_linear(byte / 255) : byte / 255);
            }
    }

    // Lines and points have colours here, and those only where no face has them.
    void loose_parts(const aiMesh& in, std::span<const MeshPart> parts, Mesh& out) {
        if (out.points.empty() && out.line_vertices.empty()) return;
        const unsigned sets = color_sets(in);
        const bool taken = sets > 0 && out.face_count() == 0;
        if (taken) out.vertex_colors = colors(in, 0);
        out.loose_parts_with_attributes =
            in.HasNormals() || uv_sets(in) > 0 || sets > (taken ? 1u : 0u) ||
            is_material(in.mMaterialIndex) ||
            std::any_of(parts.begin(), parts.end(),
                        [&](const MeshPart& part) { return is_material(part.material); });
    }

    // Meshes without one have one that Assimp makes.
    bool is_material(unsigned index) const {
        if (index >= import_.from.mNumMaterials) return false;
        const aiString name = import_.from.mMaterials[index]->GetName();
        return text(name) != AI_DEFAULT_MATERIAL_NAME;
    }

    // Only with normals, which say what the sign is. Where a file has tangents alone, Assimp makes
    // bitangents of its own, which know nothing of mirrored UVs.
    void tangents(const aiMesh& in, Mesh& out) {
        if (!in.mTangents || out.corner_count() == 0) return;
        const bool stated =
            in.mNormals && in.mBitangents && !(any_mirrored_uvs(in) && bitangents_are_made(in));
        if (!stated) {
            tangents_without_sign_ += in.mNumVertices;
            return;
        }
        out.tangents.values.reserve(in.mNumVertices);
        for (unsigned v = 0; v < in.mNumVertices; ++v) {
            const aiVector3D& t = in.mTangents[v];
            const double side =
                glm::dot(glm::cross(vector(in.mNormals[v]), vector(t)), vector(in.mBitangents[v]));
            out.tangents.values.push_back({t.x, t.y, t.z, side < 0 ? -1.0f : 1.0f});
        }
        out.tangents.indices = out.corner_vertices;
    }

    static bool bitangents_are_made(const aiMesh& in) {
        for (unsigned v = 0; v < in.mNumVertices; ++v) {
            const aiVector3D made = in.mNormals[v] ^ in.mTangents[v];
            const aiVector3D& there = in.mBitangents[v];
            if (made.x != there.x || made.y != there.y || made.z != there.z) return false;
        }
        return true;
    }

    static bool any_mirrored_uvs(const aiMesh& in) {
        const aiVector3D* const uv = in.mTextureCoords[0];
        if (!uv) return false;
        for (unsigned f = 0; f < in.mNumFaces; ++f) {
            const aiFace& face = in.mFaces[f];
            double area = 0;  // twice, by the shoelace formula
            for (unsigned k = 0; k < face.mNumIndices; ++k) {
                const aiVector3D& a = uv[face.mIndices[k]];
                const aiVector3D& b = uv[face.mIndices[(k + 1) % face.mNumIndices]];
                area += double(a.x) * double(b.y) - double(a.y) * double(b.x);
            }
            if (area < 0) return true;
        }
        return false;
    }

    // Null where no difference is over `least`.
    std::vector<VertexDeltas> differences(const aiVector3D* to, const aiVector3D* from,
                                          unsigned count, double least) {
        auto values = std::make_shared<std::vector<glm::vec3>>(count, glm::vec3(0.0f));
        bool any = false;
        for (unsigned v = 0; v < count; ++v) {
            const glm::dvec3 d = vector(to[v]) - vector(from[v]);
            if (finite(glm::vec3(d)))
                (*values)[v] = glm::vec3(d);
            else
                ++not_finite_;
            any |= glm::length(d) > least;
        }
        if (!any) return {};
        return {VertexDeltas{0, std::move(values)}};
    }

    // Assimp has where a target leads to, we what it adds. All of them stay, so that the numbers
    // that animations have of them hold.
    void target(const aiMesh& in, const aiAnimMesh& from, Mesh& mesh) {
        MorphTarget out;
        out.name = text(from.mName);
        // Assimp 5.2 writes 1 where it has not read the weight.
        if (from.mWeight != 1 && std::isfinite(from.mWeight))
            out.weight = from.mWeight;
        else
            ++unknown_weights_;
        if (from.mNumVertices != in.mNumVertices) {
            ++other_counts_;
        } else {
            if (from.mVertices)
                out.positions = differences(from.mVertices, in.mVertices, in.mNumVertices, 0);
            // Below a float's step in a unit vector: normalised again, not moved.
            if (from.mNormals && in.mNormals)
                out.normals = differences(from.mNormals, in.mNormals, in.mNumVertices, 1e-6);
            bool others = false;
            for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s)
                others |=
                    from.mTextureCoords[s] && in.mTextureCoords[s] &&
                    !std::equal(from.mTextureCoords[s], from.mTextureCoords[s] + in.mNumVertices,
                                in.mTextureCoords[s]);
            for (unsigned s = 0; s < AI_MAX_NUMBER_OF_COLOR_SETS; ++s)
                others |=
                    from.mColors[s] && in.mColors[s] &&
                    !std::equal(from.mColors[s], from.mColors[s] + in.mNumVertices, in.mColors[s]);
            others |= from.mTangents && in.mTangents &&
                      !std::equal(from.mTangents, from.mTangents + in.mNumVertices, in.mTangents);
            other_attributes_ += others;
        }
        mesh.morph_targets.push_back(std::move(out));
    }

    AssimpImport& import_;
    const std::filesystem::path& path_;
    Scene& scene_;
    std::uint64_t other_counts_ = 0, other_attributes_ = 0, not_finite_ = 0, unknown_weights_ = 0,
                  tangents_without_sign_ = 0;
};

}  // namespace

Result<void> import_meshes(AssimpImport& import) {
    MeshImport meshes(import);
    for (unsigned m = 0; m < import.from.mNumMeshes; ++m)
        if (auto done =
                meshes.mesh(*import.from.mMeshes[m],
                            import.parts.empty() ? std::span<const MeshPart>() : import.parts[m]);
            !done)
            return done;
    meshes.warn();
    return {};
}

}  // namespace prep::detail
