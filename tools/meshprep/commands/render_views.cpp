#include "meshprep/commands/render_views.h"

#include <algorithm>
#include <numbers>

namespace meshprep {
namespace {

using prep::Error;
using prep::ErrorCode;
using prep::Result;

// A node with a camera, by the node's or the camera's name, or the n-th of them.
Result<std::uint32_t> find_camera(const prep::Scene& scene, const std::string& text) {
    std::vector<std::uint32_t> nodes;
    std::string names;
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].camera == prep::no_index) continue;
        const std::string& camera = scene.cameras[scene.nodes[n].camera].name;
        if (scene.nodes[n].name == text || camera == text) return n;
        const std::string& name = scene.nodes[n].name.empty() ? camera : scene.nodes[n].name;
        names += (nodes.empty() ? "" : ", ") + std::to_string(nodes.size()) +
                 (name.empty() ? "" : " '" + name + "'");
        nodes.push_back(n);
    }
    if (!text.empty() && text.find_first_not_of("0123456789") == std::string::npos &&
        text.size() < 10) {
        const auto index = static_cast<std::size_t>(std::stoul(text));
        if (index < nodes.size()) return nodes[index];
    }
    return Error{
        ErrorCode::invalid,
        "no camera '" + text + "' in the scene; " +
            (nodes.empty() ? "it has none: give --camera AZIMUTH,ELEVATION" : "it has " + names),
        scene.source.string()};
}

// Through a camera of the file, whose near plane is its own.
bool is_of_file(const ViewChoices& choices, const prep::Scene& scene) {
    const CameraChoice& camera = choices.camera.camera;
    if (std::holds_alternative<std::string>(camera)) return true;
    return camera.index() == 0 && !choices.orbit && scene.active_camera != prep::no_index;
}

// The scene file's orbit, where nothing else is asked for.
const prep::OrbitCamera* orbit_of_file(const ViewChoices& choices) {
    return choices.camera.camera.index() == 0 && choices.orbit ? &*choices.orbit : nullptr;
}

// What of its lens the command line leaves open is the file's.
CameraWishes wishes_of(const ViewChoices& choices) {
    CameraWishes wishes = choices.camera;
    const prep::OrbitCamera* const orbit = orbit_of_file(choices);
    if (orbit == nullptr || wishes.ortho_height) return wishes;
    wishes.ortho_height = orbit->height;
    if (!wishes.yfov) wishes.yfov = orbit->yfov;
    return wishes;
}

// Those of the file's orbit that it names, before or behind which the other one moves; another
// projection has its own.
void set_planes(rast::View& view, const ViewChoices& choices) {
    const prep::OrbitCamera* const orbit = orbit_of_file(choices);
    if (orbit == nullptr || choices.camera.ortho_height) return;
    if (orbit->zfar) {
        view.zfar = *orbit->zfar;
        if (view.zfar > 0) view.znear = std::min(view.znear, view.zfar / 2);
    }
    if (orbit->znear) {
        view.znear = *orbit->znear;
        if (!orbit->zfar && view.zfar > 0) view.zfar = std::max(view.zfar, 2 * view.znear);
    }
}

// As prepared meshes have them, those that faces have: lines and points are not drawn.
std::vector<glm::vec3> drawn_positions(const prep::Mesh& mesh) {
    std::vector<bool> drawn(mesh.positions.size(), false);
    for (const std::uint32_t v : mesh.corner_vertices) drawn[v] = true;
    std::vector<glm::vec3> positions;
    for (std::size_t v = 0; v < drawn.size(); ++v)
        if (drawn[v]) positions.push_back(mesh.positions[v]);
    return positions;
}

// Views from all around the scene, each made anew, so that its near plane fits.
class Viewer {
  public:
    Viewer(const ViewChoices& choices, const prep::PreparedScene& prepared, double aspect)
        : wishes_(wishes_of(choices)),
          prepared_(prepared),
          aspect_(aspect),
          count_(std::max<std::uint32_t>(choices.turntable, 1)) {
        const std::optional<rast::Bounds> bounds = rast::world_bounds(prepared);
        if (bounds) centre_ = bounds->centre();
    }

    std::vector<rast::View> orbits(const OrbitChoice& choice) const {
        rast::OrbitOptions options;
        options.elevation_degrees = choice.elevation;
        options.aspect = aspect_;
        if (wishes_.yfov) options.yfov = *wishes_.yfov;
        const auto at = [&](std::uint32_t n) {
            options.azimuth_degrees = choice.azimuth + 360.0 * n / count_;
            return rast::orbit_view(prepared_, options);
        };
        if (choice.distance != 1 || count_ > 1) {
            // One distance for all of them: the scene must not pulse as it turns.
            double fitting = 0;
            for (std::uint32_t n = 0; n < count_; ++n)
                fitting = std::max(fitting, glm::length(at(n).eye() - centre_));
            options.distance = choice.distance * fitting;
        }
        std::vector<rast::View> views;
        for (std::uint32_t n = 0; n < count_; ++n) views.push_back(at(n));
        return views;
    }

    std::vector<rast::View> places(const PlaceChoice& choice) const {
        std::vector<rast::View> views;
        for (std::uint32_t n = 0; n < count_; ++n) {
            rast::LookAtOptions options;
            options.eye = turned(choice.from, n);
            options.target = turned(choice.at.value_or(centre_), n);
            options.up = turned_direction(choice.up, n);
            if (wishes_.yfov) options.yfov = *wishes_.yfov;
            views.push_back(rast::look_at_view(prepared_, options));
        }
        return views;
    }

    // What is said of the scene's centre was not known when the arguments were read.
    Result<std::vector<std::optional<rast::View>>> from_place(const PlaceChoice& choice) const {
        const glm::dvec3 view = choice.at.value_or(centre_) - choice.from;
        if (choice.up_given && !(glm::length(view) > 0))
            return Error{ErrorCode::invalid,
                         "--look-from is the scene's centre: say with --look-at where to look",
                         prepared_.scene.source.string()};
        const double lengths = glm::length(view) * glm::length(choice.up);
        if (choice.up_given && !(glm::length(glm::cross(view, choice.up)) > 1e-9 * lengths))
            return Error{ErrorCode::invalid,
                         "--up points along the view from --look-from to the scene's centre: "
                         "choose another, or another --look-at",
                         prepared_.scene.source.string()};
        return finished(places(choice));
    }

    Result<std::vector<rast::View>> cameras(std::uint32_t node) const {
        rast::View view = rast::camera_view(prepared_.scene, node, aspect_);
        if (wishes_.yfov && !view.perspective)
            return Error{ErrorCode::invalid,
                         "--fov is an angle of perspective, and the camera '" +
                             prepared_.scene.nodes[node].name +
                             "' has none: --ortho HEIGHT changes what it shows",
                         prepared_.scene.source.string()};
        if (wishes_.yfov) view.yfov = *wishes_.yfov;
        std::vector<rast::View> views;
        for (std::uint32_t n = 0; n < count_; ++n)
            views.push_back(n == 0 ? view : rast::turned_view(view, centre_, angle(n)));
        return views;
    }

    Result<std::vector<std::optional<rast::View>>> through_camera(std::uint32_t node) const {
        const Result<std::vector<rast::View>> views = cameras(node);
        if (!views) return views.error();
        return finished(*views);
    }

    // With the projection asked for.
    std::vector<std::optional<rast::View>> finished(const std::vector<rast::View>& views) const {
        std::vector<std::optional<rast::View>> out;
        double half_height = 0;
        for (rast::View view : views) {
            if (wishes_.ortho_height) {
                view = rast::orthographic_view(prepared_, view, *wishes_.ortho_height,
                                               view.aspect > 0 ? view.aspect : aspect_);
                half_height = std::max(half_height, view.half_height);
            }
            out.emplace_back(view);
        }
        for (std::optional<rast::View>& view : out)
            if (wishes_.ortho_height) view->half_height = half_height;
        return out;
    }

  private:
    double angle(std::uint32_t n) const { return 2 * std::numbers::pi * n / count_; }
    glm::dvec3 turned(const glm::dvec3& place, std::uint32_t n) const {
        if (n == 0) return place;
        return centre_ + turned_direction(place - centre_, n);
    }
    glm::dvec3 turned_direction(const glm::dvec3& p, std::uint32_t n) const {
        if (n == 0) return p;
        const double c = std::cos(angle(n)), s = std::sin(angle(n));
        return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
    }

    const CameraWishes wishes_;
    const prep::PreparedScene& prepared_;
    double aspect_;
    std::uint32_t count_;
    glm::dvec3 centre_{0.0};
};

}  // namespace

Result<std::vector<std::optional<rast::View>>> views_of(const ViewChoices& choices,
                                                        const prep::PreparedScene& prepared,
                                                        double aspect) {
    const Viewer viewer(choices, prepared, aspect);
    const CameraWishes& wishes = choices.camera;
    if (const auto* choice = std::get_if<OrbitChoice>(&wishes.camera))
        return viewer.finished(viewer.orbits(*choice));
    if (const auto* place = std::get_if<PlaceChoice>(&wishes.camera))
        return viewer.from_place(*place);
    if (const auto* name = std::get_if<std::string>(&wishes.camera)) {
        const Result<std::uint32_t> node = find_camera(prepared.scene, *name);
        if (!node) return node.error();
        return viewer.through_camera(*node);
    }
    if (const prep::OrbitCamera* const orbit = orbit_of_file(choices)) {
        if (wishes.yfov && orbit->height)
            return Error{ErrorCode::invalid,
                         "--fov is an angle of perspective, and the scene file's camera has none: "
                         "--ortho HEIGHT changes what it shows",
                         prepared.scene.source.string()};
        auto views = viewer.finished(
            viewer.orbits({orbit->azimuth / radians_per_degree,
                           orbit->elevation / radians_per_degree, orbit->distance}));
        for (std::optional<rast::View>& view : views) set_planes(*view, choices);
        return views;
    }
    if (choices.turntable == 0 && !wishes.yfov && !wishes.ortho_height)
        return std::vector<std::optional<rast::View>>(1);
    if (prepared.scene.active_camera != prep::no_index)
        return viewer.through_camera(prepared.scene.active_camera);
    return viewer.finished(viewer.orbits({}));
}

Result<std::vector<rast::View>> screen_views(const ViewChoices& choices, const prep::Scene& scene,
                                             double aspect) {
    // What cameras and frames read of it.
    prep::PreparedScene framed;
    framed.scene.source = scene.source;
    framed.scene.nodes = scene.nodes;
    framed.scene.cameras = scene.cameras;
    framed.scene.active_camera = scene.active_camera;
    for (const prep::Mesh& mesh : scene.meshes) {
        prep::VertexMesh& points = framed.meshes.emplace_back();
        points.positions = drawn_positions(mesh);
        points.origin = mesh.origin;
    }
    const Result<std::vector<std::optional<rast::View>>> chosen = views_of(choices, framed, aspect);
    if (!chosen) return chosen.error();
    std::vector<rast::View> views;
    for (const std::optional<rast::View>& view : *chosen) {
        if (view)
            views.push_back(*view);
        else if (scene.active_camera != prep::no_index)
            views.push_back(rast::camera_view(framed.scene, scene.active_camera, aspect));
        else
            views.push_back(rast::orbit_view(framed, {.aspect = aspect}));
    }
    if (is_of_file(choices, scene)) return views;
    constexpr double share_of_way = 1e-3;
    const std::optional<rast::Bounds> bounds = rast::world_bounds(framed);
    for (rast::View& view : views) {
        if (!bounds || !view.perspective) continue;
        const double way = glm::length(view.eye() - bounds->centre());
        view.znear = std::min(view.znear, share_of_way * std::max(way, bounds->radius()));
        set_planes(view, choices);
    }
    return views;
}

std::vector<prep::ScreenMetric> screen_metrics(const std::vector<rast::View>& views,
                                               std::uint32_t width, std::uint32_t height) {
    std::vector<prep::ScreenMetric> metrics;
    for (const rast::View& view : views) {
        const glm::dmat4 to_clip =
            rast::projection(view, view.aspect > 0 ? view.aspect : double(width) / height) *
            view.world_to_view;
        const glm::dmat4 rows = glm::transpose(to_clip);
        prep::ScreenMetric& metric = metrics.emplace_back();
        metric.x = rows[0];
        metric.y = rows[1];
        metric.w = rows[3];
        metric.pixels = {0.5 * width, 0.5 * height};
        // Without perspective all depths are 1.
        metric.near_distance = view.perspective ? view.znear : 0.5;
    }
    return metrics;
}

std::vector<std::optional<rast::View>> drawn_views(const std::vector<rast::View>& views,
                                                   const ViewChoices& choices,
                                                   const prep::PreparedScene& prepared,
                                                   double aspect) {
    std::vector<std::optional<rast::View>> drawn;
    const bool own_depths = is_of_file(choices, prepared.scene) && !choices.camera.ortho_height;
    for (const rast::View& view : views) {
        drawn.emplace_back(view.perspective || own_depths
                               ? view
                               : rast::orthographic_view(prepared, view, 2 * view.half_height,
                                                         view.aspect > 0 ? view.aspect : aspect));
        set_planes(*drawn.back(), choices);
    }
    return drawn;
}

}  // namespace meshprep
