#include "meshprep/output/load_options.h"

#include "meshprep/files/file_list.h"
#include "prep/image.h"

namespace meshprep {

prep::LoadOptions load_options(const CommonOptions& common, Console& console) {
    prep::LoadOptions options = common.load;
    options.threads = common.threads;
    options.reader_process = common.reader_process;
    if (common.verbose)
        options.reader_log = [&console](const std::filesystem::path& file, std::string_view text) {
            console.note(file.string(), text);
        };
    return options;
}

prep::Result<prep::JsonScene> load_json_scene(const std::filesystem::path& path,
                                              const prep::LoadOptions& options) {
    if (lower_ending(path) == "json") return prep::load_scene_json(path, options);
    prep::Result<prep::Scene> scene = prep::load_scene(path, options);
    if (!scene) return scene.error();
    return prep::JsonScene{*std::move(scene), {}, {}, {}};
}

prep::PrepareOptions prepare_options(const prep::PrepareOptions& given,
                                     const prep::LoadOptions& load, int threads) {
    prep::PrepareOptions options = given;
    options.threads = threads;
    if (options.displacement.map) {
        prep::ImageOptions image;
        image.reader_process = load.reader_process;
        image.reader_log = load.reader_log;
        options.displacement.map->options = std::make_shared<const prep::ImageOptions>(image);
    }
    return options;
}

}  // namespace meshprep
