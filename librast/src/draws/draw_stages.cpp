#include "draws/draw_stages.h"

namespace rast::detail {
namespace {

StageRequest request_of(const ShadeDraw& draw) {
    StageRequest r;
    r.source = draw.source;
    r.unlit = draw.unlit;
    r.highlights = draw.highlights;
    r.metallic_roughness = draw.metallic_roughness;
    r.glows = draw.glows;
    r.vertex_light = !draw.unlit && draw.vertex_light != nullptr;
    r.vertex_colors = draw.colors != nullptr;
    r.map_count = draw.used_count;
    for (std::size_t m = 0; m < draw.used_count; ++m) {
        const BoundMap& map = draw.maps[draw.used[m]];
        r.maps[m] = {draw.used[m], map.place, map.same_texels};
    }
    return r;
}

}  // namespace

void StageLists::begin(const RenderPlan& plan, const ShadeFrame& frame) {
    plan_ = &plan;
    lists_.clear();
    local_lights_.clear();
    for (std::size_t l = 0; l < frame.light_count; ++l)
        local_lights_.push_back(frame.lights[l].kind != prep::LightKind::directional);
}

void StageLists::bind(bool has_uvs, ShadeDraw& draw) {
    const RenderRequest& asked = plan_->request;
    StageRequest r = request_of(draw);
    r.in_full = !asked.prune;
    if (asked.keep_color) draw.color_stages = list_of(r);
    r.color = false;
    r.normals = asked.keep_normals;
    r.uvs = asked.keep_uvs && has_uvs;
    r.weights = asked.keep_barycentrics;
    r.positions = asked.keep_positions;
    if (r.normals || asked.keep_uvs || r.weights || r.positions) draw.attribute_stages = list_of(r);
}

const StageList* StageLists::list_of(const StageRequest& request) {
    const auto found = lists_.find(request);
    if (found != lists_.end()) return &found->second;
    return &lists_.emplace(request, stages_for(request, local_lights_)).first->second;
}

}  // namespace rast::detail
