// The pictures of a validation sheet: four shadings, the file's materials, normals, tangents, UVs,
// wireframe and hard edges; of subdivided meshes the cage, its edges on the limit surface, and the
// surface's curvature; of displaced ones the relief as bump and normal maps show it.
#pragma once

#include <string>
#include <vector>

#include "prep/prepare.h"
#include "prep/result.h"
#include "sheets/sheet.h"
#include "sheets/subject.h"

namespace report {

struct PanelOptions {
    std::uint32_t size = 480;             // pixels
    std::uint32_t samples = 3;            // per pixel and axis
    double azimuth = 30, elevation = 20;  // degrees
    prep::PrepareOptions prepare;         // what the scene was prepared with: names hard edges
    int threads = 0;
};

struct PanelSet {
    std::vector<Panel> panels;
    FigureGroup differences;  // how far the shadings are apart, in 8-bit levels
    FigureGroup edges;        // how many of each class
    std::vector<std::string> warnings;
};

prep::Result<PanelSet> make_panels(Subject subject, const PanelOptions& options);

}  // namespace report
