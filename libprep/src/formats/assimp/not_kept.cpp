// What Assimp's scene has and ours has no place for: counted and named. What a reader of the other
// files drops of what it otherwise takes, that file says.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "formats/assimp/import.h"

namespace prep::detail {
namespace {

std::string_view view(const aiString& s) {
    return {s.data, s.length};
}

template <class List>
bool contains(const List& list, std::string_view name) {
    return std::find(std::begin(list), std::end(list), name) != std::end(list);
}

// Zero, false, empty: programs write whole tables of what does not apply.
bool is_nothing(const aiMetadataEntry& entry) {
    if (!entry.mData) return true;
    switch (entry.mType) {
        case AI_BOOL:
            return !*static_cast<const bool*>(entry.mData);
        case AI_INT32:
            return *static_cast<const std::int32_t*>(entry.mData) == 0;
        case AI_UINT64:
            return *static_cast<const std::uint64_t*>(entry.mData) == 0;
        case AI_FLOAT:
            return *static_cast<const float*>(entry.mData) == 0;
        case AI_DOUBLE:
            return *static_cast<const double*>(entry.mData) == 0;
        case AI_AISTRING:
            return static_cast<const aiString*>(entry.mData)->length == 0;
        case AI_AIVECTOR3D:
            return *static_cast<const aiVector3D*>(entry.mData) == aiVector3D(0, 0, 0);
        default:
            return false;
    }
}

bool is_number(const aiMetadataEntry& entry, double value) {
    if (!entry.mData) return false;
    if (entry.mType == AI_INT32) return *static_cast<const std::int32_t*>(entry.mData) == value;
    if (entry.mType == AI_FLOAT) return double(*static_cast<const float*>(entry.mData)) == value;
    if (entry.mType == AI_DOUBLE) return *static_cast<const double*>(entry.mData) == value;
    return false;
}

// What units_axes.cpp reads, what those were before the file's program changed them, and what
// Assimp says of its own reader.
constexpr std::string_view read_of_scenes[] = {"UpAxis",
                                               "UpAxisSign",
                                               "FrontAxis",
                                               "FrontAxisSign",
                                               "CoordAxis",
                                               "CoordAxisSign",
                                               "UnitScaleFactor",
                                               "OriginalUpAxis",
                                               "OriginalUpAxisSign",
                                               "OriginalUnitScaleFactor",
                                               "SourceAsset_Format",
                                               "SourceAsset_FormatVersion"};
// What Assimp obeys, or adds of its own.
constexpr std::string_view read_of_nodes[] = {"IsNull", "DefaultAttributeIndex", "RotationActive"};

class NotKept {
  public:
    explicit NotKept(AssimpImport& import) : import_(import), from_(import.from) {}

    void run() {
        if (from_.mMetaData) scene(*from_.mMetaData);
        if (from_.mName.length > 0) of_scene_.add("name");
        if (from_.mRootNode) nodes(*from_.mRootNode);
        for (unsigned m = 0; m < from_.mNumMeshes; ++m) mesh(*from_.mMeshes[m]);
        for (unsigned l = 0; l < from_.mNumLights; ++l) light(*from_.mLights[l]);
        for (unsigned a = 0; a < from_.mNumAnimations; ++a) animation(*from_.mAnimations[a]);
        import_.remark_not_kept(of_scene_, "property of the scene", "properties of the scene");
        import_.remark_not_kept(of_nodes_, "property of nodes", "properties of nodes");
        import_.warn(from_.mNumSkeletons, "skeleton", "skeletons",
                     "beside those of skins not kept");
        import_.warn(third_, "texture coordinate", "texture coordinates",
                     "with a third component, which is not kept");
        import_.warn(gaps_, "UV or colour set", "UV or colour sets",
                     "behind one that is missing not kept");
        import_.remark_not_kept(uv_names_, "name of a UV set", "names of UV sets");
        import_.warn(light_colors_, "light", "lights",
                     "with another colour for highlights or shadows, which is not kept");
        import_.warn(longer_, "animation", "animations",
                     "said to last longer than to the last key: it ends there");
    }

  private:
    void scene(const aiMetadata& data) {
        for (unsigned i = 0; i < data.mNumProperties; ++i) {
            const std::string_view key = view(data.mKeys[i]);
            const aiMetadataEntry& entry = data.mValues[i];
            const bool usual = key == "CustomFrameRate" && is_number(entry, -1);
            if (!usual && !is_nothing(entry) && !contains(read_of_scenes, key)) of_scene_.add(key);
        }
    }

    // The chain of nodes is as deep as nodes.cpp has let through.
    void nodes(const aiNode& root) {
        std::vector<const aiNode*> rest{&root};
        while (!rest.empty()) {
            const aiNode& node = *rest.back();
            rest.pop_back();
            if (node.mMetaData) of_node(*node.mMetaData);
            for (unsigned c = 0; c < node.mNumChildren; ++c) rest.push_back(node.mChildren[c]);
        }
    }
    void of_node(const aiMetadata& data) {
        for (unsigned i = 0; i < data.mNumProperties; ++i) {
            const std::string_view key = view(data.mKeys[i]);
            const aiMetadataEntry& entry = data.mValues[i];
            // 1: children inherit the product of their parents' matrices, as they do here.
            const bool usual = key == "InheritType" && is_number(entry, 1);
            if (!usual && !is_nothing(entry) && !contains(read_of_nodes, key)) of_nodes_.add(key);
        }
    }

    void mesh(const aiMesh& in) {
        bool gap = false;
        for (unsigned s = 0; s < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++s) {
            const aiVector3D* const uvs = in.mTextureCoords[s];
            gaps_ += gap && uvs;
            gap |= !uvs;
            if (!uvs) continue;
            if (const aiString* const name = in.GetTextureCoordsName(s); name && name->length > 0)
                uv_names_.add(view(*name));
            for (unsigned v = 0; in.mNumUVComponents[s] > 2 && v < in.mNumVertices; ++v)
                third_ += uvs[v].z != 0;
        }
        gap = false;
        for (const aiColor4D* const colors : in.mColors) {
            gaps_ += gap && colors;
            gap |= !colors;
        }
    }

    void light(const aiLight& in) {
        if (in.mType == aiLightSource_AMBIENT) return;
        const aiColor3D black(0, 0, 0);
        light_colors_ += (in.mColorSpecular != in.mColorDiffuse && in.mColorSpecular != black) ||
                         in.mColorAmbient != black;
    }

    // A tick more is how some formats count: from the first to the last, or how many there are.
    void animation(const aiAnimation& in) {
        double last = 0;
        for (unsigned c = 0; c < in.mNumChannels; ++c) {
            const aiNodeAnim& channel = *in.mChannels[c];
            if (channel.mNumPositionKeys > 0)
                last = std::max(last, channel.mPositionKeys[channel.mNumPositionKeys - 1].mTime);
            if (channel.mNumRotationKeys > 0)
                last = std::max(last, channel.mRotationKeys[channel.mNumRotationKeys - 1].mTime);
            if (channel.mNumScalingKeys > 0)
                last = std::max(last, channel.mScalingKeys[channel.mNumScalingKeys - 1].mTime);
        }
        for (unsigned c = 0; c < in.mNumMorphMeshChannels; ++c) {
            const aiMeshMorphAnim& channel = *in.mMorphMeshChannels[c];
            if (channel.mNumKeys > 0)
                last = std::max(last, channel.mKeys[channel.mNumKeys - 1].mTime);
        }
        longer_ += std::isfinite(in.mDuration) && in.mDuration > last + 1.001;
    }

    AssimpImport& import_;
    const aiScene& from_;
    CountedNames of_scene_, of_nodes_, uv_names_;
    std::uint64_t third_ = 0, gaps_ = 0, light_colors_ = 0, longer_ = 0;
};

}  // namespace

void count_what_is_not_kept(AssimpImport& import) {
    NotKept(import).run();
}

}  // namespace prep::detail
