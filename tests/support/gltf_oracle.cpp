#include "gltf_oracle.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <iostream>

#include "mesh_files.h"
#include "shared_data.h"

namespace test {
namespace {

template <class T>
std::vector<double> stored(const std::string& data, std::size_t at, std::size_t count) {
    std::vector<T> values(count);
    if (count > 0) std::memcpy(values.data(), data.data() + at, count * sizeof(T));
    return {values.begin(), values.end()};
}

}  // namespace

std::vector<double> DecodedGltf::numbers(const nlohmann::json& array) const {
    if (array.is_null()) return {};
    const auto at = array.at("at").get<std::size_t>();
    const auto count = array.at("count").get<std::size_t>() * array.at("width").get<std::size_t>();
    const std::string store = array.at("store");
    if (at + count * (store == "f64" ? 8 : 4) > data.size()) {
        ADD_FAILURE() << "the decoded file's data end before " << array.dump();
        return {};
    }
    return store == "f32"   ? stored<float>(data, at, count)
           : store == "f64" ? stored<double>(data, at, count)
                            : stored<std::uint32_t>(data, at, count);
}

std::optional<std::vector<DecodedGltf>> decode_gltf(const std::filesystem::path& node_modules,
                                                    const std::vector<std::filesystem::path>& files,
                                                    const std::filesystem::path& folder) {
    nlohmann::json list = nlohmann::json::array();
    for (std::size_t i = 0; i < files.size(); ++i)
        list.push_back({{"input", files[i].string()},
                        {"output", (folder / ("decoded" + std::to_string(i) + ".json")).string()}});
    write_text(folder / "decode.json", list.dump());
    const std::string command = "node '" + (source_dir() / "tests/tools/decode_gltf.mjs").string() +
                                "' '" + node_modules.string() + "' '" +
                                (folder / "decode.json").string() + "' >'" +
                                (folder / "decode.log").string() + "' 2>&1";
    if (std::system(command.c_str()) != 0) {
        ADD_FAILURE() << "decode_gltf.mjs: " << file_text(folder / "decode.log");
        return std::nullopt;
    }
    std::vector<DecodedGltf> out(files.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
        const std::string output = list[i].at("output");
        out[i].json = nlohmann::json::parse(file_text(output));
        if (!out[i].json.contains("error")) out[i].data = file_text(output + ".bin");
    }
    return out;
}

bool validates(const std::filesystem::path& validator, const nlohmann::json& list,
               const std::filesystem::path& list_file) {
    write_text(list_file, list.dump());
    const std::string command = "node '" +
                                (source_dir() / "tests/tools/validate_gltf.mjs").string() + "' '" +
                                validator.string() + "' '" + list_file.string() + "' 2>&1";
    std::cout.flush();
    return std::system(command.c_str()) == 0;
}

std::uint32_t fnv1a(std::span<const std::byte> bytes) {
    std::uint32_t hash = 0x811c9dc5;
    for (const std::byte b : bytes) hash = (hash ^ std::uint32_t(b)) * 0x01000193;
    return hash;
}

}  // namespace test
