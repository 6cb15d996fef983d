// Pixels that a triangle covers in part: where in it they are shaded, and how much of the
// background stays. Colours are linear across the triangle, so that they tell the place.
#include <array>

#include "reference_shading.h"

namespace {

using namespace test;

constexpr std::uint32_t extent = 40;
const glm::dvec3 background(0.25, 0.5, 1.0);

// Corners in pixels from the picture's top left, on the grid that corners are moved to, clockwise
// on the screen, and the colours there.
using Corners = std::array<glm::dvec2, 3>;
const Corners slanted = {{{2.25, 30.5}, {17.75, 3.25}, {37.5, 35.75}}};
const Corners sliver = {{{1.5, 8.25}, {39, 5.5}, {22.25, 8}}};
const glm::dvec3 colors[3] = {{1, 0, 0.125}, {0, 1, 0.5}, {0.5, 0.25, 1}};

double side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}
glm::dvec3 color_at(const Corners& c, const glm::dvec2& p) {
    const double area = side(c[0], c[1], c[2]);
    return (colors[0] * side(c[1], c[2], p) + colors[1] * side(c[2], c[0], p) +
            colors[2] * side(c[0], c[1], p)) /
           area;
}

prep::PreparedScene scene_with(const Corners& corners) {
    prep::VertexMesh mesh;
    mesh.colors = {{}};
    for (std::size_t k = 0; k < 3; ++k) {
        mesh.positions.push_back(
            glm::vec3(corners[k].x - extent / 2.0, extent / 2.0 - corners[k].y, 0));
        mesh.colors[0].push_back(glm::vec4(glm::vec3(colors[k]), 1));
    }
    mesh.indices = {0, 1, 2};
    prep::Material material = white();
    material.unlit = material.double_sided = true;
    return test::scene_of(mesh, material);
}
rast::RenderRequest request_of() {
    rast::RenderRequest request;
    request.width = request.height = extent;
    request.view = test::flat_view(extent / 2.0);
    request.background = glm::vec3(background);
    return request;
}

// ------------------------------------------------------------------------------------ exact areas

// The polygon's part where a·x + b·y ≤ c (Sutherland and Hodgman 1974).
std::vector<glm::dvec2> clipped(const std::vector<glm::dvec2>& p, double a, double b, double c) {
    std::vector<glm::dvec2> out;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const glm::dvec2 &from = p[i], &to = p[(i + 1) % p.size()];
        const double df = a * from.x + b * from.y - c, dt = a * to.x + b * to.y - c;
        if (df <= 0) out.push_back(from);
        if ((df < 0 && dt > 0) || (df > 0 && dt < 0))
            out.push_back(from + (to - from) * (df / (df - dt)));
    }
    return out;
}

TEST(PartialPixels, OfExactAreasAreShadedAtTheCentroidOfWhatIsSeen) {
    for (const Corners& corners : {slanted, sliver}) {
        rast::RenderRequest request = request_of();
        request.coverage = rast::Coverage::area;
        std::size_t partial = 0;
        // A centroid is moved by 1/512 pixel at most, where the sliver, less than two pixels high,
        // changes colours by 0.7 from pixel to pixel.
        const std::size_t compared =
            expect_pixels(scene_with(corners), request, 2e-3, [&](double x, double y) {
                std::vector<glm::dvec2> part(corners.begin(), corners.end());
                part = clipped(part, -1, 0, -x);
                part = clipped(part, 1, 0, x + 1);
                part = clipped(part, 0, -1, -y);
                part = clipped(part, 0, 1, y + 1);
                double area = 0;
                glm::dvec2 first(0.0);
                for (std::size_t i = 2; i < part.size(); ++i) {
                    const double a = side(part[0], part[i - 1], part[i]) / 2;
                    area += a;
                    first += (part[0] + part[i - 1] + part[i]) * (a / 3);
                }
                if (!(area > 1e-9)) return background;
                partial += area < 0.999;
                return glm::mix(background, color_at(corners, first / area), area);
            });
        EXPECT_GT(partial, 40u);
        EXPECT_GT(compared, partial);
    }
}

// --------------------------------------------------------------------------------- several samples

// Standard sample locations (Vulkan 1.3, "Multisampling"), in sixteenths from the top left corner.
std::vector<glm::dvec2> standard_samples(int count) {
    if (count == 2) return {{12, 12}, {4, 4}};
    if (count == 4) return {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
    return {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
}

// Shaded at the pixel's centre where all samples are covered, else at the
// covered sample nearest to it.
TEST(PartialPixels, OfSeveralSamplesAreShadedAtTheCoveredOneNearestToTheCentre) {
    for (const int count : {2, 4, 8})
        for (const Corners& corners : {slanted, sliver}) {
            rast::RenderRequest request = request_of();
            request.samples = count;
            std::size_t partial = 0;
            const std::size_t compared = expect_pixels(
                scene_with(corners), request, 1e-5,
                [&](double x, double y) -> std::optional<glm::dvec3> {
                    int covered = 0;
                    double nearest = 1e9;
                    glm::dvec2 at(0.0);
                    for (const glm::dvec2& sample : standard_samples(count)) {
                        const glm::dvec2 p = glm::dvec2(x, y) + sample / 16.0;
                        double least = 1e9;
                        for (std::size_t k = 0; k < 3; ++k)
                            least = std::min(least, side(corners[k], corners[(k + 1) % 3], p));
                        if (least == 0) return std::nullopt;  // the top-left rule decides
                        if (least < 0) continue;
                        ++covered;
                        const double from = glm::distance(p, glm::dvec2(x, y) + 0.5);
                        if (from >= nearest) continue;
                        nearest = from;
                        at = p;
                    }
                    if (covered == 0) return background;
                    partial += covered < count;
                    if (covered == count) at = glm::dvec2(x, y) + 0.5;
                    return glm::mix(background, color_at(corners, at), double(covered) / count);
                });
            EXPECT_GT(partial, 20u);
            EXPECT_GT(compared, partial);
        }
}

// docs/rendering.md: buffers hold each pixel's first sample.
TEST(PartialPixels, BuffersHoldTheFirstSample) {
    for (const int count : {1, 2, 4, 8}) {
        rast::RenderRequest request = request_of();
        request.samples = count;
        request.keep_positions = request.keep_barycentrics = request.keep_ids = true;
        for (const prep::SimdLevel level : every_level()) {
            request.simd = level;
            const rast::Frame frame = test::draw(scene_with(slanted), request);
            std::size_t seen = 0;
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    const std::size_t i = std::size_t(y) * extent + x;
                    if (frame.triangle[i] == prep::no_index) continue;
                    ++seen;
                    const glm::dvec2 first =
                        count == 1 ? glm::dvec2(0.5) : standard_samples(count)[0] / 16.0;
                    const glm::dvec2 p = glm::dvec2(x, y) + first;
                    const glm::dvec3 world(p.x - extent / 2.0, extent / 2.0 - p.y, 0);
                    ASSERT_LT(distance(glm::dvec3(frame.position[i]) + request.view->eye(), world),
                              1e-5);
                    const glm::dvec3 expected = color_at(slanted, p);
                    glm::dvec3 color(0.0);
                    for (int k = 0; k < 3; ++k)
                        color += double(frame.barycentric[i][k]) * colors[k];
                    ASSERT_LT(distance(color, expected), 1e-6);
                }
            EXPECT_GT(seen, 300u);
        }
    }
}

}  // namespace
