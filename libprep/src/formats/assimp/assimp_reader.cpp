#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <exception>

#include "formats/foreign_files.h"
#include "prep/mesh.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Deeper than any real file; a longer chain is a broken or hostile one.
constexpr int max_depth = 2000;

// Assimp 5.2 passes over what Collada says of a camera, and then takes its own angle of π/4 for
// degrees: a picture of nearly nothing.
constexpr float unread_angle = 0.7853981634f * 0.0174532925f;

std::string text(const aiString& s) {
    return {s.data, s.length};
}

glm::dmat4 matrix(const aiMatrix4x4& m) {
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
            m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

class Converter {
  public:
    Converter(const aiScene& from, const std::filesystem::path& path) : from_(from), path_(path) {}

    Result<Scene> run() {
        scene_.name = path_.filename().string();
        for (unsigned m = 0; m < from_.mNumMaterials; ++m) material(*from_.mMaterials[m]);
        for (unsigned m = 0; m < from_.mNumMeshes; ++m)
            if (auto done = mesh(*from_.mMeshes[m]); !done) return std::move(done).error();
        if (from_.mRootNode && !node(*from_.mRootNode, no_index, 0))
            return Error{ErrorCode::limit, "the scene graph is nested too deeply", path_.string()};
        cameras_and_lights();
        return std::move(scene_);
    }

  private:
    Result<void> mesh(const aiMesh& in) {
        Mesh out;
        out.name = text(in.mName);
        std::vector<glm::dvec3> positions(in.mNumVertices);
        for (unsigned v = 0; v < in.mNumVertices; ++v)
            positions[v] = {in.mVertices[v].x, in.mVertices[v].y, in.mVertices[v].z};
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
        out.face_materials.assign(out.face_count(), in.mMaterialIndex);
        if (in.HasNormals() && out.corner_count() > 0) {
            for (unsigned v = 0; v < in.mNumVertices; ++v)
                out.normals.values.push_back(
                    {in.mNormals[v].x, in.mNormals[v].y, in.mNormals[v].z});
            out.normals.indices = out.corner_vertices;
        }
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS && in.HasTextureCoords(s); ++s) {
            auto& layer = out.uvs.emplace_back();
            for (unsigned v = 0; v < in.mNumVertices; ++v)
                layer.values.push_back(
                    {in.mTextureCoords[s][v].x, float(1.0 - double(in.mTextureCoords[s][v].y))});
            layer.indices = out.corner_vertices;
        }
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_COLOR_SETS && in.HasVertexColors(s); ++s) {
            auto& layer = out.colors.emplace_back();
            for (unsigned v = 0; v < in.mNumVertices; ++v) {
                const aiColor4D& c = in.mColors[s][v];
                layer.values.push_back({c.r, c.g, c.b, c.a});
            }
            layer.indices = out.corner_vertices;
        }
        scene_.meshes.push_back(std::move(out));
        return {};
    }

    bool node(const aiNode& in, Index parent, int depth) {
        if (depth > max_depth) return false;
        const Index self = Index(scene_.nodes.size());
        Node out;
        out.name = text(in.mName);
        out.parent = parent;
        out.transform = matrix(in.mTransformation);
        if (in.mNumMeshes == 1 && in.mMeshes[0] < scene_.meshes.size()) out.mesh = in.mMeshes[0];
        scene_.nodes.push_back(out);
        if (in.mNumMeshes > 1)
            for (unsigned m = 0; m < in.mNumMeshes; ++m) {
                if (in.mMeshes[m] >= scene_.meshes.size()) continue;
                Node child;
                child.name = scene_.meshes[in.mMeshes[m]].name;
                child.parent = self;
                child.mesh = in.mMeshes[m];
                scene_.nodes.push_back(std::move(child));
            }
        for (unsigned c = 0; c < in.mNumChildren; ++c)
            if (!node(*in.mChildren[c], self, depth + 1)) return false;
        return true;
    }

    static glm::vec3 color(const aiMaterial& in, const char* key, unsigned type, unsigned index,
                           const glm::vec3& otherwise) {
        aiColor3D c;
        return in.Get(key, type, index, c) == AI_SUCCESS ? glm::vec3(c.r, c.g, c.b) : otherwise;
    }

    void material(const aiMaterial& in) {
        Material out;
        aiString name;
        if (in.Get(AI_MATKEY_NAME, name) == AI_SUCCESS) out.name = text(name);
        out.diffuse = glm::vec4(color(in, AI_MATKEY_COLOR_DIFFUSE, glm::vec3(out.diffuse)), 1.0f);
        out.specular = color(in, AI_MATKEY_COLOR_SPECULAR, glm::vec3(0.0f));
        out.emissive = color(in, AI_MATKEY_COLOR_EMISSIVE, glm::vec3(0.0f));
        float number = 0;
        if (in.Get(AI_MATKEY_SHININESS, number) == AI_SUCCESS && number >= 0)
            out.shininess = number;
        if (in.Get(AI_MATKEY_OPACITY, number) == AI_SUCCESS) {
            out.diffuse.a = std::clamp(number, 0.0f, 1.0f);
            if (out.diffuse.a < 1) out.alpha_mode = AlphaMode::blend;
        }
        int two_sided = 0;
        if (in.Get(AI_MATKEY_TWOSIDED, two_sided) == AI_SUCCESS) out.double_sided = two_sided != 0;
        map(in, aiTextureType_DIFFUSE, out.diffuse_map);
        map(in, aiTextureType_SPECULAR, out.specular_map);
        map(in, aiTextureType_EMISSIVE, out.emissive_map);
        map(in, aiTextureType_NORMALS, out.normal_map);
        map(in, aiTextureType_HEIGHT, out.bump_map);
        map(in, aiTextureType_DISPLACEMENT, out.displacement_map);
        scene_.materials.push_back(std::move(out));
    }

    void map(const aiMaterial& in, aiTextureType type, TextureRef& to) {
        aiString file;
        aiTextureMapMode mode[2] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
        unsigned uv = 0;
        if (in.GetTexture(type, 0, &file, nullptr, &uv, nullptr, nullptr, mode) != AI_SUCCESS)
            return;
        ImageRef image;
        image.name = text(file);
        if (const aiTexture* embedded = from_.GetEmbeddedTexture(file.C_Str())) {
            // Height 0: a whole compressed file; else raw texels, which glTF-like use never has.
            if (embedded->mHeight != 0) return;
            const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);
            image.bytes.assign(bytes, bytes + embedded->mWidth);
        } else {
            std::string relative = image.name;
            std::replace(relative.begin(), relative.end(), '\\', '/');
            image.path = (path_.parent_path() / relative).lexically_normal();
        }
        Texture texture;
        const auto wrap = [](aiTextureMapMode m) {
            return m == aiTextureMapMode_Mirror  ? Wrap::mirror
                   : m == aiTextureMapMode_Clamp ? Wrap::clamp
                   : m == aiTextureMapMode_Decal ? Wrap::border
                                                 : Wrap::repeat;
        };
        texture.wrap_u = wrap(mode[0]);
        texture.wrap_v = wrap(mode[1]);
        texture.image = Index(scene_.images.size());
        scene_.images.push_back(std::move(image));
        to.texture = Index(scene_.textures.size());
        to.uv_set = uv;
        scene_.textures.push_back(texture);
    }

    Index node_named(const aiString& name) const {
        for (Index n = 0; n < scene_.nodes.size(); ++n)
            if (scene_.nodes[n].name == text(name)) return n;
        return no_index;
    }

    void cameras_and_lights() {
        for (unsigned c = 0; c < from_.mNumCameras; ++c) {
            const aiCamera& in = *from_.mCameras[c];
            Camera out;
            out.name = text(in.mName);
            out.aspect = in.mAspect;
            if (std::abs(in.mHorizontalFOV - unread_angle) < 1e-6f) {
                scene_.warnings.push_back("Assimp does not read the angle of the camera '" +
                                          out.name + "': it gets the usual one");
            } else {
                const double half = std::tan(double(in.mHorizontalFOV) / 2);
                const double aspect = in.mAspect > 0 ? double(in.mAspect) : 4.0 / 3.0;
                if (half > 0) out.yfov = 2 * std::atan(half / aspect);
                if (in.mClipPlaneNear > 0) out.znear = in.mClipPlaneNear;
                out.zfar = in.mClipPlaneFar;
            }
            const Index node = node_named(in.mName);
            if (node != no_index) scene_.nodes[node].camera = Index(scene_.cameras.size());
            scene_.cameras.push_back(std::move(out));
        }
        for (unsigned l = 0; l < from_.mNumLights; ++l) {
            const aiLight& in = *from_.mLights[l];
            Light out;
            out.name = text(in.mName);
            switch (in.mType) {
                case aiLightSource_AMBIENT:
                    out.kind = LightKind::ambient;
                    break;
                case aiLightSource_DIRECTIONAL:
                    out.kind = LightKind::directional;
                    break;
                case aiLightSource_POINT:
                    out.kind = LightKind::point;
                    break;
                case aiLightSource_SPOT:
                    out.kind = LightKind::spot;
                    break;
                default:
                    continue;
            }
            out.color = {in.mColorDiffuse.r, in.mColorDiffuse.g, in.mColorDiffuse.b};
            out.inner_cone = in.mAngleInnerCone / 2;
            out.outer_cone = in.mAngleOuterCone / 2;
            const Index node = node_named(in.mName);
            if (node != no_index) scene_.nodes[node].light = Index(scene_.lights.size());
            scene_.lights.push_back(std::move(out));
        }
    }

    const aiScene& from_;
    const std::filesystem::path& path_;
    Scene scene_;
};

}  // namespace

bool assimp_reads(const std::string& extension) {
    if (extension.size() < 2) return false;
    Assimp::Importer importer;
    return importer.IsExtensionSupported(extension);
}

Result<Scene> load_with_assimp(const std::filesystem::path& path) {
    try {
        Assimp::Importer importer;
        // Only what keeps the file as it is: no joining, no triangulation, no generated normals.
        const aiScene* scene = importer.ReadFile(path.string(), aiProcess_ValidateDataStructure);
        if (!scene || !scene->mRootNode)
            return Error{ErrorCode::syntax, std::string("Assimp: ") + importer.GetErrorString(),
                         path.string()};
        return Converter(*scene, path).run();
    } catch (const std::exception& e) {
        return Error{ErrorCode::syntax, std::string("Assimp: ") + e.what(), path.string()};
    }
}

}  // namespace prep::detail
