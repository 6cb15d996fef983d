// Rigs as text, with all that exporters write: Collada skins of 1 to 8 influences, FBX pivots and
// shape keys.
#pragma once

#include <string>

namespace test {

struct ColladaRig {
    int influences = 1;  // of every vertex, of 8 joints in a chain
    double armature_scale[3] = {1, 1, 1};
    bool loose_vertices = false;  // every fifth has no weight
    unsigned seed = 1;
    double metres = 1;  // <unit>
};
std::string collada_rig(const ColladaRig& rig);

struct FbxRig {
    bool rotation_pivot = true, scaling_pivot = true, rotations_before_and_after = true;
    bool geometric = true;  // transform of the mesh alone, which the child does not inherit
    bool shape_keys = true;
    bool animated = true;
    bool pre_rotation_only = false;  // no pivots at all
    double unit = 2.54;              // centimetres
    int up = 1;                      // the axis, 0 to 2; x or y to the right
};
std::string fbx_rig(const FbxRig& rig);

// A strip of quads up the y axis, 1 a row of vertices, x = ±1, and three bones at y = 0, 2 and 4.
// In "bend", of 2 seconds, the second bone moves by (0.5, 0, 0) and turns by 90 degrees about z,
// which Ogre counts from the pose in which it is bound.
struct OgreRig {
    std::string mesh, skeleton, material;  // NAME.mesh.xml, NAME.skeleton.xml, NAME.material
};
OgreRig ogre_rig(const std::string& name);

}  // namespace test
