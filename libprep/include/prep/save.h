// Writing a prepared scene: GLB, glTF, OBJ+MTL, PLY, STL, OFF, by ending; GLB into memory, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "prep/enum_names.h"
#include "prep/prepared_scene.h"
#include "prep/result.h"

namespace prep {

// How glTF files store vertices and triangles.
enum class Compression : std::uint8_t {
    keep,     // as the glTF file that they came from; from others: as they are
    none,     // as they are
    draco,    // KHR_draco_mesh_compression: triangles
    meshopt,  // EXT_meshopt_compression: all but pictures
};
constexpr auto names_of(Compression) {
    return std::to_array<EnumName<Compression>>({{"keep", Compression::keep},
                                                 {"none", Compression::none},
                                                 {"draco", Compression::draco},
                                                 {"meshopt", Compression::meshopt}});
}

// KHR_mesh_quantization: how many bits a component of the written values has; 0: they stay as they
// are. Positions and UVs 4 to 16, normals and tangents 8 to 16.
struct Quantization {
    int positions = 0, normals = 0, tangents = 0, uvs = 0;
    bool any() const { return positions != 0 || normals != 0 || tangents != 0 || uvs != 0; }
};
struct QuantizationRow {
    const char* name;
    int Quantization::*bits;
    int least, most;
    const char* unit;  // of the errors
};
inline constexpr QuantizationRow quantization_rows[] = {
    {"positions", &Quantization::positions, 4, 16, "of the mesh's diagonal"},
    {"normals", &Quantization::normals, 8, 16, "degrees"},
    {"tangents", &Quantization::tangents, 8, 16, "degrees"},
    {"uvs", &Quantization::uvs, 4, 16, "UV"},
};

// How far what was written is from what was prepared, in the row's unit. Morph targets' positions
// count among the positions.
struct QuantizationError {
    int bits = 0;
    std::uint64_t values = 0;  // that were rounded
    std::uint64_t kept = 0;    // that stayed floats; the remarks say why
    double largest = 0, mean = 0;
};
struct QuantizationReport {
    QuantizationError rows[std::size(quantization_rows)];  // in that order
    std::vector<std::string> remarks;                      // why values stayed floats
};

struct SaveOptions {
    int threads = 0;      // 0: all cores; the result does not depend on it
    bool ascii = false;   // PLY and STL: text instead of binary
    bool replace = true;  // whether files that exist are replaced; else they are an error
    // Whether the output and files beside it (.mtl, .bin, images) may replace files that were read
    // for the scene beside its source (its own .mtl, .bin, images, the meshes of a scene file), and
    // files beside the output the source; else that is an error.
    bool replace_sources = false;
    // Where not empty, asked of each file that is there already and would be replaced: true keeps
    // it, and is an error. For callers that know what else is read, by other inputs of a batch.
    std::function<bool(const std::filesystem::path& file)> spared = {};
    // Other formats have none: draco and meshopt are errors there. Values lose nothing, but where
    // Draco rounded them in the file that they came from: there they keep its steps.
    Compression compression = Compression::keep;
    // Other formats have none: any is an error there. Values are rounded first and compressed
    // then; what the input's own compression rounded is not kept in its steps.
    Quantization quantization;
    // What became of it. Null: nobody asks, and the remarks are among the notes.
    QuantizationReport* quantized = nullptr;
    // Where not null, the files that were written are added to it, the mesh itself last.
    std::vector<std::filesystem::path>* written = nullptr;
};

// All files of the output (the mesh, .mtl, .bin, copied images) appear complete or not at all.
// What the format cannot hold is listed in the returned notes ("STL holds no UVs: 1 set dropped").
// Errors: io, unsupported (ending), invalid (bits), limit (the format's size limits).
Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options = {});

struct GlbBytes {
    std::vector<std::byte> bytes;
    std::vector<std::string> notes;  // as save_scene()'s
};

// The GLB file that save_scene() would write, in memory, where its parts and then the whole are
// held at once. Of the options, those that say how values are stored (compression, quantization,
// quantized); those of files are ignored. Errors: limit (over 4 GiB), invalid (bits), and what
// save_scene() says of scenes that cannot be written as GLB.
Result<GlbBytes> save_glb(const PreparedScene& prepared, const SaveOptions& options = {});

}  // namespace prep
