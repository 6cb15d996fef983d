#include "meshprep/options/render_names.h"

namespace meshprep {

const Words<rast::Shading>& shading_words() {
    static const Words<rast::Shading> words = {{"flat", rast::Shading::flat},
                                               {"gouraud", rast::Shading::gouraud},
                                               {"phong", rast::Shading::phong},
                                               {"normal-mapped", rast::Shading::normal_mapped}};
    return words;
}

const Words<rast::Cull>& cull_words() {
    static const Words<rast::Cull> words = {{"by-material", rast::Cull::by_material},
                                            {"back", rast::Cull::back},
                                            {"front", rast::Cull::front},
                                            {"none", rast::Cull::none}};
    return words;
}

const Words<rast::TextureFilter>& filter_words() {
    static const Words<rast::TextureFilter> words = {
        {"sampler", rast::TextureFilter::by_sampler},
        {"nearest", rast::TextureFilter::nearest},
        {"bilinear", rast::TextureFilter::bilinear},
        {"nearest-mip", rast::TextureFilter::nearest_mip},
        {"trilinear", rast::TextureFilter::trilinear},
        {"bicubic", rast::TextureFilter::bicubic},
        {"anisotropic", rast::TextureFilter::anisotropic},
        {"ripmap", rast::TextureFilter::ripmap},
        {"ewa", rast::TextureFilter::ewa}};
    return words;
}

const Words<rast::Coverage>& coverage_words() {
    static const Words<rast::Coverage> words = {{"samples", rast::Coverage::samples},
                                                {"area", rast::Coverage::area}};
    return words;
}

const Words<Buffer>& buffer_words() {
    static const Words<Buffer> words = {{"depth", Buffer::depth},
                                        {"id", Buffer::id},
                                        {"normal", Buffer::normal},
                                        {"uv", Buffer::uv},
                                        {"barycentric", Buffer::barycentric},
                                        {"position", Buffer::position}};
    return words;
}

}  // namespace meshprep
