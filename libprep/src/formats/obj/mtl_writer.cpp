#include "formats/obj/mtl_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/turned_green.h"
#include "image/packed_channels.h"
#include "image/picture_kind.h"
#include "prep/image.h"
#include "text/note_once.h"

namespace prep::detail {

using Index = std::uint32_t;

std::string path_from(const std::filesystem::path& output, const std::filesystem::path& file) {
    std::error_code ec;
    const std::filesystem::path name = std::filesystem::relative(
        file, output.parent_path().empty() ? "." : output.parent_path(), ec);
    return ec || name.empty() ? file.string() : name.generic_string();
}

namespace {

bool is_absolute_name(const std::string& name) {
    const bool drive = name.size() > 2 && name[1] == ':' && name[2] == '/';
    return drive || name.starts_with('/');
}

// Of no exponent at all it differs by less than a picture holds.
constexpr float least_exponent = 1e-4f;

}  // namespace

MtlWriter::MtlWriter(const Scene& scene, const std::filesystem::path& obj, FileSet& files,
                     std::vector<std::string>& notes)
    : scene_(scene),
      path_(obj),
      stem_(statement_name(obj.stem().string())),
      files_(files),
      notes_(notes) {
    name_materials();
    for (const Material& material : scene_.materials) {
        Index set = no_index;
        for (const MaterialMap& map : material_maps)
            if (const TextureRef& ref = material.*map.ref;
                ref && set == no_index && is_written(material, map.kind))
                set = ref.uv_set;
        uv_sets_.push_back(set);
    }
}

// A black colour with a picture is read as a white one: programs that know no factors write that.
bool MtlWriter::shows_nothing(const glm::vec3& color, const TextureRef& ref) const {
    if (!ref || color != glm::vec3(0.0f) || ref.texture >= scene_.textures.size()) return false;
    const Index index = scene_.textures[ref.texture].image;
    if (index >= scene_.images.size()) return false;
    const ImageRef& image = scene_.images[index];
    std::error_code ec;
    return !image.bytes.empty() || !image.channels.empty() ||
           std::filesystem::is_regular_file(image.path, ec);
}

// Whether MTL says anything of such a map.
bool MtlWriter::is_written(const Material& in, MapKind kind) const {
    switch (kind) {
        case MapKind::occlusion:
        case MapKind::layer_normal:
        case MapKind::anisotropy:
            return false;
        case MapKind::diffuse:
            return in.alpha_mode == AlphaMode::blend ||
                   !shows_nothing(glm::vec3(in.diffuse), in.diffuse_map);
        case MapKind::emissive:
            return !shows_nothing(in.emissive, in.emissive_map);
        case MapKind::normal:
            return in.normal_map_space == NormalMapSpace::tangent;
        default:
            return true;
    }
}

// Heights are in the mesh's own unit, and its points are written where nodes put them.
void MtlWriter::find_height_scales() {
    const auto merge = [](HeightScale& to, double along) {
        to.differs |= to.first > 0 && std::abs(along - to.first) > 1e-6 * to.first;
        if (to.first == 0) to.first = along;
    };
    const std::vector<glm::dmat4> world = world_transforms(scene_);
    std::vector<HeightScale> of_meshes(scene_.meshes.size());
    std::vector<bool> has_node(scene_.meshes.size(), false);
    std::vector<Index> in_order;  // meshes, by the first node that has them
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n) {
        const Index mesh = scene_.nodes[n].mesh;
        if (mesh == no_index) continue;
        if (!has_node[mesh]) in_order.push_back(mesh);
        has_node[mesh] = true;
        const glm::dmat3 linear(world[n]);
        for (int axis = 0; axis < 3; ++axis) merge(of_meshes[mesh], glm::length(linear[axis]));
    }
    height_scales_.resize(scene_.materials.size());
    for (const Index mesh : in_order)
        for (const Index m : scene_.meshes[mesh].face_materials) {
            if (m >= height_scales_.size()) continue;
            if (of_meshes[mesh].first > 0) merge(height_scales_[m], of_meshes[mesh].first);
            height_scales_[m].differs |= of_meshes[mesh].differs;
        }
}

double MtlWriter::height_scale(const Material& of) {
    if (height_scales_.empty()) find_height_scales();
    const HeightScale& scale = height_scales_[std::size_t(&of - scene_.materials.data())];
    if (scale.differs)
        note(
            "MTL has one scale of heights for a material: where nodes scale it differently, it is "
            "that of the first");
    return scale.first > 0 ? scale.first : 1;
}

void MtlWriter::note(const std::string& text) {
    note_once(notes_, text);
}

// OBJ tells materials apart by name alone.
void MtlWriter::name_materials() {
    std::vector<std::string> own;
    UniqueNames names;
    for (const Material& material : scene_.materials) {
        own.push_back(statement_name(material.name));
        if (own.back() != material.name) note(changed_names);
        if (!own.back().empty()) names.keep_free(own.back());
    }
    for (Index m = 0; m < own.size(); ++m) {
        const bool named = !own[m].empty();
        names_.push_back(names.unique(named ? own[m] : fmt::format("material_{}", m), named));
        if (named && names_.back() != own[m])
            note("OBJ tells materials apart by name: equal ones got a number");
    }
    no_material_ = names.unique(no_material_, false);
}

// Where a face without a material follows one that has any, in the order in which nodes are
// written, lines and points before faces.
bool MtlWriter::names_no_material() const {
    bool any = false;
    for (const Node& node : scene_.nodes) {
        if (node.mesh == no_index) continue;
        const Mesh& mesh = scene_.meshes[node.mesh];
        const bool loose = !mesh.line_vertices.empty() || !mesh.points.empty();
        const bool faces = mesh.face_materials.empty() && mesh.face_count() > 0;
        if (any && (loose || faces)) return true;
        for (const Index m : mesh.face_materials) {
            if (m >= scene_.materials.size() && any) return true;
            any |= m < scene_.materials.size();
        }
    }
    return false;
}

Result<std::string> MtlWriter::text() {
    std::string mtl = "# meshprep\n";
    for (Index m = 0; m < scene_.materials.size(); ++m)
        material(scene_.materials[m], names_[m], uv_sets_[m], mtl);
    if (names_no_material()) material({}, no_material_, no_index, mtl);
    if (failure_) return std::move(*failure_);
    return mtl;
}

void MtlWriter::material(const Material& in, const std::string& name, Index set, std::string& mtl) {
    uv_set_ = set;
    mtl += fmt::format("\nnewmtl {}\n", name);
    const auto color = [&](const char* word, const glm::vec3& c) {
        mtl += fmt::format("{} {} {} {}\n", word, c.r, c.g, c.b);
    };
    glm::vec3 specular = in.specular;
    float shininess = in.shininess;
    const bool physical = in.metallic_roughness && !in.unlit;
    if (in.metallic_roughness && in.unlit) {
        specular = glm::vec3(0.0f);  // its colour is all there is of it
    } else if (physical) {
        const BlinnPhong derived =
            blinn_phong(glm::vec3(in.diffuse), in.metallic, in.roughness, in.reflectance);
        specular = glm::min(derived.specular, glm::vec3(1.0f));  // all that MTL allows
        shininess = derived.shininess;
        note(
            "metallic-roughness is written as Pr and Pm; Kd is the base colour, Ks and Ns "
            "are for programs that do not read them");
    }
    color("Ka", in.ambient);
    // With Pm the base colour, of metals too, as other programs write and read it.
    color("Kd", glm::vec3(in.diffuse));
    color("Ks", specular);
    color("Ke", in.emissive);
    // Opaque materials ignore their alpha, and what a mask leaves is opaque.
    const float opacity = in.alpha_mode == AlphaMode::blend ? in.diffuse.a : 1.0f;
    // Beside a Ks that is not black, programs write Ns 0 where they mean none, and it is read so.
    if (shininess == 0 && specular != glm::vec3(0.0f)) shininess = least_exponent;
    mtl += fmt::format("Ns {}\nd {}\nillum {}\n", shininess, opacity, in.unlit ? 0 : 2);
    if (physical) physical_statements(in, mtl);
    if (in.alpha_mode == AlphaMode::mask)
        note("MTL has no alpha masks: what they cut out is drawn");
    if (in.double_sided) note("MTL has no double-sided materials: left out");
    map_on(glm::vec3(in.diffuse), mtl, "map_Kd", in.diffuse_map);
    map(mtl, "map_Ks", in.specular_map);
    map_on(in.emissive, mtl, "map_Ke", in.emissive_map);
    normal_map(in, mtl);
    map(mtl, "bump", in.bump_map);
    displacement(in, mtl);
    if (in.alpha_mode == AlphaMode::blend) opacity_map(in.diffuse_map, mtl);
    if (in.occlusion_map) note("MTL has no occlusion maps: left out");
}

void MtlWriter::map_on(const glm::vec3& color, std::string& mtl, const char* word,
                       const TextureRef& ref) {
    if (!shows_nothing(color, ref)) return map(mtl, word, ref);
    note(
        "MTL takes a black colour with a map for a white one: maps that show nothing, on black, "
        "are left out");
}

void MtlWriter::normal_map(const Material& in, std::string& mtl) {
    if (!in.normal_map) return;
    if (in.normal_map_space != NormalMapSpace::tangent)
        return note("MTL has no object-space normal maps: left out");
    if (!in.normal_map_flip_green) return map(mtl, "norm", in.normal_map);
    const ImageRef* const image = image_of(in.normal_map);
    if (!image) return;
    const Index index = scene_.textures[in.normal_map.texture].image;
    const std::string file = fmt::format("{}_image{}_green.png", stem_, index);
    const bool known = made_files_.contains(file);
    if (!make(file, *image, "normal map", turned_green_png)) return;
    if (!known) note("texture '" + image->name + "' was written anew, its green turned over");
    map_line(mtl, "norm", in.normal_map, file);
}

// base + gain · texel is (texel − midlevel) · scale.
void MtlWriter::displacement(const Material& in, std::string& mtl) {
    if (!in.displacement_map) return;
    if (in.displacement_kind != DisplacementKind::height)
        return note("MTL has no vector displacement: left out");
    const double gain = double(in.displacement_scale) * height_scale(in);
    const double base = -double(in.displacement_midlevel) * gain;
    // Not −0.
    const std::string range =
        base == 0 && gain == 1 ? "" : fmt::format(" -mm {} {}", base == 0 ? 0.0 : base, gain);
    map(mtl, "disp" + range, in.displacement_map);
}

void MtlWriter::physical_statements(const Material& in, std::string& mtl) {
    const auto number = [&](const char* word, float value) {
        mtl += fmt::format("{} {}\n", word, value);
    };
    number("Pr", in.roughness);
    number("Pm", in.metallic);
    const glm::vec3& f0 = in.reflectance;
    if (f0.r != f0.g || f0.r != f0.b) note("MTL has one reflectance for all colours: the mean");
    const double mean = (double(f0.r) + double(f0.g) + double(f0.b)) / 3;
    // What an index of refraction reflects: ((n − 1)/(n + 1))².
    if (f0 != glm::vec3(0.04f) && mean < 0.999) {
        const double root = std::sqrt(std::max(mean, 0.0));
        number("Ni", float((1 + root) / (1 - root)));
    }
    if (in.clearcoat > 0) {
        number("Pc", in.clearcoat);
        number("Pcr", in.clearcoat_roughness);
    }
    if (in.sheen != glm::vec3(0.0f))
        mtl += fmt::format("Ps {} {} {}\n", in.sheen.r, in.sheen.g, in.sheen.b);
    if (in.anisotropy > 0) {
        number("aniso", in.anisotropy);
        number("anisor", in.anisotropy_rotation / 6.2831853f);
    }
    if (!in.metallic_roughness_map) return;
    // Programs read grey pictures there, one for each.
    if (in.roughness > 0) grey_map(mtl, "map_Pr", in.metallic_roughness_map, 1, "roughness");
    if (in.metallic > 0) grey_map(mtl, "map_Pm", in.metallic_roughness_map, 2, "metallic");
}

// What `png` makes of the picture, once, beside the OBJ file. False, and told, where it cannot be
// read.
bool MtlWriter::make(const std::string& file, const ImageRef& image, const char* what,
                     const std::function<Result<std::vector<std::byte>>(Image)>& png) {
    if (made_files_.contains(file)) return true;
    auto decoded = load_image(image);
    const auto made = decoded ? png(*std::move(decoded)) : decoded.error();
    if (!made) {
        note(std::string("the ") + what + " '" + image.name + "' cannot be read: left out (" +
             made.error().text + ")");
        return false;
    }
    if (auto done = files_.add(path_.parent_path() / file, *made); !done && !failure_)
        failure_ = std::move(done).error();
    made_files_.insert(file);
    return true;
}

// A channel of the packed picture as a file of its own; what was put together is named again.
void MtlWriter::grey_map(std::string& mtl, const char* word, const TextureRef& ref,
                         std::uint32_t channel, const char* what) {
    const ImageRef* image = image_of(ref);
    if (!image) return;
    if (!image->channels.empty()) {
        if (channel >= image->channels.size()) return;
        const PackedChannel& packed = image->channels[channel];
        if (!packed.source) return;
        if (packed.source->bytes.empty() && packed.channel == 0 && !packed.inverted)
            return map_line(mtl, word, ref, file_name(*packed.source));
    }
    const Index index = scene_.textures[ref.texture].image;
    const std::string file = fmt::format("{}_image{}_{}.png", stem_, index, what);
    const auto grey = [channel](const Image& of) {
        return encode_png(single_channel(of, channel));
    };
    if (!make(file, *image, "metallic-roughness picture", grey)) return;
    map_line(mtl, word, ref, file);
}

// The alpha of the colour's picture: the same file, or the one that it was put together from.
void MtlWriter::opacity_map(const TextureRef& ref, std::string& mtl) {
    const ImageRef* image = image_of(ref);
    if (!image) return;
    if (image->channels.size() < 4) {
        // Of a picture without alpha, programs would take the brightness.
        const auto decoded = load_image(*image);
        if (decoded && decoded->channels % 2 == 0) map(mtl, "map_d", ref);
        if (!decoded && decoded.error().code != ErrorCode::io)
            note("whether '" + image->name + "' has alpha is unknown: " + decoded.error().text);
        return;
    }
    const auto& opacity = image->channels[3].source;
    if (!opacity) return;
    // Numbers behind those of the scene's own pictures.
    const Index number = Index(scene_.images.size()) + scene_.textures[ref.texture].image;
    map_line(mtl, "map_d", ref,
             opacity->bytes.empty() ? file_name(*opacity) : embedded_file(*opacity, number));
}

const ImageRef* MtlWriter::image_of(const TextureRef& ref) {
    if (!ref || ref.texture >= scene_.textures.size()) return nullptr;
    if (ref.uv_set != uv_set_) {
        note(
            "OBJ holds one UV set: maps that read another than their material's first are "
            "left out");
        return nullptr;
    }
    const Index image = scene_.textures[ref.texture].image;
    return image < scene_.images.size() ? &scene_.images[image] : nullptr;
}

void MtlWriter::map(std::string& mtl, const std::string& word, const TextureRef& ref) {
    if (image_of(ref)) map_line(mtl, word, ref, image_file(scene_.textures[ref.texture].image));
}

void MtlWriter::map_line(std::string& mtl, const std::string& word, const TextureRef& ref,
                         const std::string& file) {
    if (file.empty()) return;
    if (statement_name(file) != file)
        return note(
            "MTL cannot hold every name of a picture: maps of names with line ends, or "
            "with blanks around them, are left out");
    mtl += word;
    if (ref.strength != 1) mtl += fmt::format(" -bm {}", ref.strength);
    if (ref.scale != glm::vec2(1.0f)) mtl += fmt::format(" -s {} {} 1", ref.scale.x, ref.scale.y);
    // v runs upwards there: 1 − v' = s · (1 − v) + o.
    const float up = 1 - ref.scale.y - ref.offset.y;
    if (ref.offset.x != 0 || up != 0) mtl += fmt::format(" -o {} {} 0", ref.offset.x, up);
    const Texture& texture = scene_.textures[ref.texture];
    if (texture.wrap_u == Wrap::clamp && texture.wrap_v == Wrap::clamp)
        mtl += " -clamp on";
    else if (texture.wrap_u != Wrap::repeat || texture.wrap_v != Wrap::repeat)
        note("MTL repeats or clamps textures in both directions: others will repeat");
    if (ref.rotation != 0) note("MTL has no texture rotation: left out");
    // What begins with a dash is an option.
    mtl += fmt::format(" {}{}\n", file.starts_with('-') ? "./" : "", file);
}

// The image's name relative to the output; embedded ones are written beside it.
std::string MtlWriter::image_file(Index image) {
    const ImageRef& ref = scene_.images[image];
    // The colour of what was put together with an opacity.
    if (!ref.channels.empty()) {
        const auto& source = ref.channels[0].source;
        if (!source) return "";
        return source->bytes.empty() ? file_name(*source) : embedded_file(*source, image);
    }
    if (ref.bytes.empty()) return file_name(ref);
    return embedded_file(ref, image);
}

// A picture that is not there has no place beside the output, if its file said one on another
// machine.
std::string MtlWriter::file_name(const ImageRef& image) const {
    std::error_code ec;
    if (is_absolute_name(image.name) && !std::filesystem::exists(image.path, ec)) return image.name;
    return path_from(path_, image.path);
}

std::string MtlWriter::embedded_file(const ImageRef& ref, Index image) {
    const auto known = written_.find(image);
    if (known != written_.end()) return known->second;
    const std::string_view kind = picture_kind(ref.bytes);
    const std::string file = fmt::format("{}_image{}{}", stem_, image,
                                         ref.path.has_extension() ? ref.path.extension().string()
                                         : kind.empty()           ? ".jpg"
                                                                  : "." + std::string(kind));
    if (auto done = files_.add(path_.parent_path() / file, ref.bytes); !done && !failure_)
        failure_ = std::move(done).error();
    written_.emplace(image, file);
    return file;
}

}  // namespace prep::detail
