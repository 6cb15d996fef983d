#include "pipeline/displacement_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

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

std::shared_ptr<const HeightFunction> function_of(const HeightMap& map,
                                                  std::span<const ChartFaces> faces, int threads) {
    return height_function(map, faces, threads);
}
std::shared_ptr<const VectorFunction> function_of(const VectorMap& map,
                                                  std::span<const ChartFaces> faces, int threads) {
    return vector_function(map, faces, threads);
}

// For each image the first one of the same pixels, as far as that can be seen without decoding.
std::vector<Index> first_alike(const std::vector<ImageRef>& images) {
    std::vector<Index> out;
    std::map<std::filesystem::path, Index> known;
    for (Index i = 0; i < images.size(); ++i) {
        const bool is_file = !images[i].path.empty() && images[i].bytes.empty();
        out.push_back(is_file ? known.emplace(images[i].path, i).first->second : i);
    }
    return out;
}

std::string name_of_picture(const ImageRef& image) {
    return !image.path.empty()   ? image.path.filename().string()
           : !image.name.empty() ? image.name
                                 : "an embedded picture";
}

// Those that some face has, ascending.
std::vector<Index> used_materials(const Mesh& mesh, std::size_t count) {
    std::vector<bool> used(count, false);
    for (const Index m : mesh.face_materials)
        if (m < count) used[m] = true;
    std::vector<Index> out;
    for (Index m = 0; m < count; ++m)
        if (used[m]) out.push_back(m);
    return out;
}

}  // namespace

std::string DisplacementMaps::Reading::key() const {
    std::string out;
    const auto put = [&](const auto& value) {
        out.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const TextureRef& at = map.placement;
    for (const std::uint32_t whole :
         {image, uv_set, std::uint32_t(kind), std::uint32_t(map.filter), std::uint32_t(map.wrap_u),
          std::uint32_t(map.wrap_v), std::uint32_t(map.channel)})
        put(whole);
    for (const double number : {map.scale, map.midlevel, double(at.offset.x), double(at.offset.y),
                                double(at.scale.x), double(at.scale.y), double(at.rotation)})
        put(number);
    return out;
}

Result<const Image*> DisplacementMaps::picture(const Scene& scene, Index image) {
    std::unique_ptr<const Image>& known = pictures_[image];
    if (!known) {
        auto loaded = load_image(image == no_index ? *options_.map : scene.images[image]);
        if (!loaded) return loaded.error();
        known = std::make_unique<const Image>(*std::move(loaded));
    }
    return known.get();
}

// One picture that is read alike is one surface's, however many materials and meshes have it: what
// is beyond a border is no gutter.
void DisplacementMaps::find_readings(const Scene& scene, const HeightMapOptions& heights) {
    if (std::exchange(found_, true)) return;
    if (options_.map) {
        readings_.push_back({.kind = options_.kind,
                             .map = heights,
                             .uv_set = options_.uv_set,
                             .default_midlevel = !options_.midlevel});
        return;
    }
    reading_of_.assign(scene.materials.size(), no_index);
    const std::vector<Index> pictures = first_alike(scene.images);
    std::vector<bool> used(scene.materials.size(), false);
    std::vector<std::vector<Index>> of_meshes;
    for (const Mesh& mesh : scene.meshes) {
        of_meshes.push_back(used_materials(mesh, scene.materials.size()));
        for (const Index m : of_meshes.back()) used[m] = true;
    }
    std::unordered_map<std::string, Index> known;
    for (Index m = 0; m < scene.materials.size(); ++m) {
        const Material& material = scene.materials[m];
        const TextureRef& ref = material.displacement_map;
        if (!used[m] || ref.texture >= scene.textures.size()) continue;
        const Texture& texture = scene.textures[ref.texture];
        if (texture.image >= scene.images.size()) continue;
        Reading as{.image = pictures[texture.image],
                   .kind = material.displacement_kind,
                   .map = heights,
                   .uv_set = ref.uv_set};
        as.map.wrap_u = texture.wrap_u;
        as.map.wrap_v = texture.wrap_v;
        as.map.placement = ref;
        as.map.scale *= double(material.displacement_scale) * double(ref.strength);
        as.map.midlevel = options_.midlevel.value_or(double(material.displacement_midlevel));
        const auto [at, fresh] = known.emplace(as.key(), Index(readings_.size()));
        reading_of_[m] = at->second;
        if (fresh) readings_.push_back(std::move(as));
    }
    for (Index mesh = 0; mesh < of_meshes.size(); ++mesh)
        for (const Index m : of_meshes[mesh])
            if (reading_of_[m] != no_index) readings_[reading_of_[m]].materials[mesh].push_back(m);
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

template <class Map>
auto DisplacementMaps::confined(const Scene& scene, const Reading& as, const Map& map,
                                bool of_cages) const {
    std::vector<ChartFaces> faces;
    for (const auto& [mesh, materials] : as.materials)
        faces.push_back({&scene.meshes[mesh], as.uv_set, materials, of_cages});
    if (as.materials.empty())
        for (const Mesh& mesh : scene.meshes) faces.push_back({&mesh, as.uv_set, {}, of_cages});
    return function_of(map, faces, threads_);
}

Result<void> DisplacementMaps::make_heights(const Scene& scene, Reading& as, bool of_cages) {
    if (as.heights || as.confined.height) return {};
    const auto pixels = picture(scene, as.image);
    if (!pixels) return pixels.error();
    auto map = HeightMap::make(**pixels, as.map);
    if (!map) return std::move(map).error();
    as.precision = map->precision();
    if (reads_confined()) as.confined.height = confined(scene, as, *map, of_cages);
    if (options_.band_limit > 0) as.heights = *std::move(map);
    return {};
}

Result<void> DisplacementMaps::make_vectors(const Scene& scene, Reading& as, bool of_cages) {
    if (as.vectors || as.confined.vector) return {};
    const auto pixels = picture(scene, as.image);
    if (!pixels) return pixels.error();
    VectorMapOptions options{.map = as.map, .axes = VectorAxes::object};
    if (as.kind == DisplacementKind::vector_tangent) options.axes = options_.axes;
    // Files of floats hold vectors as they are.
    if (as.default_midlevel && (*pixels)->integer_bits == 0) options.map.midlevel = 0;
    auto map = VectorMap::make(**pixels, options);
    if (!map) return std::move(map).error();
    as.precision = map->precision();
    as.in_object_space = map->in_object_space();
    if (reads_confined()) as.confined.vector = confined(scene, as, *map, of_cages);
    if (options_.band_limit > 0) as.vectors = *std::move(map);
    return {};
}

template <class Map>
auto DisplacementMaps::limited(const Map& map, const ChartFaces& faces, const Surface& surface,
                               OfMesh& to) const {
    using Function = decltype(function_of(map, {&faces, 1}, threads_));
    auto made = band_limited(map, faces, options_.band_limit, surface.face_areas, threads_);
    if (!made) return Result<Function>(std::move(made).error());
    to.changes.push_back(made->change);
    return Result<Function>(function_of(made->map, {&faces, 1}, threads_));
}

Result<Displacement> DisplacementMaps::read(const Scene& scene, Reading& as,
                                            const ChartFaces& faces, const Surface& surface,
                                            OfMesh& to) {
    const bool heights = as.kind == DisplacementKind::height;
    auto made = heights ? make_heights(scene, as, surface.is_limit)
                        : make_vectors(scene, as, surface.is_limit);
    if (!made) return std::move(made).error();
    to.precisions.push_back(as.precision);
    Displacement out = as.confined;
    out.uv_set = as.uv_set;
    out.tangent_space = !heights && !as.in_object_space;
    if (keeps_as_read()) to.as_read.push_back(out);
    if (!(options_.band_limit > 0)) {
        to.changes.push_back(0);
    } else if (heights) {
        auto height = limited(*as.heights, faces, surface, to);
        if (!height) return std::move(height).error();
        out.height = *std::move(height);
    } else {
        auto vector = limited(*as.vectors, faces, surface, to);
        if (!vector) return std::move(vector).error();
        out.vector = *std::move(vector);
    }
    return out;
}

Result<void> DisplacementMaps::add(const Scene& scene, Reading& as,
                                   std::span<const Index> materials, const Surface& surface,
                                   OfMesh& to) {
    const std::string name =
        name_of_picture(as.image == no_index ? *options_.map : scene.images[as.image]);
    const ChartFaces faces{&surface.mesh, as.uv_set, materials, surface.is_limit};
    if (auto checked = check_uvs(faces, name); !checked) return checked.error();
    auto made = read(scene, as, faces, surface, to);
    if (!made) {
        Error error = std::move(made).error();
        if (error.place.empty()) error.place = name;
        return error;
    }
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
    if (options_.map || options_.from_materials) find_readings(scene, heights);
    if (options_.map)
        if (auto added = add(scene, readings_[0], {}, *surface, out); !added) return added.error();
    if (noise) {
        if (out.displacements.empty()) out.displacements.emplace_back();
        out.displacements[0].noise = noise;
        if (keeps_as_read()) {
            out.as_read.resize(1);
            out.as_read[0].noise = noise_as_read;
        }
        out.changes.push_back(band_limit_change(*options_.noise, band_limit));
        out.names.push_back(std::string(name_of(options_.noise->kind)) + " noise");
        out.precisions.emplace_back();
    }
    if (options_.map || noise || !options_.from_materials) return out;
    out.material_displacements.assign(scene.materials.size(), no_index);
    std::vector<std::pair<Index, std::vector<Index>>> groups;  // a reading and its materials
    std::map<Index, std::size_t> group_of;                     // by reading
    // Materials of residual maps, which come later, have none.
    for (const Index m : used_materials(mesh, reading_of_.size())) {
        if (reading_of_[m] == no_index) continue;
        used_.insert(m);
        const auto [at, fresh] = group_of.emplace(reading_of_[m], groups.size());
        if (fresh) groups.push_back({reading_of_[m], {}});
        groups[at->second].second.push_back(m);
    }
    for (const auto& [reading, materials] : groups) {
        for (const Index m : materials)
            out.material_displacements[m] = Index(out.displacements.size());
        auto added = add(scene, readings_[reading], materials, *surface, out);
        if (!added) return std::move(added).error();
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
