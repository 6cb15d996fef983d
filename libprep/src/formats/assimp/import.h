// What the parts of the Assimp reader share while one file is read. A file for each subject; the
// order is that of read_scene() in assimp_reader.cpp.
#pragma once

#include <assimp/commonMetaData.h>
#include <assimp/scene.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "formats/assimp/counted_names.h"
#include "formats/assimp/split_meshes.h"
#include "formats/assimp/threemf/package_parts.h"
#include "prep/load.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace prep::detail {

// A node of Assimp that is one of several factors of a node here: FBX's pivots come as nodes of
// their own ("Arm_$AssimpFbx$_RotationPivot").
struct PivotFactor {
    const aiNode* node = nullptr;
    glm::dmat4 transform{1.0};
};

// Where the nodes of the file have gone.
struct AssimpNodes {
    // By scene node: the factors whose product its transform is, from the parent down; empty for
    // nodes that stand for one node of the file.
    std::map<std::uint32_t, std::vector<PivotFactor>> factors;
    // By name in the file, its first node: where its animation belongs, and what moves as it does
    // (another node only where FBX has a geometric transform, which children do not inherit).
    struct Target {
        std::uint32_t animated = no_index, frame = no_index;
        std::vector<std::uint32_t> mesh_nodes;  // that hold its meshes
    };
    std::map<std::string, Target> by_name;
    std::set<std::string> repeated_names;

    const Target* find(const aiString& name) const {
        const auto found = by_name.find(std::string(name.data, name.length));
        return found == by_name.end() ? nullptr : &found->second;
    }
};

// By which of Assimp's readers.
inline bool is_by(const aiScene& scene, std::string_view reader) {
    aiString name;
    return scene.mMetaData && scene.mMetaData->Get(AI_METADATA_SOURCE_FORMAT, name) &&
           std::string_view(name.data, name.length).find(reader) != std::string_view::npos;
}

struct AssimpImport {
    const aiScene& from;
    const std::filesystem::path& path;
    Scene scene;
    AssimpNodes nodes;
    MeshParts parts = {};
    const PackageParts* package = nullptr;  // of 3MF: where its pictures are

    bool is_by(std::string_view reader) const { return detail::is_by(from, reader); }
    // "3 keys …", "1 key …" in the scene's warnings; nothing for a count of 0.
    void warn(std::uint64_t count, const char* one, const char* many, const std::string& rest) {
        add(count, one, many, rest, scene.warnings);
    }
    // "3 node properties not kept: a, b, c".
    void warn_not_kept(const CountedNames& what, const char* one, const char* many) {
        add_not_kept(what, one, many, scene.warnings);
    }
    // The same of what is no part of the model.
    void remark_not_kept(const CountedNames& what, const char* one, const char* many) {
        add_not_kept(what, one, many, scene.remarks);
    }

  private:
    static void add(std::uint64_t count, const char* one, const char* many, const std::string& rest,
                    std::vector<std::string>& to) {
        if (count > 0)
            to.push_back(std::to_string(count) + ' ' + (count == 1 ? one : many) + ' ' + rest);
    }
    static void add_not_kept(const CountedNames& what, const char* one, const char* many,
                             std::vector<std::string>& to) {
        const std::string names = what.names.text();
        add(what.count, one, many, names.empty() ? "not kept" : "not kept: " + names, to);
    }
};

inline std::string text(const aiString& s) {
    return {s.data, s.length};
}

inline glm::dmat4 matrix(const aiMatrix4x4& m) {
    return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
            m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

inline glm::dvec3 vector(const aiVector3D& v) {
    return {v.x, v.y, v.z};
}

// Whether Assimp made the node of this name for one of FBX's pivots.
bool is_pivot(const aiString& name);

// One material for each of Assimp's, in their order, with its textures and pictures.
void import_materials(AssimpImport& import, const LoadOptions& options);
// Sides of AC3D's surfaces, which Assimp does not tell, as their materials' (ac3d_surfaces.h).
void import_sides(AssimpImport& import);
// Once meshes are there: maps of a UV set that no mesh of theirs has take the only one.
void settle_uv_sets(AssimpImport& import);
// Errors: invalid (indices out of range).
Result<void> import_meshes(AssimpImport& import);
// Errors: limit (nesting).
Result<void> import_nodes(AssimpImport& import);
void import_skins(AssimpImport& import);
// Of what import_skins() and the morph targets made vertices of.
void share_vertices_of_corners(AssimpImport& import);
void import_animations(AssimpImport& import);
void import_cameras_and_lights(AssimpImport& import);
// FBX's UnitScaleFactor, and what Assimp did with Collada's <unit>.
void import_units(AssimpImport& import);
// Warnings for what none of the others takes.
void count_what_is_not_kept(AssimpImport& import);

}  // namespace prep::detail
