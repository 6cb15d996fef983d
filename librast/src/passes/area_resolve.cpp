#include "passes/area_resolve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "coverage/area_coverage.h"
#include "passes/parallel_tiles.h"

namespace rast::detail {
namespace {

// The visible part of a triangle on the screen, in pixels from the picture's centre.
struct ScreenPolygon {
    std::array<glm::dvec2, 4> corner;
    std::uint32_t count = 0;
    std::uint32_t draw = 0, id = 0;
    glm::dvec2 anchor{0.0};
    DepthPlane depth;                             // about the anchor
    std::int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels of the window that it may reach
};

struct Corner {
    glm::dvec2 at{0.0};
    double depth = 0;
};

// Through the three corners that span the most: a clipped corner may lie beside another.
bool depth_plane(const std::array<Corner, 4>& corners, std::uint32_t count, ScreenPolygon& out) {
    static constexpr std::uint32_t triples[][3] = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {1, 2, 3}};
    double most = 0;
    for (std::uint32_t k = 0; k < (count == 4 ? 4u : 1u); ++k) {
        const Corner &a = corners[triples[k][0]], &b = corners[triples[k][1]],
                     &c = corners[triples[k][2]];
        const glm::dvec2 u = b.at - a.at, v = c.at - a.at;
        const double area = cross(u, v);
        if (!(std::abs(area) > most)) continue;
        most = std::abs(area);
        const double du = b.depth - a.depth, dv = c.depth - a.depth;
        out.anchor = a.at;
        out.depth = {a.depth, (du * v.y - dv * u.y) / area, (dv * u.x - du * v.x) / area};
    }
    return most > 0 && std::isfinite(out.depth({0.0, 0.0})) && std::isfinite(out.depth({1.0, 1.0}));
}

// False: nothing of it is to be drawn.
bool visible_part(const RenderInstance& instance, const std::uint32_t index[3], bool mirrored,
                  CullSide cull, ScreenPolygon& out) {
    std::array<Corner, 4> corners;
    std::uint32_t count = 0;
    const auto full = [&](std::uint32_t v) {
        const VertexRecord& record = instance.records[v];
        const ScreenVertex h = instance.homogeneous(v);
        Corner c{{h.x / h.w, h.y / h.w}, h.z / h.w};
        if (record.x > first_valid)
            c.at = {double(record.x) / subpixels, double(record.y) / subpixels};
        return c;
    };
    for (int k = 0; k < 3; ++k)
        if (instance.records[index[k]].x == mark_non_finite) return false;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = index[k], b = index[k == 2 ? 0 : k + 1];
        const ScreenVertex va = instance.homogeneous(a), vb = instance.homogeneous(b);
        const bool a_in = va.w > 0 && va.w - va.z >= 0, b_in = vb.w > 0 && vb.w - vb.z >= 0;
        if (a_in) corners[count++] = full(a);
        if (a_in == b_in) continue;
        // From the lower vertex, so that both triangles of an edge are cut at the same point.
        const ScreenVertex &from = a < b ? va : vb, &to = a < b ? vb : va;
        const double df = from.w - from.z, dt = to.w - to.z, s = df / (df - dt);
        const double w = from.w + s * (to.w - from.w);
        if (!(w > 0)) return false;
        corners[count++] = {
            {(from.x + s * (to.x - from.x)) / w, (from.y + s * (to.y - from.y)) / w}, 1.0};
    }
    for (std::uint32_t k = 0; k < count; ++k)  // beyond double's range: nowhere
        if (!std::isfinite(corners[k].at.x) || !std::isfinite(corners[k].at.y) ||
            !std::isfinite(corners[k].depth))
            return false;
    if (count < 3 || !depth_plane(corners, count, out)) return false;
    double area = 0;
    for (std::uint32_t k = 2; k < count; ++k)
        area += cross(corners[k - 1].at - corners[0].at, corners[k].at - corners[0].at);
    // y points down: what is counter-clockwise in the world has a negative area here.
    const bool back = (area < 0) == mirrored;
    if (!(area != 0) || (cull == CullSide::back && back) || (cull == CullSide::front && !back))
        return false;
    out.count = count;
    for (std::uint32_t k = 0; k < count; ++k) out.corner[k] = corners[k].at;
    out.id = back ? id_back_face : 0;
    return true;
}

// Pixels of the window whose squares the polygon may touch; none: false.
bool find_box(const Window& window, ScreenPolygon& p) {
    glm::dvec2 low = p.corner[0], high = p.corner[0];
    for (std::uint32_t k = 1; k < p.count; ++k) {
        low = glm::min(low, p.corner[k]);
        high = glm::max(high, p.corner[k]);
    }
    const auto pixel = [](double v, std::int32_t first, std::int32_t extent) {
        const double at = std::floor(v - (double(first) / subpixels - 0.5));
        return std::int32_t(std::clamp(at, -1.0, double(extent)));
    };
    p.x0 = std::max(pixel(low.x, window.first_x, window.width), 0);
    p.y0 = std::max(pixel(low.y, window.first_y, window.height), 0);
    p.x1 = std::min(pixel(high.x, window.first_x, window.width), window.width - 1);
    p.y1 = std::min(pixel(high.y, window.first_y, window.height), window.height - 1);
    return p.x0 <= p.x1 && p.y0 <= p.y1;
}

class Resolver {
  public:
    Resolver(const CoverageScene& scene, const Window& window, int threads, Frame& frame)
        : scene_(scene), window_(window), threads_(threads), frame_(frame) {}

    TileCounts run() {
        collect();
        std::vector<TileCounts> counts(window_.tile_count());
        parallel_items(window_.tile_count(), threads_, [&](std::size_t tile) {
            const PartTimer timer(scene_.clock(), DrawingPart::areas);
            counts[tile] = draw_tile(std::uint32_t(tile));
        });
        TileCounts sum;
        for (const TileCounts& c : counts) sum += c;
        return sum;
    }

  private:
    void collect() {
        const PartTimer timer(scene_.clock(), DrawingPart::areas);
        tiles_.resize(window_.tile_count());
        for (std::uint32_t d = 0; d < scene_.draws->size(); ++d) {
            const Draw& draw = (*scene_.draws)[d];
            const RenderInstance& instance = (*scene_.instances)[draw.instance];
            for (std::uint32_t t = 0; t < draw.triangle_count; ++t) {
                ScreenPolygon p;
                const std::uint32_t* index =
                    instance.mesh().indices.data() + std::size_t(draw.first_triangle + t) * 3;
                if (!visible_part(instance, index, instance.mirrored(), scene_.cull[d], p) ||
                    !find_box(window_, p))
                    continue;
                p.draw = d;
                p.id |= (*scene_.shade_draws)[d].first_id + t;
                for (std::int32_t y = p.y0 / tile_size; y <= p.y1 / tile_size; ++y)
                    for (std::int32_t x = p.x0 / tile_size; x <= p.x1 / tile_size; ++x)
                        tiles_[std::size_t(y) * std::size_t(window_.tiles_x) + std::size_t(x)]
                            .push_back(std::uint32_t(polygons_.size()));
                polygons_.push_back(p);
            }
        }
    }

    TileCounts draw_tile(std::uint32_t tile) const {
        const std::int32_t left = std::int32_t(tile) % window_.tiles_x * tile_size;
        const std::int32_t top = std::int32_t(tile) / window_.tiles_x * tile_size;
        const std::int32_t right = std::min(left + tile_size, window_.width);
        const std::int32_t bottom = std::min(top + tile_size, window_.height);
        std::vector<std::vector<std::uint32_t>> lists(tile_pixels);
        for (const std::uint32_t n : tiles_[tile]) {
            const ScreenPolygon& p = polygons_[n];
            for (std::int32_t y = std::max(p.y0, top); y <= std::min(p.y1, bottom - 1); ++y)
                for (std::int32_t x = std::max(p.x0, left); x <= std::min(p.x1, right - 1); ++x)
                    lists[std::size_t((y - top) * tile_size + x - left)].push_back(n);
        }
        TileCounts counts;
        PixelCoverage coverage;
        for (std::int32_t y = top; y < bottom; ++y)
            for (std::int32_t x = left; x < right; ++x)
                counts += draw_pixel(x, y, lists[std::size_t((y - top) * tile_size + x - left)],
                                     coverage);
        return counts;
    }

    TileCounts draw_pixel(std::int32_t x, std::int32_t y, std::vector<std::uint32_t>& list,
                          PixelCoverage& coverage) const {
        if (list.empty()) return {};
        const std::int32_t corner_x = window_.first_x + x * subpixels - subpixels / 2;
        const std::int32_t corner_y = window_.first_y + y * subpixels - subpixels / 2;
        const glm::dvec2 corner(double(corner_x) / subpixels, double(corner_y) / subpixels);
        const auto plane = [&](const ScreenPolygon& p) {
            DepthPlane local = p.depth;
            local.at = p.depth(corner - p.anchor);
            return local;
        };
        const auto grid = [](double v) { return std::int32_t(std::floor(v * subpixels + 0.5)); };
        coverage.clear();
        PixelCoverage::Polygon local, inside;
        // Whether a polygon counts; `local` is its corners then.
        const auto covers = [&](const ScreenPolygon& p) {
            local.clear();
            for (std::uint32_t k = 0; k < p.count; ++k) local.push_back(p.corner[k] - corner);
            const ShadeDraw& draw = (*scene_.shade_draws)[p.draw];
            // A mask that is left out takes the same way: slivers are dropped by the same rounding.
            const std::uint32_t material = (*scene_.draws)[p.draw].material;
            if (!draw.masked && !scene_.plan->skips.of(material).mask) return true;
            glm::dvec2 at;
            return PixelCoverage::clip_to_pixel(local, inside, at) &&
                   (!draw.masked || scene_.kernels->covers(draw, corner_x + grid(at.x),
                                                           corner_y + grid(at.y), p.id));
        };
        glm::vec4& pixel = frame_.color[std::size_t(y) * frame_.width + std::size_t(x)];
        if (scene_.plan->request.alpha_alone) {
            for (const std::uint32_t n : list)
                if (covers(polygons_[n]) && !coverage.add_to_union(local, plane(polygons_[n])))
                    break;
            pixel = glm::vec4(0, 0, 0, float(1 - coverage.empty_area()));
            return {};
        }
        // From front to back, which makes the fewest pieces.
        std::vector<std::pair<double, std::uint32_t>> order;
        for (const std::uint32_t n : list) order.emplace_back(-plane(polygons_[n])({0.5, 0.5}), n);
        std::sort(order.begin(), order.end());
        for (const auto& [depth, n] : order)
            if (covers(polygons_[n]))
                coverage.add(local, plane(polygons_[n]), n);  // numbered in the order of drawing
        glm::dvec4 sum(glm::dvec3(scene_.plan->request.background), 0.0);
        const glm::dvec4 empty = sum;
        TileCounts counts;
        for (const PixelCoverage::Share& share : coverage.shares()) {
            const ScreenPolygon& p = polygons_[share.owner];
            const glm::vec3 color =
                shade(p, corner_x + grid(share.centroid.x), corner_y + grid(share.centroid.y));
            sum += (glm::dvec4(glm::dvec3(color), 1.0) - empty) * share.area;
            counts.add_points(*(*scene_.shade_draws)[p.draw].color_stages, 1);
        }
        pixel = glm::vec4(sum);
        return counts;
    }

    glm::vec3 shade(const ScreenPolygon& p, std::int32_t x, std::int32_t y) const {
        std::array<std::array<float, tile_padding + 1>, 3> out;
        const std::array<std::uint16_t, tile_padding + 1> pixels{};
        const TriangleRun run{p.id, 1};
        ShadeTask task;
        task.place = {x, y, 1, 1, {}, true};
        task.pixels = pixels.data();
        task.runs = &run;
        task.run_count = 1;
        task.watch = scene_.plan->watch;
        for (std::size_t c = 0; c < 3; ++c) task.out[c] = out[c].data();
        scene_.kernels->shade((*scene_.shade_draws)[p.draw], *scene_.shade_frame, task);
        return {out[0][0], out[1][0], out[2][0]};
    }

    const CoverageScene& scene_;
    const Window& window_;
    int threads_;
    Frame& frame_;
    std::vector<ScreenPolygon> polygons_;
    std::vector<std::vector<std::uint32_t>> tiles_;
};

}  // namespace

TileCounts resolve_coverage(const CoverageScene& scene, const Window& window, int threads,
                            Frame& frame) {
    return Resolver(scene, window, threads, frame).run();
}

}  // namespace rast::detail
