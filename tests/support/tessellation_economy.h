// Triangles against error: an adaptive tessellation beside uniform grids of the same surface, whose
// errors are measured alike, as the largest distance to the truth at equal parameters over many
// points of each triangle.
//
// A uniform level k has 2 · 4ᵏ triangles a quad; on polygons and in Loop's scheme 4ᵏ a triangle; of
// other faces n · 2 · 4ᵏ⁻¹ (each corner's part of the face is a quad), at level 0 the n triangles
// of a fan, one of a triangle.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "base/parallel.h"
#include "tessellation/limit/limit_base.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"

namespace tessellation_checks {

// With MESHPREP_TABLES in the environment more is looked at: the tables of docs/displacement.md.
inline bool for_tables() {
    return std::getenv("MESHPREP_TABLES") != nullptr;
}

class Economy {
  public:
    // The domain is pointed at: it stays where it is.
    Economy(const Economy&) = delete;
    Economy& operator=(const Economy&) = delete;
    // Polygons without a scheme.
    Economy(prep::Mesh cage, std::optional<prep::SubdivisionScheme> scheme,
            prep::Displacement displacement)
        : cage_(std::move(cage)),
          whole_triangles_(!scheme || scheme == prep::SubdivisionScheme::loop) {
        using namespace prep::detail;
        options_.scheme = scheme;
        options_.samples = 0;
        if (displacement.height || displacement.noise)
            options_.displacements = {std::move(displacement)};
        if (scheme) {
            prep::SubdivideOptions subdivision;
            subdivision.scheme = *scheme;
            auto base = LimitBase::make(cage_, subdivision, true);
            EXPECT_TRUE(base);
            auto made = std::make_unique<LimitBase>(*std::move(base));
            domain_ = make_domain(cage_, made->left_out(), false, 0);
            made->set_domain(domain_);
            base_ = std::move(made);
        } else {
            domain_ = make_domain(cage_, {}, true, 0);
            auto base = PolygonSurface::make(cage_, domain_, {}, 0);
            EXPECT_TRUE(base);
            base_ = std::make_unique<PolygonSurface>(*std::move(base));
        }
        auto heights = RootHeights::make(cage_, domain_, *base_, options_);
        EXPECT_TRUE(heights);
        heights_ = *std::move(heights);
        surface_ = std::make_unique<DisplacedSurface>(*base_, heights_);
    }

    const prep::Mesh& cage() const { return cage_; }

    std::uint64_t uniform_triangles(int level) const {
        std::uint64_t sum = 0;
        for (std::uint32_t fan = 0; fan < domain_.fans(); ++fan) {
            const std::uint64_t n = corners(fan), grown = std::uint64_t(1) << 2 * level;
            sum += n == 4                                       ? 2 * grown
                   : n == 3 && (level == 0 || whole_triangles_) ? grown
                   : level == 0                                 ? n
                                                                : n * grown / 2;
        }
        return sum;
    }

    // At `each` points along a side of a grid's cell beside its corners; 0 where more than `enough`
    // was met: then some error beyond that.
    double uniform_error(int level, int each,
                         double enough = std::numeric_limits<double>::infinity()) const {
        std::atomic<bool> met{false};
        std::vector<double> errors(domain_.fans(), 0.0);
        prep::detail::parallel_blocks(domain_.fans(), 1, 0, [&](std::size_t begin, std::size_t) {
            const auto fan = std::uint32_t(begin);
            if (met) return;
            errors[fan] = face_error(fan, level, each, enough);
            if (errors[fan] > enough) met = true;
        });
        return errors.empty() ? 0 : *std::max_element(errors.begin(), errors.end());
    }

    struct Made {
        std::uint64_t triangles = 0;
        double error = 0, proved = 0;
        bool within_limit = true;
    };
    // Points along a triangle's side where triangles are few, so that all have 25,000 points, or
    // 100,000, together.
    static int points_of(std::uint64_t triangles) {
        const double all = for_tables() ? 100'000 : 25'000;
        return int(std::min(64.0, std::sqrt(2 * all / double(triangles))));
    }
    // `each`: points along a triangle's side, more where triangles are few; the 2 % of triangles
    // that are worst there, and never fewer than 200, are looked at with four times as many.
    Made adaptive(double asked, int each, std::uint64_t limit) {
        using namespace prep::detail;
        options_.chord_error = asked;
        options_.triangle_limit = limit;
        std::vector<TrianglePlace> places;
        TessellationHooks hooks;
        hooks.places = &places;
        const auto made = prep::detail::tessellate(cage_, options_, hooks);
        if (!made && made.error().code == prep::ErrorCode::limit) return {0, 0, 0, false};
        EXPECT_TRUE(made);
        Made out{made->mesh.face_count(), 0, made->certificate.proved};
        std::vector<std::pair<double, std::uint32_t>> errors(places.size());
        const auto look = [&](std::size_t begin, std::size_t end, int points) {
            for (std::size_t k = begin; k < end; ++k) {
                const std::uint32_t t = errors[k].second;
                errors[k].first =
                    std::max(errors[k].first, triangle_error(made->mesh, places[t], t, points));
            }
        };
        for (std::uint32_t t = 0; t < errors.size(); ++t) errors[t].second = t;
        const int points = std::max(each, points_of(places.size()));
        parallel_blocks(errors.size(), 64, 0,
                        [&](std::size_t b, std::size_t e) { look(b, e, points); });
        std::sort(errors.begin(), errors.end(), std::greater<>());
        const std::size_t worst =
            std::min(errors.size(), std::max<std::size_t>(200, errors.size() / 50));
        parallel_blocks(worst, 16, 0,
                        [&](std::size_t b, std::size_t e) { look(b, e, 4 * points); });
        for (const auto& [error, t] : errors) out.error = std::max(out.error, error);
        return out;
    }

  private:
    using Point = prep::detail::RootPoint;

    std::uint32_t corners(std::uint32_t fan) const {
        return domain_.fan_roots[fan + 1] - domain_.fan_roots[fan];
    }

    double triangle_error(const prep::Mesh& mesh, const prep::detail::TrianglePlace& place,
                          std::uint32_t t, int n) const {
        const prep::detail::TrianglePoints points(domain_, place.root, place.path);
        std::array<glm::dvec3, 3> v;
        for (std::size_t k = 0; k < 3; ++k)
            v[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[3 * t + k]]);
        std::vector<Point> at;
        std::vector<glm::dvec3> on;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i + j <= n; ++i) {
                const glm::dvec3 w(double(n - i - j) / n, double(i) / n, double(j) / n);
                at.push_back(points.at(w));
                on.push_back(w.x * v[0] + w.y * v[1] + w.z * v[2]);
            }
        return farthest(at, on);
    }

    double farthest(const std::vector<Point>& at, const std::vector<glm::dvec3>& on) const {
        std::vector<glm::dvec3> truths(at.size());
        surface_->truths(at, truths);
        double most = 0;
        for (std::size_t k = 0; k < at.size(); ++k)
            most = std::max(most, glm::length(on[k] - truths[k]));
        return most;
    }

    // A quad's parameters, from its first corner towards its second and its last.
    Point in_quad(std::uint32_t fan, const glm::dvec2& st) const {
        const glm::dvec2 p = 2.0 * st - 1.0;
        const auto weights = [](double along, double out) {
            return glm::dvec3((out - along) / 2, (out + along) / 2, 1 - out);
        };
        const std::uint32_t root = domain_.fan_roots[fan];
        if (-p.y >= std::abs(p.x)) return {root, weights(p.x, -p.y)};
        if (p.x >= std::abs(p.y)) return {root + 1, weights(p.y, p.x)};
        if (p.y >= std::abs(p.x)) return {root + 2, weights(-p.x, p.y)};
        return {root + 3, weights(-p.y, -p.x)};
    }
    // The part of corner k of another face: from it towards the middles of its edges, the next and
    // the one before.
    Point in_part(std::uint32_t fan, std::uint32_t k, const glm::dvec2& st) const {
        const std::uint32_t first = domain_.fan_roots[fan], n = corners(fan);
        const double least = std::min(st.x, st.y), across = std::abs(st.x - st.y) / 2;
        const double near = 1 - least - across;
        if (st.x >= st.y) return {first + k, {near, across, least}};
        return {first + (k + n - 1) % n, {across, near, least}};
    }
    // By weights of a triangle's corners.
    Point in_triangle(std::uint32_t fan, const glm::dvec3& w) const {
        const glm::length_t far = w.z <= w.x && w.z <= w.y ? 2 : w.x <= w.y ? 0 : 1;
        const glm::length_t a = (far + 1) % 3, b = (far + 2) % 3;
        return {domain_.fan_roots[fan] + std::uint32_t(a),
                {w[a] - w[far], w[b] - w[far], 3 * w[far]}};
    }

    double face_error(std::uint32_t fan, int level, int each, double enough) const {
        const std::uint32_t n = corners(fan);
        if (n == 4)
            return square_error(1 << level, each, enough,
                                [&](const glm::dvec2& st) { return in_quad(fan, st); });
        if (n == 3 && (level == 0 || whole_triangles_))
            return grid_error(1 << level, each,
                              [&](const glm::dvec3& w) { return in_triangle(fan, w); });
        double most = 0;
        for (std::uint32_t k = 0; k < n; ++k)
            most = std::max(
                most, level == 0
                          ? grid_error(1, 2 * each,
                                       [&](const glm::dvec3& w) {
                                           return Point{domain_.fan_roots[fan] + k, w};
                                       })
                          : square_error(1 << (level - 1), each, enough, [&](const glm::dvec2& st) {
                                return in_part(fan, k, st);
                            }));
        return most;
    }

    // Row by row of cells, each halved along the diagonal from its first corner.
    template <class At>
    double square_error(int n, int each, double enough, const At& at) const {
        const int side = n * each + 1;
        std::vector<Point> points(std::size_t(side) * std::size_t(each + 1));
        std::vector<glm::dvec3> truth(points.size());
        double most = 0;
        for (int y = 0; y < n && most <= enough; ++y) {
            const int from = y == 0 ? 0 : 1;  // the last row of points is the next one's first
            if (from == 1) std::copy(truth.end() - side, truth.end(), truth.begin());
            for (int j = from; j <= each; ++j)
                for (int i = 0; i < side; ++i)
                    points[std::size_t(j * side + i)] =
                        at(glm::dvec2(i, y * each + j) / double(n * each));
            const auto rest = std::size_t(from * side);
            surface_->truths(std::span(points).subspan(rest), std::span(truth).subspan(rest));
            for (int x = 0; x < n; ++x) {
                const auto t = [&](int i, int j) {
                    return truth[std::size_t(j * side + x * each + i)];
                };
                const glm::dvec3 a = rounded(t(0, 0)), b = rounded(t(each, 0));
                const glm::dvec3 c = rounded(t(each, each)), d = rounded(t(0, each));
                for (int j = 0; j <= each; ++j)
                    for (int i = 0; i <= each; ++i) {
                        const double u = double(i) / each, v = double(j) / each;
                        const glm::dvec3 on =
                            u >= v ? a + u * (b - a) + v * (c - b) : a + v * (d - a) + u * (c - d);
                        most = std::max(most, glm::length(on - t(i, j)));
                    }
            }
        }
        return most;
    }

    // A triangle in n² alike.
    template <class At>
    double grid_error(int n, int each, const At& at) const {
        double most = 0;
        std::vector<Point> points;
        std::vector<glm::dvec3> on;
        const auto corner = [&](int i, int j) { return glm::dvec3(n - i - j, i, j) / double(n); };
        const auto one = [&](const std::array<glm::dvec3, 3>& w) {
            std::array<glm::dvec3, 3> v;
            for (std::size_t k = 0; k < 3; ++k) v[k] = rounded(surface_->truth(at(w[k])));
            points.clear();
            on.clear();
            for (int j = 0; j <= each; ++j)
                for (int i = 0; i + j <= each; ++i) {
                    const glm::dvec3 p = glm::dvec3(each - i - j, i, j) / double(each);
                    points.push_back(at(p.x * w[0] + p.y * w[1] + p.z * w[2]));
                    on.push_back(p.x * v[0] + p.y * v[1] + p.z * v[2]);
                }
            most = std::max(most, farthest(points, on));
        };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i + j < n; ++i) {
                one({corner(i, j), corner(i + 1, j), corner(i, j + 1)});
                if (i + j + 1 < n) one({corner(i + 1, j + 1), corner(i, j + 1), corner(i + 1, j)});
            }
        return most;
    }

    static glm::dvec3 rounded(const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)); }

    prep::Mesh cage_;
    bool whole_triangles_;
    prep::TessellateOptions options_;
    prep::detail::Domain domain_;
    std::unique_ptr<const prep::detail::BaseSurface> base_;
    prep::detail::RootHeights heights_;
    std::unique_ptr<const prep::detail::DisplacedSurface> surface_;
};

inline prep::Displacement space_noise(double frequency, int octaves, double scale) {
    prep::NoiseOptions options{.frequency = frequency, .octaves = octaves, .seed = 11};
    options.scale = scale;
    const auto made = prep::noise_function(options);
    EXPECT_TRUE(made);
    return {.height = nullptr, .noise = *made};
}

}  // namespace tessellation_checks
