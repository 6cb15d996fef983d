#include <prep/image.h>
#include <prep/prep.h>
#include <prep/version.h>
#include <rast/render.h>
#include <rast/version.h>

#include <cstdio>

int main(int, char** argv) {
    auto scene = prep::load_scene(argv[1]);
    if (!scene) return std::puts(to_string(scene.error()).c_str()), 1;
    const auto prepared = prep::prepare(std::move(*scene));
    const auto frame = rast::render(*prepared, *rast::plan(*prepared));
    // Pictures are a library of their own, which must be found from here.
    const auto png = prep::encode_png({1, 1, 1, {0.5f}});
    if (!png) return std::puts(to_string(png.error()).c_str()), 1;
    // So must readers of other libraries, here and in a process of theirs: what is wrong is the
    // file.
    if (std::FILE* const file = std::fopen("damaged.dae", "w"))
        std::fclose((std::fputs("<", file), file));
    prep::LoadOptions contained;
    contained.reader_process = std::make_shared<prep::ReaderProcess>();
    for (const prep::LoadOptions& options : {prep::LoadOptions(), contained}) {
        const auto damaged = prep::load_scene("damaged.dae", options);
        if (damaged || damaged.error().code != prep::ErrorCode::syntax)
            return std::puts(damaged ? "a scene of nothing" : to_string(damaged.error()).c_str()),
                   1;
    }
    std::printf("prep %s, rast %s: %zu vertices from %zu, %s\n", prep::version().data(),
                rast::version().data(), prepared->meshes[0].vertex_count(),
                prepared->scene.meshes[0].vertex_count(),
                frame->counters.pixels_shaded > 10000 ? "drawn" : "nothing drawn");
}
