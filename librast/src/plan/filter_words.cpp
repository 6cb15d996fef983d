#include "plan/filter_words.h"

#include <map>

namespace rast::detail {
namespace {

std::string words_of(TextureFilter filter, int max_anisotropy) {
    const std::string most = std::to_string(max_anisotropy);
    switch (filter) {
        case TextureFilter::by_sampler:
            return "as no filter of another name: one to eight reads a sample";
        case TextureFilter::nearest:
            return "nearest texel: one read a sample";
        case TextureFilter::bilinear:
            return "bilinear: four reads a sample, first level only";
        case TextureFilter::nearest_mip:
            return "nearest mip: four reads on the mip level nearest to the footprint";
        case TextureFilter::trilinear:
            return "trilinear: four reads on each of two mip levels";
        case TextureFilter::bicubic:
            return "bicubic: 16 reads on each of two mip levels";
        case TextureFilter::anisotropic:
            return "anisotropic: up to " + most + " trilinear probes";
        case TextureFilter::ripmap:
            return "ripmap: up to four bilinear reads of levels halved along either axis";
        case TextureFilter::ewa:
            return "elliptical weighted average: ellipses up to " + most + " to 1";
    }
    return {};
}

}  // namespace

std::string filter_words(const RenderRequest& request, const std::vector<TextureFilter>& used) {
    if (request.filter != TextureFilter::by_sampler)
        return words_of(request.filter, request.max_anisotropy);
    std::map<TextureFilter, std::size_t> found;
    for (const TextureFilter filter : used) ++found[filter];
    std::string text;
    for (const auto& [filter, count] : found) {
        text += text.empty() ? "by the samplers, " : "; ";
        if (found.size() > 1) text += std::to_string(count) + " × ";
        text += words_of(filter, request.max_anisotropy);
    }
    return text;
}

}  // namespace rast::detail
