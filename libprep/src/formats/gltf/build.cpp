#include "formats/gltf/build.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "base/finite.h"
#include "base/read_open_file.h"
#include "formats/gltf/material_extensions.h"
#include "formats/gltf/nodes/build_morphs_skins.h"
#include "formats/gltf/nodes/build_nodes.h"
#include "formats/gltf/nodes/far_plane.h"
#include "formats/gltf/references.h"
#include "formats/gltf/values/uv_set_bits.h"
#include "prep/files.h"
#include "prep/image.h"
#include "text/name_list.h"
#include "text/utf8.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class Builder {
  public:
    Builder(const PreparedScene& prepared, Json& document, GltfBuffer& buffer,
            std::vector<std::string>& notes)
        : prepared_(prepared),
          scene_(prepared.scene),
          document_(document),
          buffer_(buffer),
          notes_(notes) {}

    void run() {
        choose_materials();
        meshes();
        materials();
        lights();
        cameras();
        build_nodes(prepared_, {mesh_index_, light_index_}, document_, buffer_, notes_);
        if (!unread_.empty())
            notes_.push_back("textures that cannot be read: " + unread_.text() +
                             ": their materials go without");
        for (const auto& [count, what] :
             {std::pair(dropped_[2], "triangle"), std::pair(dropped_[1], "line segment"),
              std::pair(dropped_[0], "point")})
            if (count > 0) notes_.push_back(non_finite_note(count, what));
        for (const std::string& name : extensions_) document_["extensionsUsed"].push_back(name);
    }

  private:
    void note_once(const std::string& text) {
        if (std::find(notes_.begin(), notes_.end(), text) == notes_.end()) notes_.push_back(text);
    }

    // What the maps that glTF has a place for read.
    static std::uint64_t uv_sets_read(const Material& m) {
        std::uint64_t sets = 0;
        const auto read = [&](const TextureRef& ref) {
            if (ref) sets |= uv_set_bit(ref.uv_set);
        };
        for (const TextureRef* ref :
             {&m.diffuse_map, &m.occlusion_map, &m.emissive_map, &m.displacement_map})
            read(*ref);
        if (m.normal_map_space == NormalMapSpace::tangent) read(m.normal_map);
        if (!m.unlit) read(m.specular_map);
        if (m.metallic_roughness) read(m.metallic_roughness_map);
        return sets;
    }

    // A map may only read UV sets that the primitive has. Where one lacks some, it gets a variant
    // of its material without those maps; the first variant stands at the material's own place
    // where no primitive needs the whole.
    void choose_materials() {
        const std::uint64_t whole = std::numeric_limits<std::uint64_t>::max();
        std::vector<std::set<std::uint64_t>> sets(scene_.materials.size());
        for (const VertexMesh& mesh : prepared_.meshes)
            for (const VertexMesh::Range& range : mesh.ranges) {
                if (range.material >= scene_.materials.size()) continue;
                const std::uint64_t there = uv_set_bits(mesh);
                const bool enough = (uv_sets_read(scene_.materials[range.material]) & ~there) == 0;
                sets[range.material].insert(enough ? whole : there);
            }
        std::uint64_t count = 0;
        for (Index m = 0; m < sets.size(); ++m) variants_.push_back({m, whole});
        for (Index m = 0; m < sets.size(); ++m) {
            bool own_place = !sets[m].contains(whole);
            for (const std::uint64_t n : sets[m]) {
                if (n == whole) continue;
                ++count;
                if (own_place)
                    variants_[m].uv_sets = n;
                else
                    variants_.push_back({m, n});
                variant_index_[{m, n}] = own_place ? m : Index(variants_.size() - 1);
                own_place = false;
            }
        }
        if (count > 0)
            notes_.push_back("maps were left out where faces have no UVs for them (" +
                             std::to_string(count) + (count == 1 ? " material)" : " materials)"));
    }

    Index material_for(const VertexMesh& mesh, Index material) const {
        const auto variant = variant_index_.find({material, uv_set_bits(mesh)});
        return variant == variant_index_.end() ? material : variant->second;
    }

    void meshes() {
        mesh_index_.assign(scene_.meshes.size(), no_index);
        for (Index m = 0; m < scene_.meshes.size(); ++m) {
            Json primitives = Json::array();
            const VertexMesh& mesh = prepared_.meshes[m];
            all_finite_ = all_finite(floats_of(mesh.positions));
            mended_uvs_.clear();
            // Sets are numbered without gaps: zeros before one that is there.
            for (const auto& uvs : mesh.uvs)
                mended_uvs_.push_back(uvs.empty()     ? std::vector<glm::vec2>(mesh.vertex_count())
                                      : are_good(uvs) ? std::vector<glm::vec2>()
                                                      : mended(uvs));
            mended_colors_.clear();
            for (const auto& colors : mesh.colors)
                mended_colors_.push_back(are_good(colors) ? std::vector<glm::vec4>()
                                                          : mended(colors));
            for (const VertexMesh::Range& range : mesh.ranges) {
                const std::span<const Index> whole(
                    mesh.indices.data() + 3 * std::size_t(range.first_triangle),
                    3 * std::size_t(range.triangle_count));
                add_finite_primitive(m, whole, 3, 4, range.material, primitives);
            }
            add_finite_primitive(m, mesh.lines, 2, 1, no_index, primitives);
            add_finite_primitive(m, mesh.points, 1, 0, no_index, primitives);
            if (primitives.empty()) {
                note_once("mesh '" + scene_.meshes[m].name + "' has nothing to draw: left out");
                continue;
            }
            Json out{{"primitives", std::move(primitives)}};
            if (!scene_.meshes[m].name.empty()) out["name"] = as_utf8(scene_.meshes[m].name);
            add_target_members(scene_.meshes[m], out);
            mesh_index_[m] = Index(buffer_.push("meshes", std::move(out)));
        }
    }

    // Without those of `group` vertices each of which one is not finite.
    void add_finite_primitive(Index m, std::span<const Index> indices, std::size_t group, int mode,
                              Index material, Json& primitives) {
        if (all_finite_) {
            add_primitive(m, indices, mode, material, primitives);
            return;
        }
        const VertexMesh& mesh = prepared_.meshes[m];
        std::vector<Index> kept;
        kept.reserve(indices.size());
        for (std::size_t i = 0; i < indices.size(); i += group) {
            const std::span<const Index> one = indices.subspan(i, group);
            if (std::all_of(one.begin(), one.end(),
                            [&](Index v) { return is_finite(mesh.positions[v]); }))
                kept.insert(kept.end(), one.begin(), one.end());
            else
                ++dropped_[group - 1];
        }
        add_primitive(m, kept, mode, material, primitives);
    }

    void add_primitive(Index m, std::span<const Index> indices, int mode, Index material,
                       Json& primitives) {
        if (indices.empty()) return;
        const VertexMesh& mesh = prepared_.meshes[m];
        // The vertices that this primitive uses, in their order. Where it uses all, the mesh's own
        // lists are what is written.
        std::vector<Index> used, local;
        const bool all = all_finite_ && mesh.ranges.size() == 1 && mesh.lines.empty() &&
                         mesh.points.empty() && indices.size() == mesh.indices.size();
        if (!all) {
            local.assign(indices.begin(), indices.end());
            used = number_anew(local);
            indices = local;
        }
        const std::size_t count = all ? mesh.vertex_count() : used.size();
        const auto add = [&](const auto& values, int width, bool lent = true) {
            using T = std::decay_t<decltype(values[0])>;
            if (all && lent) return buffer_.lend_floats(&values[0].x, count, width);
            if (all) return buffer_.add_floats(&values[0].x, count, width);
            std::vector<T> gathered(count);
            for (std::size_t i = 0; i < count; ++i) gathered[i] = values[used[i]];
            return buffer_.add_floats(&gathered[0].x, count, width);
        };
        Json attributes;
        const std::size_t position = add(mesh.positions, 3);
        set_bounds(mesh, used, all, position);
        attributes["POSITION"] = position;
        const bool faces = mode == 4;
        if (faces && !mesh.normals.empty()) attributes["NORMAL"] = add(mesh.normals, 3);
        if (faces && !mesh.tangents.empty() && !mesh.normals.empty())
            attributes["TANGENT"] = add(mesh.tangents, 4);
        const auto add_mended = [&](const auto& values, const auto& mended, int width) {
            return mended.empty() ? add(values, width) : add(mended, width, false);
        };
        if (faces)
            for (std::size_t s = 0; s < mesh.uvs.size(); ++s)
                attributes["TEXCOORD_" + std::to_string(s)] =
                    add_mended(mesh.uvs[s], mended_uvs_[s], 2);
        for (std::size_t s = 0; s < mesh.colors.size(); ++s)
            attributes["COLOR_" + std::to_string(s)] =
                add_mended(mesh.colors[s], mended_colors_[s], 4);
        const PrimitiveVertices vertices{prepared_, m, all ? std::span<const Index>() : used,
                                         count};
        add_influences(vertices, buffer_, attributes);
        Json primitive{{"attributes", std::move(attributes)}};
        add_targets(vertices, primitive["attributes"], document_, buffer_, primitive);
        primitive["indices"] =
            buffer_.add_indices(indices, count, indices.data() == mesh.indices.data());
        if (material < scene_.materials.size())
            primitive["material"] = material_for(mesh, material);
        if (mode != 4) primitive["mode"] = mode;
        primitives.push_back(std::move(primitive));
    }

    void set_bounds(const VertexMesh& mesh, const std::vector<Index>& used, bool all,
                    std::size_t accessor) {
        const std::size_t count = all ? mesh.vertex_count() : used.size();
        glm::vec3 low = mesh.positions[all ? 0 : used[0]], high = low;
        for (std::size_t i = 0; i < count; ++i) {
            const glm::vec3& p = mesh.positions[all ? i : used[i]];
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        document_["accessors"][accessor]["min"] = array3(low);
        document_["accessors"][accessor]["max"] = array3(high);
    }

    static bool are_good(const std::vector<glm::vec2>& uvs) {
        return std::all_of(uvs.begin(), uvs.end(),
                           [](const glm::vec2& uv) { return is_finite(uv); });
    }
    static bool are_good(const std::vector<glm::vec4>& colors) {
        return std::all_of(colors.begin(), colors.end(), [](const glm::vec4& c) {
            return c.r >= 0 && c.r <= 1 && c.g >= 0 && c.g <= 1 && c.b >= 0 && c.b <= 1 &&
                   c.a >= 0 && c.a <= 1;
        });
    }

    std::vector<glm::vec2> mended(const std::vector<glm::vec2>& uvs) {
        std::vector<glm::vec2> out = uvs;
        for (glm::vec2& uv : out)
            if (!is_finite(uv)) {
                uv = glm::vec2(0.0f);
                note_once("UVs that are not finite were written as 0");
            }
        return out;
    }

    std::vector<glm::vec4> mended(const std::vector<glm::vec4>& colors) {
        std::vector<glm::vec4> out = colors;
        for (glm::vec4& c : out)
            for (int k = 0; k < 4; ++k)
                if (!(c[k] >= 0 && c[k] <= 1)) {
                    c[k] = c[k] > 1 ? 1.0f : 0.0f;
                    note_once("vertex colours outside 0 … 1 were clamped");
                }
        return out;
    }

    // A picture as it is, or with its green turned over: normal maps whose green points down.
    // Heights are kept, with 16 bits where they need them.
    enum class Green : std::uint8_t { kept, turned, heights };

    Json texture_info(const TextureRef& ref, Green green) {
        Json info;
        const Index texture = texture_index(ref.texture, green);
        if (texture == no_index) return info;
        info["index"] = texture;
        if (ref.uv_set) info["texCoord"] = ref.uv_set;
        if (ref.offset != glm::vec2(0.0f) || ref.scale != glm::vec2(1.0f) || ref.rotation != 0) {
            extensions_.insert("KHR_texture_transform");
            Json transform;
            transform["offset"] = {ref.offset.x, ref.offset.y};
            transform["rotation"] = ref.rotation;
            transform["scale"] = {ref.scale.x, ref.scale.y};
            info["extensions"]["KHR_texture_transform"] = std::move(transform);
        }
        return info;
    }

    Index texture_index(Index texture, Green green) {
        if (texture >= scene_.textures.size()) return no_index;
        const auto known = texture_map_.find({texture, green});
        if (known != texture_map_.end()) return known->second;
        const Texture& t = scene_.textures[texture];
        Index result = no_index;
        const Index image = image_index(t.image, green);
        if (image != no_index) {
            const auto wrap = [](Wrap w) {
                return w == Wrap::repeat ? 10497 : w == Wrap::mirror ? 33648 : 33071;
            };
            Json sampler{{"magFilter", t.mag == Filter::nearest ? 9728 : 9729}};
            const bool nearest = t.min == Filter::nearest;
            sampler["minFilter"] = t.mip == MipFilter::none      ? (nearest ? 9728 : 9729)
                                   : t.mip == MipFilter::nearest ? (nearest ? 9984 : 9985)
                                                                 : (nearest ? 9986 : 9987);
            sampler["wrapS"] = wrap(t.wrap_u);
            sampler["wrapT"] = wrap(t.wrap_v);
            const std::size_t s = buffer_.push("samplers", std::move(sampler));
            result = Index(buffer_.push("textures", Json{{"sampler", s}, {"source", image}}));
        }
        texture_map_.emplace(std::pair(texture, green), result);
        return result;
    }

    Index image_index(Index image, Green green) {
        if (image >= scene_.images.size()) return no_index;
        const auto known = image_map_.find({image, green});
        if (known != image_map_.end()) return known->second;
        const ImageRef& ref = scene_.images[image];
        std::vector<std::byte> bytes = ref.bytes;
        if (bytes.empty() && ref.channels.empty()) {
            auto file = read_regular_file(ref.path);
            if (file) bytes = *std::move(file);
        }
        std::string mime = mime_of(bytes);
        if (mime.empty() || green == Green::turned) {  // glTF holds PNG and JPEG only
            mime.clear();
            auto decoded = load_image(ref);
            if (decoded) {
                const bool turned = green == Green::turned;
                if (turned) turn_green(*decoded);
                // A normal map of more bits keeps them, and heights keep what PNG can hold.
                const bool exact = turned || green == Green::heights;
                if (green == Green::heights) {
                    note_cut_heights(*decoded, ref.name);
                    if (decoded->floating)
                        note_once("texture '" + ref.name + "': heights were rounded to 16 bits");
                }
                // Floats get 16 bits whatever they are: the nearest code of 8 to a mid-level is
                // far.
                const bool wide = exact && (decoded->floating || !is_eight_bit(*decoded));
                auto png = encode_png(*decoded, wide ? PixelType::u16 : PixelType::u8);
                if (png) {
                    bytes = *std::move(png);
                    mime = "image/png";
                    note_once("texture '" + ref.name + "' was " +
                              (ref.channels.empty() ? "converted to PNG" : "put together as PNG") +
                              (turned ? ", its green turned over" : ""));
                }
            } else if (decoded.error().code != ErrorCode::io) {
                note_once("texture '" + ref.name + "': " + decoded.error().text);
            }
        }
        Index result = no_index;
        if (mime.empty()) {
            unread_.add(ref.name.empty() ? std::to_string(image) : ref.name);
        } else {
            const std::size_t view = buffer_.add_view(bytes, 0);
            Json out{{"bufferView", view}, {"mimeType", mime}};
            if (!ref.name.empty()) out["name"] = as_utf8(ref.name);
            result = Index(buffer_.push("images", std::move(out)));
        }
        image_map_.emplace(std::pair(image, green), result);
        return result;
    }

    void note_cut_heights(const Image& image, const std::string& name) {
        const bool beyond = std::any_of(image.pixels.begin(), image.pixels.end(),
                                        [](float value) { return !(value >= 0 && value <= 1); });
        if (beyond)
            note_once("texture '" + name + "' has heights beyond 0 to 1, where PNG ends: cut off");
    }

    static bool is_eight_bit(const Image& image) {
        return std::all_of(image.pixels.begin(), image.pixels.end(), [](float value) {
            return std::abs(value * 255 - std::round(value * 255)) <
                   1e-3f;  // of a 16-bit step's 1/257
        });
    }

    static void turn_green(Image& image) {
        for (std::size_t i = 1; image.channels >= 3 && i < image.pixels.size(); i += image.channels)
            image.pixels[i] = 1 - image.pixels[i];
    }

    static std::string mime_of(const std::vector<std::byte>& bytes) {
        const auto starts = [&](std::initializer_list<unsigned char> magic) {
            return bytes.size() >= magic.size() &&
                   std::equal(magic.begin(), magic.end(), bytes.begin(),
                              [](unsigned char a, std::byte b) { return std::byte(a) == b; });
        };
        if (starts({0x89, 'P', 'N', 'G'})) return "image/png";
        if (starts({0xff, 0xd8, 0xff})) return "image/jpeg";
        return {};
    }

    void materials() {
        for (const Variant& variant : variants_) {
            Material m = scene_.materials[variant.material];
            for (TextureRef* ref :
                 {&m.diffuse_map, &m.specular_map, &m.emissive_map, &m.occlusion_map, &m.normal_map,
                  &m.metallic_roughness_map, &m.displacement_map})
                if ((variant.uv_sets & uv_set_bit(ref->uv_set)) == 0) *ref = {};
            const auto unit = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
            Json out, pbr;
            if (!m.name.empty()) out["name"] = as_utf8(m.name);
            pbr["baseColorFactor"] = {unit(m.diffuse.r), unit(m.diffuse.g), unit(m.diffuse.b),
                                      unit(m.diffuse.a)};
            pbr["metallicFactor"] = m.metallic_roughness ? unit(m.metallic) : 0.0f;
            const GltfHighlight highlight = gltf_highlight(m);
            limited_ += highlight.limited && !m.unlit;
            pbr["roughnessFactor"] = highlight.roughness;
            set_texture(pbr, "baseColorTexture", m.diffuse_map);
            if (m.metallic_roughness)
                set_texture(pbr, "metallicRoughnessTexture", m.metallic_roughness_map);
            out["pbrMetallicRoughness"] = std::move(pbr);
            if (m.normal_map && m.normal_map_space == NormalMapSpace::tangent) {
                set_texture(out, "normalTexture", m.normal_map,
                            m.normal_map_flip_green ? Green::turned : Green::kept);
                if (out.contains("normalTexture") && m.normal_map.strength != 1)
                    out["normalTexture"]["scale"] = m.normal_map.strength;
            } else if (m.normal_map) {
                note_once("glTF has no object-space normal maps: left out");
            }
            if (m.bump_map) note_once("glTF has no bump maps: left out");
            if (m.displacement_map) displacement(m, out);
            set_texture(out, "occlusionTexture", m.occlusion_map);
            if (out.contains("occlusionTexture") && m.occlusion_map.strength != 1)
                out["occlusionTexture"]["strength"] =
                    std::clamp(m.occlusion_map.strength, 0.0f, 1.0f);
            set_texture(out, "emissiveTexture", m.emissive_map);
            if (m.emissive != glm::vec3(0.0f)) emissive(m.emissive, out);
            if (m.alpha_mode != AlphaMode::opaque) {
                out["alphaMode"] = m.alpha_mode == AlphaMode::mask ? "MASK" : "BLEND";
                if (m.alpha_mode == AlphaMode::mask) out["alphaCutoff"] = m.alpha_cutoff;
            }
            if (m.double_sided) out["doubleSided"] = true;
            if (m.unlit) {
                extensions_.insert("KHR_materials_unlit");
                out["extensions"]["KHR_materials_unlit"] = Json::object();
            }
            if (!m.unlit) reflectance(m, highlight.reflectance, out);
            if (!m.unlit) write_layers(m, out, extensions_);
            if (!m.metallic_roughness) blinn_phong(m, out);
            buffer_.push("materials", std::move(out));
        }
        if (limited_ > 0)
            notes_.push_back(
                std::to_string(limited_) +
                (limited_ == 1 ? " highlight reflects" : " highlights reflect") +
                " more than the diffuse colour leaves over: limited for other programs, exact in "
                "extras");
    }

    void set_texture(Json& owner, const char* slot, const TextureRef& ref,
                     Green green = Green::kept) {
        if (!ref) return;
        Json info = texture_info(ref, green);
        if (!info.is_null()) owner[slot] = std::move(info);
    }

    void emissive(const glm::vec3& color, Json& out) {
        const float largest = std::max({color.r, color.g, color.b});
        const float scale = largest > 1 ? largest : 1;
        out["emissiveFactor"] = array3(glm::max(color / scale, glm::vec3(0.0f)));
        if (scale > 1) {
            extensions_.insert("KHR_materials_emissive_strength");
            out["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = scale;
        }
    }

    // A dielectric reflects 4 % of light that falls in straight: the factor scales that.
    void reflectance(const Material& m, const glm::vec3& reflected, Json& out) {
        const bool usual = reflected == glm::vec3(0.04f) && m.metallic_roughness;
        if (usual && !m.specular_map) return;
        Json specular = Json::object();
        if (!usual) specular["specularColorFactor"] = array3(reflected / 0.04f);
        set_texture(specular, "specularColorTexture", m.specular_map);
        if (specular.empty()) return;
        extensions_.insert("KHR_materials_specular");
        out["extensions"]["KHR_materials_specular"] = std::move(specular);
    }

    // glTF has no place for displacement (KhronosGroup/glTF#948): our own reader finds it in
    // extras.
    void displacement(const Material& m, Json& out) {
        Json kept = Json::object();
        set_texture(kept, "texture", m.displacement_map, Green::heights);
        if (kept.empty()) return;
        kept["scale"] = m.displacement_scale * m.displacement_map.strength;
        kept["midlevel"] = m.displacement_midlevel;
        kept["kind"] = name_of(m.displacement_kind);
        out["extras"]["displacement"] = std::move(kept);
        note_once("glTF has no displacement maps: kept in the materials' extras");
    }

    // What our own reader takes back exactly.
    void blinn_phong(const Material& m, Json& out) {
        Json& exact = out["extras"]["blinnPhong"];
        exact["ambient"] = array3(m.ambient);
        exact["diffuse"] = {m.diffuse.r, m.diffuse.g, m.diffuse.b, m.diffuse.a};
        exact["specular"] = array3(m.specular);
        exact["shininess"] = m.shininess;
    }

    void lights() {
        light_index_.assign(scene_.lights.size(), no_index);
        Json list = Json::array();
        std::uint64_t ambient = 0;
        for (Index l = 0; l < scene_.lights.size(); ++l) {
            const Light& light = scene_.lights[l];
            if (light.kind == LightKind::ambient) {
                ++ambient;
                continue;
            }
            // Colours end at 1, intensities nowhere.
            const float brightest = std::max({light.color.r, light.color.g, light.color.b, 1.0f});
            Json out{{"type", light.kind == LightKind::directional ? "directional"
                              : light.kind == LightKind::point     ? "point"
                                                                   : "spot"},
                     {"color", array3(glm::clamp(light.color / brightest, 0.0f, 1.0f))},
                     {"intensity", std::max(light.intensity, 0.0f) * brightest}};
            if (!light.name.empty()) out["name"] = as_utf8(light.name);
            if (light.range > 0 && light.kind != LightKind::directional) out["range"] = light.range;
            // The nearest float to a quarter turn, the widest there is, lies above it.
            const float widest = std::nextafter(float(std::numbers::pi / 2), 0.0f);
            if (light.kind == LightKind::spot)
                out["spot"] = {{"innerConeAngle", light.inner_cone},
                               {"outerConeAngle", std::min(light.outer_cone, widest)}};
            light_index_[l] = Index(list.size());
            list.push_back(std::move(out));
        }
        if (ambient > 0)
            notes_.push_back(std::to_string(ambient) +
                             (ambient == 1 ? " ambient light" : " ambient lights") +
                             " left out: glTF has none");
        if (list.empty()) return;
        extensions_.insert("KHR_lights_punctual");
        document_["extensions"]["KHR_lights_punctual"]["lights"] = std::move(list);
    }

    void cameras() {
        const FarPlanes far_planes(prepared_);
        for (std::size_t c = 0; c < scene_.cameras.size(); ++c) {
            const Camera& camera = scene_.cameras[c];
            Json out;
            if (!camera.name.empty()) out["name"] = as_utf8(camera.name);
            out["type"] = camera.perspective ? "perspective" : "orthographic";
            Json& lens = out[camera.perspective ? "perspective" : "orthographic"];
            if (camera.perspective) {
                lens["yfov"] = camera.yfov;
                if (camera.aspect > 0) lens["aspectRatio"] = camera.aspect;
                lens["znear"] = camera.znear;
                if (camera.zfar > camera.znear) lens["zfar"] = camera.zfar;
            } else {
                // glTF has no camera without a width: a square picture's.
                lens["xmag"] = camera.xmag != 0 ? camera.xmag : camera.ymag;
                lens["ymag"] = camera.ymag;
                lens["znear"] = camera.znear;
                lens["zfar"] = far_planes.of(c);
            }
            buffer_.push("cameras", std::move(out));
        }
    }

    const PreparedScene& prepared_;
    const Scene& scene_;
    Json& document_;
    GltfBuffer& buffer_;
    std::vector<std::string>& notes_;
    std::array<std::uint64_t, 3> dropped_{};  // points, line segments, triangles
    bool all_finite_ = false;                 // the positions of the mesh at hand
    // Of the mesh at hand, in place of those that files must not hold; empty: there are none.
    std::vector<std::vector<glm::vec2>> mended_uvs_;
    std::vector<std::vector<glm::vec4>> mended_colors_;
    std::size_t limited_ = 0;  // highlights
    NameList unread_;          // textures
    std::vector<Index> mesh_index_, light_index_;
    struct Variant {
        Index material;
        std::uint64_t uv_sets;  // bits; maps that read others are left out
    };
    std::vector<Variant> variants_;  // by index in the output
    std::map<std::pair<Index, std::uint64_t>, Index> variant_index_;
    std::map<std::pair<Index, Green>, Index> texture_map_, image_map_;
    std::set<std::string> extensions_;
};

}  // namespace

void build_gltf(const PreparedScene& prepared, Json& document, GltfBuffer& buffer,
                std::vector<std::string>& notes) {
    Builder(prepared, document, buffer, notes).run();
}

}  // namespace prep::detail
