#include "meshprep/commands/cost_picture.h"

#include <algorithm>

#include "meshprep/commands/render_views.h"
#include "prep/prepare.h"
#include "rast/exposure.h"

namespace meshprep {

prep::Result<cost::ScenePicture> scene_picture(prep::JsonScene loaded, bool scene_file,
                                               int threads) {
    const bool own_lights =
        !scene_file &&
        std::any_of(loaded.scene.nodes.begin(), loaded.scene.nodes.end(),
                    [](const prep::Node& node) { return node.light != prep::no_index; });
    prep::PrepareOptions options;
    options.threads = threads;
    prep::Result<prep::PreparedScene> prepared = prep::prepare(std::move(loaded.scene), options);
    if (!prepared) return prepared.error();
    cost::ScenePicture out;
    out.scene = std::make_shared<const prep::PreparedScene>(*std::move(prepared));
    const CameraWishes camera;
    const auto views = views_of({camera, 0, loaded.orbit}, *out.scene,
                                double(cost::scene_width) / cost::scene_height);
    if (!views) return views.error();
    prep::RenderChoices& choices = out.request;
    choices = with_wishes(choices, loaded.picture);
    // Samples are the ladder's.
    choices.coverage = prep::Coverage::samples;
    choices.samples = choices.supersample = 1;
    choices.width = cost::scene_width;
    choices.height = cost::scene_height;
    out.request.view = views->front();
    out.request.threads = threads;
    if (!own_lights && choices.exposure != prep::automatic_exposure) {
        rast::expose(choices, choices.exposure);
        return out;
    }
    rast::SceneRenderer renderer(*out.scene);
    const auto found = rast::find_exposure(renderer, *out.scene, out.request);
    if (!found) return found.error();
    rast::expose(choices, found->exposure);
    return out;
}

}  // namespace meshprep
