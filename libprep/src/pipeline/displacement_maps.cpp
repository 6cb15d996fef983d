#include "pipeline/displacement_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "displacement/noise_field.h"
#include "tessellation/height_functions.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

// Every one of the faces has UVs in the set.
Result<void> check_uvs(const ChartFaces& faces, const std::string& picture) {
    const Mesh& mesh = *faces.mesh;
    const std::size_t uv_set = faces.uv_set;
    const bool has_set = uv_set < mesh.uvs.size() && !mesh.uvs[uv_set].empty();
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        if (!faces.has(f)) continue;
        for (Index c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            if (!has_set || mesh.uvs[uv_set].indices[c] == no_index)
                return Error{ErrorCode::invalid,
                             fmt::format("face {} has no UVs in set {}, at which {} is read: "
                                         "displacement by a map needs them",
                                         f, uv_set, picture),
                             mesh.name.empty() ? "" : fmt::format("mesh '{}'", mesh.name)};
    }
    return {};
}

// Positions are about the mesh's origin; noise is about that of its space, so that it does not
// depend on where the mesh's middle is.
class NoiseAbout final : public SpaceFunction {
  public:
    NoiseAbout(std::shared_ptr<const SpaceFunction> noise, const glm::dvec3& origin)
        : noise_(std::move(noise)), origin_(origin) {}
    Sample at(const glm::dvec3& p) const override { return noise_->at(origin_ + p); }
    double steepest() const override { return noise_->steepest(); }
    double change(double distance) const override { return noise_->change(distance); }
    double deviation(const std::array<glm::dvec3, 3>& p) const override {
        const std::array<glm::dvec3, 3> at{origin_ + p[0], origin_ + p[1], origin_ + p[2]};
        // What the sums lose, here and in at().
        double farthest = 0;
        for (const glm::dvec3& q : at) farthest = std::max(farthest, glm::length(q));
        const double lost = change(farthest * 0x1p-51);
        return lost + noise_->deviation(at);
    }

  private:
    std::shared_ptr<const SpaceFunction> noise_;
    glm::dvec3 origin_;
};

// By how much a band limit moves a noise's heights at most.
double band_limit_change(NoiseOptions options, double band_limit) {
    options.sample_spacing = band_limit;
    const auto field = NoiseField::make(options);
    return field ? field->left_out() : 0;
}

std::shared_ptr<const HeightFunction> function_of(const HeightMap& map, const ChartFaces& faces,
                                                  int threads) {
    return height_function(map, faces, threads);
}
std::shared_ptr<const VectorFunction> function_of(const VectorMap& map, const ChartFaces& faces,
                                                  int threads) {
    return vector_function(map, faces, threads);
}

}  // namespace

ChartFaces DisplacementMaps::Reading::faces(const Surface& surface) const {
    return {&surface.mesh, uv_set, materials, surface.is_limit};
}

bool DisplacementMaps::Reading::is_read_as(const Reading& other) const {
    const TextureRef &a = map.placement, &b = other.map.placement;
    return kind == other.kind && uv_set == other.uv_set && map.channel == other.map.channel &&
           map.filter == other.map.filter && map.wrap_u == other.map.wrap_u &&
           map.wrap_v == other.map.wrap_v && map.scale == other.map.scale &&
           map.midlevel == other.map.midlevel && a.offset == b.offset && a.scale == b.scale &&
           a.rotation == b.rotation;
}

Result<const Image*> DisplacementMaps::picture(const ImageRef& ref) {
    std::unique_ptr<const Image>& known = pictures_[&ref];
    if (!known) {
        auto image = load_image(ref);
        if (!image) return image.error();
        known = std::make_unique<const Image>(*std::move(image));
    }
    return known.get();
}

Result<DisplacementMaps::Surface> DisplacementMaps::surface(
    const Mesh& mesh, const SubdivideOptions* subdivision) const {
    Surface surface{mesh, subdivision != nullptr, {}};
    if (!(options_.band_limit > 0) || !subdivision) return surface;
    surface.face_areas.assign(mesh.face_count(), 0);
    constexpr std::size_t many_faces = 50'000;
    SubdivideOptions options = *subdivision;
    options.level = mesh.face_count() < many_faces ? 2 : 1;
    options.control_points = false;
    options.threads = threads_;
    const auto refined = subdivide(mesh, options);
    if (!refined) return refined.error();
    const std::vector<double> areas = fan_areas(refined->mesh);
    for (std::size_t f = 0; f < areas.size(); ++f)
        surface.face_areas[refined->cage_faces[f]] += areas[f];
    return surface;
}

template <class Map, class Function>
Result<Function> DisplacementMaps::function(const Map& map, const Reading& as,
                                            const Surface& surface, OfMesh& to, Function& as_read) {
    const ChartFaces faces = as.faces(surface);
    const auto of = [&](const Map& read) { return function_of(read, faces, threads_); };
    if (!(options_.band_limit > 0)) {
        to.changes.push_back(0);
        return of(map);
    }
    auto limited = band_limited(map, faces, options_.band_limit, surface.face_areas, threads_);
    if (!limited) return std::move(limited).error();
    to.changes.push_back(limited->change);
    if (keeps_as_read()) as_read = of(map);
    return of(limited->map);
}

Result<Displacement> DisplacementMaps::read(const ImageRef& image, const Reading& as,
                                            const std::string& name, const Surface& surface,
                                            OfMesh& to) {
    Displacement made{.height = nullptr, .uv_set = as.uv_set}, as_read = made;
    const auto named = [&](Error error) {
        if (error.place.empty()) error.place = name;
        return error;
    };
    if (as.kind == DisplacementKind::height) {
        if (!maps_.contains(as.key())) {
            const auto pixels = picture(image);
            if (!pixels) return pixels.error();
            auto map = HeightMap::make(**pixels, as.map);
            if (!map) return named(std::move(map).error());
            maps_.emplace(as.key(), *std::move(map));
        }
        const HeightMap& map = maps_.at(as.key());
        to.quantisations.push_back(map.quantisation());
        auto height = function(map, as, surface, to, as_read.height);
        if (!height) return named(std::move(height).error());
        made.height = *std::move(height);
    } else {
        if (!vector_maps_.contains(as.key())) {
            const auto pixels = picture(image);
            if (!pixels) return pixels.error();
            VectorMapOptions options{.map = as.map, .axes = VectorAxes::object};
            if (as.kind == DisplacementKind::vector_tangent) options.axes = options_.axes;
            // Files of floats hold vectors as they are.
            if (as.default_midlevel && (*pixels)->integer_bits == 0) options.map.midlevel = 0;
            auto map = VectorMap::make(**pixels, options);
            if (!map) return named(std::move(map).error());
            vector_maps_.emplace(as.key(), *std::move(map));
        }
        const VectorMap& map = vector_maps_.at(as.key());
        to.quantisations.push_back(map.quantisation());
        auto vector = function(map, as, surface, to, as_read.vector);
        if (!vector) return named(std::move(vector).error());
        made.vector = *std::move(vector);
        made.tangent_space = as_read.tangent_space = !map.in_object_space();
    }
    if (keeps_as_read()) to.as_read.push_back(std::move(as_read));
    return made;
}

Result<void> DisplacementMaps::add(const ImageRef& image, const Reading& as, const Surface& surface,
                                   OfMesh& to) {
    const std::string name = !image.path.empty()   ? image.path.filename().string()
                             : !image.name.empty() ? image.name
                                                   : "an embedded picture";
    if (auto checked = check_uvs(as.faces(surface), name); !checked) return checked.error();
    auto made = read(image, as, name, surface, to);
    if (!made) return std::move(made).error();
    to.names.push_back(name);
    to.displacements.push_back(*std::move(made));
    return {};
}

Result<DisplacementMaps::OfMesh> DisplacementMaps::of(const Scene& scene, const Mesh& mesh,
                                                      const SubdivideOptions* subdivision) {
    OfMesh out;
    const double band_limit = options_.band_limit;
    if (!(band_limit >= 0) || !std::isfinite(band_limit))
        return Error{ErrorCode::invalid, "the band limit of heights must be a positive number", ""};
    HeightMapOptions heights = options_.heights;
    heights.threads = threads_;
    heights.midlevel = options_.midlevel.value_or(HeightMapOptions{}.midlevel);
    if (options_.axes == VectorAxes::object)
        return Error{ErrorCode::invalid,
                     "the axes of vector maps in tangent space cannot be those of object space: "
                     "say that the map's kind is vector-object",
                     ""};
    std::shared_ptr<const SpaceFunction> noise;
    if (options_.noise && options_.from_materials)
        return Error{ErrorCode::invalid,
                     "noise moves all faces, alone or with one map for all: it is not added to "
                     "materials' maps",
                     ""};
    std::shared_ptr<const SpaceFunction> noise_as_read;
    for (const bool limited : {true, false}) {
        if (!options_.noise || (!limited && !keeps_as_read())) continue;
        NoiseOptions as = *options_.noise;
        as.sample_spacing = limited ? band_limit : 0;
        auto made = noise_function(as);
        if (!made) return std::move(made).error();
        (limited ? noise : noise_as_read) =
            mesh.origin == glm::dvec3(0.0)
                ? *std::move(made)
                : std::make_shared<NoiseAbout>(*std::move(made), mesh.origin);
    }
    const auto surface =
        this->surface(mesh, options_.map || options_.from_materials ? subdivision : nullptr);
    if (!surface) return surface.error();
    if (options_.map) {
        const Reading as{.kind = options_.kind,
                         .map = heights,
                         .uv_set = options_.uv_set,
                         .default_midlevel = !options_.midlevel};
        if (auto added = add(*options_.map, as, *surface, out); !added) return added.error();
    }
    if (noise) {
        if (out.displacements.empty()) out.displacements.emplace_back();
        out.displacements[0].noise = noise;
        if (keeps_as_read()) {
            out.as_read.resize(1);
            out.as_read[0].noise = noise_as_read;
        }
        out.changes.push_back(band_limit_change(*options_.noise, band_limit));
        out.names.push_back(std::string(name_of(options_.noise->kind)) + " noise");
        out.quantisations.emplace_back();
    }
    if (options_.map || noise || !options_.from_materials) return out;
    out.material_displacements.assign(scene.materials.size(), no_index);
    std::vector<bool> used(scene.materials.size(), false);
    for (const Index m : mesh.face_materials)
        if (m < used.size()) used[m] = true;
    std::vector<std::pair<const ImageRef*, Reading>> groups;
    for (Index m = 0; m < scene.materials.size(); ++m) {
        const Material& material = scene.materials[m];
        const TextureRef& ref = material.displacement_map;
        if (!used[m] || ref.texture >= scene.textures.size()) continue;
        const Texture& texture = scene.textures[ref.texture];
        if (texture.image >= scene.images.size()) continue;
        HeightMapOptions of_material = heights;
        of_material.wrap_u = texture.wrap_u;
        of_material.wrap_v = texture.wrap_v;
        of_material.placement = ref;
        of_material.scale *= double(material.displacement_scale) * double(ref.strength);
        of_material.midlevel = options_.midlevel.value_or(double(material.displacement_midlevel));
        const Reading as{.kind = material.displacement_kind,
                         .map = of_material,
                         .uv_set = ref.uv_set,
                         .materials = {m}};
        // One picture that is read alike is one surface's, however many materials have it: what is
        // beyond a border is no gutter.
        const ImageRef* const image = &scene.images[texture.image];
        auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& known) {
            return known.first == image && known.second.is_read_as(as);
        });
        if (group == groups.end())
            groups.emplace_back(image, as);
        else
            group->second.materials.push_back(m);
        used_.insert(m);
    }
    for (const auto& [image, as] : groups) {
        for (const Index m : as.materials)
            out.material_displacements[m] = Index(out.displacements.size());
        if (auto added = add(*image, as, *surface, out); !added) return added.error();
    }
    if (out.displacements.empty()) out.material_displacements.clear();
    return out;
}

void DisplacementMaps::forget(PreparedScene& prepared) const {
    Scene& scene = prepared.scene;
    std::map<Index, Index> kept;  // by material the first mesh that is to be displaced yet
    for (Index i = 0; i < scene.meshes.size(); ++i)
        if (!prepared.tessellated[i])
            for (const Index m : scene.meshes[i].face_materials)
                if (used_.contains(m)) kept.emplace(m, i);
    for (const Index m : used_) {
        if (!scene.materials[m].displacement_map) continue;
        const auto found = kept.find(m);
        if (found == kept.end()) {
            scene.materials[m].displacement_map = {};
            continue;
        }
        Finding finding;
        finding.kind = "displacement-map-kept";
        finding.severity = Severity::warning;
        finding.mesh = found->second;
        finding.place_kind = PlaceKind::face;
        const auto& faces = scene.meshes[found->second].face_materials;
        finding.count = std::uint64_t(std::count(faces.begin(), faces.end(), m));
        finding.text = fmt::format(
            "faces of this mesh are not displaced, so material '{}' keeps its displacement map, "
            "which has moved other meshes already: do not displace those again",
            scene.materials[m].name);
        prepared.findings.push_back(std::move(finding));
    }
}

}  // namespace prep::detail
