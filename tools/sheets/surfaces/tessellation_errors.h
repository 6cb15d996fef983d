// What is proved of tessellated meshes, as colours and as numbers.
#pragma once

#include "prep/prepared_scene.h"
#include "sheets/sheet.h"

namespace report {

struct ErrorColors {
    std::uint64_t triangles = 0,
                  missed = 0;  // of tessellated meshes; that are above what was asked
    bool asked = false;        // of every one of these meshes, as a length
};

// Colours by PreparedScene::tessellation_errors, a triangle in one colour, so that each has
// vertices of its own afterwards: pale where nothing is off, blue at what was asked of the mesh (of
// one that was not asked, at the largest of its own), red above and where nothing is proved. Meshes
// without errors stay pale.
ErrorColors color_by_errors(prep::PreparedScene& scene);

// Group "Tessellation"; without figures where no mesh was tessellated.
FigureGroup tessellation_group(const prep::PreparedScene& scene, int threads);

}  // namespace report
