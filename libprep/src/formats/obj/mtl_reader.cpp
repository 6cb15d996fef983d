#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <unordered_map>

#include "formats/obj/obj.h"
#include "formats/picture_search.h"
#include "image/packed_refs.h"
#include "text/line_ends.h"
#include "text/lower_case.h"
#include "text/name_list.h"
#include "text/scan.h"

namespace prep {
namespace {

using detail::LineScanner;
using detail::lower_case;
using detail::NameList;

// File names that say "normal map": bump statements often carry one, because MTL has no statement
// of its own for it.
bool names_normal_map(const std::string& file) {
    const std::string stem = lower_case(std::filesystem::path(file).stem().string());
    static constexpr std::string_view endings[] = {
        "_nm",  "_nm_tangent", "_normal", "_normals",   "_n",
        "_nrm", "_norm",       "-normal", "_normalmap", "normalmap"};
    return std::any_of(std::begin(endings), std::end(endings),
                       [&](std::string_view e) { return stem.ends_with(e); });
}

class MtlParser {
  public:
    MtlParser(const std::string& name, detail::PictureSearch& pictures, MtlLibrary& out)
        : name_(name), pictures_(pictures), out_(out) {}

    void run(std::string_view text) {
        text = detail::without_byte_order_mark(text);
        while (!text.empty()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            ++line_;
            statement(text.substr(0, end));
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        finish();
        if (without_exponent_ > 0)
            out_.warnings.push_back(name_ + ": " + std::to_string(without_exponent_) +
                                    (without_exponent_ == 1 ? " material has" : " materials have") +
                                    " Ks with Ns 0, which is no highlight: taken as not stated");
        warn_left_out("statements", not_taken_);
        warn_left_out("map options", options_not_taken_);
    }

  private:
    void warn(const std::string& what) {
        constexpr std::size_t most = 20;  // a file that is no MTL at all must not flood the report
        if (out_.warnings.size() < most)
            out_.warnings.push_back(name_ + ":" + std::to_string(line_) + ": " + what);
    }

    void statement(std::string_view line) {
        LineScanner scan(line);
        const std::string word = lower_case(scan.word());
        if (word.empty() || word[0] == '#') return;
        // A comment runs from # to the end of any line, but names go to the end of theirs with
        // every #, as in OBJ.
        if (word != "newmtl" && !takes_a_map(word)) {
            scan = LineScanner(line.substr(0, line.find('#')));
            scan.word();
        }
        if (word == "newmtl") {
            finish();
            out_.materials.emplace_back();
            material_ = &out_.materials.back();
            material_->name = std::string(scan.rest());
            stated_ = {};
            return;
        }
        if (!material_) return warn("'" + word + "' before the first newmtl was skipped");
        Material& m = *material_;
        if (word == "ka")
            color(scan, m.ambient);
        else if (word == "kd")
            diffuse(scan);
        else if (word == "ks")
            stated_.specular |= color(scan, m.specular);
        else if (word == "ke")
            color(scan, m.emissive);
        else if (word == "ns")
            exponent(scan);
        else if (word == "d")
            opacity(scan, false);
        else if (word == "tr")
            opacity(scan, true);
        else if (word == "illum")
            illumination(scan);
        else if (word == "map_kd")
            map(scan, m.diffuse_map);
        else if (word == "map_ks")
            map(scan, m.specular_map);
        else if (word == "map_ke")
            map(scan, m.emissive_map);
        else if (word == "disp" || word == "map_disp")
            displacement(scan);
        else if (word == "norm" || word == "map_kn")
            map(scan, m.normal_map);
        else if (word == "bump" || word == "map_bump")
            bump(scan);
        else if (word == "map_d")
            map(scan, stated_.opacity_map);
        else if (!physical(word, scan) && word != "sharpness" && !(word == "tf" && is_white(scan)))
            not_taken_.add(word);
    }

    // Light that passes keeps its colour: nothing that would be lost.
    static bool is_white(LineScanner scan) {
        double value = 0;
        int count = 0;
        while (count < 3 && scan.number(value) && value == 1) ++count;
        return count > 0 && scan.at_end();
    }

    // The statements of physically based MTL, by the words that Blender and others write.
    bool physical(const std::string& word, LineScanner& scan) {
        Material& m = *material_;
        float turns = 0;
        if (word == "pr")
            stated_.roughness |= share(scan, m.roughness);
        else if (word == "pm")
            stated_.metallic |= share(scan, m.metallic);
        else if (word == "map_pr" || word == "map_roughness")
            map(scan, stated_.roughness_map);
        else if (word == "map_pm" || word == "map_metallic")
            map(scan, stated_.metallic_map);
        else if (word == "pc")
            share(scan, m.clearcoat);
        else if (word == "pcr")
            share(scan, m.clearcoat_roughness);
        else if (word == "ps")
            color(scan, m.sheen);
        else if (word == "aniso")
            share(scan, m.anisotropy);
        else if (word == "anisor" && share(scan, turns))
            m.anisotropy_rotation = turns * 6.2831853f;
        else if (word == "ni")
            refraction(scan);
        else
            return word == "anisor";
        return true;
    }

    bool share(LineScanner& scan, float& to) {
        double value = 0;
        if (!number(scan, value)) return false;
        to = float(std::clamp(value, 0.0, 1.0));
        return true;
    }

    void refraction(LineScanner& scan) {
        double value = 0;
        if (number(scan, value)) stated_.refraction = value;
    }

    // What a material's statements make together (docs/materials.md).
    void finish() {
        if (!material_) return;
        Material& m = *material_;
        m.metallic_roughness =
            stated_.roughness || stated_.metallic || stated_.roughness_map || stated_.metallic_map;
        // Where a map's picture is not there, its factor is all there is.
        const bool metallic_map = is_there(stated_.metallic_map);
        const bool roughness_map = is_there(stated_.roughness_map);
        if (m.metallic_roughness) {
            if (!stated_.metallic) m.metallic = metallic_map ? 1.0f : 0.0f;
            if (!stated_.roughness)
                m.roughness = roughness_map ? 1.0f : dielectric(m.specular, m.shininess).roughness;
            // An index of 1 is what programs write that know of none.
            if (stated_.refraction > 1) {
                const double q = (stated_.refraction - 1) / (stated_.refraction + 1);
                m.reflectance = glm::vec3(float(q * q));
            }
            // A factor of 0 would make its map nothing: not what naming one means.
            if (metallic_map && m.metallic == 0) m.metallic = 1;
            if (roughness_map && m.roughness == 0) m.roughness = 1;
            metallic_roughness_map(m);
        }
        const bool unfit = stated_.specular && stated_.exponent && m.shininess == 0 &&
                           m.specular != glm::vec3(0.0f);
        if (unfit && !m.metallic_roughness && stated_.illumination != 1) ++without_exponent_;
        if (unfit) m.shininess = Material{}.shininess;
        if (stated_.illumination == 1)
            m.specular = glm::vec3(0.0f);
        else if (unfit || !stated_.specular)
            m.specular = usual_specular(m.shininess);
        // Of a map that is named something is meant to be seen.
        if (is_there(m.diffuse_map) && glm::vec3(m.diffuse) == glm::vec3(0.0f))
            m.diffuse = glm::vec4(1, 1, 1, m.diffuse.a);
        if (is_there(m.emissive_map) && m.emissive == glm::vec3(0.0f)) m.emissive = glm::vec3(1.0f);
        opacity_map(m);
        material_ = nullptr;
    }

    std::shared_ptr<const ImageRef> source(const TextureRef& ref) const {
        if (!ref) return nullptr;
        return std::make_shared<const ImageRef>(out_.images[out_.textures[ref.texture].image]);
    }
    bool is_there(const TextureRef& ref) const {
        std::error_code ec;
        return ref && std::filesystem::is_regular_file(
                          out_.images[out_.textures[ref.texture].image].path, ec);
    }
    bool differ(const TextureRef& a, const TextureRef& b) const {
        return a.offset != b.offset || a.scale != b.scale ||
               out_.textures[a.texture].wrap_u != out_.textures[b.texture].wrap_u;
    }

    // glTF has one picture for both. The same file for both is such a picture already.
    void metallic_roughness_map(Material& m) {
        const TextureRef &metallic = stated_.metallic_map, &roughness = stated_.roughness_map;
        if (!metallic && !roughness) return;
        m.metallic_roughness_map = roughness ? roughness : metallic;
        if (metallic && roughness && metallic.texture == roughness.texture) return;
        if (metallic && roughness && differ(metallic, roughness))
            warn("map_Pr and map_Pm of '" + m.name + "' lie differently: both as map_Pr");
        packed(m.metallic_roughness_map, {0, metallic.texture, roughness.texture}, [&] {
            return detail::packed_metallic_roughness(source(metallic), source(roughness), false);
        });
    }

    // map_d: the same file as map_Kd means that one's alpha.
    void opacity_map(Material& m) {
        const TextureRef& opacity = stated_.opacity_map;
        if (!is_there(opacity)) return;
        m.alpha_mode = AlphaMode::blend;
        if (m.diffuse_map && m.diffuse_map.texture == opacity.texture) return;
        if (m.diffuse_map && differ(m.diffuse_map, opacity))
            warn("map_d and map_Kd of '" + m.name + "' lie differently: both as map_Kd");
        const TextureRef color = m.diffuse_map;
        if (!m.diffuse_map) m.diffuse_map = opacity;
        packed(m.diffuse_map, {1, color.texture, opacity.texture},
               [&] { return detail::packed_with_opacity(source(color), source(opacity)); });
    }

    // What is made of the same pictures is made once.
    using PackedKey = std::array<std::uint32_t, 3>;
    template <class Make>
    void packed(TextureRef& ref, const PackedKey& key, const Make& make) {
        const auto [it, added] = packed_.emplace(key, std::uint32_t(out_.textures.size()));
        if (added) {
            Texture texture = out_.textures[ref.texture];
            texture.image = std::uint32_t(out_.images.size());
            out_.images.push_back(make());
            out_.textures.push_back(texture);
        }
        ref.texture = it->second;
    }

    static bool takes_a_map(const std::string& word) {
        return word.starts_with("map_") || word == "disp" || word == "norm" || word == "bump";
    }

    void warn_left_out(const char* what, const NameList& list) {
        if (!list.empty())
            out_.warnings.push_back(name_ + ": " + what + " that were not taken: " + list.text());
    }

    bool number(LineScanner& scan, double& value) {
        constexpr double most = std::numeric_limits<float>::max();
        if (!scan.number(value) || !std::isfinite(value)) {
            warn("expected a number; the statement was skipped");
            return false;
        }
        if (std::abs(value) <= most) return true;
        warn("expected a number of at most 3.4e38; the statement was skipped");
        return false;
    }

    bool color(LineScanner& scan, glm::vec3& to) {
        double rgb[3];
        if (!number(scan, rgb[0])) return false;
        if (scan.at_end()) {
            rgb[1] = rgb[2] = rgb[0];
        } else if (!number(scan, rgb[1]) || !number(scan, rgb[2])) {
            return false;
        }
        to = glm::vec3(glm::dvec3(rgb[0], rgb[1], rgb[2]));
        return true;
    }

    void diffuse(LineScanner& scan) {
        glm::vec3 rgb(material_->diffuse);
        color(scan, rgb);
        material_->diffuse = glm::vec4(rgb, material_->diffuse.a);
    }

    void exponent(LineScanner& scan) {
        double value = 0;
        // The format's own range is 0 … 1000; larger ones occur and mean what they say.
        if (!number(scan, value)) return;
        material_->shininess = float(std::clamp(value, 0.0, 1e6));
        stated_.exponent = true;
    }

    void opacity(LineScanner& scan, bool transparency) {
        double value = 0;
        LineScanner probe = scan;
        if (probe.word() != "-halo") probe = scan;
        if (!number(probe, value)) return;
        value = std::clamp(value, 0.0, 1.0);
        // "Tr" is 1 − d; where both stand, d decides.
        if (transparency && stated_.opacity) return;
        stated_.opacity |= !transparency;
        material_->diffuse.a = float(transparency ? 1 - value : value);
        material_->alpha_mode = material_->diffuse.a < 1 ? AlphaMode::blend : AlphaMode::opaque;
    }

    void illumination(LineScanner& scan) {
        double model = 0;
        if (!number(scan, model)) return;
        if (model == 0) material_->unlit = true;
        stated_.illumination = model;
    }

    void bump(LineScanner& scan) {
        TextureRef ref;
        const std::string file = map(scan, ref);
        if (!ref) return;
        (names_normal_map(file) ? material_->normal_map : material_->bump_map) = ref;
    }

    // The height is base + gain · texel (-mm base gain; 0 and 1 unless it says so).
    void displacement(LineScanner& scan) {
        Material& m = *material_;
        ValueRange range;
        TextureRef ref;
        map(scan, ref, &range);
        if (!ref) return;
        m.displacement_map = ref;
        m.displacement_scale = float(range.gain);
        m.displacement_midlevel = 0;
        if (range.gain != 0 && range.base != 0) {
            const double midlevel = -range.base / range.gain;
            if (std::abs(midlevel) <= largest_option)
                m.displacement_midlevel = float(midlevel);
            else
                warn("disp: a base that is no height of the map was skipped");
        } else if (range.base != 0) {
            warn("disp with a gain of 0 is the same everywhere: its base was skipped");
        }
    }

    // Offsets and scales of that size still add up to finite floats.
    static constexpr double largest_option = 1e30;

    // Whether an option with this word makes another picture than without.
    static bool changes_values(const std::string& option, const std::string& word) {
        if (option == "-cc") return word == "on";
        if (option == "-blendu" || option == "-blendv") return word == "off";
        return option == "-imfchan" || option == "-type" || option == "-colorspace";
    }

    bool exists(const std::string& file) { return pictures_.locate(file).has_value(); }

    // What -mm makes of a texel.
    struct ValueRange {
        double base = 0, gain = 1;
    };

    // Options, then a file name that may contain blanks. Returns the name. -mm goes to `range`
    // where the statement has a place for it.
    std::string map(LineScanner& scan, TextureRef& to, ValueRange* range = nullptr) {
        TextureRef ref;
        Texture texture;
        glm::dvec2 up(0.0);
        for (;;) {
            LineScanner probe = scan;
            const std::string option = lower_case(probe.word());
            const int arguments = option_arguments(option);
            if (arguments < 0) break;
            scan = probe;
            double values[3] = {0, 0, 0};
            int have = 0;
            bool good = true;
            while (have < arguments) {
                LineScanner next = scan;
                if (is_numeric(option)) {
                    double value = 0;
                    if (!next.number(value)) break;
                    if (std::abs(value) <= largest_option)
                        values[have] = value;
                    else
                        good = false;
                } else {
                    const std::string word = lower_case(next.word());
                    if (option == "-clamp" && word == "on")
                        texture.wrap_u = texture.wrap_v = Wrap::clamp;
                    if (changes_values(option, word)) options_not_taken_.add(option);
                }
                scan = next;
                ++have;
            }
            if (have == 0 && arguments > 0) warn("option " + option + " lacks its argument");
            if (!good) {
                warn("option " + option + " has a value beyond 1e30; it was skipped");
                continue;
            }
            const bool plain = values[0] == 0 && (values[1] == 0 || have < 2) && values[2] == 0;
            const bool whole_range = values[0] == 0 && (have < 2 || values[1] == 1);
            if (range && option == "-mm" && have > 0)
                *range = {values[0], have > 1 ? values[1] : 1.0};
            if ((option == "-t" && !plain) || (option == "-mm" && !whole_range && !range) ||
                (option == "-boost" && values[0] != 0))
                options_not_taken_.add(option);
            if (option == "-o") up = glm::dvec2(values[0], values[1]);
            if (option == "-s" && have > 0)
                ref.scale = glm::vec2(float(values[0]), float(have > 1 ? values[1] : 1.0));
            if (option == "-bm" && have > 0) ref.strength = float(values[0]);
        }
        // v runs upwards in the file: 1 − v' = s · (1 − v) + o.
        ref.offset = glm::vec2(float(up.x), float(1 - double(ref.scale.y) - up.y));
        std::string file(scan.rest());
        if (file.empty()) {
            warn("a map without a file name was skipped");
            return file;
        }
        if (const std::string before = detail::before_comment(file);
            before != file && !exists(file) && exists(before))
            file = before;
        ref.texture = texture_of(file, texture);
        to = ref;
        return file;
    }

    static bool is_numeric(const std::string& option) {
        return option != "-clamp" && option != "-blendu" && option != "-blendv" &&
               option != "-cc" && option != "-imfchan" && option != "-type" &&
               option != "-colorspace";
    }

    // How many arguments an option may have; −1 where the word is no option.
    static int option_arguments(const std::string& word) {
        static const std::unordered_map<std::string, int> options{
            {"-o", 3},      {"-s", 3},       {"-t", 3},     {"-mm", 2},        {"-bm", 1},
            {"-boost", 1},  {"-texres", 1},  {"-clamp", 1}, {"-cc", 1},        {"-blendu", 1},
            {"-blendv", 1}, {"-imfchan", 1}, {"-type", 1},  {"-colorspace", 1}};
        const auto it = options.find(word);
        return it == options.end() ? -1 : it->second;
    }

    std::uint32_t texture_of(const std::string& file, Texture texture) {
        const std::filesystem::path path = pictures_.find(file);
        const auto [it, added] = images_.emplace(path.string(), std::uint32_t(out_.images.size()));
        if (added) {
            ImageRef image;
            image.name = file;
            std::replace(image.name.begin(), image.name.end(), '\\', '/');
            image.path = path;
            out_.images.push_back(std::move(image));
        }
        texture.image = it->second;
        for (std::uint32_t t = 0; t < out_.textures.size(); ++t)
            if (out_.textures[t].image == texture.image &&
                out_.textures[t].wrap_u == texture.wrap_u)
                return t;
        out_.textures.push_back(texture);
        return std::uint32_t(out_.textures.size() - 1);
    }

    const std::string& name_;
    detail::PictureSearch& pictures_;
    MtlLibrary& out_;
    Material* material_ = nullptr;
    // Of the current material: what it says, for finish().
    struct Stated {
        bool specular = false, exponent = false, opacity = false;
        bool roughness = false, metallic = false;
        double illumination = -1, refraction = 0;
        TextureRef roughness_map, metallic_map, opacity_map;
    } stated_;
    std::size_t without_exponent_ = 0;
    std::size_t line_ = 0;
    // In the order of their first use.
    NameList not_taken_, options_not_taken_;
    std::unordered_map<std::string, std::uint32_t> images_;
    std::map<PackedKey, std::uint32_t> packed_;
};

}  // namespace

MtlLibrary parse_mtl(std::string_view text, const std::string& name,
                     detail::PictureSearch& pictures) {
    MtlLibrary library;
    if (detail::ends_lines_with_cr(text))
        MtlParser(name, pictures, library).run(detail::with_line_feeds(text));
    else
        MtlParser(name, pictures, library).run(text);
    return library;
}

MtlLibrary parse_mtl(std::string_view text, const std::string& name,
                     const std::filesystem::path& directory) {
    detail::PictureSearch pictures(directory);
    MtlLibrary library = parse_mtl(text, name, pictures);
    for (std::string& warning : pictures.warnings()) library.warnings.push_back(std::move(warning));
    return library;
}

}  // namespace prep
