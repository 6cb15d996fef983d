// What we read in glTF files against what @gltf-transform reads in them, value by value: the shared
// corpus, and files that use the format's corners (tests/support/gltf_cases.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "formats/gltf/document.h"
#include "gltf_cases.h"
#include "gltf_oracle.h"
#include "mesh_files.h"
#include "npm_tools.h"
#include "pipeline/morph_targets.h"
#include "sanitized.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using prep::no_index;
using Indices = std::vector<std::uint32_t>;
using Numbers = std::vector<double>;

std::uint32_t index_of(const json& value) {
    return value.is_null() ? no_index : value.get<std::uint32_t>();
}

// The corners that a mode makes of indices, by the formulas of glTF 2.0, 3.7.2.1.
Indices triangle_corners(int mode, const Indices& v) {
    Indices out;
    const std::size_t n = v.size();
    if (mode == 4)
        for (std::size_t i = 0; 3 * i + 2 < n; ++i)
            out.insert(out.end(), {v[3 * i], v[3 * i + 1], v[3 * i + 2]});
    if (mode == 5)
        for (std::size_t i = 0; i + 2 < n; ++i)
            out.insert(out.end(), {v[i], v[i + (1 + i % 2)], v[i + (2 - i % 2)]});
    if (mode == 6)
        for (std::size_t i = 0; i + 2 < n; ++i) out.insert(out.end(), {v[i + 1], v[i + 2], v[0]});
    return out;
}

std::vector<Indices> polylines(int mode, const Indices& v) {
    std::vector<Indices> out;
    if (mode == 1)
        for (std::size_t i = 0; 2 * i + 1 < v.size(); ++i) out.push_back({v[2 * i], v[2 * i + 1]});
    if ((mode == 2 || mode == 3) && v.size() > 1) {
        out.push_back(v);
        if (mode == 2) out.back().push_back(v[0]);
    }
    return out;
}

class Comparison {
  public:
    Comparison(const prep::Scene& ours, const test::DecodedGltf& theirs)
        : ours_(ours), theirs_(theirs) {}

    // Returns how many values were compared.
    std::size_t run() {
        meshes();
        nodes();
        skins();
        animations();
        lights();
        cameras();
        images();
        materials();
        return compared_;
    }

  private:
    void same(double found, double expected, double tolerance, const std::string& what) {
        ++compared_;
        // Ours are floats; −0 is 0.
        if (std::abs(found - expected) <= tolerance || float(expected) == float(found)) return;
        if (std::isnan(found) && std::isnan(expected)) return;
        if (++differences_ <= 5)
            ADD_FAILURE() << what << ": found " << found << ", expected " << expected;
    }
    void same(double found, const json& expected, const std::string& what, double absent = 0) {
        same(found, expected.is_null() ? absent : expected.get<double>(), 0, what);
    }
    template <class Vector>
    void vector(const Vector& found, const json& expected, const std::string& what) {
        for (int k = 0; k < int(found.length()); ++k)
            same(double(found[k]), expected.at(std::size_t(k)), what);
    }
    template <class Vector>
    void element(const Vector& found, const Numbers& list, std::size_t width, std::size_t i,
                 double tolerance, const std::string& what) {
        for (int k = 0; k < int(found.length()); ++k) {
            const double expected =
                std::size_t(k) < width ? list.at(i * width + std::size_t(k)) : 1;  // opaque
            same(double(found[k]), expected, tolerance, what);
        }
    }
    // The results of meshopt's filters are whole numbers; the two programs' libraries are of
    // different versions, which round halves differently.
    double step(const json& array) const {
        if (array.at("normalized") == false || ours_.name != "meshopt.glb") return 0;
        return 1.01 / (array.at("componentType") == 5120 ? 127 : 32767);
    }
    bool sizes(std::size_t found, const json& list, const std::string& what) {
        EXPECT_EQ(found, list.size()) << what;
        return found == list.size();
    }

    // --- meshes ------------------------------------------------------------------------------

    void meshes() {
        const json& list = theirs_.json.at("meshes");
        if (!sizes(ours_.meshes.size(), list, "meshes")) return;
        for (std::size_t m = 0; m < list.size(); ++m) {
            const std::string at = "mesh " + std::to_string(m);
            const json& primitives = list[m].at("primitives");
            const prep::Mesh& mesh = ours_.meshes[m];
            EXPECT_EQ(mesh.name, list[m].at("name")) << at;
            if (!sizes(document().primitives[m].size(), primitives, at)) continue;
            Elements next;
            for (std::size_t p = 0; p < primitives.size(); ++p) {
                const std::string place = at + ", primitive " + std::to_string(p);
                elements(primitives[p], mesh, std::uint32_t(p), next, place);
                attributes(primitives[p], m, p, place);
                targets(primitives[p], m, p, place);
            }
            EXPECT_EQ(next.face, mesh.face_count()) << at;
            EXPECT_EQ(next.line + 1, mesh.line_offsets.size()) << at;
            EXPECT_EQ(next.point, mesh.points.size()) << at;
        }
    }

    struct Elements {
        std::size_t face = 0, line = 0, point = 0;  // what the primitives before had
    };

    void elements(const json& primitive, const prep::Mesh& mesh, std::uint32_t part, Elements& next,
                  const std::string& at) {
        const int mode = primitive.at("mode");
        const json& attributes = primitive.at("attributes");
        const Numbers positions = theirs_.numbers(attributes.at("POSITION"));
        Indices indices;
        for (const double v : theirs_.numbers(primitive.at("indices")))
            indices.push_back(std::uint32_t(v));
        if (primitive.at("indices").is_null())
            for (std::uint32_t v = 0; v < positions.size() / 3; ++v) indices.push_back(v);
        const std::string what = at + ", position";
        const auto position = [&](std::uint32_t vertex, std::uint32_t expected) {
            element(mesh.positions.at(vertex), positions, 3, expected, 0, what);
        };

        const Indices expected = triangle_corners(mode, indices);
        if (3 * next.face + expected.size() > mesh.corner_count()) {
            ADD_FAILURE() << at << ": too few faces";
            return;
        }
        for (std::size_t c = 0; c < expected.size(); ++c)
            position(mesh.corner_vertices[3 * next.face + c], expected[c]);
        for (std::size_t f = next.face; f < next.face + expected.size() / 3; ++f) {
            EXPECT_EQ(mesh.face_offsets[f], 3 * f);
            EXPECT_EQ(mesh.face_materials.at(f), index_of(primitive.at("material"))) << at;
            EXPECT_EQ(mesh.face_parts.at(f), part) << at;
        }
        layer(mesh.normals, attributes, "NORMAL", expected, next.face, at);
        layer(mesh.tangents, attributes, "TANGENT", expected, next.face, at);
        for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
            layer(mesh.uvs[s], attributes, "TEXCOORD_" + std::to_string(s), expected, next.face,
                  at);
        for (std::size_t s = 0; s < mesh.colors.size(); ++s)
            layer(mesh.colors[s], attributes, "COLOR_" + std::to_string(s), expected, next.face,
                  at);
        next.face += expected.size() / 3;

        for (const Indices& line : polylines(mode, indices)) {
            if (next.line + 1 >= mesh.line_offsets.size()) {
                ADD_FAILURE() << at << ": too few lines";
                return;
            }
            const std::size_t first = mesh.line_offsets[next.line++];
            EXPECT_EQ(mesh.line_offsets[next.line] - first, line.size()) << at;
            for (std::size_t i = 0; i < line.size(); ++i)
                position(mesh.line_vertices.at(first + i), line[i]);
        }
        if (mode == 0)
            for (const std::uint32_t v : indices) position(mesh.points.at(next.point++), v);
    }

    template <class T>
    void layer(const prep::CornerLayer<T>& found, const json& attributes,
               const std::string& semantic, const Indices& expected, std::size_t first_face,
               const std::string& at) {
        const bool there = attributes.contains(semantic);
        Numbers list = there ? theirs_.numbers(attributes.at(semantic)) : Numbers();
        if (semantic == "COLOR_0")  // drawn, they are within this (glTF 2.0, 3.7.2.1)
            for (double& value : list) value = std::clamp(value, 0.0, 1.0);
        const double tolerance = there ? step(attributes.at(semantic)) : 0;
        const std::size_t width =
            there ? attributes.at(semantic).at("width").template get<std::size_t>() : 0;
        const std::string what = at + ", " + semantic;
        EXPECT_TRUE(!there || expected.empty() || !found.empty()) << what;
        if (found.empty()) return;
        for (std::size_t c = 0; c < expected.size(); ++c) {
            const std::uint32_t i = found.indices[3 * first_face + c];
            ASSERT_EQ(i != no_index, there) << what;
            if (there) element(found.values[i], list, width, expected[c], tolerance, what);
        }
    }

    // Also those that a Mesh has no layer for: joints, weights, an application's own.
    void attributes(const json& primitive, std::size_t m, std::size_t p, const std::string& at) {
        const prep::detail::Json& own = document().json["meshes"][m]["primitives"][p]["attributes"];
        const auto& draco = document().primitives[m][p].draco;
        EXPECT_EQ(own.size(), primitive.at("attributes").size()) << at;
        for (const auto& [semantic, theirs] : primitive.at("attributes").items()) {
            const auto held = draco.find(semantic);
            if (held != draco.end())
                list(prep::detail::to_floats(held->second), theirs, at + ", " + semantic);
            else
                accessor(own[semantic].get<std::size_t>(), theirs, at + ", " + semantic);
        }
    }

    void list(const std::vector<float>& found, const json& array, const std::string& what) {
        const Numbers expected = theirs_.numbers(array);
        ASSERT_EQ(found.size(), expected.size()) << what;
        for (std::size_t i = 0; i < found.size(); ++i)
            same(double(found[i]), expected[i], step(array), what);
    }

    void accessor(std::size_t index, const json& theirs, const std::string& what) {
        const auto raw = document().raw_accessor(index);
        ASSERT_TRUE(raw) << what;
        list(prep::detail::to_floats(*raw), theirs, what);
    }

    void targets(const json& primitive, std::size_t m, std::size_t p, const std::string& at) {
        const json& list = primitive.at("targets");
        const auto& where = document().primitives[m][p];
        for (std::size_t t = 0; t < list.size(); ++t) {
            if (!list[t].contains("POSITION")) continue;
            const prep::Mesh& mesh = ours_.meshes[m];
            const auto shape = prep::detail::morph_shape(mesh, mesh.morph_targets.at(t));
            const std::string what = at + ", target " + std::to_string(t);
            const Numbers deltas = theirs_.numbers(list[t].at("POSITION")),
                          base = theirs_.numbers(primitive.at("attributes").at("POSITION"));
            for (std::uint32_t v = 0; v < where.vertex_count; ++v)
                for (int k = 0; k < 3; ++k) {
                    const std::size_t i = 3 * where.element_of(v) + std::size_t(k);
                    same(double(shape.positions[where.first_vertex + v][k]),
                         double(float(base[i]) + float(deltas[i])), 0, what);
                }
        }
    }

    // --- the scene ---------------------------------------------------------------------------

    // Nodes that the active scene shows.
    std::vector<bool> shown() const {
        const json &nodes = theirs_.json.at("nodes"), &scenes = theirs_.json.at("scenes");
        if (scenes.empty()) return std::vector<bool>(nodes.size(), true);
        const json& chosen = theirs_.json.at("scene");
        std::vector<bool> out(nodes.size(), false);
        std::vector<std::size_t> open =
            scenes[chosen.is_null() ? 0 : chosen.get<std::size_t>()].at("nodes");
        while (!open.empty()) {
            const std::size_t n = open.back();
            open.pop_back();
            out[n] = true;
            for (const std::size_t child : nodes[n].at("children")) open.push_back(child);
        }
        return out;
    }

    void nodes() {
        const json& list = theirs_.json.at("nodes");
        if (!sizes(ours_.nodes.size(), list, "nodes")) return;
        const std::vector<bool> visible = shown();
        for (std::size_t n = 0; n < list.size(); ++n) {
            const std::string at = "node " + std::to_string(n);
            const prep::Node& node = ours_.nodes[n];
            const auto reference = [&](const char* key) {
                return visible[n] ? index_of(list[n].at(key)) : no_index;
            };
            EXPECT_EQ(node.mesh, reference("mesh")) << at;
            EXPECT_EQ(node.camera, reference("camera")) << at;
            EXPECT_EQ(node.light, reference("light")) << at;
            EXPECT_EQ(node.skin, index_of(list[n].at("skin"))) << at;
            for (const std::size_t child : list[n].at("children"))
                EXPECT_EQ(ours_.nodes[child].parent, n) << at;
            // Files' quaternions are unit to float precision; we make them so.
            double largest = 0;
            for (const json& x : list[n].at("matrix"))
                largest = std::max(largest, std::abs(x.get<double>()));
            for (std::size_t k = 0; k < 16; ++k)
                same(node.transform[int(k / 4)][int(k % 4)], list[n].at("matrix")[k].get<double>(),
                     2e-6 * largest, at);
        }
    }

    void skins() {
        const json& list = theirs_.json.at("skins");
        if (!sizes(ours_.skins.size(), list, "skins")) return;
        for (std::size_t s = 0; s < list.size(); ++s) {
            const prep::Skin& skin = ours_.skins[s];
            EXPECT_EQ(json(skin.joints), list[s].at("joints"));
            const Numbers matrices = theirs_.numbers(list[s].at("inverseBindMatrices"));
            for (std::size_t j = 0; j < skin.joints.size() && !matrices.empty(); ++j)
                for (std::size_t k = 0; k < 16; ++k)
                    same(double(skin.inverse_bind.at(j)[int(k / 4)][int(k % 4)]),
                         matrices.at(16 * j + k), 0, "inverse bind matrix");
        }
    }

    // What they refer to must have its values, and so must the scene's own lists.
    void animations() {
        const json& list = theirs_.json.at("animations");
        for (std::size_t a = 0; a < list.size(); ++a)
            for (std::size_t s = 0; s < list[a].at("samplers").size(); ++s) {
                const auto& own = document().json["animations"][a]["samplers"][s];
                for (const char* key : {"input", "output"})
                    accessor(own[key].get<std::size_t>(), list[a].at("samplers")[s].at(key),
                             std::string("animation's ") + key);
                const prep::AnimationSampler& sampler = ours_.animations.at(a).samplers.at(s);
                ASSERT_TRUE(sampler.times && sampler.values);
                this->list(*sampler.times, list[a].at("samplers")[s].at("input"), "key times");
                this->list(*sampler.values, list[a].at("samplers")[s].at("output"), "key values");
            }
    }

    void lights() {
        const json& list = theirs_.json.at("lights");
        if (!sizes(ours_.lights.size(), list, "lights")) return;
        for (std::size_t l = 0; l < list.size(); ++l) {
            const prep::Light& light = ours_.lights[l];
            const std::string type = list[l].at("type");
            EXPECT_EQ(light.kind, type == "spot"    ? prep::LightKind::spot
                                  : type == "point" ? prep::LightKind::point
                                                    : prep::LightKind::directional);
            vector(light.color, list[l].at("color"), "light's colour");
            same(double(light.intensity), list[l].at("intensity"), "intensity");
            same(double(light.range), list[l].at("range"), "range");
            same(double(light.inner_cone), list[l].at("innerConeAngle"), "inner cone");
            same(double(light.outer_cone), list[l].at("outerConeAngle"), "outer cone");
        }
    }

    void cameras() {
        const json& list = theirs_.json.at("cameras");
        if (!sizes(ours_.cameras.size(), list, "cameras")) return;
        for (std::size_t c = 0; c < list.size(); ++c) {
            const prep::Camera& camera = ours_.cameras[c];
            EXPECT_EQ(camera.perspective, list[c].at("type") == "perspective");
            if (camera.perspective) {
                same(camera.yfov, list[c].at("yfov"), "yfov");
                same(camera.aspect, list[c].at("aspectRatio"), "aspect");
            } else {
                same(camera.xmag, list[c].at("xmag"), "xmag");
                same(camera.ymag, list[c].at("ymag"), "ymag");
            }
            same(camera.znear, list[c].at("znear"), "znear");
            same(camera.zfar, list[c].at("zfar"), "zfar");
        }
    }

    // --- materials ---------------------------------------------------------------------------

    void images() {
        const json& list = theirs_.json.at("images");
        if (!sizes(ours_.images.size(), list, "images")) return;
        for (std::size_t i = 0; i < list.size(); ++i) {
            same(double(ours_.images[i].bytes.size()), list[i].at("bytes"), "image's size");
            same(double(test::fnv1a(ours_.images[i].bytes)), list[i].at("hash"), "image's bytes");
        }
    }

    void map(const prep::TextureRef& found, const json& expected, const std::string& what) {
        ASSERT_EQ(bool(found), !expected.is_null()) << what;
        if (!found) return;
        const prep::Texture& texture = ours_.textures.at(found.texture);
        EXPECT_EQ(texture.image, index_of(expected.at("image"))) << what;
        const auto wrap = [](prep::Wrap w) {
            return w == prep::Wrap::repeat ? 10497 : w == prep::Wrap::clamp ? 33071 : 33648;
        };
        EXPECT_EQ(wrap(texture.wrap_u), expected.at("wrapS")) << what;
        EXPECT_EQ(wrap(texture.wrap_v), expected.at("wrapT")) << what;
        const int linear = texture.min == prep::Filter::linear;
        const int min = texture.mip == prep::MipFilter::none
                            ? 9728 + linear
                            : 9984 + linear + (texture.mip == prep::MipFilter::linear ? 2 : 0);
        same(min, expected.at("minFilter"), what + ", minification", 9987);
        same(texture.mag == prep::Filter::linear ? 9729 : 9728, expected.at("magFilter"),
             what + ", magnification", 9729);
        same(found.uv_set, expected.at("texCoord"), what + ", UV set");
        vector(found.offset, expected.at("offset"), what + ", offset");
        vector(found.scale, expected.at("scale"), what + ", scale");
        same(double(found.rotation), expected.at("rotation"), what + ", rotation");
    }

    void materials() {
        const json& list = theirs_.json.at("materials");
        if (!sizes(ours_.materials.size(), list, "materials")) return;
        for (std::size_t m = 0; m < list.size(); ++m) {
            const prep::Material& found = ours_.materials[m];
            const json &in = list[m], &extensions = in.at("extensions");
            const std::string at = "material " + std::to_string(m);
            EXPECT_EQ(found.name, in.at("name"));
            const std::string alpha = in.at("alphaMode");
            EXPECT_EQ(found.alpha_mode, alpha == "MASK"    ? prep::AlphaMode::mask
                                        : alpha == "BLEND" ? prep::AlphaMode::blend
                                                           : prep::AlphaMode::opaque)
                << at;
            same(double(found.alpha_cutoff), in.at("alphaCutoff"), at + ", alphaCutoff");
            EXPECT_EQ(found.double_sided, in.at("doubleSided").get<bool>()) << at;
            EXPECT_EQ(found.unlit, extensions.contains("KHR_materials_unlit")) << at;
            const double strength = extensions.contains("KHR_materials_emissive_strength")
                                        ? extensions["KHR_materials_emissive_strength"]
                                              .at("emissiveStrength")
                                              .get<double>()
                                        : 1.0;
            for (int k = 0; k < 3; ++k)
                same(double(found.emissive[k]),
                     double(in.at("emissiveFactor")[std::size_t(k)].get<float>() * float(strength)),
                     0, at + ", emissive");
            map(found.emissive_map, in.at("emissiveTexture"), at + ", emissive");
            map(found.normal_map, in.at("normalTexture"), at + ", normal");
            map(found.occlusion_map, in.at("occlusionTexture"), at + ", occlusion");
            map(found.metallic_roughness_map, in.at("metallicRoughnessTexture"),
                at + ", metallic-roughness");
            if (found.normal_map)
                same(double(found.normal_map.strength), in.at("normalScale"), at + ", scale");
            if (found.occlusion_map)
                same(double(found.occlusion_map.strength), in.at("occlusionStrength"),
                     at + ", strength");
            const auto other = extensions.find("KHR_materials_pbrSpecularGlossiness");
            EXPECT_TRUE(found.metallic_roughness) << at;
            if (other != extensions.end()) {
                vector(found.reflectance, other->at("specularFactor"), at + ", specular");
                const auto f0 = other->at("specularFactor").get<std::vector<double>>();
                const double left = found.specular_map || found.unlit
                                        ? 1
                                        : 1 - *std::max_element(f0.begin(), f0.end());
                auto scattered = other->at("diffuseFactor");
                for (std::size_t k = 0; k < 3; ++k)
                    scattered[k] = scattered[k].get<double>() * left;
                vector(found.diffuse, scattered, at + ", diffuse");
                map(found.diffuse_map, other->at("diffuseTexture"), at + ", diffuse");
                map(found.specular_map, other->at("specularGlossinessTexture"), at + ", specular");
                continue;
            }
            vector(found.diffuse, in.at("baseColorFactor"), at + ", base colour");
            map(found.diffuse_map, in.at("baseColorTexture"), at + ", base colour");
            same(double(found.metallic), in.at("metallicFactor"), at + ", metallic");
            same(double(found.roughness), in.at("roughnessFactor"), at + ", roughness");
        }
    }

    const prep::GltfDocument& document() const { return *prep::detail::gltf_document(ours_); }

    const prep::Scene& ours_;
    const test::DecodedGltf& theirs_;
    std::size_t compared_ = 0, differences_ = 0;
};

// Returns how many files the other program could read.
std::size_t compare(const fs::path& node_modules, const std::vector<fs::path>& files,
                    const fs::path& scratch) {
    const auto decoded = test::decode_gltf(node_modules, files, scratch);
    if (!decoded) return 0;
    std::size_t read = 0, values = 0;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if ((*decoded)[i].json.contains("error")) {
            std::cout << files[i].filename().string() << ": not read by the other program: "
                      << (*decoded)[i].json["error"].get<std::string>() << "\n";
            continue;
        }
        SCOPED_TRACE(files[i].string());
        const auto scene = prep::load_gltf(files[i]);
        ++read;
        if (!scene) {
            // Only what a file requires and we do not offer.
            EXPECT_EQ(scene.error().code, prep::ErrorCode::unsupported) << test::error_of(scene);
            EXPECT_NE(test::error_of(scene).find("KHR_texture_basisu"), std::string::npos);
            continue;
        }
        values += Comparison(*scene, (*decoded)[i]).run();
    }
    std::cout << files.size() << " files, " << values << " values compared\n";
    return read;
}

TEST(GltfValues, FilesOfTheFormatsCornersAreReadAsAnotherProgramReadsThem) {
    MESHPREP_REQUIRE_GLTF_TRANSFORM(node_modules);
    const test::TempDir dir;
    std::vector<fs::path> files;
    for (const test::GltfCase& made : test::gltf_cases()) {
        files.push_back(dir / (made.name + ".glb"));
        test::write_text(files.back(), made.maker.glb());
    }
    EXPECT_EQ(compare(node_modules, files, dir.path()), files.size());
}

TEST(GltfValues, TheCorpusIsReadAsAnotherProgramReadsIt) {
    MESHPREP_REQUIRE_SHARED(shared);
    MESHPREP_REQUIRE_GLTF_TRANSFORM(node_modules);
    std::vector<fs::path> files;
    for (const char* folder : {"corpus", "real_files"}) {
        if (!fs::is_directory(shared / folder)) continue;
        for (auto it = fs::recursive_directory_iterator(shared / folder); it != fs::end(it); ++it) {
            const fs::path ending = it->path().extension();
            if (it->is_directory() && it->path().filename() == "gltf-validator")
                it.disable_recursion_pending();
            else if (ending == ".glb" || ending == ".gltf")
                files.push_back(it->path());
        }
    }
    std::sort(files.begin(), files.end());
    EXPECT_GE(files.size(), 14u);
    if (test::sanitized)
        std::erase_if(files, [](const fs::path& file) { return fs::file_size(file) > 3'000'000; });
    const test::TempDir dir;
    // One has indices at an odd byte, which the other program refuses.
    EXPECT_GE(compare(node_modules, files, dir.path()) + 1, files.size());
}

}  // namespace
