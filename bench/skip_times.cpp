// skip_times SCENE|MESH [ROUNDS]: what each thing that a plan leaves out saves. The picture is
// drawn as planned and with that one thing put back, in turn, on one thread; processor time,
// medians.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "plan/draw_choice.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/scene_json.h"
#include "rast/render.h"

namespace {

double processor_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

// Also those that were proved to change nothing.
void read_maps(const prep::Scene& scene, std::size_t material, rast::RenderPlan& plan) {
    if (!plan.request.textures) return;
    for (const prep::MaterialMap& map : prep::material_maps) {
        const std::size_t slot = rast::detail::texture_slot(scene.textures.size(), map.kind,
                                                            scene.materials[material].*map.ref);
        if (slot < plan.textures_read.size()) plan.textures_read[slot] = true;
    }
}

template <class T>
T value_of(prep::Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "skip_times: %s\n", to_string(result.error()).c_str());
        std::exit(1);
    }
    return *std::move(result);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// Draws its plan again and again; what it reads is read once.
class Side {
  public:
    Side(const prep::PreparedScene& scene, rast::RenderPlan plan)
        : renderer_(scene), plan_(std::move(plan)) {
        draw();
    }
    double draw() {
        const double start = processor_ms();
        if (const auto done = renderer_.render(plan_, frame_); !done) {
            std::fprintf(stderr, "skip_times: %s\n", to_string(done.error()).c_str());
            std::exit(1);
        }
        return processor_ms() - start;
    }

  private:
    rast::SceneRenderer renderer_;
    rast::RenderPlan plan_;
    rast::Frame frame_;
};

struct Skip {
    std::string name;
    std::function<void(rast::RenderPlan&)> put_back;
};

std::vector<Skip> skips_of(const rast::RenderPlan& plan, const prep::Scene& scene) {
    std::vector<Skip> out;
    for (const rast::PlanStep& step : plan.steps)
        for (std::size_t k = 0, l = 0;
             step.kind == rast::PlanStepKind::lights && k < plan.lights.size(); ++k) {
            if (plan.lights[k].kind == prep::LightKind::ambient) continue;
            ++l;  // its reason, after the step's own
            if (!plan.skips.light(k) || l >= step.reasons.size()) continue;
            out.push_back({prep::sentence(step.reasons[l], scene),
                           [k](rast::RenderPlan& p) { p.skips.lights[k] = false; }});
        }
    for (std::size_t m = 0; m < plan.skips.materials.size(); ++m) {
        const rast::PlanSkips::OfMaterial& of = plan.skips.materials[m];
        const std::string name = "'" + scene.materials[m].name + "'";
        if (of.highlights)
            out.push_back({"highlights of " + name,
                           [m](rast::RenderPlan& p) { p.skips.materials[m].highlights = false; }});
        if (of.mask)
            out.push_back({"the mask of " + name,
                           [m](rast::RenderPlan& p) { p.skips.materials[m].mask = false; }});
        if (of.maps != 0)
            out.push_back({"maps of " + name, [m, &scene](rast::RenderPlan& p) {
                               p.skips.materials[m].maps = 0;
                               read_maps(scene, m, p);
                           }});
    }
    if (plan.skips.inside_samples)
        out.push_back({"samples inside a triangle",
                       [](rast::RenderPlan& p) { p.skips.inside_samples = false; }});
    out.push_back({"all of it", [&scene](rast::RenderPlan& p) {
                       p.skips = {};
                       for (std::size_t m = 0; m < scene.materials.size(); ++m)
                           read_maps(scene, m, p);
                   }});
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        std::fprintf(stderr, "skip_times: needs a scene or a mesh\n");
        return 2;
    }
    const int rounds = argc > 2 ? std::max(std::atoi(argv[2]), 1) : 41;
    const std::string path = argv[1];
    prep::Scene loaded;
    rast::RenderRequest request;
    request.width = 640;
    request.height = 360;
    request.samples = 4;
    if (path.ends_with(".json")) {
        prep::JsonScene scene = value_of(prep::load_scene_json(path));
        prep::RenderChoices& choices = request;
        choices = prep::with_wishes(choices, scene.picture);
        loaded = std::move(scene.scene);
    } else {
        loaded = value_of(prep::load_scene(path));
    }
    request.threads = 1;
    const prep::PreparedScene scene = value_of(prep::prepare(std::move(loaded)));
    rast::SceneRenderer reader(scene);
    request.texel_facts = reader.texel_facts(value_of(rast::plan(scene, request)));
    const rast::RenderPlan plan = value_of(rast::plan(scene, request));
    Side planned(scene, plan);
    for (const Skip& skip : skips_of(plan, scene.scene)) {
        rast::RenderPlan more = plan;
        skip.put_back(more);
        Side full(scene, more);
        std::vector<double> with, without, apart;
        for (int r = 0; r < rounds; ++r) {
            without.push_back(planned.draw());
            with.push_back(full.draw());
            apart.push_back(with.back() - without.back());
        }
        std::printf("%8.3f ms saved, %8.3f to %8.3f: %s\n", median(apart), median(without),
                    median(with), skip.name.c_str());
    }
    request.prune = false;
    Side bare(scene, value_of(rast::plan(scene, request)));
    std::vector<double> apart, with;
    for (int r = 0; r < rounds; ++r) {
        const double without = planned.draw();
        with.push_back(bare.draw());
        apart.push_back(with.back() - without);
    }
    std::printf("%8.3f ms saved, to %8.3f: what nothing reads or asks for as well\n", median(apart),
                median(with));
}
