#include "gltf_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

#include "repeatable.h"

namespace samples {
namespace {

// Sixteen binary digits after the point: enough, and nothing hangs on the last bit.
float rounded(double x) {
    return float(std::floor(x * 65536 + 0.5) / 65536 + 0.0);
}

void append(std::string& bytes, std::uint32_t value, int size) {
    for (int k = 0; k < size; ++k) bytes.push_back(char(value >> (8 * k) & 0xFF));
}

void append(std::string& bytes, double value) {
    append(bytes, std::bit_cast<std::uint32_t>(rounded(value)), 4);
}

std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", x == 0 ? 0.0 : x);
    return text;
}

template <class Vector>
std::string numbers(const Vector& v) {
    std::string text = "[";
    for (int k = 0; k < int(Vector::length()); ++k) text += (k ? "," : "") + number(v[k]);
    return text + "]";
}

}  // namespace

glm::dvec4 turned(double yaw, double pitch) {
    const double sy = sine(yaw / 2), cy = cosine(yaw / 2);
    const double sp = sine(pitch / 2), cp = cosine(pitch / 2);
    return {cy * sp, sy * cp, -sy * sp, cy * cp};
}

int GltfBuilder::List::add(const std::string& item) {
    text += (count ? ",\n    {" : "{") + item + "}";
    return count++;
}

int GltfBuilder::image(const std::string& file_stem, std::string png) {
    const std::string file = file_stem + ".png";
    images_files_.push_back({name_.substr(0, name_.rfind('/') + 1) + file, std::move(png)});
    return images_.add("\"uri\":\"" + file + "\"");
}

int GltfBuilder::texture(int image, int sampler) {
    return textures_.add("\"source\":" + std::to_string(image) +
                         ",\"sampler\":" + std::to_string(sampler));
}

int GltfBuilder::sampler(const std::string& json) {
    return samplers_.add(json);
}
int GltfBuilder::material(const std::string& json) {
    return materials_.add(json);
}
int GltfBuilder::light(const std::string& json) {
    return lights_.add(json);
}
int GltfBuilder::camera(const std::string& json) {
    return cameras_.add(json);
}

int GltfBuilder::mesh(const std::string& name) {
    meshes_.push_back({name, {}});
    return int(meshes_.size()) - 1;
}

int GltfBuilder::view(std::string bytes, int target) {
    while (buffer_.size() % 4 != 0) buffer_.push_back('\0');
    const int index = views_.add("\"buffer\":0,\"byteOffset\":" + std::to_string(buffer_.size()) +
                                 ",\"byteLength\":" + std::to_string(bytes.size()) +
                                 ",\"target\":" + std::to_string(target));
    buffer_ += bytes;
    return index;
}

void GltfBuilder::primitive(const TriangleMesh& triangles, int material) {
    constexpr int vertices = 34962, elements = 34963;
    std::string positions, uvs, indices;
    glm::vec3 low(1e30f), high(-1e30f);
    for (const glm::dvec3& p : triangles.positions)
        for (int k = 0; k < 3; ++k) {
            append(positions, p[k]);
            low[k] = std::min(low[k], rounded(p[k]));
            high[k] = std::max(high[k], rounded(p[k]));
        }
    const std::string count = ",\"count\":" + std::to_string(triangles.positions.size());
    std::string attributes =
        "\"POSITION\":" +
        std::to_string(accessor("\"bufferView\":" + std::to_string(view(positions, vertices)) +
                                ",\"componentType\":5126,\"type\":\"VEC3\"" + count +
                                ",\"min\":" + numbers(low) + ",\"max\":" + numbers(high)));
    if (!triangles.uvs.empty()) {
        for (const glm::dvec2& uv : triangles.uvs)
            for (int k = 0; k < 2; ++k) append(uvs, uv[k]);
        attributes +=
            ",\"TEXCOORD_0\":" +
            std::to_string(accessor("\"bufferView\":" + std::to_string(view(uvs, vertices)) +
                                    ",\"componentType\":5126,\"type\":\"VEC2\"" + count));
    }
    for (const std::uint16_t index : triangles.indices) append(indices, index, 2);
    const int index_accessor =
        accessor("\"bufferView\":" + std::to_string(view(indices, elements)) +
                 ",\"componentType\":5123,\"type\":\"SCALAR\",\"count\":" +
                 std::to_string(triangles.indices.size()));
    meshes_.back().primitives.add("\"attributes\":{" + attributes +
                                  "},\"indices\":" + std::to_string(index_accessor) +
                                  ",\"material\":" + std::to_string(material));
}

void GltfBuilder::node(const std::string& name, const std::string& content,
                       const glm::dvec3& translation, const glm::dvec4& rotation) {
    std::string text = "\"name\":\"" + name + "\"," + content;
    if (translation != glm::dvec3(0)) text += ",\"translation\":" + numbers(translation);
    if (rotation != glm::dvec4(0, 0, 0, 1)) text += ",\"rotation\":" + numbers(rotation);
    nodes_.add(text);
}

std::vector<File> GltfBuilder::files() const {
    const std::string stem = name_.substr(name_.rfind('/') + 1);
    List meshes;
    for (const MeshText& mesh : meshes_)
        meshes.add("\"name\":\"" + mesh.name + "\",\"primitives\":[" + mesh.primitives.text + "]");
    std::string roots;
    for (int k = 0; k < nodes_.count; ++k) roots += (k ? "," : "") + std::to_string(k);

    std::string json =
        "{\n  \"asset\":{\"version\":\"2.0\",\"generator\":\"meshprep samples\"},\n"
        "  \"scene\":0,\n  \"scenes\":[{\"nodes\":[" +
        roots + "]}]";
    if (lights_.count)
        json +=
            ",\n  \"extensionsUsed\":[\"KHR_lights_punctual\"],\n"
            "  \"extensions\":{\"KHR_lights_punctual\":{\"lights\":[" +
            lights_.text + "]}}";
    const auto list = [&](const char* name, const List& items) {
        if (items.count) json += std::string(",\n  \"") + name + "\":[" + items.text + "]";
    };
    list("nodes", nodes_);
    list("cameras", cameras_);
    list("meshes", meshes);
    list("materials", materials_);
    list("textures", textures_);
    list("samplers", samplers_);
    list("images", images_);
    list("accessors", accessors_);
    list("bufferViews", views_);
    json += ",\n  \"buffers\":[{\"uri\":\"" + stem +
            ".bin\",\"byteLength\":" + std::to_string(buffer_.size()) + "}]\n}\n";

    std::vector<File> files{{name_ + ".gltf", json}, {name_ + ".bin", buffer_}};
    files.insert(files.end(), images_files_.begin(), images_files_.end());
    return files;
}

}  // namespace samples
