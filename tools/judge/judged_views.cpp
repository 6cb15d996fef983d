#include "judge/judged_views.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "cost/measure/flip.h"
#include "judge/silhouettes.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace judge {
namespace {

rast::View view_from(const glm::dvec3& direction, const ViewFrame& frame) {
    rast::View view;
    const glm::dvec3 up = std::abs(direction.y) > 0.99 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
    view.world_to_view =
        glm::lookAt(frame.centre + 4.0 * frame.radius * direction, frame.centre, up);
    view.perspective = false;
    view.half_height = ViewFrame::margin * frame.radius;
    view.aspect = 1;
    // What the second file has beyond the first one's ball is seen as well.
    view.znear = 0.01 * frame.radius;
    view.zfar = 8 * frame.radius;
    return view;
}

// Of the meshes of these names alone.
prep::Scene scoped(prep::Scene scene, const std::vector<std::string>& meshes) {
    if (meshes.empty()) return scene;
    for (prep::Node& node : scene.nodes) {
        if (node.mesh == prep::no_index) continue;
        if (std::find(meshes.begin(), meshes.end(), scene.meshes[node.mesh].name) == meshes.end())
            node.mesh = prep::no_index;
    }
    return scene;
}

rast::RenderRequest request_of(const rast::View& view, const JudgeOptions& options) {
    rast::RenderRequest request;
    request.width = request.height = options.size;
    request.view = view;
    request.threads = options.threads;
    return request;
}

// One of the two scenes, drawn again and again.
class Drawn {
  public:
    explicit Drawn(const prep::PreparedScene& scene) : scene_(scene), renderer_(scene) {}

    prep::Result<CoverageMap> outline(const rast::View& view, const JudgeOptions& options) {
        rast::RenderRequest request = request_of(view, options);
        request.coverage = rast::Coverage::area;
        request.alpha_alone = true;
        request.shading = rast::Shading::flat;
        request.cull = rast::Cull::none;
        request.textures = false;
        const prep::Result<rast::RenderPlan> plan = rast::plan(scene_, request);
        if (!plan) return plan.error();
        rast::Frame frame;
        if (const auto drawn = renderer_.render(*plan, frame); !drawn) return drawn.error();
        CoverageMap map{frame.width, frame.height, {}};
        map.covered.reserve(frame.color.size());
        for (const glm::vec4& c : frame.color) map.covered.push_back(c.a);
        return map;
    }

    prep::Result<prep::Image> picture(const rast::View& view, const JudgeOptions& options) {
        rast::RenderRequest request = request_of(view, options);
        request.samples = 4;
        request.background = glm::vec3(0.18f);
        // The lights stand with the view, so that both are lit alike whatever lights they bring.
        request.lights = rast::three_light_setup(view);
        const prep::Result<rast::RenderPlan> plan = rast::plan(scene_, request);
        if (!plan) return plan.error();
        rast::Frame frame;
        if (const auto drawn = renderer_.render(*plan, frame); !drawn) return drawn.error();
        return rast::to_srgb(frame, plan->request, options.threads);
    }

  private:
    const prep::PreparedScene& scene_;
    rast::SceneRenderer renderer_;
};

cost::Pixels encoded_pixels(const prep::Image& image) {
    cost::Pixels pixels{image.width, image.height, 3, {}};
    pixels.values.assign(image.pixels.begin(), image.pixels.end());
    return pixels;
}

// Black is equal, white as different as can be.
prep::Image flip_picture(const cost::Flip& flip, std::uint32_t width, std::uint32_t height) {
    prep::Image image{width, height, 3, {}, true};
    for (const double e : flip.errors) image.pixels.insert(image.pixels.end(), 3, float(e));
    return image;
}

}  // namespace

std::vector<glm::dvec3> view_directions(std::uint32_t count) {
    std::vector<glm::dvec3> out;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::uint32_t i = 0; i < count; ++i) {
        const double y = 1 - (2.0 * i + 1) / count, r = std::sqrt(1 - y * y);
        out.emplace_back(r * std::cos(i * golden), y, r * std::sin(i * golden));
    }
    return out;
}

prep::Result<std::vector<ViewJudged>> judged_views(const prep::Scene& a, const prep::Scene& b,
                                                   const ViewFrame& frame, bool flip,
                                                   const JudgeOptions& options) {
    prep::PrepareOptions prepare;
    prepare.threads = options.threads;
    const prep::Result<prep::PreparedScene> pa = prep::prepare(scoped(a, options.meshes), prepare);
    if (!pa) return pa.error();
    const prep::Result<prep::PreparedScene> pb = prep::prepare(scoped(b, options.meshes), prepare);
    if (!pb) return pb.error();
    Drawn drawn_a(*pa), drawn_b(*pb);
    std::vector<ViewJudged> out;
    for (const glm::dvec3& direction : view_directions(options.views)) {
        const rast::View view = view_from(direction, frame);
        ViewJudged& judged = out.emplace_back();
        judged.direction = direction;
        const auto ca = drawn_a.outline(view, options), cb = drawn_b.outline(view, options);
        if (!ca) return ca.error();
        if (!cb) return cb.error();
        const OutlineShift shift = outline_shift(*ca, *cb);
        judged.outline = shift.pixels;
        judged.x = shift.x;
        judged.y = shift.y;
        if (!flip && !options.pictures) continue;
        const auto ia = drawn_a.picture(view, options), ib = drawn_b.picture(view, options);
        if (!ia) return ia.error();
        if (!ib) return ib.error();
        cost::Flip error;
        if (ia->pixels == ib->pixels)  // which FLIP calls equal as well, but not as fast
            error.errors.resize(std::size_t(ia->width) * ia->height);
        else
            error = cost::flip(encoded_pixels(*ia), encoded_pixels(*ib));
        judged.compared_flip = true;
        judged.flip = error.mean;
        if (!options.pictures) continue;
        judged.difference = flip_picture(error, ia->width, ia->height);
        judged.a = *ia;
        judged.b = *ib;
    }
    return out;
}

}  // namespace judge
