#include "meshprep/budgets/stored_bytes.h"

#include <array>
#include <fstream>
#include <set>
#include <string>

#include "meshprep/output/report_json.h"

namespace meshprep {
namespace {

// The document, which is the first chunk, without what follows it.
Json document_of_glb(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 20> head{};
    if (!file.read(head.data(), std::streamsize(head.size()))) return {};
    std::uint32_t length = 0;
    for (std::size_t k = 0; k < 4; ++k)
        length |= std::uint32_t(static_cast<unsigned char>(head[12 + k])) << (8 * k);
    std::error_code failed;
    if (length > std::filesystem::file_size(path, failed) || failed) return {};
    std::string text(length, ' ');
    if (!file.read(text.data(), std::streamsize(text.size()))) return {};
    return Json::parse(text, nullptr, false);
}

std::uint64_t element_bytes(const Json& accessor) {
    const int type = accessor.value("componentType", 5126);
    const std::uint64_t one = type <= 5121 ? 1 : type <= 5123 ? 2 : 4;
    const std::string shape = accessor.value("type", "");
    return one * (shape == "VEC2" ? 2 : shape == "VEC3" ? 3 : shape == "VEC4" ? 4 : 1);
}

std::uint64_t bytes_in(const Json& document, const char* attribute) {
    std::set<std::size_t> accessors;
    if (!document.contains("meshes")) return 0;
    for (const Json& mesh : document.at("meshes"))
        for (const Json& primitive : mesh.at("primitives"))
            if (const Json& has = primitive.at("attributes"); has.contains(attribute))
                accessors.insert(has.at(attribute).get<std::size_t>());
    std::uint64_t bytes = 0;
    for (const std::size_t a : accessors) {
        const Json& accessor = document.at("accessors").at(a);
        if (!accessor.contains("bufferView")) continue;
        const Json& view =
            document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
        bytes += accessor.at("count").get<std::uint64_t>() *
                 view.value("byteStride", element_bytes(accessor));
    }
    return bytes;
}

}  // namespace

prep::Result<std::uint64_t> stored_bytes(const std::filesystem::path& glb, const char* attribute) {
    const Json document = document_of_glb(glb);
    // Members are asked for by at(): what is not there or of another type is no document.
    try {
        if (document.is_object()) return bytes_in(document, attribute);
    } catch (const Json::exception&) {
    }
    return prep::Error{prep::ErrorCode::syntax, "is no GLB file", glb.string()};
}

}  // namespace meshprep
