#include "judge/material_looks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "prep/image.h"

namespace judge {
namespace {

using prep::Material;
using prep::no_index;

template <int N>
std::string numbers(const glm::vec<N, float>& v) {
    std::string text;
    for (int k = 0; k < N; ++k) text += (k > 0 ? " " : "") + fmt::format("{:.3g}", v[k]);
    return text;
}

class MaterialComparer {
  public:
    std::vector<std::string> out;

    static bool same(double a, double b) {
        return a == b || (std::isnan(a) && std::isnan(b)) ||
               std::abs(a - b) <= same_number * std::max(1.0, std::abs(a));
    }
    void number(const char* name, double a, double b) {
        if (!same(a, b)) out.push_back(fmt::format("{} {:.3g} → {:.3g}", name, a, b));
    }
    template <int N>
    void vector(const char* name, const glm::vec<N, float>& a, const glm::vec<N, float>& b) {
        for (int k = 0; k < N; ++k) {
            if (same(double(a[k]), double(b[k]))) continue;
            out.push_back(fmt::format("{} {} → {}", name, numbers(a), numbers(b)));
            return;
        }
    }
    void truth(const char* name, bool a, bool b) {
        if (a != b)
            out.push_back(fmt::format("{} {} → {}", name, a ? "on" : "off", b ? "on" : "off"));
    }
    template <class E>
    void named(const char* name, E a, E b) {
        if (a != b)
            out.push_back(fmt::format("{} {} → {}", name, prep::name_of(a), prep::name_of(b)));
    }
};

const Material& material_at(const prep::Scene& scene, std::uint32_t index) {
    static const Material plain;
    return index < scene.materials.size() ? scene.materials[index] : plain;
}

std::vector<std::byte> encoded_bytes(const prep::ImageRef& image) {
    if (!image.bytes.empty() || image.path.empty()) return image.bytes;
    std::ifstream file(image.path, std::ios::binary);
    std::vector<std::byte> bytes;
    char block[65536];
    while (file.read(block, sizeof block) || file.gcount() > 0) {
        const auto* from = reinterpret_cast<const std::byte*>(block);
        bytes.insert(bytes.end(), from, from + file.gcount());
    }
    return bytes;
}

// Red, green, blue or alpha: grey is three equal ones, and without an alpha all is opaque.
float channel_of(const prep::Image& image, std::uint32_t x, std::uint32_t y, std::uint32_t k) {
    const float* pixel = image.at(x, y);
    const bool grey = image.channels < 3, alpha = image.channels == 2 || image.channels == 4;
    if (k == 3) return alpha ? pixel[image.channels - 1] : 1.0f;
    return pixel[grey ? 0 : k];
}

bool same_pixels(const prep::Image& a, const prep::Image& b) {
    if (a.width != b.width || a.height != b.height) return false;
    const auto same = [](float x, float y) {
        return x == y || std::abs(x - y) <= float(same_value) || (std::isnan(x) && std::isnan(y));
    };
    for (std::uint32_t y = 0; y < a.height; ++y)
        for (std::uint32_t x = 0; x < a.width; ++x)
            for (std::uint32_t k = 0; k < 4; ++k)
                if (!same(channel_of(a, x, y, k), channel_of(b, x, y, k))) return false;
    return true;
}

}  // namespace

bool MaterialLooks::same_picture(std::uint32_t of_a, std::uint32_t of_b) {
    const bool has_a = of_a < a_.images.size(), has_b = of_b < b_.images.size();
    if (!has_a || !has_b) return has_a == has_b;
    const auto [place, fresh] = pictures_.try_emplace({of_a, of_b}, false);
    if (!fresh) return place->second;
    const prep::ImageRef &a = a_.images[of_a], &b = b_.images[of_b];
    if (a.channels.empty() && b.channels.empty()) {
        const std::vector<std::byte> bytes = encoded_bytes(a);
        if (!bytes.empty() && bytes == encoded_bytes(b)) return place->second = true;
    }
    const prep::Result<prep::Image> left = prep::load_image(a), right = prep::load_image(b);
    for (const auto* picture : {&left, &right})
        if (!*picture) warnings_.push_back(prep::to_string(picture->error()));
    // Missing in both: all that is known of it is what it is called.
    if (!left && !right) return place->second = a.path.filename() == b.path.filename();
    return place->second = left && right && same_pixels(*left, *right);
}

const std::vector<std::string>& MaterialLooks::differences(std::uint32_t of_a, std::uint32_t of_b) {
    const auto [place, fresh] = known_.try_emplace({of_a, of_b});
    if (!fresh) return place->second;
    const Material &a = material_at(a_, of_a), &b = material_at(b_, of_b);
    MaterialComparer compare;
    const bool rough = a.metallic_roughness && b.metallic_roughness;
    compare.truth("metallic-roughness", a.metallic_roughness, b.metallic_roughness);
    compare.vector("base colour", a.diffuse, b.diffuse);
    compare.vector("emitted light", a.emissive, b.emissive);
    compare.truth("unlit", a.unlit, b.unlit);
    if (rough) {
        compare.number("metallic", a.metallic, b.metallic);
        compare.number("roughness", a.roughness, b.roughness);
        compare.vector("reflectance", a.reflectance, b.reflectance);
    } else {
        compare.vector("ambient", a.ambient, b.ambient);
        compare.vector("specular", a.specular, b.specular);
        compare.number("shininess", a.shininess, b.shininess);
    }
    compare.number("clearcoat", a.clearcoat, b.clearcoat);
    compare.number("clearcoat roughness", a.clearcoat_roughness, b.clearcoat_roughness);
    compare.vector("sheen", a.sheen, b.sheen);
    if (a.sheen != glm::vec3(0.0f) && b.sheen != glm::vec3(0.0f))
        compare.number("sheen roughness", a.sheen_roughness, b.sheen_roughness);
    compare.number("anisotropy", a.anisotropy, b.anisotropy);
    if (a.anisotropy != 0 && b.anisotropy != 0)
        compare.number("anisotropy's rotation", a.anisotropy_rotation, b.anisotropy_rotation);
    compare.named("alpha", a.alpha_mode, b.alpha_mode);
    if (a.alpha_mode == prep::AlphaMode::mask && b.alpha_mode == a.alpha_mode)
        compare.number("alpha cutoff", a.alpha_cutoff, b.alpha_cutoff);
    compare.truth("double-sided", a.double_sided, b.double_sided);
    if (a.normal_map && b.normal_map) {
        compare.truth("normal map's green down", a.normal_map_flip_green, b.normal_map_flip_green);
        compare.named("normal map's space", a.normal_map_space, b.normal_map_space);
    }
    if (a.displacement_map && b.displacement_map) {
        compare.number("displacement's scale", a.displacement_scale, b.displacement_scale);
        compare.number("displacement's midlevel", a.displacement_midlevel, b.displacement_midlevel);
        compare.named("displacement's kind", a.displacement_kind, b.displacement_kind);
    }
    const auto more_a = prep::undrawn_numbers(a_, of_a), more_b = prep::undrawn_numbers(b_, of_b);
    for (std::size_t k = 0; k < more_a.size(); ++k)
        compare.number(std::string(more_a[k].first).c_str(), more_a[k].second, more_b[k].second);
    for (const prep::MaterialMap& map : prep::material_maps) {
        const prep::TextureRef &ra = a.*map.ref, &rb = b.*map.ref;
        const std::string name = std::string(map.name) + " map";
        if (bool(ra) != bool(rb)) {
            compare.out.push_back(name + (ra ? " lost" : " added"));
            continue;
        }
        if (!ra) continue;
        static const prep::Texture plain;
        const prep::Texture& ta = ra.texture < a_.textures.size() ? a_.textures[ra.texture] : plain;
        const prep::Texture& tb = rb.texture < b_.textures.size() ? b_.textures[rb.texture] : plain;
        if (!same_picture(ta.image, tb.image)) compare.out.push_back(name + ": another picture");
        compare.named((name + "'s wrap").c_str(), ta.wrap_u, tb.wrap_u);
        compare.named((name + "'s wrap").c_str(), ta.wrap_v, tb.wrap_v);
        compare.named((name + "'s filter of near texels").c_str(), ta.mag, tb.mag);
        compare.named((name + "'s filter of far texels").c_str(), ta.min, tb.min);
        compare.named((name + "'s filter of mip levels").c_str(), ta.mip, tb.mip);
        if (ra.uv_set != rb.uv_set)
            compare.out.push_back(fmt::format("{}: UV set {} → {}", name, ra.uv_set, rb.uv_set));
        compare.vector((name + "'s offset").c_str(), ra.offset, rb.offset);
        compare.vector((name + "'s scale").c_str(), ra.scale, rb.scale);
        compare.number((name + "'s rotation").c_str(), ra.rotation, rb.rotation);
        compare.number((name + "'s strength").c_str(), ra.strength, rb.strength);
    }
    return place->second = std::move(compare.out);
}

std::uint32_t MaterialLooks::twin_in_a(std::uint32_t of_b) {
    for (std::uint32_t m = 0; m < a_.materials.size(); ++m)
        if (differences(m, of_b).empty()) return m;
    return no_index;
}

}  // namespace judge
