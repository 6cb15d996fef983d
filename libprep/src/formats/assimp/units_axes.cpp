// Metres. FBX counts in UnitScaleFactor centimetres, which Assimp tells and leaves to its caller;
// what Collada says of its unit is in the root node's transform already. Blender's files have z up,
// which it leaves so as well; those of 3DS and of Quake's kin it turns itself.
#include <charconv>
#include <cmath>

#include "formats/assimp/import.h"
#include "text/numbers.h"

namespace prep::detail {
namespace {

std::string short_text(double number) {
    char digits[max_number_text];
    return {digits, write_float(digits, float(number))};
}

// 2.54 is an inch, 2.5399999618 is not.
double by_own_digits(float number) {
    char digits[max_number_text];
    double value = 0;
    std::from_chars(digits, write_float(digits, number), value);
    return value;
}

// FBX says which of the file's axes point right, up and to the front: the first two are x and y
// here, and z is what makes a rotation of them. Assimp 5.2 tells and turns nothing.
glm::dmat4 axes_of(const aiMetadata& said, int& up) {
    const auto axis = [&](const char* name, int otherwise, int& number) {
        int sign = 1;
        number = otherwise;
        said.Get(name, number);
        said.Get(std::string(name) + "Sign", sign);
        if (number < 0 || number > 2) number = otherwise;
        glm::dvec3 direction(0.0);
        direction[number] = sign < 0 ? -1 : 1;
        return direction;
    };
    int right = 0;
    const glm::dvec3 y = axis("UpAxis", 1, up), x = axis("CoordAxis", 0, right);
    if (right == up) {
        up = 1;
        return glm::dmat4(1.0);
    }
    const glm::dvec3 z = glm::cross(x, y);
    return glm::dmat4(glm::transpose(glm::dmat3(x, y, z)));
}

}  // namespace

void import_units(AssimpImport& import) {
    const aiMetadata* said = import.from.mMetaData;
    Scene& scene = import.scene;
    if (scene.nodes.empty()) return;
    Placement& placement = scene.placement;
    if (import.is_by("Blender")) {
        placement.file_unit_source = "Blender, z up";
        const glm::dmat4 turn(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 0, -1, 0),
                              glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 0, 1));
        scene.nodes[0].transform = turn * scene.nodes[0].transform;
        return;
    }
    // As Collada: in the root node's transform already.
    if (import.is_by("Industry Foundation Classes")) {
        const double unit = glm::length(glm::dvec3(scene.nodes[0].transform[0]));
        if (!(unit > 0) || !std::isfinite(unit)) return;
        placement.file_unit = unit;
        placement.file_unit_source = "IFC unit, z up";
        return;
    }
    // Their readers have turned the root.
    static constexpr std::pair<std::string_view, const char*> with_z_up[] = {
        {"3DS", "3DS"},
        {"ASE Importer", "ASE"},
        {"(DXF)", "DXF"},
        {"MD5", "MD5"},
        {"Quake", "Quake"}};
    for (const auto& [reader, name] : with_z_up)
        if (const glm::dvec3 z(scene.nodes[0].transform[2]);
            import.is_by(reader) && z.y > 0 && z.x == 0 && z.z == 0)
            scene.remarks.push_back(
                std::string(name) + " files have z up: turned to y" +
                (z.y == 1 ? "" : ", and lengths multiplied by " + short_text(z.y)));
    if (!said) return;
    float number = 0;
    double precise = 0;
    if (said->Get("UnitScaleFactor", precise) || said->Get("UnitScaleFactor", number)) {
        const double centimetres = precise != 0 ? precise : by_own_digits(number);
        if (centimetres > 0 && std::isfinite(centimetres)) {
            placement.file_unit = centimetres / 100;
            placement.file_unit_source = "FBX UnitScaleFactor " + short_text(centimetres);
        } else {
            scene.warnings.emplace_back(
                "the file's UnitScaleFactor is no number over 0: its unit is taken for a metre");
            placement.file_unit_source = "FBX";
        }
        int up = 1;
        glm::dmat4 metres = axes_of(*said, up);
        for (int c = 0; c < 3; ++c) metres[c] *= placement.file_unit;
        if (up != 1) placement.file_unit_source += up == 0 ? ", x up" : ", z up";
        scene.nodes[0].transform = metres * scene.nodes[0].transform;
    } else if (import.is_by("Collada")) {
        const double unit = glm::length(glm::dvec3(scene.nodes[0].transform[0]));
        if (!(unit > 0) || !std::isfinite(unit) || std::abs(unit - 1) < 1e-5) return;
        placement.file_unit = unit;
        placement.file_unit_source = "Collada unit";
    }
}

}  // namespace prep::detail
