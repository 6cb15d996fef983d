// What came by EXT_meshopt_compression and changes is compressed as it came, when a document is
// rewritten.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "formats/gltf/appended_data.h"
#include "formats/gltf/document.h"

namespace prep::detail {

class KeptMeshopt {
  public:
    // `json`: what `document` becomes, `appended` with it.
    KeptMeshopt(const GltfDocument& document, Json& json, AppendedData& appended)
        : document_(document), json_(json), appended_(appended) {}

    // Whether an attribute or the indices of a primitive of the document came so.
    bool has_part_of(const Json& primitive) const;

    // Stores a new view by the filter of the one that the document's accessor lies in, where that
    // has one: the view holds the accessor's `elements`, each `stride` bytes. They are taken from
    // the filter's input, so that nothing is rounded twice.
    void keep_filter(std::size_t accessor, const std::vector<std::uint32_t>& elements,
                     std::size_t stride, std::size_t view);

    // Compresses the new accessors from `first` on, where they are not yet. `turns`: triangles may
    // begin with another of their corners.
    void compress_from(std::size_t first, bool turns);

  private:
    const Json* compressed_view(std::size_t accessor) const;

    const GltfDocument& document_;
    Json& json_;
    AppendedData& appended_;
    std::map<std::size_t, std::vector<std::byte>> filtered_;  // by bufferView of the document
};

}  // namespace prep::detail
