#include "prep/scene_json.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <set>

#include "contained/pictures.h"
#include "formats/picture_search.h"
#include "formats/scene_json/merge.h"
#include "formats/scene_json/spec.h"
#include "model/primitive_shapes.h"
#include "prep/files.h"
#include "prep/formats.h"
#include "text/json_schema.h"

namespace prep {
namespace {

using namespace detail;
using schema::Json;
using schema::Name;
using schema::Problem;

constexpr double degrees = std::numbers::pi / 180;

// Whether anything reads it.
bool has_strength(MapKind kind, const Material& material) {
    switch (kind) {
        case MapKind::normal:
            return material.normal_map_space == NormalMapSpace::tangent;
        case MapKind::occlusion:
        case MapKind::bump:
        case MapKind::displacement:
            return true;
        default:
            return false;
    }
}

class Builder {
  public:
    // Without `opens_files`, mesh files have nothing in them.
    Builder(const std::filesystem::path& path, const LoadOptions& options, bool opens_files)
        : path_(path), options_(options), opens_files_(opens_files) {}

    Result<JsonScene> build(const SceneSpec& spec) {
        out_.scene.source = path_;
        out_.scene.name = spec.name;
        // Materials that the file brings come first, so that names of mesh files never hide them.
        const auto steps = {&Builder::add_textures, &Builder::add_materials, &Builder::add_meshes,
                            &Builder::add_nodes,    &Builder::add_lights,    &Builder::add_camera};
        for (const auto step : steps)
            if (std::optional<Error> error = (this->*step)(spec)) return std::move(*error);
        out_.picture = spec.picture;
        const RenderChoices& choices = spec.picture.choices;
        if (choices.coverage == Coverage::area && choices.samples > 1)
            return error("/picture/coverage", "exact areas take the place of several samples");
        pictures_.tell(out_.scene);
        return std::move(out_);
    }

  private:
    using Step = std::optional<Error>;

    Error error(const std::string& pointer, std::string text,
                ErrorCode code = ErrorCode::invalid) const {
        return {code, std::move(text), path_.string() + "#" + pointer};
    }

    // Names to indices, with the complaint about names that are not there.
    using Names = std::map<std::string, std::uint32_t>;
    Result<std::uint32_t> find(const Names& names, const Name& name, const char* kind) const {
        const auto at = names.find(name.text);
        if (at != names.end()) return at->second;
        std::vector<std::string> known;
        for (const auto& entry : names) known.push_back(entry.first);
        if (known.empty())
            return error(name.pointer, "no " + std::string(kind) + " is called '" + name.text +
                                           "': the scene defines none");
        return error(name.pointer, "no " + std::string(kind) + " is called '" + name.text + "'" +
                                       suggestion(name.text, known));
    }

    Result<std::filesystem::path> existing_file(const Name& file) const {
        const std::filesystem::path full = path_.parent_path() / file.text;
        std::error_code ec;
        if (std::filesystem::is_regular_file(full, ec)) return full;
        const bool directory = std::filesystem::is_directory(full, ec);
        return error(file.pointer,
                     directory ? "'" + file.text + "' is a directory, expected a file"
                               : "there is no file '" + file.text +
                                     "'; paths are relative to the scene file",
                     ErrorCode::io);
    }

    Step add_textures(const SceneSpec& spec) {
        for (const schema::Named<TextureSpec>& entry : spec.textures) {
            Result<std::filesystem::path> file = existing_file(entry.value.file);
            if (!file) {
                const auto elsewhere = pictures_.locate(entry.value.file.text);
                if (!elsewhere) return file.error();
                file = *elsewhere;
            }
            Texture texture;
            texture.image = static_cast<std::uint32_t>(out_.scene.images.size());
            texture.wrap_u = entry.value.wrap_u.value_or(entry.value.wrap);
            texture.wrap_v = entry.value.wrap_v.value_or(entry.value.wrap);
            texture.mag = entry.value.mag;
            texture.min = entry.value.min;
            texture.mip = entry.value.mip;
            ImageRef image;
            image.name = entry.name.text;
            image.path = *file;
            textures_[entry.name.text] = static_cast<std::uint32_t>(out_.scene.textures.size());
            out_.scene.images.push_back(std::move(image));
            out_.scene.textures.push_back(texture);
        }
        return {};
    }

    Step add_materials(const SceneSpec& spec) {
        for (const schema::Named<MaterialSpec>& entry : spec.materials) {
            Material material = entry.value.material;
            material.name = entry.name.text;
            material.diffuse.a = entry.value.opacity;
            for (const MaterialMap& row : material_maps) {
                const std::optional<MapSpec>& map = entry.value.maps[std::size_t(row.kind)];
                if (!map) continue;
                if (map->strength.value_or(1) != 1 && !has_strength(row.kind, material))
                    return error(entry.name.pointer + "/" + row.scene_key + "/strength",
                                 row.kind == MapKind::normal
                                     ? "normal maps in object space have no strength; leave it out"
                                     : "maps of colours have no strength; change the colour that "
                                       "the map multiplies");
                const Result<std::uint32_t> texture = find(textures_, map->texture, "texture");
                if (!texture) return texture.error();
                TextureRef ref = map->ref;
                ref.texture = *texture;
                ref.rotation = static_cast<float>(map->rotate * degrees);
                ref.strength = static_cast<float>(map->strength.value_or(1));
                material.*row.ref = ref;
            }
            materials_[entry.name.text] = static_cast<std::uint32_t>(out_.scene.materials.size());
            out_.scene.materials.push_back(std::move(material));
        }
        return {};
    }

    Result<Scene> load_part(const schema::Named<MeshSpec>& entry) {
        const MeshSpec& spec = entry.value;
        const int sources = (spec.file.text.empty() ? 0 : 1) + (spec.shape ? 1 : 0);
        if (sources != 1)
            return error(entry.name.pointer,
                         sources == 0 ? "a mesh needs a 'file' or a 'shape'; add one of them"
                                      : "a mesh has a 'file' or a 'shape', not both");
        if (spec.shape) {
            const ShapeSpec shape = with_defaults(*spec.shape);
            const std::uint64_t faces = face_count(shape);
            constexpr std::uint64_t most = std::uint64_t(1) << 24;
            if (faces > most - generated_faces_)
                return error(
                    entry.name.pointer + "/shape",
                    "the shape has " + std::to_string(faces) + " faces" +
                        (generated_faces_ == 0 ? ", over 2^24"
                                               : ", and " + std::to_string(generated_faces_) +
                                                     " in the shapes before it; all "
                                                     "together may have 2^24 faces"),
                    ErrorCode::limit);
            generated_faces_ += faces;
            Scene scene;
            scene.meshes.push_back(make_shape(shape));
            scene.meshes[0].name = entry.name.text;
            instance_unused_meshes(scene);
            return scene;
        }
        if (lower_ending(spec.file.text) == ".json")
            return error(spec.file.pointer, "a scene file cannot contain another scene file",
                         ErrorCode::unsupported);
        if (!opens_files_) return Scene{};
        Result<std::filesystem::path> file = existing_file(spec.file);
        if (!file) return file.error();
        Result<Scene> scene = load_scene(*file, options_);
        if (!scene) {
            Error inner = scene.error();
            return Error{inner.code, to_string(inner), path_.string() + "#" + spec.file.pointer};
        }
        return scene;
    }

    static ShapeSpec with_defaults(ShapeSpec s) {
        const bool plane = s.kind == ShapeKind::plane;
        if (s.segments == 0) s.segments = plane ? 1 : 64;
        if (s.rings == 0) s.rings = plane ? 1 : 32;
        return s;
    }

    static std::uint64_t face_count(const ShapeSpec& s) {
        if (s.kind == ShapeKind::box) return 6;
        if (s.kind == ShapeKind::cylinder) return std::uint64_t(s.segments) + 2;
        return std::uint64_t(s.segments) * s.rings;
    }

    static Mesh make_shape(const ShapeSpec& s) {
        switch (s.kind) {
            case ShapeKind::plane:
                return plane_shape({s.size.x, s.size.z}, s.segments, s.rings);
            case ShapeKind::box:
                return box_shape(s.size);
            case ShapeKind::sphere:
                return sphere_shape(s.radius, s.segments, s.rings);
            case ShapeKind::cylinder:
                return cylinder_shape(s.radius, s.height, s.segments);
            case ShapeKind::torus:
                return torus_shape(s.radius, s.tube, s.segments, s.rings);
        }
        return {};
    }

    Step add_meshes(const SceneSpec& spec) {
        for (const schema::Named<MeshSpec>& entry : spec.meshes) {
            Result<Scene> loaded = load_part(entry);
            if (!loaded) return loaded.error();
            Scene part = std::move(*loaded);
            for (const std::string& warning : part.warnings)
                out_.scene.warnings.push_back(entry.name.text + ": " + warning);
            for (const std::string& remark : part.remarks)
                out_.scene.remarks.push_back(entry.name.text + ": " + remark);
            const auto first_material = static_cast<std::uint32_t>(out_.scene.materials.size());
            std::vector<std::string> part_materials;
            for (const Material& m : part.materials) part_materials.push_back(m.name);
            parts_.push_back(merge_scene(out_.scene, std::move(part), entry.name.text, files_));
            part_names_[entry.name.text] = static_cast<std::uint32_t>(parts_.size() - 1);
            if (Step failed = override_materials(entry, first_material, part_materials))
                return failed;
        }
        return {};
    }

    Step override_materials(const schema::Named<MeshSpec>& entry, std::uint32_t first,
                            const std::vector<std::string>& part_materials) {
        const MergedPart& part = parts_.back();
        JsonMeshFile of_file;
        of_file.file = path_.parent_path() / entry.value.file.text;
        if (!entry.value.material.text.empty()) {
            const Result<std::uint32_t> material =
                find(materials_, entry.value.material, "material");
            if (!material) return material.error();
            of_file.material = *material;
            for (std::uint32_t m = part.first_mesh; m < part.first_mesh + part.mesh_count; ++m)
                out_.scene.meshes[m].face_materials.assign(out_.scene.meshes[m].face_count(),
                                                           *material);
        }
        for (const auto& [from, to] : entry.value.replaced) {
            const Result<std::uint32_t> material = find(materials_, to, "material");
            if (!material) return material.error();
            of_file.replaced.emplace_back(from, *material);
            bool found = false;
            for (std::uint32_t k = 0; k < part_materials.size(); ++k) {
                if (part_materials[k] != from) continue;
                found = true;
                for (std::uint32_t m = part.first_mesh; m < part.first_mesh + part.mesh_count; ++m)
                    for (std::uint32_t& face : out_.scene.meshes[m].face_materials)
                        if (face == first + k) face = *material;
            }
            if (!found && opens_files_)
                return error(to.pointer, "the mesh has no material called '" + from + "'" +
                                             suggestion(from, part_materials));
        }
        if (!entry.value.shape) mesh_files_.emplace(parts_.size() - 1, std::move(of_file));
        return {};
    }

    Result<glm::dmat4> transform(const TransformSpec& spec, const std::string& pointer) const {
        if (spec.matrix) {
            if (spec.translate || spec.rotate || spec.scale)
                return error(pointer,
                             "'matrix' stands for translate, rotate and scale together; give "
                             "either it or them");
            return *spec.matrix;
        }
        glm::dmat4 m(1.0);
        if (spec.translate) m = glm::translate(m, *spec.translate);
        if (spec.rotate) {
            // Turns about X, then Y, then Z of the fixed axes.
            m = glm::rotate(m, spec.rotate->z * degrees, glm::dvec3(0, 0, 1));
            m = glm::rotate(m, spec.rotate->y * degrees, glm::dvec3(0, 1, 0));
            m = glm::rotate(m, spec.rotate->x * degrees, glm::dvec3(1, 0, 0));
        }
        if (spec.scale) m = glm::scale(m, *spec.scale);
        return m;
    }

    Step add_nodes(const SceneSpec& spec) {
        Scene& scene = out_.scene;
        if (spec.nodes.empty()) {
            for (std::uint32_t part = 0; part < parts_.size(); ++part) place(part, no_index);
            return {};
        }
        Names names;
        for (std::size_t i = 0; i < spec.nodes.size(); ++i) {
            const schema::Named<NodeSpec>& entry = spec.nodes[i];
            Result<glm::dmat4> matrix = transform(entry.value.transform, entry.name.pointer);
            if (!matrix) return matrix.error();
            Node node;
            node.name = entry.value.name.text;
            node.transform = *matrix;
            if (!node.name.empty() && !names.emplace(node.name, i).second)
                return error(entry.value.name.pointer, "another node is called '" + node.name +
                                                           "' too; names tell nodes "
                                                           "apart, choose a different one");
            scene.nodes.push_back(std::move(node));
        }
        for (std::size_t i = 0; i < spec.nodes.size(); ++i) {
            const NodeSpec& node = spec.nodes[i].value;
            if (node.parent.text.empty()) continue;
            const Result<std::uint32_t> parent = find(names, node.parent, "node");
            if (!parent) return parent.error();
            scene.nodes[i].parent = *parent;
        }
        if (Step cycle = check_cycles(spec)) return cycle;
        for (std::size_t i = 0; i < spec.nodes.size(); ++i) {
            const NodeSpec& node = spec.nodes[i].value;
            if (node.mesh.text.empty()) continue;
            const Result<std::uint32_t> part = find(part_names_, node.mesh, "mesh");
            if (!part) return part.error();
            place(*part, static_cast<std::uint32_t>(i));
        }
        return {};
    }

    void place(std::uint32_t part, std::uint32_t node) {
        instance_part(out_.scene, parts_[part], node);
        const auto file = mesh_files_.find(part);
        if (file == mesh_files_.end()) return;
        out_.mesh_files.push_back(std::move(file->second));
        mesh_files_.erase(file);
    }

    Step check_cycles(const SceneSpec& spec) const {
        const std::size_t count = spec.nodes.size();
        std::vector<std::uint32_t> walked_by(count, no_index);
        for (std::uint32_t i = 0; i < count; ++i) {
            for (std::uint32_t k = i; k != no_index; k = out_.scene.nodes[k].parent) {
                if (walked_by[k] == i)
                    return error(spec.nodes[k].value.parent.pointer,
                                 "node '" + out_.scene.nodes[k].name +
                                     "' is its own ancestor; break the circle of parents");
                if (walked_by[k] != no_index) break;
                walked_by[k] = i;
            }
        }
        return {};
    }

    // A node whose −Z looks along `direction`.
    static glm::dmat4 looking(const glm::dvec3& from, const glm::dvec3& direction, glm::dvec3 up) {
        const glm::dvec3 back = -glm::normalize(direction);
        if (glm::length(glm::cross(up, back)) < 1e-9 * glm::length(up))
            up = std::abs(back.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
        const glm::dvec3 right = glm::normalize(glm::cross(up, back));
        return {glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0),
                glm::dvec4(from, 1)};
    }

    Step add_lights(const SceneSpec& spec) {
        for (const schema::Named<LightSpec>& entry : spec.lights) {
            const LightSpec& l = entry.value;
            const std::string& pointer = entry.name.pointer;
            const bool aimed = l.kind == LightKind::directional || l.kind == LightKind::spot;
            const bool placed = l.kind == LightKind::point || l.kind == LightKind::spot;
            if (aimed != l.direction.has_value())
                return error(pointer, aimed ? "a directional or spot light needs a 'direction'"
                                            : "an ambient or point light has no 'direction'");
            if (placed != l.position.has_value())
                return error(pointer, placed ? "a point or spot light needs a 'position'"
                                             : "an ambient or directional light has no 'position'");
            if (!placed && l.range != 0)
                return error(pointer, "an ambient or directional light has no 'range'");
            if (l.kind != LightKind::spot && (l.inner_cone || l.outer_cone))
                return error(pointer, "only spot lights have cones");
            Light light;
            light.name = l.name.text;
            light.kind = l.kind;
            light.color = l.color;
            light.intensity = l.intensity;
            light.range = l.range;
            if (l.inner_cone) light.inner_cone = static_cast<float>(*l.inner_cone * degrees);
            if (l.outer_cone) light.outer_cone = static_cast<float>(*l.outer_cone * degrees);
            if (light.kind == LightKind::spot && light.inner_cone >= light.outer_cone)
                return error(pointer, "the inner cone must be smaller than the outer one");
            const glm::dvec3 direction = l.direction.value_or(glm::dvec3(0, 0, -1));
            if (!(glm::length(direction) > 1e-12))
                return error(pointer + "/direction", "the direction has no length");
            Node node;
            node.name = light.name;
            node.light = static_cast<std::uint32_t>(out_.scene.lights.size());
            node.transform = looking(l.position.value_or(glm::dvec3(0)), direction, {0, 1, 0});
            out_.scene.lights.push_back(std::move(light));
            out_.scene.nodes.push_back(std::move(node));
        }
        return {};
    }

    Step add_orbit(const CameraSpec& c) {
        if (c.position || c.target)
            return error("/camera", "'orbit' circles the scene; it takes no position or target");
        if (c.up && !(c.up->x == 0 && c.up->z == 0 && c.up->y > 0))
            return error("/camera/up", "'orbit' keeps +Y up; give 'position' and 'target' instead");
        OrbitCamera& orbit = out_.orbit.emplace();
        orbit.azimuth = c.orbit->azimuth * degrees;
        orbit.elevation = c.orbit->elevation * degrees;
        orbit.distance = c.orbit->distance;
        if (c.fov) orbit.yfov = *c.fov * degrees;
        orbit.height = c.height;
        orbit.znear = c.near;
        orbit.zfar = c.far;
        return {};
    }

    Step add_camera(const SceneSpec& spec) {
        if (!spec.camera) return {};
        const CameraSpec& c = *spec.camera;
        if (c.fov && c.height)
            return error("/camera/fov",
                         "is an angle of perspective; 'height' makes the camera orthographic, give "
                         "one of them");
        const double near = c.near.value_or(0.01), far = c.far.value_or(0);
        if (far > 0 && far <= near && (c.near || !c.orbit))
            return error("/camera/far", "'far' must lie beyond 'near'");
        if (c.orbit) return add_orbit(c);
        if (!c.position || !c.target)
            return error("/camera", "a camera needs 'position' and 'target', or 'orbit'");
        const glm::dvec3 direction = *c.target - *c.position;
        if (!(glm::length(direction) > 0))
            return error("/camera/target", "the target is where the camera stands; move one");
        const glm::dvec3 up = c.up.value_or(glm::dvec3(0, 1, 0));
        if (!(glm::length(glm::cross(direction, up)) >
              1e-9 * glm::length(direction) * glm::length(up)))
            return error("/camera/up", "'up' is zero or points along the view; choose another");
        Camera camera;
        camera.perspective = !c.height.has_value();
        camera.yfov = c.fov.value_or(45) * degrees;
        if (c.height) {
            camera.xmag = 0;  // pictures of any form show this height
            camera.ymag = *c.height / 2;
        }
        camera.znear = near;
        camera.zfar = far;
        Node node;
        node.name = "camera";
        node.camera = static_cast<std::uint32_t>(out_.scene.cameras.size());
        node.transform = looking(*c.position, direction, up);
        out_.scene.cameras.push_back(camera);
        out_.scene.active_camera = static_cast<std::uint32_t>(out_.scene.nodes.size());
        out_.scene.nodes.push_back(std::move(node));
        return {};
    }

    std::filesystem::path path_;
    LoadOptions options_;
    bool opens_files_;
    detail::PictureSearch pictures_{path_.parent_path(), options_.texture_directories};
    JsonScene out_;
    Names textures_, materials_, part_names_;
    std::vector<MergedPart> parts_;
    std::map<std::size_t, JsonMeshFile> mesh_files_;  // by part, until a node places it
    ReadFiles files_;
    std::uint64_t generated_faces_ = 0;
};

Result<JsonScene> parse_text(std::string_view text, const std::filesystem::path& path,
                             const LoadOptions& options, bool opens_files) {
    constexpr std::size_t most = std::size_t(64) << 20;
    if (text.size() > most)
        return Error{ErrorCode::limit,
                     "a scene file of more than 64 MiB; keep meshes in files of "
                     "their own and refer to them",
                     path.string()};
    Json json;
    if (const std::optional<schema::ParseProblem> problem = schema::parse(text, json))
        return Error{ErrorCode::syntax, problem->text,
                     path.string() + ":" + std::to_string(problem->line) + ":" +
                         std::to_string(problem->column)};
    if (!json.is_object() || !json.contains("meshprep"))
        return Error{ErrorCode::invalid,
                     "not a meshprep scene: expected an object with the key \"meshprep\": 1",
                     path.string() + "#"};
    SceneSpec spec;
    if (const schema::Outcome problem = schema::read_object(json, "", scene_table(), spec))
        return Error{ErrorCode::invalid, problem->text, path.string() + "#" + problem->pointer};
    if (spec.version != 1)
        return Error{ErrorCode::unsupported,
                     "the scene is of version " + std::to_string(spec.version) +
                         "; this build reads version 1",
                     path.string() + "#/meshprep"};
    if (spec.meshes.empty())
        return Error{ErrorCode::invalid, "the scene has no meshes; add one under \"meshes\"",
                     path.string() + "#"};
    Result<JsonScene> built = Builder(path, options, opens_files).build(spec);
    if (built) detail::contain_pictures(built->scene, options);
    return built;
}

Result<JsonScene> load_file(const std::filesystem::path& path, const LoadOptions& options,
                            bool opens_files) {
    const Result<std::vector<std::byte>> bytes = read_file(path);
    if (!bytes) return bytes.error();
    return parse_text({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, path, options,
                      opens_files);
}

}  // namespace

Result<JsonScene> parse_scene_json(std::string_view text, const std::filesystem::path& path,
                                   const LoadOptions& options) {
    return parse_text(text, path, options, true);
}

Result<JsonScene> load_scene_json(const std::filesystem::path& path, const LoadOptions& options) {
    return load_file(path, options, true);
}

Result<JsonScene> load_scene_json_alone(const std::filesystem::path& path) {
    return load_file(path, {}, false);
}

}  // namespace prep
