#include "baking/surface_truth.h"

#include "tessellation/limit/limit_base.h"
#include "tessellation/polygon_surface.h"

namespace prep::detail {

Result<std::unique_ptr<const SurfaceTruth>> SurfaceTruth::make(const Mesh& cage,
                                                               TessellateOptions options) {
    auto truth = std::make_unique<SurfaceTruth>();
    truth->options_ = std::move(options);
    const TessellateOptions& o = truth->options_;
    if (o.scheme) {
        SubdivideOptions subdivision = o.subdivision;
        subdivision.scheme = *o.scheme;
        subdivision.threads = o.threads;
        auto made = LimitBase::make(cage, subdivision, false);
        if (!made) return std::move(made).error();
        auto base = std::make_unique<LimitBase>(*std::move(made));
        truth->domain_ = make_domain(cage, base->left_out(), false, o.threads);
        base->set_domain(truth->domain_);
        truth->base_ = std::move(base);
    } else {
        truth->domain_ = make_domain(cage, {}, true, o.threads);
        auto made = PolygonSurface::make(cage, truth->domain_, o.hard_edges, o.threads);
        if (!made) return std::move(made).error();
        truth->base_ = std::make_unique<PolygonSurface>(*std::move(made));
    }
    auto heights = RootHeights::make(cage, truth->domain_, *truth->base_, o);
    if (!heights) return std::move(heights).error();
    truth->heights_ = *std::move(heights);
    truth->surface_ = std::make_unique<DisplacedSurface>(*truth->base_, truth->heights_);
    return std::unique_ptr<const SurfaceTruth>(std::move(truth));
}

}  // namespace prep::detail
