// prepare(): the whole pipeline, from a loaded scene to meshes that a renderer can shade.
//
// requirements → repair → subdivide or tessellate (these where asked for) → weld/topology → hard
// edges → normals → tangents → split → optimize (where asked for). Each stage says whether it ran
// and why; what no material and no request calls for is not computed.
#pragma once

#include <cstdint>

#include "prep/corner_normals.h"
#include "prep/displacement/residual.h"
#include "prep/displacement/sources.h"
#include "prep/displacement/tessellate.h"
#include "prep/enum_names.h"
#include "prep/hard_edges.h"
#include "prep/prepared_scene.h"
#include "prep/repair.h"
#include "prep/requirements.h"
#include "prep/result.h"
#include "prep/scene.h"
#include "prep/subdivide.h"
#include "prep/tangents.h"

namespace prep {

// What happens to authored normals or tangents (those that the file brings).
enum class Authored : std::uint8_t {
    keep,     // kept where the file has them, computed where it does not or they are no direction
    replace,  // computed everywhere
    // Kept, but for the bad ones: zero, non-finite or non-unit; normals against their face;
    // tangents out of their normal's plane (by over 1.1°) or against the UVs (by over 60°, or of
    // other sign).
    repair,
};
constexpr auto names_of(Authored) {
    return std::to_array<EnumName<Authored>>(
        {{"keep", Authored::keep}, {"replace", Authored::replace}, {"repair", Authored::repair}});
}

enum class WeldMode : std::uint8_t {
    automatic,  // exact for vertex-indexed formats (glTF, PLY, …), none where the file indexes
                // positions apart from attributes (OBJ, OFF)
    none,
    exact,  // equal positions (−0 equals 0) are one vertex for adjacency
    // But with `none`: where no corner shares a vertex (STL, soups; not where vertices are tied to
    // the file or carry skins or morph targets), those at equal positions are made one for good.
};
constexpr auto names_of(WeldMode) {
    return std::to_array<EnumName<WeldMode>>(
        {{"auto", WeldMode::automatic}, {"none", WeldMode::none}, {"exact", WeldMode::exact}});
}

// Which heights move a surface that is tessellated; without `tessellate` none of this is read.
struct DisplaceOptions {
    bool from_materials = false;                       // each material's displacement map
    std::optional<ImageRef> map;                       // this one for all faces instead
    std::optional<NoiseOptions> noise;                 // this on all faces, instead or besides
    DisplacementKind kind = DisplacementKind::height;  // of `map`
    // Of vector maps in tangent space, the materials' as well, as no file says it: not `object`.
    VectorAxes axes = VectorAxes::tangent_normal_bitangent;
    std::uint32_t uv_set = 0;  // that `map` is read at
    // Channel, filter, scale (a material's own is multiplied by it) and, for `map`, wrap and
    // placement; its midlevel is not read.
    HeightMapOptions heights;
    // None: the material's, whatever its file holds; for `map` 0.5, but 0 for vectors in a file of
    // floats.
    std::optional<double> midlevel;
    // What samples of the surface so far apart cannot carry is left out of maps and noise, in units
    // of the mesh; 0: nothing. The spacings of `heights` and `noise` are not read.
    double band_limit = 0;
    // What the triangles cannot carry of the surface, as normal maps (displacement/residual.h).
    std::optional<ResidualMapOptions> residual;
};

struct PrepareOptions {
    Request request;
    RepairOptions repair;  // off unless asked for
    WeldMode weld = WeldMode::automatic;
    // Cages become their surfaces (threads are those below). Points are welded before as `weld`
    // says; the normals are the limit surface's, whatever `normals` says, and hard edges those of
    // the cage.
    bool subdivide = false;
    SubdivideOptions subdivision;
    bool recover_quads = false;      // first: quads from pairs of triangles, where only one fits
    bool crease_hard_edges = false;  // edges that `hard_edges` calls hard are infinitely sharp
    bool keep_cages = false;         // PreparedScene::cages and tessellation_errors
    // Triangles as fine as `tessellation` asks take the place of meshes: of the cage's limit
    // surface where `subdivide` says so (its level is not read), else of the polygons. The scheme,
    // the displacements, the hard edges and the threads that it reads are those given here; where
    // it asks for nothing, an error of a thousandth of the mesh's diagonal and at most a million
    // triangles are meant. Its screens are of the world: each is that of every node with the mesh.
    // Normals of polygons are prepared before, as `normals` and `normal` say of any mesh.
    bool tessellate = false;
    TessellateOptions tessellation;
    DisplaceOptions displacement;
    Authored normals = Authored::keep;
    NormalOptions normal;        // weight, precision
    HardEdgeOptions hard_edges;  // angle, borders
    Authored tangents = Authored::keep;
    TangentOptions tangent;  // neighbour rule, fallback, threshold
    // Triangles and vertices in an order that graphics hardware reads with less work
    // (vertex_order.h). Triangles of materials that blend stay in theirs, which is seen.
    bool optimize = false;
    // Whether the document that a scene came from is written back, as glTF's are: for one picture
    // alone, its textures and the UV sets that they refer to stay all the same.
    bool document_stays = true;
    int threads = 0;  // 0: all cores; the result does not depend on it
};

// Takes the scene by value: move it in to avoid a copy. Errors: limit (more than 2^32 − 2
// vertices and corners together, or 2^30 triangles where tangents are computed), invalid (options
// out of range), those of subdivide(), tessellate() and of pictures that heights are read from.
Result<PreparedScene> prepare(Scene scene, const PrepareOptions& options = {});

}  // namespace prep
