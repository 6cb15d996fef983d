// How many triangles an error takes: adaptive against uniform grids of 2 · 4ᵏ triangles a quad, at
// equal true error. Both errors are measured alike, as the largest distance to the truth at equal
// parameters over dense points; docs/displacement.md has the table that this prints.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>

#include "tessellation/limit_base.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

// Every face the whole of the UV square.
Mesh charted(Mesh mesh) {
    mesh.uvs.assign(1, {});
    mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) mesh.uvs[0].indices.push_back(c % 4);
    return mesh;
}

class Economy {
  public:
    // The domain is pointed at: it stays where it is.
    Economy(const Economy&) = delete;
    Economy& operator=(const Economy&) = delete;
    Economy(Mesh cage, bool limit, Displacement displacement) : cage_(std::move(cage)) {
        if (limit) options_.scheme = SubdivisionScheme::catmark;
        options_.samples = 0;
        if (displacement.height || displacement.noise)
            options_.displacements = {std::move(displacement)};
        domain_ = detail::make_domain(cage_, {}, !limit, 0);
        if (limit) {
            auto base = detail::LimitBase::make(cage_, {}, true);
            EXPECT_TRUE(base);
            auto made = std::make_unique<detail::LimitBase>(*std::move(base));
            made->set_domain(domain_);
            base_ = std::move(made);
        } else {
            auto base = detail::PolygonSurface::make(cage_, domain_, {}, 0);
            EXPECT_TRUE(base);
            base_ = std::make_unique<detail::PolygonSurface>(*std::move(base));
        }
        auto heights = detail::RootHeights::make(cage_, domain_, *base_, options_);
        EXPECT_TRUE(heights);
        heights_ = *std::move(heights);
        surface_ = std::make_unique<detail::DisplacedSurface>(*base_, heights_);
    }

    struct Mean {
        std::size_t triangles = 0;
        double error = 0;
    };

    Mean uniform(int level) const {
        const int dense = this->dense(), n = 1 << level, each = dense / n;
        Mean out{2 * cage_.face_count() * std::size_t(n) * std::size_t(n), 0};
        for (std::uint32_t face = 0; face < cage_.face_count(); ++face) {
            std::vector<glm::dvec3> truth;
            for (int j = 0; j <= dense; ++j)
                for (int i = 0; i <= dense; ++i)
                    truth.push_back(
                        surface_->truth(in_face(face, glm::dvec2(i, j) / double(dense))));
            const auto at = [&](int i, int j) { return truth[std::size_t(j * (dense + 1) + i)]; };
            for (int y = 0; y < n; ++y)
                for (int x = 0; x < n; ++x)
                    for (int j = 0; j <= each; ++j)
                        for (int i = 0; i <= each; ++i) {
                            const double s = double(i) / each, t = double(j) / each;
                            const glm::dvec3 a = at(x * each, y * each);
                            const glm::dvec3 b = at((x + 1) * each, y * each);
                            const glm::dvec3 c = at((x + 1) * each, (y + 1) * each);
                            const glm::dvec3 d = at(x * each, (y + 1) * each);
                            const glm::dvec3 on = s >= t ? a + s * (b - a) + t * (c - b)
                                                         : a + t * (d - a) + s * (c - d);
                            out.error = std::max(out.error,
                                                 glm::length(on - at(x * each + i, y * each + j)));
                        }
        }
        return out;
    }

    Mean adaptive(double asked) {
        options_.chord_error = asked;
        std::vector<detail::TrianglePlace> places;
        detail::TessellationHooks hooks;
        hooks.places = &places;
        const auto made = detail::tessellate(cage_, options_, hooks);
        EXPECT_TRUE(made);
        Mean out{made->mesh.face_count(), 0};
        for (std::size_t t = 0; t < places.size(); ++t) {
            const auto corners = detail::path_weights(places[t].path);
            // As dense as the points of uniform grids, and never fewer than eight along a side.
            const int depth = int(std::bit_width(places[t].path)) - 1;
            const int n = std::max(8, dense() >> (depth / 2));
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i + j <= n; ++i) {
                    const double w[3] = {double(n - i - j) / n, double(i) / n, double(j) / n};
                    detail::RootPoint p{places[t].root, glm::dvec3(0.0)};
                    glm::dvec3 on(0.0);
                    for (std::size_t k = 0; k < 3; ++k) {
                        p.weights += w[k] * corners[k];
                        on +=
                            w[k] *
                            glm::dvec3(made->mesh.positions[made->mesh.corner_vertices[3 * t + k]]);
                    }
                    out.error = std::max(out.error, glm::length(on - surface_->truth(p)));
                }
        }
        EXPECT_LE(out.error, asked);
        return out;
    }

    // The fewest triangles found that are no farther off than that.
    Mean fewest(double error) {
        Mean best = adaptive(error);
        for (const double more : {1.2, 1.5, 2.0, 2.7, 4.0}) {
            const Mean tried = adaptive(more * error);
            if (tried.error <= error && tried.triangles < best.triangles) best = tried;
        }
        return best;
    }

  private:
    // Points along a face's side: of one quad those that have all centres of 32² and 64² texels.
    int dense() const { return cage_.face_count() == 1 ? 128 : 64; }

    // A quad's parameters, from its first corner towards its second and its last.
    detail::RootPoint in_face(std::uint32_t face, const glm::dvec2& st) const {
        constexpr std::array<glm::dvec2, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        for (std::size_t k = 0; k < 4; ++k) {
            const glm::dvec2 a = square[k] - 0.5, b = square[(k + 1) % 4] - 0.5;
            const glm::dvec2 w = glm::inverse(glm::dmat2(a, b)) * (st - 0.5);
            if (w.x >= 0 && w.y >= 0)
                return {4 * face + std::uint32_t(k), {w.x, w.y, 1 - w.x - w.y}};
        }
        ADD_FAILURE();
        return {};
    }

    Mesh cage_;
    TessellateOptions options_;
    detail::Domain domain_;
    std::unique_ptr<const detail::BaseSurface> base_;
    detail::RootHeights heights_;
    std::unique_ptr<const detail::DisplacedSurface> surface_;
};

Displacement noise(double frequency, int octaves, double scale) {
    NoiseOptions options{.frequency = frequency, .octaves = octaves, .seed = 11};
    options.scale = scale;
    const auto made = noise_function(options);
    EXPECT_TRUE(made);
    return {.height = nullptr, .noise = *made};
}

// Cones on a plane: detail here and there, as of craters.
Displacement cones() {
    constexpr std::uint32_t size = 64;
    Image image{.width = size, .height = size, .channels = 1, .pixels = {}, .floating = true};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            double height = 0;
            for (const glm::dvec3 c :
                 {glm::dvec3(14, 18, 9), {45, 30, 6}, {22, 50, 5}, {52, 54, 4}})
                height = std::max(height, 1 - glm::length(glm::dvec2(c) - glm::dvec2(x, y)) / c.z);
            image.pixels.push_back(float(0.1 * height));
        }
    HeightMapOptions options;
    options.midlevel = 0;
    options.wrap_u = options.wrap_v = Wrap::clamp;
    const auto made = height_function(image, options);
    EXPECT_TRUE(made);
    return {.height = *made};
}

Displacement waves(double scale, double k) {
    return {.height = std::make_shared<Waves>(scale, k, k)};
}

TEST(TessellationEconomy, TrianglesAtEqualTrueError) {
    constexpr double round = 2 * std::numbers::pi;
    struct Case {
        const char* name;
        Mesh cage;
        bool limit;
        Displacement by;
        double most = 0;  // of uniform triangles at level 4, where that is less than all
    };
    const Displacement nothing{.height = nullptr};
    std::vector<Case> cases{{"quad, a spike of a texel of 32²",
                             unit_quad(),
                             false,
                             {.height = std::make_shared<Spike>(32, 10, 18, 0.1)},
                             0.5},
                            {"quad, four cones", unit_quad(), false, cones(), 0.5},
                            {"quad, sines", unit_quad(), false, waves(0.1, round)},
                            {"quad, noise", unit_quad(), false, noise(4, 3, 0.1)},
                            {"cube, noise", cube(), false, noise(1, 3, 0.2)},
                            {"cube's limit surface", cube(), true, nothing},
                            {"the same, sines", charted(cube()), true, waves(0.1, round)},
                            {"the same, noise", cube(), true, noise(1, 3, 0.2)},
                            {"torus' limit surface", torus(6, 4), true, nothing},
                            {"the same, noise", torus(6, 4), true, noise(0.7, 3, 0.2)}};
    // The table of docs/displacement.md has six faces at level 4, too.
    const std::size_t few = std::getenv("MESHPREP_LONG_TESTS") != nullptr ? 10 : 2;
    std::vector<double> ratios;
    for (Case& c : cases) {
        Economy of(c.cage, c.limit, c.by);
        for (int level = 1; level <= (c.cage.face_count() < few ? 4 : 3); ++level) {
            const Economy::Mean even = of.uniform(level);
            const Economy::Mean made = of.fewest(even.error);
            EXPECT_LE(made.error, even.error);
            const double ratio = double(made.triangles) / double(even.triangles);
            ratios.push_back(ratio);
            std::printf("%-34s level %d, error %.3g: uniform %zu, adaptive %zu (%.2f)\n", c.name,
                        level, even.error, even.triangles, made.triangles, ratio);
            // Detail here and there is what it is for.
            if (level == 4 && c.most > 0) {
                EXPECT_LE(ratio, c.most) << c.name;
            }
        }
    }
    std::sort(ratios.begin(), ratios.end());
    const double median = ratios[ratios.size() / 2];
    std::printf("median %.2f, largest %.2f\n", median, ratios.back());
    EXPECT_LE(median, 1.1);
}

}  // namespace
}  // namespace prep
