#include "rig_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>
#include <vector>

namespace test {
namespace {

constexpr int joint_count = 8, ring_count = 12, side_count = 6;

// Rows of a matrix that turns about an axis of the plane xz and moves up.
std::string turn_and_rise(double angle, double about, double rise) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double x = std::cos(about), z = std::sin(about);  // Rodrigues about (x, 0, z)
    std::ostringstream out;
    out.precision(9);
    out << c + x * x * (1 - c) << ' ' << -z * s << ' ' << x * z * (1 - c) << " 0 "  //
        << z * s << ' ' << c << ' ' << -x * s << ' ' << rise << ' '                 //
        << x * z * (1 - c) << ' ' << x * s << ' ' << c + z * z * (1 - c) << " 0 0 0 0 1";
    return out.str();
}

std::string accessor(const std::string& of, std::size_t count, int stride, const char* type) {
    std::string text = "<technique_common><accessor source=\"#" + of + "\" count=\"" +
                       std::to_string(count) + "\" stride=\"" + std::to_string(stride) + "\">";
    // One for each number, but for what is one value.
    for (int k = 0; k < (stride <= 3 ? stride : 1); ++k)
        text.append("<param name=\"")
            .append(1, "XYZ"[k])
            .append("\" type=\"")
            .append(type)
            .append("\"/>");
    return text + "</accessor></technique_common>";
}

std::string numbers(const std::string& id, const std::vector<double>& values, int stride,
                    const char* type = "float") {
    std::ostringstream out;
    out.precision(9);
    out << "<source id=\"" << id << "\"><float_array id=\"" << id << "-a\" count=\""
        << values.size() << "\">";
    for (const double v : values) out << v << ' ';
    out << "</float_array>"
        << accessor(id + "-a", values.size() / std::size_t(stride), stride, type) << "</source>\n";
    return out.str();
}

}  // namespace

std::string collada_rig(const ColladaRig& rig) {
    std::mt19937 random(rig.seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * double(random() % 10000) / 10000;
    };
    std::vector<double> points;
    std::ostringstream polygons, counts;
    for (int r = 0; r < ring_count; ++r)
        for (int s = 0; s < side_count; ++s) {
            const double a = 2 * std::acos(-1.0) * s / side_count;
            points.insert(points.end(), {std::cos(a), 8.0 * r / (ring_count - 1), std::sin(a)});
        }
    int faces = 0;
    for (int r = 0; r + 1 < ring_count; ++r)
        for (int s = 0; s < side_count; ++s, ++faces) {
            const int t = (s + 1) % side_count;
            polygons << r * side_count + s << ' ' << (r + 1) * side_count + s << ' '
                     << (r + 1) * side_count + t << ' ' << r * side_count + t << ' ';
            counts << "4 ";
        }
    std::vector<double> weights;
    std::ostringstream vcount, v;
    for (int p = 0; p < ring_count * side_count; ++p) {
        const int n = rig.loose_vertices && p % 5 == 0 ? 0 : rig.influences;
        vcount << n << ' ';
        for (int k = 0; k < n; ++k) {
            v << (p / side_count + 3 * k) % joint_count << ' ' << weights.size() << ' ';
            weights.push_back(uniform(0.05, 1));  // sums that are not 1
        }
    }
    std::ostringstream binds, names;
    for (int j = 0; j < joint_count; ++j) {
        names << "j" << j << ' ';
        binds << "1 0 0 0 0 1 0 " << -j << " 0 0 1 0 0 0 0 1 ";
    }
    std::ostringstream out;
    out << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" )"
        << R"(version="1.4.1"><asset><unit name="u" meter=")" << rig.metres
        << R"("/><up_axis>Y_UP</up_axis></asset><library_animations>)";
    for (int j = 0; j < joint_count; ++j) {
        const std::string id = "a" + std::to_string(j);
        std::vector<double> times;
        std::string values;
        for (int k = 0; k < 5; ++k) {
            times.push_back(0.25 * k + (j % 2 ? 0.1 : 0));
            values += turn_and_rise(uniform(-1.2, 1.2), uniform(0, 3), j == 0 ? 0 : 1) + ' ';
        }
        out << "<animation id=\"" << id << "\">" << numbers(id + "-t", times, 1) << "<source id=\""
            << id << "-v\"><float_array id=\"" << id << "-v-a\" count=\"80\">" << values
            << "</float_array>" << accessor(id + "-v-a", 5, 16, "float4x4") << "</source>"
            << "<source id=\"" << id << "-i\"><Name_array id=\"" << id
            << "-i-a\" count=\"5\">LINEAR LINEAR LINEAR LINEAR LINEAR</Name_array>"
            << accessor(id + "-i-a", 5, 1, "name") << "</source><sampler id=\"" << id
            << "-s\"><input semantic=\"INPUT\" source=\"#" << id
            << "-t\"/><input semantic=\"OUTPUT\" source=\"#" << id
            << "-v\"/><input semantic=\"INTERPOLATION\" source=\"#" << id
            << "-i\"/></sampler><channel source=\"#" << id << "-s\" target=\"j" << j
            << "/transform\"/></animation>\n";
    }
    out << "</library_animations><library_geometries><geometry id=\"g\" name=\"tube\"><mesh>"
        << numbers("p", points, 3)
        << "<vertices id=\"pv\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
        << "<polylist count=\"" << faces
        << "\"><input semantic=\"VERTEX\" source=\"#pv\" offset=\"0\"/><vcount>" << counts.str()
        << "</vcount><p>" << polygons.str() << "</p></polylist></mesh></geometry>"
        << "</library_geometries><library_controllers><controller id=\"c\"><skin source=\"#g\">"
        << "<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>"
        << "<source id=\"jn\"><Name_array id=\"jn-a\" count=\"" << joint_count << "\">"
        << names.str() << "</Name_array>" << accessor("jn-a", joint_count, 1, "name")
        << "</source><source id=\"jb\"><float_array id=\"jb-a\" count=\"" << 16 * joint_count
        << "\">" << binds.str() << "</float_array>" << accessor("jb-a", joint_count, 16, "float4x4")
        << "</source>" << numbers("jw", weights, 1)
        << "<joints><input semantic=\"JOINT\" source=\"#jn\"/>"
        << "<input semantic=\"INV_BIND_MATRIX\" source=\"#jb\"/></joints><vertex_weights count=\""
        << ring_count * side_count << "\"><input semantic=\"JOINT\" source=\"#jn\" offset=\"0\"/>"
        << "<input semantic=\"WEIGHT\" source=\"#jw\" offset=\"1\"/><vcount>" << vcount.str()
        << "</vcount><v>" << v.str() << "</v></vertex_weights></skin></controller>"
        << "</library_controllers><library_visual_scenes><visual_scene id=\"s\">"
        << "<node id=\"arm\" name=\"arm\"><scale>" << rig.armature_scale[0] << ' '
        << rig.armature_scale[1] << ' ' << rig.armature_scale[2] << "</scale>";
    for (int j = 0; j < joint_count; ++j)
        out << "<node id=\"j" << j << "\" sid=\"j" << j << "\" name=\"j" << j
            << "\" type=\"JOINT\"><matrix sid=\"transform\">1 0 0 0 0 1 0 " << (j == 0 ? 0 : 1)
            << " 0 0 1 0 0 0 0 1</matrix>";
    for (int j = 0; j < joint_count; ++j) out << "</node>";
    out << "</node><node id=\"m\" name=\"m\"><translate>0.5 0 0.25</translate>"
        << "<instance_controller url=\"#c\"><skeleton>#j0</skeleton></instance_controller></node>"
        << "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/>"
        << "</scene></COLLADA>\n";
    return out.str();
}

namespace {

std::string vector_property(const char* name, double x, double y, double z) {
    std::ostringstream out;
    out << "P: \"" << name << "\", \"Vector3D\", \"Vector\", \"\"," << x << ',' << y << ',' << z
        << "\n";
    return out.str();
}

template <class T>
std::string array_of(const char* name, const std::vector<T>& values) {
    std::ostringstream out;
    out.precision(9);
    out << name << ": *" << values.size() << " { a: ";
    for (std::size_t i = 0; i < values.size(); ++i) out << (i ? "," : "") << values[i];
    out << " }\n";
    return out.str();
}

class FbxText {
  public:
    void curve_node(int id, const char* name, int target, const std::string& property) {
        objects << "AnimationCurveNode: " << id << ", \"AnimCurveNode::" << name
                << "\", \"\" { }\n";
        connections << "C: \"OO\"," << id << ",301\nC: \"OP\"," << id << ',' << target << ", \""
                    << property << "\"\n";
    }
    void curve(int id, int node, const char* component, const std::vector<double>& values) {
        std::vector<long long> times;
        for (std::size_t k = 0; k < values.size(); ++k)
            times.push_back((long long)(k) * (46186158000LL / 2));
        objects << "AnimationCurve: " << id
                << ", \"AnimCurve::\", \"\" { Default: 0\nKeyVer: 4008\n"
                << array_of("KeyTime", times) << array_of("KeyValueFloat", values)
                << "KeyAttrFlags: *1 { a: 24836 }\nKeyAttrDataFloat: *4 { a: 0,0,255,0 }\n"
                << "KeyAttrRefCount: *1 { a: " << values.size() << " }\n}\n";
        connections << "C: \"OP\"," << id << ',' << node << ", \"" << component << "\"\n";
    }
    void mesh(int id, const char* name, double size) {
        std::vector<double> points;
        for (int i = 0; i < 8; ++i)
            for (int k = 0; k < 3; ++k) points.push_back((i >> k) & 1 ? size : -size);
        objects << "Geometry: " << id << ", \"Geometry::" << name << "\", \"Mesh\" {\n"
                << array_of("Vertices", points)
                << array_of("PolygonVertexIndex",
                            std::vector<int>{0, 2, 3, -2, 4, 5, 7, -7, 0, 1, 5, -5,
                                             2, 6, 7, -4, 0, 4, 6, -3, 1, 3, 7, -6})
                << "GeometryVersion: 124\n}\n";
    }
    std::ostringstream objects, connections;
};

}  // namespace

std::string fbx_rig(const FbxRig& rig) {
    FbxText text;
    text.mesh(100, "box", 1);
    text.mesh(101, "hand", 0.5);
    text.objects << "Model: 200, \"Model::arm\", \"Mesh\" { Version: 232\nProperties70: {\n"
                 << vector_property("Lcl Translation", 4, 5, 6)
                 << vector_property("Lcl Rotation", 10, 20, 30)
                 << vector_property("Lcl Scaling", 1, 2, 0.5);
    if (rig.pre_rotation_only || rig.rotations_before_and_after)
        text.objects << vector_property("PreRotation", 30, -40, 15);
    if (!rig.pre_rotation_only) {
        if (rig.rotations_before_and_after)
            text.objects << vector_property("PostRotation", 0, 25, 0);
        if (rig.rotation_pivot)
            text.objects << vector_property("RotationPivot", 2, 3, -1)
                         << vector_property("RotationOffset", 0.5, 0, 0.25);
        if (rig.scaling_pivot)
            text.objects << vector_property("ScalingPivot", -1, 1, 2)
                         << vector_property("ScalingOffset", 0, 0.75, 0);
        if (rig.geometric)
            text.objects << vector_property("GeometricTranslation", 0, 7, 0)
                         << vector_property("GeometricScaling", 2, 2, 2);
    }
    text.objects << "}\n}\nModel: 201, \"Model::hand\", \"Mesh\" { Version: 232\nProperties70: {\n"
                 << vector_property("Lcl Translation", 0, 3, 0) << "}\n}\n";
    text.connections
        << "C: \"OO\",200,0\nC: \"OO\",201,200\nC: \"OO\",100,200\nC: \"OO\",101,201\n";
    if (rig.shape_keys) {
        for (int k = 0; k < 2; ++k) {
            text.objects << "Geometry: " << 110 + k << ", \"Geometry::key" << k
                         << "\", \"Shape\" { Version: 100\n"
                         << array_of("Indexes", std::vector<int>{k, 7})
                         << array_of("Vertices", std::vector<double>{1, 0.5 * k, 0, 0, 1.0 + k, 2})
                         << array_of("Normals", std::vector<double>(6, 0)) << "}\n"
                         << "Deformer: " << 120 + k << ", \"SubDeformer::key" << k
                         << "\", \"BlendShapeChannel\" { Version: 100\nDeformPercent: 0\n"
                         << "FullWeights: *1 { a: 100 }\n}\n";
            text.connections << "C: \"OO\"," << 110 + k << ',' << 120 + k << "\nC: \"OO\","
                             << 120 + k << ",130\n";
        }
        text.objects << "Deformer: 130, \"Deformer::keys\", \"BlendShape\" { Version: 100\n}\n";
        text.connections << "C: \"OO\",130,100\n";
    }
    if (rig.animated) {
        text.objects << "AnimationStack: 300, \"AnimStack::wave\", \"\" { }\n"
                     << "AnimationLayer: 301, \"AnimLayer::base\", \"\" { }\n";
        text.connections << "C: \"OO\",301,300\n";
        text.curve_node(310, "R", 200, "Lcl Rotation");
        text.curve(311, 310, "d|X", {10, 80, -60, 20});
        text.curve(312, 310, "d|Y", {20, 100, 140});
        text.curve(313, 310, "d|Z", {30, 0, 0, 90});
        text.curve_node(320, "T", 200, "Lcl Translation");
        text.curve(321, 320, "d|X", {4, 8, -3});
        text.curve(322, 320, "d|Y", {5, 5});
        text.curve(323, 320, "d|Z", {6, 6, 0, 1});
        text.curve_node(330, "S", 200, "Lcl Scaling");
        text.curve(331, 330, "d|X", {1, 1.5});
        text.curve(332, 330, "d|Y", {2, 0.75, 1});
        text.curve(333, 330, "d|Z", {0.5, 1});
        if (rig.shape_keys) {
            text.curve_node(340, "DeformPercent", 120, "DeformPercent");
            text.curve(341, 340, "d|DeformPercent", {0, 100, 30});
            text.curve_node(350, "DeformPercent", 121, "DeformPercent");
            text.curve(351, 350, "d|DeformPercent", {50, 0, 0, 80});
        }
    }
    std::ostringstream out;
    out << "; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXHeaderVersion: 1003\n"
        << "FBXVersion: 7400\n}\nGlobalSettings: {\nVersion: 1000\nProperties70: {\n"
        << "P: \"UpAxis\", \"int\", \"Integer\", \"\"," << rig.up
        << "\nP: \"CoordAxis\", \"int\", \"Integer\", \"\"," << (rig.up == 0 ? 1 : 0)
        << "\nP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n"
        << "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," << rig.unit
        << "\nP: \"TimeMode\", \"enum\", \"\", \"\",6\n}\n}\n"
        << "Definitions: {\nVersion: 100\nCount: 0\n}\nObjects: {\n"
        << text.objects.str() << "}\nConnections: {\n"
        << text.connections.str() << "}\n";
    return out.str();
}

OgreRig ogre_rig(const std::string& name) {
    constexpr int rows = 7;
    OgreRig rig;
    std::ostringstream mesh, assignments;
    mesh << "<mesh><submeshes><submesh material=\"stone\" usesharedvertices=\"false\" "
            "use32bitindexes=\"false\" operationtype=\"triangle_list\"><faces count=\""
         << 2 * (rows - 1) << "\">\n";
    for (int r = 0; r + 1 < rows; ++r) {
        const int v = 2 * r;
        for (const auto& [a, b, c] : {std::array{v, v + 1, v + 3}, {v, v + 3, v + 2}})
            mesh << "<face v1=\"" << a << "\" v2=\"" << b << "\" v3=\"" << c << "\"/>\n";
    }
    mesh << "</faces><geometry vertexcount=\"" << 2 * rows
         << "\"><vertexbuffer positions=\"true\" normals=\"true\" texture_coords=\"1\" "
            "texture_coord_dimensions_0=\"2\">\n";
    for (int v = 0; v < 2 * rows; ++v) {
        const int y = v / 2;
        mesh << "<vertex><position x=\"" << (v % 2 ? 1 : -1) << "\" y=\"" << y
             << "\" z=\"0\"/><normal x=\"0\" y=\"0\" z=\"1\"/><texcoord u=\"" << v % 2 << "\" v=\""
             << y / 8.0 << "\"/></vertex>\n";
        // Bone 0 below 2, bone 1 from 3 to 4, bone 2 from 5 on; half of two at 2.
        const auto assign = [&](int bone, double weight) {
            assignments << "<vertexboneassignment vertexindex=\"" << v << "\" boneindex=\"" << bone
                        << "\" weight=\"" << weight << "\"/>\n";
        };
        if (y < 2) assign(0, 1);
        if (y == 2) {
            assign(0, 0.25);
            assign(1, 0.75);
        }
        if (y == 3 || y == 4) assign(1, 1);
        if (y > 4) assign(2, 1);
    }
    mesh << "</vertexbuffer></geometry><boneassignments>\n"
         << assignments.str() << "</boneassignments></submesh></submeshes><skeletonlink name=\""
         << name << ".skeleton\"/></mesh>\n";
    rig.mesh = mesh.str();
    const auto bone = [](int id, int y) {
        return "<bone id=\"" + std::to_string(id) + "\" name=\"bone" + std::to_string(id) +
               "\"><position x=\"0\" y=\"" + std::to_string(y) +
               "\" z=\"0\"/><rotation angle=\"0\"><axis x=\"1\" y=\"0\" z=\"0\"/></rotation>"
               "</bone>\n";
    };
    const auto key = [](double time, double x, double angle) {
        std::ostringstream text;
        text << "<keyframe time=\"" << time << "\"><translate x=\"" << x
             << "\" y=\"0\" z=\"0\"/><rotate angle=\"" << angle
             << "\"><axis x=\"0\" y=\"0\" z=\"1\"/></rotate></keyframe>\n";
        return text.str();
    };
    rig.skeleton = "<skeleton><bones>\n" + bone(0, 0) + bone(1, 2) + bone(2, 2) +
                   "</bones><bonehierarchy><boneparent bone=\"bone1\" parent=\"bone0\"/>"
                   "<boneparent bone=\"bone2\" parent=\"bone1\"/></bonehierarchy>"
                   "<animations><animation name=\"bend\" length=\"2\"><tracks>"
                   "<track bone=\"bone1\"><keyframes>\n" +
                   key(0, 0, 0) + key(0.5, 0, 0.5) + key(2, 0.5, 1.5707963267948966) +
                   "</keyframes></track></tracks></animation></animations></skeleton>\n";
    rig.material =
        "material stone\n{\n technique\n {\n  pass\n  {\n   ambient 0 0 0 1\n"
        "   diffuse 0.25 0.5 0.75 1\n   specular 0.5 0.5 0.5 1 20\n   texture_unit\n   {\n"
        "    texture stone.png\n   }\n  }\n }\n}\n";
    return rig;
}

}  // namespace test
