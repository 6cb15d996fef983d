#include "random_scenes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "prep/image.h"

namespace test {

std::uint64_t RandomNumbers::bits() {
    std::uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
}

namespace {

using prep::Material;
using prep::Mesh;
using prep::TextureRef;

// Baseline TIFF, one strip, 32-bit floats: the plainest file that keeps them.
class FloatTiff {
  public:
    FloatTiff(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
              std::span<const float> values) {
        const auto bytes = std::uint32_t(values.size() * 4);
        constexpr std::uint16_t entries = 11;
        constexpr std::uint32_t directory = 8, behind = directory + 2 + entries * 12 + 4;
        const std::uint32_t extra = behind + bytes;  // bits and format of each channel
        text("II");
        number(42, 2);
        number(directory, 4);
        number(entries, 2);
        entry(256, 4, 1, width);
        entry(257, 4, 1, height);
        entry(258, 3, channels, channels > 2 ? extra : pair(32, channels));
        entry(259, 3, 1, 1);
        entry(262, 3, 1, channels < 3 ? 1 : 2);
        entry(273, 4, 1, behind);
        entry(277, 3, 1, channels);
        entry(278, 4, 1, height);
        entry(279, 4, 1, bytes);
        entry(284, 3, 1, 1);
        entry(339, 3, channels, channels > 2 ? extra + 8 : pair(3, channels));
        number(0, 4);
        for (const float v : values) number(std::bit_cast<std::uint32_t>(v), 4);
        for (const std::uint32_t value : {32u, 3u})
            for (int c = 0; c < 4; ++c) number(value, 2);
    }
    std::vector<std::byte> take() { return std::move(out_); }

  private:
    static std::uint32_t pair(std::uint32_t value, std::uint32_t count) {
        return count == 2 ? value | value << 16 : value;
    }
    void text(const char* s) {
        for (; *s != 0; ++s) out_.push_back(std::byte(*s));
    }
    void number(std::uint32_t value, int size) {
        for (int k = 0; k < size; ++k) out_.push_back(std::byte(value >> (8 * k) & 0xffu));
    }
    void entry(std::uint32_t tag, std::uint32_t type, std::uint32_t count, std::uint32_t value) {
        number(tag, 2);
        number(type, 2);
        number(count, 4);
        number(value, 4);
    }
    std::vector<std::byte> out_;
};

class SceneOfChance {
  public:
    explicit SceneOfChance(std::uint32_t seed) : r_(seed) { scene_.name = std::to_string(seed); }

    prep::Scene make() {
        make_textures();
        for (std::uint32_t m = 1 + r_.below(3); m-- > 0;) scene_.materials.push_back(material());
        for (std::uint32_t m = 1 + r_.below(3); m-- > 0;) scene_.meshes.push_back(mesh());
        place_meshes();
        const bool before_wall = r_.chance(0.15);
        if (before_wall) add_wall();
        make_lights();
        if (before_wall || r_.chance(0.4)) make_camera();
        return std::move(scene_);
    }

  private:
    glm::vec3 color(double most) {
        return {r_.between(0, most), r_.between(0, most), r_.between(0, most)};
    }

    // Pictures ------------------------------------------------------------------------------

    void add_texture(prep::ImageRef image) {
        image.name = "picture" + std::to_string(scene_.images.size()) + image.name;
        prep::Texture t;
        t.image = std::uint32_t(scene_.images.size());
        scene_.images.push_back(std::move(image));
        const auto wrap = [&] { return prep::Wrap(r_.chance(0.5) ? 0 : r_.below(4)); };
        t.wrap_u = wrap();
        t.wrap_v = wrap();
        if (r_.chance(0.3)) t.mag = prep::Filter::nearest;
        if (r_.chance(0.3)) t.min = prep::Filter::nearest;
        t.mip = prep::MipFilter(r_.below(3));
        scene_.textures.push_back(t);
    }

    // Eight bits; `least` of alpha: below 255 there is a channel of it.
    prep::ImageRef codes(std::uint32_t least_alpha, bool constant) {
        prep::Image image;
        image.width = 1u << r_.below(5);
        image.height = r_.chance(0.7) ? image.width : 1 + r_.below(16);
        image.channels = least_alpha < 255 ? 4 : 3;
        std::vector<float> one;
        for (std::uint32_t i = 0; i < image.width * image.height; ++i) {
            if (i == 0 || !constant) {
                one.clear();
                for (int c = 0; c < 3; ++c) one.push_back(float(r_.below(256)) / 255.0f);
                if (image.channels == 4)
                    one.push_back(float(least_alpha + r_.below(256 - least_alpha)) / 255.0f);
            }
            image.pixels.insert(image.pixels.end(), one.begin(), one.end());
        }
        prep::ImageRef ref;
        ref.name = ".png";
        ref.bytes = *prep::encode_png(image);
        return ref;
    }

    void make_textures() {
        add_texture(codes(255, false));           // 0: a picture
        add_texture(codes(0, false));             // 1: with holes
        add_texture(codes(200, r_.chance(0.3)));  // 2: nearly opaque
        add_texture(codes(255, true));            // 3: of one colour
        const std::uint32_t side = 1 + r_.below(8);
        std::vector<float> flat, bright;
        for (std::uint32_t i = 0; i < side * side; ++i) {
            flat.insert(flat.end(), {0.5f, 0.5f, 1.0f});
            bright.insert(bright.end(), {r_.between(0, 3), r_.between(0, 3), r_.between(0, 3)});
        }
        add_texture(float_picture(side, side, 3, flat));    // 4: normals straight up
        add_texture(float_picture(side, side, 3, bright));  // 5: beyond white
        // 6: black, of 8 bits.
        prep::Image black;
        black.width = black.height = 4;
        black.channels = 3;
        black.pixels.assign(48, 0.0f);
        prep::ImageRef ref;
        ref.name = ".png";
        ref.bytes = *prep::encode_png(black);
        add_texture(ref);
        if (r_.chance(0.1)) {  // 7: no picture at all
            prep::ImageRef broken;
            broken.name = ".png";
            broken.bytes.assign(20, std::byte(7));
            add_texture(broken);
        }
    }

    TextureRef map(std::initializer_list<std::uint32_t> textures) {
        TextureRef ref;
        ref.texture = *(textures.begin() + r_.below(std::uint32_t(textures.size())));
        ref.uv_set = r_.chance(0.15) ? 1 : r_.chance(0.03) ? 5 : 0;
        if (r_.chance(0.3)) {
            ref.offset = {r_.between(-1, 1), r_.between(-1, 1)};
            ref.scale = {r_.between(-3, 3), r_.between(0.1, 3)};
            ref.rotation = r_.between(-3, 3);
        }
        if (r_.chance(0.3)) ref.strength = r_.between(0, 2);
        return ref;
    }
    TextureRef any_picture() {
        if (scene_.textures.size() > 7 && r_.chance(0.5)) return map({7});
        return map({0, 0, 1, 2, 3, 5});
    }

    // Materials -----------------------------------------------------------------------------

    Material material() {
        Material m;
        m.name = "material" + std::to_string(scene_.materials.size());
        m.diffuse = glm::vec4(color(1), 1);
        m.ambient = r_.chance(0.3) ? color(1) : glm::vec3(1);
        m.specular = r_.chance(0.4) ? glm::vec3(0) : color(1);
        m.shininess = r_.chance(0.1) ? 0.0f : float(std::exp2(r_.between(0, 9)));
        if (r_.chance(0.15)) m.emissive = color(2);
        m.unlit = r_.chance(0.12);
        m.double_sided = r_.chance(0.3);
        if (r_.chance(0.3)) {
            m.metallic_roughness = true;
            m.metallic = r_.chance(0.4) ? 0.0f : r_.between(0, 1);
            m.roughness = r_.between(0, 1);
            if (r_.chance(0.3)) m.reflectance = glm::vec3(0);
            if (r_.chance(0.3)) m.metallic_roughness_map = map({0, 3});
        }
        if (r_.chance(0.5)) m.diffuse_map = any_picture();
        if (r_.chance(0.25)) m.specular_map = map({0, 3, 5, 6});
        if (r_.chance(0.15)) m.emissive_map = any_picture();
        if (r_.chance(0.2)) m.occlusion_map = map({0, 3});
        if (r_.chance(0.5)) {
            m.normal_map = map({0, 3, 4, 4, 4});
            if (m.normal_map.texture == 4 && r_.chance(0.6)) m.normal_map.strength = 1;
            if (r_.chance(0.1)) m.normal_map.strength = 0;
            if (scene_.textures.size() > 7 && r_.chance(0.5)) m.normal_map.texture = 7;
            if (r_.chance(0.15)) m.normal_map_space = prep::NormalMapSpace::object;
            m.normal_map_flip_green = r_.chance(0.3);
        }
        if (r_.chance(0.1)) {
            m.bump_map = map({0});
            float& strength = m.bump_map.strength;  // heights of a unit would hide all else
            strength = strength != 1 ? 0.0f : 0.05f * m.diffuse.x - 0.01f;
        }
        if (r_.chance(0.1)) m.displacement_map = map({0});
        if (r_.chance(0.05)) m.layer_normal_map = map({0});
        if (r_.chance(0.05)) m.anisotropy_map = map({0});
        if (r_.chance(0.05)) m.anisotropy = 0.5f;
        if (r_.chance(0.1)) {
            m.alpha_mode = prep::AlphaMode::blend;
        } else if (r_.chance(0.4)) {
            m.alpha_mode = prep::AlphaMode::mask;
            m.alpha_cutoff = r_.between(0.1, 0.9);
            if (r_.chance(0.5)) m.diffuse_map = map({1, 2, 2});
            if (r_.chance(0.3)) {  // exactly at the cutoff: nothing is cut
                m.diffuse_map = {};
                m.diffuse.a = m.alpha_cutoff;
            } else if (r_.chance(0.2)) {
                m.diffuse.a = r_.between(0, 1);
            }
        }
        return m;
    }

    // Meshes --------------------------------------------------------------------------------

    // Rows of quads over (u, v) of the unit square.
    template <class Surface>
    void grid(Mesh& mesh, std::uint32_t columns, std::uint32_t rows, const Surface& at) {
        prep::CornerLayer<glm::vec2> uv;
        for (std::uint32_t j = 0; j <= rows; ++j)
            for (std::uint32_t i = 0; i <= columns; ++i) {
                const glm::vec2 p(float(i) / float(columns), float(j) / float(rows));
                mesh.positions.push_back(at(p));
                uv.values.push_back(p);
            }
        for (std::uint32_t j = 0; j < rows; ++j)
            for (std::uint32_t i = 0; i < columns; ++i) {
                const std::uint32_t a = j * (columns + 1) + i, b = a + columns + 1;
                mesh.corner_vertices.insert(mesh.corner_vertices.end(), {a, b, b + 1, a + 1});
                mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
            }
        uv.indices = mesh.corner_vertices;
        mesh.uvs.push_back(std::move(uv));
    }

    void ball(Mesh& mesh) {
        constexpr double pi = std::numbers::pi;
        const std::uint32_t down = 2 + r_.below(14), around = 3 + r_.below(20);
        grid(mesh, around, down, [&](glm::vec2 p) {
            const double a = 2 * pi * p.x, b = pi * p.y;
            return glm::vec3(std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a));
        });
    }
    void wall(Mesh& mesh, double bumps) {
        const float extent = r_.chance(0.3) ? 8.0f : 1.0f;
        const std::uint32_t rows = 1 + r_.below(9), columns = 1 + r_.below(9);
        grid(mesh, columns, rows, [&](glm::vec2 p) {
            return glm::vec3((p.x * 2 - 1) * extent, (1 - p.y * 2) * extent, r_.between(0, bumps));
        });
    }
    // Odd triangles: without area, with two equal corners, the same one twice.
    void soup(Mesh& mesh) {
        prep::CornerLayer<glm::vec2> uv;
        for (std::uint32_t v = 0; v < 12; ++v) {
            mesh.positions.push_back({r_.between(-1, 1), r_.between(-1, 1), r_.between(-1, 1)});
            uv.values.push_back({r_.between(-2, 2), r_.between(-2, 2)});
        }
        mesh.positions[11] = mesh.positions[10];
        for (std::uint32_t f = 3 + r_.below(12); f-- > 0;) {
            std::uint32_t a = r_.below(12), b = r_.below(12), c = r_.below(12);
            if (f % 4 == 0) b = a;
            mesh.corner_vertices.insert(mesh.corner_vertices.end(), {a, b, c});
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
        uv.indices = mesh.corner_vertices;
        mesh.uvs.push_back(std::move(uv));
    }

    Mesh mesh() {
        Mesh mesh;
        mesh.name = "mesh" + std::to_string(scene_.meshes.size());
        const std::uint32_t kind = r_.below(10);
        if (kind < 4) {
            ball(mesh);
        } else if (kind < 6) {
            wall(mesh, 0);
        } else if (kind < 8) {
            wall(mesh, 0.5);
        } else if (kind < 9 || r_.chance(0.5)) {
            soup(mesh);
        } else {
            mesh.positions = {{0, 0, 0}};
            mesh.points = {0};
            return mesh;
        }
        if (r_.chance(0.06))
            mesh.positions[r_.below(std::uint32_t(mesh.positions.size()))].x =
                std::numeric_limits<float>::quiet_NaN();
        const std::size_t corners = mesh.corner_count();
        if (r_.chance(0.15)) {
            mesh.uvs.clear();
        } else if (r_.chance(0.3)) {
            prep::CornerLayer<glm::vec2> second = mesh.uvs[0];
            for (glm::vec2& uv : second.values) uv = glm::vec2(uv.y, 1 - uv.x) * 2.0f;
            mesh.uvs.push_back(std::move(second));
        }
        if (r_.chance(0.3)) {
            prep::CornerLayer<glm::vec4> layer;
            for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
                const float alpha = r_.chance(0.5) ? 1.0f : r_.between(0.5, 1);
                layer.values.push_back(glm::vec4(color(1), alpha));
            }
            layer.indices = mesh.corner_vertices;
            mesh.colors.push_back(std::move(layer));
        }
        if (r_.chance(0.25)) {
            for (std::size_t c = 0; c < corners; ++c) {
                const float z = r_.between(0.2, 1), y = r_.between(-1, 1), x = r_.between(-1, 1);
                const glm::vec3 n(x, y, z);
                mesh.normals.values.push_back(r_.chance(0.02) ? glm::vec3(0) : glm::normalize(n));
                mesh.normals.indices.push_back(std::uint32_t(c));
            }
        }
        if (!r_.chance(0.1))
            for (std::size_t f = 0; f < mesh.face_count(); ++f)
                mesh.face_materials.push_back(r_.below(std::uint32_t(scene_.materials.size())));
        if (!mesh.face_materials.empty() && r_.chance(0.6))  // one for all
            std::fill(mesh.face_materials.begin(), mesh.face_materials.end(),
                      mesh.face_materials[0]);
        return mesh;
    }

    void place_meshes() {
        for (std::uint32_t m = 0; m < scene_.meshes.size(); ++m)
            for (std::uint32_t n = r_.chance(0.2) ? 2 : 1; n-- > 0;) {
                prep::Node node;
                node.mesh = m;
                prep::Trs trs;
                trs.translation = {r_.between(-1.5, 1.5), r_.between(-1, 1), r_.between(-1.5, 1)};
                const double angle = r_.between(-0.8, 0.8);
                trs.rotation = glm::dquat(std::cos(angle / 2), 0, std::sin(angle / 2), 0);
                if (r_.chance(0.3)) trs.rotation = glm::dquat(1, 0, 0, 0);
                trs.scale = glm::dvec3(r_.between(0.5, 1.5));
                if (r_.chance(0.15)) trs.scale.x *= -1;
                if (r_.chance(0.04)) trs.scale.y = 0;
                if (r_.chance(0.05)) trs.scale *= 1e-4;
                node.transform = trs.matrix();
                scene_.nodes.push_back(node);
            }
    }

    // Two triangles behind everything, each of which fills tiles of the picture.
    void add_wall() {
        Mesh wall;
        grid(wall, 1, 1, [](glm::vec2 p) { return glm::vec3(p.x * 16 - 8, 8 - p.y * 16, 0); });
        prep::Node node;
        node.mesh = std::uint32_t(scene_.meshes.size());
        node.transform[3] = glm::dvec4(0, 0, -2.5, 1);
        scene_.nodes.push_back(node);
        scene_.meshes.push_back(std::move(wall));
    }

    // Lights --------------------------------------------------------------------------------

    // A node at a place, looking along `towards`.
    void add_light(const prep::Light& light, const glm::dvec3& place, const glm::dvec3& towards) {
        prep::Node node;
        node.light = std::uint32_t(scene_.lights.size());
        const glm::dvec3 back = -glm::normalize(towards);
        const glm::dvec3 up = std::abs(back.y) > 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        const glm::dvec3 right = glm::normalize(glm::cross(up, back));
        node.transform = glm::dmat4(glm::dmat3(right, glm::cross(back, right), back));
        node.transform[3] = glm::dvec4(place, 1);
        scene_.lights.push_back(light);
        scene_.nodes.push_back(node);
    }

    void make_lights() {
        if (r_.chance(0.2)) return;  // the renderer's three
        using prep::LightKind;
        const bool only_ambient = r_.chance(0.12);
        for (std::uint32_t n = 1 + r_.below(4); n-- > 0;) {
            prep::Light light;
            light.kind = only_ambient ? LightKind::ambient : LightKind(r_.below(4));
            light.color = r_.chance(0.06) ? glm::vec3(0) : color(1);
            light.intensity = light.kind == LightKind::ambient       ? 0.2f
                              : light.kind == LightKind::directional ? 0.8f
                                                                     : r_.between(1, 20);
            const float z = r_.between(1, 5), y = r_.between(-1, 5), x = r_.between(-4, 4);
            glm::dvec3 place(x, y, z);
            glm::dvec3 towards = -place + glm::dvec3(0, 0, r_.between(-1, 1));
            if (light.kind == LightKind::point || light.kind == LightKind::spot) {
                if (r_.chance(0.3)) light.range = r_.between(3, 12);
                if (r_.chance(0.25)) {  // too far away for its range
                    place *= 20.0;
                    light.range = r_.between(1, 10);
                    light.intensity = 5000;
                }
            }
            if (light.kind == LightKind::spot) {
                light.outer_cone = r_.between(0.1, 1.2);
                light.inner_cone = light.outer_cone * r_.between(0, 0.99);
                if (r_.chance(0.4)) {  // away from all of it
                    towards = -towards;
                    place = glm::normalize(place) * 12.0;
                    light.outer_cone = r_.between(0.1, 0.6);
                    light.inner_cone = 0;
                }
            }
            if (light.kind == LightKind::directional && r_.chance(0.3))
                towards = {r_.between(-0.2, 0.2), r_.between(-0.2, 0.2), 1};  // from behind
            add_light(light, place, towards);
        }
    }

    void make_camera() {
        prep::Camera camera;
        camera.perspective = r_.chance(0.6);
        camera.yfov = r_.between(0.4, 1.5);
        camera.ymag = r_.between(0.5, 3);
        camera.xmag = camera.ymag * 1.3;
        // At times among the triangles, which then cross the near plane.
        const double distance = r_.chance(0.3) ? r_.between(0, 1.5) : r_.between(3, 8);
        prep::Node node;
        node.camera = std::uint32_t(scene_.cameras.size());
        const float y = r_.between(-0.5, 0.5), x = r_.between(-0.5, 0.5);
        node.transform[3] = glm::dvec4(x, y, distance, 1);
        camera.zfar = camera.perspective && r_.chance(0.5) ? 0 : 100;
        scene_.cameras.push_back(camera);
        scene_.active_camera = std::uint32_t(scene_.nodes.size());
        scene_.nodes.push_back(node);
    }

    RandomNumbers r_;
    prep::Scene scene_;
};

}  // namespace

prep::ImageRef float_picture(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                             std::span<const float> values) {
    prep::ImageRef ref;
    ref.name = "floats.tif";
    ref.bytes = FloatTiff(width, height, channels, values).take();
    return ref;
}

prep::Scene random_scene(std::uint32_t seed) {
    return SceneOfChance(seed).make();
}

}  // namespace test
