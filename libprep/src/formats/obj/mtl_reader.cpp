#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "formats/obj/obj.h"
#include "text/name_list.h"
#include "text/scan.h"

namespace prep {
namespace {

using detail::LineScanner;
using detail::NameList;

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out) c = char(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

// File names that say "normal map": bump statements often carry one, because MTL has no statement
// of its own for it.
bool names_normal_map(const std::string& file) {
    const std::string stem = lower(std::filesystem::path(file).stem().string());
    static constexpr std::string_view endings[] = {
        "_nm",  "_nm_tangent", "_normal", "_normals",   "_n",
        "_nrm", "_norm",       "-normal", "_normalmap", "normalmap"};
    return std::any_of(std::begin(endings), std::end(endings),
                       [&](std::string_view e) { return stem.ends_with(e); });
}

class MtlParser {
  public:
    MtlParser(const std::string& name, const std::filesystem::path& directory, MtlLibrary& out)
        : name_(name), directory_(directory), out_(out) {}

    void run(std::string_view text) {
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        while (!text.empty()) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            ++line_;
            statement(text.substr(0, end));
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        tell_left("statements", not_taken_);
        tell_left("map options", options_not_taken_);
    }

  private:
    void warn(const std::string& what) {
        constexpr std::size_t most = 20;  // a file that is no MTL at all must not flood the report
        if (out_.warnings.size() < most)
            out_.warnings.push_back(name_ + ":" + std::to_string(line_) + ": " + what);
    }

    void statement(std::string_view line) {
        LineScanner scan(line);
        const std::string word = lower(scan.word());
        if (word.empty() || word[0] == '#') return;
        // A comment runs from # to the end of any line, but names go to the end of theirs with
        // every #, as in OBJ.
        if (word != "newmtl" && !takes_a_map(word)) {
            scan = LineScanner(line.substr(0, line.find('#')));
            scan.word();
        }
        if (word == "newmtl") {
            out_.materials.emplace_back();
            material_ = &out_.materials.back();
            material_->name = std::string(scan.rest());
            material_->specular = glm::vec3(0.0f);
            has_d_ = false;
            return;
        }
        if (!material_) return warn("'" + word + "' before the first newmtl was skipped");
        Material& m = *material_;
        if (word == "ka")
            color(scan, m.ambient);
        else if (word == "kd")
            diffuse(scan);
        else if (word == "ks")
            color(scan, m.specular);
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
            map(scan, m.displacement_map);
        else if (word == "norm" || word == "map_kn")
            map(scan, m.normal_map);
        else if (word == "bump" || word == "map_bump")
            bump(scan);
        else if (word != "ni" && word != "tf" && word != "sharpness")  // refraction and reflection
            not_taken_.add(word);
    }

    static bool takes_a_map(const std::string& word) {
        return word.starts_with("map_") || word == "disp" || word == "norm" || word == "bump";
    }

    void tell_left(const char* what, const NameList& list) {
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

    void color(LineScanner& scan, glm::vec3& to) {
        double rgb[3];
        if (!number(scan, rgb[0])) return;
        if (scan.at_end()) {
            rgb[1] = rgb[2] = rgb[0];
        } else if (!number(scan, rgb[1]) || !number(scan, rgb[2])) {
            return;
        }
        to = glm::vec3(glm::dvec3(rgb[0], rgb[1], rgb[2]));
    }

    void diffuse(LineScanner& scan) {
        glm::vec3 rgb(material_->diffuse);
        color(scan, rgb);
        material_->diffuse = glm::vec4(rgb, material_->diffuse.a);
    }

    void exponent(LineScanner& scan) {
        double value = 0;
        // The format's own range is 0 … 1000; larger ones occur and mean what they say.
        if (number(scan, value)) material_->shininess = float(std::clamp(value, 0.0, 1e6));
    }

    void opacity(LineScanner& scan, bool transparency) {
        double value = 0;
        LineScanner probe = scan;
        if (probe.word() != "-halo") probe = scan;
        if (!number(probe, value)) return;
        value = std::clamp(value, 0.0, 1.0);
        // "Tr" is 1 − d; where both stand, d decides.
        if (transparency && has_d_) return;
        has_d_ |= !transparency;
        material_->diffuse.a = float(transparency ? 1 - value : value);
        material_->alpha_mode = material_->diffuse.a < 1 ? AlphaMode::blend : AlphaMode::opaque;
    }

    void illumination(LineScanner& scan) {
        double model = 0;
        if (!number(scan, model)) return;
        if (model == 0) material_->unlit = true;
        if (model == 1) material_->specular = glm::vec3(0.0f);
    }

    void bump(LineScanner& scan) {
        TextureRef ref;
        const std::string file = map(scan, ref);
        if (!ref) return;
        (names_normal_map(file) ? material_->normal_map : material_->bump_map) = ref;
    }

    // Offsets and scales of that size still add up to finite floats.
    static constexpr double largest_option = 1e30;

    // Whether an option with this word makes another picture than without.
    static bool changes_values(const std::string& option, const std::string& word) {
        if (option == "-cc") return word == "on";
        if (option == "-blendu" || option == "-blendv") return word == "off";
        return option == "-imfchan" || option == "-type" || option == "-colorspace";
    }

    bool exists(std::string file) const {
        std::replace(file.begin(), file.end(), '\\', '/');
        std::error_code ec;
        return std::filesystem::is_regular_file(directory_ / file, ec);
    }

    // Options, then a file name that may contain blanks. Returns the name.
    std::string map(LineScanner& scan, TextureRef& to) {
        TextureRef ref;
        Texture texture;
        glm::dvec2 up(0.0);
        for (;;) {
            LineScanner probe = scan;
            const std::string option = lower(probe.word());
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
                    const std::string word = lower(next.word());
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
            if ((option == "-t" && !plain) || (option == "-mm" && !whole_range) ||
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
        std::replace(file.begin(), file.end(), '\\', '/');
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
        const std::filesystem::path path = (directory_ / file).lexically_normal();
        const auto [it, added] = images_.emplace(path.string(), std::uint32_t(out_.images.size()));
        if (added) {
            ImageRef image;
            image.name = file;
            image.path = path;
            std::error_code ec;
            if (!std::filesystem::is_regular_file(path, ec))
                warn("texture '" + file + "' is missing");
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
    const std::filesystem::path& directory_;
    MtlLibrary& out_;
    Material* material_ = nullptr;
    bool has_d_ = false;  // of the current material
    std::size_t line_ = 0;
    // In the order of their first use.
    NameList not_taken_, options_not_taken_;
    std::unordered_map<std::string, std::uint32_t> images_;
};

}  // namespace

MtlLibrary parse_mtl(std::string_view text, const std::string& name,
                     const std::filesystem::path& directory) {
    MtlLibrary library;
    MtlParser(name, directory, library).run(text);
    return library;
}

}  // namespace prep
